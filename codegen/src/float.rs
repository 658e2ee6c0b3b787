//! The two float banks: f32, the semantics, and f64, the oracle.
//!
//! Every method of the f32 bank is plain arithmetic with the same bits on every machine and at
//! every vector width: no fused multiply-add, no library calls.

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
    /// The bits of the nearest f32.
    fn bits(self) -> u32;
    /// The 12 leading significant bits of the nearest f32.
    fn high(self) -> Self;
    /// Absolute value.
    fn abs(self) -> Self;
    /// The smaller; `a` unless `b < a`.
    fn smaller(a: Self, b: Self) -> Self {
        if b < a { b } else { a }
    }
    /// The larger; `a` unless `b > a`.
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
    ($F:ident) => {
        impl Float for $F {
            fn from_f32(x: f32) -> Self {
                x as $F
            }
            fn to_f32(self) -> f32 {
                self as f32
            }
            fn to_f64(self) -> f64 {
                self as f64
            }
            fn from_i32(x: i32) -> Self {
                x as $F
            }
            fn from_u32(x: u32) -> Self {
                x as $F
            }
            fn to_i32(self) -> i32 {
                self as i32
            }
            fn bits(self) -> u32 {
                (self as f32).to_bits()
            }
            fn high(self) -> Self {
                f32::from_bits((self as f32).to_bits() & 0xffff_f000) as $F
            }
            fn abs(self) -> Self {
                $F::abs(self)
            }
            fn floor(self) -> Self {
                $F::floor(self)
            }
            fn sqrt(self) -> Self {
                $F::sqrt(self)
            }
            fn exp(self) -> Self {
                $F::exp(self)
            }
            fn ln(self) -> Self {
                $F::ln(self)
            }
            fn sin(self) -> Self {
                $F::sin(self)
            }
            fn cos(self) -> Self {
                $F::cos(self)
            }
        }
    };
}
float_bank!(f32);
float_bank!(f64);
