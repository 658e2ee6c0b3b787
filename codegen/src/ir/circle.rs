//! Cosine and sine together.

use super::Float;

/// sin(πt)/t on |t| ≤ ½ in powers of t²: the interpolant at Chebyshev's nodes, 1e-8 off.
const SINE: [f32; 5] = [
    std::f32::consts::PI,
    -5.167_71,
    2.550_077_4,
    -0.598_290_4,
    0.077_655_91,
];
/// cos(πt) likewise, 5e-8 off.
const COSINE: [f32; 5] = [
    0.999_999_95,
    -4.934_793,
    4.058_410_6,
    -1.331_873,
    0.219_682_42,
];

impl<'b> Float<'b> {
    /// cos(2πt) and sin(2πt) of turns in [−½, ½], within 1e-6: both from sine and cosine of half of
    /// the angle, which need no quadrants. Two ops of the table would reduce the angle twice.
    #[must_use]
    pub fn circle(self) -> [Self; 2] {
        let square = self.square();
        let [sine, cosine] = [SINE, COSINE].map(|[rest @ .., last]| {
            let polynomial = self.literal(last);
            (rest.iter().rev()).fold(polynomial, |sum, &c| sum * square + c)
        });
        let sine = sine * self;
        let twice = sine + sine;
        [1.0 - twice * sine, twice * cosine]
    }
}

/// Cosine and sine of the multiples 1, 2, … of an angle of which they are given, by Chebyshev's
/// recurrence.
pub fn multiples<const N: usize>([cosine, sine]: [Float<'_>; 2]) -> [[Float<'_>; 2]; N] {
    let twice = cosine + cosine;
    let mut before = [1.0, 0.0].map(|x| cosine.literal(x));
    let mut here = [cosine, sine];
    std::array::from_fn(|_| {
        let next = [0, 1].map(|i| twice * here[i] - before[i]);
        (before, here) = (here, next);
        before
    })
}

#[cfg(test)]
mod tests {
    use crate::cpu::{Evaluator, Input, Scratch};
    use crate::ir::{Builder, Module};

    #[test]
    fn the_circle_is_within_1e_6_and_starts_at_1() {
        let mut module = Module::default();
        let b = Builder::new("f", "A test.");
        let [cosine, sine] = b.float_param("turns").circle();
        b.result("cosine", cosine);
        b.result("sine", sine);
        b.finish(&mut module);
        let turns: Vec<f32> = (-4000..=4000).map(|i| i as f32 / 8000.0).collect();
        let mut found = Vec::new();
        Evaluator::<f32>::new(&module).evaluate(
            &mut Scratch::new(),
            &[Input::Floats(&turns)],
            turns.len(),
            &mut found,
        );
        for (i, &turn) in turns.iter().enumerate() {
            let (sine, cosine) = (std::f64::consts::TAU * f64::from(turn)).sin_cos();
            let off = (f64::from(found[0][i]) - cosine).abs();
            let off = off.max((f64::from(found[1][i]) - sine).abs());
            assert!(off < 1e-6, "{turn}: {off}");
        }
        assert_eq!((found[0][4000], found[1][4000]), (1.0, 0.0));
    }
}
