//! Files that graphs name: every format, and every mistake where it stands.

use exr::prelude::{self as openexr, WritableImage};
use image::{DynamicImage, ExtendedColorType, ImageEncoder};
use mipless::{Diagnostic, Files, Folder, Footprint, LARGEST_FILE, Method, Options, Texture};
use mipless_graph::CheckOptions;
use std::collections::BTreeMap;
use std::io::{self, Cursor};

fn graph(file: &str, more: &str) -> String {
    format!(
        r#"{{ "version": 1, "name": "test", "nodes": {{
  "wall": {{ "type": "image", "inputs": {{ "file": {file:?}{more} }} }}
}}, "outputs": {{ "out": {{ "node": "wall" }} }} }}"#
    )
}

fn load(text: &str, files: &dyn Files) -> Result<Texture, Vec<Diagnostic>> {
    Texture::with_files(text, &CheckOptions::default(), files)
}

fn one(name: &str, bytes: Vec<u8>) -> BTreeMap<String, Vec<u8>> {
    BTreeMap::from([(name.to_owned(), bytes)])
}

/// The outputs at the middle of the texel in column x of row y of a picture of 4 × 2 texels.
fn texel(texture: &Texture, x: usize, y: usize) -> Vec<f32> {
    let options = Options {
        method: Method::Point,
        ..Options::default()
    };
    let uv = [(x as f32 + 0.5) / 4.0, (y as f32 + 0.5) / 2.0];
    let at = Footprint {
        uv,
        ..Footprint::default()
    };
    let outputs = texture.evaluator(&options).evaluate(&[at]);
    outputs.iter().map(|channel| channel[0]).collect()
}

fn png(bytes: &[u8], color: ExtendedColorType) -> Vec<u8> {
    let mut file = Vec::new();
    image::codecs::png::PngEncoder::new(&mut file)
        .write_image(bytes, 4, 2, color)
        .expect("a PNG");
    file
}

fn exr(numbers: Vec<f32>, half: bool) -> Vec<u8> {
    let samples = if half {
        let halves = numbers.iter().map(|&x| openexr::f16::from_f32(x));
        openexr::FlatSamples::F16(halves.collect())
    } else {
        openexr::FlatSamples::F32(numbers)
    };
    let channels = ["R", "G", "B"].map(|name| openexr::AnyChannel::new(name, samples.clone()));
    let layer = openexr::Layer::new(
        (4, 2),
        openexr::LayerAttributes::default(),
        openexr::Encoding::SMALL_LOSSLESS,
        openexr::AnyChannels::sort(channels.to_vec().into()),
    );
    let mut file = Cursor::new(Vec::new());
    openexr::Image::from_layer(layer)
        .write()
        .to_buffered(&mut file)
        .expect("an EXR");
    file.into_inner()
}

fn jpeg() -> Vec<u8> {
    let picture = image::RgbImage::from_fn(4, 2, |_, _| image::Rgb([200, 100, 50]));
    let mut file = Cursor::new(Vec::new());
    DynamicImage::ImageRgb8(picture)
        .write_to(&mut file, image::ImageFormat::Jpeg)
        .expect("a JPEG");
    file.into_inner()
}

fn near(found: &[f32], wanted: &[f32], tolerance: f32) {
    assert_eq!(found.len(), wanted.len(), "{found:?} for {wanted:?}");
    for (f, w) in found.iter().zip(wanted) {
        assert!((f - w).abs() <= tolerance, "{found:?} for {wanted:?}");
    }
}

