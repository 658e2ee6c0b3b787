//! All components of a texel in one number.
//!
//! A number of a table is an f32 that must survive every load, so no bits may make it a NaN or a
//! subnormal: 30 bits are used, the sign stays 0 and the exponent lies between 64 and 191 (in its
//! stored form). One component is stored as it is.

use crate::ir::{Builder, Value};

/// What is added to the packed bits so that the exponent is that of a normal number.
const BASE: u32 = 64 << 23;

/// How many bits each component has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Packing {
    bits: [u32; 4],
    components: usize,
}

impl Packing {
    /// For up to four components.
    pub(super) fn new(components: usize) -> Self {
        let bits = match components {
            1 => [0; 4],
            2 => [15, 15, 0, 0],
            3 => [10, 10, 10, 0],
            4 => [8, 8, 7, 7],
            _ => panic!("a map has one to four components, not {components}"),
        };
        Self { bits, components }
    }

    /// How many components there are.
    pub(super) const fn components(&self) -> usize {
        self.components
    }

    /// How many numbers precede the texels: the value of code 0 and the step, for each component.
    pub(super) const fn header(&self) -> usize {
        2 * self.components
    }

    /// The table of texels, given by component.
    pub(super) fn pack(&self, components: &[Vec<f64>]) -> Vec<f32> {
        let mut table = Vec::with_capacity(self.header() + components[0].len());
        if self.components == 1 {
            table.extend([0.0, 1.0]);
            table.extend(components[0].iter().map(|&x| x as f32));
            return table;
        }
        for (values, &bits) in components.iter().zip(&self.bits) {
            let low = values.iter().copied().fold(f64::INFINITY, f64::min);
            let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            let step = (high - low) / f64::from((1u32 << bits) - 1);
            // A component of one value has codes of 0.
            table.extend([low as f32, step as f32]);
        }
        let header = table.clone();
        for texel in 0..components[0].len() {
            let mut word = 0;
            let mut shift = 0;
            for (i, values) in components.iter().enumerate() {
                let (low, step) = (f64::from(header[2 * i]), f64::from(header[2 * i + 1]));
                let most = (1u32 << self.bits[i]) - 1;
                let code = if step > 0.0 {
                    ((values[texel] - low) / step)
                        .round()
                        .clamp(0.0, most.into())
                } else {
                    0.0
                };
                word |= (code as u32) << shift;
                shift += self.bits[i];
            }
            table.push(f32::from_bits(BASE + word));
        }
        table
    }

    /// The codes of a texel, as the shader reads them.
    pub(super) fn codes(&self, number: f32) -> Vec<f64> {
        if self.components == 1 {
            return vec![f64::from(number)];
        }
        let word = number.to_bits() - BASE;
        let mut shift = 0;
        (self.bits[..self.components].iter())
            .map(|&bits| {
                let code = (word >> shift) & ((1 << bits) - 1);
                shift += bits;
                f64::from(code)
            })
            .collect()
    }

    /// The same in IR.
    pub(super) fn unpack(&self, b: &mut Builder, number: Value) -> Vec<Value> {
        if self.components == 1 {
            return vec![number];
        }
        let bits = b.bits(number);
        let base = b.u32(BASE);
        let word = b.sub_u(bits, base);
        let mut shift = 0;
        (self.bits[..self.components].iter())
            .map(|&width| {
                let by = b.u32(shift);
                let moved = b.shr_u(word, by);
                let mask = b.u32((1 << width) - 1);
                shift += width;
                let code = b.and_u(moved, mask);
                b.float_u(code)
            })
            .collect()
    }

    /// Values from (weighted sums of) codes: low + step · code, by the table's header.
    pub(super) fn decode(&self, b: &mut Builder, table: u32, codes: &[Value]) -> Vec<Value> {
        if self.components == 1 {
            return codes.to_vec();
        }
        (0u32..)
            .zip(codes)
            .map(|(i, &code)| {
                let [low, step] = [2 * i, 2 * i + 1].map(|at| {
                    let at = b.u32(at);
                    b.load(table, at)
                });
                let part = b.mul(step, code);
                b.add(low, part)
            })
            .collect()
    }
}
