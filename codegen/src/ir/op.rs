//! The op table. **Adding an op is one row here.**
//!
//! A row is: the variant, its name in the IR's text, its operands, its result type, its CPU
//! semantics (an expression, generic over the float bank `F`), its WGSL (operands in braces), its
//! error bound, and one sentence of documentation. WGSL infix operators are written with single
//! spaces; the emitter adds the parentheses.

use super::Type;

/// What the op table says of an op.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OpInfo {
    /// The name in the IR's text form.
    pub name: &'static str,
    /// The operands' types. [`Op::Select`] takes any one type for its last two.
    pub operands: &'static [Type],
    /// The result's type.
    pub result: Type,
    /// The WGSL expression: `{a}`, `{b}`, `{c}` stand for the operands.
    pub wgsl: &'static str,
    /// The largest error of the CPU's f32 run.
    pub error: &'static str,
    /// One sentence.
    pub doc: &'static str,
}

/// Calls the macro `$callback` with all the rows.
macro_rules! for_each_op {
    ($callback:ident) => {
        $callback! {
            // Real arithmetic.
            Add "add" (a: F, b: F) -> F { a + b } "{a} + {b}" "correctly rounded" "Sum.";
            Sub "sub" (a: F, b: F) -> F { a - b } "{a} - {b}" "correctly rounded" "Difference.";
            Mul "mul" (a: F, b: F) -> F { a * b } "{a} * {b}" "correctly rounded" "Product.";
            Div "div" (a: F, b: F) -> F { a / b } "{a} / {b}" "correctly rounded (WGSL: 2.5 ulp)" "Quotient.";
            Neg "neg" (a: F) -> F { -a } "-{a}" "exact" "Negation.";
            Abs "abs" (a: F) -> F { Float::abs(a) } "abs({a})" "exact" "Absolute value.";
            Min "min" (a: F, b: F) -> F { Float::smaller(a, b) } "min({a}, {b})" "exact" "The smaller.";
            Max "max" (a: F, b: F) -> F { Float::larger(a, b) } "max({a}, {b})" "exact" "The larger.";
            Floor "floor" (a: F) -> F { Float::floor(a) } "floor({a})" "exact" "The largest integer not above.";
            Sqrt "sqrt" (a: F) -> F { Float::sqrt(a) } "sqrt({a})" "correctly rounded (WGSL: 2.5 ulp)" "Square root; the operand is not negative.";
            Exp "exp" (a: F) -> F { Float::exp(a) } "exp({a})" "2 ulp on [-87, 88]" "e to the power; the operand lies within ±87.";
            Ln "ln" (a: F) -> F { Float::ln(a) } "log({a})" "2 ulp" "Natural logarithm; the operand is positive and normal.";
            Sin "sin" (a: F) -> F { Float::sin(a) } "sin({a})" "2e-7 on ±10⁴" "Sine of radians.";
            Cos "cos" (a: F) -> F { Float::cos(a) } "cos({a})" "2e-7 on ±10⁴" "Cosine of radians.";
            High "high" (a: F) -> F { Float::high(a) } "bitcast<f32>(bitcast<u32>({a}) & 0xfffff000u)" "exact" "The 12 leading significant bits: products of two such numbers are exact.";
            // Comparisons of reals.
            Lt "lt" (a: F, b: F) -> bool { a < b } "{a} < {b}" "exact" "Whether a < b.";
            Le "le" (a: F, b: F) -> bool { a <= b } "{a} <= {b}" "exact" "Whether a ≤ b.";
            // Logic.
            And "and" (a: bool, b: bool) -> bool { a & b } "{a} & {b}" "exact" "Both.";
            Or "or" (a: bool, b: bool) -> bool { a | b } "{a} | {b}" "exact" "Either.";
            Not "not" (a: bool) -> bool { !a } "!{a}" "exact" "Negation.";
            // Signed integers.
            AddI "iadd" (a: i32, b: i32) -> i32 { a.wrapping_add(b) } "{a} + {b}" "wraps" "Sum.";
            SubI "isub" (a: i32, b: i32) -> i32 { a.wrapping_sub(b) } "{a} - {b}" "wraps" "Difference.";
            MulI "imul" (a: i32, b: i32) -> i32 { a.wrapping_mul(b) } "{a} * {b}" "wraps" "Product.";
            MinI "imin" (a: i32, b: i32) -> i32 { if b < a { b } else { a } } "min({a}, {b})" "exact" "The smaller.";
            MaxI "imax" (a: i32, b: i32) -> i32 { if b > a { b } else { a } } "max({a}, {b})" "exact" "The larger.";
            LtI "ilt" (a: i32, b: i32) -> bool { a < b } "{a} < {b}" "exact" "Whether a < b.";
            EqI "ieq" (a: i32, b: i32) -> bool { a == b } "{a} == {b}" "exact" "Whether a = b.";
            AndI "iand" (a: i32, b: i32) -> i32 { a & b } "{a} & {b}" "exact" "Bitwise and.";
            ShrI "ishr" (a: i32, b: u32) -> i32 { a >> (b & 31) } "{a} >> {b}" "exact" "Arithmetic shift to the right, by less than 32.";
            // Unsigned integers.
            AddU "uadd" (a: u32, b: u32) -> u32 { a.wrapping_add(b) } "{a} + {b}" "wraps" "Sum.";
            SubU "usub" (a: u32, b: u32) -> u32 { a.wrapping_sub(b) } "{a} - {b}" "wraps" "Difference.";
            MulU "umul" (a: u32, b: u32) -> u32 { a.wrapping_mul(b) } "{a} * {b}" "wraps" "Product.";
            MinU "umin" (a: u32, b: u32) -> u32 { if b < a { b } else { a } } "min({a}, {b})" "exact" "The smaller.";
            AndU "uand" (a: u32, b: u32) -> u32 { a & b } "{a} & {b}" "exact" "Bitwise and.";
            OrU "uor" (a: u32, b: u32) -> u32 { a | b } "{a} | {b}" "exact" "Bitwise or.";
            XorU "uxor" (a: u32, b: u32) -> u32 { a ^ b } "{a} ^ {b}" "exact" "Bitwise exclusive or.";
            ShlU "ushl" (a: u32, b: u32) -> u32 { a << (b & 31) } "{a} << {b}" "exact" "Shift to the left, by less than 32.";
            ShrU "ushr" (a: u32, b: u32) -> u32 { a >> (b & 31) } "{a} >> {b}" "exact" "Shift to the right, by less than 32.";
            LtU "ult" (a: u32, b: u32) -> bool { a < b } "{a} < {b}" "exact" "Whether a < b.";
            EqU "ueq" (a: u32, b: u32) -> bool { a == b } "{a} == {b}" "exact" "Whether a = b.";
            // Conversions.
            FloatI "float_i" (a: i32) -> F { Float::from_i32(a) } "f32({a})" "correctly rounded" "An integer as a real.";
            FloatU "float_u" (a: u32) -> F { Float::from_u32(a) } "f32({a})" "correctly rounded" "An integer as a real.";
            TruncI "trunc_i" (a: F) -> i32 { Float::to_i32(a) } "i32({a})" "exact" "A real as an integer, towards 0; saturates.";
            Bits "bits" (a: F) -> u32 { Float::bits(a) } "bitcast<u32>({a})" "exact" "The bits of a real as f32.";
            CastU "cast_u" (a: i32) -> u32 { a as u32 } "u32({a})" "exact" "The same bits.";
            CastI "cast_i" (a: u32) -> i32 { a as i32 } "i32({a})" "exact" "The same bits.";
            // Choice.
            Select "select" (a: bool, b: F, c: F) -> F { std::hint::select_unpredictable(a, b, c) } "select({c}, {b}, {a})" "exact" "b where a holds, else c.";
            SelectI "iselect" (a: bool, b: i32, c: i32) -> i32 { std::hint::select_unpredictable(a, b, c) } "select({c}, {b}, {a})" "exact" "b where a holds, else c.";
            SelectU "uselect" (a: bool, b: u32, c: u32) -> u32 { std::hint::select_unpredictable(a, b, c) } "select({c}, {b}, {a})" "exact" "b where a holds, else c.";
        }
    };
}
pub(crate) use for_each_op;

