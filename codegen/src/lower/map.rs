//! Functions of two signals by tables.

use super::{Bundle, Compiler, Lower};
use crate::cpu::{Evaluator, Input, Scratch};
use crate::ir::{Builder, Float, FunctionRef, Module};
use crate::moments::{Domain, Grid, Map, SIDE, Signal, tables};
use mipless_graph::Node;
use std::sync::{Arc, LazyLock};

/// Builds the components of a map from two numbers.
type Build =
    dyn for<'b> Fn(&'b Builder, &mut Module, [Float<'b>; 2]) -> Vec<Float<'b>> + Send + Sync;

impl<'b> Lower<'_, 'b> {
    /// A function of two signals, whatever their covariance: `build` gives its components, within
    /// `ranges`, of two numbers; it must build the same function each time. The function is sampled
    /// over `domain` when a table of its moments is first read.
    ///
    /// # Panics
    /// If there are not one to four ranges.
    pub fn map(
        &mut self,
        node: &Node,
        [x, y]: [&Signal<'b>; 2],
        domain: Domain,
        ranges: &[[f32; 2]],
        build: impl for<'c> Fn(&'c Builder, &mut Module, [Float<'c>; 2]) -> Vec<Float<'c>>
        + Send
        + Sync
        + 'static,
    ) -> Bundle<'b> {
        let name = super::identifier(&node.name);
        let map = self.compiler.mapped(self.module, &node.name, |module| {
            let of = function(module, &name, &build);
            let build = Box::new(build);
            let grid: Grid = Arc::new(LazyLock::new(Box::new(move || {
                let mut module = Module::default();
                function(&mut module, "map", &*build);
                sampled(&module, domain)
            })));
            let tables = tables(&grid, domain, ranges.len());
            Map::new(module, &name, of, domain, ranges.to_vec(), tables)
        });
        self.algebra.map([x, y], &map)
    }
}

impl Compiler<'_> {
    /// The map of that key, made once.
    pub(super) fn mapped(
        &self,
        module: &mut Module,
        key: &str,
        make: impl FnOnce(&mut Module) -> Map,
    ) -> Map {
        let known = self.maps.borrow().get(key).cloned();
        known.unwrap_or_else(|| {
            let map = make(module);
            self.maps.borrow_mut().insert(key.to_owned(), map.clone());
            map
        })
    }
}

fn function(module: &mut Module, name: &str, build: &Build) -> FunctionRef {
    let b = &Builder::new(format!("{name}_of"), "A function of two signals.");
    let place = b.float_params(["x", "y"]);
    for (i, value) in build(b, module, place).into_iter().enumerate() {
        b.result(format!("value_{i}"), value);
    }
    b.finish(module)
}

/// The components of the module's entry, a function of two numbers, over a domain: each sample is
/// the average over its places.
pub(super) fn sampled(module: &Module, domain: Domain) -> Vec<Vec<f32>> {
    let evaluator = Evaluator::<f64>::new(module);
    let mut scratch = Scratch::new();
    let detail = domain.detail;
    let mut components: Vec<Vec<f32>> = Vec::new();
    let mut values: Vec<Vec<f64>> = Vec::new();
    for row in 0..SIDE {
        let mut sums: Vec<Vec<f64>> = Vec::new();
        for part in 0..detail {
            let [x, y] = domain.row(row * detail + part);
            let inputs = [Input::Floats(&x), Input::Floats(&y)];
            evaluator.evaluate(&mut scratch, &inputs, x.len(), &mut values);
            sums.resize_with(values.len(), || vec![0.0; SIDE]);
            for (sums, values) in sums.iter_mut().zip(&values) {
                for (sum, values) in sums.iter_mut().zip(values.chunks(detail)) {
                    *sum += values.iter().sum::<f64>();
                }
            }
        }
        components.resize_with(sums.len(), || Vec::with_capacity(SIDE * SIDE));
        let share = 1.0 / (detail * detail) as f64;
        for (component, sums) in components.iter_mut().zip(&sums) {
            component.extend(sums.iter().map(|&sum| (sum * share) as f32));
        }
    }
    components
}
