//! Image files: PNG with 8 or 16 bits, EXR with f32 in linear light.
//!
//! A file is written whole or not at all: its bytes go to a temporary file in the same folder,
//! which then takes the name in one step. Large PNG files are written as their rows are made
//! ([`stream`]).

mod levels;
mod png;

use std::fmt;
use std::fs;
use std::io::{self, Cursor, Write};
use std::path::{Path, PathBuf};

use exr::prelude as openexr;
use exr::prelude::WritableImage;
use rayon::prelude::*;

use crate::image::Image;
use crate::ordered::in_order;
use crate::size::Size;
use levels::Levels;
use png::{Layout, Stream, Strip};

/// The bits of a channel of a PNG file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Bits {
    /// 0 to 255.
    #[default]
    Eight,
    /// 0 to 65535.
    Sixteen,
}

/// What the levels of a PNG file stand for; the file says so.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Space {
    /// sRGB: what people look at.
    #[default]
    Srgb,
    /// The numbers as they are: what programs read.
    Linear,
}

impl Space {
    /// The space of what has these channels: colours are looked at, all else is read.
    pub fn of(names: &[String]) -> Self {
        match names.first().map(String::as_str) {
            Some("R") => Self::Srgb,
            _ => Self::Linear,
        }
    }

    /// The name on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Srgb => "srgb",
            Self::Linear => "linear",
        }
    }
}

/// The format of an image file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// PNG: clamped to 0 to 1, rounded to nearest, not dithered.
    Png(Bits, Space),
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
            Self::Exr(path, error) => write!(f, "{}: not a possible EXR: {error}", path.display()),
        }
    }
}

impl std::error::Error for FileError {}

