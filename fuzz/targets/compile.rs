//! A graph that is accepted compiles by every method to a shader that is valid, and has finite values.
//! Its first letter chooses the method.
#![no_main]

use libfuzzer_sys::fuzz_target;
use mipless::target::validate;
use mipless::wgsl::{Entry, emit};
use mipless::{Footprint, Method, Options, Texture};

const METHODS: [Method; 7] = [
    Method::Auto,
    Method::Point,
    Method::Naive,
    Method::Ensemble,
    Method::Local,
    Method::Quad,
    Method::Split(4),
];

/// A larger graph says no more, and takes longer.
const LONGEST: usize = 4000;

fuzz_target!(|text: &str| {
    let Some(first) = text.chars().next().filter(|_| text.len() < LONGEST) else {
        return;
    };
    let Ok(texture) = Texture::from_json(&text[first.len_utf8()..]) else {
        return;
    };
    let options = Options {
        method: METHODS[first as usize % METHODS.len()],
        moments: true,
        ..Options::default()
    };
    let program = texture.compile(&options);
    let shader = emit(&program, &Entry::Fragment.into());
    if let Err(error) = validate(&shader.source) {
        panic!("{error}\n{}", shader.source);
    }
    let footprints = [0.0, 1e-3, 1.0, 1e6].map(|size| Footprint {
        uv: [0.3, 0.7],
        du: [size, 0.0],
        dv: [0.0, size],
        ..Footprint::default()
    });
    let values = texture.evaluator(&options).evaluate(&footprints);
    assert!(values.iter().flatten().all(|x| x.is_finite()), "{values:?}");
});
