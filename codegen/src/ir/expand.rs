//! The size of a program once its calls are expanded, as compilers of shaders do.

use super::{Inst, Module};

impl Module {
    /// How many instructions the entry has once every call is replaced by the function that it
    /// calls, and every fold by its body once; what a driver's compiler has to read. Constants,
    /// parameters and results are none.
    pub fn expanded_size(&self) -> u64 {
        let mut sizes: Vec<u64> = Vec::with_capacity(self.functions.len());
        for function in &self.functions {
            let mut size = 0_u64;
            for inst in &function.insts {
                let own = match inst {
                    Inst::Const(_) | Inst::Param(_) | Inst::Result(..) => 0,
                    Inst::Op(..) | Inst::Load(..) => 1,
                    Inst::Call(callee, _) => sizes[callee.index()],
                    Inst::Fold { function, .. } => sizes[function.index()],
                };
                size = size.saturating_add(own);
            }
            sizes.push(size);
        }
        sizes.last().copied().unwrap_or(0)
    }
}

#[cfg(test)]
mod tests {
    use crate::ir::{Builder, Module};

    #[test]
    fn a_call_counts_as_what_it_calls() {
        let mut module = Module::default();
        let b = Builder::new("twice", "x + x");
        let x = b.float_param("x");
        b.result("twice", x + x);
        let twice = b.finish(&mut module);
        let b = Builder::new("eight", "8 x");
        let mut value = b.float_param("x");
        for _ in 0..3 {
            value = b.call(&twice, value)[0];
        }
        b.result("eight", value);
        b.finish(&mut module);
        assert_eq!(module.expanded_size(), 3);
    }

    #[test]
    fn many_doublings_do_not_overflow() {
        let mut module = Module::default();
        let b = Builder::new("f0", "x + x");
        let x = b.float_param("x");
        b.result("r", x + x);
        let mut last = b.finish(&mut module);
        for level in 1..=70 {
            let b = Builder::new(format!("f{level}"), "The one before, twice.");
            let once = b.call(&last, b.float_param("x"))[0];
            let twice = b.call(&last, once)[0];
            b.result("r", twice);
            last = b.finish(&mut module);
        }
        assert_eq!(module.expanded_size(), u64::MAX);
    }
}
