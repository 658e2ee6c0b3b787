//! The CPU batch evaluator: a register machine over batches of lanes.
//!
//! # What it runs
//! The functions of a module become straight code over registers, each of which holds a value of
//! a whole batch of evaluations ("lanes"): a step of the code is one tight loop over the lanes,
//! which the compiler vectorises for each [`Level`]. There are two banks of registers: floats, f32
//! in the semantics and f64 in the oracle, and words for integers and truth values.
//!
//! # What it computes once
//! Constants are preloaded registers. What the entry derives from constants and uniform parameters
//! alone runs once for an evaluation, not once for each batch.
//!
//! # Where it branches
//! At folds alone: a fold takes as many turns as the active lane of the batch that asks for the
//! most, so a fold whose count is 0 in all lanes costs nothing.
//!
//! # Bits
//! The results are the same to the bit at every level, for every number of lanes and every way to
//! cut them into calls: a lane never sees another one, and no product and sum share a rounding.

mod block;
mod code;
mod compile;
mod run;
#[cfg(test)]
mod tests;

pub use block::Level;

use crate::float::Float;
use crate::ir::{FOOTPRINT, Module, Program, Type};
use block::{LANES, Registers, Runner, runner};
use compile::Code;
use run::Run;

/// A pixel's footprint in texture space.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Footprint {
    /// The integer part of the position; any integers.
    pub cell: [i32; 2],
    /// The position from `cell`, usually in [0, 1).
    pub uv: [f32; 2],
    /// The change of the position from a pixel to the next one to the right.
    pub du: [f32; 2],
    /// The change of the position from a pixel to the one below.
    pub dv: [f32; 2],
}

impl Footprint {
    /// A point, which has no footprint.
    pub fn point(at: [f64; 2]) -> Self {
        Self {
            cell: at.map(|x| x.floor() as i32),
            uv: at.map(|x| (x - x.floor()) as f32),
            ..Self::default()
        }
    }
}

/// Where a pixel's centre lies in space, and how that changes from pixel to pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Position {
    /// The integer part; any integers.
    pub cell: [i32; 3],
    /// The position from `cell`, usually in [0, 1).
    pub xyz: [f32; 3],
    /// The change of the position from a pixel to the next one to the right.
    pub dx: [f32; 3],
    /// The change of the position from a pixel to the one below.
    pub dy: [f32; 3],
}

impl Position {
    /// The position of a pixel of a flat texture: (u, v, 0).
    pub fn flat(footprint: &Footprint) -> Self {
        let Footprint { cell, uv, du, dv } = *footprint;
        let raised = |[x, y]: [f32; 2]| [x, y, 0.0];
        Self {
            cell: [cell[0], cell[1], 0],
            xyz: raised(uv),
            dx: raised(du),
            dy: raised(dv),
        }
    }
}

