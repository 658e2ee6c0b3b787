//! What comes from outside is anybody's: a document, a text of the IR, a value of `--set`, a picture.
//! Whatever bytes it is, it is taken, or refused with a reason and a place; nothing panics or hangs.
//!
//! The same inputs in every run; `MIPLESS_FUZZ=600 cargo test -p mipless-tests --test fuzz NAME`
//! looks at others for so many seconds.

use exr::prelude::{self as openexr, WritableImage};
use image::{DynamicImage, ImageFormat};
use mipless::{Diagnostic, Footprint, Method, Options, Texture};
use mipless_codegen::ir::{Module, verify};
use mipless_graph::{CheckOptions, Literal, Type, parse_setting};
use mipless_tests::case::{all, examples, load};
use mipless_tests::mutation::Kind;
use mipless_tests::random::Random;
use std::collections::BTreeMap;
use std::io::Cursor;

fn options(method: Method) -> Options {
    Options {
        method,
        ..Options::default()
    }
}

/// Every mistake says where it is, and what.
fn located(mistakes: &[Diagnostic]) {
    assert!(!mistakes.is_empty(), "refused without a reason");
    for mistake in mistakes {
        let is_placed = mistake.line.is_some() || mistake.pointer.is_some();
        assert!(is_placed, "{mistake} stands nowhere");
        assert!(!mistake.message.is_empty(), "{} is mute", mistake.code);
    }
}

/// A texture that was accepted has finite values, by a point and filtered.
fn finite(texture: &Texture) {
    let footprints = [0.0, 1e-3, 1.0, 1e6].map(|size| Footprint {
        uv: [0.3, 0.7],
        du: [size, 0.0],
        dv: [0.0, size],
        ..Footprint::default()
    });
    for method in [Method::Point, Method::Local] {
        let values = texture.evaluator(&options(method)).evaluate(&footprints);
        let finite = values.iter().flatten().all(|x| x.is_finite());
        assert!(finite, "{method}: {values:?}");
    }
}

#[test]
fn bytes_are_a_graph_or_located_mistakes() {
    let kind = Kind {
        name: "document",
        sound: all().into_iter().map(|case| case.text.into()).collect(),
        words: &[
            b"\"node\"",
            b"\"input\"",
            b"\"graph:part\"",
            b"\"graphs\"",
            b"\"outputs\"",
            b"null",
            b"true",
            b"{}",
            b"[]",
            b"[[",
            b"\\u0000",
            b"\\ud800",
            b"\xff",
            b"\xef\xbb\xbf",
            b"\"\"",
            b"\"type\": \"noise2d\"",
            b"\"version\": 2",
            b"#ffffff",
            b"1e38",
            b"\"extra\": {}",
            b"//",
            b",",
            b":",
        ],
        usual: 4000,
    };
    kind.try_inputs(|bytes| match std::str::from_utf8(bytes) {
        Ok(text) => match load(text) {
            Ok(texture) => finite(&texture),
            Err(mistakes) => located(&mistakes),
        },
        // A text is what the face takes; a file that is none is refused where it is read.
        Err(_) => {
            if let Err(mistakes) = load(&String::from_utf8_lossy(bytes)) {
                located(&mistakes);
            }
        }
    });
}

#[test]
fn bytes_are_a_module_or_a_mistake_in_a_line() {
    let text = |texture: &Texture, method| texture.compile(&options(method)).module.to_string();
    let cases = examples();
    let sound = (cases.iter().step_by(9))
        .flat_map(|case| {
            [Method::Point, Method::Quad].map(|method| text(&case.texture, method).into_bytes())
        })
        .collect();
    let kind = Kind {
        name: "ir",
        sound,
        words: &[
            b"f32",
            b"i32",
            b"u32",
            b"bool",
            b"fold",
            b"call",
            b"select",
            b"fn ",
            b"table",
            b"return",
            b"%0",
            b"%4294967295",
            b"=",
            b"(",
            b")",
            b"{",
            b"}",
            b",",
            b"\n",
            b"nan",
            b"inf",
            b"->",
        ],
        usual: 4000,
    };
    kind.try_inputs(|bytes| {
        let text = String::from_utf8_lossy(bytes);
        match Module::parse(&text) {
            Ok(module) => {
                // What is read may be no valid module, and is written and read as it is.
                let valid = verify(&module).is_ok();
                let again = Module::parse(&module.to_string());
                let again = again.unwrap_or_else(|error| panic!("{error}:\n{module}"));
                assert_eq!(again.to_string(), module.to_string());
                assert_eq!(verify(&again).is_ok(), valid);
            }
            Err(error) => {
                let lines = text.lines().count();
                assert!(error.line <= lines, "line {} of {lines}", error.line);
                assert!(!error.message.is_empty());
            }
        }
    });
}

