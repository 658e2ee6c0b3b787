//! The blend modes: layers `fg` over `bg`, and the share `mix` of the result.

use crate::componentwise::{composed, exposed, product, quotient, transfer};
use crate::port::{any, number};
use mipless_codegen::ir::Float;
use mipless_codegen::moments::{Piecewise, Polynomial, Signal};
use mipless_codegen::{Bundle, Lower, NodeDef};
use mipless_graph::{
    Behaviour, Category, Doc, InputView, Node, NodeSpec, OutputType, PortSpec, Range, Reach,
};

/// What is blended, over what, and how much of the result is taken.
const LAYERS: &[PortSpec] = &[
    any("fg", 0.0, "The signal that is blended in."),
    any("bg", 0.0, "The signal that is blended over."),
    number("mix", 1.0, "How much of the result is taken; 0 leaves bg.")
        .range(Range::soft(0.0, 1.0)),
];

/// How exact a mode is, in words that several have in common.
macro_rules! accuracy {
    (exact) => {
        "Exact to rounding."
    };
    (function) => {
        "For jointly Gaussian inputs the mean and the standard deviation are those of the function, \
         within 1e-3."
    };
    (within $spread:literal) => {
        concat!(
            "For jointly Gaussian inputs with spreads up to 0.3 the mean is within 1e-3 and the \
             standard deviation within ",
            $spread,
            "."
        )
    };
    (divisor) => {
        "For a divisor at least six standard deviations from 0 the mean is within 1e-3 and the \
         standard deviation within 0.015."
    };
}

