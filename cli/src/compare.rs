//! `compare`: point sampling, mipless and the truth side by side.

use crate::mistake::Mistake;
use crate::plan;
use crate::progress;
use crate::report::Report;
use crate::scene::{self, Scene, writable};
use crate::sources::Sources;
use clap::Args;
use mipless::Method;
use mipless_graph::CheckOptions;
use mipless_runtime::compare::{Panel, compose};
use mipless_runtime::image::Image;
use mipless_runtime::image_file::{Bits, Format, Space, encode, write_all};
use mipless_runtime::lit::{Halves, Hiding, Lit};
use mipless_runtime::metrics::display_difference;
use mipless_runtime::plan::TRUTH;
use mipless_runtime::view::Size;
use serde_json::json;
use std::path::PathBuf;

/// The arguments of `compare`.
#[derive(Args, Debug)]
pub(crate) struct Arguments {
    /// The graph, a JSON file; `-` is standard input
    #[arg(value_name = "GRAPH")]
    graph: PathBuf,

    #[command(flatten)]
    scene: scene::Arguments,

    /// The picture, a .png
    #[arg(short, long, value_name = "FILE.png")]
    out: PathBuf,

    /// How many points of a pixel the truth of a lit material shades
    #[arg(long, value_name = "N", default_value_t = 256,
        value_parser = clap::value_parser!(u32).range(2..=65536))]
    samples: u32,
}

/// Pixels over which the truth's own error is measured.
const PIXELS: usize = 400;

/// One column: what it shows, what it is called, its error.
type Column = (Image, String, f64);

/// Evaluates, measures and writes.
pub(crate) fn run(arguments: &Arguments, report: &mut Report) -> Result<(), Mistake> {
    let refused = |error| Mistake::usage("usage", error);
    let format = Format::of(&arguments.out, Bits::Eight, Space::Srgb).map_err(refused)?;
    writable(&arguments.out)?;
    let default = Size::new(480, 270);
    let mut scene =
        arguments
            .scene
            .open(&arguments.graph, &CheckOptions::default(), default, report)?;
    let mut read = Sources::default();
    read.add_graph(&arguments.graph, &scene.texture);
    read.guard(&arguments.out)?;

    let (panels, results) = match scene.lit(Hiding::Nothing) {
        Some(lit) => lit_columns(&mut scene, &lit, arguments.samples, report)?,
        None => columns(&mut scene, report)?,
    };
    let (truth, noise_floor) = (panels[2].1.clone(), panels[2].2);
    let details: Vec<String> = panels.iter().map(|p| format!("error {:.4}", p.2)).collect();
    let panels: Vec<Panel<'_>> = (panels.iter().zip(&details))
        .map(|((image, title, _), detail)| Panel {
            image,
            title,
            detail,
        })
        .collect();
    let unwritable = |error| Mistake::usage("unwritable-file", error);
    let bytes = encode(&arguments.out, &compose(&panels), format).map_err(unwritable)?;
    write_all(&[(arguments.out.clone(), bytes)]).map_err(unwritable)?;

    let named = panels
        .iter()
        .map(|panel| format!("{} {}", panel.title, panel.detail));
    report.note(format_args!(
        "{}: {} (sRGB RMS), {}",
        arguments.out.display(),
        named.collect::<Vec<_>>().join(", "),
        scene.device
    ));
    report.result("files", vec![arguments.out.display().to_string()]);
    report.result("methods", results);
    report.result("truth", truth);
    report.result("noise_floor", noise_floor);
    report.result("device", scene.device.to_string());
    Ok(())
}

/// `point`, `auto` and the truth of an output, with the errors of the first two.
fn columns(
    scene: &mut Scene,
    report: &mut Report,
) -> Result<(Vec<Column>, Vec<serde_json::Value>), Mistake> {
    // The other methods do not sample, so that they share no points with the truth.
    let truth = scene.evaluate(&scene.options(TRUTH), report)?;
    let noise_floor = plan::measured(scene, &[], PIXELS, report)?.noise_floor;
    // The measured truth has twice as many points.
    let noise_floor = noise_floor * std::f64::consts::SQRT_2;
    let mut images = Vec::new();
    for method in [Method::Point, Method::Auto] {
        let image = scene.evaluate(&scene.options(method), report)?;
        images.push((image, method.to_string()));
    }
    let name = format!("truth ({TRUTH})");
    Ok(measured(scene, images, (truth, name, noise_floor)))
}

/// The same of a lit material: points that a host shades, moments that `shade` does, and facets that are
/// shaded one by one. Nothing hides anything in any of them.
fn lit_columns(
    scene: &mut Scene,
    lit: &Lit,
    samples: u32,
    report: &mut Report,
) -> Result<(Vec<Column>, Vec<serde_json::Value>), Mistake> {
    let program = scene.texture.compile(&scene.options(Method::Point));
    let point = (&program, &scene.parameters[..]);
    let halves = progress::watch(report, "truth", |job| {
        lit.truth(point, scene.size, scene.filter, samples, job)
    });
    let halves = halves.map_err(|error| Mistake::usage("render-failed", error))?;
    let mask = scene.view.mask(scene.size);
    let Halves([first, second]) = &halves;
    let noise_floor = 0.5 * display_difference(first, second, Some(&mask)).rms;
    let mut images = Vec::new();
    for (method, name) in [
        (Method::Point, "point, shaded by a host"),
        (Method::Auto, "auto, shade"),
    ] {
        let image = scene.evaluate_lit(&scene.options(method), lit, report)?;
        images.push((image, name.to_owned()));
    }
    let name = format!("truth ({samples} points, each shaded)");
    Ok(measured(scene, images, (halves.whole(), name, noise_floor)))
}

/// The errors of images against the truth, and all as people see them.
fn measured(
    scene: &Scene,
    images: Vec<(Image, String)>,
    (truth, name, noise_floor): (Image, String, f64),
) -> (Vec<Column>, Vec<serde_json::Value>) {
    let mask = scene.view.mask(scene.size);
    let mut columns = Vec::new();
    let mut results = Vec::new();
    for (image, name) in images {
        let error = display_difference(&image, &truth, Some(&mask)).rms;
        results.push(json!({ "method": name, "error": error }));
        columns.push((scene.present(&image), name, error));
    }
    columns.push((scene.present(&truth), name, noise_floor));
    (columns, results)
}
