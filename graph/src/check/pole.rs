//! Where a node divides by what may be 0, or has no moments for another reason.
//!
//! What is the same everywhere and may be 0 is a mistake, as a literal is. Of what varies, a quotient
//! has neither mean nor variance near 0 (Marsaglia 1965, *Ratios of Normal Variables*): that is a
//! warning, at the port, and whatever else would be said of what follows from it is not.

use super::{View, follows};
use crate::{
    Behaviour, Class, Diagnostic, Graph, InputView, Interval, Node, NodeId, Signal, Source,
};

/// A port that divides, whose values hold 0.
pub(super) struct Pole {
    port: &'static str,
    source: NodeId,
    reach: Interval,
    varies: bool,
}

impl Pole {
    /// How the node acts then.
    pub(super) fn behaviour(&self) -> Option<Behaviour> {
        self.varies.then_some(Behaviour::NoMoments {
            port: self.port,
            reason: "it divides, and a quotient has neither mean nor variance where the divisor \
                     reaches 0",
        })
    }
}

/// The first port that divides by a node whose values hold 0. Literals and inputs of the graph have
/// been looked at before.
pub(super) fn divided(view: &View<'_>) -> Option<Pole> {
    let ports = view.node.spec.inputs.iter().zip(&view.node.inputs);
    ports
        .filter(|(port, _)| port.range.nonzero)
        .find_map(|(port, input)| {
            let Source::Node(source) = input.source else {
                return None;
            };
            let components = view
                .reach(port.name)
                .0
                .into_iter()
                .take(input.ty.components());
            let reach = components.into_iter().find(|reach| reach.contains(0.0))?;
            Some(Pole {
                port: port.name,
                source,
                reach,
                varies: view.signals[source.index()].class != Class::Constant,
            })
        })
}

/// What is to be said of a node, which is the last one of the signals.
pub(super) fn diagnostics(
    graph: &Graph,
    signals: &[Signal],
    node: &Node,
    pole: Option<&Pole>,
    behaviour: Behaviour,
) -> Vec<Diagnostic> {
    let known = |port: &str| !follows(signals, node.input(port));
    let at = |diagnostic: Diagnostic, port: &'static str| {
        diagnostic
            .at(format!("{}/inputs/{port}", node.pointer))
            .in_node(&*node.name)
            .in_port(port)
    };
    let mut out = Vec::new();
    if let Some(pole) = pole.filter(|pole| !pole.varies && known(pole.port)) {
        let source = &graph.node(pole.source).name;
        let message = format!(
            "`{}` is `{source}`: 0 is not accepted, for it divides",
            pole.port
        );
        let diagnostic = at(Diagnostic::error("out-of-range", message), pole.port)
            .because(format!("`{source}` is {}, the same everywhere", pole.reach));
        out.push(if pole.reach.low == pole.reach.high {
            diagnostic
        } else {
            diagnostic
                .help("keep it from 0 with `max`, `clamp` or the bounds of the graph’s inputs")
        });
    }
    if let Behaviour::NoMoments { port, reason } = behaviour
        && known(port)
    {
        let message = format!("`{}` (`{}`) has no moments", node.name, node.spec.name);
        let diagnostic = at(Diagnostic::warning("no-moments", message), port).because(reason);
        let diagnostic = match node.input(port).source {
            Source::Node(source) => {
                let components = graph.node(source).ty.components();
                let reach = signals[source.index()].reach.whole(components);
                let name = &graph.node(source).name;
                diagnostic.because(format!("`{name}` is {reach}"))
            }
            _ => diagnostic,
        };
        out.push(
            diagnostic
                .help("what filters it is only bounded: keep the input away with `max` or `clamp`"),
        );
    }
    out
}
