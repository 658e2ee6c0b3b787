//! Node specs as data: the reference pages, the JSON Schema and the catalogue dump are generated
//! from them, and the resolver checks documents against them.

use crate::{Picture, Reach, Type};

/// What kind of node it is; orders the catalogue.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Category {
    /// Coordinates, constants.
    Input,
    /// Sources of detail.
    Noise,
    /// Deterministic functions of position.
    Pattern,
    /// Sums and products.
    Arithmetic,
    /// Functions of one signal.
    Transfer,
    /// Colour.
    Color,
    /// Coordinates from coordinates.
    Coordinate,
    /// Packing and unpacking.
    Channel,
}

impl Category {
    /// A heading.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Input => "input",
            Self::Noise => "noise",
            Self::Pattern => "pattern",
            Self::Arithmetic => "arithmetic",
            Self::Transfer => "transfer",
            Self::Color => "color",
            Self::Coordinate => "coordinate",
            Self::Channel => "channel",
        }
    }
}

/// What a port takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PortType {
    /// This type, or one that converts to it.
    Exactly(Type),
    /// Any of `float`, `vector2…4`, `color3`, `color4`: the node's own type is the widest of all
    /// such ports, and each is promoted to it.
    Any,
    /// As [`PortType::Any`], but a float stays one: what acts on all components alike.
    Each,
    /// Any of these types, whatever the others have.
    Own,
    /// `color3`, or `color4` where what is connected has an alpha.
    Color,
    /// One of these names; always uniform.
    Choice(&'static [&'static str]),
    /// A list of `{ "at": number, "value": number or colour }`; always uniform.
    Stops,
    /// A square matrix: a list of 9 or 16 numbers; always uniform.
    Matrix,
}

impl PortType {
    /// Whether the port has its type in common with others.
    pub const fn is_common(&self) -> bool {
        matches!(self, Self::Any | Self::Each)
    }
}

/// What an unconnected port holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Default {
    /// A number (broadcast to the port's type).
    Float(f32),
    /// An integer.
    Integer(i32),
    /// A truth value.
    Boolean(bool),
    /// Two numbers.
    Vector2([f32; 2]),
    /// A colour.
    Color3([f32; 3]),
    /// One of the port's names.
    Choice(&'static str),
    /// Text, or the name of a file; empty for none.
    Text(&'static str),
    /// Stops `(at, value)` of a float ramp.
    Stops(&'static [(f32, f32)]),
    /// The surface's texture coordinates.
    Surface,
    /// The matrix of three rows that changes nothing.
    Identity,
}

/// The numbers that a port accepts, and those that an editor offers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// The smallest accepted.
    pub min: f32,
    /// The largest accepted.
    pub max: f32,
    /// Where a slider starts.
    pub soft_min: f32,
    /// Where a slider ends.
    pub soft_max: f32,
    /// Whether 0 is refused although it lies within (a divisor).
    pub nonzero: bool,
}

impl Range {
    /// Any finite number; the slider goes from `soft_min` to `soft_max`.
    pub const fn soft(soft_min: f32, soft_max: f32) -> Self {
        Self {
            min: f32::MIN,
            max: f32::MAX,
            soft_min,
            soft_max,
            nonzero: false,
        }
    }

    /// Numbers of `[min, max]`; the slider covers the same.
    pub const fn hard(min: f32, max: f32) -> Self {
        Self {
            min,
            max,
            soft_min: min,
            soft_max: max,
            nonzero: false,
        }
    }

    /// The same with another slider.
    pub const fn with_soft(self, soft_min: f32, soft_max: f32) -> Self {
        Self {
            soft_min,
            soft_max,
            ..self
        }
    }

    /// The same without 0.
    pub const fn nonzero(self) -> Self {
        Self {
            nonzero: true,
            ..self
        }
    }
}

/// An input of a node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PortSpec {
    /// MaterialX's name.
    pub name: &'static str,
    /// What it takes.
    pub ty: PortType,
    /// What it holds when nothing is said.
    pub default: Default,
    /// Whether it takes literals only (counts, seeds, enumerations, stops, files).
    pub uniform: bool,
    /// The numbers that it accepts.
    pub range: Range,
    /// The unit: `"dimensionless"`, `"degrees"`, `"radians"`, `"uv"`, `"cycles per uv"`, `"octaves"`…
    pub unit: &'static str,
    /// One sentence.
    pub doc: &'static str,
}

