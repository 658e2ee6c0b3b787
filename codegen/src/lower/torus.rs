//! Functions of position that repeat, as maps on the torus: evaluated once over a period, they are
//! filtered exactly for any footprint, whatever nodes they are built of.

use super::bands::Bands;
use super::fusion::region;
use super::period::{Function, Periods, directions, periods, steps};
use super::place::Place;
use super::shape::{baked, shape};
use super::{Arguments, Bundle, Compiler, Lower, Method, value_results};
use crate::ir::{FOOTPRINT, FunctionRef, Module, Vec2};
use crate::moments::{Algebra, Domain, Grid, Map, Mode, Signal, tables};
use mipless_graph::Source;
use std::sync::{Arc, LazyLock};

/// One period, in units of both.
const DOMAIN: Domain = Domain {
    bounds: [[0.0, 1.0]; 2],
    periodic: true,
    detail: 1,
};

/// The most components of a map.
const COMPONENTS: usize = 4;

/// How a node that repeats is read.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Repeated {
    pub(super) periods: Periods,
    /// The bits of the bands of footprints where it is read from a map.
    pub(super) within: u32,
    /// The bands.
    pub(super) bands: Bands,
}

/// The periods of a node that depends on position alone, if it repeats along two directions.
pub(super) fn found(compiler: &Compiler<'_>, index: usize) -> Option<Periods> {
    let region = region(compiler, index, &[]);
    if compiler.graph.nodes[index].ty.components() > COMPONENTS {
        return None;
    }
    let entry = |nodes: &[usize]| {
        Function::new(&alone(compiler, |compiler, module| {
            let b = &compiler.builder("region", "Nodes at a point.");
            let place = Place::declare(b, &FOOTPRINT);
            let arguments = Arguments::of_place(b, compiler.graph, place);
            let algebra = Algebra::new(b, Mode::Point);
            let mut lower = Lower::with(compiler, module, algebra, arguments);
            let bundle = values(&mut lower, &region, nodes);
            value_results(b, &bundle);
            b.finish(module);
        }))
    };
    let directions = directions(&mut entry(&region));
    if directions.is_empty() {
        return None;
    }
    periods(&mut entry(&[index]), &directions, &steps(compiler, &region))
}

