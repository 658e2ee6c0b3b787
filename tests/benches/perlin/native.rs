//! The same noise written by hand as one loop over pixels, which the compiler turns into vector
//! instructions: what a native kernel for this source would take.

use mipless_codegen::cpu::Level;

/// Where the pixels of a row lie: whole cells and fractions.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Row<'a> {
    pub(crate) cells: [&'a [i32]; 2],
    pub(crate) fractions: [&'a [f32]; 2],
}

/// A function that fills a row with ¼ of the sum of octaves, as `fractal2d` does.
pub(crate) type Kernel = fn(Row<'_>, &mut [f32]);

/// The kernel for the vector instructions that the evaluator uses on this machine.
pub(crate) fn kernel() -> Kernel {
    match Level::detect() {
        Level::Baseline => fill,
        // SAFETY: the instruction set was found on this machine.
        #[cfg(target_arch = "x86_64")]
        Level::Avx2 => |row, out| unsafe { fill_avx2(row, out) },
        // SAFETY: the instruction set was found on this machine.
        #[cfg(target_arch = "x86_64")]
        Level::Avx512 => |row, out| unsafe { fill_avx512(row, out) },
        #[cfg(not(target_arch = "x86_64"))]
        Level::Avx2 | Level::Avx512 => fill,
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn fill_avx2(row: Row<'_>, out: &mut [f32]) {
    fill(row, out);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl")]
fn fill_avx512(row: Row<'_>, out: &mut [f32]) {
    fill(row, out);
}

#[inline(always)]
fn fill(row: Row<'_>, out: &mut [f32]) {
    let n = out.len();
    let [cell_x, cell_y] = row.cells.map(|cells| &cells[..n]);
    let [x, y] = row.fractions.map(|fractions| &fractions[..n]);
    for i in 0..n {
        out[i] = noise([cell_x[i], cell_y[i]], [x[i], y[i]]);
    }
}

/// Three octaves, written out: only the innermost loop becomes vectors.
#[inline(always)]
fn noise(cells: [i32; 2], fractions: [f32; 2]) -> f32 {
    let first = octave(cells, fractions, 0);
    let (cells, fractions) = next(cells, fractions);
    let second = octave(cells, fractions, 0x85eb_ca6b);
    let (cells, fractions) = next(cells, fractions);
    let third = octave(cells, fractions, 0x0bd7_94d6);
    // 1 over the standard deviation of the bare sum of kernels.
    let unit = 1.0 / ((1u64 << 60) as f32 * (16.0f32 / 15.0 * 0.783_549_8 * 0.059_385_06).sqrt());
    0.25 * unit * (first + 0.5 * second + 0.25 * third)
}

/// The position in cells of the next octave.
#[inline(always)]
fn next(cells: [i32; 2], fractions: [f32; 2]) -> ([i32; 2], [f32; 2]) {
    let step = |cell: i32, t: f32| {
        // Below 3: a cast, which saturates, would keep the loop from becoming vectors.
        let doubled = 2.0 * (t + 0.5 * 0.381_966);
        let whole = i32::from(doubled >= 1.0) + i32::from(doubled >= 2.0);
        (
            cell.wrapping_mul(2).wrapping_add(whole),
            doubled - whole as f32,
        )
    };
    let (cell_x, x) = step(cells[0], fractions[0]);
    let (cell_y, y) = step(cells[1], fractions[1]);
    ([cell_x, cell_y], [x, y])
}

#[inline(always)]
fn octave(cells: [i32; 2], [x, y]: [f32; 2], seed: u32) -> f32 {
    let column = (cells[0] as u32).wrapping_mul(0x85eb_ca77);
    let row = (cells[1] as u32)
        .wrapping_mul(0x9e37_79b1)
        .wrapping_add(seed);
    let columns = [column, column.wrapping_add(0x85eb_ca77)];
    let rows = [row, row.wrapping_add(0x9e37_79b1)];
    let corner = |i: usize, j: usize| {
        let [gx, gy] = compass(columns[i] ^ rows[j]);
        gx * (x - i as f32) + gy * (y - j as f32)
    };
    let fade = |t: f32| t * t * t * (t * (6.0 * t - 15.0) + 10.0);
    let (u, v) = (fade(x), fade(y));
    let low = corner(0, 0) + u * (corner(1, 0) - corner(0, 0));
    let high = corner(0, 1) + u * (corner(1, 1) - corner(0, 1));
    low + v * (high - low)
}

/// A random direction, as long as 2⁶⁰.
#[inline(always)]
fn compass(word: u32) -> [f32; 2] {
    const HALF: f32 = (1u32 << 31) as f32;
    let hash = (word ^ (word >> 15)).wrapping_mul(0x846c_a68b);
    let angle = hash as i32 as f32;
    let turned = 0.5 * HALF - angle.abs();
    [turned, angle].map(|t| t * (HALF - t.abs()))
}
