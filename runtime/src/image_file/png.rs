//! PNG files in strips: each strip of rows is filtered and deflated by itself, on any thread, and the
//! strips follow each other in one stream (as pigz does it: deflate blocks may be cut at a flush). So a
//! picture of any size is written with a few strips in memory, and all cores deflate.

use std::io::{self, Write};

use flate2::{Compress, Compression, FlushCompress, Status};

use super::levels::Levels;
use super::{Bits, Space};
use crate::image::Image;
use crate::size::Size;

/// The pixels of a strip: as many as deflate well by themselves, and few enough for the memory of all
/// threads.
const PIXELS: usize = 1 << 17;

/// How hard the strips are deflated: what follows costs several times the time for a few percent.
const LEVEL: u32 = 2;

/// How a picture is stored.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Layout {
    pub(super) size: Size,
    /// 1: grey; 3: colours; 4: colours with alpha.
    channels: usize,
    bits: Bits,
    space: Space,
}

/// The rows of a strip, deflated.
#[derive(Debug)]
pub(super) struct Strip {
    deflated: Vec<u8>,
    /// The checksum of what was deflated, and how many bytes that were.
    adler: u32,
    length: u64,
}

impl Layout {
    /// The layout of an image with channels of these names.
    pub(super) fn of(size: Size, names: &[String], bits: Bits, space: Space) -> Self {
        let alpha = names.len() == 4 && names[3] == "A";
        let channels = match names.len() {
            1 => 1,
            _ if alpha => 4,
            _ => 3,
        };
        Self {
            size,
            channels,
            bits,
            space,
        }
    }

    /// The rows of a strip but for the last one, which may have fewer.
    pub(super) fn rows(&self) -> u32 {
        (PIXELS as u32 / self.size.width).clamp(1, self.size.height)
    }

    /// How many strips there are.
    pub(super) fn strips(&self) -> u32 {
        self.size.height.div_ceil(self.rows())
    }

    /// The first row of a strip, and how many it has.
    pub(super) fn rows_of(&self, strip: u32) -> (u32, u32) {
        let first = strip * self.rows();
        (first, self.rows().min(self.size.height - first))
    }

    /// Filters and deflates the strip of this number, of which `image` holds the rows from `row` on.
    pub(super) fn strip(&self, levels: &Levels, image: &Image, row: u32, strip: u32) -> Strip {
        let (_, rows) = self.rows_of(strip);
        let is_last = strip + 1 == self.strips();
        let width = self.size.width as usize;
        let pixel = self.channels
            * match self.bits {
                Bits::Eight => 1,
                Bits::Sixteen => 2,
            };
        let (mut held, mut before) = (vec![0; width * pixel], vec![0; width * pixel]);
        let mut filtered = Vec::with_capacity((width * pixel + 1) * rows as usize);
        for index in 0..rows {
            let first = (row + index) as usize * width;
            self.numbers(levels, image, first, &mut held);
            // The row above the first one is another strip's.
            filter(&held, (index > 0).then_some(&before), pixel, &mut filtered);
            std::mem::swap(&mut held, &mut before);
        }
        Strip {
            deflated: deflated(&filtered, is_last),
            adler: adler(&filtered),
            length: filtered.len() as u64,
        }
    }

    /// The bytes of a row.
    fn numbers(&self, levels: &Levels, image: &Image, first: usize, row: &mut [u8]) {
        let width = self.size.width as usize;
        for channel in 0..self.channels {
            // A vector of two has no blue.
            let Some(numbers) = image.channels().get(channel) else {
                continue;
            };
            let numbers = &numbers[first..first + width];
            let space = if channel == 3 {
                Space::Linear
            } else {
                self.space
            };
            match self.bits {
                Bits::Eight => {
                    let places = row.iter_mut().skip(channel).step_by(self.channels);
                    for (place, &x) in places.zip(numbers) {
                        *place = levels.eight(space, x);
                    }
                }
                Bits::Sixteen => {
                    let places = row.chunks_exact_mut(2).skip(channel);
                    for (place, &x) in places.step_by(self.channels).zip(numbers) {
                        place.copy_from_slice(&levels.sixteen(space, x).to_be_bytes());
                    }
                }
            }
        }
    }

    /// Writes what comes before the strips.
    pub(super) fn begin(&self, out: &mut impl Write) -> io::Result<()> {
        out.write_all(b"\x89PNG\r\n\x1a\n")?;
        let mut header = Vec::with_capacity(13);
        header.extend(self.size.width.to_be_bytes());
        header.extend(self.size.height.to_be_bytes());
        let bits = match self.bits {
            Bits::Eight => 8,
            Bits::Sixteen => 16,
        };
        let color = [0, 0, 0, 2, 6][self.channels];
        header.extend([bits, color, 0, 0, 0]);
        chunk(out, b"IHDR", &[&header])?;
        match self.space {
            // The rendering intent is perceptual; gAMA is for those who know no sRGB.
            Space::Srgb => {
                chunk(out, b"sRGB", &[&[0]])?;
                chunk(out, b"gAMA", &[&45_455_u32.to_be_bytes()])
            }
            Space::Linear => chunk(out, b"gAMA", &[&100_000_u32.to_be_bytes()]),
        }
    }
}

/// The checksum of all strips so far, which the stream ends with.
#[derive(Debug)]
pub(super) struct Stream {
    adler: u32,
    is_begun: bool,
}

