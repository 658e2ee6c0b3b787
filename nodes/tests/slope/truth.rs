//! Slope statistics over footprints by dense sums of finite differences of the point function.

use mipless_codegen::cpu::{Footprint, eval_program};
use mipless_codegen::ir::Program;
use mipless_codegen::{Method, Options, PixelFilter, compile};
use mipless_graph::{CheckOptions, check, load};
use serde_json::{Value, json};

/// A height, and the graph of its slopes: both components, and their sum.
pub(crate) struct Graph {
    height: Value,
    slopes: Value,
}

impl Graph {
    /// Of nodes of which one is named `height`.
    pub(crate) fn of_height(nodes: &Value) -> Self {
        let mut with = nodes.clone();
        let component = |name: &str| json!({ "node": "separate", "output": name });
        with["slope"] = json!({ "type": "slope", "inputs": { "in": { "node": "height" } } });
        with["separate"] = json!({ "type": "separate2", "inputs": { "in": { "node": "slope" } } });
        let both = json!({ "in1": component("outx"), "in2": component("outy") });
        with["sum"] = json!({ "type": "add", "inputs": both });
        Self {
            height: document(nodes, &["height"]),
            slopes: document(&with, &["slope", "sum"]),
        }
    }
}

fn document(nodes: &Value, outputs: &[&str]) -> Value {
    let mut document = json!({ "version": 1, "name": "height", "nodes": nodes, "outputs": {} });
    for name in outputs {
        document["outputs"][format!("out_{name}")] = json!({ "node": name });
    }
    document
}

fn compiled(document: &Value, method: Method, filter: PixelFilter) -> Program {
    let catalogue = mipless_nodes::catalogue();
    let specs: Vec<_> = catalogue.iter().map(|d| d.spec).collect();
    let loaded = load(&document.to_string(), &specs);
    let graph = (loaded.graph).unwrap_or_else(|| panic!("{:?}", loaded.diagnostics));
    let checked = check(graph, &CheckOptions::default()).expect("checks");
    let options = Options {
        method,
        filter,
        moments: true,
        seed: 0,
    };
    compile(&checked, catalogue, &options)
}

/// A footprint: the shorter axis in uv, and how much longer the other one is.
pub(crate) struct Size {
    pub(crate) minor: f64,
    pub(crate) ratio: f64,
    /// The finest wavelength of the height.
    pub(crate) finest: f64,
}

impl Size {
    /// How far apart the points of a finite difference are, in uv: a power of 2, which adds to places
    /// without rounding. Closer ones would see the jumps of unfiltered noises at the lattice, where
    /// kernels end.
    fn step(&self) -> f32 {
        ((self.finest / 160.0).log2().floor() as f32).exp2()
    }

    /// The axes, askew.
    fn axes(&self) -> [[f64; 2]; 2] {
        let (sin, cos) = 0.4f64.sin_cos();
        let major = self.minor * self.ratio;
        [
            [major * cos, major * sin],
            [-self.minor * sin, self.minor * cos],
        ]
    }
}

/// What is wrong with the slopes of a footprint, on average over places.
pub(crate) struct Found {
    /// The root mean square error of the mean slopes, over the root of the slopes' whole variance.
    pub(crate) mean: f64,
    /// tr S over the truth's, less 1.
    pub(crate) bias: f64,
    /// The ratio of the roots of S's eigenvalues, smaller over larger, less the truth's.
    pub(crate) axes: f64,
}

/// How many places, and how many points in each footprint.
const PLACES: usize = 240;
const POINTS: usize = 240;

fn footprint(at: [f64; 2], axes: [[f64; 2]; 2]) -> Footprint {
    let fraction = |x: f64| {
        // A multiple of 2⁻²⁴ below 1, to which steps add exactly.
        let grid = 16_777_216.0;
        (((x - x.floor()) * grid).floor() / grid) as f32
    };
    Footprint {
        cell: at.map(|x| x.floor() as i32),
        uv: at.map(fraction),
        du: axes[0].map(|x| x as f32),
        dv: axes[1].map(|x| x as f32),
    }
}

/// The same place, so far away.
fn moved(from: Footprint, by: [f32; 2]) -> Footprint {
    let uv = [0, 1].map(|k| from.uv[k] + by[k]);
    Footprint {
        cell: [0, 1].map(|k| from.cell[k] + uv[k].floor() as i32),
        uv: uv.map(|x| x - x.floor()),
        ..from
    }
}

/// A standard normal pair by the R2 sequence (Roberts 2018) and Box & Muller, each place turned.
fn deviate(place: usize, point: usize) -> [f64; 2] {
    let turn = |step: f64, k: usize| (k as f64 * step).fract();
    let x = (turn(0.754_877_666_246_692_7, point + 1) + turn(0.618_033_988_749_895, place)).fract();
    let y = (turn(0.569_840_290_998_053_3, point + 1) + turn(0.414_213_562_373_095, place)).fract();
    let radius = (-2.0 * (1.0 - x).ln()).sqrt();
    let (sin, cos) = (std::f64::consts::TAU * y).sin_cos();
    [radius * cos, radius * sin]
}

