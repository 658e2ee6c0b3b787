//! Materials: what a host reads is a number that it can use, at every distance and place.

use mipless::{Method, Options};
use mipless_codegen::cpu::{Footprint, eval_program};
use mipless_tests::case::materials;

/// Footprints of every size, round and long, here and far away.
fn footprints() -> Vec<Footprint> {
    let mut footprints = Vec::new();
    for size in [0.0, 1e-6, 1e-3, 0.05, 1.0, 100.0, 1e6, f32::INFINITY] {
        for (i, ratio) in [1.0, 8.0, 1e4].into_iter().enumerate() {
            let (sin, cos) = (0.6 + i as f32).sin_cos();
            for at in [[0.3, 0.7], [-12.1, 5.9], [1e7, -3e8]] {
                footprints.push(Footprint {
                    du: [size * ratio * cos, size * ratio * sin],
                    dv: [-size * sin, size * cos],
                    ..Footprint::point(at)
                });
            }
        }
    }
    footprints
}

#[test]
fn parts_of_materials_are_numbers_that_a_host_can_use() {
    let footprints = footprints();
    for case in materials() {
        for method in [Method::Point, Method::Local, Method::Quad] {
            let program = case.texture.compile(&Options {
                method,
                ..Options::default()
            });
            let parameters: Vec<f32> = (program.interface.parameters.iter())
                .flat_map(|parameter| parameter.default.iter().copied())
                .collect();
            let values = eval_program::<f32>(&program, &footprints, &parameters);
            let mut next = 0;
            for output in case.texture.outputs() {
                for component in 0..output.ty.components() {
                    for (i, &value) in values[next + component].iter().enumerate() {
                        let of = format!("{} {} by {method} at {i}", case.name, output.name);
                        let least =
                            if output.name.contains("normal") || output.name.contains("tangent") {
                                -1.0
                            } else {
                                0.0
                            };
                        assert!(value.is_finite(), "{of}: {value}");
                        let within = (least - 1e-3..=1.0 + 1e-3).contains(&value);
                        assert!(within || output.name == "displacement", "{of}: {value}");
                    }
                }
                next += output.ty.components();
            }
        }
    }
}
