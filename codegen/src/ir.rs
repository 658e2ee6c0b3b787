//! The intermediate representation: small, typed, pure, in SSA form, hash-consed.
//!
//! # What a value is
//! A [`Value`] names one scalar of one [`Type`] inside one [`Function`]. It is defined once, by an
//! [`Inst`], and has no identity beyond its definition: two equal instructions of a function are
//! the same value (hash-consing), so common subexpressions cannot exist. Colours and moments are
//! several values; vectors appear only at the boundary of a program ([`Interface`]).
//!
//! # When it is evaluated
//! Never, in any order, or many times: every instruction is pure and total, so evaluation order is
//! the back end's choice. Control flow is [`Inst::Fold`] alone: it applies a named function `count`
//! times to a state. A fold whose count is 0 or 1 is the only conditional execution; everything
//! else is [`Op::Select`], whose two branches are both evaluated.
//!
//! # What is never allowed
//! - A use before its definition: operands have smaller indices than their user.
//! - Recursion: a function calls only functions with a smaller [`FunctionId`].
//! - An operand of another type than the op table says: there are no implicit conversions.
//! - Names in the hash key: they are a side table, so that readable names never defeat sharing.
//!
//! # Two back ends
//! WGSL text and the CPU batch evaluator both read this form. `F32` is the only bank that changes
//! between the semantics (f32) and the oracle (f64); integers, and so hashes and lattice cells, are
//! identical in every run.

mod build;
mod builder;
mod circle;
mod expand;
mod function;
mod idle;
mod inline;
mod library;
mod op;
mod prune;
#[cfg(test)]
pub(crate) mod random;
mod shared;
mod table;
mod text;
mod vector;
mod verify;

pub use builder::{Bool, Builder, Choice, Expr, Float, Int, Kind, Operand, Scalar, Scalars, Uint};
pub use circle::multiples;
pub use function::{Body, Function, FunctionRef, Label, Parameter};
pub(crate) use library::{Library, Shelves};
pub(crate) use op::for_each_op;
pub use op::{Op, OpInfo};
pub use shared::SharedFunction;
pub(crate) use table::Borrowed;
pub use table::{Numbers, Table};
pub use text::ParseError;
pub use vector::{Sym2, Vec2, dot};
pub use verify::{Violation, verify};

/// The type of a scalar.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Type {
    /// A real number: f32, or f64 in a run of the oracle.
    F32,
    /// A two's-complement integer; arithmetic wraps.
    I32,
    /// An unsigned integer; arithmetic wraps.
    U32,
    /// A truth value.
    Bool,
}

impl Type {
    /// The name in the IR's text form, which is also WGSL's.
    pub const fn name(self) -> &'static str {
        match self {
            Self::F32 => "f32",
            Self::I32 => "i32",
            Self::U32 => "u32",
            Self::Bool => "bool",
        }
    }
}

/// One scalar of a function, by the index of its defining instruction.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Value(pub(crate) u32);

impl Value {
    /// The index of the defining instruction.
    pub const fn index(self) -> usize {
        self.0 as usize
    }

    /// The value that the instruction at `index` defines.
    pub const fn from_index(index: usize) -> Self {
        Self(index as u32)
    }
}

/// A function of a module, by its position: callees come before callers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct FunctionId(pub(crate) u32);

impl FunctionId {
    /// The position in [`Module::functions`].
    pub const fn index(self) -> usize {
        self.0 as usize
    }

    /// The function at `index` of [`Module::functions`].
    pub const fn from_index(index: usize) -> Self {
        Self(index as u32)
    }
}

/// A constant: the bits of an f32, i32 or u32, or 0 and 1 for a truth value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Constant {
    /// The type.
    pub ty: Type,
    /// The bits.
    pub bits: u32,
}

impl Constant {
    /// The number, where the type is [`Type::F32`].
    pub fn as_f32(self) -> Option<f32> {
        (self.ty == Type::F32).then(|| f32::from_bits(self.bits))
    }
}

/// One definition.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Inst {
    /// A constant.
    Const(Constant),
    /// The parameter of the function at this position.
    Param(u32),
    /// An op of the table applied to as many operands as [`OpInfo::operands`] has; unused operand
    /// places repeat the first operand (or `Value(0)`), and are never read.
    Op(Op, [Value; 3]),
    /// A number of a table: `module.tables[table].data[index]`, the index (u32) clamped to the last.
    Load(u32, Value),
    /// `function(arguments)`; its results are read through [`Inst::Result`]. The value itself has
    /// no type and no other use.
    Call(FunctionId, Box<[Value]>),
    /// `state = init; for index in 0..count { state = function(index, state…, captures…) }`;
    /// `count` is u32. The results, read through [`Inst::Result`], are the last state.
    Fold {
        /// The body: parameters are the index (u32), the state and the captures; results the state.
        function: FunctionId,
        /// How many times.
        count: Value,
        /// The state before the first turn.
        init: Box<[Value]>,
        /// Values that every turn sees unchanged.
        captures: Box<[Value]>,
    },
    /// One result of a [`Inst::Call`] or a [`Inst::Fold`].
    Result(Value, u32),
}

