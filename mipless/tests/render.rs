//! Pictures into buffers: tiles, coarse pictures, cancelling, and nodes of a tool's own.

use mipless::conformance::{self, Law};
use mipless::define::*;
use mipless::render::{Flat, Footprints, Job, Picture, Plane, RenderError, Size, View};
use mipless::{Footprint, Options, Texture, TextureEvaluator};
use std::sync::atomic::{AtomicBool, Ordering};

fn evaluator() -> TextureEvaluator {
    let texture = Texture::from_json(
        r#"{ "version": 1, "inputs": { "scale": { "type": "float", "value": 9, "min": 1, "max": 40 } },
            "nodes": { "n": { "type": "noise2d", "inputs": { "frequency": { "input": "scale" } } },
                       "uv": { "type": "texcoord" } },
            "outputs": { "height": { "node": "n" }, "place": { "node": "uv" } } }"#,
    )
    .expect("no mistakes");
    texture.evaluator(&Options {
        method: mipless::Method::Local,
        ..Options::default()
    })
}

#[test]
fn a_picture_is_what_its_footprints_are_and_tiles_are_parts_of_it() {
    let mut evaluator = evaluator();
    let names: Vec<String> = evaluator
        .channels()
        .iter()
        .map(ToString::to_string)
        .collect();
    assert_eq!(names, ["height", "place.X", "place.Y"]);
    let view = View::Plane(Plane::default());
    let size = Size::new(37, 21);
    let picture = Picture::of_view(&view, size);
    let mut whole = vec![7.0; picture.numbers(&evaluator)];
    evaluator
        .render(&picture, &mut whole, Job::default())
        .expect("a picture");
    for index in 0..size.pixels() {
        let pixel = &whole[3 * index..3 * index + 3];
        match view.footprint(size, index) {
            None => assert_eq!(pixel, [0.0; 3]),
            Some(footprint) => {
                let values = evaluator.evaluate(&[footprint]);
                assert_eq!(pixel, [values[0][0], values[1][0], values[2][0]]);
            }
        }
    }
    let tile = picture.tile([5, 9], Size::new(20, 12));
    let mut part = vec![0.0; tile.numbers(&evaluator)];
    evaluator
        .render(&tile, &mut part, Job::default())
        .expect("a picture");
    for row in 0..12 {
        let from = 3 * ((row + 9) * 37 + 5);
        assert_eq!(part[60 * row..60 * (row + 1)], whole[from..from + 60]);
    }
    let short = evaluator.render(&tile, &mut part[1..], Job::default());
    assert_eq!(
        short,
        Err(RenderError::Buffer {
            expected: 720,
            given: 719
        })
    );
}

#[test]
fn coarse_pictures_come_first_and_are_filtered_and_inputs_have_handles() {
    let mut evaluator = evaluator();
    let scale = evaluator.input("scale").expect("an input");
    assert!(evaluator.set_input(scale, &[50.0]).is_err());
    evaluator.set_input(scale, &[12.0]).expect("in its range");
    let view = View::Flat(Flat {
        window: [0.0, 0.0, 1.0, 1.0],
    });
    let picture = Picture::of_view(&view, Size::new(30, 20));
    let mut pixels = vec![0.0; picture.numbers(&evaluator)];
    let mut passes = Vec::new();
    let mut progress = |block: u32, pixels: &[f32]| passes.push((block, pixels.to_vec()));
    let job = Job {
        blocks: &[8, 3],
        progress: Some(&mut progress),
        ..Job::default()
    };
    evaluator
        .render(&picture, &mut pixels, job)
        .expect("a picture");
    assert_eq!(
        passes.iter().map(|(block, _)| *block).collect::<Vec<_>>(),
        [8, 3, 1]
    );
    assert_eq!(passes[2].1, pixels);
    // The block around (4, 4) is a pixel of eight times the size.
    let wide = Footprint {
        uv: [4.0 / 30.0, 4.0 / 20.0],
        du: [8.0 / 30.0, 0.0],
        dv: [0.0, 8.0 / 20.0],
        ..Footprint::default()
    };
    let value = evaluator.evaluate(&[wide])[0][0];
    assert!((passes[0].1[0] - value).abs() < 1e-5);
    assert_eq!(passes[0].1[0], passes[0].1[3 * (7 * 30 + 7)]);
}