/// A graph with an input of every type, in bounds.
const INPUTS: &str = r##"{ "version": 1, "inputs": {
  "f": { "type": "float", "value": 1, "min": 0.5, "max": 2 },
  "i": { "type": "integer", "value": 3, "min": 1, "max": 8 },
  "v": { "type": "vector2", "value": [0.1, 0.2], "min": -1, "max": 1 },
  "w": { "type": "vector3", "value": [0.1, 0.2, 0.3] },
  "c": { "type": "color3", "value": "#c08a52" }
}, "nodes": {
  "n": { "type": "fractal2d", "inputs": { "pivot": { "input": "i" }, "amplitude": { "input": "f" } } },
  "a": { "type": "multiply", "inputs": { "in1": { "node": "n" }, "in2": { "input": "c" } } },
  "b": { "type": "multiply", "inputs": { "in1": { "node": "n" }, "in2": { "input": "v" } } },
  "d": { "type": "multiply", "inputs": { "in1": { "node": "n" }, "in2": { "input": "w" } } }
}, "outputs": { "a": { "node": "a" }, "b": { "node": "b" }, "d": { "node": "d" } } }"##;

#[test]
fn bytes_are_the_value_of_an_input_or_refused() {
    const TYPES: [Type; 10] = [
        Type::Float,
        Type::Integer,
        Type::Boolean,
        Type::Vector2,
        Type::Vector3,
        Type::Vector4,
        Type::Color3,
        Type::Color4,
        Type::String,
        Type::Filename,
    ];
    let texture = Texture::from_json(INPUTS).expect("a graph");
    let sound = [
        "0.5",
        "1e-3",
        "3",
        "-1",
        "true",
        "false",
        "0.1, 0.2",
        "0.1,0.2,0.3",
        "1,2,3,4",
        "#c08a52",
        "#fff",
        "#11223344",
        "a text",
        "  7 ",
    ];
    let kind = Kind {
        name: "setting",
        sound: sound.map(|text| text.as_bytes().to_vec()).to_vec(),
        words: &[
            b"#",
            b",",
            b"nan",
            b"inf",
            b"-",
            b"e",
            b"1e999",
            b"\xc3\xa9",
            b"\xff",
            b"0x1",
            b"_",
            b" ",
            b"\0",
            b"1e-46",
            b"16777217",
            b"3.4028236e38",
        ],
        usual: 20_000,
    };
    let evaluator = std::cell::RefCell::new(texture.evaluator(&options(Method::Local)));
    kind.try_inputs(|bytes| {
        let text = String::from_utf8_lossy(bytes);
        for ty in TYPES {
            match parse_setting(ty, &text) {
                Ok(Literal::Text(taken)) => assert_eq!(taken, text),
                Ok(value) => {
                    let numbers = value.numbers();
                    assert!(numbers.iter().all(|x| x.is_finite()), "{numbers:?}");
                    assert_eq!(numbers.len(), ty.components().max(1), "{ty:?}: {value:?}");
                }
                Err(error) => assert!(!error.to_string().is_empty()),
            }
        }
        for parameter in texture.parameters() {
            let Ok(value) = parameter.parse(&text) else {
                continue;
            };
            let mut evaluator = evaluator.borrow_mut();
            let set = evaluator.set(&parameter.name, &value.numbers());
            assert_eq!(set, Ok(()), "{} = {value:?}", parameter.name);
            let values = evaluator.evaluate(&[Footprint::default()]);
            assert!(values.iter().flatten().all(|x| x.is_finite()), "{values:?}");
        }
    });
}

