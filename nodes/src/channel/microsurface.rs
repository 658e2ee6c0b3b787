//! What the slopes that differ within a footprint make of a surface: the lobe of a host that knows one
//! GGX of two widths, its diffuse roughness, and what its own valleys hide.

use crate::pattern::angle::turns_of;
use mipless_codegen::ir::{Float, Sym2, Vec2};

/// Slopes beyond this are vertical.
const STEEPEST: f32 = 1e3;

/// The largest variance of a slope.
const LARGEST: f32 = 1e6;

/// The narrowest lobe.
const NARROWEST: f32 = 1e-4;

/// How many times the covariance of slopes is added to the square of a lobe's widths. Of 1 to 2.5 it is
/// nearest to the lobe convolved with Gaussian slopes: a GGX of width α is not a Gaussian of variance α²/2.
const WIDENING: f32 = 2.0;

/// Widths whose squares differ by less than this share are alike.
const ROUND: f32 = 4e-3;

/// The most anisotropic that a standard surface is.
const LONGEST: f32 = 0.98;

/// A surface within a footprint, by the mean of its slopes and their covariance.
#[derive(Clone, Copy)]
pub(super) struct Microsurface<'b> {
    mean: Vec2<'b>,
    covariance: Sym2<'b>,
}

/// A GGX lobe: the squares of its widths, the longer first, and the direction of the longer: cosine and
/// sine of twice its angle to u.
#[derive(Clone, Copy)]
pub(super) struct Lobe<'b> {
    long: Float<'b>,
    short: Float<'b>,
    doubled: Vec2<'b>,
}

impl<'b> Microsurface<'b> {
    pub(super) fn new(mean: Vec2<'b>, [uu, uv, vv]: [Float<'b>; 3]) -> Self {
        let [uu, vv] = [uu, vv].map(|variance| variance.clamp(0.0, LARGEST));
        let most = (uu * vv).sqrt();
        Self {
            mean: mean.map(|slope| slope.clamp(-STEEPEST, STEEPEST)),
            covariance: Sym2([uu, uv.clamp(-most, most), vv]),
        }
    }

    /// The mean of the slopes.
    pub(super) const fn mean(&self) -> Vec2<'b> {
        self.mean
    }

    /// Their covariance: along u, of both, along v.
    pub(super) const fn covariance(&self) -> Sym2<'b> {
        self.covariance
    }

    /// The normal of the mean slope, of length 1 in tangent space.
    pub(super) fn normal(&self) -> [Float<'b>; 3] {
        let up = 1.0 / (self.mean.norm2() + 1.0).sqrt();
        [-self.mean[0] * up, -self.mean[1] * up, up]
    }

    /// The covariance of the slopes as they are seen from the normal of their mean m: D S D with
    /// D = a (1 − a² mmᵀ/(1 + a)), a = 1/√(1 + |m|²), which is a across the tilt and a² along it.
    fn tangent(&self) -> Sym2<'b> {
        let a = 1.0 / (self.mean.norm2() + 1.0).sqrt();
        let bent = a * a * a / (a + 1.0);
        let [mu, mv] = *self.mean;
        let d = Sym2([a - bent * mu * mu, -bent * mu * mv, a - bent * mv * mv]);
        let [uu, uv, vv] = *self.covariance;
        let (first, second) = (
            Sym2([uu, uv, vv]).times(Vec2([d[0], d[1]])),
            Sym2([uu, uv, vv]).times(Vec2([d[1], d[2]])),
        );
        let row = |x: Float<'b>, y: Float<'b>, s: Vec2<'b>| Vec2([x, y]).dot(s);
        Sym2([
            row(d[0], d[1], first).max(0.0),
            row(d[1], d[2], first),
            row(d[1], d[2], second).max(0.0),
        ])
    }

    /// The lobe of a surface whose facets have a roughness: r⁴ + 2 S.
    pub(super) fn lobe(&self, roughness: Float<'b>) -> Lobe<'b> {
        let own = roughness.square().square();
        let [uu, uv, vv] = *self.tangent();
        let (middle, tilt) = (0.5 * (uu + vv), 0.5 * (uu - vv));
        let root = (tilt * tilt + uv * uv).sqrt();
        // Of a lobe that is next to round, the direction is none: it would be that of rounding.
        let long = root.gt((own + middle) * ROUND);
        let divisor = long.select(root, 1.0);
        Lobe {
            long: own + WIDENING * (middle + root),
            short: own + WIDENING * (middle - root).max(0.0),
            doubled: Vec2([
                long.select(tilt / divisor, 1.0),
                long.select(uv / divisor, 0.0),
            ]),
        }
    }

    /// The deviation of the slopes by which Oren and Nayar's surface spreads diffuse light.
    pub(super) fn diffuse_roughness(&self) -> Float<'b> {
        let [uu, _, vv] = *self.tangent();
        (0.5 * (uu + vv)).sqrt().min(1.0)
    }

    /// What of the light from all sides the valleys that were filtered let in: Smith's mean over the
    /// cosine, 1/(1 + 0.173 σ^1.444), within 0.006 for σ up to 2.
    pub(super) fn openness(&self) -> Float<'b> {
        let [uu, _, vv] = *self.covariance;
        let variance = 0.5 * (uu + vv);
        let power = (variance.max(1e-30).ln() * 0.722).exp();
        1.0 / (variance.gt(1e-30).select(power, 0.0) * 0.173 + 1.0)
    }
}

impl<'b> Lobe<'b> {
    /// α along the longer axis and across it.
    fn widths(&self) -> [Float<'b>; 2] {
        [self.long, self.short].map(|square| square.sqrt().clamp(NARROWEST, 1.0))
    }

    /// 1 − α_short/α_long.
    pub(super) fn anisotropy(&self) -> Float<'b> {
        let [long, short] = self.widths();
        1.0 - short / long
    }

    /// Roughness and anisotropy by which a standard surface has these widths: α = r²/√(1 − a) and
    /// r² √(1 − a), a at most 0.98, beyond which the longer width is kept.
    pub(super) fn standard(&self) -> [Float<'b>; 2] {
        let [long, short] = self.widths();
        let most = (1.0 - LONGEST).sqrt();
        let square = (long * short).sqrt().max(long * most);
        [square.sqrt(), self.anisotropy().min(LONGEST)]
    }

    /// The roughness by which an OpenPBR surface has these widths: α = r² √(2/(1 + (1 − a)²)) along the
    /// longer axis and (1 − a) of that across.
    pub(super) fn open_pbr(&self) -> Float<'b> {
        let [long, short] = self.widths();
        (0.5 * (long.square() + short.square())).sqrt().sqrt()
    }

    /// The roughness of the round lobe nearest to this one, r⁴ = (α₁² + α₂²)/2.
    pub(super) fn round(&self) -> Float<'b> {
        let square = (0.5 * (self.long + self.short)).sqrt();
        square.clamp(NARROWEST, 1.0).sqrt()
    }

    /// How far the longer axis is turned from u, in turns of [0, 1).
    pub(super) fn turns(&self) -> Float<'b> {
        let turns = turns_of(self.doubled[0], self.doubled[1]);
        // The axis has no sign: half a turn more or less is the same.
        0.5 * turns
    }

    /// The direction of the longer axis in tangent space.
    pub(super) fn tangent(&self) -> [Float<'b>; 3] {
        let [cosine, sine] = *self.doubled;
        let x = (0.5 * (cosine + 1.0)).max(0.0).sqrt();
        let y = (0.5 * (1.0 - cosine)).max(0.0).sqrt();
        [x, sine.lt(0.0).select(-y, y), x.literal(0.0)]
    }
}
