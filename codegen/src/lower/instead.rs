//! What takes the place of closed forms that the audit found to be wrong ([`super::audit`]): maps,
//! points, and the texture's mean, each over what is before it.

use super::{Bundle, Lower};
use crate::moments::Signal;

impl<'b> Lower<'_, 'b> {
    /// What takes the place of a closed form that the audit found to be wrong.
    pub(super) fn instead(&mut self, index: usize, closed: &[Signal<'b>]) -> Option<Bundle<'b>> {
        let mut found = self.repeated(index, closed);
        if let Some(sampling) = self.sampling(index) {
            let closed = found.unwrap_or_else(|| closed.to_vec());
            found = Some(self.sampled(index, &closed, sampling));
        }
        let drawn = self.drawn(index, found.as_deref().unwrap_or(closed));
        drawn.or(found)
    }
}