/// A module of its own, to be evaluated while compiling.
pub(super) fn alone(
    compiler: &Compiler<'_>,
    build: impl FnOnce(&Compiler<'_>, &mut Module),
) -> Module {
    let of = (compiler.graph, compiler.facts);
    let compiler = Compiler::new(of, compiler.catalogue, compiler.options);
    let mut module = Module::default();
    build(&compiler, &mut module);
    compiler.library.link(&mut module);
    module.pruned()
}

/// Lowers the nodes of a region, inputs first; the components of some of them.
fn values<'b>(lower: &mut Lower<'_, 'b>, region: &[usize], of: &[usize]) -> Bundle<'b> {
    for &node in region {
        let node_of = &lower.compiler.graph.nodes[node];
        let bundle = (lower.compiler.catalogue[node_of.definition].lower)(lower, node_of);
        lower.bundles[node] = Some(bundle);
    }
    let bundles = of.iter().map(|&node| lower.bundles[node].clone());
    bundles.flatten().flatten().collect()
}

impl<'b> Lower<'_, 'b> {
    /// A node that repeats, by a map on the torus, where `auto` is to read it so.
    pub(super) fn repeated(&mut self, index: usize, closed: &[Signal<'b>]) -> Option<Bundle<'b>> {
        let compiler = self.compiler;
        let applies =
            compiler.options.method == Method::Auto && self.algebra.mode.spreads() && !self.in_rule;
        let repeated = compiler.facts.repeated.get(&index).filter(|_| applies)?;
        let periods = repeated.periods;
        let within = Bands::within(repeated.bands.of(&self.arguments), repeated.within);
        if compiler.facts.rehearses && !self.measures {
            let footprint = (within, Bands::shorter(&self.arguments));
            return Some(self.averaged(index, closed, footprint, periods));
        }
        let name = super::identifier(&compiler.graph.nodes[index].name);
        let ranges: Vec<[f32; 2]> = closed.iter().map(|signal| signal.range).collect();
        let map = compiler.mapped(self.module, &format!("torus {index}"), |module| {
            let of = function(compiler, module, index, periods);
            let alone = alone(compiler, |compiler, module| {
                function(compiler, module, index, periods);
            });
            let grid: Grid = Arc::new(LazyLock::new(Box::new(move || {
                super::map::sampled(&alone, DOMAIN)
            })));
            let shape = shape(compiler, &[], &region(compiler, index, &[])).map(|mut shape| {
                let periods = periods.as_flattened().iter().map(|x| x.to_bits());
                shape.push(u32::MAX);
                shape.extend(periods.flat_map(|bits| [bits as u32, (bits >> 32) as u32]));
                shape
            });
            let tables = baked(shape, || tables(&grid, DOMAIN, ranges.len()));
            Map::new(module, &name, of, DOMAIN, ranges, tables)
        });
        let surface = self.surface();
        let place = inverse(periods).map(|[of_u, of_v]| {
            let parts = [(of_u, &surface[0]), (of_v, &surface[1])];
            let mut parts = (parts.into_iter())
                .filter(|(by, _)| *by != 0.0)
                .map(|(by, coordinate)| coordinate * by as f32);
            let first = parts.next().expect("a row of an inverse is not 0");
            parts.fold(first, |sum, part| sum + part)
        });
        let bundle = self.algebra.map([&place[0], &place[1]], &map);
        if within.as_constant() == Some(true) {
            return Some(bundle);
        }
        let both = closed.iter().zip(&bundle);
        Some(
            both.map(|(closed, other)| closed.select(within, other))
                .collect(),
        )
    }
}

/// D⁻¹ of uv = D p, with p in periods.
pub(super) fn inverse([[a, c], [b, d]]: Periods) -> [[f64; 2]; 2] {
    let area = a * d - b * c;
    [[d / area, -b / area], [-c / area, a / area]]
}

/// The node as a function of two numbers, in periods.
pub(super) fn function(
    compiler: &Compiler<'_>,
    module: &mut Module,
    index: usize,
    [first, second]: Periods,
) -> FunctionRef {
    let name = super::identifier(&compiler.graph.nodes[index].name);
    let b = &compiler.builder(format!("{name}_of"), "A function that repeats.");
    let p = Vec2(b.float_params(["x", "y"]));
    let at = [0, 1].map(|axis| {
        let row = [first[axis] as f32, second[axis] as f32].map(|x| b.float(x));
        p.dot(Vec2(row))
    });
    let place = Place::at_point(b, at);
    let arguments = Arguments::of_place(b, compiler.graph, place);
    let mut lower = Lower::with(compiler, module, Algebra::new(b, Mode::Point), arguments);
    let bundle = values(&mut lower, &region(compiler, index, &[]), &[index]);
    value_results(b, &bundle);
    b.finish(module)
}

/// The nodes of which something is worth a map: those that depend on position alone and are read by
/// what does not, or by an output.
pub(super) fn tops(compiler: &Compiler<'_>, of_position: &[bool]) -> Vec<usize> {
    let graph = compiler.graph;
    let mut top = vec![false; graph.nodes.len()];
    for output in &graph.outputs {
        top[output.node.index()] |= of_position[output.node.index()];
    }
    for (index, node) in graph.nodes.iter().enumerate() {
        if of_position[index] || compiler.facts.live[index] == 0 {
            continue;
        }
        for input in &node.inputs {
            if let Source::Node(id) = input.source {
                top[id.index()] |= of_position[id.index()];
            }
        }
    }
    (0..top.len()).filter(|&index| top[index]).collect()
}
