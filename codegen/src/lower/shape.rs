//! What tells regions apart that are measured: those of one shape are measured once in a process.

use super::Compiler;
use crate::ir::{Borrowed, Numbers};
use mipless_graph::{Literal, NodeId, Parameter, Source, Type};
use rustc_hash::FxHashMap;
use std::sync::{LazyLock, Mutex, PoisonError, RwLock};

/// All that a region's function and its entries depend on.
pub(super) type Shape = Vec<u32>;

/// How many shapes of regions of one graph are measured: a graph of 10,000 nodes stays quick.
const MEASURED: usize = 48;

/// The most measurements that a process keeps.
const MOST: usize = 4096;

/// What this process has measured: the same for every graph.
static KNOWN: LazyLock<RwLock<FxHashMap<Shape, usize>>> = LazyLock::new(RwLock::default);

/// The nodes of a region with what they read; entries count by their places. `None` where a file
/// shapes it.
pub(super) fn shape(compiler: &Compiler<'_>, entries: &[NodeId], nodes: &[usize]) -> Option<Shape> {
    let mut words = Vec::with_capacity(96);
    let mut places: FxHashMap<usize, usize> = FxHashMap::default();
    for (place, entry) in entries.iter().enumerate() {
        places.insert(entry.index(), place);
    }
    words.push(nodes.len() as u32);
    for &index in nodes {
        let node = &compiler.graph.nodes[index];
        // Catalogues differ: a definition is its spec, and the code that lowers it, which several
        // nodes of a family may share.
        let code = compiler.catalogue[node.definition].lower as usize as u64;
        let spec = std::ptr::from_ref(node.spec) as usize as u64;
        for word in [code, spec] {
            words.extend([word as u32, (word >> 32) as u32]);
        }
        words.push(node.ty as u32);
        for input in &node.inputs {
            words.push(input.ty as u32);
            match &input.source {
                Source::Node(id) => {
                    let place = places.get(&id.index());
                    words.extend([0, place.map_or(u32::MAX, |&place| place as u32)]);
                }
                Source::Surface => words.push(1),
                Source::Parameter(id) => {
                    words.extend([2, id.index() as u32]);
                    parameter(&compiler.graph.parameters[id.index()], &mut words);
                }
                Source::Literal(Literal::Numbers(ty, numbers)) => {
                    words.extend([3, *ty as u32]);
                    words.extend(numbers.map(f32::to_bits));
                }
                Source::Literal(Literal::Integer(i)) => words.extend([4, *i as u32]),
                Source::Literal(Literal::Boolean(b)) => words.extend([5, u32::from(*b)]),
                Source::Literal(Literal::Text(_)) if input.ty == Type::Filename => return None,
                Source::Literal(Literal::Text(text)) => {
                    words.extend([6, text.len() as u32]);
                    words.extend(text.bytes().map(u32::from));
                }
                Source::Literal(Literal::Matrix(numbers)) => {
                    words.extend([8, numbers.len() as u32]);
                    words.extend(numbers.iter().map(|x| x.to_bits()));
                }
                Source::Literal(Literal::Stops(ramp)) => {
                    words.extend([7, ramp.ty as u32, ramp.stops.len() as u32]);
                    for stop in &ramp.stops {
                        words.push(stop.at.to_bits());
                        words.extend(stop.value.map(f32::to_bits));
                    }
                }
            }
        }
        let place = places.len();
        places.insert(index, place);
    }
    Some(words)
}

/// A parameter's default and the ends of its range and of its slider.
fn parameter(parameter: &Parameter, words: &mut Shape) {
    words.push(parameter.ty as u32);
    words.extend(parameter.value.numbers().into_iter().map(f32::to_bits));
    let bounds = [
        parameter.min,
        parameter.max,
        parameter.soft_min,
        parameter.soft_max,
    ];
    for bound in bounds {
        words.extend([u32::from(bound.is_some()), bound.unwrap_or(0.0).to_bits()]);
    }
}

/// The tables that programs of this process have, by the shapes of what they are of: those of one
/// shape are baked once, as long as one of the programs is there.
static BAKED: LazyLock<Mutex<FxHashMap<Shape, Vec<Borrowed>>>> = LazyLock::new(Mutex::default);

/// The tables of a shape, made where no program has them. What has no shape has tables of its own.
pub(super) fn baked<const N: usize>(
    shape: Option<Shape>,
    make: impl FnOnce() -> [Numbers; N],
) -> [Numbers; N] {
    let Some(shape) = shape else {
        return make();
    };
    let mut known = BAKED.lock().unwrap_or_else(PoisonError::into_inner);
    let there = |tables: &Vec<Borrowed>| tables.iter().map(Borrowed::get).collect();
    let found: Option<Vec<Numbers>> = known.get(&shape).and_then(there);
    if let Some(tables) = found.and_then(|tables| tables.try_into().ok()) {
        return tables;
    }
    let tables = make();
    if known.len() >= MOST {
        known.retain(|_, tables| there(tables).is_some());
    }
    if known.len() < MOST {
        known.insert(shape, tables.iter().map(Numbers::borrowed).collect());
    }
    tables
}

/// What `measure` says of a shape, asked once for each; 0 for all but the first shapes of a graph.
/// What has no shape is measured anew.
pub(super) fn measured(
    compiler: &Compiler<'_>,
    shape: Option<Shape>,
    measure: impl FnOnce() -> usize,
) -> usize {
    let Some(shape) = shape else {
        return measure();
    };
    let known = compiler.gains.borrow().get(&shape).copied();
    if let Some(known) = known {
        return known;
    }
    let within = compiler.gains.borrow().len() < MEASURED;
    let gain = if within {
        // The lock is free again while a shape is measured.
        let ready = KNOWN.read().map_or_else(
            |poisoned| poisoned.into_inner().get(&shape).copied(),
            |known| known.get(&shape).copied(),
        );
        ready.unwrap_or_else(|| {
            let gain = measure();
            let mut known = KNOWN.write().unwrap_or_else(PoisonError::into_inner);
            if known.len() < MOST {
                known.insert(shape.clone(), gain);
            }
            gain
        })
    } else {
        0
    };
    compiler.gains.borrow_mut().insert(shape, gain);
    gain
}
