//! Expressions: copyable handles of a function's values, with operators.
//!
//! Formulas are written as formulas: `0.5 * (xx - yy)`, `(t * t + xy * xy).sqrt()`,
//! `inside.select(out, 0.0)`. A number beside an expression is a constant of its function. What types
//! do not allow does not compile:
//!
//! ```compile_fail
//! use mipless_codegen::ir::Builder;
//! let b = Builder::new("f", "A real plus an integer.");
//! let sum = b.float_param("x") + b.int_param("i");
//! ```

use super::Builder;
use crate::ir::{Op, Type, Value};
use std::fmt;
use std::marker::PhantomData;
use std::ops::{
    Add, AddAssign, BitAnd, BitOr, BitXor, Div, Mul, MulAssign, Neg, Not, Shl, Shr, Sub, SubAssign,
};

/// A scalar of a function under construction, of the type that `T` stands for.
pub struct Expr<'b, T> {
    builder: &'b Builder,
    value: Value,
    ty: PhantomData<T>,
}

/// A real number: f32, or f64 in a run of the oracle.
pub type Float<'b> = Expr<'b, f32>;
/// A signed integer; arithmetic wraps.
pub type Int<'b> = Expr<'b, i32>;
/// An unsigned integer; arithmetic wraps.
pub type Uint<'b> = Expr<'b, u32>;
/// A truth value.
pub type Bool<'b> = Expr<'b, bool>;

/// A type of scalars.
pub trait Kind: Copy + PartialEq + 'static {
    /// The type in the IR.
    const TYPE: Type;
    /// The bits of a constant.
    fn bits(self) -> u32;
    /// The constant of these bits.
    fn of_bits(bits: u32) -> Self;
}

impl Kind for f32 {
    const TYPE: Type = Type::F32;
    /// −0 becomes 0.
    fn bits(self) -> u32 {
        (self + 0.0).to_bits()
    }
    fn of_bits(bits: u32) -> Self {
        Self::from_bits(bits)
    }
}

impl Kind for i32 {
    const TYPE: Type = Type::I32;
    fn bits(self) -> u32 {
        self as u32
    }
    fn of_bits(bits: u32) -> Self {
        bits as Self
    }
}

impl Kind for u32 {
    const TYPE: Type = Type::U32;
    fn bits(self) -> u32 {
        self
    }
    fn of_bits(bits: u32) -> Self {
        bits
    }
}

impl Kind for bool {
    const TYPE: Type = Type::Bool;
    fn bits(self) -> u32 {
        u32::from(self)
    }
    fn of_bits(bits: u32) -> Self {
        bits != 0
    }
}

/// What stands beside an expression: another one, or a number.
pub trait Operand<'b, T> {
    /// The expression, in the function of `builder`.
    fn within(self, builder: &'b Builder) -> Expr<'b, T>;
}

impl<'b, T: Kind> Operand<'b, T> for Expr<'b, T> {
    fn within(self, _: &'b Builder) -> Self {
        self
    }
}

impl<'b, T: Kind> Operand<'b, T> for T {
    fn within(self, builder: &'b Builder) -> Expr<'b, T> {
        builder.literal(self)
    }
}

impl<T> Clone for Expr<'_, T> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<T> Copy for Expr<'_, T> {}

impl<T> fmt::Debug for Expr<'_, T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "v{}", self.value.index())
    }
}

/// Two expressions are equal if they are one value of their function.
impl<T> PartialEq for Expr<'_, T> {
    fn eq(&self, other: &Self) -> bool {
        self.value == other.value && std::ptr::eq(self.builder, other.builder)
    }
}

impl<T> Eq for Expr<'_, T> {}

impl<'b, T: Kind> Expr<'b, T> {
    pub(in crate::ir) fn new(builder: &'b Builder, value: Value) -> Self {
        debug_assert_eq!(builder.ty(value), T::TYPE);
        Self {
            builder,
            value,
            ty: PhantomData,
        }
    }

