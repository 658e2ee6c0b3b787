//! What `shade` makes of a filtered surface, against facets that are shaded one by one.
//!
//! The closed forms run on the evaluator in f32 with the exact moments of the fields, so that errors are
//! those of the closed forms. A bias is that of the mean over pixels, relative to the mean.

#[path = "shading/color.rs"]
mod color;
#[path = "shading/sky.rs"]
mod sky;

use mipless::target::{Target, translate};
use mipless::wgsl::{Entry, emit_shaded};
use mipless::{CheckOptions, Options, Texture};
use mipless_codegen::shade::{FIELDS, Hiding, Lighting, terms_module};
use mipless_tests::random::Random;
use mipless_tests::surface::{
    Averages, Direction, Field, Host, Kind, Lit, Model, Moments, Torus, direction, ggx, lambert,
};
use rayon::prelude::*;
use std::sync::LazyLock;

/// Every so many texels there is a pixel.
const STRIDE: usize = 8;

fn mean(all: &[f64]) -> f64 {
    all.iter().sum::<f64>() / all.len() as f64
}

fn bias_of(model: &[f64], truth: &[f64]) -> f64 {
    mean(model) / mean(truth) - 1.0
}

#[test]
fn what_is_seen_of_a_surface_is_its_projection() {
    let field = Field::new(&Torus::new(512, 8.0), Kind::Band, 0.4, 1);
    for theta in [45.0, 75.0, 85.0] {
        let view = direction(theta, 20.0);
        let seen = mean(Lit::new(&field, view, view).seen()) / view[2];
        println!("{theta} degrees: {seen:.4}");
        assert!((seen - 1.0).abs() < 0.002, "{theta}: {seen}");
    }
}

/// Lights around a view, which make 18 half vectors.
fn pairs() -> Vec<(Direction, Direction)> {
    let view = direction(30.0, 23.0);
    let lights = [10.0, 30.0, 50.0].into_iter();
    lights
        .flat_map(|theta| (0..6).map(move |k| (theta, 60.0 * f64::from(k))))
        .map(|(theta, azimuth)| (view, direction(theta, azimuth)))
        .collect()
}

/// What a field of slopes of .4 mirrors of each of the [`pairs`], for each of the [`ALPHAS`].
struct Mirrored {
    kind: Kind,
    field: Field,
    truths: Vec<[f64; ALPHAS.len()]>,
}

const ALPHAS: [f64; 4] = [0.05, 0.1, 0.2, 0.5];

static MIRRORED: LazyLock<Vec<Mirrored>> = LazyLock::new(|| {
    let torus = Torus::new(512, 14.0);
    let of = |kind| {
        let whole = Field::new(&torus, kind, 0.4, 2);
        let field = whole.thinned(2);
        let truths = pairs().into_par_iter().map(|(view, light)| {
            let lit = Lit::of(&field, &whole, view, light);
            ALPHAS.map(|alpha| lit.whole(&field.each(|_, s| ggx(s, alpha, view, light))))
        });
        let truths = truths.collect();
        Mirrored {
            kind,
            field,
            truths,
        }
    };
    vec![of(Kind::Band), of(Kind::Fractal), of(Kind::Directed)]
});

/// The L2 error over the pairs, and by how much the largest is off.
fn errors(truths: impl Iterator<Item = f64>, found: impl Iterator<Item = f64>) -> [f64; 2] {
    let (mut error, mut all, mut peaks) = (0.0, 0.0, [0.0_f64; 2]);
    for (truth, found) in truths.zip(found) {
        error += (found - truth).powi(2);
        all += truth * truth;
        peaks = [peaks[0].max(found), peaks[1].max(truth)];
    }
    [(error / all).sqrt(), peaks[0] / peaks[1] - 1.0]
}

