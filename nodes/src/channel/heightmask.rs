//! Where a height is above a level.

use crate::componentwise::{difference, transfer};
use crate::port::number;
use mipless_codegen::moments::Piecewise;
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{Behaviour, Category, Doc, Node, NodeSpec, OutputType, Range, Reach, Type};

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "heightmask",
    aliases: &[
        "mask_by_height",
        "height_mask",
        "height_select",
        "water_level",
        "snow_line",
    ],
    category: Category::Channel,
    summary: "1 where a height is above a level, 0 below it.",
    doc: Doc {
        computes: "out = 3t² − 2t³ with t = ½ + (in − level)/width limited to [0, 1]; a step at the level \
            where the width is less than 1e-6. Both may vary: a level that varies is the surface of \
            another material, such as the water in the ruts.",
        statistics: "That of `smoothstep`, as a function of in − level, of which all that both share is \
            kept; of the width the mean is used.",
        accuracy: "As `smoothstep`: for a Gaussian difference the mean is within 1e-4, the remainder's \
            standard deviation within 3e-3.",
        references: cite!(bussgang),
    },
    inputs: &[
        number("in", 0.0, "The height."),
        number("level", 0.0, "Where the mask is one half."),
        number(
            "width",
            0.1,
            "Over what difference of height it rises from 0 to 1.",
        )
        .range(Range::hard(0.0, 1e6).with_soft(0.0, 1.0)),
    ],
    output: OutputType::Exactly(Type::Float),
    reach: |_| Reach::of(0.0, 1.0),
    class: |_| Behaviour::Function,
    example: example! { "heightmask", r#"
    "hills": { "type": "fractal2d", "inputs": { "frequency": 5 } },
    "heightmask": { "type": "heightmask", "inputs": { "in": { "node": "hills" }, "level": 0.1, "width": 0.2 } }
"# },
};

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let half = lower.number(node, "width") * 0.5;
    let above = difference(&lower.signal(node, "in"), &lower.signal(node, "level"));
    vec![transfer(lower, &above, &Piecewise::smoothstep(-half, half))]
}
