//! The class of patterns of position.

use mipless_graph::{Behaviour, InputView};

/// A function of position alone, unless one of these ports varies.
pub(crate) fn pattern_unless(inputs: &dyn InputView, ports: &[&str]) -> Behaviour {
    if ports.iter().any(|port| inputs.varies(port)) {
        Behaviour::Function
    } else {
        Behaviour::Pattern
    }
}