#[test]
fn two_lobes_are_near_what_gaussian_slopes_mirror() {
    let model = Model::new(&terms_module(Hiding::Facets));
    for Mirrored {
        kind,
        field,
        truths,
    } in &*MIRRORED
    {
        let mut moments = Moments::of_slopes(field, &Averages::whole(field), 0.0, false);
        for ((k, alpha), bound) in ALPHAS.iter().enumerate().zip([0.10, 0.10, 0.10, 0.16]) {
            moments.fill("mean_roughness", alpha.sqrt());
            let found = pairs().into_iter();
            let found = found.map(|(view, light)| model.between(&moments, view, light)[3][0]);
            let [error, peak] = errors(truths.iter().map(|truths| truths[k]), found);
            println!("{kind:?}, alpha {alpha}: L2 {error:.3}, peak {peak:+.2}");
            assert!(error <= bound, "{kind:?} {alpha}: {error}");
        }
    }
}

#[test]
fn hosts_of_one_lobe_are_near_enough_with_the_widths_of_a_surface() {
    for Mirrored {
        kind,
        field,
        truths,
    } in &*MIRRORED
    {
        let over = |f: &dyn Fn([f64; 2]) -> f64| mean(&field.each(|_, s| f(s)));
        let covariance = [
            over(&|s| s[0] * s[0]),
            over(&|s| s[0] * s[1]),
            over(&|s| s[1] * s[1]),
        ];
        // Every texel of a normal map counts the same.
        let length = over(&|s| 1.0 / (1.0 + s[0] * s[0] + s[1] * s[1]).sqrt());
        for (k, &alpha) in ALPHAS.iter().enumerate().skip(1) {
            for host in Host::ALL {
                let found = pairs().into_iter();
                let found = found
                    .map(|(view, light)| host.mirrored(covariance, length, alpha, [view, light]));
                let [error, peak] = errors(truths.iter().map(|truths| truths[k]), found);
                println!("{kind:?}, alpha {alpha}, {host:?}: L2 {error:.3}, peak {peak:+.2}");
                let near = host != Host::Surface || (error <= 0.25 && peak.abs() <= 0.2);
                assert!(near, "{kind:?} {alpha}: {error} {peak}");
            }
        }
    }
}

/// The angles of eyes and lights, and the azimuth between them.
const PAIRS: [[f64; 3]; 7] = [
    [0.0, 45.0, 0.0],
    [30.0, 20.0, 90.0],
    [45.0, 45.0, 180.0],
    [45.0, 45.0, 0.0],
    [60.0, 30.0, 90.0],
    [60.0, 60.0, 30.0],
    [75.0, 30.0, 180.0],
];

fn directions([view, light, between]: [f64; 3]) -> (Direction, Direction) {
    (direction(view, 23.0), direction(light, 23.0 + between))
}

#[test]
fn cracks_and_plateaus_are_flat_and_ramp() {
    let torus = Torus::new(256, 8.0);
    let model = Model::new(&terms_module(Hiding::Facets));
    let sds = [0.05, 0.35, 1.0];
    for kind in [Kind::Cracks, Kind::Plateaus] {
        let field = Field::new(&torus, kind, 0.4, 4);
        let averages = Averages::of(&field, STRIDE);
        let moments: Vec<[Moments; 2]> = (sds.iter())
            .map(|&sd| [false, true].map(|mixed| Moments::of_slopes(&field, &averages, sd, mixed)))
            .collect();
        let mut table = vec![[[[0.0; 2]; 2]; 4]; sds.len()];
        for (view, light) in PAIRS.map(directions) {
            let lit = Lit::new(&field, view, light);
            for (row, alpha) in [0.05_f64, 0.2, 0.5, 0.0].into_iter().enumerate() {
                let facets = field.each(|_, s| match alpha {
                    0.0 => lambert(s, light),
                    _ => ggx(s, alpha, view, light),
                });
                let truths = lit.pixels(&facets, &sds, STRIDE);
                for ((moments, truth), table) in moments.iter().zip(&truths).zip(&mut table) {
                    for (moments, table) in moments.iter().zip(&mut table[row]) {
                        let mut moments = moments.clone();
                        moments.fill("mean_roughness", alpha.sqrt());
                        let terms = model.between(&moments, view, light);
                        let found: Vec<f64> = match alpha {
                            0.0 => terms[0].iter().zip(&terms[4]).map(|(d, v)| d * v).collect(),
                            _ => terms[3].clone(),
                        };
                        let off: Vec<f64> = found.iter().zip(truth).map(|(f, t)| f - t).collect();
                        let square = mean(&off.iter().map(|x| x * x).collect::<Vec<_>>());
                        table[0] += mean(&off).abs() / mean(truth) / 7.0;
                        table[1] += square.sqrt() / mean(truth) / 7.0;
                    }
                }
            }
        }
        for (sd, rows) in sds.iter().zip(&table) {
            println!("{kind:?} {sd}: [one, mixed] [bias, rms] {rows:.3?}");
            for (row, bound) in rows.iter().zip([0.30, 0.15, 0.12, 0.03]) {
                let [one, mixed] = row;
                assert!(mixed[1] <= 1.001 * one[1], "{kind:?} {sd}: {row:?}");
                let holds = *sd < 0.35 || mixed[0] <= bound;
                assert!(holds, "{kind:?} {sd}: {row:?} over {bound}");
            }
        }
    }
}

