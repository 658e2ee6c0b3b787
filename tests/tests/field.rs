//! Graphs as strangers write them, of which the closed forms alone are wrong: `auto` finds that out
//! when it compiles, and is nowhere worse than a point.

use mipless::{Footprint, Method, Options, Texture};

/// Pixels along a side of a window.
const SIDE: usize = 40;
/// The widths of a pixel, in units of texture space.
const PIXELS: [f32; 5] = [0.005, 0.02, 0.0625, 0.25, 1.0];
/// By how much a window's error may be above that of a point: the truth's own noise.
const FLOOR: f64 = 0.004;

/// What people build of `fract`, `floor` and the like of coordinates `u` and `v`, of the ids `id` of
/// regions and `cell` of cells; the error of `o` that is allowed where a pixel is finest, and
/// anywhere.
const GRAPHS: [(&str, [f64; 2], &str); 24] = [
    (
        "stripes by floor and modulo",
        [0.01, 0.02],
        r#""x":{"type":"multiply","inputs":{"in1":{"node":"u"},"in2":8}},"f":{"type":"floor","inputs":{"in":{"node":"x"}}},"o":{"type":"modulo","inputs":{"in1":{"node":"f"},"in2":2}}"#,
    ),
    (
        "a grid by the minimum of two fracts",
        [0.02, 0.02],
        r#""x":{"type":"multiply","inputs":{"in1":{"node":"uv"},"in2":4}},"f":{"type":"fract","inputs":{"in":{"node":"x"}}},"p":{"type":"extract","inputs":{"in":{"node":"f"},"index":0}},"q":{"type":"extract","inputs":{"in":{"node":"f"},"index":1}},"m":{"type":"min","inputs":{"in1":{"node":"p"},"in2":{"node":"q"}}},"o":{"type":"step","inputs":{"in":{"node":"m"},"edge":0.2}}"#,
    ),
    (
        "a circle in every cell",
        [0.02, 0.02],
        r#""x":{"type":"multiply","inputs":{"in1":{"node":"uv"},"in2":4}},"f":{"type":"fract","inputs":{"in":{"node":"x"}}},"c":{"type":"subtract","inputs":{"in1":{"node":"f"},"in2":[0.5,0.5]}},"m":{"type":"magnitude","inputs":{"in":{"node":"c"}}},"o":{"type":"smoothstep","inputs":{"in":{"node":"m"},"low":0.3,"high":0.35}}"#,
    ),
    (
        "a checkerboard by the sum of two floors",
        [0.01, 0.02],
        r#""x":{"type":"multiply","inputs":{"in1":{"node":"uv"},"in2":6}},"f":{"type":"floor","inputs":{"in":{"node":"x"}}},"p":{"type":"extract","inputs":{"in":{"node":"f"},"index":0}},"q":{"type":"extract","inputs":{"in":{"node":"f"},"index":1}},"s":{"type":"add","inputs":{"in1":{"node":"p"},"in2":{"node":"q"}}},"o":{"type":"modulo","inputs":{"in1":{"node":"s"},"in2":2}}"#,
    ),
    (
        "crossing waves on turned axes",
        [0.01, 0.02],
        r#""t":{"type":"rotate2d","inputs":{"in":{"node":"uv"},"amount":30}},"x":{"type":"multiply","inputs":{"in1":{"node":"t"},"in2":[30,20]}},"w":{"type":"sin","inputs":{"in":{"node":"x"}}},"p":{"type":"extract","inputs":{"in":{"node":"w"},"index":0}},"q":{"type":"extract","inputs":{"in":{"node":"w"},"index":1}},"s":{"type":"max","inputs":{"in1":{"node":"p"},"in2":{"node":"q"}}},"o":{"type":"step","inputs":{"in":{"node":"s"},"edge":0.5}}"#,
    ),
    (
        "random colours of regions",
        [0.005, 0.013],
        r#""o":{"type":"randomcolor","inputs":{"in":{"node":"id"}}}"#,
    ),
    (
        "random colours of cells",
        [0.002, 0.01],
        r#""o":{"type":"randomcolor","inputs":{"in":{"node":"cell"}}}"#,
    ),
    (
        "steps of colour over cells",
        [0.002, 0.01],
        r##""o":{"type":"colorramp","inputs":{"in":{"node":"cell"},"interpolation":"constant","stops":[{"at":0,"value":"#204060"},{"at":0.3,"value":"#f0e0a0"},{"at":0.5,"value":"#803010"},{"at":1,"value":"#101010"}]}}"##,
    ),
    (
        "a hue, a threshold and a random number of cells, multiplied",
        [0.002, 0.01],
        r#""h":{"type":"combine3","inputs":{"in1":{"node":"cell"},"in2":0.8,"in3":0.7}},"c":{"type":"hsvtorgb","inputs":{"in":{"node":"h"}}},"s":{"type":"ifgreater","inputs":{"value1":{"node":"cell"},"value2":0.4,"in1":1,"in2":0.2}},"r":{"type":"randomfloat","inputs":{"in":{"node":"cell"},"min":0.5}},"d":{"type":"multiply","inputs":{"in1":{"node":"s"},"in2":{"node":"r"}}},"o":{"type":"multiply","inputs":{"in1":{"node":"c"},"in2":{"node":"d"}}}"#,
    ),
    (
        "random colours of cells in space",
        [0.005, 0.02],
        r#""s":{"type":"cellnoise3d","inputs":{"frequency":6}},"o":{"type":"randomcolor","inputs":{"in":{"node":"s"}}}"#,
    ),
    (
        "random colours of cells, in some cells over a noise",
        [0.005, 0.02],
        r#""c":{"type":"randomcolor","inputs":{"in":{"node":"cell"}}},"m":{"type":"step","inputs":{"in":{"node":"cell"},"edge":0.6}},"w":{"type":"noise2d","inputs":{"frequency":3,"amplitude":0.5,"pivot":0.5}},"o":{"type":"mix","inputs":{"bg":{"node":"w"},"fg":{"node":"c"},"mix":{"node":"m"}}}"#,
    ),
    (
        "random colours of bricks",
        [0.002, 0.01],
        r#""b":{"type":"brick","inputs":{"output":"random"}},"o":{"type":"randomcolor","inputs":{"in":{"node":"b"}}}"#,
    ),
    (
        "random colours of the steps of a coordinate",
        [0.002, 0.01],
        r#""x":{"type":"multiply","inputs":{"in1":{"node":"u"},"in2":6}},"f":{"type":"floor","inputs":{"in":{"node":"x"}}},"o":{"type":"randomcolor","inputs":{"in":{"node":"f"}}}"#,
    ),
    (
        "cells of a position that is rounded down",
        [0.002, 0.01],
        r#""x":{"type":"multiply","inputs":{"in1":{"node":"uv"},"in2":6}},"f":{"type":"floor","inputs":{"in":{"node":"x"}}},"o":{"type":"cellnoise2d","inputs":{"texcoord":{"node":"f"}}}"#,
    ),
    (
        "a hash of rounded coordinates by a sine",
        [0.002, 0.01],
        r#""x":{"type":"multiply","inputs":{"in1":{"node":"uv"},"in2":5}},"f":{"type":"round","inputs":{"in":{"node":"x"}}},"d":{"type":"dotproduct","inputs":{"in1":{"node":"f"},"in2":[12.9898,78.233]}},"s":{"type":"sin","inputs":{"in":{"node":"d"}}},"m":{"type":"multiply","inputs":{"in1":{"node":"s"},"in2":43758.5}},"o":{"type":"fract","inputs":{"in":{"node":"m"}}}"#,
    ),
    (
        "a random number of quantised coordinates, in some of their steps",
        [0.002, 0.01],
        r#""p":{"type":"quantize","inputs":{"in":{"node":"u"},"steps":5}},"y":{"type":"multiply","inputs":{"in1":{"node":"v"},"in2":4}},"q":{"type":"ceil","inputs":{"in":{"node":"y"}}},"j":{"type":"multiply","inputs":{"in1":{"node":"q"},"in2":57}},"s":{"type":"add","inputs":{"in1":{"node":"p"},"in2":{"node":"j"}}},"r":{"type":"randomfloat","inputs":{"in":{"node":"s"}}},"k":{"type":"modulo","inputs":{"in1":{"node":"q"},"in2":3}},"e":{"type":"ifgreater","inputs":{"value1":{"node":"k"},"value2":0.5,"in1":1,"in2":0.2}},"o":{"type":"multiply","inputs":{"in1":{"node":"r"},"in2":{"node":"e"}}}"#,
    ),
    (
        "random colours of the steps of a warped coordinate",
        [0.002, 0.04],
        r#""w":{"type":"noise2d","inputs":{"frequency":2,"amplitude":0.3}},"p":{"type":"add","inputs":{"in1":{"node":"u"},"in2":{"node":"w"}}},"x":{"type":"multiply","inputs":{"in1":{"node":"p"},"in2":6}},"f":{"type":"floor","inputs":{"in":{"node":"x"}}},"o":{"type":"randomcolor","inputs":{"in":{"node":"f"}}}"#,
    ),
    (
        "stripes of random colours over a ramp of their steps",
        [0.002, 0.01],
        r#""x":{"type":"multiply","inputs":{"in1":{"node":"u"},"in2":6}},"f":{"type":"floor","inputs":{"in":{"node":"x"}}},"c":{"type":"randomcolor","inputs":{"in":{"node":"f"}}},"g":{"type":"multiply","inputs":{"in1":{"node":"f"},"in2":0.005}},"o":{"type":"add","inputs":{"in1":{"node":"c"},"in2":{"node":"g"}}}"#,
    ),
    (
        "a ramp of the steps of a coordinate",
        [0.01, 0.02],
        r##""x":{"type":"multiply","inputs":{"in1":{"node":"v"},"in2":5}},"f":{"type":"fract","inputs":{"in":{"node":"x"}}},"s":{"type":"multiply","inputs":{"in1":{"node":"f"},"in2":4}},"r":{"type":"floor","inputs":{"in":{"node":"s"}}},"o":{"type":"colorramp","inputs":{"in":{"node":"r"},"stops":[{"at":0,"value":"#204060"},{"at":1,"value":"#f0e0a0"},{"at":2,"value":"#803010"},{"at":3,"value":"#101010"}]}}"##,
    ),
    (
        "what a division of bricks with soft edges by more than their height leaves",
        [0.001, 0.005],
        r#""b":{"type":"brick","inputs":{"output":"mask","bevel":0.3}},"o":{"type":"modulo","inputs":{"in1":{"node":"b"},"in2":1.141}}"#,
    ),
    (
        "random colours of bricks over a grey, by random numbers of regions",
        [0.002, 0.015],
        r#""b":{"type":"brick","inputs":{"output":"random"}},"c":{"type":"randomcolor","inputs":{"in":{"node":"b"}}},"r":{"type":"randomfloat","inputs":{"in":{"node":"id"}}},"o":{"type":"mix","inputs":{"bg":0.3,"fg":{"node":"c"},"mix":{"node":"r"}}}"#,
    ),
    (
        "random colours of the sum of the numbers of two things",
        [0.01, 0.07],
        r#""s":{"type":"add","inputs":{"in1":{"node":"id"},"in2":{"node":"cell"}}},"o":{"type":"randomcolor","inputs":{"in":{"node":"s"}}}"#,
    ),
    (
        "a wave of a coordinate, in some steps of a noise",
        [0.002, 0.025],
        r#""x":{"type":"multiply","inputs":{"in1":{"node":"u"},"in2":40}},"w":{"type":"sin","inputs":{"in":{"node":"x"}}},"n":{"type":"noise2d","inputs":{"frequency":5,"pivot":0.5}},"p":{"type":"multiply","inputs":{"in1":{"node":"w"},"in2":{"node":"n"}}},"m":{"type":"step","inputs":{"in":{"node":"p"},"edge":0.1}},"o":{"type":"mix","inputs":{"bg":{"node":"n"},"fg":{"node":"w"},"mix":{"node":"m"}}}"#,
    ),
    (
        "coordinates that repeat",
        [0.02, 0.02],
        r#""o":{"type":"repeat","inputs":{"uvtiling":[2.5,-3]}}"#,
    ),
];

