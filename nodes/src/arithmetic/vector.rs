//! Lengths and directions.

use mipless_codegen::Lower;
use mipless_codegen::ir::{Builder, Value};
use mipless_codegen::moments::{Piecewise, Polynomial, RealPower, Signal};

use crate::componentwise::{composed, transfer};

/// √Σ xᵢ²; of one number, |x|.
pub(crate) fn length(lower: &mut Lower<'_>, components: &[Signal]) -> Signal {
    if let [x] = components {
        let absolute = Piecewise::absolute(lower.b());
        return transfer(lower, x, &absolute);
    }
    composed(lower, |lower| {
        let mut sum = Signal::constant(lower.b(), 0.0);
        for x in components {
            let square = transfer(lower, x, &Polynomial { power: 2 });
            sum = sum.add(lower.b(), &square);
        }
        let power = lower.b().f32(0.5);
        transfer(lower, &sum, &RealPower { power })
    })
}

/// x / √Σ xᵢ²; 0 for what is shorter than 1e-6.
pub(crate) fn unit(b: &mut Builder, x: &[Value]) -> Vec<Value> {
    let square = b.dot(x, x);
    let (least, zero, one) = (b.f32(1e-12), b.f32(0.0), b.f32(1.0));
    let long = b.lt(least, square);
    let guarded = b.max(square, least);
    let root = b.sqrt(guarded);
    let inverse = b.div(one, root);
    let inverse = b.select(long, inverse, zero);
    x.iter().map(|&x| b.mul(x, inverse)).collect()
}
