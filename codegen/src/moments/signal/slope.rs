//! How a signal changes with u and with v, as two signals that it carries.

use super::Signal;
use std::rc::Rc;

/// The derivatives of a signal by u and by v.
pub type Slope<'b> = Rc<[Signal<'b>; 2]>;

impl<'b> Signal<'b> {
    /// The slopes, where they are known: those of a number are 0.
    pub fn slopes(&self) -> Option<Slope<'b>> {
        match &self.slope {
            Some(slope) => Some(slope.clone()),
            None if self.is_certain() && self.cell.is_none() => {
                let flat = Signal::certain(self.mean.literal(0.0));
                Some(Rc::new([flat.clone(), flat]))
            }
            None => None,
        }
    }

    /// The same signal with these slopes.
    pub fn with_slope(self, slope: Option<Slope<'b>>) -> Self {
        Self { slope, ..self }
    }

    /// Both slopes through a linear map.
    pub(super) fn map_slope(&self, map: impl Fn(&Signal<'b>) -> Signal<'b>) -> Option<Slope<'b>> {
        let [u, v] = &**self.slope.as_ref()?;
        Some(Rc::new([map(u), map(v)]))
    }
}

/// The slopes of a linear combination of two signals, where both are known.
pub(super) fn combined<'b>(
    x: &Signal<'b>,
    y: &Signal<'b>,
    combine: impl Fn(&Signal<'b>, &Signal<'b>) -> Signal<'b>,
) -> Option<Slope<'b>> {
    if x.slope.is_none() && y.slope.is_none() {
        return None;
    }
    let (p, q) = (x.slopes()?, y.slopes()?);
    Some(Rc::new([0, 1].map(|i| combine(&p[i], &q[i]))))
}
