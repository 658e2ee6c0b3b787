//! Maxima and minima of two signals (Clark 1961).

use super::{Algebra, Normal, Piecewise, Signal, Slope, spread};

impl<'b> Algebra<'b> {
    /// max(X, Y): with a = (m_X − m_Y)/θ, θ² = Var(X − Y): mean max(m_X, m_Y) + θ(φ(a) − |a|Φ(−|a|)),
    /// so that the larger one keeps its digits far above the other, coefficients Φ(a)x + Φ(−a)y,
    /// distortion θ² d(a). Exact in mean and variance for Gaussians, and one of both where all its values
    /// are the larger ones.
    pub fn maximum(&mut self, x: &Signal<'b>, y: &Signal<'b>) -> Signal<'b> {
        let range = [x.range[0].max(y.range[0]), x.range[1].max(y.range[1])];
        for (above, below) in [(x, y), (y, x)] {
            if above.cell.is_none() && above.range[0] >= below.range[1] {
                return above.clone();
            }
        }
        if let Some(both) = self.either(x, y) {
            return both;
        }
        let (x, y) = (&self.held(x), &self.held(y));
        let difference = x - y;
        if !self.mode.spreads() || difference.is_certain() {
            let mean = x.mean.max(y.mean);
            return if x.is_certain() || !self.mode.spreads() {
                Signal::certain(mean).with_range(range)
            } else {
                // Equal spreads: whichever mean is larger carries all of it.
                Signal {
                    mean,
                    range,
                    binary: None,
                    hermite: None,
                    slope: self.larger(x, y, &difference),
                    ..x.clone()
                }
            };
        }
        self.bent = true;
        let variance = difference.variance();
        let (sd, inverse) = spread(variance);
        let normal = Normal::at(difference.mean, inverse);
        let mut out = x * normal.below + y * normal.above;
        let below = normal.above.min(normal.below);
        let beyond = sd * normal.density - difference.mean.abs() * below;
        out.mean = x.mean.max(y.mean) + beyond.max(0.0);
        out.range = range;
        self.attach_fresh(&mut out, variance * normal.hinge_distortion());
        out.slope = self.larger(x, y, &difference);
        out
    }

    /// The slopes of max(X, Y): those of X where X − Y is positive, else those of Y.
    fn larger(
        &mut self,
        x: &Signal<'b>,
        y: &Signal<'b>,
        difference: &Signal<'b>,
    ) -> Option<Slope<'b>> {
        if !self.derives() {
            return None;
        }
        let (p, q) = (x.slopes()?, y.slopes()?);
        let step = Piecewise::step(self.b.float(0.0));
        let above = self.transfer(&difference.clone().with_slope(None), &step);
        let across = [0, 1].map(|i| &p[i] - &q[i]);
        let one = Signal::constant(self.b, 1.0);
        Some(self.bilinear(&[(&one, &*q), (&above, &across)]))
    }

    /// The maximum of two signals that take the same two values: low + (high − low)(X + Y − XY) of
    /// their shares. Exact where they are independent.
    fn either(&mut self, x: &Signal<'b>, y: &Signal<'b>) -> Option<Signal<'b>> {
        let [low, high] = x.binary?;
        let [from, to] = [low.as_constant()?, high.as_constant()?];
        let same = y.binary?.map(|value| value.as_constant()) == [Some(from), Some(to)];
        if !same || from >= to || !self.mode.spreads() {
            return None;
        }
        let [p, q] = [x, y].map(|signal| signal.offset(-from) * (1.0 / (to - from)));
        let both = self.product(&p, &q);
        let mut out = ((&p + &q - both) * (to - from)).offset(from);
        out.binary = Some([low, high]);
        out.range = x.range;
        Some(out)
    }

    /// min(X, Y) = −max(−X, −Y).
    pub fn minimum(&mut self, x: &Signal<'b>, y: &Signal<'b>) -> Signal<'b> {
        -self.maximum(&-x, &-y)
    }
}
