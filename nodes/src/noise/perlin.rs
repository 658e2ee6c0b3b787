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
use super::jenkins;
use super::remainder::{remainder, share};
use super::sum::Octave;
use super::sum::{Octaves, footprint_scale, parts};
use super::window::{count, start};
use energy::{Footprint, energies};
use fit::{Fit, Shape};
use grid::{Grid, Tiles};
use mipless_codegen::Lower;
use mipless_codegen::ir::{Builder, Float, FunctionRef, Module, Sym2, Uint, Vec2};
use mipless_codegen::moments::{Mode, Signal};

/// ∫ w² = 181/231.
pub(super) const WINDOW_ENERGY: f32 = 0.783_549_8;

/// That of the cubic window: 26/35.
pub(super) const CUBIC_ENERGY: f32 = 26.0 / 35.0;

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
    /// One of eight directions by a byte of MaterialX's hash.
    Materialx(u8),
    /// A number by Material Maker's hash, with the cubic window 1 − 3t² + 2|t|³ in place of the quintic.
    Materialmaker {
        /// The node's seed, which is hashed where the shader is made.
        seed: i32,
    },
}

impl Kind {
    /// The kernel's terms: for each random number, whether the profiles along x and along y are
    /// w(t) (0) or t w(t) (1).
    const fn terms(self) -> &'static [[usize; 2]] {
        match self {
            Self::Gradient | Self::Materialx(_) => &[[1, 0], [0, 1]],
            Self::Value | Self::Materialmaker { .. } => &[[0, 0]],
        }
    }

    /// The random numbers of a lattice point, as many as there are terms.
    fn weights(self, hash: Uint<'_>) -> Vec<Float<'_>> {
        match self {
            Self::Gradient => compass(hash).to_vec(),
            Self::Value | Self::Materialmaker { .. } => vec![signed(hash)],
            Self::Materialx(byte) => jenkins::gradient(hash >> (8 * u32::from(byte))).to_vec(),
        }
    }

    /// 1 over the standard deviation of the bare sum of kernels.
    pub(crate) fn unit(self) -> f32 {
        match self {
            Self::Materialx(_) => 1.0 / self.deviation(),
            Self::Gradient => {
                let energy = 2.0 * COMPASS_ENERGY * WINDOW_ENERGY * WINDOW_MOMENT;
                1.0 / (COMPASS_LENGTH * energy.sqrt())
            }
            Self::Value => 3.0f32.sqrt() / (WINDOW_ENERGY * (1u32 << 31) as f32),
            Self::Materialmaker { .. } => 3.0f32.sqrt() / (CUBIC_ENERGY * (1u32 << 31) as f32),
        }
    }

    /// The standard deviation of the bare sum of kernels.
    pub(crate) fn deviation(self) -> f32 {
        match self {
            // E[gₓ²] = E[g_y²] = (1 + 4)/2, and the two are uncorrelated.
            Self::Materialx(_) => (2.0 * 2.5 * WINDOW_ENERGY * WINDOW_MOMENT).sqrt(),
            _ => 1.0 / self.unit(),
        }
    }

    /// The wavelength of the dominant detail, in cells: where k times the energy spectrum peaks.
    pub(super) const fn wavelength(self) -> f32 {
        match self {
            Self::Gradient | Self::Materialx(_) => 1.70,
            Self::Value => 3.144,
            Self::Materialmaker { .. } => 3.31,
        }
    }

    /// The order and the area of the band that has the slopes of its spectrum: E|∂|² = 3.6464 a cell²
    /// of values and 8.384 of gradients, from ∫ w′² and ∫ ((t w)′)²; what any round filter removes of
    /// them is within 1.3 % of all.
    pub(super) const fn band(self) -> (u32, f32) {
        match self {
            // MaterialX's directions have the second moments of a circle's.
            Self::Gradient | Self::Materialx(_) => (1, 0.119_27),
            Self::Value => (0, 0.137_12),
            // ∫ w′² = 12/5 of the cubic window: 3.2308 a cell².
            Self::Materialmaker { .. } => (0, 0.154_76),
        }
    }

    /// The name of its rule.
    pub(crate) const fn rule(self) -> &'static str {
        match self {
            Self::Materialx(_) => "materialx_noise",
            Self::Gradient => "perlin_noise",
            Self::Value => "value_noise",
            Self::Materialmaker { .. } => "materialmaker_noise",
        }
    }

    const fn fit(self) -> Fit {
        match self {
            Self::Gradient | Self::Materialx(_) => fit::GRADIENT,
            Self::Value => fit::VALUE,
            Self::Materialmaker { .. } => fit::CUBIC,
        }
    }

    /// What a kernel of the fit is multiplied by: the unit of its offset, in cells.
    const fn length(self) -> f32 {
        match self {
            Self::Gradient | Self::Materialx(_) => fit::GRADIENT.width,
            Self::Value | Self::Materialmaker { .. } => 1.0,
        }
    }

    /// The window and its derivatives by |t|.
    fn window(self, t: Float<'_>) -> Vec<Float<'_>> {
        match self {
            Self::Materialmaker { .. } => profile::cubic(t),
            _ => profile::window(t),
        }
    }

    /// From and up to which standard deviation, in cells, the polynomials of the window give way to
    /// its fit. Those of the cubic window are off by its jumps of w″ at the lattice lines, with the
    /// square of the footprint.
    const fn handover(self) -> [f32; 2] {
        match self {
            Self::Materialmaker { .. } => [0.05, 0.08],
            _ => HANDOVER,
        }
    }

    const fn name(self) -> &'static str {
        match self {
            Self::Materialx(_) => "materialx",
            Self::Gradient => "perlin",
            Self::Value => "value",
            Self::Materialmaker { .. } => "materialmaker",
        }
    }
}

