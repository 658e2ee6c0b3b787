//! `render`: a picture of a graph.

mod names;

use crate::bake;
use crate::load::{self, allows_sampling};
use crate::mistake::Mistake;
use crate::plan::{Plan, Wish};
use crate::progress;
use crate::report::Report;
use crate::scene::{self, Scene, writable};
use crate::sources::Sources;
use crate::strips::Strips;
use crate::value;
use clap::{Args, ValueEnum};
use mipless::{Method, Options};
use mipless_graph::CheckOptions;
use mipless_runtime::image::{Image, channel_names, outputs};
use mipless_runtime::image_file::{self, Bits, Format, Space, Streamed};
use mipless_runtime::lit::Hiding;
use mipless_runtime::view::{Part, Size};
use names::{Name, Names};
use serde_json::{Map, Value, json};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::{Duration, Instant};

/// The arguments of `render`.
#[derive(Args, Debug)]
pub(crate) struct Arguments {
    /// Graphs, JSON files; `-` is standard input
    #[arg(value_name = "GRAPH", required = true)]
    graphs: Vec<PathBuf>,

    #[command(flatten)]
    scene: scene::Arguments,

    /// The picture: .png or .exr (f32, linear). `{graph}`, `{output}`, `{tile}` and `{level}` stand for
    /// their names, so that several have names of their own
    #[arg(short, long, value_name = "FILE")]
    out: PathBuf,

    /// auto, point, naive, ensemble, local, quad, split:4|7|16 or supersample:N
    #[arg(long, default_value = "auto")]
    method: Method,

    /// Choose the cheapest method whose measured error (sRGB RMS) is at most this
    #[arg(long, value_name = "E", value_parser = value::positive)]
    tolerance: Option<f64>,

    /// Choose the most accurate method that costs at most this many times `point`
    #[arg(long, value_name = "R", value_parser = value::positive)]
    budget: Option<f64>,

    /// The bits of a channel of a .png [default: 8]
    #[arg(long, value_enum)]
    bits: Option<BitsName>,

    /// What the levels of a .png stand for: `auto` is srgb of colours, linear of numbers, vectors and
    /// normals; an .exr is always linear
    #[arg(long, value_enum, default_value = "auto")]
    colorspace: SpaceName,

    /// A tile of the picture of --size, to the bit as it is in the whole: its column and row, of so many
    #[arg(long, value_name = "I,J/NxM", value_parser = value::tile)]
    tile: Option<[[u32; 2]; 2]>,

    /// Also render each level of the mip chain down to 1×1, filtered for its own pixels: `{level}` in the
    /// name is its number
    #[arg(long, conflicts_with = "tile")]
    mips: bool,

    /// Also write the mean and the variance of every channel over the footprint, as f32
    #[arg(long, value_name = "FILE.exr")]
    moments: Option<PathBuf>,

    #[command(flatten)]
    bake: bake::Arguments,
}

/// From so many pixels on a .png is written as it is made, with a few of its rows in memory.
const STREAMED: usize = 1 << 20;

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum SpaceName {
    Auto,
    Srgb,
    Linear,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum BitsName {
    #[value(name = "8")]
    Eight,
    #[value(name = "16")]
    Sixteen,
}

/// Evaluates and writes.
pub(crate) fn run(arguments: &Arguments, report: &mut Report) -> Result<(), Mistake> {
    let format = arguments.check(report)?;
    let mut names = Names::default();
    let several = arguments.graphs.len() > 1;
    let mut rendered = Vec::new();
    for path in &arguments.graphs {
        match arguments.graph(path, format, &mut names, report) {
            Ok(results) if several => rendered.push(Value::Object(results)),
            Ok(results) => results
                .into_iter()
                .for_each(|(key, value)| report.result(&key, value)),
            Err(mistake) => report.mistake(&mistake),
        }
    }
    if several {
        report.result("rendered", rendered);
    }
    Ok(())
}

/// What a graph is rendered to.
struct Work<'a> {
    path: &'a Path,
    options: Options,
    format: Format,
    part: Part,
    /// The pictures, one an output that is looked at.
    out: Vec<PathBuf>,
    moments: Vec<PathBuf>,
}

