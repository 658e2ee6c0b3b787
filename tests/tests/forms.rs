//! Every form of every graph is accepted by a compiler of its language, inside of a host that includes
//! the file and calls the function.
//!
//! glslangValidator reads GLSL, GLSL ES and HLSL; where it is not installed those cases show as ignored,
//! and with `MIPLESS_REQUIRE_COMPILERS=1` they fail then. Godot, Unity, Unreal and MaterialX themselves
//! are not run: their files are read as the language that they hold, with what the host would add.

use libtest_mimic::{Arguments, Failed, Trial};
use mipless::form::{Form, FormFile};
use mipless::target::{Target, validate};
use mipless::wgsl::{Entry, Options as Emission, Shader, TableForm, emit};
use mipless::{Method, Options, Program};
use mipless_tests::asked;
use mipless_tests::case::{Case, all};
use std::collections::BTreeMap;
use std::fmt::Write;
use std::process::{Command, Stdio};
use std::sync::Arc;
use std::{env, fs};

const ES: &str =
    "#version 300 es\nprecision highp float;\nprecision highp int;\nprecision highp sampler2D;\n";

fn main() {
    let arguments = Arguments::from_args();
    let required = asked("MIPLESS_REQUIRE_COMPILERS");
    let paths = env::var_os("PATH").unwrap_or_default();
    let missing = !env::split_paths(&paths).any(|folder| folder.join("glslangValidator").is_file());
    let mut trials = Vec::new();
    let cases = all()
        .into_iter()
        .filter(|case| !case.name.starts_with("example_"));
    for case in cases.map(Arc::new) {
        let name = format!("naga_{}", case.name);
        let own = Arc::clone(&case);
        trials.push(Trial::test(name, move || modules(&own)));
        let name = format!("glslang_{}", case.name);
        let trial = Trial::test(name, move || hosts(&case));
        trials.push(trial.with_ignored_flag(missing && !required));
    }
    let trial = Trial::test("two_textures_stand_in_one_file", two);
    trials.push(trial.with_ignored_flag(missing && !required));
    libtest_mimic::run(&arguments, trials).exit();
}

fn program(case: &Case) -> Program {
    let method = Method::Local;
    case.texture.compile(&Options {
        method,
        ..Options::default()
    })
}

fn function(program: &Program, tables: TableForm) -> Shader {
    let emission = Emission {
        tables,
        ..Entry::None.into()
    };
    emit(program, &emission)
}

fn text(shader: &Shader, target: Target) -> Result<String, Failed> {
    let bytes = validate(&shader.source)?.translate(shader, target)?;
    Ok(String::from_utf8(bytes)?)
}

/// The files of a form, by their extension.
fn files(
    program: &Program,
    form: Form,
) -> Result<(Shader, BTreeMap<&'static str, String>), Failed> {
    let shader = emit(program, &form.emission(Emission::default()));
    let files = form.files(&validate(&shader.source)?, &shader, "texture", |_| {
        (Some(0.0), Some(1.0))
    })?;
    let files = (files.into_iter()).map(|FormFile { extension, text }| (extension, text));
    Ok((shader, files.collect()))
}

/// The template literals of a module of JavaScript.
fn literals(script: &str) -> Vec<String> {
    let mut literals = Vec::new();
    let mut rest = script;
    while let Some(start) = rest.find('`') {
        let end = start + 1 + rest[start + 1..].find('`').expect("a literal ends");
        literals.push(rest[start + 1..end].to_owned());
        rest = &rest[end + 1..];
    }
    literals
}

/// The modules of WGSL, read by naga.
fn modules(case: &Case) -> Result<(), Failed> {
    let program = program(case);
    for tables in [TableForm::Storage, TableForm::Texture, TableForm::Argument] {
        for entry in [Entry::None, Entry::Fragment, Entry::Compute] {
            let emission = Emission {
                tables,
                ..entry.into()
            };
            validate(&emit(&program, &emission).source)?;
        }
    }
    let (_, oil) = files(&program, Form::NagaOil)?;
    let oil = &oil["naga_oil.wgsl"];
    let (path, module) = oil.split_once('\n').expect("a path and a module");
    assert!(path.starts_with("#define_import_path mipless::"), "{path}");
    validate(module)?;
    let (_, wesl) = files(&program, Form::Wesl)?;
    validate(&wesl["wesl"])?;
    let (shader, three) = files(&program, Form::ThreeJs)?;
    let nodes = literals(&three["tsl.js"]);
    assert_eq!(nodes.len(), 1 + shader.outputs.len(), "functions of nodes");
    validate(&nodes.join("\n"))?;
    Ok(())
}

