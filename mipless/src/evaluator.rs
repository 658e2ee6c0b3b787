//! Evaluation on the CPU with live inputs.

use crate::{Footprint, Parameter, Program};
use mipless_codegen::cpu::{Evaluator, Scratch};
use std::fmt;

/// A compiled texture that is evaluated on the calling thread.
#[derive(Debug)]
pub struct TextureEvaluator {
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

impl TextureEvaluator {
    pub(crate) fn new(parameters: Vec<Parameter>, program: &Program) -> Self {
        Self {
            numbers: parameters.iter().flat_map(|p| p.value.numbers()).collect(),
            parameters,
            evaluator: Evaluator::of_program(program),
            scratch: Scratch::new(),
        }
    }

    /// Sets an input, one number a component.
    ///
    /// # Errors
    /// If there is no such input, or if it does not take these numbers; nothing is changed then.
    pub fn set(&mut self, name: &str, numbers: &[f32]) -> Result<(), SetError> {
        let mut first = 0;
        for parameter in &self.parameters {
            let expected = parameter.ty.components();
            if parameter.name != name {
                first += expected;
                continue;
            }
            if numbers.len() != expected {
                return Err(SetError::Components {
                    expected,
                    given: numbers.len(),
                });
            }
            let min = parameter.min.unwrap_or(f32::MIN);
            let max = parameter.max.unwrap_or(f32::MAX);
            if let Some(&number) = numbers.iter().find(|&&x| !(min..=max).contains(&x)) {
                return Err(SetError::OutOfRange { number, min, max });
            }
            self.numbers[first..first + expected].copy_from_slice(numbers);
            return Ok(());
        }
        Err(SetError::NoInput(name.to_owned()))
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
