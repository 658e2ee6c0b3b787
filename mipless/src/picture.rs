//! Pictures from the bytes of PNG, JPEG and OpenEXR files of 8, 16 and 32 bits.

use crate::files::{LARGEST_PICTURE, LARGEST_SIDE};
use ::image::{DynamicImage, ImageDecoder, ImageFormat, ImageReader, Limits};
use exr::prelude as openexr;
use exr::prelude::{ReadChannels, ReadLayers};
use mipless_graph::Picture;
use std::fmt;
use std::io::Cursor;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Half a float's largest number: what a picture's infinities become.
const LARGEST_NUMBER: f32 = 65_504.0;

/// The largest number of a picture, of which the fourth power is finite: what filters multiplies
/// variances.
const LARGEST_FINITE: f32 = 1e9;

/// The most bytes of a profile, or of whatever else stands before the texels.
const LARGEST_HEADER: u64 = 4 << 20;

/// A picture, and how many of its numbers were replaced: NaN became 0, infinities ±65504,
/// and what is larger than 1e9 that.
#[derive(Debug)]
pub(crate) struct Decoded {
    pub(crate) picture: Picture,
    pub(crate) replaced: usize,
}

/// Why bytes are no picture that can be used.
#[derive(Debug)]
pub(crate) enum PictureError {
    /// They begin like none of the formats.
    Format,
    /// The decoder refuses them; why.
    Corrupt(&'static str, String),
    /// It has no texels.
    Empty,
    /// It has more texels than [`LARGEST_SIDE`] and [`LARGEST_PICTURE`] allow.
    TooLarge(u64, u64),
    /// None of the channels is one that a picture has.
    Channels(Vec<String>),
}

impl fmt::Display for PictureError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Format => write!(f, "it is neither PNG nor JPEG nor OpenEXR"),
            Self::Corrupt(format, reason) => write!(f, "it is no sound {format} file: {reason}"),
            Self::Empty => write!(f, "it has no texels"),
            Self::TooLarge(width, height) => write!(
                f,
                "{width}×{height} texels are more than {LARGEST_SIDE} a side or {LARGEST_PICTURE} in all"
            ),
            Self::Channels(names) => write!(
                f,
                "none of its channels (`{}`) is R, G, B, Y, X or alone",
                names.join("`, `")
            ),
        }
    }
}

/// Refuses sizes before anything of that size is allocated.
fn checked(width: u64, height: u64) -> Result<(u32, u32), PictureError> {
    let side = |length: u64| u32::try_from(length).ok().filter(|&l| l <= LARGEST_SIDE);
    match (side(width), side(height)) {
        (Some(0), _) | (_, Some(0)) => Err(PictureError::Empty),
        (Some(w), Some(h)) if width * height <= LARGEST_PICTURE => Ok((w, h)),
        _ => Err(PictureError::TooLarge(width, height)),
    }
}

/// Decodes a file; its first bytes say of which format it is.
pub(crate) fn decode(bytes: &[u8]) -> Result<Decoded, PictureError> {
    const EXR: [u8; 4] = [0x76, 0x2f, 0x31, 0x01];
    let (name, format) = if bytes.starts_with(&EXR) {
        ("OpenEXR", None)
    } else {
        match ::image::guess_format(bytes) {
            Ok(ImageFormat::Png) => ("PNG", Some(ImageFormat::Png)),
            Ok(ImageFormat::Jpeg) => ("JPEG", Some(ImageFormat::Jpeg)),
            _ => return Err(PictureError::Format),
        }
    };
    // The decoders are others' code, and the bytes are anybody's: a bug there is a corrupt file here.
    catch_unwind(AssertUnwindSafe(|| match format {
        Some(format) => quantised(bytes, name, format),
        None => floats(bytes),
    }))
    .unwrap_or_else(|_| Err(PictureError::Corrupt(name, "its decoder failed".to_owned())))
}