fn texture(nodes: &str) -> Texture {
    let json = format!(
        r#"{{"version":1,"name":"field","nodes":{{
            "uv":{{"type":"texcoord"}},
            "u":{{"type":"extract","inputs":{{"in":{{"node":"uv"}},"index":0}}}},
            "v":{{"type":"extract","inputs":{{"in":{{"node":"uv"}},"index":1}}}},
            "id":{{"type":"worleynoise2d","inputs":{{"frequency":6,"style":"solid"}}}},
            "cell":{{"type":"cellnoise2d","inputs":{{"frequency":6}}}},
            {nodes}}},"outputs":{{"out":{{"node":"o"}}}}}}"#
    );
    Texture::from_json(&json).unwrap_or_else(|mistakes| panic!("{nodes}: {mistakes:?}"))
}

/// Straight windows of pixels of each size.
fn footprints() -> Vec<Footprint> {
    let mut footprints = Vec::new();
    for pixel in PIXELS {
        for i in 0..SIDE * SIDE {
            let at = [i % SIDE, i / SIDE].map(|i| 0.137 + (i as f32 + 0.5) * pixel);
            footprints.push(Footprint {
                cell: at.map(|x| x.floor() as i32),
                uv: at.map(|x| x - x.floor()),
                du: [pixel, 0.0],
                dv: [0.0, pixel],
            });
        }
    }
    footprints
}