/// The filtered sum of octaves at a position in cells of the first octave; unit variance of the
/// first octave.
pub(crate) fn filtered<'b>(
    lower: &mut Lower<'_, 'b>,
    position: &[Signal<'b>],
    kind: Kind,
    octaves: Octaves,
    seed: Uint<'b>,
) -> Field<'b> {
    let mode = lower.mode();
    let spread = Spread::of(position);
    let Octaves {
        lacunarity,
        diminish,
        ..
    } = octaves;
    let tiles = octaves.tiles();
    let name = kind.name();
    let ratio = octaves.ratio;
    let key = format!("{name} {kind:?} {mode:?} {lacunarity} {diminish} {tiles} {ratio}");
    let octave = lower.function(&key, |module| match mode {
        Mode::Point => point::octave(module, kind, octaves),
        _ => filtered_octave(module, kind, mode, octaves),
    });
    let captures = (mode != Mode::Point).then_some((spread.covariance, spread.eigenvalues));
    octaves.sum(lower, &octave, (position, seed), captures, None)
}

/// One octave of the filtered noise, the body of a fold.
fn filtered_octave(module: &mut Module, kind: Kind, mode: Mode, octaves: Octaves) -> FunctionRef {
    let near = near::sums(module, kind, mode, Tiles::of(octaves));
    let row = window::row(module, kind, mode, Tiles::of(octaves));
    let parts = parts(mode);
    let doc = "One more octave of the filtered noise.";
    let b = &Builder::new(format!("{}_octave", kind.name()), doc);
    b.uint_param("index");
    let sums: Vec<Float<'_>> = NAMES[..parts]
        .iter()
        .map(|name| b.float_param(*name))
        .collect();
    let rest = mode.spreads().then(|| b.float_param("rest"));
    let state = Octave::declare(b, octaves);
    let covariance = Sym2(b.float_params(["s_xx", "s_xy", "s_yy"]));
    let eigenvalues = b.float_params(["s_major", "s_minor"]);

    // The footprint in cells of this octave.
    let area = footprint_scale(state.scale, eigenvalues[0]);
    let [major, minor] = eigenvalues.map(|s| s * area);
    let footprint = Footprint {
        covariance: covariance * area,
        determinant: major * minor,
    };
    let energy = energies(kind, &footprint);
    let width = kind.fit().width;
    let [from, to] = kind.handover();
    let by_window = share(major.sqrt(), from, to);
    let by_near = 1.0 - by_window;

    // Polynomials of the window.
    let grid = Grid::of(&state, kind);
    let zeros = vec![b.float(0.0); parts];
    let captures = (grid, state.fractions, footprint.covariance);
    let turns = by_near.gt(0.0).select(1u32, 0u32);
    let close = b.fold(&near, turns, zeros.clone(), captures);

    // Its fit. The octave fades to nothing before it is dropped.
    let window = Window::of(width, &footprint, energy[0]);
    let used = by_window * window.fade;
    let (points, rows) = count(window.rows, window::COUNTS);
    let rows = used.gt(0.0).select(rows, 0);
    let start_y = start(state.fractions[1], points);
    let reach = [start_y, window.rows, window.columns, window.shear];
    let shape = window::captures(&window.shape);
    let kernels = b.fold(&row, rows, zeros, (reach, grid, state.fractions, shape));
    let wide = window.derivatives(&kernels);

    // Both parts, in units of the position.
    let amplitude = state.amplitude * kind.unit();
    let weight = window.inverse.sqrt() * used * kind.length();
    let factors = [amplitude, amplitude * state.scale, amplitude * area];
    for (i, (name, sum)) in NAMES.into_iter().zip(sums).enumerate() {
        let order = profile::DERIVATIVES[i].iter().sum::<usize>();
        let finer = weight * width.powi(-(order as i32));
        let part = by_near * close[i] + finer * wide[i];
        b.result(name, sum + part * factors[order]);
    }
    if let Some(rest) = rest {
        // Narrow footprints do not fade.
        let left = remainder(mode, energy, by_near + used);
        b.result("rest", rest + state.amplitude.square() * left);
    }
    state.advance(b, octaves);
    b.finish(module)
}

