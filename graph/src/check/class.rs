//! The class of a node's output from how the node behaves and what reaches it.

use super::closure::{
    CLOSED, FUNCTION_DEVIATION, FUSED, PRODUCT_DEVIATION, SUMMED, WARPED, WARPED_DEVIATION,
    together,
};
use super::{Correlation, Signal, Sources};
use crate::{Behaviour, Graph, Node, NodeId, Reach};

/// The statistics class of a signal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Class {
    /// The same everywhere.
    Constant,
    /// Gaussian within a footprint.
    Gaussian {
        /// max |CDF − Φ|, dimensionless. For a sum the largest of its terms' is stated: sums are
        /// closer to a Gaussian than their terms are, but only the total of the terms' is a bound.
        deviation: f32,
    },
    /// A function of Gaussian numbers, whose expectation fusion computes under the Gaussian
    /// assumption; or, with 0 Gaussians, a pattern of position filtered in closed form.
    Function {
        /// How many, at most 2.
        gaussians: u8,
    },
    /// Mean and covariance are matched; the rest is not known.
    Moments {
        /// The estimated max |CDF − Φ|, dimensionless.
        deviation: f32,
    },
    /// No statistics: it is sampled.
    Unknown,
}

impl Class {
    /// A stable name for tools.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Constant => "constant",
            Self::Gaussian { .. } => "gaussian",
            Self::Function { .. } => "function",
            Self::Moments { .. } => "moments-only",
            Self::Unknown => "unknown",
        }
    }
}

/// The Gaussian signals that a signal is a function of, with how many Gaussian numbers each holds;
/// no node stands for the surface itself. `None` at the end of the array.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub(super) struct Entries([Option<Entry>; 2]);

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Entry {
    pub(super) node: Option<NodeId>,
    rank: u8,
    /// A function of position alone has no error of closure but its own.
    position: bool,
}

impl Entries {
    fn one(entry: Entry) -> Self {
        Self([Some(entry), None])
    }

    fn iter(&self) -> impl Iterator<Item = Entry> + '_ {
        self.0.iter().flatten().copied()
    }

    /// How many Gaussian numbers there are.
    fn rank(&self) -> u8 {
        self.iter().map(|entry| entry.rank).sum()
    }

    /// Those of both, if they hold at most two numbers.
    fn with(self, other: Self) -> Option<Self> {
        let mut all = self;
        for entry in other.iter() {
            if all.iter().any(|known| known.node == entry.node) {
                continue;
            }
            *all.0.iter_mut().find(|slot| slot.is_none())? = Some(entry);
        }
        (all.rank() <= 2).then_some(all)
    }
}

/// What reaches a node on an input that varies.
#[derive(Clone, Debug)]
pub(super) struct Incoming {
    port: &'static str,
    node: Option<NodeId>,
    class: Class,
    entries: Entries,
    sources: Sources,
    error: f32,
}

impl Incoming {
    pub(super) fn node(port: &'static str, node: NodeId, signal: &Signal) -> Self {
        Self {
            port,
            node: Some(node),
            class: signal.class,
            entries: signal.entries,
            sources: signal.sources.clone(),
            error: signal.error,
        }
    }

    pub(super) fn surface(port: &'static str) -> Self {
        Self {
            port,
            node: None,
            class: Class::Gaussian { deviation: 0.0 },
            entries: Entries::one(Entry {
                node: None,
                rank: 2,
                position: true,
            }),
            sources: Sources::surface(),
            error: 0.0,
        }
    }

    /// Its own deviation from a Gaussian.
    fn deviation(&self) -> f32 {
        match self.class {
            Class::Constant => 0.0,
            Class::Gaussian { deviation } | Class::Moments { deviation } => deviation,
            Class::Function { .. } | Class::Unknown => FUNCTION_DEVIATION,
        }
    }
}