/// The nodes, from rows of what they do not share.
macro_rules! modes {
    ($($node:ident {
        aliases: $aliases:expr,
        summary: $summary:literal,
        computes: $computes:literal,
        statistics: $statistics:expr,
        accuracy: ($($accuracy:tt)*),
        references: ($($reference:tt)*),
        class: $class:expr,
        $(example: $before:literal => $layers:literal,)?
        $(divisor: $divisor:expr,)?
        mode: $mode:expr,
    })*) => {$(
        pub(crate) const fn $node() -> NodeDef {
            static SPEC: NodeSpec = NodeSpec {
                name: stringify!($node),
                aliases: $aliases,
                category: Category::Arithmetic,
                summary: $summary,
                doc: Doc {
                    computes: concat!($computes, " The share of it that is taken is mix: out = bg + \
                        mix (… − bg), for each component, without limits."),
                    statistics: concat!($statistics, " A varying mix is a product as in `mix`."),
                    accuracy: concat!(accuracy!($($accuracy)*), " Held by \
                        `nodes/src/tests/combination.rs` against dense numerical integration in f64."),
                    references: cite!($($reference)*),
                },
                inputs: LAYERS,
                output: OutputType::Widest,
                reach: |_| Reach::ANY,
                class: $class,
                example: modes!(@ $node $($before => $layers)?),
            };
            NodeDef::new(&SPEC, |lower, node| blend(lower, node, $mode, modes!(@ divisor $($divisor)?)))
        }
    )*};
    (@ divisor) => { |_| None };
    (@ divisor $divisor:expr) => { $divisor };
    (@ $node:ident) => {
        modes!(@ $node "" => r#""fg": {"node": "bands"}, "bg": {"node": "noise"}, "mix": 0.8"#)
    };
    (@ $node:ident $before:literal => $layers:literal) => {
        example! { stringify!($node), concat!(r#"
    "bands": {"type": "stripes", "inputs": {"frequency": 6}},
    "noise": {"type": "noise2d", "inputs": {"frequency": 5, "pivot": 0.5}},
"#, $before, r#"    ""#, stringify!($node), r#"": {"type": ""#, stringify!($node),
            r#"", "inputs": {"#, $layers, "}}\n") }
    };
}

/// The statistics of a light: with h = max(2y − 1, 0) it is h + x (2y − 2h).
macro_rules! light {
    ($x:literal, $y:literal) => {
        concat!("With h = max(2", $y, " − 1, 0) in closed form, the result is h + ", $x, " (2", $y,
            " − 2h): a hinge, and a product with the covariance that the factors have. Exact in mean \
            for jointly Gaussian signals; the variance of the product takes its factors for Gaussian.")
    };
}

/// The statistics of a mode that divides.
macro_rules! division {
    () => {
        "As `divide`: the product with a reciprocal, whose moments exist only where the divisor stays \
         away from 0: its mean is kept at least four standard deviations from it. Approximate."
    };
}

modes! {
    burn {
        aliases: &["color_burn", "burn_blend"],
        summary: "Darkens a signal by another.",
        computes: "1 − (1 − bg) / fg, without limits as in MaterialX. A divisor nearer to 0 than 1e-6 is \
            moved to ±1e-6; a number nearer than 1e-8 makes all of it 0.",
        statistics: division!(),
        accuracy: (divisor),
        references: (marsaglia, isserlis; "burn"),
        class: divided,
        example: r#"    "high": {"type": "range", "inputs": {"in": {"node": "bands"}, "outlow": 0.5}},
"# => r#""fg": {"node": "high"}, "bg": {"node": "noise"}"#,
        divisor: |fg| Some(fg.flat_mean()),
        mode: |lower, fg, bg| (-quotient(lower, &(-bg).offset(1.0), fg)).offset(1.0),
    }
    darken {
        aliases: &["darken_blend"],
        summary: "The smaller of two signals.",
        computes: "min(fg, bg).",
        statistics: "As `min`: Clark’s moments with the covariance. Exact in mean and variance for \
            jointly Gaussian signals.",
        accuracy: (function),
        references: (clark, blending),
        class: |_| Behaviour::Function,
        mode: |lower, fg, bg| lower.algebra.minimum(fg, bg),
    }
    difference {
        aliases: &["difference_blend", "absolute_difference"],
        summary: "How far two signals are apart.",
        computes: "|bg − fg|.",
        statistics: "The folded normal distribution of bg − fg, with the covariance of the two. Exact \
            for jointly Gaussian signals.",
        accuracy: (function),
        references: (folded, bussgang; "difference"),
        class: |_| Behaviour::Function,
        mode: |lower, fg, bg| {
            let absolute = Piecewise::absolute(lower.b());
            transfer(lower, &(bg - fg), &absolute)
        },
    }
    dodge {
        aliases: &["color_dodge", "dodge_blend"],
        summary: "Brightens a signal by what another lacks of 1.",
        computes: "bg / (1 − fg), without limits as in MaterialX. A divisor nearer to 0 than 1e-6 is \
            moved to ±1e-6; a number nearer than 1e-8 makes all of it 0.",
        statistics: division!(),
        accuracy: (divisor),
        references: (marsaglia, isserlis; "dodge"),
        class: divided,
        example: r#"    "low": {"type": "multiply", "inputs": {"in1": {"node": "bands"}, "in2": 0.4}},
"# => r#""fg": {"node": "low"}, "bg": {"node": "noise"}"#,
        divisor: |fg| Some(1.0 - fg.flat_mean()),
        mode: |lower, fg, bg| quotient(lower, bg, &(-fg).offset(1.0)),
    }
    hardlight {
        aliases: &["hard_light", "hard_light_blend"],
        summary: "`overlay` with its layers exchanged.",
        computes: "2 fg bg where fg < ½, 1 − 2 (1 − fg)(1 − bg) elsewhere.",
        statistics: light!("bg", "fg"),
        accuracy: (within "0.03"),
        references: (isserlis, bussgang, blending),
        class: |_| Behaviour::Function,
        mode: |lower, fg, bg| overlaid(lower, bg, fg),
    }
    lighten {
        aliases: &["lighten_blend"],
        summary: "The larger of two signals.",
        computes: "max(fg, bg).",
        statistics: "As `max`: Clark’s moments with the covariance. Exact in mean and variance for \
            jointly Gaussian signals.",
        accuracy: (function),
        references: (clark, blending),
        class: |_| Behaviour::Function,
        mode: |lower, fg, bg| lower.algebra.maximum(fg, bg),
    }
    linearlight {
        aliases: &["linear_light", "linear_light_blend"],
        summary: "Adds or takes away light by how far a signal is from ½.",
        computes: "bg + 2 fg − 1.",
        statistics: "Linear, exact.",
        accuracy: (exact),
        references: (linear),
        class: linear,
        mode: |_, fg, bg| (fg * 2.0).offset(-1.0) + bg,
    }
    minus {
        aliases: &["subtract_blend"],
        summary: "Takes one signal from another.",
        computes: "bg − fg.",
        statistics: "Linear, exact.",
        accuracy: (exact),
        references: (linear; "minus"),
        class: linear,
        mode: |_, fg, bg| bg - fg,
    }
    overlay {
        aliases: &["overlay_blend"],
        summary: "Darkens what is dark and lightens what is light, by another signal.",
        computes: "2 fg bg where bg < ½, 1 − 2 (1 − fg)(1 − bg) elsewhere.",
        statistics: light!("fg", "bg"),
        accuracy: (within "0.03"),
        references: (isserlis, bussgang, blending; "overlay"),
        class: |_| Behaviour::Function,
        mode: overlaid,
    }
    plus {
        aliases: &["add_blend"],
        summary: "Adds one signal to another.",
        computes: "bg + fg.",
        statistics: "Linear, exact.",
        accuracy: (exact),
        references: (linear; "plus"),
        class: linear,
        mode: |_, fg, bg| fg + bg,
    }
    screen {
        aliases: &["screen_blend"],
        summary: "Multiplies what two signals lack of 1.",
        computes: "1 − (1 − fg)(1 − bg).",
        statistics: "fg + bg − fg · bg: a product of varying signals takes its covariance: exact in mean \
            and variance for jointly Gaussian ones.",
        accuracy: (function),
        references: (isserlis, blending; "screen"),
        class: |_| Behaviour::Product,
        mode: |lower, fg, bg| (fg + bg) - product(lower, fg, bg),
    }
    softlight {
        aliases: &["soft_light", "soft_light_blend"],
        summary: "A gentle `overlay`, without a bend.",
        computes: "bg² + 2 fg bg (1 − bg): the smooth form, whose result lies in [0, 1] with its inputs.",
        statistics: "q = bg² in closed form, then q + 2 fg (bg − q): a product with the covariance that \
            the factors have. Exact in mean for jointly Gaussian signals; the variance of the product \
            takes its factors for Gaussian.",
        accuracy: (within "0.02"),
        references: (isserlis, bussgang),
        class: |_| Behaviour::Function,
        mode: |lower, fg, bg| {
            let square = transfer(lower, bg, &Polynomial { power: 2 });
            product(lower, fg, &(bg - &square)) * 2.0 + square
        },
    }
}

/// A varying divisor bends; a number scales.
fn divided(inputs: &dyn InputView) -> Behaviour {
    match ["fg", "bg", "mix"].map(|port| inputs.varies(port)) {
        [false, _, false] => Behaviour::Linear,
        [true, false, false] => Behaviour::Function,
        _ => Behaviour::Product,
    }
}

/// A varying mix multiplies.
fn linear(inputs: &dyn InputView) -> Behaviour {
    if inputs.varies("mix") {
        Behaviour::Product
    } else {
        Behaviour::Linear
    }
}

/// bg + mix (mode(fg, bg) − bg), for each component; 0 where a divisor that is certain is, as in
/// MaterialX.
fn blend<'b>(
    lower: &mut Lower<'_, 'b>,
    node: &Node,
    mode: impl Fn(&mut Lower<'_, 'b>, &Signal<'b>, &Signal<'b>) -> Signal<'b>,
    divisor: impl Fn(&Signal<'b>) -> Option<Float<'b>>,
) -> Bundle<'b> {
    let [fg, bg] = ["fg", "bg"].map(|port| exposed(lower, node, port));
    let share = lower.signal(node, "mix");
    composed(lower, |lower| {
        (fg.iter().zip(&bg))
            .map(|(fg, bg)| {
                let result = mode(lower, fg, bg);
                let mixed = lower.algebra.mix(bg, &result, &share);
                match divisor(fg).filter(|_| fg.is_certain()) {
                    Some(divisor) => mixed * divisor.abs().lt(1e-8).select(0.0, 1.0),
                    None => mixed,
                }
            })
            .collect()
    })
}

/// 2xy where y < ½, else 1 − 2(1 − x)(1 − y): with h = max(2y − 1, 0) it is h + x(2y − 2h).
fn overlaid<'b>(lower: &mut Lower<'_, 'b>, x: &Signal<'b>, y: &Signal<'b>) -> Signal<'b> {
    let twice = y * 2.0;
    let hinge = Piecewise::hinge(lower.b());
    let hinge = transfer(lower, &twice.offset(-1.0), &hinge);
    product(lower, x, &(twice - &hinge * 2.0)) + hinge
}
