//! Splitting long functions: statements are grouped into parts, parts into larger parts, until
//! every function is short. naga's WGSL front end takes time quadratic in the statements of one
//! function.
//!
//! A part takes what it reads of the outside as parameters and returns what the outside reads of
//! it. Every pass over a level is linear in the reads of that level.

use crate::ir::Value;

/// The weight from which on statements may make a part of their own, and up to which they do.
const PART: [u32; 2] = [60, 140];
/// The weight up to which a function is not split.
const WHOLE: u32 = 180;

/// One line of a function.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Item {
    /// A statement of the IR function.
    Statement(Value),
    /// A call of the part with this number.
    Part(u32),
}

/// A function made of some lines of another.
#[derive(Debug)]
pub(super) struct Part {
    /// Its lines.
    pub(super) items: Vec<Item>,
    /// The values that it reads and does not define, in the order of their definition.
    pub(super) inputs: Vec<Value>,
    /// The values that it defines and others read, likewise.
    pub(super) outputs: Vec<Value>,
}

/// A split function.
#[derive(Debug)]
pub(super) struct Split {
    /// The parts; each calls only parts before it.
    pub(super) parts: Vec<Part>,
    /// The lines of the function itself.
    pub(super) items: Vec<Item>,
}

/// The lines of one level, with what each reads.
#[derive(Default)]
struct Level {
    items: Vec<Item>,
    /// How much of a function each line takes up.
    weights: Vec<u32>,
    /// All inputs, and where those of each line end.
    inputs: Vec<Value>,
    ends: Vec<usize>,
}

impl Level {
    fn push(&mut self, item: Item, weight: u32) {
        self.items.push(item);
        self.weights.push(weight);
        self.ends.push(self.inputs.len());
    }

    fn weight(&self) -> u32 {
        self.weights.iter().sum()
    }

    fn inputs(&self, line: usize) -> &[Value] {
        let start = if line == 0 { 0 } else { self.ends[line - 1] };
        &self.inputs[start..self.ends[line]]
    }
}

impl Level {
    /// How many values of the level live across the place after each line.
    fn crossing(&self, home: &[u32], results: &[Value]) -> Vec<u32> {
        let count = self.items.len();
        // Each value is there from the line that defines it to the last one that reads it.
        let mut last = vec![0; home.len()];
        for line in 0..count {
            for &v in self.inputs(line) {
                last[v.index()] = line;
            }
        }
        for &v in results {
            last[v.index()] = count;
        }
        let mut changes = vec![0_i32; count + 1];
        for (&line, last) in home.iter().zip(last) {
            if line != OUTSIDE && (line as usize) < last {
                changes[line as usize] += 1;
                changes[last] -= 1;
            }
        }
        let mut alive = 0;
        let sum = |change: i32| {
            alive += change;
            alive as u32
        };
        changes.into_iter().map(sum).collect()
    }

    /// Where the part that begins at a line ends: where the fewest values cross, as late as that.
    fn cut(&self, start: usize, crossing: &[u32]) -> usize {
        let count = self.items.len();
        let mut weight = 0;
        let mut best: Option<usize> = None;
        for end in start + 1..=count {
            weight += self.weights[end - 1];
            if weight > PART[1] {
                break;
            }
            let is_fewer = best.is_none_or(|best| crossing[end - 1] <= crossing[best - 1]);
            if end == count || (weight >= PART[0] && is_fewer) {
                best = Some(end);
            }
        }
        // A part of one line would never get the level shorter.
        best.unwrap_or(start).max(start + 2).min(count)
    }
}

/// No line: the value comes from outside the function.
const OUTSIDE: u32 = u32::MAX;

/// Splits a function of `values` values.
///
/// `statements` are its lines with their weights; `inputs_of` visits what a line reads; `home_of`
/// says which statement defines a value (`None` for parameters); `results` are read at the end.
pub(super) fn split(
    values: usize,
    statements: &[(Value, u32)],
    mut inputs_of: impl FnMut(Value, &mut dyn FnMut(Value)),
    home_of: impl Fn(Value) -> Option<Value>,
    results: &[Value],
) -> Split {
    let total: u32 = statements.iter().map(|&(_, weight)| weight).sum();
    if total <= WHOLE {
        let items = statements
            .iter()
            .map(|&(v, _)| Item::Statement(v))
            .collect();
        return Split {
            parts: Vec::new(),
            items,
        };
    }
    let mut level = Level::default();
    let mut line_of = vec![OUTSIDE; values];
    for (line, &(statement, weight)) in (0u32..).zip(statements) {
        line_of[statement.index()] = line;
        inputs_of(statement, &mut |v| level.inputs.push(v));
        level.push(Item::Statement(statement), weight);
    }
    let home = |v: Value, line_of: &[u32]| home_of(v).map_or(OUTSIDE, |h| line_of[h.index()]);
    let mut home: Vec<u32> = {
        let mut all = vec![OUTSIDE; values];
        for &v in level.inputs.iter().chain(results) {
            all[v.index()] = home(v, &line_of);
        }
        all
    };

    let mut parts: Vec<Part> = Vec::new();
    let mut seen = vec![u32::MAX; values];
    let mut is_output = vec![u32::MAX; values];
    for depth in 0.. {
        let first = parts.len() as u32;
        let mut group_of = Vec::with_capacity(level.items.len());
        let crossing = level.crossing(&home, results);
        let mut start = 0;
        while start < level.items.len() {
            let end = level.cut(start, &crossing);
            let group = parts.len() as u32;
            parts.push(Part {
                items: level.items[start..end].to_vec(),
                inputs: Vec::new(),
                outputs: Vec::new(),
            });
            group_of.resize(end, group);
            start = end;
        }
        let group_home = |v: Value, home: &[u32]| match home[v.index()] {
            OUTSIDE => OUTSIDE,
            line => group_of[line as usize],
        };
        for line in 0..level.items.len() {
            let group = group_of[line];
            for &v in level.inputs(line) {
                let from = group_home(v, &home);
                if from == group || seen[v.index()] == group {
                    continue;
                }
                seen[v.index()] = group;
                parts[group as usize].inputs.push(v);
                if from != OUTSIDE && is_output[v.index()] != depth {
                    is_output[v.index()] = depth;
                    parts[from as usize].outputs.push(v);
                }
            }
        }
        for &v in results {
            let from = group_home(v, &home);
            if from != OUTSIDE && is_output[v.index()] != depth {
                is_output[v.index()] = depth;
                parts[from as usize].outputs.push(v);
            }
        }

        let mut next = Level::default();
        for (line, number) in (0u32..).zip(first..parts.len() as u32) {
            let part = &mut parts[number as usize];
            part.inputs.sort_unstable();
            part.outputs.sort_unstable();
            part.outputs.iter().for_each(|v| home[v.index()] = line);
            next.inputs.extend_from_slice(&part.inputs);
            next.push(Item::Part(number), 1 + part.inputs.len() as u32 / 32);
        }
        let shorter = next.items.len() < level.items.len();
        level = next;
        if level.weight() <= WHOLE || !shorter {
            break;
        }
    }
    Split {
        parts,
        items: level.items,
    }
}
