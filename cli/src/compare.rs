//! `compare`: point sampling, mipless and the truth side by side.

use crate::mistake::Mistake;
use crate::plan;
use crate::report::Report;
use crate::scene::{self, writable};
use crate::sources::Sources;
use clap::Args;
use mipless::{Method, Options};
use mipless_graph::CheckOptions;
use mipless_runtime::compare::{Panel, compose};
use mipless_runtime::image_file::{Bits, Format, encode, write_all};
use mipless_runtime::metrics::display_difference;
use mipless_runtime::plan::TRUTH;
use mipless_runtime::view::Size;
use serde_json::json;
use std::path::PathBuf;

/// The arguments of `compare`.
#[derive(Args, Debug)]
pub(crate) struct Arguments {
    #[command(flatten)]
    scene: scene::Arguments,

    /// The picture, a .png
    #[arg(short, long, value_name = "FILE.png")]
    out: PathBuf,
}

/// Pixels over which the truth's own error is measured.
const PIXELS: usize = 400;

/// Evaluates, measures and writes.
pub(crate) fn run(arguments: &Arguments, report: &mut Report) -> Result<(), Mistake> {
    let refused = |error| Mistake::usage("usage", error);
    let format = Format::of(&arguments.out, Bits::Eight).map_err(refused)?;
    writable(&arguments.out)?;
    let default = Size::new(480, 270);
    let mut scene = arguments
        .scene
        .open(&CheckOptions::default(), default, report)?;
    let mut read = Sources::default();
    read.add_graph(&arguments.scene.graph, &scene.texture);
    read.guard(&arguments.out)?;

    // The other methods do not sample, so that they share no points with the truth.
    let truth = scene.evaluate(&scene.options(TRUTH), report)?.mean;
    let noise_floor = plan::measured(&scene, &[], PIXELS, report)?.noise_floor;
    // The measured truth has twice as many points.
    let noise_floor = noise_floor * std::f64::consts::SQRT_2;
    let mask = scene.view.mask(scene.size);
    let mut panels = Vec::new();
    let mut results = Vec::new();
    for method in [Method::Point, Method::Auto] {
        let options: Options = scene.options(method);
        let image = scene.evaluate(&options, report)?.mean;
        let error = display_difference(&image, &truth, Some(&mask));
        results.push(json!({ "method": method.to_string(), "error": error.rms }));
        panels.push((scene.view.present(&image), method.to_string(), error.rms));
    }
    panels.push((
        scene.view.present(&truth),
        format!("truth ({TRUTH})"),
        noise_floor,
    ));
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
    report.result("truth", TRUTH.to_string());
    report.result("noise_floor", noise_floor);
    report.result("device", scene.device.to_string());
    Ok(())
}
