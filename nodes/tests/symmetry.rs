//! No lattice of random numbers knows the origin, an axis or a seed: every node with a seed, with
//! each of its choices, is uncorrelated with its reflections and with itself further on.

use mipless_codegen::cpu::{Evaluator, Footprint, Position, Scratch};
use mipless_codegen::{Method, Options, PixelFilter, compile};
use mipless_graph::{CheckOptions, NodeSpec, PortType, check, load};

/// Nodes with a seed whose detail is no lattice of random numbers, and why.
const NO_LATTICE: [(&str, &str); 3] = [
    (
        "spectralnoise2d",
        "a few waves, whose phases meet their reflections' by chance",
    ),
    ("byexample", "shows the same picture everywhere"),
    ("colormap2d", "a finite map of two signals"),
];

const SEEDS: [i32; 5] = [0, 1, 7, 12_345, -1];

/// The seed that every other one is compared with: in the difference of two seeds nothing is left of
/// what is not random, such as the joints of a wall.
const REFERENCE: i32 = 271_828;

/// A correlation beyond so many of its standard deviations is no chance. Of 3000 places that are all
/// random it is one of 0.1; of a source that is 0 at many of them, as the difference of two tilings is, of
/// fewer places.
const DEVIATIONS: f64 = 5.5;

type Point = [f64; 3];

/// Places within 48 units of the origin, by a sequence of low discrepancy.
fn places() -> Vec<Point> {
    let place = |i: usize| {
        [0.819_172_513_4, 0.671_043_606_7, 0.549_700_477_9]
            .map(|step: f64| ((i as f64 + 0.5) * step).fract() * 96.0 - 48.0)
    };
    (0..3000).map(place).collect()
}

/// A name, and where it takes a point.
type Isometry = (String, Box<dyn Fn(Point) -> Point>);

/// The isometries that a lattice might be symmetric under.
fn isometries(axes: usize) -> Vec<Isometry> {
    let named = |name: &str, f: fn(Point) -> Point| {
        let f: Box<dyn Fn(Point) -> Point> = Box::new(f);
        (name.to_owned(), f)
    };
    let mut all = vec![
        named("point reflection", |p| p.map(|x| -x)),
        named("mirror image along x", |[x, y, z]| [-x, y, z]),
        named("mirror image along y", |[x, y, z]| [x, -y, z]),
        named("mirror image along z", |[x, y, z]| [x, y, -z]),
        named("half turn", |[x, y, z]| [-x, -y, z]),
        named("quarter turn", |[x, y, z]| [-y, x, z]),
        named("transposition", |[x, y, z]| [y, x, z]),
        named("rotation of axes", |[x, y, z]| [y, z, x]),
    ];
    for exponent in [5, 8, 12, 16, 20, 24, 28] {
        let by = f64::from(1 << exponent);
        for direction in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0; 3]] {
            if exponent > 24 && (direction == [1.0; 3] || axes == 1) {
                // Askew, the lattices of gradient noise repeat sooner than along the axes: their pages
                // say so. The cells of numbers are 32 in a unit.
                continue;
            }
            let name = format!("shift by 2^{exponent} along {direction:?}");
            let f = move |p: Point| std::array::from_fn(|k| p[k] + by * direction[k]);
            all.push((name, Box::new(f)));
        }
    }
    all
}

/// How many coordinates move the node's output.
fn axes(spec: &NodeSpec) -> usize {
    match spec.input("in") {
        Some(_) => 1,
        None if spec.input("position").is_some() => 3,
        None => 2,
    }
}

/// A graph of the node with cells of one unit; of a function of numbers there are 32 in a unit along x.
fn graph(spec: &NodeSpec, inputs: &str, seed: i32) -> String {
    let place = match spec.input("frequency") {
        _ if axes(spec) == 1 => r#""in":{"node":"step"},"#,
        Some(_) => r#""frequency":1,"#,
        None => "",
    };
    format!(
        r#"{{"version":1,"name":"n","nodes":{{
            "uv":{{"type":"texcoord"}},
            "u":{{"type":"extract","inputs":{{"in":{{"node":"uv"}}}}}},
            "step":{{"type":"divide","inputs":{{"in1":{{"node":"u"}},"in2":128}}}},
            "n":{{"type":"{}","inputs":{{{place}{inputs}"seed":{seed}}}}}}},
            "outputs":{{"out":{{"node":"n"}}}}}}"#,
        spec.name
    )
}