/// The sum over kernels of the window's fit: how far it reaches (rows, and columns of the middle row, as
/// reals), and what is left of it. What needs more than can be summed fades.
struct Window<'b> {
    shape: Shape<'b, 2>,
    /// 1/det T.
    inverse: Float<'b>,
    /// T₁₂/T₂₂.
    shear: Float<'b>,
    rows: Float<'b>,
    columns: Float<'b>,
    fade: Float<'b>,
}

impl<'b> Window<'b> {
    fn of(width: f32, footprint: &Footprint<'b>, energy: Float<'b>) -> Self {
        let finer = width.powi(-2);
        let covariance = footprint.covariance * finer;
        let determinant = footprint.determinant * (finer * finer);
        let (shape, inverse) = window::shape(covariance, determinant);
        let t_yy = shape.total[1][1];
        // R² = ln F + 9.66 in units of T.
        let energy = energy.max(1e-12);
        let reach = (energy.ln() + NEGLIGIBLE_LN).max(1.0).sqrt() * (2.0 * width);
        let rows = t_yy.sqrt() * reach;
        let columns = (1.0 / (inverse * t_yy)).sqrt() * reach;
        let most = window::COUNTS[1];
        let by_amplitude = share(energy.sqrt(), FADE[0], FADE[1]);
        let by_reach = share(rows.max(columns), most, most * 0.8);
        Self {
            fade: by_amplitude * by_reach,
            shear: covariance[1] / t_yy,
            shape,
            inverse,
            rows,
            columns,
        }
    }

    /// M on the sums: derivatives in units of the fit's width.
    fn derivatives(&self, kernels: &[Float<'b>]) -> Vec<Float<'b>> {
        let m = self.shape.inverse.map(Vec2);
        let mut all = vec![kernels[0]];
        if let Some(&[x, y]) = kernels.get(1..3) {
            all.extend(m.map(|row| row.dot(Vec2([x, y]))));
        }
        if let Some(&[h11, h12, h22]) = kernels.get(3..6) {
            let hessian = Sym2([h11, h12, h22]);
            for (i, j) in [(0, 0), (0, 1), (1, 1)] {
                all.push(m[i].dot(hessian.times(m[j])));
            }
        }
        all
    }
}