#[test]
fn light_reaches_what_smith_says() {
    let torus = Torus::new(256, 8.0);
    let model = Model::new(&terms_module(Hiding::Facets));
    let azimuths = [0.0, 10.0, 30.0, 60.0, 90.0, 180.0];
    let mut biases = [0.0; 6];
    let mut count = 0.0;
    for (kind, sigma) in [(Kind::Band, 0.3), (Kind::Band, 0.6), (Kind::Fractal, 0.6)] {
        let field = Field::new(&torus, kind, sigma, 5);
        let moments = Moments::of_slopes(&field, &Averages::whole(&field), 0.0, false);
        for (o, i) in [
            (30.0, 60.0),
            (60.0, 30.0),
            (60.0, 60.0),
            (60.0, 75.0),
            (75.0, 60.0),
        ] {
            for (bias, azimuth) in biases.iter_mut().zip(azimuths) {
                let (view, light) = directions([o, i, azimuth]);
                // Of facets that face the light: the others' cosine is 0 already.
                let faces = field.each(|_, s| f64::from(u8::from(lambert(s, light) > 0.0)));
                let lit = Lit::new(&field, view, light);
                let truth = lit.whole(&faces) / lit.unshadowed(&faces);
                *bias += model.between(&moments, view, light)[4][0] - truth;
            }
            count += 1.0;
        }
    }
    let biases = biases.map(|bias| bias / count);
    println!("visibility at {azimuths:?}: {biases:.3?}");
    assert!(
        biases[..5].iter().all(|bias| bias.abs() <= 0.03),
        "{biases:?}"
    );
}

#[test]
fn matt_surfaces_are_lit_right_to_60_degrees() {
    let torus = Torus::new(256, 8.0);
    let model = Model::new(&terms_module(Hiding::Facets));
    for (kind, sigma) in [
        (Kind::Band, 0.3),
        (Kind::Band, 0.6),
        (Kind::Fractal, 0.5),
        (Kind::Directed, 0.5),
    ] {
        let field = Field::new(&torus, kind, sigma, 6);
        let moments = Moments::of_slopes(&field, &Averages::whole(&field), 0.0, false);
        let (mut to_60, mut all) = ([0.0; 2], [0.0; 2]);
        for o in [15.0, 45.0, 60.0, 75.0] {
            for i in [15.0, 45.0, 60.0] {
                for azimuth in [0.0, 90.0, 180.0] {
                    let (view, light) = directions([o, i, azimuth]);
                    let facets = field.each(|_, s| lambert(s, light));
                    let truth = Lit::new(&field, view, light).whole(&facets);
                    let terms = model.between(&moments, view, light);
                    let found = terms[0][0] * terms[4][0];
                    let sums = if o > 60.0 { &mut all } else { &mut to_60 };
                    sums[0] += found - truth;
                    sums[1] += truth;
                }
            }
        }
        let [near, far] = [to_60, all].map(|[off, sum]| off / sum);
        println!("{kind:?} {sigma}: to 60 degrees {near:.4}, at 75 {far:.4}");
        assert!(near.abs() <= 0.02, "{kind:?} {sigma}: {near}");
    }
}

