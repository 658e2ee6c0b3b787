//! Modules of JavaScript for three.js.

use super::FormFile;
use super::library::{Library, Parameter};
use crate::ir::Type;
use crate::wgsl::{OutputField, TABLE_WIDTH};
use std::fmt::Write;

/// Text inside of a template literal.
fn quoted(text: &str) -> String {
    text.replace('\\', "\\\\")
        .replace('`', "\\`")
        .replace("${", "\\${")
}

/// The default of a parameter as JavaScript.
fn value(parameter: &Parameter<'_>) -> String {
    let numbers: Vec<String> = parameter.field.default.iter().map(f32::to_string).collect();
    match numbers.len() {
        1 => numbers.join(", "),
        n => format!("new Vector{n}({})", numbers.join(", ")),
    }
}

/// Appends the function that makes the texture of tables of the bytes of their file.
fn push_tables(text: &mut String, library: &Library<'_>) {
    let Some(tables) = &library.shader.tables else {
        return;
    };
    write!(
        text,
        "/** The texture of {file}.tables.bin, an ArrayBuffer. */\n\
         export function tablesOf(buffer) {{\n  \
           const texture = new DataTexture(new Float32Array(buffer), {TABLE_WIDTH}, {}, RedFormat, FloatType);\n  \
           texture.needsUpdate = true;\n  \
           return texture;\n\
         }}\n\n",
        tables.rows(),
        file = library.file
    )
    .expect("a string takes all text");
}

/// What the module imports of three.js.
fn imports(library: &Library<'_>, more: &[&str]) -> String {
    let mut names: Vec<&str> = more.to_vec();
    if library.shader.tables.is_some() {
        names.extend(["DataTexture", "FloatType", "RedFormat"]);
    }
    for (components, name) in [(2, "Vector2"), (3, "Vector3"), (4, "Vector4")] {
        let is_used = |p: &Parameter<'_>| p.field.ty.components() == components;
        if library.parameters.iter().any(is_used) {
            names.push(name);
        }
    }
    names.join(", ")
}

/// Nodes of TSL, for WebGPU: one function an output, which share the texture's text.
pub(super) fn nodes(library: &Library<'_>) -> FormFile {
    let shader = library.shader;
    let names: Vec<String> = (library.outputs.iter())
        .map(|(_, name)| library.free(&format!("{}_{name}", shader.function)))
        .collect();
    let mut text = library.head(
        "//",
        &[
            "Nodes for three.js (TSL, WebGPURenderer): material.colorNode = nodes().base_color."
                .to_owned(),
        ],
    );
    let values = imports(library, &[]);
    if !values.is_empty() {
        writeln!(text, "import {{ {values} }} from 'three/webgpu';")
            .expect("a string takes all text");
    }
    let texture = if library.takes_tables() {
        "texture, "
    } else {
        ""
    };
    let space = if shader.position {
        "positionLocal, "
    } else {
        ""
    };
    let uniform = if library.parameters.is_empty() {
        ""
    } else {
        "uniform, "
    };
    write!(
        text,
        "import {{ dFdx, dFdy, {space}{texture}{uniform}uv, wgsl, wgslFn }} from 'three/tsl';\n\n\
         const library = wgsl(`\n{}`);\n\n",
        quoted(&library.text)
    )
    .expect("a string takes all text");
    push_tables(&mut text, library);

    let mut arguments = Vec::new();
    if library.takes_tables() {
        arguments.push("tables: texture_2d<f32>".to_owned());
    }
    arguments.extend((library.place().iter()).map(|(name, n)| format!("{name}: vec{n}f")));
    let mut fields = Vec::new();
    for parameter in &library.parameters {
        let ty =
            (library.language).type_name(parameter.field.scalar, parameter.field.ty.components());
        arguments.push(format!("{}: {ty}", parameter.name));
        fields.push(parameter.name.clone());
    }
    let call = library.call("tables", &fields);
    for ((output, _), name) in library.outputs.iter().zip(&names) {
        let ty = library
            .language
            .type_name(output.scalar, output.ty.components());
        write!(
            text,
            "const {name} = wgslFn(`fn {name}({}) -> {ty} {{\n    return {call}.{};\n}}`, [library]);\n\n",
            arguments.join(", "),
            output.field
        )
        .expect("a string takes all text");
    }

    let mut taken = vec!["coordinate = uv()".to_owned()];
    let mut given = vec![
        "uv: coordinate".to_owned(),
        "du: dFdx(coordinate)".to_owned(),
        "dv: dFdy(coordinate)".to_owned(),
    ];
    if shader.position {
        taken.push("place = positionLocal".to_owned());
        given.extend(["xyz: place", "dx: dFdx(place)", "dy: dFdy(place)"].map(str::to_owned));
    }
    if library.takes_tables() {
        taken.push("tables".to_owned());
        given.push("tables: texture(tables)".to_owned());
    }
    for parameter in &library.parameters {
        let kind = match parameter.field.scalar {
            Type::F32 => "",
            Type::I32 => ", 'int'",
            Type::U32 | Type::Bool => ", 'uint'",
        };
        taken.push(format!(
            "{} = uniform({}{kind})",
            parameter.name,
            value(parameter)
        ));
        given.push(parameter.name.clone());
    }
    let results: Vec<String> = (library.outputs.iter().zip(&names))
        .map(|((output, _), name)| format!("    {}: {name}(place_),\n", output.field))
        .collect();
    write!(
        text,
        "/** The outputs as nodes; colours are linear. */\n\
         export function nodes({{ {} }} = {{}}) {{\n  \
           const place_ = {{ {} }};\n  \
           return {{\n{}  }};\n\
         }}\n",
        taken.join(", "),
        given.join(", "),
        results.concat()
    )
    .expect("a string takes all text");
    FormFile {
        extension: "tsl.js",
        text,
    }
}

