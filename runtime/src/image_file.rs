//! Image files: PNG with 8 or 16 bits in sRGB, EXR with f32 in linear light.
//!
//! A file is written whole or not at all: its bytes go to a temporary file in the same folder,
//! which then takes the name in one step.

use std::fmt;
use std::fs;
use std::io::{self, Cursor, Write};
use std::path::{Path, PathBuf};

use ::image::{ExtendedColorType, ImageEncoder, codecs::png::PngEncoder};
use exr::prelude as openexr;
use exr::prelude::WritableImage;

use crate::image::Image;
use crate::srgb::srgb_from_linear;

/// The bits of a channel of a PNG file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Bits {
    /// 0 to 255.
    #[default]
    Eight,
    /// 0 to 65535.
    Sixteen,
}

/// The format of an image file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// PNG: sRGB, clamped to 0 to 1, rounded to nearest, not dithered.
    Png(Bits),
    /// EXR: the numbers as they are, with the channel names of the image.
    Exr,
}

/// Why an image file could not be written.
#[derive(Debug)]
pub enum FileError {
    /// The name ends in neither `.png` nor `.exr`.
    Extension(PathBuf),
    /// The file or its folder cannot be written.
    Write(PathBuf, io::Error),
    /// The PNG encoder refuses the image, for instance because it is too large for the format.
    Png(PathBuf, ::image::ImageError),
    /// The EXR encoder refuses the image.
    Exr(PathBuf, exr::error::Error),
}

impl fmt::Display for FileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Extension(path) => {
                write!(f, "{}: the name must end in .png or .exr", path.display())
            }
            Self::Write(path, error) => write!(f, "{}: cannot be written: {error}", path.display()),
            Self::Png(path, error) => write!(f, "{}: not a possible PNG: {error}", path.display()),
            Self::Exr(path, error) => write!(f, "{}: not a possible EXR: {error}", path.display()),
        }
    }
}

impl std::error::Error for FileError {}

impl Format {
    /// The format that a file name asks for by its extension, in any case; `bits` is for PNG.
    ///
    /// # Errors
    /// If the extension is neither `png` nor `exr`.
    pub fn of(path: &Path, bits: Bits) -> Result<Self, FileError> {
        let extension = path.extension().unwrap_or_default().to_ascii_lowercase();
        match extension.to_str() {
            Some("png") => Ok(Self::Png(bits)),
            Some("exr") => Ok(Self::Exr),
            _ => Err(FileError::Extension(path.to_path_buf())),
        }
    }
}

/// Writes an image, whole or not at all.
///
/// In PNG, the first three channels are red, green and blue (a missing blue is 0), so that vectors
/// show as colours; a fourth is alpha if it is named `A`, and left out otherwise; one channel is
/// grey.
///
/// # Errors
/// If the encoder refuses the image, or the file cannot be written.
pub fn write(path: &Path, image: &Image, format: Format) -> Result<(), FileError> {
    let bytes = encode(path, image, format)?;
    write_whole(path, &bytes).map_err(|e| FileError::Write(path.into(), e))
}

/// The bytes of the file that [`write()`] writes; `path` is for the error alone.
///
/// # Errors
/// If the encoder refuses the image.
pub fn encode(path: &Path, image: &Image, format: Format) -> Result<Vec<u8>, FileError> {
    match format {
        Format::Png(bits) => png(image, bits).map_err(|e| FileError::Png(path.into(), e)),
        Format::Exr => exr_bytes(image).map_err(|e| FileError::Exr(path.into(), e)),
    }
}

/// Writes several files of any kind: every one whole, and none unless the bytes of all of them have
/// found room.
///
/// # Errors
/// If one of the files or folders cannot be written; then existing files are as they were, unless
/// the very last step, taking the name, fails for one file after it worked for another.
pub fn write_all(files: &[(PathBuf, Vec<u8>)]) -> Result<(), FileError> {
    let failed = |path: &Path| {
        let path = path.to_path_buf();
        move |error| FileError::Write(path, error)
    };
    let staged: Result<Vec<_>, _> = (files.iter())
        .map(|(path, bytes)| Staged::new(path, bytes).map_err(failed(path)))
        .collect();
    for (staged, (path, bytes)) in staged?.into_iter().zip(files) {
        staged.finish(bytes).map_err(failed(path))?;
    }
    Ok(())
}

/// Writes a file of any kind, whole or not at all. An existing file is replaced in one step, a
/// link is followed, and what is no regular file (a pipe, a terminal) is written to directly.
///
/// # Errors
/// If the file or its folder cannot be written; then an existing file is as it was.
pub fn write_whole(path: &Path, bytes: &[u8]) -> io::Result<()> {
    Staged::new(path, bytes)?.finish(bytes)
}