/// PNG and JPEG: integers of 8 or 16 bits as numbers from 0 to 1.
fn quantised(
    bytes: &[u8],
    name: &'static str,
    format: ImageFormat,
) -> Result<Decoded, PictureError> {
    let corrupt = |error: ::image::ImageError| PictureError::Corrupt(name, error.to_string());
    if format == ImageFormat::Jpeg && !has_end(bytes) {
        return Err(PictureError::Corrupt(name, "its end is missing".to_owned()));
    }
    let limits = |bytes: u64| {
        let mut limits = Limits::default();
        limits.max_alloc = Some(bytes);
        limits
    };
    let mut reader = ImageReader::with_format(Cursor::new(bytes), format);
    reader.limits(limits(LARGEST_HEADER));
    let mut decoder = reader.into_decoder().map_err(corrupt)?;
    let (width, height) = decoder.dimensions();
    let size = checked(width.into(), height.into())?;
    let most = 4 * decoder.total_bytes() + LARGEST_HEADER;
    decoder.set_limits(limits(most)).map_err(corrupt)?;
    let image = DynamicImage::from_decoder(decoder).map_err(corrupt)?;
    let channels = u32::from(image.color().channel_count());
    let byte = |x: &u8| f32::from(*x) / 255.0;
    let word = |x: &u16| f32::from(*x) / 65535.0;
    let numbers: Vec<f32> = match &image {
        DynamicImage::ImageLuma8(image) => image.as_raw().iter().map(byte).collect(),
        DynamicImage::ImageLumaA8(image) => image.as_raw().iter().map(byte).collect(),
        DynamicImage::ImageRgb8(image) => image.as_raw().iter().map(byte).collect(),
        DynamicImage::ImageRgba8(image) => image.as_raw().iter().map(byte).collect(),
        DynamicImage::ImageLuma16(image) => image.as_raw().iter().map(word).collect(),
        DynamicImage::ImageLumaA16(image) => image.as_raw().iter().map(word).collect(),
        DynamicImage::ImageRgb16(image) => image.as_raw().iter().map(word).collect(),
        DynamicImage::ImageRgba16(image) => image.as_raw().iter().map(word).collect(),
        other => {
            let reason = format!("its texels are of the kind {:?}", other.color());
            return Err(PictureError::Corrupt(name, reason));
        }
    };
    Ok(Decoded {
        picture: Picture::new(size, channels, true, numbers),
        replaced: 0,
    })
}

/// Whether the scans of a JPEG end with its mark: decoders fill up what is cut off. What stands before
/// the first scan is skipped, for a preview has a mark of its own (ITU T.81, B.1.1).
fn has_end(bytes: &[u8]) -> bool {
    let mut at = 2;
    while let Some(&[0xff, kind, high, low]) = bytes.get(at..at + 4) {
        if kind == 0xff {
            at += 1;
            continue;
        }
        let length = usize::from(u16::from_be_bytes([high, low]));
        at += 2 + length;
        if kind == 0xda {
            let scans = bytes.get(at..).unwrap_or_default();
            return scans.windows(2).any(|pair| pair == [0xff, 0xd9]);
        }
    }
    false
}

/// OpenEXR: linear numbers of 16 or 32 bits, of the first layer that holds an image.
fn floats(bytes: &[u8]) -> Result<Decoded, PictureError> {
    let corrupt = |error: exr::error::Error| PictureError::Corrupt("OpenEXR", error.to_string());
    let reason = |text: &str| PictureError::Corrupt("OpenEXR", text.to_owned());
    let headers = exr::meta::MetaData::read_from_buffered(Cursor::new(bytes), false)
        .map_err(corrupt)?
        .headers;
    for header in &headers {
        let size = header.layer_size;
        checked(size.width() as u64, size.height() as u64)?;
        // Every channel is decoded.
        if header.channels.list.len() > 64 {
            return Err(reason("it has more than 64 channels"));
        }
        let whole = |channel: &exr::meta::attribute::ChannelDescription| {
            channel.sampling == exr::math::Vec2(1, 1)
        };
        if !header.channels.list.iter().all(whole) {
            return Err(reason("its channels are subsampled"));
        }
    }
    let image = openexr::read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .first_valid_layer()
        .all_attributes()
        .non_parallel()
        .from_buffered(Cursor::new(bytes))
        .map_err(corrupt)?;
    let layer = image.layer_data;
    let size = checked(layer.size.width() as u64, layer.size.height() as u64)?;
    let list = layer.channel_data.list;
    let find = |name: &str| list.iter().position(|channel| channel.name.eq(name));
    let orders: [&[&str]; 3] = [&["R", "G", "B", "A"], &["X", "Y", "Z", "W"], &["Y", "A"]];
    let chosen: Vec<usize> = orders
        .iter()
        .find(|order| find(order[0]).is_some())
        .map_or_else(
            || if list.len() == 1 { vec![0] } else { Vec::new() },
            |order| order.iter().map_while(|name| find(name)).collect(),
        );
    if chosen.is_empty() {
        let names = list.iter().map(|channel| channel.name.to_string());
        return Err(PictureError::Channels(names.collect()));
    }
    let texels = size.0 as usize * size.1 as usize;
    let mut numbers = vec![0.0; texels * chosen.len()];
    let mut replaced = 0;
    for (place, &channel) in chosen.iter().enumerate() {
        let samples = list[channel].sample_data.values_as_f32();
        for (to, x) in numbers[place..]
            .iter_mut()
            .step_by(chosen.len())
            .zip(samples)
        {
            *to = match x {
                _ if x.is_nan() => 0.0,
                _ if x.is_infinite() => LARGEST_NUMBER.copysign(x),
                _ => x.clamp(-LARGEST_FINITE, LARGEST_FINITE),
            };
            replaced += usize::from(*to != x);
        }
    }
    Ok(Decoded {
        picture: Picture::new(size, chosen.len() as u32, false, numbers),
        replaced,
    })
}