/// The type that a row's type word stands for.
macro_rules! type_of {
    (F) => {
        Type::F32
    };
    (i32) => {
        Type::I32
    };
    (u32) => {
        Type::U32
    };
    (bool) => {
        Type::Bool
    };
}

macro_rules! define_ops {
    ($($variant:ident $name:literal ($($p:ident: $pt:tt),*) -> $rt:tt { $cpu:expr } $wgsl:literal $error:literal $doc:literal;)*) => {
        /// A pure, total function of up to three scalars: a row of the op table.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub enum Op {
            $(#[doc = $doc] $variant,)*
        }

        impl Op {
            /// Every op, in the table's order.
            pub const ALL: &'static [Self] = &[$(Self::$variant),*];

            /// What the table says of this op.
            pub const fn info(self) -> &'static OpInfo {
                match self {
                    $(Self::$variant => &OpInfo {
                        name: $name,
                        operands: &[$(type_of!($pt)),*],
                        result: type_of!($rt),
                        wgsl: $wgsl,
                        error: $error,
                        doc: $doc,
                    },)*
                }
            }
        }
    };
}
for_each_op!(define_ops);

impl Op {
    /// The op of that name in the IR's text form.
    pub fn by_name(name: &str) -> Option<Self> {
        Self::ALL.iter().copied().find(|op| op.info().name == name)
    }
}