/// The files in other languages, read by glslangValidator.
fn hosts(case: &Case) -> Result<(), Failed> {
    let program = program(case);
    let mut sources = Vec::new();
    for tables in [TableForm::Storage, TableForm::Texture] {
        let shader = function(&program, tables);
        let glsl = text(&shader, Target::Glsl)?;
        sources.push((
            "glsl",
            "frag",
            format!("#version 450\n{glsl}{}", caller(&shader, "450")),
        ));
        // Without tables it is the same text.
        if tables == TableForm::Storage || shader.tables.is_some() {
            let hlsl = text(&shader, Target::Hlsl)?;
            sources.push(("hlsl", "hlsl", format!("{hlsl}{}", hlsl_caller(&shader))));
        }
        if tables == TableForm::Texture {
            let es = text(&shader, Target::GlslEs)?;
            sources.push((
                "glsl-es",
                "frag",
                format!("{ES}{es}{}", caller(&shader, "300 es")),
            ));
            let emission = Emission {
                tables,
                ..Entry::Fragment.into()
            };
            let whole = text(&emit(&program, &emission), Target::GlslEs)?;
            sources.push(("glsl-es, whole", "frag", whole));
        }
    }

    let (shader, godot) = files(&program, Form::Godot)?;
    sources.push(("godot", "frag", godot_host(&shader, &godot["gdshaderinc"])));
    let (_, unity) = files(&program, Form::Unity)?;
    let host = "struct UnityTexture2D { Texture2D tex; SamplerState samplerstate; };\n";
    let main = "float4 main(float2 uv : TEXCOORD0) : SV_Target0 { return float4(uv, 0, 1); }\n";
    sources.push((
        "unity",
        "hlsl",
        format!("{host}{}{main}", unity["unity.hlsl"]),
    ));
    let (_, unreal) = files(&program, Form::Unreal)?;
    sources.push(("unreal", "hlsl", format!("{}{main}", unreal["ush"])));
    let (shader, three) = files(&program, Form::ThreeJs)?;
    let fragment = literals(&three["material.js"]).remove(1);
    assert!(
        fragment.contains("${outputs[output]}"),
        "the output is chosen"
    );
    let shown = "vec4(float(outputs.FIELD == outputs.FIELD))";
    let shown = shown.replace("FIELD", &shader.outputs[0].field);
    let fragment = fragment.replace("${outputs[output]}", &shown);
    sources.push(("threejs", "frag", format!("#version 300 es\n{fragment}")));
    let (_, materialx) = files(&program, Form::MaterialX)?;
    sources.push(("materialx", "frag", materialx_host(&materialx)));

    let folder = tempfile::tempdir()?;
    for (form, extension, source) in sources {
        let file = folder.path().join(format!("host.{extension}"));
        fs::write(&file, &source)?;
        let mut command = Command::new("glslangValidator");
        if extension == "hlsl" {
            command.args(["-D", "-V", "-S", "frag", "-e", "main", "-o"]);
            command.arg(folder.path().join("host.spv"));
        }
        let output = command.arg(&file).stdin(Stdio::null()).output()?;
        if !output.status.success() {
            let said = String::from_utf8_lossy(&output.stdout).into_owned();
            return Err(format!("{form}: {said}").into());
        }
    }
    Ok(())
}

/// Zeros for the members of the struct of parameters.
fn zeros(shader: &Shader) -> String {
    let each = shader.parameters.iter().map(|p| {
        let (vector, scalar) = match p.scalar.name() {
            "i32" => ("ivec", "0"),
            "u32" => ("uvec", "0u"),
            _ => ("vec", "0.0"),
        };
        match p.ty.components() {
            1 => scalar.to_owned(),
            n => format!("{vector}{n}({scalar})"),
        }
    });
    let each: Vec<String> = each.collect();
    format!("{}({})", shader.parameters_struct, each.join(", "))
}

/// A fragment shader that calls a function that is included before it.
fn caller(shader: &Shader, version: &str) -> String {
    let mut arguments = "Footprint(ivec2(0), place, dFdx(place), dFdy(place))".to_owned();
    if shader.position {
        arguments.push_str(", Position(ivec3(0), vec3(place, 0.0), vec3(0.0), vec3(0.0))");
    }
    if !shader.parameters.is_empty() {
        write!(arguments, ", {}", zeros(shader)).expect("a string takes all text");
    }
    let layout = if version == "450" {
        "layout(location = 0) "
    } else {
        ""
    };
    format!(
        "{layout}in vec2 place;\n{layout}out vec4 shown;\nvoid main() {{\n    \
         {0} seen = {1}({arguments});\n    shown = vec4(float(seen.{2} == seen.{2}));\n}}\n",
        shader.outputs_struct, shader.function, shader.outputs[0].field
    )
}

