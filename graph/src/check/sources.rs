//! The sources of a signal, shared between signals so that a chain of 100,000 nodes is linear.

use std::sync::Arc;

use crate::NodeId;

/// How many sources are listed; signals with more are rare, and their lists are nobody's reading.
const LISTED: usize = 16;

/// The sources that a signal depends on.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Sources {
    /// Sorted; at most [`LISTED`].
    nodes: Option<Arc<[NodeId]>>,
    position: bool,
    more: bool,
}

impl Sources {
    /// One node.
    pub(super) fn of(node: NodeId) -> Self {
        Self {
            nodes: Some(Arc::new([node])),
            position: false,
            more: false,
        }
    }

    /// The position.
    pub(super) fn surface() -> Self {
        Self {
            nodes: None,
            position: true,
            more: false,
        }
    }

    /// The nodes, at most 16 of them, in their order.
    pub fn nodes(&self) -> &[NodeId] {
        self.nodes.as_deref().unwrap_or_default()
    }

    /// Whether the signal depends on the position other than through the nodes.
    pub fn position(&self) -> bool {
        self.position
    }

    /// Whether there are more than the listed ones.
    pub fn more(&self) -> bool {
        self.more
    }

    /// The sources of both; shared with one of them where it has them all.
    pub(super) fn with(self, other: &Self) -> Self {
        let position = self.position || other.position;
        let more = self.more || other.more;
        let within = |part: &Self, whole: &Self| {
            part.nodes()
                .iter()
                .all(|node| whole.nodes().binary_search(node).is_ok())
        };
        if within(other, &self) {
            return Self {
                position,
                more,
                ..self
            };
        }
        if within(&self, other) {
            return Self {
                nodes: other.nodes.clone(),
                position,
                more,
            };
        }
        let mut all = [self.nodes(), other.nodes()].concat();
        all.sort_unstable();
        all.dedup();
        let more = more || all.len() > LISTED;
        all.truncate(LISTED);
        Self {
            nodes: Some(all.into()),
            position,
            more,
        }
    }

    /// A source that both list: a node, or `Some(None)` for the position.
    pub(super) fn common(&self, other: &Self) -> Option<Option<NodeId>> {
        let node = self
            .nodes()
            .iter()
            .find(|node| other.nodes().binary_search(node).is_ok());
        match node {
            Some(node) => Some(Some(*node)),
            None => (self.position && other.position).then_some(None),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unions_are_shared_and_capped() {
        let one = Sources::of(NodeId(7));
        let again = one.clone().with(&Sources::of(NodeId(7)));
        assert!(Arc::ptr_eq(
            one.nodes.as_ref().unwrap(),
            again.nodes.as_ref().unwrap()
        ));
        let mut all = one;
        for i in 0..40 {
            all = all.with(&Sources::of(NodeId(i)));
        }
        assert_eq!((all.nodes().len(), all.more()), (LISTED, true));
        assert_eq!(all.common(&Sources::of(NodeId(3))), Some(Some(NodeId(3))));
        assert_eq!(Sources::surface().common(&Sources::surface()), Some(None));
        assert_eq!(all.common(&Sources::surface()), None);
    }
}