/// A file that is ready to take its name.
enum Staged {
    /// Its bytes lie beside the name, which they are to take.
    Beside(tempfile::NamedTempFile, PathBuf),
    /// What is no regular file takes the bytes in the end.
    Direct(fs::File),
}

impl Staged {
    fn new(path: &Path, bytes: &[u8]) -> io::Result<Self> {
        let resolved = fs::canonicalize(path);
        let path = resolved.as_deref().unwrap_or(path);
        if fs::metadata(path).is_ok_and(|metadata| !metadata.is_file()) {
            return Ok(Self::Direct(fs::OpenOptions::new().write(true).open(path)?));
        }
        let folder = match path.parent() {
            Some(parent) if !parent.as_os_str().is_empty() => parent,
            _ => Path::new("."),
        };
        let mut builder = tempfile::Builder::new();
        builder.prefix(".mipless-");
        #[cfg(unix)]
        {
            // Temporary files are private by default; a picture is as readable as any other file.
            use std::os::unix::fs::PermissionsExt;
            builder.permissions(fs::Permissions::from_mode(0o666));
        }
        let mut file = builder.tempfile_in(folder)?;
        file.write_all(bytes)?;
        Ok(Self::Beside(file, path.to_path_buf()))
    }

    fn finish(self, bytes: &[u8]) -> io::Result<()> {
        match self {
            Self::Beside(file, path) => {
                file.persist(path).map_err(|error| error.error)?;
                Ok(())
            }
            Self::Direct(mut file) => file.write_all(bytes),
        }
    }
}

fn png(image: &Image, bits: Bits) -> ::image::ImageResult<Vec<u8>> {
    let names = image.names();
    let alpha = names.len() == 4 && names[3] == "A";
    let zeros;
    let mut channels: Vec<&[f32]> = image.channels().iter().map(Vec::as_slice).collect();
    channels.truncate(if alpha { 4 } else { 3 });
    if channels.len() == 2 {
        zeros = vec![0.0; image.size().pixels()];
        channels.push(&zeros);
    }
    let number = |channel: usize, pixel: usize| {
        let x = channels[channel][pixel];
        // A NaN stays one, and converts to the integer 0.
        if channel == 3 {
            x.clamp(0.0, 1.0)
        } else {
            srgb_from_linear(x)
        }
    };
    let pixels = image.size().pixels();
    let all = (0..pixels).flat_map(|p| (0..channels.len()).map(move |c| (c, p)));
    let (bytes, [grey, rgb, rgba]) = match bits {
        Bits::Eight => (
            all.map(|(c, p)| (number(c, p) * 255.0).round() as u8)
                .collect::<Vec<_>>(),
            [
                ExtendedColorType::L8,
                ExtendedColorType::Rgb8,
                ExtendedColorType::Rgba8,
            ],
        ),
        Bits::Sixteen => (
            all.flat_map(|(c, p)| ((number(c, p) * 65535.0).round() as u16).to_ne_bytes())
                .collect(),
            [
                ExtendedColorType::L16,
                ExtendedColorType::Rgb16,
                ExtendedColorType::Rgba16,
            ],
        ),
    };
    let color = match channels.len() {
        1 => grey,
        3 => rgb,
        _ => rgba,
    };
    let mut file = Vec::new();
    PngEncoder::new(&mut file).write_image(&bytes, image.width(), image.height(), color)?;
    Ok(file)
}

