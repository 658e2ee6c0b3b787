//! One source's table: errors by size and shape, with the targets beside.

use crate::footprint::{SHAPES, SIZES, Shape, footprint, places};
use crate::truth::{Moments, evaluator, moments, truth};
use mipless::{Method, Texture};

/// The columns of the standard deviation.
const METHODS: [Method; 3] = [Method::Ensemble, Method::Local, Method::Quad];

/// Errors: of the mean in standard deviations of the noise (root mean square), and of the local
/// standard deviation by `ensemble`, `local` and `quad`, relative to its mean.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Errors {
    pub(crate) mean: f64,
    pub(crate) deviation: [f64; 3],
}

/// The largest errors wanted; `None` where nothing is asked.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Target {
    pub(crate) mean: Option<f64>,
    pub(crate) local: Option<f64>,
    pub(crate) quad: Option<f64>,
}

/// A source of detail to measure.
pub(crate) struct Source {
    /// What the table is called.
    pub(crate) name: &'static str,
    /// A graph whose only output is the source.
    pub(crate) graph: String,
    /// The wavelength of its dominant detail, in uv.
    pub(crate) wavelength: f64,
    /// Its standard deviation over the plane.
    pub(crate) sd: f64,
    /// The shortest period in it, in wavelengths.
    pub(crate) finest: f64,
    /// At how many places it is measured, over a square of `extent` wavelengths.
    pub(crate) places: usize,
    pub(crate) extent: f64,
    /// What is wanted at a size (in wavelengths) and a shape.
    pub(crate) target: fn(f64, Shape) -> Target,
}

/// The graph of one node, `inputs` being the members of its JSON object.
pub(crate) fn graph(node: &str, inputs: &str) -> String {
    format!(
        r#"{{"version":1,"name":"source","nodes":{{"n":{{"type":"{node}","inputs":{{{inputs}}}}}}},"outputs":{{"out":{{"node":"n"}}}}}}"#
    )
}

/// The errors at one size and shape, and the mean of the true standard deviation.
pub(crate) fn errors(source: &Source, texture: &Texture, size: f64, shape: Shape) -> (Errors, f64) {
    let axes = shape.axes(size * source.wavelength);
    let places = places(source.places, source.extent * source.wavelength);
    let point = evaluator(texture, Method::Point);
    let finest = source.finest * source.wavelength;
    let truths = truth(&point, &places, axes, finest);
    let footprints: Vec<_> = places.iter().map(|&at| footprint(at, axes)).collect();
    let n = places.len() as f64;
    let sd = truths.iter().map(|t| t[1].sqrt()).sum::<f64>() / n;
    let of = |method| moments(&evaluator(texture, method), &footprints);
    let found = METHODS.map(of);
    let off = |values: &[Moments]| {
        let pairs = values.iter().zip(&truths);
        pairs
            .map(|(v, t)| (v[1].sqrt() - t[1].sqrt()).abs())
            .sum::<f64>()
            / n
            / sd
    };
    let square = |(v, t): (&Moments, &Moments)| (v[0] - t[0]).powi(2);
    let mean = found[1].iter().zip(&truths).map(square).sum::<f64>() / n;
    let errors = Errors {
        mean: mean.sqrt() / source.sd,
        deviation: [0, 1, 2].map(|i| off(&found[i])),
    };
    (errors, sd)
}

/// A figure, bold where it is above what is wanted.
fn figure(value: f64, wanted: Option<f64>) -> String {
    // Three digits after the point are printed: what rounds to the target meets it.
    match wanted {
        Some(wanted) if value > wanted + 5e-4 => format!("**{value:.3}**"),
        _ => format!("{value:.3}"),
    }
}

fn wanted(target: Target) -> String {
    [target.mean, target.local, target.quad]
        .map(|t| t.map_or("–".to_owned(), |t| format!("{t}")))
        .join(" / ")
}

/// Measures the source and prints its table.
pub(crate) fn print(source: &Source) {
    let texture = Texture::from_json(&source.graph)
        .unwrap_or_else(|mistakes| panic!("{}: {mistakes:#?}", source.name));
    println!("### {}\n", source.name);
    println!("mean error, noise sd / relative error of the local sd: ensemble / local / quad\n");
    print!("| s, wavelengths |");
    for shape in SHAPES {
        if shape.is_round() {
            print!(" round |");
        } else {
            print!(" {}:1 at {}° |", shape.ratio, shape.degrees);
        }
    }
    println!(" target mean / local / quad, round | 8:1 |");
    println!("|---|{}", "---|".repeat(SHAPES.len() + 2));
    for size in SIZES {
        print!("| {size} |");
        for shape in SHAPES {
            let (found, _) = errors(source, &texture, size, shape);
            let target = (source.target)(size, shape);
            print!(
                " {} / {:.3} / {} / {} |",
                figure(found.mean, target.mean),
                found.deviation[0],
                figure(found.deviation[1], target.local),
                figure(found.deviation[2], target.quad)
            );
        }
        let targets = [SHAPES[0], SHAPES[1]].map(|shape| wanted((source.target)(size, shape)));
        println!(" {} | {} |", targets[0], targets[1]);
    }
    println!();
}
