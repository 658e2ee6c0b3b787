//! Rules of nodes: what a node makes of signals, as a call of a function that all functions share.

use super::{Arguments, Lower};
use crate::ir::{Builder, Module, Value};
use crate::moments::{Algebra, Signal};
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

impl Lower<'_> {
    /// What `build` makes of signals and numbers, as a call of a function that all functions of the
    /// module share. `build` must depend on nothing but the mode, its arguments and the rule's
    /// literals; it must not read tables, and what it gives carries no symbol and no cell. Its
    /// private variance is fresh: a symbol where the node is read by several.
    ///
    /// Signals that carry symbols are known where they are used alone: there it is built in place.
    pub fn rule(
        &mut self,
        of: NodeRule<'_>,
        signals: &[(PartNames, &Signal)],
        numbers: &[(&'static str, Value)],
        build: impl FnOnce(&mut Lower<'_>, &[Signal], &[Value]) -> Signal,
    ) -> Signal {
        let plain = signals.iter().all(|(_, signal)| signal.shared.is_empty());
        let mut out = if plain && self.algebra.b.has_library() {
            self.called(of, signals, numbers, build)
        } else {
            let signals: Vec<Signal> = signals.iter().map(|&(_, s)| s.clone()).collect();
            let numbers: Vec<Value> = numbers.iter().map(|&(_, v)| v).collect();
            let shares = std::mem::replace(&mut self.algebra.shares, false);
            let out = build(self, &signals, &numbers);
            self.algebra.shares = shares;
            out
        };
        let zero = self.algebra.b.f32(0.0);
        let private = std::mem::replace(&mut out.private, zero);
        self.algebra.attach_fresh(&mut out, private);
        out
    }

    fn called(
        &mut self,
        of: NodeRule<'_>,
        signals: &[(PartNames, &Signal)],
        numbers: &[(&'static str, Value)],
        build: impl FnOnce(&mut Lower<'_>, &[Signal], &[Value]) -> Signal,
    ) -> Signal {
        let (compiler, mode) = (self.compiler, self.algebra.mode);
        let mut cells = 0;
        let mut arguments: SmallVec<[(&'static str, Value); 32]> = SmallVec::new();
        for (place, ([cell, names @ ..], signal)) in signals.iter().enumerate() {
            if let Some(value) = signal.cell {
                cells |= 1 << place;
                arguments.push((cell, value));
            }
            let ([gx, gy], [hxx, hxy, hyy]) = (signal.g, signal.h);
            let parts = [signal.mean, gx, gy, hxx, hxy, hyy, signal.private];
            arguments.extend(names.iter().copied().zip(parts));
        }
        arguments.extend_from_slice(numbers);
        let key = (of.name.into(), cells << 3 | mode as u32, of.literals);
        let results = (self.algebra.b).call_rule(key, (of.name, of.doc), &arguments, |b, v| {
            let mut values = v.iter().copied();
            let mut signals = Vec::with_capacity(signals.len());
            for place in 0..signals.capacity() {
                let mut next = || values.next().expect("a value for each argument");
                let cell = (cells >> place & 1 == 1).then(&mut next);
                let mean = next();
                signals.push(Signal {
                    cell,
                    g: [next(), next()],
                    h: [next(), next(), next()],
                    private: next(),
                    ..Signal::certain(b, mean)
                });
            }
            let numbers: Vec<Value> = values.collect();
            let unused = numbers.first().copied().unwrap_or(signals[0].mean);
            let arguments = Arguments {
                footprint: [unused; 8],
                position: None,
                parameters: Vec::new(),
            };
            let mut module = Module::default();
            let taken = std::mem::replace(b, Builder::new("", ""));
            let algebra = Algebra::new(taken, mode);
            let mut lower = Lower::with(compiler, &mut module, algebra, arguments);
            lower.in_rule = true;
            let out = build(&mut lower, &signals, &numbers);
            *b = lower.algebra.b;
            assert!(
                out.shared.is_empty() && out.cell.is_none(),
                "a plain signal"
            );
            assert!(
                module.functions.is_empty() && module.tables.is_empty(),
                "a rule reads no table"
            );
            let ([gx, gy], [hxx, hxy, hyy]) = (out.g, out.h);
            let parts = [out.mean, gx, gy, hxx, hxy, hyy, out.private];
            RESULTS.into_iter().zip(parts).collect()
        });
        let [mean, gx, gy, hxx, hxy, hyy, private] = results[..] else {
            unreachable!("a result for each part")
        };
        let b = &mut self.algebra.b;
        Signal {
            g: [gx, gy],
            h: [hxx, hxy, hyy],
            private,
            ..Signal::certain(b, mean)
        }
    }
}

/// The names of the parts of what a rule gives.
const RESULTS: [&str; 7] = ["mean", "gx", "gy", "hxx", "hxy", "hyy", "rest"];