/// A small picture of random texels, as every codec that graphs may name.
fn pictures() -> Vec<Vec<u8>> {
    let mut random = Random::new(5);
    let (width, height) = (9, 5);
    let picture = image::RgbaImage::from_fn(width, height, |_, _| {
        image::Rgba([0; 4].map(|_: u8| random.bits() as u8))
    });
    let picture = DynamicImage::ImageRgba8(picture);
    let as_file = |picture: &DynamicImage, format| {
        let mut file = Cursor::new(Vec::new());
        picture.write_to(&mut file, format).expect("a picture");
        file.into_inner()
    };
    let mut all = vec![
        as_file(&picture, ImageFormat::Png),
        as_file(&picture.to_luma8().into(), ImageFormat::Png),
        as_file(&picture.to_luma_alpha16().into(), ImageFormat::Png),
        as_file(&picture.to_rgb16().into(), ImageFormat::Png),
        as_file(&picture.to_rgb8().into(), ImageFormat::Jpeg),
        as_file(&picture.to_luma8().into(), ImageFormat::Jpeg),
    ];
    use openexr::{Blocks, Compression, Encoding, LineOrder, Vec2};
    let blocks = [Blocks::ScanLines, Blocks::Tiles(Vec2(4, 4))];
    let compressions = [
        Compression::Uncompressed,
        Compression::RLE,
        Compression::ZIP1,
        Compression::ZIP16,
        Compression::PIZ,
        Compression::PXR24,
        Compression::B44,
    ];
    for (turn, compression) in compressions.into_iter().enumerate() {
        let numbers: Vec<f32> = (0..width * height)
            .map(|_| random.within(-2.0, 70_000.0) as f32)
            .collect();
        let halves = numbers.iter().map(|&x| openexr::f16::from_f32(x)).collect();
        let samples = if turn % 2 == 0 {
            openexr::FlatSamples::F16(halves)
        } else {
            openexr::FlatSamples::F32(numbers)
        };
        let channels = ["R", "G", "B"].map(|name| openexr::AnyChannel::new(name, samples.clone()));
        let layer = openexr::Layer::new(
            (width as usize, height as usize),
            openexr::LayerAttributes::default(),
            Encoding {
                compression,
                blocks: blocks[turn % 2],
                line_order: LineOrder::Increasing,
            },
            openexr::AnyChannels::sort(channels.to_vec().into()),
        );
        let mut file = Cursor::new(Vec::new());
        let image = openexr::Image::from_layer(layer);
        let written = image.write().to_buffered(&mut file);
        written.expect("an OpenEXR file");
        all.push(file.into_inner());
    }
    all
}

#[test]
fn bytes_are_a_picture_or_refused_where_they_are_named() {
    const WALL: &str = r#"{ "version": 1, "nodes": {
  "wall": { "type": "image", "inputs": { "file": "wall" } }
}, "outputs": { "out": { "node": "wall" } } }"#;
    let kind = Kind {
        name: "picture",
        sound: pictures(),
        words: &[
            b"IHDR",
            b"IDAT",
            b"IEND",
            b"PLTE",
            b"tRNS",
            b"iCCP",
            b"\xff\xd8",
            b"\xff\xd9",
            b"\xff\xda",
            b"\xff\xc0",
            b"\xff\xc2",
            b"\xff\xdd",
            b"\0\0\0\0",
            b"\xff\xff\xff\xff",
            b"\x7f\xff\xff\xff",
            b"\x80\0\0\0",
            b"compression\0",
            b"dataWindow\0",
            b"tiles\0",
            b"\x76\x2f\x31\x01",
        ],
        usual: 3000,
    };
    kind.try_inputs(|bytes| {
        let files = BTreeMap::from([("wall".to_owned(), bytes.to_vec())]);
        match Texture::with_files(WALL, &CheckOptions::default(), &files) {
            Ok(texture) => finite(&texture),
            Err(mistakes) => {
                located(&mistakes);
                let place = Some("/nodes/wall/inputs/file");
                assert!(mistakes.iter().any(|m| m.pointer.as_deref() == place));
            }
        }
    });
}