impl PortSpec {
    /// A port that takes a signal of this type; range soft [0, 1], dimensionless.
    pub const fn new(
        name: &'static str,
        ty: PortType,
        default: Default,
        doc: &'static str,
    ) -> Self {
        let uniform = matches!(
            ty,
            PortType::Choice(_)
                | PortType::Stops
                | PortType::Matrix
                | PortType::Exactly(Type::String | Type::Filename)
        );
        Self {
            name,
            ty,
            default,
            uniform,
            range: Range::soft(0.0, 1.0),
            unit: "dimensionless",
            doc,
        }
    }

    /// The same, literal only.
    pub const fn uniform(self) -> Self {
        Self {
            uniform: true,
            ..self
        }
    }

    /// The same with a range.
    pub const fn range(self, range: Range) -> Self {
        Self { range, ..self }
    }

    /// The same with a unit.
    pub const fn unit(self, unit: &'static str) -> Self {
        Self { unit, ..self }
    }
}

/// The type of a node's output `out`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum OutputType {
    /// This type.
    Exactly(Type),
    /// The widest of the [`PortType::Any`] inputs; each component comes from the same components of
    /// the inputs alone.
    Widest,
    /// The widest of the [`PortType::Any`] inputs, whose components act on one another.
    Whole,
    /// The type that the [`PortType::Choice`] input of this name names.
    Named(&'static str),
    /// That of the [`PortType::Color`] input.
    Colored,
    /// The components of the [`PortType::Own`] inputs one after another: a colour where one of
    /// them is, else a vector.
    Joined,
    /// The type of the values of the [`PortType::Stops`] input.
    Stops,
    /// The type that the [`PortType::Choice`] input `named` names where the [`Type::Filename`] input
    /// `file` names one, else that of the values of the [`PortType::Stops`] input.
    Picture {
        /// The file.
        file: &'static str,
        /// The type.
        named: &'static str,
    },
    /// A material: the node ends a graph. Its choice `output` names each of the parts, after one name
    /// that stands for all those of the model that the [`PortType::Choice`] input `model` names.
    Material {
        /// The model.
        model: &'static str,
        /// The parts, in the order of the choice's names after the first.
        parts: &'static [MaterialPart],
    },
}

/// A part of a material: what a host reads under one name.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MaterialPart {
    /// The name, that of the model.
    pub name: &'static str,
    /// Its type.
    pub ty: Type,
    /// The models that have it; none for what only those ask for who shade by moments.
    pub models: &'static [&'static str],
    /// The inputs that it depends on, besides uniform ones: no other is computed for it.
    pub reads: &'static [&'static str],
    /// Whether the mean of its values at points is what is right over a footprint: not of a roughness,
    /// which is wider by the slopes that differ there.
    pub is_mean: bool,
    /// Whether it tells what slopes have in common with other signals, or on what share of the footprint
    /// they are: that is kept where it is asked for.
    pub is_joint: bool,
}

impl MaterialPart {
    /// Whether a material of this model has the part by that name; what only moments are is there in
    /// every one.
    pub fn is_of(&self, model: &str) -> bool {
        self.models.is_empty() || self.models.contains(&model)
    }
}

/// The parts of a node's reference page; Markdown without headings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Doc {
    /// *What it computes*, with the formula.
    pub computes: &'static str,
    /// *Statistics*: mean, covariance, hypotheses; exact or approximate.
    pub statistics: &'static str,
    /// *Accuracy*: the largest error, and what holds it.
    pub accuracy: &'static str,
    /// *References*: paper and equation.
    pub references: &'static str,
}