impl Stream {
    pub(super) fn new() -> Self {
        Self {
            adler: 1,
            is_begun: false,
        }
    }

    /// Writes the next strip.
    pub(super) fn push(&mut self, out: &mut impl Write, strip: &Strip) -> io::Result<()> {
        // Deflate with a window of 32 KiB, the fast way.
        let head: &[u8] = if self.is_begun { &[] } else { &[0x78, 0x01] };
        self.is_begun = true;
        self.adler = both(self.adler, strip.adler, strip.length);
        chunk(out, b"IDAT", &[head, &strip.deflated])
    }

    /// Writes what comes behind the strips.
    pub(super) fn end(&self, out: &mut impl Write) -> io::Result<()> {
        chunk(out, b"IDAT", &[&self.adler.to_be_bytes()])?;
        chunk(out, b"IEND", &[])
    }
}

/// Writes a chunk: its length, name, contents and checksum.
fn chunk(out: &mut impl Write, name: &[u8; 4], parts: &[&[u8]]) -> io::Result<()> {
    let length: usize = parts.iter().map(|part| part.len()).sum();
    out.write_all(&(length as u32).to_be_bytes())?;
    let mut crc = crc32fast::Hasher::new();
    for part in std::iter::once(&&name[..]).chain(parts) {
        crc.update(part);
        out.write_all(part)?;
    }
    out.write_all(&crc.finalize().to_be_bytes())
}

/// Appends a row as differences to the left or to the row above, whichever are smaller: the heuristic of
/// the PNG specification, 12.7.
fn filter(row: &[u8], before: Option<&Vec<u8>>, pixel: usize, out: &mut Vec<u8>) {
    let size = |bytes: &[u8]| {
        let one = |&byte: &u8| u64::from((byte as i8).unsigned_abs());
        bytes.iter().map(one).sum::<u64>()
    };
    let start = out.len();
    out.push(1);
    out.extend_from_slice(&row[..pixel]);
    out.extend((row[pixel..].iter().zip(row)).map(|(x, left)| x.wrapping_sub(*left)));
    if let Some(before) = before {
        let up: Vec<u8> = (row.iter().zip(before))
            .map(|(x, above)| x.wrapping_sub(*above))
            .collect();
        if size(&up) < size(&out[start + 1..]) {
            out.truncate(start);
            out.push(2);
            out.extend_from_slice(&up);
        }
    }
}

/// Raw deflate blocks, which end at a byte; the last ones say that they are the last.
fn deflated(bytes: &[u8], is_last: bool) -> Vec<u8> {
    let mut deflate = Compress::new(Compression::new(LEVEL), false);
    let mut out = Vec::with_capacity(bytes.len() / 2 + 1024);
    let flush = if is_last {
        FlushCompress::Finish
    } else {
        FlushCompress::Sync
    };
    loop {
        let done = deflate.total_in() as usize;
        let status = deflate.compress_vec(&bytes[done..], &mut out, flush);
        let status = status.expect("deflate takes all bytes");
        let is_whole = deflate.total_in() as usize == bytes.len();
        // What fills its room may have more to say.
        let has_room = out.len() < out.capacity();
        if status == Status::StreamEnd || !is_last && is_whole && has_room {
            return out;
        }
        out.reserve(out.capacity() / 2 + 1024);
    }
}

fn adler(bytes: &[u8]) -> u32 {
    let mut adler = simd_adler32::Adler32::new();
    adler.write(bytes);
    adler.finish()
}

/// The Adler-32 of two texts one behind the other, the second of this length (RFC 1950, 9: a is one more
/// than the sum of the bytes, b the sum of all a, both modulo 65521).
fn both(first: u32, second: u32, length: u64) -> u32 {
    const MODULUS: u64 = 65_521;
    let [a, b] = [first & 0xffff, first >> 16].map(u64::from);
    let [c, d] = [second & 0xffff, second >> 16].map(u64::from);
    let sum = (a + c + MODULUS - 1) % MODULUS;
    let sums = (b + d + length % MODULUS * (a + MODULUS - 1)) % MODULUS;
    (sums << 16 | sum) as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn checksums_of_parts_are_that_of_the_whole() {
        let bytes: Vec<u8> = (0..200_000u32)
            .map(|x| (x.wrapping_mul(x) >> 5) as u8)
            .collect();
        for cut in [0, 1, 65_521, 150_000] {
            let (first, second) = bytes.split_at(cut);
            let together = both(adler(first), adler(second), second.len() as u64);
            assert_eq!(together, adler(&bytes), "{cut}");
        }
    }

    #[test]
    fn strips_that_fill_their_room_are_whole() {
        // Noise does not deflate: the first guess of the room is too small.
        let mut state = 1u32;
        let mut noise = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 24) as u8
        };
        let parts: Vec<Vec<u8>> = [5usize, 4096, 100_000]
            .map(|length| (0..length).map(|_| noise()).collect())
            .into();
        let mut stream = Vec::new();
        for (index, part) in parts.iter().enumerate() {
            stream.extend(deflated(part, index + 1 == parts.len()));
        }
        let mut inflate = flate2::Decompress::new(false);
        let mut back = Vec::with_capacity(200_000);
        let finish = flate2::FlushDecompress::Finish;
        let status = inflate.decompress_vec(&stream, &mut back, finish);
        assert_eq!(status.expect("a stream"), Status::StreamEnd);
        assert_eq!(back, parts.concat());
    }
}
