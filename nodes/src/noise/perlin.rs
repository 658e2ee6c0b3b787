//! Lattice noise with the quintic window of Perlin 2002: gradients or values at the lattice points.
//!
//! With w(t) = 1 − 10|t|³ + 15t⁴ − 6|t|⁵ for |t| < 1 and d the offset to a lattice point, the kernel
//! is w(d_x) w(d_y) g·d with a random direction g, or w(d_x) w(d_y) v with v uniform in [−1, 1]. The
//! noise is scaled to variance 1 over random lattices and positions.
//!
//! # How it is filtered
//! - Footprints narrow against a cell ([`near`]) act on the window's polynomials: E f(t + ξ) =
//!   f + ½Cf″ + ⅛C²f⁗, exact but for the jumps of w‴ at the lattice lines.
//! - Wider ones ([`window`]) replace the product of the w by a polynomial times a Gaussian, which
//!   any Gaussian footprint filters in closed form ([`fit`]); between 0.1 and 0.16 cells the two are mixed.
//! - What the filter removed comes from the energy spectrum ([`energy`]).

pub(super) mod energy;
pub(super) mod fit;
mod grid;
mod near;
pub(super) mod point;
pub(super) mod profile;
mod window;

use super::field::{Field, Spread};
use super::hash::{COMPASS_ENERGY, COMPASS_LENGTH, compass, signed};
use super::octave::Octave;
use super::remainder::{remainder, share};
use super::sum::{Octaves, parts};
use super::window::{count, start};
use energy::{Footprint, energies};
use fit::{Fit, Shape};
use grid::Grid;
use mipless_codegen::Lower;
use mipless_codegen::ir::{Builder, FunctionRef, Module, Value};
use mipless_codegen::moments::{Mode, Signal};

/// ∫ w² = 181/231.
pub(super) const WINDOW_ENERGY: f32 = 0.783_549_8;

/// ∫ t² w².
pub(super) const WINDOW_MOMENT: f32 = 0.059_385_06;

/// Below this share of its amplitude an octave has faded, above the other it has not begun to.
const FADE: [f32; 2] = [0.03, 0.06];

/// The standard deviations, in cells, from which and up to which the polynomials of the window
/// give way to its fit.
pub(super) const HANDOVER: [f32; 2] = [0.1, 0.16];

/// A kernel is dropped where its envelope is this small against the unfiltered noise: −2 ln 0.008.
const NEGLIGIBLE_LN: f32 = 10.3;

/// The sums over kernels, in the order of [`profile::DERIVATIVES`].
const NAMES: [&str; 6] = ["mean", "dx", "dy", "dxx", "dxy", "dyy"];

/// What is random at a lattice point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// A direction: Perlin's gradient noise.
    Gradient,
    /// A number: value noise.
    Value,
}

impl Kind {
    /// The kernel's terms: for each random number, whether the profiles along x and along y are
    /// w(t) (0) or t w(t) (1).
    const fn terms(self) -> &'static [[usize; 2]] {
        match self {
            Self::Gradient => &[[1, 0], [0, 1]],
            Self::Value => &[[0, 0]],
        }
    }

    /// The random numbers of a lattice point, as many as there are terms.
    fn weights(self, b: &mut Builder, hash: Value) -> Vec<Value> {
        match self {
            Self::Gradient => compass(b, hash).to_vec(),
            Self::Value => vec![signed(b, hash)],
        }
    }

    /// 1 over the standard deviation of the bare sum of kernels.
    pub(crate) fn unit(self) -> f32 {
        match self {
            Self::Gradient => {
                let energy = 2.0 * COMPASS_ENERGY * WINDOW_ENERGY * WINDOW_MOMENT;
                1.0 / (COMPASS_LENGTH * energy.sqrt())
            }
            Self::Value => 3.0f32.sqrt() / (WINDOW_ENERGY * (1u32 << 31) as f32),
        }
    }

    /// The wavelength of the dominant detail, in cells: where k times the energy spectrum peaks.
    pub(super) const fn wavelength(self) -> f32 {
        match self {
            Self::Gradient => 1.70,
            Self::Value => 3.144,
        }
    }

    /// The name of its rule.
    pub(crate) const fn rule(self) -> &'static str {
        match self {
            Self::Gradient => "perlin_noise",
            Self::Value => "value_noise",
        }
    }

    const fn fit(self) -> Fit {
        match self {
            Self::Gradient => fit::GRADIENT,
            Self::Value => fit::VALUE,
        }
    }

    /// What a kernel of the fit is multiplied by: the unit of its offset, in cells.
    const fn length(self) -> f32 {
        match self {
            Self::Gradient => fit::GRADIENT.width,
            Self::Value => 1.0,
        }
    }

    const fn name(self) -> &'static str {
        match self {
            Self::Gradient => "perlin",
            Self::Value => "value",
        }
    }
}