fn hlsl_caller(shader: &Shader) -> String {
    let mut body = "    Footprint a = (Footprint)0;\n    a.uv = place;\n".to_owned();
    let mut arguments = "a".to_owned();
    if shader.position {
        body.push_str("    Position b = (Position)0;\n");
        arguments.push_str(", b");
    }
    if !shader.parameters.is_empty() {
        let ty = &shader.parameters_struct;
        writeln!(body, "    {ty} c = ({ty})0;").expect("a string takes all text");
        arguments.push_str(", c");
    }
    let first = &shader.outputs[0];
    let component = if first.ty.components() > 1 { ".x" } else { "" };
    format!(
        "float4 main(float2 place : TEXCOORD0) : SV_Target0 {{\n{body}    \
         {} seen = {}({arguments});\n    return (float4)(float)seen.{}{component};\n}}\n",
        shader.outputs_struct, shader.function, first.field
    )
}

/// An include of Godot as GLSL ES: uniforms without hints and defaults.
fn godot_host(shader: &Shader, include: &str) -> String {
    let mut source = ES.to_owned();
    for line in include.lines() {
        match line.strip_prefix("uniform ") {
            Some(uniform) => {
                let declared = uniform.split([':', '=', ';']).next().unwrap_or_default();
                writeln!(source, "uniform {};", declared.trim_end())
            }
            None => writeln!(source, "{line}"),
        }
        .expect("a string takes all text");
    }
    let space = if shader.position {
        ", vec3(0.0), vec3(0.0), vec3(0.0)"
    } else {
        ""
    };
    source
        + &format!(
            "in vec2 place;\nout vec4 shown;\nvoid main() {{\n    \
             {} seen = {}_at(place, dFdx(place), dFdy(place){space});\n    shown = vec4(1.0);\n}}\n",
            shader.outputs_struct, shader.function
        )
}

/// What MaterialX generates around an implementation: a call with the inputs and outputs of the
/// definition, in its order.
fn materialx_host(files: &BTreeMap<&str, String>) -> String {
    let definition = &files["mtlx"];
    let called = |line: &str, key: &str| -> String {
        let start = line.find(&format!("{key}=\"")).expect("the attribute") + key.len() + 2;
        line[start..]
            .split('"')
            .next()
            .unwrap_or_default()
            .to_owned()
    };
    let glsl = |ty: &str| match ty {
        "filename" => "sampler2D",
        "float" => "float",
        "integer" => "int",
        "boolean" => "bool",
        "vector2" => "vec2",
        "vector3" | "color3" => "vec3",
        _ => "vec4",
    };
    let (mut declared, mut body, mut arguments) = (String::new(), String::new(), Vec::new());
    for line in definition.lines().map(str::trim_start) {
        let (name, is_input) = match line.split_whitespace().next() {
            Some("<input") => (called(line, "name"), true),
            Some("<output") => (called(line, "name"), false),
            _ => continue,
        };
        let ty = called(line, "type");
        // A truth value of MaterialX is a uniform too.
        match is_input {
            true => writeln!(declared, "uniform {} host_{name};", glsl(&ty)),
            false => writeln!(body, "    {} host_{name};", glsl(&ty)),
        }
        .expect("a string takes all text");
        arguments.push(format!("host_{name}"));
    }
    let implementation = definition
        .lines()
        .find(|line| line.contains("<implementation"));
    let function = called(implementation.expect("an implementation"), "function");
    format!(
        "#version 400\n{}{declared}out vec4 shown;\nvoid main() {{\n{body}    {function}({});\n    shown = vec4(1.0);\n}}\n",
        files["genglsl.glsl"],
        arguments.join(", ")
    )
}

/// Two textures, one with tables, are included in one file.
fn two() -> Result<(), Failed> {
    let cases: Vec<Case> = all()
        .into_iter()
        .filter(|case| ["marble", "wood"].contains(&case.name.as_str()))
        .collect();
    assert_eq!(cases.len(), 2, "the graphs are there");
    let mut languages = [(Target::Glsl, String::new()), (Target::Hlsl, String::new())];
    let mut last = None;
    for case in &cases {
        let shader = function(&program(case), TableForm::Texture);
        for (target, source) in &mut languages {
            source.push_str(&text(&shader, *target)?);
        }
        last = Some(shader);
    }
    let shader = last.expect("there are two");
    let folder = tempfile::tempdir()?;
    for (target, source) in languages {
        let is_glsl = target == Target::Glsl;
        let (name, source) = match is_glsl {
            true => (
                "two.frag",
                format!("#version 450\n{source}{}", caller(&shader, "450")),
            ),
            false => ("two.hlsl", source + &hlsl_caller(&shader)),
        };
        let file = folder.path().join(name);
        fs::write(&file, source)?;
        let mut command = Command::new("glslangValidator");
        if !is_glsl {
            command.args(["-D", "-V", "-S", "frag", "-e", "main", "-o"]);
            command.arg(folder.path().join("host.spv"));
        }
        let output = command.arg(&file).stdin(Stdio::null()).output()?;
        let said = String::from_utf8_lossy(&output.stdout);
        assert!(output.status.success(), "{}: {said}", target.name());
    }
    Ok(())
}