fn values(texture: &Texture, method: Method) -> Vec<Vec<f32>> {
    let options = Options {
        method,
        ..Options::default()
    };
    texture.evaluator(&options).evaluate(&footprints())
}

/// The root mean square difference in each window, as a display shows it.
fn errors(found: &[Vec<f32>], truth: &[Vec<f32>]) -> Vec<f64> {
    let pixels = SIDE * SIDE;
    (0..PIXELS.len())
        .map(|window| {
            let of_window = window * pixels..(window + 1) * pixels;
            let squares = (found.iter().zip(truth)).flat_map(|(found, truth)| {
                let of_window = of_window.clone();
                of_window.map(|i| {
                    let [x, y] = [found[i], truth[i]]
                        .map(|x| f64::from(mipless_runtime::srgb::srgb_from_linear(x)));
                    (x - y).powi(2)
                })
            });
            (squares.sum::<f64>() / (pixels * found.len()) as f64).sqrt()
        })
        .collect()
}

#[test]
fn graphs_of_strangers_are_filtered() {
    let mut wrong = Vec::new();
    for (name, [finest, any], nodes) in GRAPHS {
        let texture = texture(nodes);
        let truth = values(&texture, Method::Supersample(1024));
        let [auto, point] =
            [Method::Auto, Method::Point].map(|method| errors(&values(&texture, method), &truth));
        println!("{name}: auto {auto:.4?}, point {point:.4?}");
        for (window, (&auto, &point)) in auto.iter().zip(&point).enumerate() {
            let bound = if window == 0 { finest } else { any };
            if auto > bound || auto > point + FLOOR {
                let pixel = PIXELS[window];
                wrong.push(format!("{name} at {pixel}: {auto:.4}, point {point:.4}"));
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// What follows the numbers of cells, regions and bricks at an input that is not at its default: a
/// threshold, and colours where it is passed, as two outputs.
#[test]
fn what_follows_things_follows_live_inputs() {
    let sources = [
        r#""cellnoise2d","inputs":{"frequency":6}"#,
        r#""worleynoise2d","inputs":{"frequency":6,"style":"solid"}"#,
        r#""brick","inputs":{"output":"random"}"#,
    ];
    for source in sources {
        let json = format!(
            r#"{{"version":1,"name":"field","inputs":{{"edge":{{"type":"float","value":0.5,"min":0,"max":1}}}},"nodes":{{
                "id":{{"type":{source}}},
                "mask":{{"type":"step","inputs":{{"in":{{"node":"id"}},"edge":{{"input":"edge"}}}}}},
                "color":{{"type":"randomcolor","inputs":{{"in":{{"node":"id"}}}}}},
                "some":{{"type":"multiply","inputs":{{"in1":{{"node":"color"}},"in2":{{"node":"mask"}}}}}}
            }},"outputs":{{"mask":{{"node":"mask"}},"some":{{"node":"some"}}}}}}"#
        );
        let texture = Texture::from_json(&json).expect("a graph");
        let [auto, truth] = [Method::Auto, Method::Supersample(1024)].map(|method| {
            let options = Options {
                method,
                ..Options::default()
            };
            let mut evaluator = texture.evaluator(&options);
            evaluator.set("edge", &[0.3]).expect("an input");
            evaluator.evaluate(&footprints())
        });
        let errors = errors(&auto, &truth);
        println!("{source}: {errors:.4?}");
        let bounds = [0.012, 0.015, 0.02, 0.02, 0.012];
        assert!(
            errors
                .iter()
                .zip(bounds)
                .all(|(&error, bound)| error <= bound),
            "{source}: {errors:.4?}"
        );
    }
}