/// A raw material in GLSL ES 3.00, for WebGL 2.
pub(super) fn material(library: &Library<'_>) -> FormFile {
    let shader = library.shader;
    let mut text = library.head(
        "//",
        &[
            "A RawShaderMaterial for three.js (WebGL 2): new Mesh(geometry, material())."
                .to_owned(),
        ],
    );
    writeln!(
        text,
        "import {{ {} }} from 'three';\n",
        imports(library, &["GLSL3", "RawShaderMaterial"])
    )
    .expect("a string takes all text");
    push_tables(&mut text, library);

    let [coordinate, space, color] =
        ["surface_uv", "surface_place", "shown"].map(|name| library.free(name));
    let (varying, pass) = match shader.position {
        true => (
            format!("\nout vec3 {space};"),
            format!("\n    {space} = position;"),
        ),
        false => Default::default(),
    };
    write!(
        text,
        "export const vertexShader = `in vec3 position;\n\
         in vec2 uv;\n\
         uniform mat4 modelViewMatrix;\n\
         uniform mat4 projectionMatrix;\n\
         out vec2 {coordinate};{varying}\n\
         void main() {{\n    \
             {coordinate} = uv;{pass}\n    \
             gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);\n\
         }}\n`;\n\n"
    )
    .expect("a string takes all text");

    let mut body =
        format!("    vec2 uv = {coordinate};\n    vec2 du = dFdx(uv);\n    vec2 dv = dFdy(uv);\n");
    let mut declared = format!("in vec2 {coordinate};\n");
    if shader.position {
        declared.push_str(&format!("in vec3 {space};\n"));
        body.push_str(&format!(
            "    vec3 xyz = {space};\n    vec3 dx = dFdx(xyz);\n    vec3 dy = dFdy(xyz);\n"
        ));
    }
    let (mut values, mut uniforms) = (Vec::new(), Vec::new());
    if shader.tables.is_some() {
        writeln!(declared, "uniform highp sampler2D {};", shader.tables_name)
            .expect("a string takes all text");
        uniforms.push(format!(
            "      {}: {{ value: tables }},\n",
            shader.tables_name
        ));
    }
    for parameter in &library.parameters {
        let name = library.free(&format!("{}_{}", shader.function, parameter.name));
        let ty =
            (library.language).type_name(parameter.field.scalar, parameter.field.ty.components());
        writeln!(declared, "uniform {ty} {name};").expect("a string takes all text");
        uniforms.push(format!(
            "      {name}: {{ value: {} }},\n",
            value(parameter)
        ));
        values.push(name);
    }
    let outputs: Vec<String> = (library.outputs.iter())
        .map(|(output, _)| format!("  {}: '{}',\n", output.field, shown(output)))
        .collect();
    write!(
        text,
        "/** What is shown of each output. */\n\
         export const outputs = {{\n{}}};\n\n\
         /** The fragment shader that shows an output. */\n\
         export const fragmentShader = (output = '{}') => `precision highp float;\n\
         precision highp int;\n\
         precision highp sampler2D;\n{}\n{declared}\
         layout(location = 0) out vec4 {color};\n\
         void main() {{\n{body}    \
             {} outputs = {};\n    \
             {color} = ${{outputs[output]}};\n\
         }}\n`;\n\n",
        outputs.concat(),
        library.outputs[0].0.field,
        quoted(&library.text),
        shader.outputs_struct,
        library.call(&shader.tables_name, &values)
    )
    .expect("a string takes all text");
    let tables = if shader.tables.is_some() {
        "tables, "
    } else {
        ""
    };
    write!(
        text,
        "/** The material; parameters are its uniforms. */\n\
         export function material({{ {tables}output }} = {{}}) {{\n  \
           return new RawShaderMaterial({{\n    \
             glslVersion: GLSL3,\n    \
             vertexShader,\n    \
             fragmentShader: fragmentShader(output),\n    \
             uniforms: {{\n{}    }},\n  \
           }});\n\
         }}\n",
        uniforms.concat()
    )
    .expect("a string takes all text");
    FormFile {
        extension: "material.js",
        text,
    }
}

/// An output as a colour.
fn shown(output: &OutputField) -> String {
    let path = format!("outputs.{}", output.field);
    match output.ty.components() {
        1 => format!("vec4(vec3(float({path})), 1.0)"),
        2 => format!("vec4(vec2({path}), 0.0, 1.0)"),
        3 => format!("vec4(vec3({path}), 1.0)"),
        _ => format!("vec4({path})"),
    }
}