#[test]
fn every_format_and_depth_is_read() {
    // Texel (1, 1) is 128 of 255 red, the others black.
    let mut bytes = [0; 24];
    bytes[15] = 128;
    let linear = 0.215_860_5;
    let small = one("a.png", png(&bytes, ExtendedColorType::Rgb8));
    let texture = load(&graph("a.png", ""), &small).expect("a PNG");
    near(&texel(&texture, 1, 1), &[linear, 0.0, 0.0], 1e-6);
    near(&texel(&texture, 2, 1), &[0.0; 3], 1e-6);
    let raw = graph("a.png", r#", "colorspace": "lin_rec709""#);
    let texture = load(&raw, &small).expect("a PNG");
    near(&texel(&texture, 1, 1), &[128.0 / 255.0, 0.0, 0.0], 1e-6);
    // One number is data.
    let float = graph("a.png", r#", "signature": "float""#);
    let texture = load(&float, &small).expect("a PNG");
    near(&texel(&texture, 1, 1), &[128.0 / 255.0], 1e-6);
    let color4 = graph("a.png", r#", "signature": "color4""#);
    let texture = load(&color4, &small).expect("a PNG");
    near(&texel(&texture, 1, 1), &[linear, 0.0, 0.0, 1.0], 1e-6);

    let words: Vec<u8> = (0..8u16).flat_map(|i| (i * 9000).to_ne_bytes()).collect();
    let files = one("a.png", png(&words, ExtendedColorType::L16));
    let texture = load(&float, &files).expect("a PNG of 16 bits");
    near(&texel(&texture, 3, 1), &[63000.0 / 65535.0], 1e-6);

    for half in [false, true] {
        let files = one("a.exr", exr((0..8).map(|i| i as f32 - 2.5).collect(), half));
        let texture = load(&graph("a.exr", ""), &files).expect("an EXR");
        near(&texel(&texture, 3, 1), &[4.5; 3], 1e-6);
        near(&texel(&texture, 0, 0), &[-2.5; 3], 1e-6);
    }
    let texture = load(&graph("a.jpg", ""), &one("a.jpg", jpeg())).expect("a JPEG");
    near(&texel(&texture, 2, 0), &[0.578, 0.127, 0.032], 0.02);
    let fine: Vec<u8> = texture.warnings().iter().map(|_| 1).collect();
    assert!(fine.is_empty(), "no warnings of a sound file");
}

/// The only error of a graph with this file, which is located.
fn mistake(text: &str, files: &dyn Files) -> Diagnostic {
    let mistakes = load(text, files).expect_err("a mistake");
    assert_eq!(mistakes.len(), 1, "{mistakes:?}");
    let mistake = mistakes[0].clone();
    assert!(mistake.is_error());
    assert_eq!(mistake.pointer.as_deref(), Some("/nodes/wall/inputs/file"));
    assert_eq!(
        (mistake.line, mistake.node.as_deref()),
        (Some(2), Some("wall"))
    );
    assert_eq!(mistake.port.as_deref(), Some("file"));
    mistake
}

struct Endless;

impl Files for Endless {
    fn read(&self, _: &str) -> io::Result<Vec<u8>> {
        Err(io::ErrorKind::FileTooLarge.into())
    }
}

#[test]
fn files_that_cannot_be_used_are_located_errors() {
    let folder = tempfile::tempdir().expect("a folder");
    let here = Folder(folder.path().to_path_buf());
    let text = graph("a.png", "");
    assert_eq!(mistake(&text, &here).code, "missing-file");
    std::fs::create_dir(folder.path().join("a.png")).expect("a folder");
    let error = mistake(&text, &here);
    assert_eq!(error.code, "unreadable-file");
    assert!(error.message.contains("folder"), "{error}");
    assert_eq!(mistake(&text, &Endless).code, "image-too-large");
    let sparse = std::fs::File::create(folder.path().join("large.png")).expect("a file");
    sparse.set_len(LARGEST_FILE + 1).expect("a sparse file");
    let large = mistake(&graph("large.png", ""), &here);
    assert_eq!(large.code, "image-too-large");

    let other = mistake(&graph("a.txt", ""), &one("a.txt", b"no picture".to_vec()));
    assert_eq!(other.code, "not-an-image");
    assert_eq!(
        mistake(&text, &one("a.png", Vec::new())).code,
        "not-an-image"
    );
    // The content decides, not the name.
    let renamed = one("a.txt", png(&[9; 8], ExtendedColorType::L8));
    load(&graph("a.txt", ""), &renamed).expect("a PNG by its content");
    let nothing = Texture::from_json(&text).expect_err("a text has no folder");
    assert_eq!(nothing[0].code, "missing-file");
}

#[test]
fn a_colour_map_reads_its_picture_and_locates_its_mistakes() {
    let text = r#"{ "version": 1, "name": "test", "nodes": {
  "wall": { "type": "colormap2d", "inputs": { "in1": 0.375, "in2": 0.75, "file": "a.png" } }
}, "outputs": { "out": { "node": "wall" } } }"#;
    // Texel (1, 1) is 128 of 255 red, the others black.
    let mut bytes = [0; 24];
    bytes[15] = 128;
    let sound = png(&bytes, ExtendedColorType::Rgb8);
    let texture = load(text, &one("a.png", sound.clone())).expect("a PNG");
    near(&texel(&texture, 0, 0), &[0.215_860_5, 0.0, 0.0], 1e-6);
    let raw = text.replace("a.png\"", "a.png\", \"colorspace\": \"lin_rec709\"");
    let texture = load(&raw, &one("a.png", sound.clone())).expect("a PNG");
    near(&texel(&texture, 0, 0), &[128.0 / 255.0, 0.0, 0.0], 1e-6);

    assert_eq!(mistake(text, &BTreeMap::new()).code, "missing-file");
    let cut = sound[..sound.len() / 2].to_vec();
    assert_eq!(mistake(text, &one("a.png", cut)).code, "bad-image");
    assert_eq!(mistake(text, &Endless).code, "image-too-large");
}

#[test]
fn pictures_too_large_are_refused_before_they_are_decoded() {
    // The size stands in the first chunk; its checksum is not looked at before.
    let mut file = png(&[9; 8], ExtendedColorType::L8);
    file[16..24].copy_from_slice(&[0, 0, 0x40, 1, 0, 0, 0, 1]);
    let crc = crc32(&file[12..29]);
    file[29..33].copy_from_slice(&crc.to_be_bytes());
    let error = mistake(&graph("a.png", ""), &one("a.png", file));
    assert_eq!(error.code, "image-too-large", "{error}");
    assert!(error.message.contains("16385×1"), "{error}");
}

fn crc32(bytes: &[u8]) -> u32 {
    let step = |crc: u32, byte: &u8| {
        (0..8).fold(crc ^ u32::from(*byte), |crc, _| {
            (crc >> 1) ^ (0xedb8_8320 & (crc & 1).wrapping_neg())
        })
    };
    !bytes.iter().fold(!0, step)
}

#[test]
fn mistakes_of_files_are_collected_with_all_others() {
    let text = r#"{ "version": 1, "name": "test", "nodes": {
        "a": { "type": "image", "inputs": { "file": "no.png", "uvtilin": 2 } },
        "b": { "type": "image", "inputs": { "file": "no.png" } },
        "c": { "type": "nose2d" }
    }, "outputs": { "out": { "node": "a" } } }"#;
    let mistakes = Texture::from_json(text).expect_err("mistakes");
    let found: Vec<&str> = mistakes.iter().map(|mistake| mistake.code).collect();
    let errors = [
        "missing-file",
        "unknown-port",
        "missing-file",
        "unknown-node-type",
    ];
    for code in errors {
        assert!(found.contains(&code), "{code} of {found:?}");
    }
    assert_eq!(
        found.iter().filter(|code| **code == "missing-file").count(),
        2
    );
}

