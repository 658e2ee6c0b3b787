//! MaterialX: the definition of a node, and its implementation for `genglsl`.

use super::FormFile;
use super::library::Library;
use crate::ir::Type;
use mipless_graph::Type as GraphType;
use std::fmt::Write;

/// Of the library's files.
const SOURCE: &str = "genglsl.glsl";

/// The document: what the node is called, takes and gives.
pub(super) fn definition(library: &Library<'_>) -> FormFile {
    let shader = library.shader;
    let function = &shader.function;
    let mut text = format!(
        "<?xml version=\"1.0\"?>\n\
         <materialx version=\"1.39\">\n  \
           <nodedef name=\"ND_mipless_{function}\" node=\"mipless_{function}\" nodegroup=\"procedural\">\n"
    );
    let mut input = |name: &str, ty: &str, rest: &str| {
        writeln!(text, "    <input name=\"{name}\" type=\"{ty}\"{rest} />")
            .expect("a string takes all text");
    };
    if library.takes_tables() {
        let value = format!(
            " uniform=\"true\" value=\"{}.tables.exr\" colorspace=\"none\"",
            library.file
        );
        input("tables", "filename", &value);
    }
    input("uv", "vector2", " defaultgeomprop=\"UV0\"");
    if shader.position {
        input("xyz", "vector3", " defaultgeomprop=\"Pobject\"");
    }
    for parameter in &library.parameters {
        let numbers: Vec<String> = (parameter.field.default.iter())
            .map(|number| match parameter.is_truth() {
                true => (*number != 0.0).to_string(),
                false => format!("{number}"),
            })
            .collect();
        let mut rest = format!(" value=\"{}\"", numbers.join(", "));
        let (min, max) = parameter.range;
        for (key, bound) in [("uimin", min), ("uimax", max)] {
            if let Some(bound) = bound {
                let all = vec![bound.to_string(); numbers.len()];
                write!(rest, " {key}=\"{}\"", all.join(", ")).expect("a string takes all text");
            }
        }
        input(&parameter.name, parameter.field.ty.name(), &rest);
    }
    for (output, name) in &library.outputs {
        writeln!(
            text,
            "    <output name=\"{name}\" type=\"{}\" />",
            output.ty.name()
        )
        .expect("a string takes all text");
    }
    write!(
        text,
        "  </nodedef>\n  \
           <implementation name=\"IM_mipless_{function}_genglsl\" nodedef=\"ND_mipless_{function}\" \
         file=\"{}.{SOURCE}\" function=\"{}\" target=\"genglsl\" />\n\
         </materialx>\n",
        library.file,
        wrapper(library)
    )
    .expect("a string takes all text");
    FormFile {
        extension: "mtlx",
        text,
    }
}

fn wrapper(library: &Library<'_>) -> String {
    library.free(&format!("mipless_{}", library.shader.function))
}

/// The implementation: arguments as the definition has them, then the outputs.
pub(super) fn source(library: &Library<'_>) -> FormFile {
    let shader = library.shader;
    let mut arguments = Vec::new();
    if library.takes_tables() {
        arguments.push("sampler2D tables".to_owned());
    }
    arguments.push("vec2 uv".to_owned());
    let mut body = "    vec2 du = dFdx(uv);\n    vec2 dv = dFdy(uv);\n".to_owned();
    if shader.position {
        arguments.push("vec3 xyz".to_owned());
        body.push_str("    vec3 dx = dFdx(xyz);\n    vec3 dy = dFdy(xyz);\n");
    }
    let mut values = Vec::new();
    for parameter in &library.parameters {
        let name = &parameter.name;
        arguments.push(format!("{} {name}", library.host_type(parameter)));
        values.push(match parameter.is_truth() {
            true => format!("({name} ? 1u : 0u)"),
            false => name.clone(),
        });
    }
    writeln!(
        body,
        "    {} outputs = {};",
        shader.outputs_struct,
        library.call("tables", &values)
    )
    .expect("a string takes all text");
    for (output, name) in &library.outputs {
        let components = output.ty.components();
        let scalar = match output.ty {
            GraphType::Integer => Type::I32,
            GraphType::Boolean => Type::Bool,
            _ => Type::F32,
        };
        let ty = library.language.type_name(scalar, components);
        arguments.push(format!("out {ty} {name}"));
        writeln!(body, "    {name} = {ty}(outputs.{});", output.field)
            .expect("a string takes all text");
    }
    let mut text = library.head(
        "//",
        &[format!("The implementation of {}.mtlx.", library.file)],
    );
    write!(
        text,
        "\n{}\nvoid {}({}) {{\n{body}}}\n",
        library.text,
        wrapper(library),
        arguments.join(", ")
    )
    .expect("a string takes all text");
    FormFile {
        extension: SOURCE,
        text,
    }
}
