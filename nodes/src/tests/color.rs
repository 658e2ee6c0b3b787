//! Colours of jointly Gaussian channels.

use serde_json::{Value, json};

use super::law::{Inputs, Law};

/// Channels four standard deviations apart.
const APART: &[Inputs<'static>] = &[
    &[
        (0.2, &[0.03]),
        (0.7, &[0.02, 0.04]),
        (0.4, &[0.0, 0.0, 0.03]),
    ],
    &[
        (0.3, &[0.05]),
        (0.1, &[0.01, 0.01]),
        (0.8, &[0.05, 0.0, 0.05]),
    ],
];

/// Channels whose order changes within the footprint.
const CROSSING: &[Inputs<'static>] = &[
    &[(0.4, &[0.1]), (0.5, &[0.05, 0.1]), (0.45, &[0.0, 0.0, 0.1])],
    &[
        (0.6, &[0.1]),
        (0.5, &[-0.05, 0.05]),
        (0.2, &[0.0, 0.05, 0.05]),
    ],
];

const BOTH: &[Inputs<'static>] = &[APART[0], APART[1], CROSSING[0], CROSSING[1]];

fn of(ty: &str, more: Value) -> Value {
    let node = |i: usize| json!({ "node": format!("x{i}") });
    let color = json!({
        "type": "combine3", "inputs": { "in1": node(0), "in2": node(1), "in3": node(2) }
    });
    let mut inputs = json!({ "in": { "node": "color" } });
    for (key, value) in more.as_object().into_iter().flatten() {
        inputs[key] = value.clone();
    }
    json!({ "type": ty, "inputs": inputs, "extra_nodes": { "color": color } })
}

fn check(
    (name, more): (&str, Value),
    exact: &dyn Fn([f64; 3]) -> [f64; 3],
    inputs: &[Inputs<'_>],
    tolerances: [f64; 2],
) {
    Law {
        node: of(name, more),
        exact: &|x| exact([x[0], x[1], x[2]]).to_vec(),
        inputs,
        tolerances,
    }
    .check();
}

fn to_hsv([r, g, b]: [f64; 3]) -> [f64; 3] {
    let (high, low) = (r.max(g).max(b), r.min(g).min(b));
    let span = high - low;
    let hue = if r >= high {
        (g - b) / span
    } else if g >= high {
        2.0 + (b - r) / span
    } else {
        4.0 + (r - g) / span
    };
    [(hue / 6.0).rem_euclid(1.0), span / high, high]
}

fn to_rgb([h, s, v]: [f64; 3]) -> [f64; 3] {
    [0.0, 1.0 / 3.0, 2.0 / 3.0].map(|turn| {
        let full = ((6.0 * (h - turn).rem_euclid(1.0) - 3.0).abs() - 1.0).clamp(0.0, 1.0);
        v * (1.0 - s * (1.0 - full))
    })
}

#[test]
fn hue_saturation_value() {
    check(("rgbtohsv", json!({})), &to_hsv, APART, [5e-3, 5e-3]);
    check(("rgbtohsv", json!({})), &to_hsv, CROSSING, [0.25, 0.25]);
    let hsv: &[Inputs<'_>] = &[
        &[(0.1, &[0.05]), (0.7, &[0.05, 0.1]), (0.6, &[0.0, 0.0, 0.1])],
        &[(0.6, &[0.2]), (0.5, &[-0.05, 0.1]), (0.6, &[0.1, 0.0, 0.1])],
        &[(0.3, &[0.8]), (0.5, &[0.0, 0.1]), (0.6, &[0.0, 0.0, 0.1])],
    ];
    check(("hsvtorgb", json!({})), &to_rgb, hsv, [5e-3, 2e-2]);
    let adjusted = |amount: [f64; 3]| {
        move |rgb: [f64; 3]| {
            let [h, s, v] = to_hsv(rgb);
            to_rgb([h + amount[0], s * amount[1], v * amount[2]])
        }
    };
    let amount = [0.0, 0.6, 1.2];
    let node = ("hsvadjust", json!({ "amount": amount }));
    check(node, &adjusted(amount), BOTH, [2e-3, 1e-2]);
    let amount = [0.3, 0.8, 1.1];
    let node = || ("hsvadjust", json!({ "amount": amount }));
    check(node(), &adjusted(amount), APART, [1e-3, 1e-3]);
    check(node(), &adjusted(amount), BOTH, [2e-2, 2e-2]);
}

#[test]
fn corrections() {
    let grey = |[r, g, b]: [f64; 3]| 0.272_228_7 * r + 0.674_081_8 * g + 0.053_689_5 * b;
    let saturated =
        move |rgb: [f64; 3], amount: f64| rgb.map(|x| grey(rgb) + amount * (x - grey(rgb)));
    let node = ("saturate", json!({ "amount": 0.4 }));
    check(node, &|rgb| saturated(rgb, 0.4), BOTH, [2e-4, 2e-4]);
    let node = ("brightness", json!({ "brightness": 0.1, "contrast": 1.5 }));
    check(node, &|rgb| rgb.map(|x| 1.5 * x - 0.15), BOTH, [2e-4, 2e-4]);
    let more = json!({
        "saturation": 1.3, "gamma": 2.2, "lift": 0.1, "gain": 1.2, "contrast": 1.1,
        "contrastpivot": 0.4, "exposure": 0.5
    });
    let exact = |rgb: [f64; 3]| {
        saturated(rgb, 1.3).map(|x| {
            let x = x.signum() * x.abs().powf(1.0 / 2.2);
            let x = (x * 0.9 + 0.1) * 1.2;
            ((x - 0.4) * 1.1 + 0.4) * 0.5f64.exp2()
        })
    };
    check(("colorcorrect", more), &exact, BOTH, [5e-4, 1e-3]);
}

/// The cubic formulas of Kim et al. in linear Rec. 709.
fn glow(kelvin: f64) -> [f64; 3] {
    let t = 1e3 / kelvin;
    let cubic = |c: [f64; 4], x: f64| ((c[0] * x + c[1]) * x + c[2]) * x + c[3];
    let x = if kelvin < 4000.0 {
        cubic([-0.266_123_9, -0.234_358, 0.877_695_6, 0.179_91], t)
    } else {
        cubic([-3.025_846_9, 2.107_037_9, 0.222_634_7, 0.240_39], t)
    };
    let y = if kelvin < 2222.0 {
        cubic([-1.106_381_4, -1.348_110_2, 2.185_558_32, -0.202_196_83], x)
    } else if kelvin < 4000.0 {
        cubic(
            [-0.954_947_6, -1.374_185_93, 2.091_370_15, -0.167_488_67],
            x,
        )
    } else {
        cubic([3.081_758, -5.873_386_7, 3.751_129_97, -0.370_014_83], x)
    };
    let (big_x, big_z) = (x / y, (1.0 - x - y) / y);
    [
        3.240_454_2 * big_x - 1.537_138_5 - 0.498_531_4 * big_z,
        -0.969_266 * big_x + 1.876_010_8 + 0.041_556 * big_z,
        0.055_643_4 * big_x - 0.204_025_9 + 1.057_225_2 * big_z,
    ]
    .map(|channel| channel.max(0.0))
}

#[test]
fn a_body_glows_along_the_planckian_locus() {
    for kelvin in (1667..25_000).step_by(331).map(f64::from) {
        let inputs = json!({ "temperature": kelvin });
        let graph = json!({
            "version": 1, "name": "glow",
            "nodes": { "y": { "type": "blackbody", "inputs": inputs } },
            "outputs": { "out": { "node": "y" } }
        });
        let place = mipless_codegen::cpu::Footprint::default();
        let results =
            super::evaluated(&graph.to_string(), mipless_codegen::Method::Point, &[place]);
        for ((found, exact), tolerance) in
            results.iter().zip(glow(kelvin)).zip([0.015, 0.004, 0.03])
        {
            super::near(&format!("{kelvin} K"), found[0], exact, tolerance);
        }
    }
}