#[test]
fn no_surface_gives_negative_light_or_no_number() {
    let modules = [Lighting::Light, Lighting::Sky]
        .map(|lighting| Model::new(&lighting.module(Hiding::Facets)));
    let mut random = Random::new(12);
    let extreme = [0.0, 1.0, -1.0, 1e-9, 0.3, 2.0, 1e3, -1e3, 1e7, 1e-3];
    for turn in 0..400 {
        let mut moments = Moments::flat(64);
        for (name, components) in FIELDS {
            let all: Vec<Vec<f64>> = (0..components)
                .map(|_| (0..64).map(|_| *random.choose(&extreme)).collect())
                .collect();
            moments.set(name, &all);
        }
        let [view, light] = [0, 1].map(|_| {
            // Also along the surface, and from below.
            let theta = *random.choose(&[0.0, 45.0, 89.99, 90.0, 120.0, 180.0]);
            direction(theta, random.within(0.0, 360.0))
        });
        let color = [1.0; 3];
        let sky = [0.5; 27];
        for (model, rest) in modules
            .iter()
            .zip([[view, light, color].concat(), [&view[..], &sky].concat()])
        {
            let found = model.evaluate(&moments, &rest);
            let bad = found
                .iter()
                .flatten()
                .position(|x| !(x.is_finite() && *x >= 0.0));
            assert_eq!(bad, None, "turn {turn}: {view:?} {light:?} {found:?}");
        }
    }
}

#[test]
fn a_footprint_of_nothing_is_a_facet() {
    let model = Model::new(&terms_module(Hiding::Facets));
    let mut random = Random::new(13);
    for _ in 0..200 {
        let slope = [random.within(-0.8, 0.8), random.within(-0.8, 0.8)];
        let (view, light) = (
            direction(random.within(0.0, 60.0), 10.0),
            direction(random.within(0.0, 60.0), 200.0),
        );
        let alpha = random.within(0.1, 1.0);
        let mut moments = Moments::flat(1);
        moments.set("slope_mean", &slope.map(|x| vec![x]));
        moments.fill("mean_roughness", f64::sqrt(alpha));
        let terms = model.between(&moments, view, light);
        let [x, y, z] = view;
        let area = z - x * slope[0] - y * slope[1];
        if area < 0.05 {
            continue;
        }
        let truth = [lambert(slope, light), ggx(slope, alpha, view, light)];
        let found = [terms[0][0] * terms[4][0], terms[3][0]];
        for (found, truth) in found.into_iter().zip(truth) {
            let near = (found - truth).abs() <= 2e-3 * (1.0 + truth);
            assert!(
                near,
                "{slope:?} {view:?} {light:?} {alpha}: {found} {truth}"
            );
        }
    }
}

#[test]
fn facets_that_hide_nothing_are_shaded_as_they_are() {
    let torus = Torus::new(256, 8.0);
    let model = Model::new(&terms_module(Hiding::Nothing));
    for (kind, mixed) in [
        (Kind::Band, false),
        (Kind::Fractal, false),
        (Kind::Cracks, true),
    ] {
        let field = Field::new(&torus, kind, 0.4, 4);
        let moments = Moments::of_slopes(&field, &Averages::whole(&field), 0.0, mixed);
        let mut errors = [[0.0; 2]; 4];
        let around = [70.0, 80.0].into_iter().flat_map(|theta| {
            [60.0, 70.0].map(|light| (direction(theta, 23.0), direction(light, 203.0)))
        });
        for (view, light) in pairs()
            .into_iter()
            .chain(PAIRS.map(directions))
            .chain(around)
        {
            let lit = Lit::open(&field, view);
            for (sums, alpha) in errors.iter_mut().zip([0.05_f64, 0.2, 0.5, 0.0]) {
                let truth = lit.whole(&field.each(|_, s| match alpha {
                    0.0 => lambert(s, light),
                    _ => ggx(s, alpha, view, light),
                }));
                let mut moments = moments.clone();
                moments.fill("mean_roughness", alpha.sqrt());
                let terms = model.between(&moments, view, light);
                let found = if alpha == 0.0 {
                    terms[0][0] * terms[4][0]
                } else {
                    terms[3][0]
                };
                sums[0] += (found - truth).powi(2);
                sums[1] += truth.powi(2);
            }
        }
        let errors = errors.map(|[error, all]| (error / all).sqrt());
        println!("{kind:?}, nothing hidden: {errors:.3?}");
        // Lights that meet the surface at 70 degrees from the normal are among them.
        for (error, bound) in errors.into_iter().zip([0.08, 0.15, 0.24, 0.02]) {
            assert!(error <= bound, "{kind:?}: {errors:?}");
        }
    }
}