#[test]
fn numbers_that_are_not_finite_are_replaced_with_a_warning() {
    let mut numbers = vec![1.0; 8];
    numbers[0] = f32::NAN;
    numbers[7] = f32::NEG_INFINITY;
    let files = one("a.exr", exr(numbers, false));
    let texture = load(&graph("a.exr", ""), &files).expect("a warning only");
    let warning = &texture.warnings()[0];
    assert_eq!(warning.code, "not-finite-texels");
    assert_eq!(warning.pointer.as_deref(), Some("/nodes/wall/inputs/file"));
    near(&texel(&texture, 0, 0), &[0.0; 3], 0.0);
    near(&texel(&texture, 3, 1), &[-65504.0; 3], 0.1);
}

#[test]
fn damaged_files_are_refused_or_read_but_never_a_panic() {
    let noise: Vec<u8> = (0..24u8).map(|i| i.wrapping_mul(37)).collect();
    let originals = [
        png(&noise, ExtendedColorType::Rgb8),
        jpeg(),
        exr((0..8).map(|i| i as f32).collect(), false),
    ];
    let text = graph("a", "");
    let mut refused = 0;
    for original in &originals {
        for cut in (1..original.len()).step_by(7) {
            let files = one("a", original[..cut].to_vec());
            refused += usize::from(load(&text, &files).is_err());
        }
        for place in 0..original.len() {
            let mut damaged = original.clone();
            damaged[place] ^= 1 << (place % 8);
            let files = one("a", damaged);
            if let Err(mistakes) = load(&text, &files) {
                assert!(mistakes.iter().all(|m| m.line.is_some()), "{mistakes:?}");
                refused += 1;
            }
        }
    }
    assert!(refused > 100, "{refused} damaged files are refused");
}