    /// The function under construction.
    pub fn builder(self) -> &'b Builder {
        self.builder
    }

    /// The value in its function.
    pub(crate) fn value(self) -> Value {
        self.value
    }

    /// A constant beside this expression, in the same function.
    pub fn literal(self, x: T) -> Self {
        self.builder.literal(x)
    }

    /// The constant that this is, if it is one.
    pub fn as_constant(self) -> Option<T> {
        let constant = self.builder.constant_of(self.value)?;
        Some(T::of_bits(constant.bits))
    }

    fn unary<R: Kind>(self, op: Op) -> Expr<'b, R> {
        Expr::new(self.builder, self.builder.op(op, &[self.value]))
    }

    fn binary<R: Kind, U: Kind>(self, op: Op, other: impl Operand<'b, U>) -> Expr<'b, R> {
        let other = other.within(self.builder);
        Expr::new(
            self.builder,
            self.builder.op(op, &[self.value, other.value]),
        )
    }
}

/// Methods that are ops of one operand, or of two.
macro_rules! methods {
    ($ty:ident: $($(#[$doc:meta])* $name:ident $op:ident ($($other:ident: $kind:ty)?) -> $result:ident;)*) => {
        impl<'b> $ty<'b> {
            $($(#[$doc])*
            #[must_use]
            pub fn $name(self $(, $other: impl Operand<'b, $kind>)?) -> $result<'b> {
                methods!(@ self $op $($other)?)
            })*
        }
    };
    (@ $this:ident $op:ident) => { $this.unary(Op::$op) };
    (@ $this:ident $op:ident $other:ident) => { $this.binary(Op::$op, $other) };
}

methods! { Float:
    /// |x|.
    abs Abs () -> Float;
    /// The smaller of both.
    min Min (other: f32) -> Float;
    /// The larger of both.
    max Max (other: f32) -> Float;
    /// The largest integer not above.
    floor Floor () -> Float;
    /// √x of a number that is not negative.
    sqrt Sqrt () -> Float;
    /// eˣ for |x| ≤ 87.
    exp Exp () -> Float;
    /// ln x of a positive, normal number.
    ln Ln () -> Float;
    /// The sine of radians.
    sin Sin () -> Float;
    /// The cosine of radians.
    cos Cos () -> Float;
    /// The 12 leading significant bits: products of two such numbers are exact.
    high High () -> Float;
    /// Whether this is below the other.
    lt Lt (other: f32) -> Bool;
    /// Whether this is at most the other.
    le Le (other: f32) -> Bool;
    /// As an integer, towards 0; saturates.
    to_int TruncI () -> Int;
    /// The bits as f32.
    bits Bits () -> Uint;
}

methods! { Int:
    /// The smaller of both.
    min MinI (other: i32) -> Int;
    /// The larger of both.
    max MaxI (other: i32) -> Int;
    /// Whether this is below the other.
    lt LtI (other: i32) -> Bool;
    /// Whether both are the same number.
    equals EqI (other: i32) -> Bool;
    /// The nearest real number.
    to_float FloatI () -> Float;
    /// The same bits.
    to_uint CastU () -> Uint;
}

methods! { Uint:
    /// The smaller of both.
    min MinU (other: u32) -> Uint;
    /// Whether this is below the other.
    lt LtU (other: u32) -> Bool;
    /// Whether both are the same number.
    equals EqU (other: u32) -> Bool;
    /// The nearest real number.
    to_float FloatU () -> Float;
    /// The same bits.
    to_int CastI () -> Int;
}

impl<'b> Float<'b> {
    /// Whether this is the constant 0.
    pub fn is_zero(self) -> bool {
        self.as_constant() == Some(0.0)
    }

    /// Whether this is above the other.
    #[must_use]
    pub fn gt(self, other: impl Operand<'b, f32>) -> Bool<'b> {
        other.within(self.builder).lt(self)
    }

    /// Whether this is at least the other.
    #[must_use]
    pub fn ge(self, other: impl Operand<'b, f32>) -> Bool<'b> {
        other.within(self.builder).le(self)
    }

    /// x².
    #[must_use]
    pub fn square(self) -> Self {
        self * self
    }

    /// The smallest integer not below.
    #[must_use]
    pub fn ceil(self) -> Self {
        -(-self).floor()
    }

    /// This limited to `[low, high]`; `high` where they are crossed.
    #[must_use]
    pub fn clamp(self, low: impl Operand<'b, f32>, high: impl Operand<'b, f32>) -> Self {
        self.max(low).min(high)
    }
}

impl<'b> Uint<'b> {
    /// A bijection of 32-bit words without visible structure (Wellons's lowbias32), the hash of all
    /// noises and samples.
    #[must_use]
    pub fn scramble(self) -> Self {
        let word = self ^ (self >> 16);
        let word = word * 0x7feb_352d;
        let word = word ^ (word >> 15);
        let word = word * 0x846c_a68b;
        word ^ (word >> 16)
    }
}

/// Types that a condition chooses between.
pub trait Choice: Kind {
    /// The choice.
    #[doc(hidden)]
    fn choose<'b>(condition: Bool<'b>, yes: Expr<'b, Self>, no: Expr<'b, Self>) -> Expr<'b, Self>;
}

macro_rules! choices {
    ($($ty:ty: $op:ident;)*) => {
        $(impl Choice for $ty {
            fn choose<'b>(condition: Bool<'b>, yes: Expr<'b, Self>, no: Expr<'b, Self>) -> Expr<'b, Self> {
                let operands = [condition.value, yes.value, no.value];
                Expr::new(condition.builder, condition.builder.op(Op::$op, &operands))
            }
        })*
    };
}

choices! { f32: Select; i32: SelectI; u32: SelectU; }

impl Choice for bool {
    fn choose<'b>(condition: Bool<'b>, yes: Bool<'b>, no: Bool<'b>) -> Bool<'b> {
        condition & yes | !condition & no
    }
}

impl<'b> Bool<'b> {
    /// `yes` where this holds, else `no`; both are evaluated.
    #[must_use]
    pub fn select<T: Choice>(
        self,
        yes: impl Operand<'b, T>,
        no: impl Operand<'b, T>,
    ) -> Expr<'b, T> {
        T::choose(self, yes.within(self.builder), no.within(self.builder))
    }
}

/// Operators between two expressions, and between an expression and a number on either side.
macro_rules! operators {
    ($($ty:ident { $($trait:ident $method:ident $op:ident;)* })*) => {
        $($(impl<'b, R: Operand<'b, $ty>> $trait<R> for Expr<'b, $ty> {
            type Output = Self;
            fn $method(self, other: R) -> Self {
                self.binary(Op::$op, other)
            }
        }
        impl<'b> $trait<Expr<'b, $ty>> for $ty {
            type Output = Expr<'b, $ty>;
            fn $method(self, other: Expr<'b, $ty>) -> Expr<'b, $ty> {
                other.literal(self).binary(Op::$op, other)
            }
        })*)*
    };
}

operators! {
    f32 { Add add Add; Sub sub Sub; Mul mul Mul; Div div Div; }
    i32 { Add add AddI; Sub sub SubI; Mul mul MulI; BitAnd bitand AndI; }
    u32 {
        Add add AddU; Sub sub SubU; Mul mul MulU; BitAnd bitand AndU; BitOr bitor OrU;
        BitXor bitxor XorU; Shl shl ShlU; Shr shr ShrU;
    }
    bool { BitAnd bitand And; BitOr bitor Or; }
}

/// Shift to the right, by less than 32.
impl<'b, R: Operand<'b, u32>> Shr<R> for Int<'b> {
    type Output = Self;
    fn shr(self, by: R) -> Self {
        self.binary(Op::ShrI, by)
    }
}

impl Neg for Float<'_> {
    type Output = Self;
    fn neg(self) -> Self {
        self.unary(Op::Neg)
    }
}

impl Not for Bool<'_> {
    type Output = Self;
    fn not(self) -> Self {
        self.unary(Op::Not)
    }
}

macro_rules! assigned {
    ($($trait:ident $method:ident $of:ident $op:tt;)*) => {
        $(impl<'b, T: Kind, R> $trait<R> for Expr<'b, T>
        where
            Self: $of<R, Output = Self>,
        {
            fn $method(&mut self, other: R) {
                *self = *self $op other;
            }
        })*
    };
}

assigned! { AddAssign add_assign Add +; SubAssign sub_assign Sub -; MulAssign mul_assign Mul *; }
