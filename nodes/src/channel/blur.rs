//! A blurred signal.

use crate::port;
use crate::port::{any, number};
use mipless_codegen::ir::{Float, Sym2, Vec2};
use mipless_codegen::moments::{Mode, Signal};
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{Behaviour, Category, Doc, InputView, Node, NodeSpec, OutputType, Range};

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "blur",
    aliases: &["gaussian_blur", "blur_hq", "soften", "fast_blur"],
    category: Category::Channel,
    summary: "Its input, blurred by a Gaussian.",
    doc: Doc {
        computes: "out = the mean of in under a round Gaussian in uv around the place, of the variance \
            size²/12 along each axis: that of a box of this size. What the input depends on is \
            evaluated once more, over a larger footprint; nothing is sampled.",
        statistics: "A Gaussian footprint convolved with a Gaussian is one: the mean is that of the input \
            over Σ + size²/12 · I, as exact as the input's own filter. Of the blurred signal's variation \
            within the pixel, the part of order n is that of the wide footprint times ρⁿ (Mehler), with \
            ρ = tr Σ/(tr Σ + size²/6): gradient and Hessian are exact for a round footprint, and of the rest at \
            most the share ρ³ is left, or e^{−q(1 − ρ)} of detail of the coarsest source's wavelength λ, \
            q = (2πs/λ)²: the smaller is taken.",
        accuracy: "The mean is as exact as the filter of what is upstream: 2e-3 for patterns, 0.01 for a \
            noise. A noise through a step is blurred as well as `quad` filters it: the means of its \
            blurred values are within 0.055 of their filtered ones (root mean square 0.02). The standard \
            deviation is within 0.11 for noises and up to 0.28 too large for patterns. Held by `nodes/src/pattern/tests/upstream.rs` against dense sums.",
        references: cite!(
            "Heckbert 1989, *Fundamentals of Texture Mapping and Image Warping*, §3.5.8 \
             (Gaussians under convolution). Mehler 1866, *Ueber die Entwicklung einer Function \
             von beliebig vielen Variablen nach Laplaceschen Functionen höherer Ordnung*."; "blur"
        ),
    },
    inputs: &[
        any("in", 0.0, "The signal."),
        number("size", 0.0, "The width of the box that blurs as much.")
            .range(Range::hard(0.0, 1e4).with_soft(0.0, 0.1))
            .unit("uv"),
        port::surface("Where it is: the surface's own coordinates."),
    ],
    output: OutputType::Widest,
    reach: |inputs| inputs.reach("in"),
    class,
    example: example! { "blur", r#"
    "wall": { "type": "brick", "inputs": { "bond": "basket", "columns": 3, "rows": 6 } },
    "blur": { "type": "blur", "inputs": { "in": { "node": "wall" }, "size": 0.06 } }
"# },
};

pub(super) fn class(inputs: &dyn InputView) -> Behaviour {
    if inputs.in_space("in") {
        return Behaviour::Refused {
            port: "in",
            reason: "a blur widens the footprint in uv, which does not move a position in space",
        };
    }
    Behaviour::Function
}

/// A footprint of this variance, in uv², blurs nothing that can be seen.
const LEAST: f32 = 1e-10;

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let variance = variance(lower, node);
    blurred(lower, node, variance)
}

/// The variance of the blur along each axis.
pub(super) fn variance<'b>(lower: &Lower<'_, 'b>, node: &Node) -> Float<'b> {
    lower.number(node, "size").square() * (1.0 / 12.0) + LEAST
}

/// `in` under a round Gaussian of this variance.
pub(super) fn blurred<'b>(
    lower: &mut Lower<'_, 'b>,
    node: &Node,
    variance: Float<'b>,
) -> Bundle<'b> {
    let mode = lower.mode();
    let over = lower.widened(variance);
    let inputs = lower.bundle(node, "in");
    // At a point too: the same closure then gives the same mean at every footprint.
    let blurred = lower.upstream(node, "in", &over, true);
    let own = (lower.b()).sum(over.own.into_iter().flatten().map(|x| x.square()));
    let both = own + variance * 2.0;
    let share = own / both;
    // Of one wavelength, order n has the Poisson weight qⁿe^{−q}/n!, q = (2πs/λ)²: Σ ρⁿ of them is
    // e^{−q(1 − ρ)}.
    let turns = blurred.wavelengths.square() * std::f32::consts::TAU.powi(2);
    let exponent = turns.min(1e30) * (variance * -2.0 / both);
    let kept = (share.square() * share).min(exponent.clamp(-80.0, 0.0).exp());
    // δ′ = L⁻¹A δ.
    let [top, bottom] = over.ratio;
    let columns = [0, 1].map(|k| Vec2([top[k], bottom[k]]));
    (blurred.components.iter().zip(&inputs))
        .map(|(of, input)| {
            let mut signal = Signal::certain(of.mean).with_range(input.range);
            if !mode.spreads() {
                return signal;
            }
            signal.g = Vec2(columns.map(|column| of.g.dot(column)));
            let bent = columns.map(|column| of.h.times(column));
            let h = Sym2([(0, 0), (0, 1), (1, 1)].map(|(i, j)| columns[i].dot(bent[j])));
            let mut rest = of.rest * kept;
            if mode == Mode::Quad {
                signal.h = h;
            } else {
                rest += h.half_contraction(h);
            }
            lower.algebra.bent = true;
            lower.algebra.attach_fresh(&mut signal, rest);
            signal
        })
        .collect()
}
