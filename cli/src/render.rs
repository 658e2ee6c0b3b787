//! `render`: a picture of a graph.

use crate::load::{self, allows_sampling};
use crate::mistake::Mistake;
use crate::plan::{Plan, Wish};
use crate::report::Report;
use crate::scene::{self, Frame, Scene, writable};
use crate::sources::{Sources, is_same};
use crate::value;
use clap::{Args, ValueEnum};
use mipless::{Method, Options};
use mipless_graph::CheckOptions;
use mipless_runtime::image::Image;
use mipless_runtime::image_file::{self, Bits, Format};
use mipless_runtime::lit::Hiding;
use mipless_runtime::view::Size;
use serde_json::json;
use std::path::PathBuf;
use std::time::{Duration, Instant};

/// The arguments of `render`.
#[derive(Args, Debug)]
pub(crate) struct Arguments {
    #[command(flatten)]
    scene: scene::Arguments,

    /// The picture: .png (sRGB) or .exr (f32, linear)
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

    /// Also write the mean and the variance of every channel over the footprint, as f32
    #[arg(long, value_name = "FILE.exr")]
    moments: Option<PathBuf>,
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
    let (mut scene, plan) = arguments.prepare(report)?;
    let method = plan.as_ref().map_or(arguments.method, |plan| plan.method);
    let moments = arguments.moments.is_some();
    let options = Options {
        moments,
        ..scene.options(method)
    };

    let begun = Instant::now();
    let frame = match scene.lit(Hiding::Facets) {
        Some(lit) => Frame {
            mean: scene.evaluate_lit(&options, &lit, report)?,
            variance: None,
        },
        None => scene.evaluate(&options, report)?,
    };
    let taken = begun.elapsed();

    let unwritable = |error| Mistake::usage("unwritable-file", error);
    let picture = scene.present(&frame.mean);
    let bytes = image_file::encode(&arguments.out, &picture, format).map_err(unwritable)?;
    let mut files = vec![(arguments.out.clone(), bytes)];
    if let (Some(path), Some(variance)) = (&arguments.moments, &frame.variance) {
        let image = Image::moments(&frame.mean, variance);
        let bytes = image_file::encode(path, &image, Format::Exr).map_err(unwritable)?;
        files.push((path.clone(), bytes));
    }
    image_file::write_all(&files).map_err(unwritable)?;

    say(&scene, &files, &options, plan.as_ref(), taken, report);
    Ok(())
}

impl Arguments {
    /// What can be refused before any work is done.
    fn check(&self, report: &mut Report) -> Result<Format, Mistake> {
        let bits = match self.bits {
            Some(BitsName::Sixteen) => Bits::Sixteen,
            Some(BitsName::Eight) | None => Bits::Eight,
        };
        let refused = |error| Mistake::usage("usage", error);
        let format = Format::of(&self.out, bits).map_err(refused)?;
        writable(&self.out)?;
        let mut read = Sources::default();
        read.add(&self.scene.graph);
        read.guard(&self.out)?;
        if let Some(path) = &self.moments {
            if Format::of(path, Bits::Eight).map_err(refused)? != Format::Exr {
                return Err(refused(image_file::FileError::Extension(path.clone()))
                    .help("moments need the range of .exr"));
            }
            if is_same(path, &self.out) {
                return Err(Mistake::usage(
                    "usage",
                    "`--moments` and `-o` name the same file",
                ));
            }
            writable(path)?;
            read.guard(path)?;
        }
        if self.bits.is_some() && format == Format::Exr {
            report.warn(
                "ignored-bits",
                "`--bits` is for .png; an .exr holds 32-bit floats",
            );
        }
        if self.method != Method::Auto && (self.tolerance.is_some() || self.budget.is_some()) {
            return Err(Mistake::usage(
                "usage",
                "`--tolerance` and `--budget` choose the method, but `--method` names one",
            ));
        }
        self.scene.check()?;
        Ok(format)
    }

    /// Refuses to write over a picture that the graph reads.
    fn guard(&self, scene: &Scene) -> Result<(), Mistake> {
        let mut read = Sources::default();
        read.add_graph(&self.scene.graph, &scene.texture);
        read.guard(&self.out)?;
        self.moments.iter().try_for_each(|path| read.guard(path))
    }

    /// The scene, and the method that was chosen for it, if it was to be chosen.
    fn prepare(&self, report: &mut Report) -> Result<(Scene, Option<Plan>), Mistake> {
        let default = Size::new(1280, 720);
        let Some(wish) = Wish::new(self.tolerance, self.budget) else {
            let scene = self
                .scene
                .open(&allows_sampling(self.method), default, report)?;
            self.guard(&scene)?;
            if scene.sun.is_some() && self.moments.is_some() {
                return Err(Mistake::usage("usage", "a lit material has no moments")
                    .help("name a part of it by `--output`"));
            }
            return Ok((scene, None));
        };
        let graph = load::graph(&self.scene.graph, report)?;
        let checked = load::parse(&self.scene.graph, &graph, &CheckOptions::default(), report);
        // What has no statistics can still be sampled, if that is good or cheap enough.
        let (texture, filters) = match checked {
            Ok(texture) => (texture, true),
            Err(mistake) => {
                let options = CheckOptions {
                    allow_sampling: true,
                };
                let sampled = load::parse(&self.scene.graph, &graph, &options, report);
                (sampled.map_err(|_| mistake)?, false)
            }
        };
        load::warn(&self.scene.graph, &texture, report);
        let scene = self.scene.scene(texture, default)?;
        self.guard(&scene)?;
        scene.needs_part()?;
        let plan = Plan::make(&scene, wish, filters, report)?;
        Ok((scene, Some(plan)))
    }
}

fn say(
    scene: &Scene,
    files: &[(PathBuf, Vec<u8>)],
    options: &Options,
    plan: Option<&Plan>,
    taken: Duration,
    report: &mut Report,
) {
    let names: Vec<String> = files
        .iter()
        .map(|(path, _)| path.display().to_string())
        .collect();
    let Size { width, height } = scene.size;
    let chosen = plan.map(|plan| format!(" ({plan})")).unwrap_or_default();
    report.note(format_args!(
        "{}: {width}×{height}, {} view, method {}{chosen}, {}, {:.1} s",
        names.join(", "),
        scene.view.name(),
        options.method,
        scene.device,
        taken.as_secs_f64()
    ));
    report.result("files", names);
    report.result("size", json!([width, height]));
    report.result("output", scene.output_name());
    report.result("view", scene.view.name());
    report.result("method", options.method.to_string());
    report.result("pixel_filter", value::pixel_filter_name(options.filter));
    report.result("device", scene.device.to_string());
    report.result("seconds", taken.as_secs_f64());
    if let Some(plan) = plan {
        report.result("plan", plan.to_json());
    }
}
