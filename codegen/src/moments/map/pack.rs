//! All components of a texel in one number.
//!
//! A number of a table is an f32 that must survive every load, so no bits may make it a NaN or a
//! subnormal: 30 bits are used, the sign stays 0 and the exponent lies between 64 and 191 (in its
//! stored form). One component is stored as it is.

use crate::ir::Float;

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
            let words = self.fields().enumerate().map(|(i, (shift, most))| {
                let (low, step) = (f64::from(header[2 * i]), f64::from(header[2 * i + 1]));
                let code = if step > 0.0 {
                    let code = ((components[i][texel] - low) / step).round();
                    code.clamp(0.0, most.into())
                } else {
                    0.0
                };
                (code as u32) << shift
            });
            table.push(f32::from_bits(BASE + words.sum::<u32>()));
        }
        table
    }

    /// Of each component: how far its code is shifted, and the largest code.
    fn fields(&self) -> impl Iterator<Item = (u32, u32)> {
        let bits = self.bits.into_iter().take(self.components);
        bits.scan(0, |end, bits| {
            *end += bits;
            Some((*end - bits, (1u32 << bits) - 1))
        })
    }

    /// The codes of a texel, as the shader reads them.
    pub(super) fn codes(&self, number: f32) -> Vec<f64> {
        if self.components == 1 {
            return vec![f64::from(number)];
        }
        let word = number.to_bits() - BASE;
        let codes = self
            .fields()
            .map(|(shift, most)| f64::from((word >> shift) & most));
        codes.collect()
    }

    /// The same in IR.
    pub(super) fn unpack<'b>(&self, number: Float<'b>) -> Vec<Float<'b>> {
        if self.components == 1 {
            return vec![number];
        }
        let word = number.bits() - BASE;
        let codes = self
            .fields()
            .map(|(shift, most)| ((word >> shift) & most).to_float());
        codes.collect()
    }

    /// Values from (weighted sums of) codes: low + step · code, by the table's header.
    pub(super) fn decode<'b>(
        &self,
        table: u32,
        codes: impl Iterator<Item = Float<'b>>,
    ) -> Vec<Float<'b>> {
        if self.components == 1 {
            return codes.collect();
        }
        let values = (0u32..).zip(codes).map(|(i, code)| {
            let b = code.builder();
            let [low, step] = [2 * i, 2 * i + 1].map(|at| b.load(table, b.uint(at)));
            low + step * code
        });
        values.collect()
    }
}
