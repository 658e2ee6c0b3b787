//! The elementary functions of the f32 bank: branch-free, so that a loop over lanes vectorises.

use std::hint::select_unpredictable;

/// The operands that `exp` tells apart: e to these powers are finite and normal.
pub(super) const EXP_RANGE: [f32; 2] = [-87.0, 88.0];

/// Adding it rounds a number below 2²² to an integer, whose bits are then the lowest of the sum's.
const ROUNDER: f32 = 1.5 * (1 << 23) as f32;

/// The leading `bits` significant bits of `x`.
const fn leading(x: f64, bits: u32) -> f32 {
    f32::from_bits((x as f32).to_bits() & !((1 << (24 - bits)) - 1))
}

#[inline(always)]
fn limited(x: f32, [low, high]: [f32; 2]) -> f32 {
    let x = if x > low { x } else { low };
    if x < high { x } else { high }
}

/// The largest integer not above, without an instruction that only some machines have.
#[inline(always)]
pub(super) fn floor(x: f32) -> f32 {
    // From 2²³ on, every f32 is an integer.
    const INTEGERS: f32 = (1 << 23) as f32;
    let magnitude = f32::from_bits(x.to_bits() & 0x7fff_ffff);
    let sign = x.to_bits() & 0x8000_0000;
    let nearest = f32::from_bits(((magnitude + INTEGERS) - INTEGERS).to_bits() | sign);
    let below = nearest - if nearest > x { 1.0 } else { 0.0 };
    if magnitude < INTEGERS { below } else { x }
}

/// Towards 0; saturates, and 0 where `x` is not a number: the bits of `x as i32`, which does not
/// vectorise.
#[inline(always)]
pub(super) fn to_i32(x: f32) -> i32 {
    const END: f32 = (1_u32 << 31) as f32;
    let inside = if x.abs() < END { x } else { 0.0 };
    // SAFETY: `inside` is a number of magnitude below 2³¹, so its integer part is an i32.
    let integer = unsafe { inside.to_int_unchecked::<i32>() };
    let integer = select_unpredictable(x >= END, i32::MAX, integer);
    select_unpredictable(x <= -END, i32::MIN, integer)
}

/// e to the power: 2ⁿ eʳ with |r| ≤ ½ ln 2.
#[inline(always)]
pub(super) fn exp(x: f32) -> f32 {
    use std::f64::consts::{LN_2, LOG2_E};
    const HIGH: f32 = leading(LN_2, 12);
    const LOW: f32 = (LN_2 - HIGH as f64) as f32;
    let x = limited(x, EXP_RANGE);
    let rounded = x * LOG2_E as f32 + ROUNDER;
    let n = rounded - ROUNDER;
    let r = (x - n * HIGH) - n * LOW;
    let p = 0.001_392_626_79;
    let p = p * r + 0.008_363_246_92;
    let p = p * r + 0.041_666_552_4;
    let p = p * r + 0.166_665_763;
    let p = p * r + 0.5;
    let power = (p * r) * r + r + 1.0;
    // n lies in [−126, 127]: adding it to the exponent keeps the number normal, but for powers
    // below 1 at n = −126, which the range excludes.
    f32::from_bits(power.to_bits().wrapping_add(rounded.to_bits() << 23))
}

/// Natural logarithm: n ln 2 + ln(1 + f) with 1 + f in [√½, √2).
#[inline(always)]
pub(super) fn ln(x: f32) -> f32 {
    use std::f64::consts::{FRAC_1_SQRT_2, LN_2};
    const HIGH: f32 = leading(LN_2, 12);
    const LOW: f32 = (LN_2 - HIGH as f64) as f32;
    let x = limited(x, [f32::MIN_POSITIVE, f32::MAX]);
    let exponent = (x.to_bits() as i32).wrapping_sub((FRAC_1_SQRT_2 as f32).to_bits() as i32) >> 23;
    let n = exponent as f32;
    let f = f32::from_bits(x.to_bits().wrapping_sub((exponent as u32) << 23)) - 1.0;
    let p = -0.079_027_459;
    let p = p * f + 0.126_223_207;
    let p = p * f - 0.129_981_831;
    let p = p * f + 0.142_144_963;
    let p = p * f - 0.166_412_815;
    let p = p * f + 0.200_010_449;
    let p = p * f - 0.250_003_07;
    let p = p * f + 0.333_333_313;
    let square = f * f;
    let tail = (p * f) * square - 0.5 * square;
    n * HIGH + (f + (tail + n * LOW))
}

/// What a quarter of the circle makes of `x`: the quarter's number, and sine and cosine of the
/// rest, which lies within ±π/4.
#[inline(always)]
fn quarter(x: f32) -> (u32, f32, f32) {
    use std::f64::consts::{FRAC_2_PI, FRAC_PI_2, FRAC_PI_4};
    // 11 bits times a number of quarters of up to 13 bits is exact.
    const HIGH: f32 = leading(FRAC_PI_2, 11);
    const MIDDLE: f32 = leading(FRAC_PI_2 - HIGH as f64, 11);
    const LOW: f32 = (FRAC_PI_2 - HIGH as f64 - MIDDLE as f64) as f32;
    let rounded = x * FRAC_2_PI as f32 + ROUNDER;
    let n = rounded - ROUNDER;
    let r = ((x - n * HIGH) - n * MIDDLE) - n * LOW;
    // Far outside the range of use the rest is meaningless; it must still be a small number.
    let r = limited(r, [-FRAC_PI_4 as f32 - 1e-3, FRAC_PI_4 as f32 + 1e-3]);
    let z = r * r;
    let s = ((-0.000_195_872_49 * z + 0.008_332_745_17) * z - 0.166_666_642) * z;
    let c = ((0.000_024_547_298_4 * z - 0.001_388_830_02) * z + 0.041_666_664_2) * z;
    (rounded.to_bits(), r + r * s, (1.0 - 0.5 * z) + c * z)
}