#[test]
fn a_file_that_is_cut_off_is_a_located_mistake_wherever_it_is_cut() {
    let noise: Vec<u8> = (0..24u8).map(|i| i.wrapping_mul(37)).collect();
    // Behind the texels a PNG has twelve more bytes.
    let originals = [
        (png(&noise, ExtendedColorType::Rgb8), 12),
        (jpeg(), 0),
        (exr((0..8).map(|i| i as f32).collect(), false), 0),
    ];
    for (original, rest) in &originals {
        for cut in 1..original.len() - rest {
            let files = one("a", original[..cut].to_vec());
            let mistakes = load(&graph("a", ""), &files).map(|_| cut);
            let mistakes = mistakes.expect_err("a part of a picture");
            assert!(
                mistakes.iter().all(|m| m.line.is_some()),
                "{cut}: {mistakes:?}"
            );
        }
    }
}

#[test]
fn a_preview_in_a_jpeg_does_not_end_it() {
    let whole = jpeg();
    // An APP1 segment with a preview of its own, as cameras write it.
    let preview = [&[0xff, 0xe1, 0, 8][..], b"Exif", &[0xff, 0xd9]].concat();
    let with_preview = [&whole[..2], &preview, &whole[2..]].concat();
    let files = one("a.jpg", with_preview.clone());
    load(&graph("a.jpg", ""), &files).expect("a picture with a preview");
    let files = one("a.jpg", with_preview[..with_preview.len() - 2].to_vec());
    assert_eq!(mistake(&graph("a.jpg", ""), &files).code, "bad-image");
}

/// A chunk of a PNG.
fn chunk(kind: &[u8; 4], data: &[u8]) -> Vec<u8> {
    let named = [&kind[..], data].concat();
    let length = (data.len() as u32).to_be_bytes();
    [&length[..], &named, &crc32(&named).to_be_bytes()].concat()
}

#[test]
fn a_profile_takes_no_more_memory_than_its_bound() {
    let whole = png(&[7; 24], ExtendedColorType::Rgb8);
    // A chunk that is larger than the bound is left out or refused; else the picture is as it was.
    for kind in [b"iCCP", b"eXIf", b"tEXt"] {
        let profile = chunk(kind, &[b"p\0\0".to_vec(), vec![0; 16 << 20]].concat());
        let file = [&whole[..33], &profile, &whole[33..]].concat();
        match load(&graph("a.png", ""), &one("a.png", file)) {
            Ok(texture) => near(&texel(&texture, 1, 1), &[0.002; 3], 1e-3),
            Err(mistakes) => assert!(
                mistakes.iter().all(|m| m.code == "bad-image"),
                "{mistakes:?}"
            ),
        }
    }
}