impl Inst {
    /// Calls `visit` with every operand that is read.
    pub fn operands(&self, mut visit: impl FnMut(Value)) {
        match self {
            Self::Const(_) | Self::Param(_) => {}
            Self::Op(op, operands) => {
                operands[..op.info().operands.len()]
                    .iter()
                    .for_each(|&v| visit(v));
            }
            Self::Load(_, index) => visit(*index),
            Self::Call(_, arguments) => arguments.iter().for_each(|&v| visit(v)),
            Self::Fold {
                count,
                init,
                captures,
                ..
            } => {
                visit(*count);
                init.iter().chain(captures).for_each(|&v| visit(v));
            }
            Self::Result(of, _) => visit(*of),
        }
    }
}

/// Functions and tables; the last function is the entry.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Module {
    /// Callees before callers; the last is the entry.
    pub functions: Vec<Function>,
    /// The tables.
    pub tables: Vec<Table>,
}

impl Module {
    /// The function `id`.
    pub fn function(&self, id: FunctionId) -> &Function {
        &self.functions[id.index()]
    }

    /// The entry: the last function.
    ///
    /// # Panics
    /// If the module is empty.
    pub fn entry(&self) -> &Function {
        self.functions.last().expect("a module has an entry")
    }
}

/// How an entry function's scalars make up the typed inputs and outputs of a texture.
#[derive(Clone, Debug, PartialEq)]
pub struct Interface {
    /// The graph's name, an identifier in lower snake case.
    pub name: String,
    /// The graph's inputs. Their scalars follow the eight of the footprint in the entry's
    /// parameters, in order: `cell_x, cell_y` (i32), `u, v, du_dx, dv_dx, du_dy, dv_dy` (f32),
    /// where (u, v) is `Footprint::uv`, (du_dx, dv_dx) is `Footprint::du` (the change of uv from a
    /// pixel to the next one to the right) and (du_dy, dv_dy) is `Footprint::dv` (… to the one
    /// below). Where `position` holds, the twelve scalars of [`POSITION`] come between.
    pub parameters: Vec<Port>,
    /// The graph's outputs, in order: the scalars of their means make up the first results of the
    /// entry.
    pub outputs: Vec<Port>,
    /// Whether the variances of all outputs follow all means in the results.
    pub moments: bool,
    /// Whether the texture reads the surface's position in space.
    pub position: bool,
}

impl Interface {
    /// How many of the entry's parameters say where the pixel is: those of the footprint and of the
    /// position, before the graph's inputs.
    pub const fn place(&self) -> usize {
        FOOTPRINT.len() + if self.position { POSITION.len() } else { 0 }
    }
}

/// The eight scalars of a footprint, as parameters of every entry.
pub const FOOTPRINT: [(&str, Type); 8] = [
    ("cell_x", Type::I32),
    ("cell_y", Type::I32),
    ("u", Type::F32),
    ("v", Type::F32),
    ("du_dx", Type::F32),
    ("dv_dx", Type::F32),
    ("du_dy", Type::F32),
    ("dv_dy", Type::F32),
];

/// The twelve scalars of a position in space, as parameters of entries that read it: the integer
/// part, the rest, and the change from a pixel to the next one to the right and to the one below.
pub const POSITION: [(&str, Type); 12] = [
    ("space_cell_x", Type::I32),
    ("space_cell_y", Type::I32),
    ("space_cell_z", Type::I32),
    ("space_x", Type::F32),
    ("space_y", Type::F32),
    ("space_z", Type::F32),
    ("dx_dx", Type::F32),
    ("dy_dx", Type::F32),
    ("dz_dx", Type::F32),
    ("dx_dy", Type::F32),
    ("dy_dy", Type::F32),
    ("dz_dy", Type::F32),
];

/// A typed input or output of a texture.
#[derive(Clone, Debug, PartialEq)]
pub struct Port {
    /// The name in the JSON graph.
    pub name: String,
    /// The graph type: a float, integer, boolean, vector or colour.
    pub ty: mipless_graph::Type,
    /// For a parameter: its default, one number a component.
    pub default: Vec<f32>,
}

/// A compiled texture: what both back ends read.
#[derive(Clone, Debug, PartialEq)]
pub struct Program {
    /// The functions.
    pub module: Module,
    /// What goes in and comes out.
    pub interface: Interface,
}
