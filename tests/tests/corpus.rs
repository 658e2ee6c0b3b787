//! Public documents of other tools, which are no part of the project: what loads of them, where the
//! rest is refused, and that pixels are those of MaterialX's own shader.
//!
//! The folder is named by `MIPLESS_CORPUS`; without it everything is shown as ignored. It has `mtlx`, `ptex` and `gltf`, and in `reference` what
//! MaterialX's shaders give at 64 × 64 points. What is expected stands in `corpus.txt`; with
//! `MIPLESS_BLESS=1` it is written anew.

use libtest_mimic::{Arguments, Failed, Trial};
use mipless::{CheckOptions, Files, Folder, Footprint, Method, Options, Texture, specs};
use mipless_import::{Format, Imported, import};
use mipless_tests::{asked, root};
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Points a side, and the window that the references show.
const SIDE: usize = 64;
const WINDOW: [f64; 2] = [0.0137, 0.0071];

/// The largest difference that is none: that of two graphics drivers.
const SAME: f32 = 2e-4;

/// References that are not what their documents say, with the reason.
const STRAY: [(&str, &str); 1] = [(
    "learn__gltf_pattern.gltf_pbr_surfaceshader_base_color",
    // With a tiling of 0 of the hexagons, which read the same input of the document as the circles do, the
    // pictures are the same: MaterialX's generator connects such an input to the first of its readers.
    "generator",
)];

/// The longest that the import of a document may take, in a build without optimisation: 50 ms are
/// wanted of a release.
const LONGEST: Duration = Duration::from_millis(500);

fn main() {
    let arguments = Arguments::from_args();
    let folder = PathBuf::from(std::env::var_os("MIPLESS_CORPUS").unwrap_or_default());
    let missing = !folder.join("mtlx").is_dir();
    let folder = Arc::new(folder);
    let mut trials = Vec::new();
    for (format, test) in [
        ("mtlx", mtlx as fn(&Path) -> Result<(), Failed>),
        ("gltf", gltf),
        ("ptex", ptex),
    ] {
        let folder = Arc::clone(&folder);
        let trial = Trial::test(format!("documents_{format}"), move || test(&folder));
        trials.push(trial.with_ignored_flag(missing));
    }
    let back = Arc::clone(&folder);
    trials.push(
        Trial::test(
            "documents_that_load_come_back_from_their_export",
            move || round_trips(&back),
        )
        .with_ignored_flag(missing),
    );
    let cut = Arc::clone(&folder);
    trials.push(
        Trial::test(
            "documents_that_are_cut_off_do_not_stop_the_importer",
            move || truncations(&cut),
        )
        .with_ignored_flag(missing),
    );
    libtest_mimic::run(&arguments, trials).exit();
}

/// The documents of a format.
fn documents(folder: &Path, format: &str) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder.join(format)).expect("the corpus is readable");
    let mut paths: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
    paths.retain(|path| {
        path.extension()
            .is_some_and(|extension| extension == format)
    });
    paths.sort();
    paths
}

fn read(path: &Path) -> (Imported, Duration) {
    let format = Format::of(path).expect("a known extension");
    let text = fs::read_to_string(path).expect("the document is readable");
    let files = Folder(path.parent().expect("it stands in a folder").to_path_buf());
    let specs = specs();
    let options = mipless_import::Options {
        specs: &specs,
        files: &|name| files.read(name),
        ..mipless_import::Options::default()
    };
    let name = path.file_name().expect("a name").to_string_lossy();
    let begun = Instant::now();
    let imported = import(format, &name, &text, &options);
    (imported, begun.elapsed())
}

/// The graph of a document, if it checks; else the codes of what is wrong with it.
fn texture(imported: &Imported, path: &Path) -> Option<Result<Texture, Vec<String>>> {
    let text = imported.document.as_ref()?.to_text();
    let files = Folder(path.parent()?.to_path_buf());
    let checked = Texture::with_name("t", &text, &CheckOptions::default(), &files);
    Some(checked.map_err(|diagnostics| {
        let mut codes: Vec<String> = (diagnostics.iter())
            .filter(|diagnostic| diagnostic.is_error())
            .map(|diagnostic| {
                let located = imported.located(diagnostic.clone()).diagnostic;
                format!("{}@{}", located.code, located.line.unwrap_or(0))
            })
            .collect();
        codes.dedup();
        codes
    }))
}