impl Format {
    /// The format that a file name asks for by its extension, in any case; `bits` and `space` are for
    /// PNG.
    ///
    /// # Errors
    /// If the extension is neither `png` nor `exr`.
    pub fn of(path: &Path, bits: Bits, space: Space) -> Result<Self, FileError> {
        let extension = path.extension().unwrap_or_default().to_ascii_lowercase();
        match extension.to_str() {
            Some("png") => Ok(Self::Png(bits, space)),
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
        Format::Png(bits, space) => Ok(png(image, bits, space)),
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
        let mut staged = Self::open(path)?;
        if let Self::Beside(file, _) = &mut staged {
            file.write_all(bytes)?;
        }
        Ok(staged)
    }

    /// Nothing is written yet.
    fn open(path: &Path) -> io::Result<Self> {
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
        let file = builder.tempfile_in(folder)?;
        Ok(Self::Beside(file, path.to_path_buf()))
    }

    /// What takes bytes as they come.
    fn file(&mut self) -> &mut fs::File {
        match self {
            Self::Beside(file, _) => file.as_file_mut(),
            Self::Direct(file) => file,
        }
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

fn png(image: &Image, bits: Bits, space: Space) -> Vec<u8> {
    let layout = Layout::of(image.size(), image.names(), bits, space);
    let levels = Levels::new();
    let strips: Vec<Strip> = (0..layout.strips())
        .into_par_iter()
        .map(|strip| layout.strip(&levels, image, layout.rows_of(strip).0, strip))
        .collect();
    let (mut file, mut stream) = (Vec::new(), Stream::new());
    layout
        .begin(&mut file)
        .and_then(|()| {
            strips
                .iter()
                .try_for_each(|strip| stream.push(&mut file, strip))
        })
        .and_then(|()| stream.end(&mut file))
        .expect("memory takes all bytes");
    file
}

/// A PNG file of several that are written together as their rows are made.
#[derive(Clone, Debug)]
pub struct Streamed {
    /// Where it goes.
    pub path: PathBuf,
    /// The names of its channels.
    pub names: Vec<String>,
    /// The bits of a channel.
    pub bits: Bits,
    /// What its levels stand for.
    pub space: Space,
}

/// Writes PNG files of one size on all cores, with a few strips of rows in memory: `render` makes some
/// rows, from the first one and so many, of all files. The bytes are those of [`encode`].
///
/// # Errors
/// What `render` says, and if a file cannot be written; then existing files are as they were.
pub fn stream<E: Send + From<FileError>>(
    files: &[Streamed],
    size: Size,
    render: impl Fn(u32, u32) -> Result<Vec<Image>, E> + Sync,
) -> Result<(), E> {
    let layouts: Vec<Layout> = (files.iter())
        .map(|file| Layout::of(size, &file.names, file.bits, file.space))
        .collect();
    let Some(first) = layouts.first() else {
        return Ok(());
    };
    let failed = |file: &Streamed| {
        let path = file.path.clone();
        move |error| FileError::Write(path, error)
    };
    let mut staged = Vec::with_capacity(files.len());
    for (file, layout) in files.iter().zip(&layouts) {
        let mut open = Staged::open(&file.path).map_err(failed(file))?;
        layout.begin(open.file()).map_err(failed(file))?;
        staged.push((open, Stream::new(), file));
    }
    let levels = Levels::new();
    let make = |strip: usize| {
        let (row, rows) = first.rows_of(strip as u32);
        let strip =
            |(layout, image): (&Layout, &Image)| layout.strip(&levels, image, 0, strip as u32);
        let strips =
            render(row, rows).map(|images| layouts.iter().zip(&images).map(strip).collect());
        strips as Result<Vec<Strip>, E>
    };
    let count = first.strips() as usize;
    in_order(
        count,
        rayon::current_num_threads(),
        make,
        |_, strips: Vec<Strip>| {
            for ((open, stream, file), strip) in staged.iter_mut().zip(&strips) {
                stream.push(open.file(), strip).map_err(failed(file))?;
            }
            Ok(())
        },
    )?;
    for (open, stream, file) in &mut staged {
        stream.end(open.file()).map_err(failed(file))?;
    }
    for (open, _, file) in staged {
        open.finish(&[]).map_err(failed(file))?;
    }
    Ok(())
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
    use crate::srgb::{linear_from_srgb, srgb_from_linear};
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
                let format = Format::of(&path, bits, Space::Srgb).unwrap();
                write(&path, &image, format).unwrap();
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
    fn what_is_streamed_is_what_is_written_whole() {
        let folder = tempfile::tempdir().unwrap();
        // Several strips, the last of which is not full.
        let size = Size::new(1 << 12, 70);
        let number = |c: usize, p: usize| ((p * (7 + c)) % 9973) as f32 / 9973.0;
        let rows = |names: &[&str], row: u32, rows: u32| {
            let pixels = row as usize * size.width as usize..;
            let pixels = pixels.take(rows as usize * size.width as usize);
            let channel = |c| pixels.clone().map(|p| number(c, p)).collect();
            let channels = (0..names.len()).map(channel).collect();
            Image::new(Size::new(size.width, rows), names, channels)
        };
        let (color, height) = (["R", "G", "B"], ["Y"]);
        let file = |name: &str, names: &[&str], bits, space| Streamed {
            path: folder.path().join(name),
            names: names.iter().map(|name| (*name).to_owned()).collect(),
            bits,
            space,
        };
        let files = [
            file("color.png", &color, Bits::Eight, Space::Srgb),
            file("height.png", &height, Bits::Sixteen, Space::Linear),
        ];
        let both = |row, count| Ok(vec![rows(&color, row, count), rows(&height, row, count)]);
        stream::<FileError>(&files, size, both).unwrap();
        for (file, names) in files.iter().zip([&color[..], &height]) {
            let image = rows(names, 0, size.height);
            let bytes = fs::read(&file.path).unwrap();
            let format = Format::Png(file.bits, file.space);
            assert!(bytes == encode(&file.path, &image, format).unwrap());
            let read = ::image::load_from_memory(&bytes).unwrap().into_rgba32f();
            for (index, pixel) in read.pixels().enumerate() {
                let x = image.channels()[0][index];
                let wanted = match file.space {
                    Space::Srgb => srgb_from_linear(x),
                    Space::Linear => x,
                };
                assert!((pixel.0[0] - wanted).abs() < 0.51 / 255.0);
            }
        }
        let fails = |row, _| Err(FileError::Extension(format!("{row}").into()));
        stream(&files, size, fails).unwrap_err();
        let left = fs::read_dir(folder.path()).unwrap().count();
        assert_eq!(left, 2, "no temporary file stays");
    }

    #[test]
    fn a_png_says_what_its_levels_are() {
        let image = gradient(&["Y"]);
        let bytes = |space| {
            let file = encode(Path::new("a.png"), &image, Format::Png(Bits::Eight, space));
            file.unwrap()
        };
        let says = |bytes: &[u8], word: &[u8]| bytes.windows(word.len()).any(|w| w == word);
        let (srgb, linear) = (bytes(Space::Srgb), bytes(Space::Linear));
        assert!(says(&srgb, b"sRGB\0") && !says(&linear, b"sRGB"));
        assert!(says(
            &linear,
            &[b"gAMA".as_slice(), &100_000u32.to_be_bytes()].concat()
        ));
        assert_eq!(Space::of(&["R".into()]), Space::Srgb);
        assert_eq!(Space::of(&["Y".into()]), Space::Linear);
    }

    #[test]
    fn exr_holds_every_bit_under_its_channel_name() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("moments.exr");
        let mut mean = gradient(&["R", "G", "B"]);
        mean.channels_mut()[0][5] = -7.25e20;
        let image = Image::moments(&mean, &gradient(&["R", "G", "B"]));
        write(&path, &image, Format::Exr).unwrap();
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
        let result = write(&missing, &image, Format::Png(Bits::Eight, Space::Srgb));
        assert!(matches!(result, Err(FileError::Write(_, _))), "{result:?}");

        let taken = folder.path().join("taken.png");
        fs::create_dir(&taken).unwrap();
        let result = write(&taken, &image, Format::Png(Bits::Eight, Space::Srgb));
        assert!(matches!(result, Err(FileError::Write(_, _))), "{result:?}");

        let unknown = Format::of(Path::new("a.jpeg"), Bits::Eight, Space::Srgb);
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