/// Why a signal has its class; the text is made when somebody asks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Reason {
    NothingVaries,
    Position,
    Noise,
    WarpedNoise(&'static str),
    Random,
    Pattern,
    WarpedPattern(&'static str),
    LinearOfGaussians,
    LinearOfFunction,
    LinearOfFunctions,
    FunctionOfGaussians,
    TooManyGaussians,
    Rough(&'static str),
    NoMoments(&'static str),
    FunctionOfPattern(&'static str),
    MomentsIn(&'static str),
    UnknownIn(&'static str),
    NoStatistics(&'static str),
}

impl Reason {
    /// The sentence.
    pub(super) fn text(self, graph: &Graph, node: &Node, signal: &Signal) -> String {
        let name = &node.name;
        let from = || match signal.decided_by {
            Some(source) => format!("`{}`", graph.node(source).name),
            None => "the position".to_owned(),
        };
        match self {
            Self::NothingVaries => format!("no input of `{name}` varies over the surface"),
            Self::Position => format!("`{name}` is the position, which is Gaussian in a footprint"),
            Self::Noise => match signal.class {
                Class::Gaussian { deviation } => format!(
                    "`{name}` is a noise whose distribution is within {deviation} of a Gaussian's"
                ),
                _ => format!("`{name}` is a noise"),
            },
            Self::WarpedNoise(port) => format!(
                "`{name}` is a noise at a position (`{port}`) that {} displaces at random",
                from()
            ),
            Self::Random => match signal.class {
                Class::Moments { deviation } => format!(
                    "`{name}` is a noise that is not Gaussian (its distribution is {deviation} away): \
                     only its mean and covariance are known"
                ),
                _ => format!("`{name}` is a noise that is not Gaussian"),
            },
            Self::Pattern => format!("`{name}` is a pattern of position, filtered in closed form"),
            Self::WarpedPattern(port) => format!(
                "`{name}` is a pattern at a position (`{port}`) that {} displaces at random",
                from()
            ),
            Self::LinearOfGaussians => {
                format!("`{name}` is a linear combination of Gaussian signals, so it is Gaussian")
            }
            Self::LinearOfFunction => {
                format!("`{name}` is linear in functions of the same Gaussian: fused")
            }
            Self::LinearOfFunctions => format!(
                "`{name}` sums signals that are not all functions of one Gaussian: only mean and \
                 covariance are known"
            ),
            Self::FunctionOfGaussians => match signal.class {
                Class::Function { gaussians: 1 } => {
                    format!("`{name}` is a function of one Gaussian: fused, and filtered once")
                }
                _ => format!("`{name}` is a function of two Gaussians: fused, and filtered once"),
            },
            Self::TooManyGaussians => format!(
                "`{name}` is a non-linear function of more than two Gaussians: closed by its moments"
            ),
            Self::NoMoments(reason) => format!("`{name}` has no moments: {reason}"),
            Self::Rough(place) => format!("`{name}` {place}"),
            Self::FunctionOfPattern(port) => format!(
                "`{port}` of `{name}`, {}, is a pattern, whose values are far from Gaussian: closed \
                 by its moments",
                from()
            ),
            Self::MomentsIn(port) => {
                format!(
                    "of `{port}` of `{name}`, {}, only mean and covariance are known",
                    from()
                )
            }
            Self::UnknownIn(port) => format!("`{port}` of `{name}`, {}, has no statistics", from()),
            Self::NoStatistics(reason) => format!("`{name}` has no statistics: {reason}"),
        }
    }
}

/// The class, the reason, who decided it, the entries and the error.
struct Outcome {
    class: Class,
    reason: Reason,
    decided_by: Option<NodeId>,
    entries: Entries,
    error: f32,
}

impl Outcome {
    fn new(class: Class, reason: Reason) -> Self {
        Self {
            class,
            reason,
            decided_by: None,
            entries: Entries::default(),
            error: 0.0,
        }
    }

    fn by(self, decided_by: Option<NodeId>) -> Self {
        Self { decided_by, ..self }
    }

    fn error(self, error: f32) -> Self {
        Self { error, ..self }
    }
}

/// The statistics of a node's output.
pub(super) fn signal(
    id: NodeId,
    node: &Node,
    behaviour: Behaviour,
    incoming: &[Incoming],
) -> Signal {
    let mut outcome = outcome(id, node, behaviour, incoming);
    let mut correlations = Vec::new();
    for (i, first) in incoming.iter().enumerate() {
        for second in &incoming[i + 1..] {
            if let Some(source) = first.sources.common(&second.sources) {
                correlations.push(Correlation {
                    first: first.port,
                    second: second.port,
                    source,
                });
            }
        }
    }
    let own = match behaviour {
        Behaviour::Constant => None,
        Behaviour::Position => Some(Sources::surface()),
        Behaviour::Gaussian { .. } | Behaviour::Random { .. } | Behaviour::Unknown(_) => {
            Some(Sources::of(id))
        }
        _ => None,
    };
    let noise = matches!(
        behaviour,
        Behaviour::Gaussian { .. } | Behaviour::Random { .. }
    );
    let mut sources = own.unwrap_or_default();
    for input in incoming {
        // A noise is a source of its own: that it is read at the position is understood.
        if !(noise && input.sources.nodes().is_empty()) {
            sources = sources.with(&input.sources);
        }
    }
    if outcome.class == Class::Constant {
        sources = Sources::default();
        outcome.entries = Entries::default();
    }
    let Outcome {
        class,
        reason,
        decided_by,
        entries,
        error,
    } = outcome;
    Signal {
        class,
        sources,
        correlations,
        error,
        reason,
        decided_by,
        entries,
        space: false,
        reach: Reach::ANY,
        follows: false,
    }
}

fn outcome(id: NodeId, node: &Node, behaviour: Behaviour, incoming: &[Incoming]) -> Outcome {
    let unknown = incoming.iter().find(|input| input.class == Class::Unknown);
    let components = u8::try_from(node.ty.components()).unwrap_or(4);
    match behaviour {
        Behaviour::Unknown(reason) | Behaviour::Refused { reason, .. } => {
            Outcome::new(Class::Unknown, Reason::NoStatistics(reason))
        }
        _ if unknown.is_some() => {
            let (port, by) = unknown
                .map(|input| (input.port, input.node))
                .unwrap_or_default();
            Outcome::new(Class::Unknown, Reason::UnknownIn(port)).by(by)
        }
        Behaviour::Constant => Outcome::new(Class::Constant, Reason::NothingVaries),
        Behaviour::Position => gaussian(id, 0.0, components, true, Reason::Position),
        _ if incoming.is_empty() => Outcome::new(Class::Constant, Reason::NothingVaries),
        Behaviour::Gaussian { deviation } => match displaced(incoming) {
            None => gaussian(id, deviation, 1, false, Reason::Noise),
            Some(by) => {
                let deviation = deviation.max(WARPED_DEVIATION);
                Outcome::new(Class::Moments { deviation }, Reason::WarpedNoise(by.port))
                    .by(by.node)
                    .error(together(by.error, WARPED))
            }
        },
        Behaviour::Random { deviation } => {
            let outcome = Outcome::new(Class::Moments { deviation }, Reason::Random);
            match displaced(incoming) {
                None => outcome,
                Some(by) => outcome.by(by.node).error(together(by.error, WARPED)),
            }
        }
        Behaviour::Pattern => match displaced(incoming) {
            None => Outcome::new(Class::Function { gaussians: 0 }, Reason::Pattern),
            Some(by) => {
                let class = Class::Moments {
                    deviation: FUNCTION_DEVIATION,
                };
                let outcome = Outcome::new(class, Reason::WarpedPattern(by.port)).by(by.node);
                outcome.error(together(by.error, CLOSED))
            }
        },
        Behaviour::Linear => linear(id, components, incoming),
        // A product with one varying factor is linear in it.
        Behaviour::Product if incoming.len() == 1 => linear(id, components, incoming),
        Behaviour::Product => function(incoming, PRODUCT_DEVIATION),
        Behaviour::Function => function(incoming, FUNCTION_DEVIATION),
        Behaviour::NoMoments { reason, .. } => {
            let closed = function(incoming, FUNCTION_DEVIATION);
            let class = Class::Moments { deviation: 0.5 };
            // Nothing bounds the error of what has no mean; half of the range is none at all.
            Outcome::new(class, Reason::NoMoments(reason))
                .by(closed.decided_by)
                .error(closed.error.hypot(0.5))
        }
        Behaviour::Rough { error, place } => {
            let deviation = FUNCTION_DEVIATION;
            let closed = function(incoming, deviation);
            Outcome::new(Class::Moments { deviation }, Reason::Rough(place))
                .by(closed.decided_by)
                .error(closed.error.hypot(error))
        }
    }
}

/// The first input that is more than a linear function of the position.
fn displaced(incoming: &[Incoming]) -> Option<&Incoming> {
    incoming.iter().find(|input| {
        !matches!(input.class, Class::Gaussian { .. }) || !input.sources.nodes().is_empty()
    })
}

fn gaussian(id: NodeId, deviation: f32, rank: u8, position: bool, reason: Reason) -> Outcome {
    let mut outcome = Outcome::new(Class::Gaussian { deviation }, reason);
    outcome.entries = Entries::one(Entry {
        node: Some(id),
        rank,
        position,
    });
    outcome
}

/// The entries of all inputs together, if they hold at most two Gaussian numbers.
fn together_entries(incoming: &[Incoming]) -> Option<Entries> {
    incoming
        .iter()
        .try_fold(Entries::default(), |all, input| all.with(input.entries))
}

fn is_pattern(input: &Incoming) -> bool {
    input.class == Class::Function { gaussians: 0 }
}

/// The input that is worst closed, for the chain of reasons.
fn worst(incoming: &[Incoming]) -> Option<&Incoming> {
    incoming.iter().max_by(|a, b| a.error.total_cmp(&b.error))
}

fn largest(incoming: &[Incoming], of: impl Fn(&Incoming) -> f32) -> f32 {
    incoming.iter().map(of).fold(0.0, f32::max)
}

fn linear(id: NodeId, components: u8, incoming: &[Incoming]) -> Outcome {
    let error = largest(incoming, |input| input.error);
    let by = worst(incoming).and_then(|input| input.node);
    if let Some(input) = incoming
        .iter()
        .find(|input| matches!(input.class, Class::Moments { .. }))
    {
        let deviation = largest(incoming, Incoming::deviation);
        let reason = Reason::MomentsIn(input.port);
        return Outcome::new(Class::Moments { deviation }, reason)
            .by(input.node)
            .error(error);
    }
    if incoming
        .iter()
        .all(|input| matches!(input.class, Class::Gaussian { .. }))
    {
        let deviation = largest(incoming, Incoming::deviation);
        let numbers: u8 = incoming
            .iter()
            .map(|input| input.entries.rank())
            .fold(0, u8::saturating_add)
            .min(components);
        let position = incoming
            .iter()
            .all(|input| input.sources.nodes().is_empty());
        let mut outcome =
            gaussian(id, deviation, numbers, position, Reason::LinearOfGaussians).by(by);
        // An affine function of one Gaussian is the same Gaussian to what follows.
        if let [input] = incoming
            && input.entries.rank() <= numbers
        {
            outcome.entries = input.entries;
        }
        return outcome;
    }
    if let [input] = incoming {
        // An affine function changes nothing.
        let mut outcome = Outcome::new(input.class, Reason::LinearOfFunction)
            .by(by)
            .error(error);
        outcome.entries = input.entries;
        return outcome;
    }
    match together_entries(incoming) {
        Some(entries) if entries.rank() == 1 && !incoming.iter().any(is_pattern) => {
            let class = Class::Function { gaussians: 1 };
            let mut outcome = Outcome::new(class, Reason::LinearOfFunction)
                .by(by)
                .error(error);
            outcome.entries = entries;
            outcome
        }
        _ => {
            let deviation = largest(incoming, Incoming::deviation);
            // Patterns and positions are exact, and so are their sums.
            let exact = incoming
                .iter()
                .all(|input| is_pattern(input) || matches!(input.class, Class::Gaussian { .. }));
            let error = if exact {
                error
            } else {
                together(error, SUMMED)
            };
            Outcome::new(Class::Moments { deviation }, Reason::LinearOfFunctions)
                .by(by)
                .error(error)
        }
    }
}

fn function(incoming: &[Incoming], deviation: f32) -> Outcome {
    let by = worst(incoming).and_then(|input| input.node);
    let error = largest(incoming, |input| input.error);
    let moments = incoming
        .iter()
        .find(|input| matches!(input.class, Class::Moments { .. }));
    if let Some(input) = moments {
        let deviation = largest(incoming, Incoming::deviation).max(deviation);
        let outcome = Outcome::new(Class::Moments { deviation }, Reason::MomentsIn(input.port));
        return outcome.by(input.node).error(together(error, CLOSED));
    }
    if let Some(input) = incoming.iter().find(|input| is_pattern(input)) {
        let reason = Reason::FunctionOfPattern(input.port);
        let outcome = Outcome::new(Class::Moments { deviation }, reason);
        return outcome.by(input.node).error(together(error, CLOSED));
    }
    match together_entries(incoming) {
        Some(entries) => {
            let gaussians = entries.rank();
            // The position is exactly Gaussian, so a fused function of it has no such error; for
            // the others, a function of a function is fused anew.
            let fused = if entries.iter().all(|entry| entry.position) {
                0.0
            } else {
                FUSED
            };
            let own = incoming
                .iter()
                .filter(|input| matches!(input.class, Class::Gaussian { .. }));
            let own = own.map(Incoming::deviation).fold(0.0, f32::max);
            let mut outcome =
                Outcome::new(Class::Function { gaussians }, Reason::FunctionOfGaussians)
                    .by(by)
                    .error(error.max(together(fused, own)));
            outcome.entries = entries;
            outcome
        }
        None => Outcome::new(Class::Moments { deviation }, Reason::TooManyGaussians)
            .by(by)
            .error(together(error, CLOSED)),
    }
}
