//! Random programs, for the property tests of the printer and the emitters.

use super::build::Core;
use super::{FOOTPRINT, FunctionRef, Interface, Module, Op, Port, Program, Type, Value};
use proptest::prelude::*;

/// A stream of choices: proptest shrinks it like any list of numbers.
struct Choices(std::vec::IntoIter<u32>);

impl Choices {
    fn next(&mut self, below: usize) -> usize {
        self.0.next().unwrap_or(0) as usize % below
    }

    fn done(&self) -> bool {
        self.0.len() == 0
    }

    fn pick(&mut self, b: &Core, values: &[Value], ty: Type) -> Value {
        let fitting: Vec<Value> = values.iter().copied().filter(|&v| b.ty(v) == ty).collect();
        fitting[self.next(fitting.len())]
    }
}

/// One value of each type, so that every op has operands.
fn constants(b: &mut Core, choices: &mut Choices) -> Vec<Value> {
    let integers = [0, 1, -1, i32::MIN, i32::MAX, 40];
    let reals = [0.0, 1.0, -2.5, 1e-7, f32::MAX, 0.1, -1e-40];
    let naturals = [0, 1, 31, 33, u32::MAX];
    vec![
        b.f32(reals[choices.next(reals.len())]),
        b.constant(Type::I32, integers[choices.next(integers.len())] as u32),
        b.constant(Type::U32, naturals[choices.next(naturals.len())]),
        b.constant(Type::Bool, choices.next(2) as u32),
    ]
}

/// Adds up to so many instructions, fewer if the stream ends.
fn fill(
    b: &mut Core,
    values: &mut Vec<Value>,
    callees: &[(FunctionRef, Vec<Type>)],
    choices: &mut Choices,
    instructions: usize,
) {
    for _ in 0..instructions {
        if choices.done() {
            return;
        }
        match choices.next(12) {
            0 if !callees.is_empty() => {
                let (callee, params) = &callees[choices.next(callees.len())];
                let arguments: Vec<_> = params
                    .iter()
                    .map(|&ty| choices.pick(b, values, ty))
                    .collect();
                values.extend(b.call(callee, &arguments));
            }
            1 if !callees.is_empty() => {
                let (callee, params) = &callees[choices.next(callees.len())];
                if params[0] != Type::U32 || !params[1..].starts_with(&callee.results[..]) {
                    continue;
                }
                let arguments: Vec<_> = params[1..]
                    .iter()
                    .map(|&ty| choices.pick(b, values, ty))
                    .collect();
                let count = match choices.next(3) {
                    0 => {
                        let condition = choices.pick(b, values, Type::Bool);
                        let (one, zero) = (b.constant(Type::U32, 1), b.constant(Type::U32, 0));
                        if choices.next(2) == 0 {
                            b.op(Op::SelectU, &[condition, one, zero])
                        } else {
                            b.op(Op::SelectU, &[condition, zero, one])
                        }
                    }
                    1 => b.constant(Type::U32, choices.next(4) as u32),
                    _ => choices.pick(b, values, Type::U32),
                };
                let (state, captures) = arguments.split_at(callee.results.len());
                values.extend(b.fold(callee, count, state, captures));
            }
            2 => {
                let index = choices.pick(b, values, Type::U32);
                values.push(b.load(0, index));
            }
            3 => {
                let name = ["mean", "t1", "swirl", "float", "gain"][choices.next(5)];
                let value = values[choices.next(values.len())];
                b.name(value, name);
            }
            _ => {
                let op = Op::ALL[choices.next(Op::ALL.len())];
                let operands: Vec<_> = op
                    .info()
                    .operands
                    .iter()
                    .map(|&ty| choices.pick(b, values, ty))
                    .collect();
                values.push(b.op(op, &operands));
            }
        }
    }
}

/// A program with helper functions, folds, a table and one output of three channels.
pub(crate) fn program() -> impl Strategy<Value = Program> {
    proptest::collection::vec(any::<u32>(), 0..900).prop_map(|numbers| {
        let mut choices = Choices(numbers.into_iter());
        let mut module = Module::default();
        module.table("steps", vec![0.25, -1.5, 3.0]);
        let mut callees: Vec<(FunctionRef, Vec<Type>)> = Vec::new();
        for number in 0..choices.next(4) {
            let mut b = Core::new(format!("helper_{number}"), "A helper.");
            let types = [Type::F32, Type::I32, Type::U32, Type::Bool];
            let results: Vec<Type> = (0..1 + choices.next(3))
                .map(|_| types[choices.next(4)])
                .collect();
            let captures: Vec<Type> = (0..choices.next(3))
                .map(|_| types[choices.next(4)])
                .collect();
            let params: Vec<Type> = [&[Type::U32][..], &results, &captures].concat();
            let mut values: Vec<Value> = (params.iter().enumerate())
                .map(|(i, &ty)| b.param(format!("in_{i}"), ty))
                .collect();
            values.extend(constants(&mut b, &mut choices));
            fill(&mut b, &mut values, &callees, &mut choices, 20);
            for (i, &ty) in results.iter().enumerate() {
                let value = choices.pick(&b, &values, ty);
                b.result(format!("out_{i}"), value);
            }
            callees.push((b.finish(&mut module), params));
        }
        let mut b = Core::new("random", "A random texture.");
        let mut values: Vec<Value> = FOOTPRINT
            .iter()
            .map(|&(name, ty)| b.param(name, ty))
            .collect();
        values.extend(constants(&mut b, &mut choices));
        fill(&mut b, &mut values, &callees, &mut choices, 400);
        for channel in ["r", "g", "b"] {
            let value = choices.pick(&b, &values, Type::F32);
            b.result(channel, value);
        }
        b.finish(&mut module);
        let output = Port {
            name: "color".to_owned(),
            ty: mipless_graph::Type::Color3,
            default: Vec::new(),
        };
        let interface = Interface {
            name: "random".to_owned(),
            parameters: Vec::new(),
            outputs: vec![output],
            moments: false,
            position: false,
        };
        Program { module, interface }
    })
}