impl Arguments {
    /// What can be refused before any work is done.
    fn check(&self, report: &mut Report) -> Result<Format, Mistake> {
        let bits = match self.bits {
            Some(BitsName::Sixteen) => Bits::Sixteen,
            Some(BitsName::Eight) | None => Bits::Eight,
        };
        let refused = |error| Mistake::usage("usage", error);
        let format = Format::of(&self.out, bits, Space::Srgb).map_err(refused)?;
        let mut read = Sources::default();
        self.graphs.iter().for_each(|graph| read.add(graph));
        for path in std::iter::once(&self.out).chain(&self.moments) {
            names::needs_graph(path, self.graphs.len())?;
            if self.mips && !path.to_string_lossy().contains("{level}") {
                let message = format!("all levels would be {}", path.display());
                return Err(Mistake::usage("same-name", message)
                    .help("put `{level}` into the name: {graph}_{level}.png"));
            }
            if !names::is_pattern(path) {
                writable(path)?;
                read.guard(path)?;
            }
        }
        if let Some(path) = &self.moments {
            if Format::of(path, bits, Space::Linear).map_err(refused)? != Format::Exr {
                return Err(refused(image_file::FileError::Extension(path.clone()))
                    .help("moments need the range of .exr"));
            }
            if crate::sources::is_same(path, &self.out) {
                return Err(Mistake::usage(
                    "usage",
                    "`--moments` and `-o` name the same file",
                ));
            }
        }
        if self.bits.is_some() && format == Format::Exr {
            report.warn(
                "ignored-bits",
                "`--bits` is for .png; an .exr holds 32-bit floats",
            );
        }
        if self.colorspace == SpaceName::Srgb && format == Format::Exr {
            report.warn("ignored-colorspace", "an .exr is linear");
        }
        let chooses = self.tolerance.is_some() || self.budget.is_some();
        if self.method != Method::Auto && chooses {
            return Err(Mistake::usage(
                "usage",
                "`--tolerance` and `--budget` choose the method, but `--method` names one",
            ));
        }
        if chooses && self.scene.is_all() {
            return Err(
                Mistake::usage("usage", "`--tolerance` and `--budget` measure one output")
                    .help("name it by `--output`"),
            );
        }
        self.scene.check()?;
        Ok(format)
    }

    /// Renders a graph; returns what tools are told.
    fn graph(
        &self,
        path: &Path,
        format: Format,
        names: &mut Names,
        report: &mut Report,
    ) -> Result<Map<String, Value>, Mistake> {
        let (mut scene, plan) = self.prepare(path, report)?;
        let whole = match self.tile {
            None => Part::all(scene.size),
            Some([place, count]) => Part::tile(scene.size, place, count).ok_or_else(|| {
                Mistake::usage("usage", "`--tile`: a picture of that size has no such tile")
                    .help("a tile has a pixel at least")
            })?,
        };
        let method = plan.as_ref().map_or(self.method, |plan| plan.method);
        let options = Options {
            moments: self.moments.is_some(),
            ..scene.options(method)
        };
        let mut read = Sources::default();
        self.graphs.iter().for_each(|graph| read.add(graph));
        read.add_graph(path, &scene.texture);
        let begun = Instant::now();
        let mut files = Vec::new();
        let levels = if self.mips {
            whole.size.levels()
        } else {
            vec![whole.size]
        };
        for (level, size) in (0..).zip(levels) {
            let part = if level == 0 { whole } else { Part::all(size) };
            scene.size = part.whole;
            let mut named = |pattern: &PathBuf| {
                let one = |output: String| {
                    let name = Name {
                        graph: scene.texture.name(),
                        output: &output,
                        tile: self.tile,
                        level,
                    };
                    names.take(pattern, &name, &read)
                };
                let all = scene.outputs().into_iter();
                all.map(one).collect::<Result<Vec<PathBuf>, Mistake>>()
            };
            let work = Work {
                path,
                options,
                format,
                part,
                out: named(&self.out)?,
                moments: (self.moments.as_ref().map(&mut named))
                    .transpose()?
                    .unwrap_or_default(),
            };
            let is_large = part.size.pixels() > STREAMED;
            match format {
                Format::Png(bits, _) if is_large && work.moments.is_empty() => {
                    self.stream(&work, bits, &scene, report)?;
                }
                _ => self.whole(&work, &mut scene, report)?,
            }
            let written = work.out.iter().chain(&work.moments);
            files.extend(written.map(|file| file.display().to_string()));
        }
        let shown = (whole.size, begun.elapsed());
        Ok(say(
            &scene,
            (path, &options),
            &files,
            plan.as_ref(),
            shown,
            report,
        ))
    }

    /// What the levels of an output stand for.
    fn space(&self, scene: &Scene, index: usize) -> Space {
        match self.colorspace {
            SpaceName::Srgb => Space::Srgb,
            SpaceName::Linear => Space::Linear,
            SpaceName::Auto => match scene.is_color(index) {
                true => Space::Srgb,
                false => Space::Linear,
            },
        }
    }