#[test]
fn a_picture_is_cancelled_and_grids_are_functions() {
    let evaluator = evaluator();
    let cancel = AtomicBool::new(false);
    let asked = std::sync::atomic::AtomicUsize::new(0);
    let grid = Footprints(|[x, y]: [f64; 2]| {
        if asked.fetch_add(1, Ordering::Relaxed) > 500 {
            cancel.store(true, Ordering::Relaxed);
        }
        Some(Footprint::point([x, y]))
    });
    let picture = Picture::of_grid(grid, Size::new(500, 500));
    let mut pixels = vec![0.0; picture.numbers(&evaluator)];
    let job = Job {
        cancel: Some(&cancel),
        ..Job::default()
    };
    assert_eq!(
        evaluator.render(&picture, &mut pixels, job),
        Err(RenderError::Cancelled)
    );
    assert!(asked.load(Ordering::Relaxed) < 20_000);
}

static INPUTS: &[PortSpec] = &[PortSpec::new(
    "in",
    PortType::Any,
    Default::Float(0.0),
    "The signal.",
)];

const fn spec(name: &'static str) -> NodeSpec {
    NodeSpec {
        name,
        aliases: &[],
        category: Category::Transfer,
        summary: "A square, or what is meant for one.",
        doc: Doc {
            computes: "out = in².",
            statistics: "A product.",
            accuracy: "Exact.",
            references: "Isserlis 1918.",
        },
        inputs: INPUTS,
        output: OutputType::Widest,
        reach: |_| Reach::ANY,
        class: |_| Behaviour::Function,
        example: r#"{ "version": 1, "name": "n", "nodes": { "n": { "type": "noise2d" } },
            "outputs": { "out": { "node": "n" } } }"#,
    }
}

static RIGHT: NodeSpec = spec("acme_square");
static WRONG: NodeSpec = spec("acme_wrong");

fn right<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let signals = lower.bundle(node, "in");
    let square = |signal: &Signal<'b>| {
        let signal = lower.algebra.expose(signal);
        lower.algebra.product(&signal, &signal)
    };
    signals.iter().map(square).collect()
}

/// A square of which the variance counts twice.
fn wrong<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let signals = lower.bundle(node, "in");
    let square = |signal: &Signal<'b>| {
        let signal = lower.algebra.expose(signal);
        let more = signal.variance();
        lower.algebra.product(&signal, &signal).offset(more)
    };
    signals.iter().map(square).collect()
}

/// A square of a signal that does not know that it is itself: its own variance is private to each reader.
fn unshared<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let signals = lower.bundle(node, "in");
    let square = |signal: &Signal<'b>| lower.algebra.product(signal, signal);
    signals.iter().map(square).collect()
}

#[test]
fn conformance_says_which_law_a_node_breaks() {
    let found = conformance::check(&NodeDef::new(&RIGHT, right));
    assert!(found.is_empty(), "{}", found[0]);
    let found = conformance::check(&NodeDef::new(&WRONG, wrong));
    assert!(
        found.iter().any(|breach| breach.violation.law == Law::Heat),
        "{found:?}"
    );
    let found = conformance::check(&NodeDef::new(&WRONG, unshared));
    assert!(
        found.iter().any(|breach| breach.violation.law == Law::Heat),
        "{found:?}"
    );
    let taken = NodeDef::new(&TAKEN, right);
    assert!(
        conformance::check(&taken)[0]
            .violation
            .what
            .contains("already")
    );
}

static TAKEN: NodeSpec = spec("absval");