/// The argument of one parameter of the entry.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Input<'a> {
    /// A number for each lane, for a parameter of [`Type::F32`].
    Floats(&'a [f32]),
    /// An integer for each lane, for any other parameter: the bits of a u32, or 0 for false.
    Integers(&'a [i32]),
    /// The number of all lanes, for a parameter of [`Type::F32`].
    Float(f32),
    /// The integer of all lanes, for any other parameter: the bits of a u32, or 0 for false.
    Integer(i32),
}

/// The registers of one thread. Any evaluator of the same bank can use it; it grows and stays.
#[derive(Debug)]
pub struct Scratch<F>(Registers<F>);

impl<F: Float> Scratch<F> {
    /// No registers yet.
    pub fn new() -> Self {
        Self(Registers::new())
    }

    /// How many instructions of a lane it has taken so far: the same number on every machine.
    pub fn work(&self) -> u64 {
        self.0.steps * LANES as u64
    }
}

impl<F: Float> Default for Scratch<F> {
    fn default() -> Self {
        Self::new()
    }
}

/// A module compiled for evaluation in the float bank `F`: f32 is the semantics, f64 the oracle.
///
/// Threads share an evaluator, each with a [`Scratch`] of its own.
#[derive(Debug)]
pub struct Evaluator<F> {
    code: Code<F>,
    is_uniform: Vec<bool>,
    /// How many parameters say where the pixel is, in a program.
    place: usize,
    runner: Runner<F>,
}

impl<F: Float> Evaluator<F> {
    /// Compiles `module`, whose entry's parameters may all vary from lane to lane.
    ///
    /// # Panics
    /// If the module is empty.
    pub fn new(module: &Module) -> Self {
        Self::with_uniform(module, |_| false)
    }

    /// Compiles `program`: what follows the footprint in the entry's parameters is uniform.
    pub fn of_program(program: &Program) -> Self {
        let place = program.interface.place();
        Self {
            place,
            ..Self::with_uniform(&program.module, |parameter| parameter >= place)
        }
    }

    /// Compiles `module`; `is_uniform` says which of the entry's parameters, by position, have one
    /// argument for all lanes. What depends on them alone is then computed once an evaluation.
    ///
    /// # Panics
    /// If the module is empty.
    pub fn with_uniform(module: &Module, is_uniform: impl Fn(usize) -> bool) -> Self {
        Self {
            code: Code::new(
                &module.inlined(size_of::<F>() == size_of::<f32>()),
                &is_uniform,
            ),
            is_uniform: (0..module.entry().params.len()).map(is_uniform).collect(),
            place: FOOTPRINT.len(),
            runner: runner(Level::detect()),
        }
    }

    /// The same evaluator at another level than the machine's highest.
    ///
    /// # Panics
    /// If the level is not available on this machine.
    pub fn at_level(mut self, level: Level) -> Self {
        self.runner = runner(level);
        self
    }

    /// Evaluates the entry for `lanes` lanes; `outputs` becomes one vector a result, each of
    /// `lanes` numbers. Results of other types than real ones become numbers: 1 for true.
    ///
    /// # Panics
    /// If the inputs are not the entry's parameters in number and type, if a uniform parameter has
    /// an argument for each lane, or if there are other than `lanes` of them.
    pub fn evaluate(
        &self,
        scratch: &mut Scratch<F>,
        inputs: &[Input<'_>],
        lanes: usize,
        outputs: &mut Vec<Vec<F>>,
    ) {
        let code = &self.code;
        assert_eq!(inputs.len(), code.parameters.len(), "inputs of the entry");
        outputs.resize_with(code.results.len(), Vec::new);
        for output in outputs.iter_mut() {
            output.clear();
            output.reserve(lanes);
        }
        if lanes == 0 {
            return;
        }
        let registers = &mut scratch.0;
        registers.reserve(code.size[0], code.size[1]);
        for (register, &x) in registers.floats.iter_mut().zip(&code.floats) {
            register.0.fill(x);
        }
        for (register, &x) in registers.words.iter_mut().zip(&code.words) {
            register.0.fill(x);
        }
        for (input, is_uniform) in inputs.iter().zip(&self.is_uniform) {
            let count = match input {
                Input::Floats(all) => Some(all.len()),
                Input::Integers(all) => Some(all.len()),
                Input::Float(_) | Input::Integer(_) => None,
            };
            assert!(
                count.is_none_or(|count| count == lanes && !is_uniform),
                "{count:?} of {lanes}"
            );
        }
        self.load(registers, inputs, 0..lanes.min(LANES), true);
        let mut run = Run {
            code,
            runner: self.runner,
            registers,
        };
        run.nodes(&code.prologue, None);
        let entry = code.functions.last().expect("a module has an entry");
        for start in (0..lanes).step_by(LANES) {
            let batch = start..lanes.min(start + LANES);
            self.load(run.registers, inputs, batch.clone(), false);
            run.nodes(entry, None);
            self.store(run.registers, batch.len(), outputs);
        }
    }

    /// Puts the arguments of the lanes `batch` into the parameters that are uniform, or into those
    /// that are not. The lanes after the last one repeat it, so that they ask for no turns of
    /// their own.
    fn load(
        &self,
        registers: &mut Registers<F>,
        inputs: &[Input<'_>],
        batch: std::ops::Range<usize>,
        uniform: bool,
    ) {
        let count = batch.len();
        let parameters = inputs
            .iter()
            .zip(&self.code.parameters)
            .zip(&self.is_uniform);
        for ((input, &(ty, register)), &is_uniform) in parameters {
            if is_uniform != uniform {
                continue;
            }
            let register = register as usize;
            let word = |x: i32| {
                if ty == Type::Bool {
                    u32::from(x != 0)
                } else {
                    x as u32
                }
            };
            match *input {
                Input::Floats(all) if ty == Type::F32 => {
                    let to = &mut registers.floats[register].0;
                    for (to, &x) in to.iter_mut().zip(&all[batch.clone()]) {
                        *to = F::from_f32(x);
                    }
                    let last = to[count - 1];
                    to[count..].fill(last);
                }
                Input::Integers(all) if ty != Type::F32 => {
                    let to = &mut registers.words[register].0;
                    for (to, &x) in to.iter_mut().zip(&all[batch.clone()]) {
                        *to = word(x);
                    }
                    let last = to[count - 1];
                    to[count..].fill(last);
                }
                Input::Float(x) if ty == Type::F32 => {
                    registers.floats[register].0.fill(F::from_f32(x));
                }
                Input::Integer(x) if ty != Type::F32 => registers.words[register].0.fill(word(x)),
                _ => panic!("{input:?} for a parameter of type {}", ty.name()),
            }
        }
    }

    fn store(&self, registers: &Registers<F>, count: usize, outputs: &mut [Vec<F>]) {
        for (output, &(ty, register)) in outputs.iter_mut().zip(&self.code.results) {
            let register = register as usize;
            match ty {
                Type::F32 => output.extend_from_slice(&registers.floats[register].0[..count]),
                Type::I32 => {
                    let words = &registers.words[register].0[..count];
                    output.extend(words.iter().map(|&x| F::from_i32(x as i32)));
                }
                Type::U32 | Type::Bool => {
                    let words = &registers.words[register].0[..count];
                    output.extend(words.iter().map(|&x| F::from_u32(x)));
                }
            }
        }
    }

    /// Evaluates a program compiled by [`Evaluator::of_program`] at `footprints`: the uniform
    /// `parameters`, one number for each scalar that follows the footprint in the entry's
    /// parameters, become integers (rounded towards 0) or truth values (whether not 0) as their
    /// types ask. A program that reads the position in space sees a flat texture:
    /// [`Position::flat`].
    ///
    /// # Panics
    /// If the number of parameters is not the program's.
    pub fn evaluate_footprints(
        &self,
        scratch: &mut Scratch<F>,
        footprints: &[Footprint],
        parameters: &[f32],
        outputs: &mut Vec<Vec<F>>,
    ) {
        let positions: Vec<Position> = if self.reads_position() {
            footprints.iter().map(Position::flat).collect()
        } else {
            Vec::new()
        };
        self.evaluate_surface(scratch, footprints, &positions, parameters, outputs);
    }

    /// Whether the program reads the position in space.
    pub fn reads_position(&self) -> bool {
        self.place > FOOTPRINT.len()
    }

    /// As [`Evaluator::evaluate_footprints`], with the positions in space of the same pixels; a
    /// program that does not read them needs none.
    ///
    /// # Panics
    /// If the number of parameters is not the program's, or if it reads positions and there are
    /// other than one for each footprint.
    pub fn evaluate_surface(
        &self,
        scratch: &mut Scratch<F>,
        footprints: &[Footprint],
        positions: &[Position],
        parameters: &[f32],
        outputs: &mut Vec<Vec<F>>,
    ) {
        let cells = [0, 1].map(|i| footprints.iter().map(|f| f.cell[i]).collect::<Vec<i32>>());
        let floats: [fn(&Footprint) -> f32; 6] = [
            |f| f.uv[0],
            |f| f.uv[1],
            |f| f.du[0],
            |f| f.du[1],
            |f| f.dv[0],
            |f| f.dv[1],
        ];
        let floats = floats.map(|get| footprints.iter().map(get).collect::<Vec<f32>>());
        let positions = if self.reads_position() {
            positions
        } else {
            &[]
        };
        let space_cells =
            [0, 1, 2].map(|i| positions.iter().map(|p| p.cell[i]).collect::<Vec<i32>>());
        let space: Vec<Vec<f32>> = (0..9)
            .map(|i| {
                let get = |p: &Position| [p.xyz, p.dx, p.dy][i / 3][i % 3];
                positions.iter().map(get).collect()
            })
            .collect();
        let place = (space_cells.iter().map(|all| Input::Integers(all)))
            .chain(space.iter().map(|all| Input::Floats(all)))
            .take(self.place - FOOTPRINT.len());
        let uniform = self.code.parameters.iter().skip(self.place).zip(parameters);
        let inputs: Vec<Input<'_>> = (cells.iter().map(|all| Input::Integers(all)))
            .chain(floats.iter().map(|all| Input::Floats(all)))
            .chain(place)
            .chain(uniform.map(|(&(ty, _), &x)| match ty {
                Type::F32 => Input::Float(x),
                Type::I32 => Input::Integer(x as i32),
                Type::U32 => Input::Integer(x as u32 as i32),
                Type::Bool => Input::Integer(i32::from(x != 0.0)),
            }))
            .collect();
        let expected = self.code.parameters.len() - self.place;
        assert_eq!(parameters.len(), expected, "parameters of the program");
        self.evaluate(scratch, &inputs, footprints.len(), outputs);
    }
}

/// The results of `program` at `footprints`, one vector a result: for tests and small work. See
/// [`Evaluator::evaluate_footprints`].
pub fn eval_program<F: Float>(
    program: &Program,
    footprints: &[Footprint],
    parameters: &[f32],
) -> Vec<Vec<F>> {
    let mut outputs = Vec::new();
    let evaluator = Evaluator::of_program(program);
    evaluator.evaluate_footprints(&mut Scratch::new(), footprints, parameters, &mut outputs);
    outputs
}