/// One line about a document: how much loads, what is refused and where.
fn line(path: &Path, imported: &Imported, took: Duration) -> Result<String, Failed> {
    let loads = imported
        .outputs
        .iter()
        .filter(|output| output.loads)
        .count();
    let name = path.file_name().expect("a name").to_string_lossy();
    let mut line = format!("{name}: {loads}/{}", imported.outputs.len());
    for finding in &imported.findings {
        let diagnostic = &finding.diagnostic;
        if diagnostic.line.is_none() || diagnostic.column.is_none() || finding.file.is_empty() {
            return Err(format!("{name}: no place: {diagnostic}").into());
        }
        if diagnostic.is_error() {
            let at = diagnostic.line.unwrap_or(0);
            write!(line, " {}@{at}", diagnostic.code).expect("a text grows");
        }
    }
    if took > LONGEST {
        return Err(format!("{name}: the import takes {took:?}").into());
    }
    Ok(line)
}

/// Compares what was found with what is expected of the documents of a format.
fn expect(format: &str, lines: &[String]) -> Result<(), Failed> {
    let path = root().join("tests/corpus.txt");
    let old = fs::read_to_string(&path).unwrap_or_default();
    let mut sections: BTreeMap<String, Vec<String>> = BTreeMap::new();
    let mut section = String::new();
    for line in old.lines() {
        match line.strip_prefix("## ") {
            Some(name) => name.clone_into(&mut section),
            None if line.is_empty() || line.starts_with('#') => {}
            None => sections
                .entry(section.clone())
                .or_default()
                .push(line.to_owned()),
        }
    }
    if asked("MIPLESS_BLESS") {
        sections.insert(format.to_owned(), lines.to_vec());
        let mut text =
            "# What loads of public documents; tests/tests/corpus.rs writes it.\n".to_owned();
        for (name, lines) in &sections {
            write!(text, "\n## {name}\n{}\n", lines.join("\n")).expect("a text grows");
        }
        fs::write(&path, text)?;
        return Ok(());
    }
    let expected = sections.remove(format).unwrap_or_default();
    let wrong: Vec<String> = (lines.iter())
        .filter(|line| !expected.contains(line))
        .map(|line| {
            let name = line.split(':').next().unwrap_or_default();
            let old = expected
                .iter()
                .find(|old| old.starts_with(&format!("{name}:")));
            format!(
                "{line}\n    expected {}",
                old.map_or("nothing", String::as_str)
            )
        })
        .collect();
    if wrong.is_empty() && expected.len() == lines.len() {
        return Ok(());
    }
    Err(format!("{}\nMIPLESS_BLESS=1 writes them anew", wrong.join("\n")).into())
}

/// The totals, for people.
fn total(format: &str, imported: &[Imported]) {
    let whole = imported
        .iter()
        .filter(|imported| imported.is_complete())
        .count();
    let outputs = imported.iter().flat_map(|imported| &imported.outputs);
    let (mut loads, mut all) = (0, 0);
    for output in outputs {
        loads += usize::from(output.loads);
        all += 1;
    }
    if asked("MIPLESS_REPORT") {
        println!(
            "{format}: {whole} of {} documents load whole, {loads} of {all} outputs",
            imported.len()
        );
    }
}

fn mtlx(folder: &Path) -> Result<(), Failed> {
    let references = References::read(folder);
    let mut lines = Vec::new();
    let mut all = Vec::new();
    for path in documents(folder, "mtlx") {
        let (imported, took) = read(&path);
        let mut line = line(&path, &imported, took)?;
        match texture(&imported, &path) {
            Some(Ok(texture)) => {
                let stem = path.file_stem().expect("a name").to_string_lossy();
                line += &references.compare(&stem, &imported, &texture);
            }
            Some(Err(codes)) => write!(line, " check: {}", codes.join(" "))?,
            None => {}
        }
        lines.push(line);
        all.push(imported);
    }
    total("mtlx", &all);
    expect("mtlx", &lines)
}

fn gltf(folder: &Path) -> Result<(), Failed> {
    without_references(folder, "gltf")
}

fn ptex(folder: &Path) -> Result<(), Failed> {
    without_references(folder, "ptex")
}

fn without_references(folder: &Path, format: &str) -> Result<(), Failed> {
    let mut lines = Vec::new();
    let mut all = Vec::new();
    for path in documents(folder, format) {
        let (imported, took) = read(&path);
        let mut line = line(&path, &imported, took)?;
        if let Some(Err(codes)) = texture(&imported, &path) {
            write!(line, " check: {}", codes.join(" "))?;
        }
        lines.push(line);
        all.push(imported);
    }
    total(format, &all);
    expect(format, &lines)
}

/// What MaterialX's own shaders give.
struct References {
    folder: PathBuf,
    index: serde_json::Value,
}

impl References {
    fn read(folder: &Path) -> Self {
        let folder = folder.join("reference");
        let text = fs::read_to_string(folder.join("index.json")).unwrap_or_default();
        Self {
            index: serde_json::from_str(&text).unwrap_or_default(),
            folder,
        }
    }

