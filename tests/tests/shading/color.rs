//! Colour that goes with slopes and heights.

use super::{STRIDE, bias_of, directions};
use mipless_codegen::shade::{Hiding, Lighting, terms_module};
use mipless_tests::surface::{
    Averages, Direction, Field, Kind, Lit, Model, Moments, Torus, lambert,
};

/// A colour of the slope: bright where it faces one way.
fn facing(sigma: f64) -> impl Fn(f64, [f64; 2]) -> f64 {
    move |_, s| 0.5 + 0.5 * (2.0 * s[0] / sigma).tanh()
}

#[test]
fn colors_of_slopes_are_seen_with_their_slopes() {
    let torus = Torus::new(256, 8.0);
    let model = Model::new(&terms_module(Hiding::Facets));
    let sigma = 0.4;
    let field = Field::new(&torus, Kind::Band, sigma, 7);
    let color = field.each(facing(sigma));
    for sd in [0.15, 0.35, 1.0] {
        let averages = Averages::of(&field, STRIDE);
        let plain = Moments::of_slopes(&field, &averages, sd, false);
        let joint = with_color(&plain, &field, &averages, sd, &color, false);
        let tinted = with_color(&plain, &field, &averages, sd, &color, true);
        let mean_color = averages.filtered(&color, sd);
        let mut biases = [0.0; 3];
        for (o, i, azimuth) in EIGHT {
            let (view, light) = directions([o, i, azimuth]);
            let lit = Lit::new(&field, view, light);
            let facets: Vec<f64> = (field.each(|_, s| lambert(s, light)).iter())
                .zip(&color)
                .map(|(f, c)| f * c)
                .collect();
            let truth = &lit.pixels(&facets, &[sd], STRIDE)[0];
            for (bias, moments) in biases.iter_mut().zip([&plain, &joint, &tinted]) {
                let terms = model.between(moments, view, light);
                let found: Vec<f64> = (0..truth.len())
                    .map(|k| mean_color[k] * terms[0][k] * terms[4][k])
                    .collect();
                *bias += bias_of(&found, truth).abs() / 8.0;
            }
        }
        println!("colour of slope, {sd}: independent, joint, tinted {biases:.3?}");
        assert!(
            biases[2] <= 0.05 && biases[2] < 0.2 * biases[0],
            "{sd}: {biases:?}"
        );
    }
}

/// Angles of eyes and lights, and the azimuth between them.
const EIGHT: [(f64, f64, f64); 8] = [
    (0.0, 30.0, 0.0),
    (0.0, 60.0, 120.0),
    (30.0, 45.0, 90.0),
    (45.0, 45.0, 180.0),
    (45.0, 60.0, 40.0),
    (60.0, 30.0, 240.0),
    (60.0, 60.0, 90.0),
    (75.0, 45.0, 150.0),
];

/// The moments of a colour beside those of slopes: its covariance with them, and, where `third`, that
/// with their squares.
fn with_color(
    moments: &Moments,
    field: &Field,
    averages: &Averages<'_>,
    sd: f64,
    color: &[f64],
    third: bool,
) -> Moments {
    let mut moments = moments.clone();
    let [u, v] = &field.slopes;
    let filtered = |f: &dyn Fn(usize) -> f64| {
        let all: Vec<f64> = (0..color.len()).map(f).collect();
        averages.filtered(&all, sd)
    };
    let c = filtered(&|i| color[i]);
    let s = [filtered(&|i| u[i]), filtered(&|i| v[i])];
    let slopes = [u, v];
    let first: Vec<Vec<f64>> = (0..2)
        .map(|a| {
            let product = filtered(&|i| color[i] * slopes[a][i]);
            (0..c.len()).map(|k| product[k] - c[k] * s[a][k]).collect()
        })
        .collect();
    moments.set("base_color", &[c.clone(), c.clone(), c.clone()]);
    for (name, a) in [("cov_color_slope_u", 0), ("cov_color_slope_v", 1)] {
        moments.set(name, &vec![first[a].clone(); 3]);
    }
    if third {
        let pairs = [("uu", 0, 0), ("uv", 0, 1), ("vv", 1, 1)];
        for (name, a, b) in pairs {
            let triple = filtered(&|i| color[i] * slopes[a][i] * slopes[b][i]);
            let second = filtered(&|i| slopes[a][i] * slopes[b][i]);
            let of = |k: usize| {
                triple[k] - c[k] * second[k] - s[a][k] * first[b][k] - s[b][k] * first[a][k]
            };
            let all: Vec<f64> = (0..c.len()).map(of).collect();
            moments.set(&format!("cov_color_slope_{name}"), &vec![all; 3]);
        }
    }
    moments
}

#[test]
fn colors_of_heights_are_seen_where_heights_are_seen() {
    let torus = Torus::new(256, 8.0);
    let model = Model::new(&Lighting::Light.module(Hiding::Facets));
    let field = Field::new(&torus, Kind::Fractal, 0.6, 8);
    let averages = Averages::whole(&field);
    let count = field.height.len() as f64;
    let sd = (field.height.iter().map(|h| h * h).sum::<f64>() / count).sqrt();
    let color = field.each(|h, _| 0.5 + 0.15 * h / sd);
    let plain = {
        let mut moments = Moments::of_slopes(&field, &averages, 0.0, false);
        moments.fill("base_color", 0.5);
        moments
    };
    let mut seen = plain.clone();
    seen.fill("cov_color_height", 0.15 * sd);
    seen.fill("sigma_height", sd);
    let mut biases = [0.0; 2];
    for (o, i, azimuth) in [
        (45.0, 60.0, 90.0),
        (60.0, 60.0, 90.0),
        (75.0, 60.0, 180.0),
        (75.0, 75.0, 60.0),
    ] {
        let (view, light) = directions([o, i, azimuth]);
        let lit = Lit::new(&field, view, light);
        let facets = field.each(|_, s| lambert(s, light));
        // Of the colour alone: what is matt is seen by the closed form as it is.
        let tinted: Vec<f64> = facets.iter().zip(&color).map(|(f, c)| f * c).collect();
        let truth = lit.whole(&tinted) / lit.whole(&facets);
        let white = matt(&model, &plain, view, light) / 0.5;
        for (bias, moments) in biases.iter_mut().zip([&plain, &seen]) {
            *bias += (matt(&model, moments, view, light) / white - truth) / truth / 4.0;
        }
    }
    println!("colour of height: independent, seen {biases:.4?}");
    assert!(
        biases[1].abs() <= 0.02 && biases[1].abs() < 0.3 * biases[0].abs(),
        "{biases:?}"
    );
}

/// The light of matt facets: what is mirrored does not depend on the base colour of what is no metal.
fn matt(model: &Model, moments: &Moments, view: Direction, light: Direction) -> f64 {
    let mut black = moments.clone();
    black.fill("base_color", 0.0);
    black.fill("cov_color_height", 0.0);
    let arguments = [view, light, [1.0; 3]].concat();
    let [of, without] = [moments, &black].map(|moments| model.evaluate(moments, &arguments)[0][0]);
    of - without
}
