//! From the functions of a module to code over registers.
//!
//! Registers are allocated by a scan over each function: a register is free again after its value's
//! last use. A function's registers form its frame. There is no recursion, so a frame has one place
//! in the register file: after the frames of all its callers. A call copies its arguments into the
//! callee's frame, or trades registers where it is the last use of an argument, and takes the
//! results in the same way.

mod scan;

use super::code::{Node, Register};
use crate::float::Float;
use crate::ir::{Function, FunctionId, Inst, Module, Type};
use rustc_hash::FxHashMap;
use scan::Scan;

/// A register before the frames have places.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Place {
    /// The bank: 0 for floats, 1 for words.
    bank: usize,
    frame: Frame,
    index: Register,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Frame {
    /// The constants of the module, which no code writes.
    Constants,
    Function(FunctionId),
}

/// The bank of a type.
fn bank(ty: Type) -> usize {
    usize::from(ty != Type::F32)
}

/// The registers of a function's parameters: the first of its frame.
fn parameter_places(function: &Function, id: FunctionId) -> Vec<Place> {
    let mut next = [0; 2];
    let place = |ty| {
        let index = next[bank(ty)];
        next[bank(ty)] += 1;
        Place {
            bank: bank(ty),
            frame: Frame::Function(id),
            index,
        }
    };
    function.params.iter().map(|p| p.ty).map(place).collect()
}

/// The constants of a module in the order of their registers.
#[derive(Debug, Default)]
struct Constants {
    bits: [Vec<u32>; 2],
    known: [FxHashMap<u32, Register>; 2],
}

impl Constants {
    fn place(&mut self, ty: Type, bits: u32) -> Place {
        let bank = bank(ty);
        let all = &mut self.bits[bank];
        let index = *self.known[bank].entry(bits).or_insert_with(|| {
            all.push(bits);
            Register::try_from(all.len() - 1).expect("fewer than 2³² constants")
        });
        Place {
            bank,
            frame: Frame::Constants,
            index,
        }
    }
}

/// The code of a function before the frames have places.
#[derive(Debug)]
struct Compiled {
    /// What an evaluation runs once; only the entry has such code.
    prologue: Vec<Node<Place>>,
    nodes: Vec<Node<Place>>,
    results: Vec<Place>,
    /// The number of registers of each bank.
    size: [Register; 2],
}

/// The code of a module.
#[derive(Debug)]
pub(super) struct Code<F> {
    /// The code of each function for a batch; the last is the entry's.
    pub(super) functions: Vec<Vec<Node<Register>>>,
    /// What the entry needs once for all batches.
    pub(super) prologue: Vec<Node<Register>>,
    /// The entry's parameters, with their types and registers.
    pub(super) parameters: Vec<(Type, Register)>,
    /// The entry's results, with their types and registers.
    pub(super) results: Vec<(Type, Register)>,
    /// What the first float registers hold.
    pub(super) floats: Vec<F>,
    /// What the first word registers hold.
    pub(super) words: Vec<u32>,
    /// The number of registers of each bank.
    pub(super) size: [usize; 2],
    /// The tables of the module.
    pub(super) tables: Vec<Box<[F]>>,
}

impl<F: Float> Code<F> {
    /// Compiles `module`; `uniform` says of each parameter of the entry whether all lanes of an
    /// evaluation have the same argument.
    pub(super) fn new(module: &Module, uniform: &dyn Fn(usize) -> bool) -> Self {
        let is_body = fold_bodies(module);
        let mut constants = Constants::default();
        let mut compiled: Vec<Compiled> = Vec::new();
        for index in 0..module.functions.len() {
            let id = FunctionId::from_index(index);
            let scan = Scan::new(module, id, &compiled, is_body[index], &mut constants);
            let is_entry = index + 1 == module.functions.len();
            compiled.push(scan.run(&|parameter| is_entry && uniform(parameter)));
        }
        let sizes: Vec<[Register; 2]> = compiled.iter().map(|f| f.size).collect();
        let first = [0, 1].map(|bank| constants.bits[bank].len());
        let (starts, size) = frame_starts(module, &sizes, first);
        let register = |place: Place| -> Register {
            let start = match place.frame {
                Frame::Constants => 0,
                Frame::Function(id) => starts[id.index()][place.bank],
            };
            Register::try_from(start + place.index as usize).expect("fewer than 2³² registers")
        };
        let renamed = |nodes: &[Node<Place>]| nodes.iter().map(|n| n.renamed(&register)).collect();
        let id = FunctionId::from_index(module.functions.len() - 1);
        let entry = module.entry();
        let places = parameter_places(entry, id);
        let own = compiled.last().expect("a module has an entry");
        Self {
            functions: compiled.iter().map(|f| renamed(&f.nodes)).collect(),
            prologue: renamed(&own.prologue),
            parameters: (entry.params.iter().zip(places))
                .map(|(p, at)| (p.ty, register(at)))
                .collect(),
            results: (entry.results.iter().zip(&own.results))
                .map(|(&(_, value), &at)| (entry.ty(value), register(at)))
                .collect(),
            floats: constants.bits[0]
                .iter()
                .map(|&b| F::from_f32(f32::from_bits(b)))
                .collect(),
            words: constants.bits[1].clone(),
            size,
            tables: (module.tables.iter())
                .map(|table| table.data.iter().map(|&x| F::from_f32(x)).collect())
                .collect(),
        }
    }
}

/// Which functions a fold applies.
fn fold_bodies(module: &Module) -> Vec<bool> {
    let mut is_body = vec![false; module.functions.len()];
    for inst in module.functions.iter().flat_map(|f| &f.insts) {
        if let Inst::Fold { function, .. } = inst {
            is_body[function.index()] = true;
        }
    }
    is_body
}

/// Where each frame starts, and where the last one ends.
fn frame_starts(
    module: &Module,
    sizes: &[[Register; 2]],
    first: [usize; 2],
) -> (Vec<[usize; 2]>, [usize; 2]) {
    let mut starts = vec![first; sizes.len()];
    let mut size = first;
    // Callers come after their callees.
    for (index, function) in module.functions.iter().enumerate().rev() {
        let end = [0, 1].map(|bank| starts[index][bank] + sizes[index][bank] as usize);
        size = [0, 1].map(|bank| size[bank].max(end[bank]));
        for inst in &function.insts {
            if let Inst::Call(callee, _)
            | Inst::Fold {
                function: callee, ..
            } = inst
            {
                let start = &mut starts[callee.index()];
                *start = [0, 1].map(|bank| start[bank].max(end[bank]));
            }
        }
    }
    (starts, size)
}