    /// The components of an output at every point, or the same everywhere.
    fn get(&self, key: &str) -> Option<Vec<Vec<f32>>> {
        let entry = self.index.get(key)?;
        if let Some(constant) = entry.get("constant").and_then(serde_json::Value::as_array) {
            let numbers = constant.iter().filter_map(serde_json::Value::as_f64);
            return Some(
                numbers
                    .map(|number| vec![number as f32; SIDE * SIDE])
                    .collect(),
            );
        }
        let path = self.folder.join(entry.get("file")?.as_str()?);
        let image = exr::prelude::read_first_flat_layer_from_file(path).ok()?;
        let channels = &image.layer_data.channel_data.list;
        let order = ["R", "G", "B", "X", "Y", "Z", "A", "W"];
        let mut found: Vec<(usize, Vec<f32>)> = (channels.iter())
            .filter_map(|channel| {
                let name = channel.name.to_string();
                let place = order.iter().position(|known| *known == name)?;
                Some((place, channel.sample_data.values_as_f32().collect()))
            })
            .collect();
        found.sort_by_key(|(place, _)| *place);
        Some(found.into_iter().map(|(_, numbers)| numbers).collect())
    }

    /// How the outputs of a document compare with their references: `same` is within [`SAME`]
    /// everywhere, `edge` but for 2 % of the points, `noise` where the hash is another one.
    fn compare(&self, stem: &str, imported: &Imported, texture: &Texture) -> String {
        let options = Options {
            method: Method::Point,
            ..Options::default()
        };
        let mut evaluator = texture.evaluator(&options);
        let components = evaluator.evaluate(&footprints());
        let mut first = 0;
        let mut verdicts: BTreeMap<&str, Vec<String>> = BTreeMap::new();
        for output in texture.outputs() {
            let count = texture.checked().graph().node(output.node).ty.components();
            let own = &components[first..first + count];
            first += count;
            // A part of a surface may be a product of inputs.
            let sources = (imported.outputs.iter()).filter(|own| own.name == output.name);
            let mut product: Option<Vec<Vec<f32>>> = None;
            let mut source = "";
            let mut stray = None;
            for factor in sources {
                let key = format!("{stem}.{}", factor.source.replace('/', "_"));
                let Some(reference) = self.get(&key) else {
                    continue;
                };
                source = &factor.source;
                stray = stray.or_else(|| STRAY.iter().find(|(own, _)| *own == key));
                product = Some(match product {
                    None => reference,
                    Some(product) => times(&product, &reference),
                });
            }
            let Some(reference) = product else {
                continue;
            };
            // A factor alone of a colour that has none, as it is a number.
            if reference.len() < own.len() && output.name.ends_with("base_color") {
                continue;
            }
            let verdict = match (verdict(own, &reference, is_noisy(imported)), stray) {
                ("differs", Some((_, reason))) => *reason,
                (verdict, _) => verdict,
            };
            verdicts.entry(verdict).or_default().push(source.to_owned());
        }
        let shown = verdicts
            .into_iter()
            .map(|(verdict, sources)| match verdict {
                "same" => format!(" same:{}", sources.len()),
                _ => format!(" {verdict}:{}", sources.join(",")),
            });
        shown.collect()
    }
}

/// The product of two pictures; one of one channel is a factor of all.
fn times(a: &[Vec<f32>], b: &[Vec<f32>]) -> Vec<Vec<f32>> {
    let channel = |of: &[Vec<f32>], i: usize| of[i.min(of.len() - 1)].clone();
    (0..a.len().max(b.len()))
        .map(|i| {
            let pairs = channel(a, i).into_iter().zip(channel(b, i));
            pairs.map(|(a, b)| a * b).collect()
        })
        .collect()
}

/// The places of the points.
fn footprints() -> Vec<Footprint> {
    let at = |low: f64, i: usize| (low + (i as f64 + 0.5) / SIDE as f64) as f32;
    let places = (0..SIDE).flat_map(|j| (0..SIDE).map(move |i| (i, j)));
    let place = |(i, j): (usize, usize)| Footprint {
        uv: [at(WINDOW[0], i), at(WINDOW[1], j)],
        du: [1.0 / SIDE as f32, 0.0],
        dv: [0.0, 1.0 / SIDE as f32],
        ..Footprint::default()
    };
    places.map(place).collect()
}

/// How an output compares: noises with other hashes have other blobs.
fn verdict(own: &[Vec<f32>], reference: &[Vec<f32>], noisy: bool) -> &'static str {
    let broadcast = own.len() == 1 && reference.len() == 3;
    if own.len() != reference.len() && !broadcast {
        return "type";
    }
    let count = own.len().min(reference.len());
    let differs = |k: usize| {
        own[..count].iter().zip(reference).any(|(a, b)| {
            let (a, b) = (a[k], b[k]);
            (a - b).abs() > SAME * b.abs().max(1.0)
        })
    };
    match (0..SIDE * SIDE).filter(|k| differs(*k)).count() {
        0 => "same",
        few if few * 50 < SIDE * SIDE => "edge",
        _ if noisy => "noise",
        _ => "differs",
    }
}

