//! Sawtooth, triangle, the hexagon of hues, whole parts.

use super::super::wave::Staircase;
use super::super::{Corner, LinearWave, Transfer};
use super::{Case, DEVIATIONS, Make, evaluate, grid, module, unit};

type Function = fn(f64) -> f64;

fn fraction(x: f64) -> f64 {
    x - x.floor()
}

fn triangle(x: f64) -> f64 {
    2.0 * (x - (x + 0.5).floor()).abs()
}

fn hexagon(x: f64) -> f64 {
    ((fraction(x) * 6.0 - 3.0).abs() - 1.0).clamp(0.0, 1.0)
}

/// Rises twice, jumping at 0.25 and 0.7.
fn uneven(x: f64) -> f64 {
    let x = fraction(x - 0.25);
    if x < 0.45 { 0.5 + x } else { 2.0 * (x - 0.45) }
}

const POINTS: [(f32, f32); 4] = [
    (1.0 / 6.0, 1.0),
    (1.0 / 3.0, 0.0),
    (2.0 / 3.0, 0.0),
    (5.0 / 6.0, 1.0),
];

fn waves() -> [(&'static str, LinearWave, Function, Vec<f64>); 4] {
    let corner = |at, before, after| Corner { at, before, after };
    let corners = vec![corner(0.25, 1.1, 0.5), corner(0.7, 0.95, 0.0)];
    [
        ("sawtooth", LinearWave::sawtooth(), fraction, vec![0.0]),
        ("triangle", LinearWave::triangle(), triangle, vec![0.0, 0.5]),
        (
            "hexagon",
            LinearWave::through(&POINTS),
            hexagon,
            POINTS.map(|p| f64::from(p.0)).to_vec(),
        ),
        ("uneven", LinearWave::new(corners), uneven, vec![0.25, 0.7]),
    ]
}

#[test]
fn linear_waves() {
    for (name, wave, exact, corners) in waves() {
        let breaks = (-60..=60).flat_map(|i| corners.iter().map(move |at| f64::from(i) + at));
        Case {
            name,
            make: &|_| Box::new(wave.clone()),
            exact: &exact,
            breaks: breaks.collect(),
            points: grid(-1.03, 1.51, &DEVIATIONS[..13]),
            reach: 9.0,
            tolerances: [4e-6, 4e-6, 1e-5, 5e-5, 1e-3],
            size: &unit,
        }
        .check();
    }
}

#[test]
fn whole_parts() {
    Case {
        name: "floor",
        make: &|_| Box::new(Staircase::default()),
        exact: &f64::floor,
        breaks: (-60..=60).map(f64::from).collect(),
        points: grid(-1.03, 1.51, &DEVIATIONS[..13]),
        reach: 9.0,
        tolerances: [4e-6, 4e-6, 1e-5, 5e-5, 1e-3],
        size: &|_, sd: f64| 1.0 + sd,
    }
    .check();
}

#[test]
fn waves_without_spread_are_their_values() {
    let points: Vec<(f32, f32)> = (0..41).map(|i| (-1.013 + 0.05 * i as f32, 0.0)).collect();
    for (name, wave, exact, _) in waves() {
        let make: Make<'_> = &|_| Box::new(wave.clone());
        let results = evaluate::<f32>(&module(make, super::UNBOUNDED), &points);
        for (&(m, _), [mean, .., distortion, value]) in points.iter().zip(results) {
            assert!((mean - value).abs() < 2e-6, "{name} at {m}");
            assert!(
                (value - exact(m.into())).abs() < 1e-6,
                "{name} at {m}: {value}"
            );
            assert!(distortion < 1e-6, "{name} at {m}: {distortion}");
        }
    }
}

#[test]
fn a_wave_of_a_signal_that_reaches_one_stretch_is_its_line() {
    let points = grid(0.05, 0.85, &[1e-3, 0.1, 0.3, 0.5]);
    let make: Make<'_> = &|_| Box::new(LinearWave::sawtooth());
    for (shift, range) in [(0.0, [0.0, 0.9]), (-3.0, [-3.0, -2.1])] {
        let moved: Vec<(f32, f32)> = points.iter().map(|&(m, v)| (m + shift, v)).collect();
        let results = evaluate::<f32>(&module(make, range), &moved);
        for (&(m, _), [mean, slope, curvature, .., distortion, _]) in points.iter().zip(results) {
            assert!((mean - f64::from(m)).abs() < 1e-6, "{mean} for {m}");
            assert!((slope - 1.0).abs() < 1e-6 && curvature.abs() < 1e-6);
            assert!(distortion < 1e-6, "{distortion} at {m}");
        }
    }
}

#[test]
fn a_wave_knows_what_values_a_part_of_its_period_has() {
    let triangle = LinearWave::triangle();
    let range = |input| Transfer::range(&triangle, input);
    for (input, wanted) in [
        ([0.1, 0.3], [0.2, 0.6]),
        ([0.4, 0.7], [0.6, 1.0]),
        ([-0.1, 0.2], [0.0, 0.4]),
        ([-5.0, 9.0], [0.0, 1.0]),
        (super::UNBOUNDED, [0.0, 1.0]),
    ] {
        let found = range(input);
        let near = found.iter().zip(wanted).all(|(x, y)| (x - y).abs() < 1e-5);
        assert!(near, "{found:?} for {wanted:?}");
    }
}