/// The filtered sum of octaves at a position in cells of the first octave; unit variance of the
/// first octave.
pub(crate) fn filtered(
    lower: &mut Lower<'_>,
    position: &[Signal],
    kind: Kind,
    octaves: Octaves,
    seed: Value,
) -> Field {
    let mode = lower.mode();
    let spread = Spread::of(lower.b(), position);
    let Octaves {
        lacunarity,
        diminish,
        ..
    } = octaves;
    let tiles = octaves.tiles();
    let name = kind.name();
    let key = format!("{name} {mode:?} {lacunarity} {diminish} {tiles}");
    let octave = match mode {
        Mode::Point => lower.function(&key, |module| point::octave(module, kind, octaves)),
        _ => lower.function(&key, |module| filtered_octave(module, kind, mode, octaves)),
    };
    let mut captures = Vec::new();
    if mode != Mode::Point {
        captures.extend(spread.covariance);
        captures.extend(spread.eigenvalues);
    }
    octaves.sum(lower, &octave, (position, seed), &captures, None)
}

/// One octave of the filtered noise, the body of a fold.
fn filtered_octave(module: &mut Module, kind: Kind, mode: Mode, octaves: Octaves) -> FunctionRef {
    let near = near::sums(module, kind, mode, octaves.tiles());
    let row = window::row(module, kind, mode, octaves.tiles());
    let parts = parts(mode);
    let doc = "One more octave of the filtered noise.";
    let mut b = Builder::new(format!("{}_octave", kind.name()), doc);
    b.param("index", mipless_codegen::ir::Type::U32);
    let sums: Vec<Value> = NAMES[..parts]
        .iter()
        .map(|name| b.param_f32(*name))
        .collect();
    let rest = mode.spreads().then(|| b.param_f32("rest"));
    let state = Octave::declare(&mut b, octaves);
    let covariance = ["s_xx", "s_xy", "s_yy"].map(|name| b.param_f32(name));
    let eigenvalues = ["s_major", "s_minor"].map(|name| b.param_f32(name));

    // The footprint in cells of this octave.
    let area = b.square(state.scale);
    let widest = b.f32(1e6);
    let area = b.min(area, widest);
    let covariance = covariance.map(|s| b.mul(s, area));
    let [major, minor] = eigenvalues.map(|s| b.mul(s, area));
    let determinant = b.mul(major, minor);
    let footprint = Footprint {
        covariance,
        determinant,
    };
    let energy = energies(&mut b, kind, &footprint);

    // The octave fades to nothing before it is dropped.
    let width = kind.fit().width;
    let window = Window::of(&mut b, width, &footprint, energy[0]);
    let zero = b.f32(0.0);
    let size = b.sqrt(major);
    let by_window = share(&mut b, size, HANDOVER[0], HANDOVER[1]);
    let one = b.f32(1.0);
    let by_near = b.sub(one, by_window);
    let (none, once) = (b.u32(0), b.u32(1));

    let is_near = b.lt(zero, by_near);
    let turns = b.select(is_near, once, none);
    let grid = Grid::of(&state).captures();
    let mut captures = grid.clone();
    captures.extend(state.fractions);
    captures.extend(covariance);
    let close = b.fold(&near, turns, &vec![zero; parts], &captures);

    let used = b.mul(by_window, window.fade);
    let is_used = b.lt(zero, used);
    let [points, rows] = count(&mut b, window.rows, window::COUNTS);
    let rows = b.select(is_used, rows, none);
    let start_y = start(&mut b, state.fractions[1], points);
    let mut captures = vec![start_y, window.rows, window.columns, window.shear];
    captures.extend(grid);
    captures.extend(state.fractions);
    captures.extend(window::captures(&window.shape));
    let kernels = b.fold(&row, rows, &vec![zero; parts], &captures);
    let wide = window.derivatives(&mut b, &kernels);

    // Both parts, in units of the position.
    let amplitude = b.scale(state.amplitude, kind.unit());
    let root = b.sqrt(window.inverse);
    let weight = b.mul(root, used);
    let weight = b.scale(weight, kind.length());
    let slope = b.mul(amplitude, state.scale);
    let factors = [amplitude, slope, b.mul(amplitude, area)];
    for (i, (name, sum)) in NAMES.into_iter().zip(sums).enumerate() {
        let order = profile::DERIVATIVES[i].iter().sum::<usize>();
        let finer = b.scale(weight, width.powi(-(order as i32)));
        let part = b.dot(&[by_near, finer], &[close[i], wide[i]]);
        let part = b.mul(part, factors[order]);
        let sum = b.add(sum, part);
        b.result(name, sum);
    }
    if let Some(rest) = rest {
        // Narrow footprints do not fade.
        let fade = b.add(by_near, used);
        let left = remainder(&mut b, mode, energy, fade);
        let power = b.square(state.amplitude);
        let part = b.mul(power, left);
        let rest = b.add(rest, part);
        b.result("rest", rest);
    }
    state.advance(&mut b, octaves);
    b.finish(module)
}