fn exr_bytes(image: &Image) -> Result<Vec<u8>, exr::error::Error> {
    let channel = |(name, data): (&String, &Vec<f32>)| {
        openexr::AnyChannel::new(name.as_str(), openexr::FlatSamples::F32(data.clone()))
    };
    let channels = image
        .names()
        .iter()
        .zip(image.channels())
        .map(channel)
        .collect();
    let size = (image.width() as usize, image.height() as usize);
    let layer = openexr::Layer::new(
        size,
        openexr::LayerAttributes::default(),
        // Lines in increasing order, so that the same image gives the same bytes.
        openexr::Encoding::SMALL_LOSSLESS,
        openexr::AnyChannels::sort(channels),
    );
    let mut file = Cursor::new(Vec::new());
    openexr::Image::from_layer(layer)
        .write()
        .to_buffered(&mut file)?;
    Ok(file.into_inner())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::srgb::linear_from_srgb;
    use crate::view::Size;

    fn gradient(names: &[&str]) -> Image {
        let size = Size::new(19, 7);
        let channel = |c: usize| {
            (0..size.pixels())
                .map(|p| (p + 3 * c) as f32 / 140.0)
                .collect::<Vec<_>>()
        };
        Image::new(size, names, (0..names.len()).map(channel).collect())
    }

    #[test]
    fn png_holds_srgb_to_half_a_step() {
        let folder = tempfile::tempdir().unwrap();
        for (bits, steps) in [(Bits::Eight, 255.0), (Bits::Sixteen, 65535.0)] {
            for names in [
                &["R", "G", "B"][..],
                &["Y"],
                &["R", "G", "B", "A"],
                &["X", "Y"],
            ] {
                let path = folder
                    .path()
                    .join(format!("{}-{bits:?}.PNG", names.join("")));
                let image = gradient(names);
                write(&path, &image, Format::of(&path, bits).unwrap()).unwrap();
                let bytes = fs::read(&path).unwrap();
                let read = ::image::load_from_memory(&bytes).unwrap();
                let expected = if names == ["X", "Y"] { 3 } else { names.len() };
                assert_eq!(usize::from(read.color().channel_count()), expected);
                let read = read.into_rgba32f();
                for (index, pixel) in read.pixels().enumerate() {
                    for (c, name) in names.iter().enumerate() {
                        let stored = pixel.0[c];
                        let wanted = image.channels()[c][index];
                        let encoded = srgb_from_linear(wanted);
                        let wanted = if *name == "A" {
                            wanted.min(1.0)
                        } else {
                            encoded
                        };
                        assert!((stored - wanted).abs() <= 0.51 / steps, "{stored} {wanted}");
                    }
                }
            }
        }
        assert!((linear_from_srgb(0.5) - 0.214_041).abs() < 1e-5);
    }

    #[test]
    fn exr_holds_every_bit_under_its_channel_name() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("moments.exr");
        let mut mean = gradient(&["R", "G", "B"]);
        mean.channels_mut()[0][5] = -7.25e20;
        let image = Image::moments(&mean, &gradient(&["R", "G", "B"]));
        write(&path, &image, Format::of(&path, Bits::Eight).unwrap()).unwrap();
        let read = openexr::read_first_flat_layer_from_file(&path).unwrap();
        let found = &read.layer_data.channel_data.list;
        assert_eq!(found.len(), 6);
        for channel in found {
            let stored: Vec<f32> = channel.sample_data.values_as_f32().collect();
            assert!(matches!(channel.sample_data, openexr::FlatSamples::F32(_)));
            assert_eq!(image.channel(&channel.name.to_string()), Some(&stored[..]));
        }
        let first = fs::read(&path).unwrap();
        write(&path, &image, Format::Exr).unwrap();
        assert_eq!(
            first,
            fs::read(&path).unwrap(),
            "the same image, the same bytes"
        );
    }

    #[test]
    fn what_cannot_be_written_leaves_nothing_behind() {
        let folder = tempfile::tempdir().unwrap();
        let image = gradient(&["Y"]);
        let missing = folder.path().join("no").join("such.png");
        let result = write(&missing, &image, Format::Png(Bits::Eight));
        assert!(matches!(result, Err(FileError::Write(_, _))), "{result:?}");

        let taken = folder.path().join("taken.png");
        fs::create_dir(&taken).unwrap();
        let result = write(&taken, &image, Format::Png(Bits::Eight));
        assert!(matches!(result, Err(FileError::Write(_, _))), "{result:?}");

        let unknown = Format::of(Path::new("a.jpeg"), Bits::Eight);
        assert!(
            matches!(unknown, Err(FileError::Extension(_))),
            "{unknown:?}"
        );

        let kept = folder.path().join("kept.png");
        write_whole(&kept, b"old").unwrap();
        write_whole(&kept, b"new").unwrap();
        assert_eq!(fs::read(&kept).unwrap(), b"new");
        let left = fs::read_dir(folder.path()).unwrap().count();
        assert_eq!(
            left, 2,
            "the folder that was there and the file that was written"
        );
    }

    #[cfg(unix)]
    #[test]
    fn links_and_devices_stay_what_they_are() {
        let folder = tempfile::tempdir().unwrap();
        let (file, link) = (folder.path().join("file"), folder.path().join("link"));
        fs::write(&file, b"old").unwrap();
        std::os::unix::fs::symlink(&file, &link).unwrap();
        write_whole(&link, b"new").unwrap();
        assert_eq!(fs::read(&file).unwrap(), b"new");
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
        write_whole(Path::new("/dev/null"), b"gone").unwrap();
        assert!(!fs::metadata("/dev/null").unwrap().is_file());
    }
}
