//! The ports that noises share, and what they do to the field.

use super::affine::Affine;
use super::field::Field;
use super::kernel::Kernel;
use super::sum::Octaves;
use crate::port;
use mipless_codegen::Lower;
use mipless_codegen::ir::Sym2;
use mipless_codegen::moments::Signal;
use mipless_graph::{Behaviour, Default, InputView, Node, PortSpec, PortType, Range, Reach, Type};

/// Where.
pub(crate) const TEXCOORD: PortSpec = port::surface("Where the noise is evaluated.");

/// How fine.
pub(crate) const FREQUENCY: PortSpec = port::number(
    "frequency",
    1.0,
    "How many lattice cells fit a unit of the texture space.",
)
.range(Range::soft(0.25, 64.0))
.unit("cells per uv");

/// How strong.
pub(crate) const AMPLITUDE: PortSpec =
    port::number("amplitude", 1.0, "Four standard deviations of the noise.")
        .range(Range::soft(0.0, 4.0));

/// Around what.
pub(crate) const PIVOT: PortSpec =
    port::number("pivot", 0.0, "The mean of the noise.").range(Range::soft(-1.0, 1.0));

/// Which.
pub(crate) const SEED: PortSpec =
    port::integer("seed", 0, "Selects one of 2³² independent noises.")
        .uniform()
        .range(Range::hard(i32::MIN as f32, i32::MAX as f32).with_soft(0.0, 100.0));

/// Whether it tiles.
pub(crate) const PERIOD: PortSpec = port::integer(
    "period",
    0,
    "After how many cells of the lattice the noise repeats in both directions; 0 for never.",
)
.uniform()
.range(Range::hard(0.0, 65536.0).with_soft(0.0, 64.0))
.unit("cells");

/// The longest period of an octave, in its cells: lattice points are told apart as reals.
const LONGEST: f64 = 1_048_576.0;

/// The class of a sum of noises of a lattice, where each has the frequency of the one before times
/// the lacunarity: with a period, all of them must repeat after whole cells.
pub(crate) fn tiling(
    inputs: &dyn InputView,
    octaves: f32,
    lacunarity: f32,
    deviation: f32,
) -> Behaviour {
    let period = f64::from(inputs.number("period"));
    let fits = (0..octaves as i32).all(|octave| {
        let cells = period * f64::from(lacunarity).powi(octave);
        cells.fract() == 0.0 && cells <= LONGEST
    });
    if fits {
        return Behaviour::Gaussian { deviation };
    }
    Behaviour::Refused {
        port: "period",
        reason: "in every octave, period × lacunarityᵏ must be a whole number of cells, at most 2²⁰",
    }
}

/// Of what shape.
pub(crate) const KERNEL: PortSpec = port::choice(
    "kernel",
    &["gaussian", "quintic"],
    "gaussian",
    "The kernel at each lattice point: `gaussian` is filtered exactly for any footprint, `quintic` \
     is Perlin's gradient noise.",
);

/// Where in space.
pub(crate) const POSITION: PortSpec = PortSpec::new(
    "position",
    PortType::Exactly(Type::Vector3),
    Default::Surface,
    "Where the noise is evaluated.",
)
.unit("units of space");

/// position · frequency.
pub(crate) fn place<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Vec<Signal<'b>> {
    scaled_by_frequency(lower, node, "position")
}

/// texcoord · frequency.
pub(crate) fn position<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Vec<Signal<'b>> {
    scaled_by_frequency(lower, node, "texcoord")
}

fn scaled_by_frequency<'b>(lower: &mut Lower<'_, 'b>, node: &Node, port: &str) -> Vec<Signal<'b>> {
    let frequency = lower.signal(node, "frequency");
    (lower.bundle(node, port).iter())
        .map(|axis| lower.algebra.product(axis, &frequency))
        .collect()
}

/// No noise leaves this many standard deviations in practice (once in 10⁶ points of a Gaussian).
pub(crate) const EXTENT: f32 = 5.0;

/// What a noise of standard deviation amplitude/4, or `layers` times that at most, is in practice.
pub(crate) fn practical(inputs: &dyn InputView, layers: f32) -> Reach {
    let extent = 0.25 * EXTENT * layers;
    inputs.reach("pivot") + inputs.reach("amplitude") * Reach::of(-extent, extent)
}

/// Σ diminishᵏ over the octaves, the last of which may be a part of one.
pub(crate) fn diminished(inputs: &dyn InputView) -> f32 {
    let [octaves, diminish] = ["octaves", "diminish"].map(|port| inputs.number(port));
    (0..octaves.ceil() as i32).map(|k| diminish.powi(k)).sum()
}

/// A sum of octaves of a lattice at a position as a component of the node's output: pivot + amplitude ·
/// `factor` · X, with |X| at most `extent`.
pub(crate) fn octaves_of<'b>(
    lower: &mut Lower<'_, 'b>,
    node: &Node,
    (kernel, octaves): (Kernel, Octaves),
    (factor, extent): (f32, f32),
    (position, component): (&[Signal<'b>], usize),
) -> Signal<'b> {
    kernel.report(lower, position, octaves);
    if lower.only_measures() {
        return Signal::constant(lower.b(), 0.0);
    }
    let amplitude = amplitude_of(lower, node, component);
    let pivot = lower.signal(node, "pivot");
    if !(amplitude.is_certain() && pivot.is_certain()) {
        let shape = Affine::unit(lower.b());
        let unit = kernel.signal(lower, position, octaves, shape);
        return scaled(lower, node, unit, (factor, extent), component);
    }
    let amplitude = amplitude * factor;
    let extent = match amplitude.mean.as_constant() {
        Some(amplitude) => extent * amplitude.abs(),
        None => f32::INFINITY,
    };
    let range = [-extent + pivot.range[0], extent + pivot.range[1]];
    let shape = Affine {
        amplitude: amplitude.mean,
        pivot: pivot.mean,
    };
    let signal = kernel.signal(lower, position, octaves, shape);
    signal.with_range(range)
}

/// The amplitude of a component: its own where there are several.
fn amplitude_of<'b>(lower: &Lower<'_, 'b>, node: &Node, component: usize) -> Signal<'b> {
    let amplitudes = lower.bundle(node, "amplitude");
    amplitudes[component.min(amplitudes.len() - 1)].clone()
}

/// The field of variance 1, and the covariance of the slopes that the filter removed, as the node's
/// output: pivot + amplitude/4 · X.
pub(crate) fn shaped<'b>(
    lower: &mut Lower<'_, 'b>,
    node: &Node,
    field: &Field<'b>,
    position: &[Signal<'b>],
    rest: impl FnOnce(&mut Lower<'_, 'b>) -> Sym2<'b>,
) -> Vec<Signal<'b>> {
    let unit = field.steep(lower, position, rest);
    vec![scaled(lower, node, unit, (0.25, EXTENT), 0)]
}

/// A noise X of variance 1 as a component of the node's output: pivot + amplitude · `factor` · X, with
/// |X| at most `extent`.
pub(crate) fn scaled<'b>(
    lower: &mut Lower<'_, 'b>,
    node: &Node,
    unit: Signal<'b>,
    (factor, extent): (f32, f32),
    component: usize,
) -> Signal<'b> {
    let amplitude = amplitude_of(lower, node, component);
    let pivot = lower.signal(node, "pivot");
    let unit = unit.with_range([-extent, extent]);
    lower.algebra.product(&unit, &(amplitude * factor)) + pivot
}
