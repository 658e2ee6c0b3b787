//! The two float banks: f32, the semantics, and f64, the oracle.
//!
//! Every method of the f32 bank is plain arithmetic with the same bits on every machine and at
//! every vector width: no fused multiply-add, no library calls, no branches, no tables. Elementary
//! functions reduce their range after Cody & Waite ("Software Manual for the Elementary
//! Functions", 1980): a multiple of the period is taken away in parts of so few bits that the
//! first products are exact. The polynomials interpolate the function at Chebyshev nodes of the
//! reduced range; the tests hold the errors that the op table states.
//!
//! Both banks are total in the same way: `exp` limits its operand to [−87, 88], so that it stays a
//! finite normal f32, and `ln` raises its operand to the smallest normal f32.

mod elementary;

/// What the op table asks of a float bank.
pub trait Float:
    Copy
    + Default
    + PartialOrd
    + Send
    + Sync
    + std::fmt::Debug
    + std::ops::Add<Output = Self>
    + std::ops::Sub<Output = Self>
    + std::ops::Mul<Output = Self>
    + std::ops::Div<Output = Self>
    + std::ops::Neg<Output = Self>
    + 'static
{
    /// The number, exactly (f64) or itself.
    fn from_f32(x: f32) -> Self;
    /// The nearest f32.
    fn to_f32(self) -> f32;
    /// The number as f64, exactly.
    fn to_f64(self) -> f64;
    /// The nearest number of the bank.
    fn from_i32(x: i32) -> Self;
    /// The nearest number of the bank.
    fn from_u32(x: u32) -> Self;
    /// Towards 0; saturates.
    fn to_i32(self) -> i32;
    /// The bits of the nearest f32; of what is not a number always `7fc0_0000`: its sign and payload
    /// are whatever the processor's instructions left.
    fn bits(self) -> u32;
    /// The 12 leading significant bits of the nearest f32.
    fn high(self) -> Self;
    /// Absolute value.
    fn abs(self) -> Self;
    /// The smaller; `a` unless `b < a`.
    #[inline(always)]
    fn smaller(a: Self, b: Self) -> Self {
        if b < a { b } else { a }
    }
    /// The larger; `a` unless `b > a`.
    #[inline(always)]
    fn larger(a: Self, b: Self) -> Self {
        if b > a { b } else { a }
    }
    /// The largest integer not above.
    fn floor(self) -> Self;
    /// Square root.
    fn sqrt(self) -> Self;
    /// e to the power.
    fn exp(self) -> Self;
    /// Natural logarithm.
    fn ln(self) -> Self;
    /// Sine of radians.
    fn sin(self) -> Self;
    /// Cosine of radians.
    fn cos(self) -> Self;
}

macro_rules! float_bank {
    ($F:ident, $to_i32:path, $floor:path, $exp:path, $ln:path, $sin:path, $cos:path) => {
        impl Float for $F {
            #[inline(always)]
            fn from_f32(x: f32) -> Self {
                x as $F
            }
            #[inline(always)]
            fn to_f32(self) -> f32 {
                self as f32
            }
            #[inline(always)]
            fn to_f64(self) -> f64 {
                self as f64
            }
            #[inline(always)]
            fn from_i32(x: i32) -> Self {
                x as $F
            }
            #[inline(always)]
            fn from_u32(x: u32) -> Self {
                x as $F
            }
            #[inline(always)]
            fn to_i32(self) -> i32 {
                $to_i32(self)
            }
            #[inline(always)]
            fn bits(self) -> u32 {
                let nearest = self as f32;
                if nearest.is_nan() {
                    0x7fc0_0000
                } else {
                    nearest.to_bits()
                }
            }
            #[inline(always)]
            fn high(self) -> Self {
                f32::from_bits((self as f32).to_bits() & 0xffff_f000) as $F
            }
            #[inline(always)]
            fn abs(self) -> Self {
                $F::abs(self)
            }
            #[inline(always)]
            fn floor(self) -> Self {
                $floor(self)
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                $F::sqrt(self)
            }
            #[inline(always)]
            fn exp(self) -> Self {
                $exp(self)
            }
            #[inline(always)]
            fn ln(self) -> Self {
                $ln(self)
            }
            #[inline(always)]
            fn sin(self) -> Self {
                $sin(self)
            }
            #[inline(always)]
            fn cos(self) -> Self {
                $cos(self)
            }
        }
    };
}
float_bank!(
    f32,
    elementary::to_i32,
    elementary::floor,
    elementary::exp,
    elementary::ln,
    elementary::sin,
    elementary::cos
);
float_bank!(
    f64,
    to_i32_f64,
    f64::floor,
    exp_f64,
    ln_f64,
    f64::sin,
    f64::cos
);

fn to_i32_f64(x: f64) -> i32 {
    x as i32
}

fn exp_f64(x: f64) -> f64 {
    x.clamp(
        f64::from(elementary::EXP_RANGE[0]),
        f64::from(elementary::EXP_RANGE[1]),
    )
    .exp()
}

fn ln_f64(x: f64) -> f64 {
    f64::max(x, f64::from(f32::MIN_POSITIVE)).ln()
}
