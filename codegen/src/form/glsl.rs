//! Godot's shader language, which is GLSL ES with uniforms of its own.

use super::FormFile;
use super::library::{Library, Parameter, literal, real};
use crate::ir::Type;
use mipless_graph::Type as GraphType;
use std::fmt::Write;

/// A shader include of Godot 4: uniforms for the parameters, the function, and a function of the
/// coordinate and its derivatives.
pub(super) fn godot(library: &Library<'_>) -> FormFile {
    let shader = library.shader;
    let function = &shader.function;
    let wrapper = library.free(&format!("{function}_at"));
    let place: Vec<&str> = library.place().iter().map(|&(name, _)| name).collect();
    let uses = match shader.position {
        true => format!("{wrapper}(UV, dFdx(UV), dFdy(UV), xyz, dFdx(xyz), dFdy(xyz))"),
        false => format!("{wrapper}(UV, dFdx(UV), dFdy(UV))"),
    };
    let (output, _) = library.outputs[0];
    let mut text = library.head(
        "//",
        &[
            format!("#include \"{}.gdshaderinc\"", library.file),
            format!(
                "In fragment(): {} {function}_here = {uses}; ALBEDO = {function}_here.{};",
                shader.outputs_struct, output.field
            ),
            "Colours are linear, as ALBEDO is.".to_owned(),
        ],
    );
    text.push('\n');
    // Godot declares textures by their use, and has no precision for them.
    for line in library.text.lines() {
        match line.strip_prefix("uniform highp sampler2D ") {
            Some(name) => {
                let name = name.trim_end_matches(';');
                writeln!(
                    text,
                    "// {}.tables.exr, or {} rows of 2048 numbers of {}.tables.bin as FORMAT_RF.",
                    library.file,
                    shader.tables.as_ref().map_or(0, |t| t.rows()),
                    library.file
                )
                .expect("a string takes all text");
                writeln!(
                    text,
                    "uniform sampler2D {name} : filter_nearest, repeat_disable;"
                )
            }
            None => writeln!(text, "{line}"),
        }
        .expect("a string takes all text");
    }
    text.push('\n');
    let mut values = Vec::new();
    for parameter in &library.parameters {
        let name = library.free(&format!("{function}_{}", parameter.name));
        let ty = library.host_type(parameter);
        let hint = hint(parameter);
        let default = literal(library.language, parameter);
        writeln!(text, "uniform {ty} {name}{hint} = {default};").expect("a string takes all text");
        values.push(match parameter.is_truth() {
            true => format!("({name} ? 1u : 0u)"),
            false => name,
        });
    }
    let arguments: Vec<String> = (library.place().iter().zip(place))
        .map(|(&(_, n), name)| format!("vec{n} {name}"))
        .collect();
    write!(
        text,
        "\n{} {wrapper}({}) {{\n    return {};\n}}\n",
        shader.outputs_struct,
        arguments.join(", "),
        library.call("", &values)
    )
    .expect("a string takes all text");
    FormFile {
        extension: "gdshaderinc",
        text,
    }
}

/// What Godot's inspector is told of a uniform.
fn hint(parameter: &Parameter<'_>) -> String {
    let field = parameter.field;
    match (field.ty, parameter.range, field.scalar) {
        (GraphType::Color3 | GraphType::Color4, ..) => " : source_color".to_owned(),
        (GraphType::Float, (Some(min), Some(max)), _) => {
            // The third number is the step.
            let step = real((max - min) / 1000.0);
            format!(" : hint_range({}, {}, {step})", real(min), real(max))
        }
        (GraphType::Integer, (Some(min), Some(max)), Type::I32) => {
            format!(" : hint_range({min}, {max})")
        }
        _ => String::new(),
    }
}