    /// Renders all of it, then writes it.
    fn whole(
        &self,
        work: &Work<'_>,
        scene: &mut Scene,
        report: &mut Report,
    ) -> Result<(), Mistake> {
        scene.fits(work.part.size)?;
        let (program, all) = scene.results(&work.options, work.part, report)?;
        let lit = scene.lit(Hiding::Facets);
        let pictures = scene.pictures(&program.interface, lit.as_ref(), &all, work.part);
        let unwritable = |error| Mistake::usage("unwritable-file", error);
        let mut files = Vec::new();
        for (index, (path, picture)) in work.out.iter().zip(&pictures).enumerate() {
            let format = match work.format {
                Format::Png(bits, _) => Format::Png(bits, self.space(scene, index)),
                Format::Exr => Format::Exr,
            };
            let bytes = image_file::encode(path, picture, format).map_err(unwritable)?;
            files.push((path.clone(), bytes));
        }
        let places = outputs(&program.interface).into_iter().skip(scene.output);
        for (path, place) in work.moments.iter().zip(places) {
            if let Some(variance) = all.variance(&place) {
                let image = Image::moments(&all.mean(&place), &variance);
                let bytes = image_file::encode(path, &image, Format::Exr).map_err(unwritable)?;
                files.push((path.clone(), bytes));
            }
        }
        image_file::write_all(&files).map_err(unwritable)
    }

    /// Writes it as it is made.
    fn stream(
        &self,
        work: &Work<'_>,
        bits: Bits,
        scene: &Scene,
        report: &mut Report,
    ) -> Result<(), Mistake> {
        let strips = Strips::new(scene, &work.options, report)?;
        let types = scene.types();
        let file = |(index, path): (usize, &PathBuf)| Streamed {
            path: path.clone(),
            names: (channel_names(types[index]).iter())
                .map(|name| (*name).to_owned())
                .collect(),
            bits,
            space: self.space(scene, index),
        };
        let files: Vec<Streamed> = work.out.iter().enumerate().map(file).collect();
        let (size, finished) = (work.part.size, AtomicU32::new(0));
        let label = work.path.display().to_string();
        progress::watch(report, &label, |job| {
            image_file::stream(&files, size, |row, rows| {
                let pictures = strips.pictures(work.part.rows(row, rows))?;
                let finished = finished.fetch_add(rows, Ordering::Relaxed) + rows;
                if let Some(progress) = job.progress {
                    progress(finished, size.height);
                }
                Ok::<_, Mistake>(pictures)
            })
        })
    }

    /// The scene, and the method that was chosen for it, if it was to be chosen.
    fn prepare(&self, path: &Path, report: &mut Report) -> Result<(Scene, Option<Plan>), Mistake> {
        let default = Size::new(1280, 720);
        let Some(wish) = Wish::new(self.tolerance, self.budget) else {
            let options = allows_sampling(self.method);
            let texture = load::load(path, &options, report)?;
            let texture = self.bake.apply(path, texture, &options)?;
            let scene = self.scene.scene(path, texture, default)?;
            if scene.sun.is_some() && self.moments.is_some() {
                return Err(Mistake::usage("usage", "a lit material has no moments")
                    .help("name a part of it by `--output`"));
            }
            return Ok((scene, None));
        };
        let graph = load::graph(path, report)?;
        let checked = load::parse(path, &graph, &CheckOptions::default(), report);
        // What has no statistics can still be sampled, if that is good or cheap enough.
        let (texture, filters) = match checked {
            Ok(texture) => (texture, true),
            Err(mistake) => {
                let options = CheckOptions {
                    allow_sampling: true,
                };
                let sampled = load::parse(path, &graph, &options, report);
                (sampled.map_err(|_| mistake)?, false)
            }
        };
        load::warn(path, &texture, report);
        let options = CheckOptions {
            allow_sampling: !filters,
        };
        let texture = self.bake.apply(path, texture, &options)?;
        let scene = self.scene.scene(path, texture, default)?;
        scene.needs_part()?;
        let plan = Plan::make(&scene, wish, filters, report)?;
        Ok((scene, Some(plan)))
    }
}

/// Says what was done, to people at once; returns it for tools.
fn say(
    scene: &Scene,
    (path, options): (&Path, &Options),
    files: &[String],
    plan: Option<&Plan>,
    (Size { width, height }, taken): (Size, Duration),
    report: &Report,
) -> Map<String, Value> {
    let chosen = plan.map(|plan| format!(" ({plan})")).unwrap_or_default();
    report.note(format_args!(
        "{}: {width}×{height}, {} view, method {}{chosen}, {}, {:.1} s",
        files.join(", "),
        scene.view.name(),
        options.method,
        scene.device,
        taken.as_secs_f64()
    ));
    let results = json!({
        "graph": path.display().to_string(),
        "files": files,
        "size": [width, height],
        "output": scene.output_name(),
        "outputs": scene.outputs(),
        "view": scene.view.name(),
        "method": options.method.to_string(),
        "pixel_filter": options.filter.to_string(),
        "device": scene.device.to_string(),
        "seconds": taken.as_secs_f64(),
    });
    let mut results = match results {
        Value::Object(results) => results,
        _ => Map::new(),
    };
    if let Some(plan) = plan {
        results.insert("plan".to_owned(), plan.to_json());
    }
    results
}