#[test]
fn numbers_near_the_largest_have_a_mean_and_a_variance() {
    let mut numbers = vec![0.5; 8];
    numbers[1] = 3e38;
    numbers[2] = -3e38;
    numbers[5] = f32::NAN;
    numbers[6] = f32::INFINITY;
    let files = one("a.exr", exr(numbers, false));
    let texture = load(&graph("a.exr", ""), &files).expect("a warning only");
    assert_eq!(texture.warnings()[0].code, "not-finite-texels");
    near(&texel(&texture, 1, 0), &[1e9; 3], 1e3);
    near(&texel(&texture, 2, 0), &[-1e9; 3], 1e3);
    let footprints: Vec<Footprint> = [1e-6, 0.01, 0.1, 0.5, 3.0, 100.0]
        .into_iter()
        .flat_map(|size: f32| {
            [0.1, 0.3, 0.45, 0.9].map(|u: f32| Footprint {
                uv: [u, 0.3],
                du: [size, 0.0],
                dv: [0.0, size],
                ..Footprint::default()
            })
        })
        .collect();
    for method in [Method::Local, Method::Quad, Method::Ensemble, Method::Auto] {
        let options = Options {
            method,
            moments: true,
            ..Options::default()
        };
        let outputs = texture.evaluator(&options).evaluate(&footprints);
        let (means, variances) = outputs.split_at(3);
        for mean in means.iter().flatten() {
            assert!(mean.is_finite() && mean.abs() <= 1.1e9, "{method}: {mean}");
        }
        for variance in variances.iter().flatten() {
            assert!(
                variance.is_finite() && *variance >= 0.0,
                "{method}: {variance}"
            );
        }
        // A footprint of a texel about the largest number is most of it, not the 0 of what overflows.
        let within = texture.evaluator(&options).evaluate(&[Footprint {
            uv: [0.375, 0.25],
            du: [0.02, 0.0],
            dv: [0.0, 0.02],
            ..Footprint::default()
        }]);
        assert!(within[0][0] > 5e8, "{method}: {}", within[0][0]);
    }
}

#[test]
fn a_root_keeps_graphs_from_what_lies_outside_of_it() {
    let place = std::env::temp_dir().join(format!("mipless-root-{}", std::process::id()));
    let inner = place.join("root/graphs");
    std::fs::create_dir_all(&inner).expect("folders");
    let picture = png(&[9; 24], ExtendedColorType::Rgb8);
    for name in ["outside.png", "root/beside.png", "root/graphs/within.png"] {
        std::fs::write(place.join(name), &picture).expect("a file");
    }
    let files = Folder(inner.clone())
        .within(&place.join("root"))
        .expect("a folder");
    let absolute = place.join("outside.png");
    let mut outside = vec![
        "../../outside.png".to_owned(),
        absolute.display().to_string(),
    ];
    outside.push("../../missing.png".to_owned());
    #[cfg(unix)]
    {
        let link = |to: &str, name: &str| {
            std::os::unix::fs::symlink(place.join(to), inner.join(name)).expect("a link");
        };
        link("outside.png", "link.png");
        link("", "folder");
        outside.extend(["link.png".to_owned(), "folder/outside.png".to_owned()]);
        link("root/beside.png", "near.png");
        assert!(files.read("near.png").is_ok(), "a link that stays within");
    }
    for name in &outside {
        let error = files.read(name).expect_err("it lies outside");
        assert_eq!(
            error.kind(),
            io::ErrorKind::PermissionDenied,
            "{name}: {error}"
        );
        let mistake = mistake(&graph(name, ""), &files);
        assert_eq!(mistake.code, "unreadable-file", "{mistake:?}");
        assert!(mistake.message.contains("outside"), "{mistake:?}");
    }
    for name in ["within.png", "../beside.png"] {
        assert!(files.read(name).is_ok(), "{name}");
    }
    let missing = files.read("missing.png").expect_err("it is not there");
    assert_eq!(missing.kind(), io::ErrorKind::NotFound);
    std::fs::remove_dir_all(&place).expect("a folder of this test");
}