/// The sum over kernels of the window's fit: how far it reaches (rows, and columns of the middle row, as
/// reals), and what is left of it. What needs more than can be summed fades.
struct Window {
    shape: Shape<2>,
    /// 1/det T.
    inverse: Value,
    /// T₁₂/T₂₂.
    shear: Value,
    rows: Value,
    columns: Value,
    fade: Value,
}

impl Window {
    fn of(b: &mut Builder, width: f32, footprint: &Footprint, energy: Value) -> Self {
        let finer = width.powi(-2);
        let covariance = footprint.covariance.map(|s| b.scale(s, finer));
        let determinant = b.scale(footprint.determinant, finer * finer);
        let (shape, inverse) = window::shape(b, covariance, determinant);
        let t_yy = shape.total[1][1];
        // R² = ln F + 9.66 in units of T.
        let (tiny, one) = (b.f32(1e-12), b.f32(1.0));
        let energy = b.max(energy, tiny);
        let reach = b.ln(energy);
        let reach = b.offset(reach, NEGLIGIBLE_LN);
        let reach = b.max(reach, one);
        let reach = b.sqrt(reach);
        let reach = b.scale(reach, 2.0 * width);
        let rows = b.sqrt(t_yy);
        let rows = b.mul(rows, reach);
        let ratio = b.mul(inverse, t_yy);
        let ratio = b.div(one, ratio);
        let columns = b.sqrt(ratio);
        let columns = b.mul(columns, reach);
        let needed = b.max(rows, columns);
        let amplitude = b.sqrt(energy);
        let by_amplitude = share(b, amplitude, FADE[0], FADE[1]);
        let most = window::COUNTS[1];
        let by_reach = share(b, needed, most, most * 0.8);
        Self {
            fade: b.mul(by_amplitude, by_reach),
            shear: b.div(covariance[1], t_yy),
            shape,
            inverse,
            rows,
            columns,
        }
    }

    /// M on the sums: derivatives in units of the fit's width.
    fn derivatives(&self, b: &mut Builder, kernels: &[Value]) -> Vec<Value> {
        let m = self.shape.inverse;
        let mut all = vec![kernels[0]];
        if let Some(sums) = kernels.get(1..3) {
            all.extend(m.map(|row| b.dot(&row, sums)));
        }
        if let Some(&[h11, h12, h22]) = kernels.get(3..6) {
            for (i, j) in [(0, 0), (0, 1), (1, 1)] {
                let left = b.dot(&[h11, h12], &m[j]);
                let right = b.dot(&[h12, h22], &m[j]);
                all.push(b.dot(&m[i], &[left, right]));
            }
        }
        all
    }
}
