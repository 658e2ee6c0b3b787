//! HLSL that engines call from their material graphs: Unity's and Unreal's.

use super::FormFile;
use super::library::Library;
use crate::ir::Type;
use std::fmt::Write;

/// What an engine's graph asks of a function.
struct Engine {
    extension: &'static str,
    /// The type of a texture among the arguments, and how the texture is read from it.
    texture: (&'static str, &'static str),
    /// The suffixes of the function's name, with the type of its numbers.
    precisions: &'static [(&'static str, &'static str)],
    /// How to use it.
    uses: &'static str,
}

/// Unity: the Custom Function node calls NAME_float or NAME_half.
const UNITY: Engine = Engine {
    extension: "unity.hlsl",
    texture: ("UnityTexture2D", ".tex"),
    precisions: &[("_float", "float"), ("_half", "half")],
    uses: "Custom Function node, type File, name NAME; inputs and outputs in this order. du and dv are DDX and DDY of uv.",
};

/// Unreal: a Custom node includes the file and calls the function.
const UNREAL: Engine = Engine {
    extension: "ush",
    texture: ("Texture2D", ""),
    precisions: &[("_node", "float")],
    uses: "Custom node: add the file to its Include File Paths, the outputs below to its Additional Outputs, and call NAME_node(…). du and dv are DDX and DDY of uv.",
};

/// A file for the Custom Function node of Unity's Shader Graph.
pub(super) fn unity(library: &Library<'_>) -> FormFile {
    file(library, &UNITY)
}

/// A file that a Custom node of Unreal Engine includes.
pub(super) fn unreal(library: &Library<'_>) -> FormFile {
    file(library, &UNREAL)
}

fn file(library: &Library<'_>, engine: &Engine) -> FormFile {
    let shader = library.shader;
    let function = &shader.function;
    let mut uses = vec![engine.uses.replace("NAME", function)];
    if library.takes_tables() {
        uses.push(format!(
            "tables: {}.tables.exr as 32-bit floats, without compression, mipmaps and sRGB.",
            library.file
        ));
    }
    let mut text = library.head("//", &uses);
    let guard = format!("MIPLESS_{}", function.to_ascii_uppercase());
    write!(text, "#ifndef {guard}\n#define {guard}\n\n{}", library.text)
        .expect("a string takes all text");
    for &(suffix, real) in engine.precisions {
        text.push('\n');
        push_function(&mut text, library, engine, suffix, real);
    }
    text.push_str("\n#endif\n");
    FormFile {
        extension: engine.extension,
        text,
    }
}

/// Appends a function of the host's types that calls the texture's.
fn push_function(
    text: &mut String,
    library: &Library<'_>,
    engine: &Engine,
    suffix: &str,
    real: &str,
) {
    let shader = library.shader;
    // Graphs of engines know numbers, vectors of them and truth values.
    let vector = |components: usize| match components {
        1 => real.to_owned(),
        n => format!("{real}{n}"),
    };
    let mut arguments: Vec<String> = (library.place().into_iter())
        // A coordinate is no half: its derivatives would be of its steps.
        .map(|(name, n)| format!("float{n} {name}"))
        .collect();
    let mut body = "    Footprint footprint = (Footprint)0;\n    footprint.uv = uv;\n    footprint.du = du;\n    footprint.dv = dv;\n".to_owned();
    let mut call = Vec::new();
    if library.takes_tables() {
        let (ty, read) = engine.texture;
        arguments.push(format!("{ty} tables"));
        call.push(format!("tables{read}"));
    }
    call.push("footprint".to_owned());
    if shader.position {
        body.push_str("    Position position = (Position)0;\n    position.xyz = xyz;\n    position.dx = dx;\n    position.dy = dy;\n");
        call.push("position".to_owned());
    }
    if !library.parameters.is_empty() {
        let ty = &shader.parameters_struct;
        writeln!(body, "    {ty} parameters = ({ty})0;").expect("a string takes all text");
        for parameter in &library.parameters {
            let (name, components) = (&parameter.name, parameter.field.ty.components());
            let (ty, value) = match (parameter.is_truth(), parameter.field.scalar) {
                (true, _) => ("bool".to_owned(), format!("{name} ? 1u : 0u")),
                (_, Type::F32) => (vector(components), name.clone()),
                (_, scalar) => {
                    let cast = library.language.type_name(scalar, components);
                    (vector(components), format!("({cast}){name}"))
                }
            };
            arguments.push(format!("{ty} {name}"));
            writeln!(body, "    parameters.{} = {value};", parameter.field.field)
                .expect("a string takes all text");
        }
        call.push("parameters".to_owned());
    }
    writeln!(
        body,
        "    {} outputs = {}({});",
        shader.outputs_struct,
        shader.function,
        call.join(", ")
    )
    .expect("a string takes all text");
    for (output, name) in &library.outputs {
        let ty = vector(output.ty.components());
        writeln!(body, "    {name} = ({ty})outputs.{};", output.field)
            .expect("a string takes all text");
        arguments.push(format!("out {ty} {name}"));
    }
    let name = library.free(&format!("{}{suffix}", shader.function));
    write!(
        text,
        "void {name}({}) {{\n{body}}}\n",
        arguments.join(",\n    ")
    )
    .expect("a string takes all text");
}
