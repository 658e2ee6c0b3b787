//! What nodes ask of pictures and tables: numbers that are computed when they are first read.

use super::{Lower, PixelFilter, identifier};
use crate::ir::{Builder, FunctionRef, Numbers};
use crate::moments::{Branch, Sampled, Samples, Tabulated, pyramids, sample_points};
use mipless_graph::{Node, Picture};
use std::any::Any;
use std::sync::{Arc, LazyLock};

impl Lower<'_, '_> {
    /// The picture that a uniform file name stands for; `None` where the name is empty.
    pub fn picture(&self, node: &Node, port: &str) -> Option<Arc<Picture>> {
        let name = self.choice(node, port);
        let found = self.compiler.graph.images.get(name).cloned();
        assert!(
            name.is_empty() || found.is_some(),
            "the check has found the picture {name}"
        );
        found
    }

    /// What is made once for each key, for all functions of the graph; the key names its type and
    /// whatever it depends on.
    ///
    /// # Panics
    /// If the key stands for something of another type.
    pub fn once<T: Any + Send + Sync>(&self, key: &str, make: impl FnOnce() -> T) -> Arc<T> {
        let known = self.compiler.made.borrow().get(key).cloned();
        let made = known.unwrap_or_else(|| {
            let made: Arc<dyn Any + Send + Sync> = Arc::new(make());
            let shared = Arc::clone(&made);
            self.compiler.made.borrow_mut().insert(key.to_owned(), made);
            shared
        });
        made.downcast()
            .unwrap_or_else(|_| panic!("{key} is of another type"))
    }

    /// The pixel filter, whose standard deviation positions already have.
    pub fn filter(&self) -> PixelFilter {
        self.compiler.options.filter
    }

    /// A table of the module, made once for each key; the key names whatever it depends on. Its name
    /// is `name`, or that with a number where the module has a table of that name.
    pub fn table(&mut self, key: &str, name: &str, numbers: impl FnOnce() -> Numbers) -> u32 {
        if let Some(&table) = self.compiler.tables.borrow().get(key) {
            return table;
        }
        let taken = |name: &str| self.module.tables.iter().any(|table| table.name == name);
        let mut free = identifier(name);
        for number in 2.. {
            if !taken(&free) {
                break;
            }
            free = format!("{}_{number}", identifier(name));
        }
        let table = self.module.push_table(free, numbers());
        self.compiler
            .tables
            .borrow_mut()
            .insert(key.to_owned(), table);
        table
    }

    /// A function of one number as a transfer by tables, made once for each key: values between 2049
    /// points of the domain are interpolated, and beyond it the function is constant. `range` bounds
    /// it. The numbers are computed when they are first read.
    pub fn tabulate(
        &mut self,
        key: &str,
        name: &str,
        (domain, range): ([f32; 2], [f32; 2]),
        function: impl Fn(f64) -> f64 + Send + Sync + 'static,
    ) -> Tabulated {
        if let Some(known) = self.compiler.tabulated.borrow().get(key) {
            return known.clone();
        }
        const INTERVALS: usize = 2048;
        let function = Arc::new(function);
        let [low, high] = domain;
        let at = Arc::clone(&function);
        let values = self.table(key, &format!("{name}_values"), || {
            let step = (f64::from(high) - f64::from(low)) / INTERVALS as f64;
            let value = move |i| at(f64::from(low) + step * f64::from(i)) as f32;
            Numbers::lazy(INTERVALS + 1, move || {
                (0..=INTERVALS as u32).map(&value).collect()
            })
        });
        let b = &Builder::new(format!("{}_of", identifier(name)), "A function by a table.");
        let inside = b.float_param("x").clamp(low, high);
        let place = (inside + -low) * (INTERVALS as f32 / (high - low));
        let left = place.floor().clamp(0.0, (INTERVALS - 1) as f32);
        let index = left.to_int().to_uint();
        let (from, to) = (b.load(values, index), b.load(values, index + 1));
        b.result("value", from + (to - from) * (place - left));
        let of = b.finish(self.module);
        let parts = move |x| vec![function(x)];
        let mut tables = self.tabulate_all(key, name, (domain, &[range]), &of, parts);
        tables.remove(0)
    }

    /// A function of one number, `of`, as transfers by tables, one for each number that it gives,
    /// made once for each key; beyond the domain it is constant, and `ranges` bound its numbers. The
    /// tables are computed from `values` when they are first read.
    pub fn tabulate_all(
        &mut self,
        key: &str,
        name: &str,
        (domain, ranges): ([f32; 2], &[[f32; 2]]),
        of: &FunctionRef,
        values: impl Fn(f64) -> Vec<f64> + Send + Sync + 'static,
    ) -> Vec<Tabulated> {
        let place = |i: usize| {
            if i == 0 {
                key.to_owned()
            } else {
                format!("{key} {i}")
            }
        };
        let known = {
            let tabulated = self.compiler.tabulated.borrow();
            let known = (0..ranges.len()).map(|i| tabulated.get(&place(i)).cloned());
            known.collect::<Option<Vec<_>>>()
        };
        if let Some(known) = known {
            return known;
        }
        let branch = Branch::of_numbers(self.module, &identifier(name), of, 1);
        let count = ranges.len();
        let samples: Samples = Arc::new(LazyLock::new(Box::new(move || {
            let mut sampled = vec![Vec::new(); count];
            for x in sample_points(domain) {
                for (to, value) in sampled.iter_mut().zip(values(x.into())) {
                    to.push(value);
                }
            }
            let sampled = sampled.into_iter();
            sampled.map(|values| Sampled::new(values, false)).collect()
        })));
        let mut tables = Vec::new();
        for (i, &range) in ranges.iter().enumerate() {
            let table = Tabulated::new(
                self.module,
                &identifier(name),
                (of.clone(), branch.clone(), i),
                (domain, false, range),
                pyramids(&samples, i),
            );
            let mut tabulated = self.compiler.tabulated.borrow_mut();
            tabulated.insert(place(i), table.clone());
            tables.push(table);
        }
        tables
    }
}
