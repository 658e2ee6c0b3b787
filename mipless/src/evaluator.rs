//! Evaluation on the CPU with live inputs.

use crate::{Footprint, Parameter, Program, Type};
#[cfg(feature = "render")]
use mipless_codegen::cpu::Position;
use mipless_codegen::cpu::{Evaluator, Scratch};
use mipless_codegen::ir::Interface;
use std::fmt;

/// What one number of a pixel is.
#[derive(Clone, Debug, PartialEq)]
pub struct Channel {
    /// The output.
    pub output: String,
    /// Its type.
    pub ty: Type,
    /// Which of its components, from 0.
    pub component: usize,
    /// Whether it is the variance over the footprint and not the mean.
    pub is_variance: bool,
}

impl fmt::Display for Channel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let letters = match self.ty {
            Type::Color3 | Type::Color4 => "RGBA",
            _ => "XYZW",
        };
        if self.is_variance {
            write!(f, "variance.")?;
        }
        write!(f, "{}", self.output)?;
        match letters.get(self.component..=self.component) {
            Some(letter) if self.ty.components() > 1 => write!(f, ".{letter}"),
            _ => Ok(()),
        }
    }
}

/// An input of an evaluator, looked up once: what a slider holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct InputHandle {
    parameter: usize,
    first: usize,
}

/// A compiled texture that is evaluated on the CPU.
#[derive(Debug)]
pub struct TextureEvaluator {
    channels: Vec<Channel>,
    parameters: Vec<Parameter>,
    numbers: Vec<f32>,
    evaluator: Evaluator<f32>,
    scratch: Scratch<f32>,
}

/// Why an input could not be set.
#[derive(Clone, Debug, PartialEq)]
pub enum SetError {
    /// The graph has no input of this name.
    NoInput(String),
    /// The input has another number of components.
    Components {
        /// The input's.
        expected: usize,
        /// Those given.
        given: usize,
    },
    /// A number is not finite or outside the input's range.
    OutOfRange {
        /// The number.
        number: f32,
        /// The least that the input takes.
        min: f32,
        /// The most that the input takes.
        max: f32,
    },
}

impl fmt::Display for SetError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoInput(name) => write!(f, "the graph has no input `{name}`"),
            Self::Components { expected, given } => {
                write!(f, "the input takes {expected} numbers, not {given}")
            }
            Self::OutOfRange { number, min, max } => {
                write!(f, "{number} lies outside the input's range [{min}, {max}]")
            }
        }
    }
}

impl std::error::Error for SetError {}

/// What the results of a program are, in their order.
fn channels(interface: &Interface) -> Vec<Channel> {
    let variances = [false, true]
        .into_iter()
        .take(1 + usize::from(interface.moments));
    let outputs = variances.flat_map(|is_variance| {
        let outputs = interface.outputs.iter();
        outputs.map(move |output| (output, is_variance))
    });
    outputs
        .flat_map(|(output, is_variance)| {
            (0..output.ty.components()).map(move |component| Channel {
                output: output.name.clone(),
                ty: output.ty,
                component,
                is_variance,
            })
        })
        .collect()
}

impl TextureEvaluator {
    pub(crate) fn new(parameters: Vec<Parameter>, program: &Program) -> Self {
        Self {
            channels: channels(&program.interface),
            numbers: parameters.iter().flat_map(|p| p.value.numbers()).collect(),
            parameters,
            evaluator: Evaluator::of_program(program),
            scratch: Scratch::new(),
        }
    }

    /// What the numbers of a pixel are, in their order.
    pub fn channels(&self) -> &[Channel] {
        &self.channels
    }

    /// The input of that name; nothing if there is none.
    pub fn input(&self, name: &str) -> Option<InputHandle> {
        let mut first = 0;
        for (parameter, of) in self.parameters.iter().enumerate() {
            if of.name == name {
                return Some(InputHandle { parameter, first });
            }
            first += of.ty.components();
        }
        None
    }

    /// Sets an input, one number a component.
    ///
    /// # Errors
    /// If there is no such input, or if it does not take these numbers; nothing is changed then.
    pub fn set(&mut self, name: &str, numbers: &[f32]) -> Result<(), SetError> {
        let handle = self.input(name);
        let handle = handle.ok_or_else(|| SetError::NoInput(name.to_owned()))?;
        self.set_input(handle, numbers)
    }

    /// The same by its handle.
    ///
    /// # Errors
    /// If it does not take these numbers; nothing is changed then.
    ///
    /// # Panics
    /// If the handle is that of another texture's evaluator, which has fewer inputs: a bug of the caller.
    pub fn set_input(&mut self, handle: InputHandle, numbers: &[f32]) -> Result<(), SetError> {
        let InputHandle { parameter, first } = handle;
        let parameter = &self.parameters[parameter];
        let expected = parameter.ty.components();
        if numbers.len() != expected {
            let given = numbers.len();
            return Err(SetError::Components { expected, given });
        }
        let min = parameter.min.unwrap_or(f32::MIN);
        let max = parameter.max.unwrap_or(f32::MAX);
        if let Some(&number) = numbers.iter().find(|&&x| !(min..=max).contains(&x)) {
            return Err(SetError::OutOfRange { number, min, max });
        }
        self.numbers[first..first + expected].copy_from_slice(numbers);
        Ok(())
    }

    /// Sets all inputs, one number a component, in their order: [`Session::numbers`](crate::session::Session::numbers).
    ///
    /// # Errors
    /// If there are not as many; nothing is changed then.
    pub fn set_numbers(&mut self, numbers: &[f32]) -> Result<(), SetError> {
        let (expected, given) = (self.numbers.len(), numbers.len());
        if expected != given {
            return Err(SetError::Components { expected, given });
        }
        self.numbers.copy_from_slice(numbers);
        Ok(())
    }

    /// The outputs over footprints at positions in space, by any thread.
    #[cfg(feature = "render")]
    pub(crate) fn surface(
        &self,
        scratch: &mut Scratch<f32>,
        (footprints, positions): (&[Footprint], &[Position]),
        outputs: &mut Vec<Vec<f32>>,
    ) {
        self.evaluator
            .evaluate_surface(scratch, footprints, positions, &self.numbers, outputs);
    }

    /// The outputs over footprints: one vector for each component of each output, in order (and
    /// then for its variance, where the moments were asked for), of as many numbers as there are
    /// footprints.
    pub fn evaluate(&mut self, footprints: &[Footprint]) -> Vec<Vec<f32>> {
        let mut outputs = Vec::new();
        self.evaluator.evaluate_footprints(
            &mut self.scratch,
            footprints,
            &self.numbers,
            &mut outputs,
        );
        outputs
    }
}