/// Whether the graph has noises whose values are not those of the tool.
fn is_noisy(imported: &Imported) -> bool {
    let mut findings = imported.findings.iter();
    findings.any(|finding| {
        finding
            .diagnostic
            .message
            .ends_with("with the same statistics")
    })
}

/// Every document, cut off at many places, is read without a panic, and refused with a place.
fn truncations(folder: &Path) -> Result<(), Failed> {
    let specs = specs();
    let options = mipless_import::Options {
        specs: &specs,
        ..mipless_import::Options::default()
    };
    for format in ["mtlx", "gltf", "ptex"] {
        for path in documents(folder, format) {
            let text = fs::read_to_string(&path)?;
            let format = Format::of(&path).expect("a known extension");
            let parts = 12;
            for part in 0..parts {
                let mut end = text.len() * part / parts;
                while !text.is_char_boundary(end) {
                    end -= 1;
                }
                let imported = import(format, "cut", &text[..end], &options);
                if imported.findings.is_empty() && imported.is_complete() {
                    return Err(format!("{}: half of it loads", path.display()).into());
                }
            }
        }
    }
    Ok(())
}

/// What loads whole is written as MaterialX and read again, and shows the same at every point.
fn round_trips(folder: &Path) -> Result<(), Failed> {
    let specs = specs();
    let (mut count, mut wrong) = (0, Vec::new());
    for path in documents(folder, "mtlx") {
        let (before, _) = read(&path);
        let (Some(document), true) = (&before.document, before.is_complete()) else {
            continue;
        };
        let name = path.file_name().expect("a name").to_string_lossy();
        let (Some(graph), _) = mipless_graph::resolve(document, &specs) else {
            wrong.push(format!("{name}: it does not resolve"));
            continue;
        };
        count += 1;
        let exported = mipless_import::export(&graph, &specs);
        let Some(text) = exported.text else {
            let said: Vec<String> = (exported.diagnostics.iter())
                .map(ToString::to_string)
                .collect();
            wrong.push(format!("{name}: {}", said.join("; ")));
            continue;
        };
        let options = mipless_import::Options {
            specs: &specs,
            ..mipless_import::Options::default()
        };
        let after = import(Format::MaterialX, &name, &text, &options);
        if !after.is_complete() {
            let finding = after.findings.first().map(|one| one.diagnostic.to_string());
            wrong.push(format!("{name}: {}", finding.unwrap_or_default()));
            continue;
        }
        match (texture(&before, &path), texture(&after, &path)) {
            (Some(Ok(before)), Some(Ok(after))) => {
                // What no shader reads is told, and stays behind.
                let mut told = exported.diagnostics.iter();
                let (before, after) = if told.any(|one| one.code == "export-unread") {
                    let names = |of: &Texture| -> Vec<String> {
                        of.outputs().iter().map(|one| one.name.clone()).collect()
                    };
                    let (own, back) = (names(&before), names(&after));
                    // A shader that is left alone gives its name to no output any more.
                    let same = |back: &str| {
                        let tail = format!("_{back}");
                        let mut found =
                            (own.iter()).filter(|own| *own == back || own.ends_with(&tail));
                        found.next().filter(|_| found.next().is_none())
                    };
                    let common = back
                        .iter()
                        .filter_map(|back| Some((same(back)?.as_str(), back.as_str())));
                    let (own, back): (Vec<&str>, Vec<&str>) = common.unzip();
                    if own.is_empty() {
                        wrong.push(format!("{name}: nothing comes back"));
                        continue;
                    }
                    (before.with_outputs(&own), after.with_outputs(&back))
                } else {
                    (before, after)
                };
                let (before, after) = (points(&before), points(&after));
                let off = |k: usize| verdict(&after[k..=k], &before[k..=k], false) != "same";
                if before.len() != after.len() || (0..before.len()).any(off) {
                    wrong.push(format!("{name}: it shows something else"));
                }
            }
            // Pictures that are not at hand.
            (Some(Err(_)), Some(Err(_))) => {}
            _ => wrong.push(format!("{name}: what checks does not check again")),
        }
    }
    if asked("MIPLESS_REPORT") {
        println!(
            "mtlx: {count} documents are written, {} not as they were",
            wrong.len()
        );
    }
    if wrong.is_empty() {
        return Ok(());
    }
    Err(wrong.join("\n").into())
}

/// The components of all outputs at the points of the references.
fn points(texture: &Texture) -> Vec<Vec<f32>> {
    let options = Options {
        method: Method::Point,
        ..Options::default()
    };
    texture.evaluator(&options).evaluate(&footprints())
}
