//! Maxima and minima of two signals (Clark 1961).

use super::{Algebra, Normal, Signal, spread};

impl Algebra {
    /// max(X, Y): with a = (m_X − m_Y)/θ, θ² = Var(X − Y): mean m_Y + θ(aΦ(a) + φ(a)),
    /// coefficients Φ(a)x + Φ(−a)y, distortion θ² d(a). Exact in mean and variance for Gaussians.
    pub fn maximum(&mut self, x: &Signal, y: &Signal) -> Signal {
        let range = [x.range[0].max(y.range[0]), x.range[1].max(y.range[1])];
        if let Some(both) = self.either(x, y) {
            return both;
        }
        let b = &mut self.b;
        let (x, y) = (&x.flat(b), &y.flat(b));
        let difference = x.sub(b, y);
        if !self.mode.spreads() || difference.is_certain(b) {
            let mean = b.max(x.mean, y.mean);
            return if x.is_certain(b) || !self.mode.spreads() {
                Signal::certain(b, mean).with_range(range)
            } else {
                // Equal spreads: whichever mean is larger carries all of it.
                Signal {
                    mean,
                    range,
                    binary: None,
                    hermite: None,
                    ..x.clone()
                }
            };
        }
        self.bent = true;
        let variance = difference.variance(b);
        let (sd, inverse) = spread(b, variance);
        let normal = Normal::at(b, difference.mean, inverse);
        let hinge = normal.hinge(b, difference.mean, sd);
        let (of_x, of_y) = (x.scale(b, normal.below), y.scale(b, normal.above));
        let mut out = of_x.add(b, &of_y);
        out.mean = b.add(y.mean, hinge);
        out.range = range;
        let distortion = normal.hinge_distortion(b);
        let distortion = b.mul(variance, distortion);
        self.attach_fresh(&mut out, distortion);
        out
    }

    /// The maximum of two signals that take the same two values: low + (high − low)(X + Y − XY) of
    /// their shares. Exact where they are independent.
    fn either(&mut self, x: &Signal, y: &Signal) -> Option<Signal> {
        let b = &mut self.b;
        let [low, high] = x.binary?;
        let same = [(low, y.binary?[0]), (high, y.binary?[1])]
            .map(|(p, q)| b.as_constant(p).is_some() && b.as_constant(p) == b.as_constant(q));
        let (from, to) = (b.as_constant(low)?, b.as_constant(high)?);
        if same != [true; 2] || from >= to || !self.mode.spreads() {
            return None;
        }
        let (down, unit) = (b.f32(-from), b.f32(1.0 / (to - from)));
        let [p, q] = [x, y].map(|signal| signal.offset(b, down).scale(b, unit));
        let both = self.product(&p, &q);
        let b = &mut self.b;
        let share = p.add(b, &q).sub(b, &both);
        let (span, from) = (b.f32(to - from), b.f32(from));
        let mut out = share.scale(b, span).offset(b, from);
        out.binary = Some([low, high]);
        out.range = x.range;
        Some(out)
    }

    /// min(X, Y) = −max(−X, −Y).
    pub fn minimum(&mut self, x: &Signal, y: &Signal) -> Signal {
        let (x, y) = (x.negate(&mut self.b), y.negate(&mut self.b));
        let out = self.maximum(&x, &y);
        out.negate(&mut self.b)
    }
}