/// Where points inside the footprint take the place of a closed form that is wrong, what inputs of the
/// graph shape has the same far field everywhere, as what none shapes has; and the right mean wherever
/// the inputs are.
#[test]
fn points_of_what_inputs_shape_find_their_far_field() {
    let json = r#"{"version":1,"name":"field","inputs":{"edge":{"type":"float","value":0.6,"min":0.3,"max":0.9}},"nodes":{
        "id":{"type":"worleynoise2d","inputs":{"frequency":6,"style":"solid","output":"F2"}},
        "first":{"type":"worleynoise2d","inputs":{"frequency":6,"style":"solid"}},
        "sum":{"type":"add","inputs":{"in1":{"node":"id"},"in2":{"node":"first"}}},
        "number":{"type":"randomfloat","inputs":{"in":{"node":"sum"}}},
        "mask":{"type":"step","inputs":{"in":{"node":"number"},"edge":{"input":"edge"}}}
    },"outputs":{"mask":{"node":"mask"}}}"#;
    let texture = Texture::from_json(json).expect("a graph");
    let pixels: Vec<Footprint> = (0..400)
        .map(|i| Footprint {
            du: [100.0, 0.0],
            dv: [0.0, 100.0],
            ..Footprint::point([i % 20, i / 20].map(|i| 0.3 + 77.7 * f64::from(i)))
        })
        .collect();
    for edge in [0.6, 0.35, 0.85] {
        let mut evaluator = texture.evaluator(&Options::default());
        evaluator.set("edge", &[edge]).expect("an input");
        let values = &evaluator.evaluate(&pixels)[0];
        let mean = values.iter().sum::<f32>() / values.len() as f32;
        let apart = values.iter().map(|x| (x - mean).abs()).fold(0.0, f32::max);
        println!("edge {edge}: mean {mean}, apart {apart}");
        let is_default = edge == 0.6;
        assert!(!is_default || apart < 0.01, "{apart} at {edge}");
        // Three deviations of the mean of 2,800 points.
        assert!((mean - (1.0 - edge)).abs() < 0.03, "{mean} at {edge}");
    }
}