/// Means of u, v, uu, uv, vv.
#[derive(Clone, Copy, Default)]
struct Moments([f64; 5]);

impl Moments {
    fn add(&mut self, [u, v]: [f64; 2]) {
        for (sum, term) in self.0.iter_mut().zip([u, v, u * u, u * v, v * v]) {
            *sum += term;
        }
    }

    fn covariance(&self, count: f64) -> [f64; 3] {
        let [u, v, uu, uv, vv] = self.0.map(|sum| sum / count);
        // Of points in place of an integral.
        let whole = count / (count - 1.0);
        [uu - u * u, uv - u * v, vv - v * v].map(|part| part * whole)
    }
}

/// The slopes of a method against the truth.
pub(crate) fn compared(graph: &Graph, method: Method, size: &Size) -> Found {
    let axes = size.axes();
    let places: Vec<[f64; 2]> = (0..PLACES)
        .map(|i| {
            [0.754_877_666_246_692_7, 0.569_840_290_998_053_3]
                .map(|step| (i as f64 * step).fract() * 60.0 + 3.0)
        })
        .collect();
    let truths = truth(&graph.height, &places, axes, size.step());

    let program = compiled(&graph.slopes, method, PixelFilter::Gaussian(1.0));
    let footprints: Vec<Footprint> = places.iter().map(|&at| footprint(at, axes)).collect();
    let out = eval_program::<f32>(&program, &footprints, &[]);
    let (mut own, mut wanted) = ([0.0; 3], [0.0; 3]);
    let (mut off, mut whole) = (0.0, 0.0);
    for (i, moments) in truths.iter().enumerate() {
        let at = |k: usize| f64::from(out[k][i]);
        let [uu, vv] = [at(3), at(4)];
        let uv = 0.5 * (at(5) - uu - vv);
        let truth = moments.covariance(POINTS as f64);
        for ((own, wanted), (a, b)) in
            (own.iter_mut().zip(&mut wanted)).zip([uu, uv, vv].into_iter().zip(truth))
        {
            *own += a;
            *wanted += b;
        }
        let n = POINTS as f64;
        // The truth's own noise is not the method's.
        let noise = (truth[0] + truth[2]) / n;
        off += (at(0) - moments.0[0] / n).powi(2) + (at(1) - moments.0[1] / n).powi(2) - noise;
        whole += (moments.0[2] + moments.0[4]) / n;
    }
    Found {
        mean: (off.max(0.0) / whole).sqrt(),
        bias: (own[0] + own[2]) / (wanted[0] + wanted[2]) - 1.0,
        axes: shape(own) - shape(wanted),
    }
}

/// The ratio of the roots of the eigenvalues, the smaller over the larger.
fn shape([uu, uv, vv]: [f64; 3]) -> f64 {
    let (middle, tilt) = (0.5 * (uu + vv), 0.5 * (uu - vv));
    let root = tilt.hypot(uv);
    ((middle - root).max(0.0) / (middle + root)).sqrt()
}

/// The moments of the slopes over footprints at places, by finite differences at points.
fn truth(height: &Value, places: &[[f64; 2]], axes: [[f64; 2]; 2], step: f32) -> Vec<Moments> {
    let program = compiled(height, Method::Point, PixelFilter::Gaussian(1.0));
    let none = [[0.0; 2]; 2];
    places
        .iter()
        .enumerate()
        .map(|(place, at)| {
            let mut points = Vec::with_capacity(4 * POINTS);
            for point in 0..POINTS {
                let [y, z] = deviate(place, point);
                let p = [0, 1].map(|k| at[k] + axes[0][k] * y + axes[1][k] * z);
                let middle = footprint(p, none);
                for [du, dv] in [[step, 0.0], [-step, 0.0], [0.0, step], [0.0, -step]] {
                    points.push(moved(middle, [du, dv]));
                }
            }
            let values = &eval_program::<f64>(&program, &points, &[])[0];
            let mut moments = Moments::default();
            for rows in values.chunks(4) {
                let by = 0.5 / f64::from(step);
                let of = |k: usize| (rows[k] - rows[k + 1]) * by;
                moments.add([of(0), of(2)]);
            }
            moments
        })
        .collect()
}

/// The mean of a frame of 32 × 32 pixels that looks at 16 × 16 uv flat.
pub(crate) fn frame_mean(nodes: &Value, output: &str) -> f64 {
    let program = compiled(
        &document(nodes, &[output]),
        Method::Local,
        PixelFilter::default(),
    );
    let pixel = 16.0 / 32.0;
    let footprints: Vec<Footprint> = (0..32 * 32)
        .map(|i| {
            let at = [i % 32, i / 32].map(|k| (f64::from(k) + 0.5) * pixel);
            footprint(at, [[pixel, 0.0], [0.0, pixel]])
        })
        .collect();
    let out = eval_program::<f32>(&program, &footprints, &[]);
    out[0].iter().map(|&x| f64::from(x)).sum::<f64>() / (32.0 * 32.0)
}