/// How a node acts on the class of its inputs, for these inputs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Behaviour {
    /// A literal.
    Constant,
    /// The surface's position: within a footprint, exactly Gaussian.
    Position,
    /// A noise of position, Gaussian up to `deviation` = max |CDF − Φ|.
    Gaussian {
        /// Dimensionless.
        deviation: f32,
    },
    /// A noise of position that is not Gaussian: only its mean and covariance are known.
    Random {
        /// max |CDF − Φ|, dimensionless.
        deviation: f32,
    },
    /// A linear combination of its varying inputs.
    Linear,
    /// A product of varying inputs.
    Product,
    /// A non-linear function of its varying inputs.
    Function,
    /// A non-linear function of its varying inputs whose rule is off by a large part of the result
    /// somewhere.
    Rough {
        /// The root mean square over footprints of 0.06 to 1 wavelengths, relative to the
        /// function's range, measured.
        error: f32,
        /// Where and why, as what follows the node's name in a sentence.
        place: &'static str,
    },
    /// A non-linear function of position alone, filtered in closed form.
    Pattern,
    /// A function of its varying inputs whose mean or variance does not exist where `port` reaches
    /// what it may: what filters it is only bounded. A warning, unless the input is constant.
    NoMoments {
        /// The input.
        port: &'static str,
        /// Why, as a sentence of its own.
        reason: &'static str,
    },
    /// No statistics, for this reason.
    Unknown(&'static str),
    /// The uniform ports contradict each other: a mistake at `port`, for this reason.
    Refused {
        /// Where it is reported.
        port: &'static str,
        /// What is wanted.
        reason: &'static str,
    },
}

/// What a class rule sees of a node's inputs.
pub trait InputView {
    /// Whether the input varies over the surface (is connected to a node that does).
    fn varies(&self, port: &str) -> bool;
    /// The truth value of a uniform port.
    fn flag(&self, port: &str) -> bool;
    /// The chosen name of a uniform port.
    fn choice(&self, port: &str) -> &str;
    /// The number of a uniform port.
    fn number(&self, port: &str) -> f32;
    /// Whether the input depends on the surface's position in space, which no footprint in texture
    /// space moves.
    fn in_space(&self, port: &str) -> bool;
    /// The stops of a uniform port, as places and the means of their values' components.
    fn stops(&self, port: &str) -> Vec<[f32; 2]>;
    /// The numbers of a matrix.
    fn matrix(&self, port: &str) -> Vec<f32>;
    /// The picture that a port names, if there is one.
    fn picture(&self, port: &str) -> Option<&Picture>;
    /// Whether two inputs are the output of the same node, so that they move together.
    fn same(&self, first: &str, second: &str) -> bool;
    /// How many components the input has, as the node sees it.
    fn components(&self, port: &str) -> usize;
    /// What values the input can have.
    fn reach(&self, port: &str) -> Reach;
}

/// The node's class rule.
pub type ClassRule = fn(&dyn InputView) -> Behaviour;

/// What values the node's output can have, from those of its inputs; of a noise, those within four
/// standard deviations of its mean.
pub type ReachRule = fn(&dyn InputView) -> Reach;

/// Everything that is known of a node type but its lowering.
#[derive(Clone, Copy, Debug)]
pub struct NodeSpec {
    /// MaterialX's name where it has the node; also the name of the file that defines it.
    pub name: &'static str,
    /// Other camps' names, which diagnostics suggest.
    pub aliases: &'static [&'static str],
    /// What kind of node.
    pub category: Category,
    /// One line for lists.
    pub summary: &'static str,
    /// The reference page.
    pub doc: Doc,
    /// The inputs, in the order of the reference page.
    pub inputs: &'static [PortSpec],
    /// The type of `out`.
    pub output: OutputType,
    /// How it acts on what values signals can have.
    pub reach: ReachRule,
    /// How it acts on classes.
    pub class: ClassRule,
    /// A small JSON graph, with the node named as the type is; compiled by the tests.
    pub example: &'static str,
}

impl NodeSpec {
    /// The position of the input of that name.
    pub fn input(&self, name: &str) -> Option<usize> {
        self.inputs.iter().position(|port| port.name == name)
    }

    /// The outputs beside `out`, and the position of the input that selects among them: a node with
    /// a choice named `output` has each of its names as an output, and `out` is the one that the
    /// input names.
    pub fn selector(&self) -> Option<(usize, &'static [&'static str])> {
        let position = self.input("output")?;
        match self.inputs[position].ty {
            PortType::Choice(names) => Some((position, names)),
            _ => None,
        }
    }

    /// The parts of a material with the name of the input that chooses its model, if that is what the
    /// node gives.
    pub const fn material(&self) -> Option<(&'static str, &'static [MaterialPart])> {
        match self.output {
            OutputType::Material { model, parts } => Some((model, parts)),
            _ => None,
        }
    }
}