#[test]
fn functions_that_shade_are_valid_for_every_target() {
    let graph = r#"{ "version": 1, "name": "light",
        "nodes": {
            "noise": { "type": "noise2d" },
            "surface": { "type": "surface", "inputs": { "height": { "node": "noise" }, "scale": 0.1 } } },
        "outputs": { "material": { "node": "surface" } } }"#;
    let texture = Texture::from_json(graph).expect("the graph has no mistakes");
    let parts: Vec<&str> = FIELDS.iter().map(|(name, _)| *name).collect();
    let material = texture.material(&parts, &CheckOptions::default());
    let material = material.expect("a material").expect("without mistakes");
    let program = material.compile(&Options::default());
    for entry in [Entry::None, Entry::Fragment, Entry::Compute] {
        let shader = emit_shaded(&program, &entry.into());
        for line in [
            "fn light_shade(surface: LightOutputs, view: vec3f, light: vec3f, light_color: vec3f) -> vec3f",
            "fn light_shade_sky(surface: LightOutputs, view: vec3f, sky: array<vec3f, 9>) -> vec3f",
        ] {
            assert!(shader.source.contains(line), "{line}: {}", shader.source);
        }
        for target in Target::ALL {
            if target.refuses(&shader).is_some() {
                continue;
            }
            translate(&shader, target).unwrap_or_else(|error| panic!("{}: {error}", target.name()));
        }
    }
}

/// A material of slopes is the mean of its facets, each shaded as a material of one slope.
#[test]
fn a_material_is_the_mean_of_its_facets() {
    let torus = Torus::new(256, 8.0);
    let models = [Lighting::Light, Lighting::Sky].map(|l| Model::new(&l.module(Hiding::Nothing)));
    let mut sky = [0.0; 27];
    // Bright above, dark below.
    sky[..3].fill(0.4);
    sky[9..12].fill(0.3);
    sky[21..24].fill(-0.2);
    for (kind, sigma) in [(Kind::Fractal, 0.15), (Kind::Fractal, 0.4)] {
        let field = Field::new(&torus, kind, sigma, 4);
        let mut moments = Moments::of_slopes(&field, &Averages::whole(&field), 0.0, false);
        let mut facets = Moments::flat(field.height.len());
        facets.set("slope_mean", &field.slopes);
        for moments in [&mut moments, &mut facets] {
            moments.fill("mean_roughness", 0.35);
            moments.fill("base_color", 0.3);
        }
        for theta in [0.0, 45.0, 70.0, 80.0, 85.0, 88.0] {
            for azimuth in [180.0, 90.0] {
                let (view, light) = directions([theta, 62.0, azimuth]);
                let lit = Lit::open(&field, view);
                let light_arguments = [view, light, [1.0; 3]].concat();
                let sky_arguments = [&view[..], &sky].concat();
                let all = models.iter().zip([light_arguments, sky_arguments]);
                let pairs: Vec<[f64; 2]> = all
                    .map(|(model, rest)| {
                        let truth = lit.whole(&model.evaluate(&facets, &rest)[0]);
                        [model.evaluate(&moments, &rest)[0][0], truth]
                    })
                    .collect();
                println!(
                    "{kind:?} {sigma}, {theta} {azimuth}: [found, truth] by light, sky {pairs:.3?}"
                );
                // The glitter of a low sun ahead, seen at 88 degrees, is the furthest off.
                for ([found, truth], bound) in pairs.into_iter().zip([0.16, 0.05]) {
                    assert!(
                        (found / truth - 1.0).abs() <= bound,
                        "{theta}: {found} {truth}"
                    );
                }
            }
        }
    }
}
