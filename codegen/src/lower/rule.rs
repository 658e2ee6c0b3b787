//! Rules of nodes: what a node makes of signals, as a call of a function that all functions share.

use super::{Arguments, Lower};
use crate::ir::{Float, Module, Scalar};
use crate::moments::{Algebra, PARTS, Signal};
use smallvec::SmallVec;

/// A rule's name and what it depends on beside the mode, the signals and the numbers.
#[derive(Clone, Copy, Debug)]
pub struct NodeRule<'a> {
    /// A readable name (an identifier in lower snake case), unique among rules.
    pub name: &'static str,
    /// One sentence that says what it computes.
    pub doc: &'static str,
    /// All that tells its functions apart, whatever it means.
    pub literals: &'a [u32],
}

/// The names of a signal's parts as parameters: cell, mean, g, H, private variance.
pub type PartNames = [&'static str; 8];

impl<'b> Lower<'_, 'b> {
    /// What `build` makes of signals and numbers, as a call of a function that all functions of the
    /// module share. `build` must depend on nothing but the mode, its arguments and the rule's
    /// literals; it must not read tables, and what it gives carries no symbol and no cell. Its
    /// private variance is fresh: a symbol where the node is read by several.
    ///
    /// Signals that carry symbols are known where they are used alone: there it is built in place.
    pub fn rule(
        &mut self,
        of: NodeRule<'_>,
        signals: &[(PartNames, &Signal<'b>)],
        numbers: &[(&'static str, Scalar<'b>)],
        build: impl for<'c> FnOnce(&mut Lower<'_, 'c>, &[Signal<'c>], &[Scalar<'c>]) -> Signal<'c>,
    ) -> Signal<'b> {
        let plain = signals.iter().all(|(_, signal)| signal.shared.is_empty());
        // Slopes are no parts of what a function gives.
        let plain = plain && !self.algebra.derives();
        let mut out = if plain && self.algebra.b.library().is_some() {
            self.called(of, signals, numbers, build)
        } else {
            let signals: Vec<Signal<'b>> = signals.iter().map(|&(_, s)| s.clone()).collect();
            let numbers: Vec<Scalar<'b>> = numbers.iter().map(|&(_, v)| v).collect();
            // Where slopes are carried, both components share what is fresh in them.
            let fresh = self.algebra.derives();
            let shares = std::mem::replace(&mut self.algebra.shares, fresh);
            let out = build(self, &signals, &numbers);
            self.algebra.shares = shares;
            out
        };
        let private = std::mem::replace(&mut out.private, self.algebra.b.float(0.0));
        self.algebra.attach_fresh(&mut out, private);
        out
    }

    fn called(
        &mut self,
        of: NodeRule<'_>,
        signals: &[(PartNames, &Signal<'b>)],
        numbers: &[(&'static str, Scalar<'b>)],
        build: impl for<'c> FnOnce(&mut Lower<'_, 'c>, &[Signal<'c>], &[Scalar<'c>]) -> Signal<'c>,
    ) -> Signal<'b> {
        let (compiler, mode) = (self.compiler, self.algebra.mode);
        let mut cells = 0;
        let mut arguments: SmallVec<[(&'static str, Scalar<'b>); 32]> = SmallVec::new();
        for (place, ([cell, names @ ..], signal)) in signals.iter().enumerate() {
            if let Some(value) = signal.cell {
                cells |= 1 << place;
                arguments.push((cell, value.into()));
            }
            let parts = signal.parts().map(Scalar::from);
            arguments.extend(names.iter().copied().zip(parts));
        }
        arguments.extend_from_slice(numbers);
        let key = (of.name.into(), cells << 3 | mode as u32, of.literals);
        let results = (self.algebra.b).call_rule(key, (of.name, of.doc), &arguments, |b, v| {
            let mut values = v.iter().copied();
            let mut next = || values.next().expect("a value for each argument");
            let signals: Vec<Signal<'_>> = (0..signals.len())
                .map(|place| Signal {
                    cell: (cells >> place & 1 == 1).then(|| next().int()),
                    ..Signal::of_parts([(); PARTS].map(|()| next().float()))
                })
                .collect();
            let numbers: Vec<Scalar<'_>> = values.collect();
            let mut module = Module::default();
            let arguments = Arguments::without_place(b, compiler.graph, Vec::new());
            let algebra = Algebra::new(b, mode);
            let mut lower = Lower::with(compiler, &mut module, algebra, arguments);
            lower.in_rule = true;
            let out = build(&mut lower, &signals, &numbers);
            assert!(
                out.shared.is_empty() && out.cell.is_none(),
                "a plain signal"
            );
            assert!(
                module.functions.is_empty() && module.tables.is_empty(),
                "a rule reads no table"
            );
            let parts = out.parts().map(Scalar::from);
            RESULTS.into_iter().zip(parts).collect()
        });
        let results: Vec<Float<'b>> = results.into_iter().map(Scalar::float).collect();
        Signal::of_parts(results.try_into().expect("a result for each part"))
    }
}

/// The names of the parts of what a rule gives.
const RESULTS: [&str; PARTS] = ["mean", "gx", "gy", "hxx", "hxy", "hyy", "rest"];