/// The first component of a graph at places: those on the surface are x and y of those in space.
fn values(json: &str, places: &[Point]) -> Vec<f64> {
    let catalogue = mipless_nodes::catalogue();
    let specs: Vec<_> = catalogue.iter().map(|d| d.spec).collect();
    let loaded = load(json, &specs);
    let graph = loaded
        .graph
        .unwrap_or_else(|| panic!("{json}: {:?}", loaded.diagnostics));
    let checked = check(graph, &CheckOptions::default())
        .unwrap_or_else(|diagnostics| panic!("{json}: {diagnostics:?}"));
    let options = Options {
        method: Method::Point,
        filter: PixelFilter::Gaussian(1.0),
        moments: false,
        seed: 0,
    };
    let program = compile(&checked, catalogue, &options);
    let (footprints, positions): (Vec<_>, Vec<_>) = (places.iter())
        .map(|place| {
            let cell = place.map(|x| x.floor() as i32);
            let xyz = place.map(|x| (x - x.floor()) as f32);
            let footprint = Footprint {
                cell: [cell[0], cell[1]],
                uv: [xyz[0], xyz[1]],
                ..Footprint::default()
            };
            let position = Position {
                cell,
                xyz,
                ..Position::default()
            };
            (footprint, position)
        })
        .unzip();
    let mut out: Vec<Vec<f64>> = Vec::new();
    Evaluator::<f64>::of_program(&program).evaluate_surface(
        &mut Scratch::new(),
        &footprints,
        &positions,
        &[],
        &mut out,
    );
    out.swap_remove(0)
}

/// Pearson's correlation, and its standard deviation where the two are independent.
fn correlation(x: &[f64], y: &[f64]) -> [f64; 2] {
    let n = x.len() as f64;
    let [mean_x, mean_y] = [x, y].map(|x| x.iter().sum::<f64>() / n);
    let (mut xx, mut xy, mut yy, mut square) = (0.0, 0.0, 0.0, 0.0);
    for (x, y) in x.iter().zip(y) {
        let (x, y) = (x - mean_x, y - mean_y);
        (xx, xy, yy) = (xx + x * x, xy + x * y, yy + y * y);
        square += (x * y).powi(2);
    }
    [xy, square.sqrt()].map(|sum| sum / (xx * yy).sqrt())
}

/// The defaults, and each choice of each port alone.
fn variants(spec: &NodeSpec) -> Vec<String> {
    let mut variants = vec![String::new()];
    // How many components there are does not change the first, and MaterialX's hash is as it is.
    let fixed = ["signature", "hash"];
    let others = (spec.inputs.iter()).filter(|port| !fixed.contains(&port.name));
    for port in others {
        if let PortType::Choice(names) = port.ty {
            let chosen = |name: &&str| format!(r#""{}":"{name}","#, port.name);
            variants.extend(names.iter().map(chosen));
        }
    }
    variants
}

/// The places and their images, one after the other, for those that move `axes` coordinates.
fn images(axes: usize) -> (Vec<String>, Vec<Point>) {
    let places = places();
    let moves = |f: &dyn Fn(Point) -> Point| {
        // What only leaves the coordinates that count where they are is no test.
        let here = [1.0, 2.0, 3.0];
        f(here)[..axes] != here[..axes] && (axes == 3 || f(here)[..axes].iter().all(|x| *x != 3.0))
    };
    let (mut names, mut all) = (Vec::new(), places.clone());
    for (name, f) in isometries(axes) {
        if moves(&*f) {
            names.push(name);
            all.extend(places.iter().map(|&p| f(p)));
        }
    }
    (names, all)
}

#[test]
fn no_source_is_its_own_reflection_or_repeats_for_any_seed() {
    let sources = mipless_nodes::catalogue().iter().map(|d| d.spec);
    let mut count = 0;
    for spec in sources.filter(|spec| spec.input("seed").is_some()) {
        if NO_LATTICE.iter().any(|(name, _)| *name == spec.name) {
            continue;
        }
        let (names, places) = images(axes(spec));
        for variant in variants(spec) {
            let reference = values(&graph(spec, &variant, REFERENCE), &places);
            for seed in SEEDS {
                let mut random = values(&graph(spec, &variant, seed), &places);
                random.iter_mut().zip(&reference).for_each(|(x, y)| *x -= y);
                let mut each = random.chunks(random.len() / (names.len() + 1));
                let here = each.next().expect("the places themselves");
                if here.iter().all(|x| *x == 0.0) {
                    // This output is not random.
                    continue;
                }
                for (name, there) in names.iter().zip(each) {
                    let [r, deviation] = correlation(here, there);
                    assert!(
                        r.abs() < DEVIATIONS * deviation,
                        "{} {variant} seed {seed}: {name} has r = {r}",
                        spec.name
                    );
                    count += 1;
                }
            }
        }
    }
    println!("{count} correlations");
    assert!(count > 5000, "{count}");
}
