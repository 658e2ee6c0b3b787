//! The error that the check predicts for closing the moments, against rendered truth.
//!
//! For every graph in `graphs/` and a set of chains: the RMS of `local` over footprints from a
//! sixteenth of a wavelength to one, where filtering is hardest, against samples. `MIPLESS_LONG=1`
//! takes more pixels and more samples.

use mipless::{Footprint, Method, Options, Texture};
use mipless_tests::case::means;
use mipless_tests::{asked, root, tolerance};

/// The sizes of a pixel, in wavelengths.
const PIXELS: [f64; 3] = [0.0625, 0.25, 1.0];

/// Predicted: the largest error of the outputs.
fn predicted(texture: &Texture) -> f64 {
    let checked = texture.checked();
    let outputs = checked.graph().outputs.iter();
    let errors = outputs.map(|output| f64::from(checked.signal(output.node).error));
    errors.fold(0.0, f64::max)
}

/// Measured: the RMS over pixels, channels and [`PIXELS`] of values limited to [0, 1].
fn measured(texture: &Texture, wavelength: f64) -> f64 {
    let (count, samples) = if asked("MIPLESS_LONG") {
        (400, 512)
    } else {
        (150, 256)
    };
    let footprints: Vec<Footprint> = (0..3 * count)
        .map(|i| {
            let p = [0.754_877_666, 0.569_840_291]
                .map(|step: f64| (f64::from(i) * step).fract() * 80.0 * wavelength);
            let pixel = (PIXELS[i as usize % 3] * wavelength) as f32;
            Footprint {
                cell: p.map(|x| x.floor() as i32),
                uv: p.map(|x| x.fract() as f32),
                du: [pixel, 0.0],
                dv: [0.0, pixel],
            }
        })
        .collect();
    let run = |method| {
        let options = Options {
            method,
            ..Options::default()
        };
        texture.evaluator(&options).evaluate(&footprints).concat()
    };
    let (found, truth) = (run(Method::Local), run(Method::Supersample(samples)));
    let limited = |x: &f32| f64::from(x.clamp(0.0, 1.0));
    let squares = found.iter().zip(&truth);
    let sum: f64 = squares
        .map(|(f, t)| (limited(f) - limited(t)).powi(2))
        .sum();
    (sum / truth.len() as f64).sqrt()
}

fn compared(name: &str, texture: &Texture, wavelength: f64) -> Option<String> {
    let (predicted, measured) = (predicted(texture), measured(texture, wavelength));
    println!("{name}: predicted {predicted:.3}, measured {measured:.3}");
    let [over, under] = tolerance::PREDICTED;
    let enough = measured <= over * predicted + tolerance::SOURCE;
    let sharp = predicted <= under * (measured + tolerance::SOURCE);
    (!enough || !sharp).then(|| format!("{name}: predicted {predicted:.3}, measured {measured:.3}"))
}

#[test]
fn graphs_are_as_wrong_as_predicted() {
    let mut wrong = Vec::new();
    let mut paths: Vec<_> = std::fs::read_dir(root().join("graphs"))
        .expect("the folder of graphs")
        .map(|entry| entry.expect("an entry").path())
        .filter(|path| path.extension().is_some_and(|e| e == "json"))
        .collect();
    paths.sort();
    assert!(!paths.is_empty());
    for path in paths {
        let name = path
            .file_stem()
            .expect("a name")
            .to_string_lossy()
            .into_owned();
        let texture = Texture::from_file(&path).unwrap_or_else(|e| panic!("{name}: {e:?}"));
        let texture = means(&texture);
        let text = std::fs::read_to_string(&path).expect("a graph");
        let json: serde_json::Value = serde_json::from_str(&text).expect("JSON");
        let wavelength = json.pointer("/extra/mipless/wavelength");
        let wavelength = wavelength
            .and_then(serde_json::Value::as_f64)
            .expect("a wavelength");
        wrong.extend(compared(&name, &texture, wavelength));
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// Nodes over two noises of unit variance, `n` and `m`, of wavelength 1; the last is `o`.
const CHAINS: [(&str, &str); 10] = [
    (
        "a noise",
        r#""o":{"type":"range","inputs":{"in":{"node":"n"},"inlow":-4,"inhigh":4}}"#,
    ),
    (
        "ramp",
        r#""o":{"type":"smoothstep","inputs":{"in":{"node":"n"},"low":-1,"high":1}}"#,
    ),
    (
        "step",
        r#""o":{"type":"step","inputs":{"in":{"node":"n"},"edge":0.3}}"#,
    ),
    (
        "sin of abs",
        r#""a":{"type":"absval","inputs":{"in":{"node":"n"}}},"h":{"type":"multiply","inputs":{"in1":{"node":"a"},"in2":5}},"s":{"type":"sin","inputs":{"in":{"node":"h"}}},"o":{"type":"range","inputs":{"in":{"node":"s"},"inlow":-1}}"#,
    ),
    (
        "ramp of a maximum",
        r#""x":{"type":"max","inputs":{"in1":{"node":"n"},"in2":{"node":"m"}}},"o":{"type":"smoothstep","inputs":{"in":{"node":"x"},"low":-1,"high":1.5}}"#,
    ),
    (
        "step of a product",
        r#""x":{"type":"multiply","inputs":{"in1":{"node":"n"},"in2":{"node":"m"}}},"o":{"type":"step","inputs":{"in":{"node":"x"},"edge":0.3}}"#,
    ),
    (
        "mix by a mask",
        r#""s":{"type":"smoothstep","inputs":{"in":{"node":"n"},"low":-1,"high":1}},"r":{"type":"range","inputs":{"in":{"node":"m"},"inlow":-3,"inhigh":3}},"o":{"type":"mix","inputs":{"bg":0.1,"fg":{"node":"r"},"mix":{"node":"s"}}}"#,
    ),
    (
        "a direction",
        r#""p":{"type":"combine2","inputs":{"in1":{"node":"n"},"in2":{"node":"m"}}},"u":{"type":"normalize","inputs":{"in":{"node":"p"}}},"x":{"type":"extract","inputs":{"in":{"node":"u"},"index":0}},"o":{"type":"range","inputs":{"in":{"node":"x"},"inlow":-1}}"#,
    ),
    (
        "a hue",
        r#""c":{"type":"combine3","inputs":{"in1":{"node":"n"},"in2":{"node":"m"},"in3":0}},"u":{"type":"rgbtohsv","inputs":{"in":{"node":"c"}}},"o":{"type":"extract","inputs":{"in":{"node":"u"},"index":0}}"#,
    ),
    (
        "an angle",
        r#""a":{"type":"atan2","inputs":{"iny":{"node":"n"},"inx":{"node":"m"}}},"o":{"type":"range","inputs":{"in":{"node":"a"},"inlow":-3.1416,"inhigh":3.1416}}"#,
    ),
];

#[test]
fn chains_are_as_wrong_as_predicted() {
    let mut wrong = Vec::new();
    for (name, nodes) in CHAINS {
        let noise = |seed| {
            format!(r#"{{"type":"spectralnoise2d","inputs":{{"amplitude":4,"seed":{seed}}}}}"#)
        };
        let (n, m) = (noise(0), noise(7));
        let json = format!(
            r#"{{"version":1,"name":"chain","nodes":{{"n":{n},"m":{m},{nodes}}},"outputs":{{"out":{{"node":"o"}}}}}}"#
        );
        let texture = Texture::from_json(&json).unwrap_or_else(|e| panic!("{name}: {e:?}"));
        wrong.extend(compared(name, &texture, 1.0));
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}
