//! `trade`: error against cost of every method, on one graph and this machine.

use crate::mistake::Mistake;
use crate::plan;
use crate::report::Report;
use crate::scene;
use crate::sources::Sources;
use clap::Args;
use mipless::Method;
use mipless_graph::CheckOptions;
use mipless_runtime::chart::{Chart, Mark, draw};
use mipless_runtime::device::Device;
use mipless_runtime::image_file::{Bits, Format, Space, encode, write_all};
use mipless_runtime::plan::{Measurement, TRUTH, front};
use mipless_runtime::view::Size;
use serde_json::{Value, json};
use std::fs;
use std::path::PathBuf;

/// The arguments of `trade`.
#[derive(Args, Debug)]
pub(crate) struct Arguments {
    /// The graph, a JSON file; `-` is standard input
    #[arg(value_name = "GRAPH")]
    graph: PathBuf,

    #[command(flatten)]
    scene: scene::Arguments,

    /// The folder for trade.json and trade.png; it is made if it does not exist
    #[arg(short, long, value_name = "DIR")]
    out: PathBuf,
}

/// Every method.
const METHODS: [Method; 14] = [
    Method::Point,
    Method::Naive,
    Method::Ensemble,
    Method::Local,
    Method::Quad,
    Method::Auto,
    Method::Split(4),
    Method::Split(7),
    Method::Split(16),
    Method::Supersample(4),
    Method::Supersample(16),
    Method::Supersample(64),
    Method::Supersample(256),
    Method::Supersample(1024),
];

/// Pixels over which errors are measured.
const PIXELS: usize = 80 * 48;

/// Measures, draws and writes.
pub(crate) fn run(arguments: &Arguments, report: &mut Report) -> Result<(), Mistake> {
    let out = &arguments.out;
    if out.exists() && !out.is_dir() {
        let message = format!("{}: it is no folder", out.display());
        return Err(Mistake::usage("unwritable-file", message));
    }
    let default = Size::new(1280, 720);
    let scene =
        arguments
            .scene
            .open(&arguments.graph, &CheckOptions::default(), default, report)?;
    scene.needs_part()?;
    let (data, picture) = (out.join("trade.json"), out.join("trade.png"));
    let mut read = Sources::default();
    read.add_graph(&arguments.graph, &scene.texture);
    [&data, &picture]
        .into_iter()
        .try_for_each(|file| read.guard(file))?;
    let measured = plan::measured(&scene, &METHODS, PIXELS, report)?;
    let floor = measured.noise_floor;
    let best = front(&measured.methods);

    let methods: Vec<Value> = (measured.methods.iter().zip(&best))
        .map(|(m, best)| {
            json!({
                "method": m.method.to_string(),
                "error": m.error,
                "cost": m.cost,
                "seconds": m.seconds * 1e6,
                "pareto": best,
            })
        })
        .collect();
    let runs_on = match &scene.device {
        Device::Gpu(_) => scene.device.to_string(),
        Device::Cpu => "CPU (1 thread)".to_owned(),
    };
    let name = &scene.texture.checked().graph().name;
    let found = json!({
        "graph": name,
        "output": scene.output_name(),
        "view": scene.view.name(),
        "size": [scene.size.width, scene.size.height],
        "pixel_filter": scene.filter.to_string(),
        "device": runs_on,
        "truth": TRUTH.to_string(),
        "error_unit": "sRGB, clamped, root mean square",
        "cost_unit": "times the cost of point",
        "seconds_for": "a million pixels",
        "pixels": measured.pixels,
        "noise_floor": floor,
        "methods": methods,
    });

    let mark = |(m, best): (&Measurement, &bool)| Mark {
        label: m.method.to_string(),
        x: m.cost,
        y: m.error,
        best: *best,
    };
    let marks: Vec<Mark> = measured.methods.iter().zip(&best).map(mark).collect();
    let chart = draw(&Chart {
        title: &format!("{name}: {} view, {runs_on}", scene.view.name()),
        x: "cost, times point",
        y: "error, sRGB RMS",
        floor,
        marks: &marks,
    });
    let unwritable = |error: &dyn std::fmt::Display| Mistake::usage("unwritable-file", error);
    let bytes = encode(&picture, &chart, Format::Png(Bits::Eight, Space::Srgb))
        .map_err(|e| unwritable(&e))?;
    let files = [
        (data, format!("{found:#}\n").into_bytes()),
        (picture, bytes),
    ];
    fs::create_dir_all(out)
        .map_err(|error| unwritable(&format_args!("{}: {error}", out.display())))?;
    write_all(&files).map_err(|e| unwritable(&e))?;

    if !report.is_json() {
        report.print(table(&measured.methods, &best));
    }
    let names: Vec<String> = files
        .iter()
        .map(|(path, _)| path.display().to_string())
        .collect();
    report.note(format_args!(
        "{}: {runs_on}, noise floor {floor:.5}",
        names.join(", ")
    ));
    report.result("files", names);
    report.result("trade", found);
    Ok(())
}

/// The table for people.
fn table(methods: &[Measurement], best: &[bool]) -> String {
    let mut text = format!(
        "{:<18}{:>10}{:>12}{:>14}\n",
        "method", "error", "cost", "s/megapixel"
    );
    for (m, best) in methods.iter().zip(best) {
        let star = if *best { "  best at its cost" } else { "" };
        text += &format!(
            "{:<18}{:>10.5}{:>10.1} ×{:>14.4}{star}\n",
            m.method.to_string(),
            m.error,
            m.cost,
            m.seconds * 1e6
        );
    }
    text
}