/// The bits of a scalar of a bank, for the evaluation of one op on constants.
trait Scalar {
    fn from_constant(bits: u32) -> Self;
    fn to_constant(self) -> u32;
}

impl Scalar for f32 {
    fn from_constant(bits: u32) -> Self {
        Self::from_bits(bits)
    }
    fn to_constant(self) -> u32 {
        self.to_bits()
    }
}

impl Scalar for i32 {
    fn from_constant(bits: u32) -> Self {
        bits as Self
    }
    fn to_constant(self) -> u32 {
        self as u32
    }
}

impl Scalar for u32 {
    fn from_constant(bits: u32) -> Self {
        bits
    }
    fn to_constant(self) -> u32 {
        self
    }
}

impl Scalar for bool {
    fn from_constant(bits: u32) -> Self {
        bits != 0
    }
    fn to_constant(self) -> u32 {
        u32::from(self)
    }
}

macro_rules! define_fold {
    ($($variant:ident $name:literal ($($p:ident: $pt:tt),*) -> $rt:tt { $cpu:expr } $wgsl:literal $error:literal $doc:literal;)*) => {
        /// The result's bits for operands of these bits: the f32 semantics of the op.
        pub(crate) fn fold_constants(op: Op, bits: [u32; 3]) -> u32 {
            use crate::float::Float;
            type F = f32;
            let mut operands = bits.into_iter();
            match op {
                $(Op::$variant => {
                    $(let $p = <$pt as Scalar>::from_constant(operands.next().unwrap_or(0));)*
                    let result: $rt = $cpu;
                    result.to_constant()
                })*
            }
        }
    };
}
for_each_op!(define_fold);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_unique_and_found() {
        for &op in Op::ALL {
            assert_eq!(Op::by_name(op.info().name), Some(op));
        }
    }

    #[test]
    fn constants_fold_with_the_semantics_of_the_row() {
        let f = f32::to_bits;
        assert_eq!(
            f32::from_bits(fold_constants(Op::Sub, [f(3.0), f(5.0), 0])),
            -2.0
        );
        assert_eq!(fold_constants(Op::MulU, [0x8000_0001, 2, 0]), 2);
        assert_eq!(fold_constants(Op::Lt, [f(1.0), f(2.0), 0]), 1);
    }
}
