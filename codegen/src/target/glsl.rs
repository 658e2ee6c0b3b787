//! GLSL, by naga: whole shaders, and functions to include.

use super::included::included;
use super::language::{Target, TranslateError};
use super::validate::{Validated, revalidate};
use crate::wgsl::{Shader, Stage, camel};
use naga::back::glsl;
use naga::proc::BoundsCheckPolicies;
use naga::{
    AddressSpace, Block, EntryPoint, Expression, Function, GlobalVariable, Module, ResourceBinding,
    ShaderStage, Span, Statement, TypeInner,
};

/// What naga calls the entry point of every GLSL text.
const MAIN: &str = "\nvoid main() {";

/// A shader in GLSL.
pub(super) fn write(
    validated: &Validated,
    shader: &Shader,
    target: Target,
) -> Result<String, TranslateError> {
    let (shader_stage, entry_point) = match &shader.entry_point {
        Some(entry) => {
            let stage = match entry.stage {
                Stage::Fragment => ShaderStage::Fragment,
                Stage::Compute => ShaderStage::Compute,
            };
            (stage, entry.name.clone())
        }
        // naga writes what an entry point reaches, and nothing without one.
        None => {
            let caller = calling(&validated.module, shader);
            let validated = revalidate(caller)?;
            let entry = (ShaderStage::Fragment, CALLER.to_owned());
            let text = written(&validated, shader, target, entry)?;
            return Ok(function(&text, shader));
        }
    };
    written(validated, shader, target, (shader_stage, entry_point))
}

fn written(
    validated: &Validated,
    shader: &Shader,
    target: Target,
    (shader_stage, entry_point): (ShaderStage, String),
) -> Result<String, TranslateError> {
    let version = match target {
        Target::GlslEs => glsl::Version::new_gles(300),
        _ => glsl::Version::Desktop(450),
    };
    let places = shader.bindings.iter().map(|b| {
        let place = ResourceBinding {
            group: b.group,
            binding: b.binding,
        };
        (place, b.binding as u8)
    });
    let options = glsl::Options {
        version,
        writer_flags: glsl::WriterFlags::empty(),
        binding_map: places.collect(),
        ..glsl::Options::default()
    };
    let pipeline = glsl::PipelineOptions {
        shader_stage,
        entry_point,
        multiview: None,
    };
    let policies = BoundsCheckPolicies::default();
    let (module, info) = (&validated.module, &validated.info);
    let mut text = String::new();
    glsl::Writer::new(&mut text, module, info, &options, &pipeline, policies)
        .and_then(|mut writer| writer.write())
        .map_err(|error| TranslateError::BackEnd(target, error.to_string()))?;
    Ok(text)
}

/// The entry point that calls what a function's text is of.
const CALLER: &str = "mipless_caller";

/// The same module with a fragment shader that calls the texture's functions.
fn calling(module: &Module, shader: &Shader) -> Module {
    let mut module = module.clone();
    let mut caller = Function::default();
    let names: Vec<&String> = std::iter::once(&shader.function)
        .chain(&shader.shading)
        .collect();
    let callees: Vec<_> = (module.functions.iter())
        .filter(|(_, function)| function.name.as_ref().is_some_and(|n| names.contains(&n)))
        .map(|(handle, function)| (handle, function.arguments.clone()))
        .collect();
    for (handle, arguments) in callees {
        let mut values = Vec::with_capacity(arguments.len());
        for (binding, argument) in (0..).zip(&arguments) {
            let is_image = matches!(module.types[argument.ty].inner, TypeInner::Image { .. });
            let value = if is_image {
                // Textures are passed from module scope, and are cut off with the caller.
                let texture = GlobalVariable {
                    name: Some(CALLER.to_owned()),
                    space: AddressSpace::Handle,
                    binding: Some(ResourceBinding { group: 0, binding }),
                    ty: argument.ty,
                    init: None,
                    memory_decorations: naga::MemoryDecorations::empty(),
                };
                let texture = module.global_variables.append(texture, Span::UNDEFINED);
                Expression::GlobalVariable(texture)
            } else {
                Expression::ZeroValue(argument.ty)
            };
            values.push(caller.expressions.append(value, Span::UNDEFINED));
        }
        let result = Expression::CallResult(handle);
        let result = caller.expressions.append(result, Span::UNDEFINED);
        let call = Statement::Call {
            function: handle,
            arguments: values,
            result: Some(result),
        };
        caller.body.push(call, Span::UNDEFINED);
    }
    caller
        .body
        .extend_block(Block::from_vec(vec![Statement::Return { value: None }]));
    module.entry_points.push(EntryPoint {
        name: CALLER.to_owned(),
        stage: ShaderStage::Fragment,
        early_depth_test: None,
        workgroup_size: [0; 3],
        workgroup_size_overrides: None,
        function: caller,
        mesh_info: None,
        task_payload: None,
        incoming_ray_payload: None,
    });
    module
}

/// A text without its version and its caller, in which the tables have their own name.
fn function(text: &str, shader: &Shader) -> String {
    let functions = text.split(MAIN).next().unwrap_or(text);
    let mut own = String::with_capacity(functions.len());
    let camel = camel(&shader.tables_name);
    // naga names what is at module scope by its place; a caller's texture has place 0 of group 0.
    let placed = |line: &str| -> Option<String> {
        let at = line.find("_group_")?;
        let end = line[at..].find("_fs").map(|end| at + end + "_fs".len())?;
        Some(line[at..end].to_owned())
    };
    let table = shader
        .bindings
        .iter()
        .find(|b| b.name == shader.tables_name);
    let table = table.map(|b| format!("_group_{}_binding_{}_fs", b.group, b.binding));
    for line in functions.lines() {
        if line.starts_with("#version") || line.starts_with("precision ") {
            continue;
        }
        match (placed(line), &table) {
            (Some(name), Some(table)) if name == *table => {
                let line = line.replace(&name, &shader.tables_name);
                // The block of a buffer is named by its type and stage.
                let block = line
                    .split_whitespace()
                    .find(|word| word.contains("_block_"));
                match block.map(str::to_owned) {
                    Some(block) => own.push_str(&line.replace(&block, &format!("{camel}Block"))),
                    None => own.push_str(&line),
                }
            }
            (Some(_), _) => continue,
            (None, _) => own.push_str(line),
        }
        own.push('\n');
    }
    included(&own)
}