/// Sine of radians.
#[inline(always)]
pub(super) fn sin(x: f32) -> f32 {
    let (quarter, sine, cosine) = quarter(x);
    let magnitude = if quarter & 1 == 0 { sine } else { cosine };
    f32::from_bits(magnitude.to_bits() ^ ((quarter & 2) << 30))
}

/// Cosine of radians.
#[inline(always)]
pub(super) fn cos(x: f32) -> f32 {
    let (quarter, sine, cosine) = quarter(x);
    let magnitude = if quarter & 1 == 0 { cosine } else { sine };
    f32::from_bits(magnitude.to_bits() ^ ((quarter.wrapping_add(1) & 2) << 30))
}

#[cfg(test)]
mod tests {
    use crate::float::Float;

    /// The largest error over `operands`, in units that `unit` gives for the exact result.
    fn largest_error(
        operands: impl Iterator<Item = f32>,
        f: fn(f32) -> f32,
        exact: fn(f64) -> f64,
        unit: fn(f64) -> f64,
    ) -> f64 {
        operands
            .map(|x| {
                let exact = exact(f64::from(x));
                (f64::from(f(x)) - exact).abs() / unit(exact)
            })
            .fold(0.0, f64::max)
    }

    /// The distance between the f32 next to `x`.
    fn ulp(x: f64) -> f64 {
        let bits = (x.abs() as f32).to_bits();
        f64::from(f32::from_bits(bits + 1)) - f64::from(f32::from_bits(bits))
    }

    fn grid(low: f32, high: f32) -> impl Iterator<Item = f32> {
        const STEPS: u32 = 2_000_000;
        (0..=STEPS).map(move |i| low + (high - low) * (i as f32 / STEPS as f32))
    }

    #[test]
    fn exp_is_within_2_ulp_and_finite_everywhere() {
        let error = largest_error(
            grid(-87.0, 88.0).chain(grid(-1.0, 1.0)),
            Float::exp,
            f64::exp,
            ulp,
        );
        assert!(error <= 2.0, "{error} ulp");
        for x in [
            -f32::INFINITY,
            f32::MIN,
            -87.5,
            -88.0,
            88.5,
            1000.0,
            f32::MAX,
            f32::INFINITY,
        ] {
            assert!(Float::exp(x).is_normal(), "{x}");
            let oracle = Float::exp(f64::from(x));
            assert!(
                (f64::from(Float::exp(x)) - oracle).abs() <= 2.0 * ulp(oracle),
                "{x}"
            );
        }
    }

    #[test]
    fn ln_is_within_2_ulp_for_every_magnitude_and_near_1() {
        let normals = (f32::MIN_POSITIVE.to_bits()..f32::INFINITY.to_bits()).step_by(997);
        let operands = normals.map(f32::from_bits).chain(grid(0.5, 2.0));
        let error = largest_error(operands, Float::ln, f64::ln, ulp);
        assert!(error <= 2.0, "{error} ulp");
        for x in [0.0, -1.0, 1e-40, f32::MIN_POSITIVE] {
            assert!((Float::ln(x) + 87.3365).abs() < 1e-4, "{x}");
            assert!((Float::ln(f64::from(x)) + 87.3365).abs() < 1e-4, "{x}");
        }
        assert_eq!(Float::ln(1.0_f32), 0.0);
    }

    #[test]
    fn sine_and_cosine_are_within_2e_7_and_bounded_everywhere() {
        let operands = || grid(-1e4, 1e4).chain(grid(-7.0, 7.0));
        let error = largest_error(operands(), Float::sin, f64::sin, |_| 1.0);
        assert!(error <= 2e-7, "sine: {error}");
        let error = largest_error(operands(), Float::cos, f64::cos, |_| 1.0);
        assert!(error <= 2e-7, "cosine: {error}");
        for x in (0..f32::INFINITY.to_bits())
            .step_by(9973)
            .map(f32::from_bits)
        {
            assert!(
                Float::sin(x).abs() <= 1.0 && Float::cos(x).abs() <= 1.0,
                "{x}"
            );
            if x < 1e6 {
                assert_eq!(Float::sin(-x), -Float::sin(x), "{x}");
                assert_eq!(Float::cos(-x), Float::cos(x), "{x}");
            }
        }
        assert!(Float::sin(f32::INFINITY).is_finite());
    }

    #[test]
    fn floor_and_truncation_have_the_bits_of_the_library() {
        for x in (0..=u32::MAX)
            .step_by(4999)
            .map(f32::from_bits)
            .chain(grid(-9.0, 9.0))
        {
            assert!(
                x.is_nan() || Float::floor(x).to_bits() == x.floor().to_bits(),
                "{x}"
            );
        }
    }
}
