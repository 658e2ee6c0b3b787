//! What a target's text calls what a host binds. naga has its own names and places in each language;
//! they are read from the text that it has written, so that they are those of the text.

use crate::manifest::{BufferSizes, ManifestTarget, TargetBinding, TargetLocation};
use crate::target::{Target, Validated};
use crate::wgsl::{Binding, BindingKind, EntryPoint, Shader, Stage};

/// What a host needs to know of a target's text, but for its file.
pub(super) fn described(
    target: Target,
    shader: &Shader,
    validated: &Validated,
    bytes: &[u8],
) -> ManifestTarget {
    let text = std::str::from_utf8(bytes).unwrap_or_default();
    let bound = |binding: &Binding| bound(target, shader, binding, text);
    let is_fragment =
        (shader.entry_point.as_ref()).is_some_and(|entry| entry.stage == Stage::Fragment);
    let (mut varyings, mut colors) = (Vec::new(), Vec::new());
    if is_fragment {
        let places = ["uv", "xyz"].iter().take(1 + usize::from(shader.position));
        for (location, of) in (0..).zip(places) {
            varyings.push(TargetLocation {
                of: (*of).to_owned(),
                location,
                name: varying(target, location),
            });
        }
        for (location, output) in (0..).zip(shader.outputs.iter().filter(|o| !o.variance)) {
            colors.push(TargetLocation {
                of: output.name.clone(),
                location,
                name: color(target, location),
            });
        }
    }
    ManifestTarget {
        file: String::new(),
        sha256: String::new(),
        key: String::new(),
        language: language(target),
        function: (target != Target::Spirv).then(|| shader.function.clone()),
        entry_point: shader.entry_point.as_ref().map(|entry| EntryPoint {
            name: match target {
                Target::Glsl | Target::GlslEs => "main".to_owned(),
                _ => entry.name.clone(),
            },
            stage: entry.stage,
        }),
        bindings: shader.bindings.iter().map(bound).collect(),
        varyings,
        colors,
        buffer_sizes: match target {
            Target::Msl => buffer_sizes(shader, validated, text),
            _ => None,
        },
    }
}

fn language(target: Target) -> &'static str {
    match target {
        Target::Wgsl => "WGSL",
        Target::Spirv => "SPIR-V 1.3",
        Target::Glsl => "GLSL 4.50",
        Target::GlslEs => "GLSL ES 3.00",
        Target::Hlsl => "HLSL, shader model 5.1",
        Target::Msl => "Metal Shading Language 2.0",
    }
}

fn varying(target: Target, location: u32) -> String {
    match target {
        Target::Wgsl => format!("@location({location})"),
        Target::Spirv => format!("Location {location}"),
        Target::Glsl | Target::GlslEs => format!("_vs2fs_location{location}"),
        Target::Hlsl => format!("LOC{location}"),
        Target::Msl => format!("user(loc{location})"),
    }
}

fn color(target: Target, location: u32) -> String {
    match target {
        Target::Wgsl => format!("@location({location})"),
        Target::Spirv => format!("Location {location}"),
        Target::Glsl | Target::GlslEs => format!("_fs2p_location{location}"),
        Target::Hlsl => format!("SV_Target{location}"),
        Target::Msl => format!("color({location})"),
    }
}

/// Where a buffer is bound, and what it is called there.
fn bound(target: Target, shader: &Shader, binding: &Binding, text: &str) -> TargetBinding {
    let Binding {
        group,
        binding: number,
        name,
        kind,
    } = binding;
    let mut found = TargetBinding {
        kind: *kind,
        name: Some(name.clone()),
        block: None,
        place: "argument".to_owned(),
        index: *number,
    };
    match target {
        Target::Wgsl => found.place = format!("@group({group}) @binding({number})"),
        Target::Spirv => {
            found.name = None;
            found.place = format!("set = {group}, binding = {number}");
        }
        Target::Glsl | Target::GlslEs => {
            let stage = match shader.entry_point.as_ref().map(|entry| entry.stage) {
                Some(Stage::Compute) => "cs",
                Some(Stage::Fragment) | None => "fs",
            };
            let variable = format!("_group_{group}_binding_{number}_{stage}");
            found.block = block(text, &variable);
            found.place = match target {
                // It has no numbers of bindings.
                Target::GlslEs => "by name".to_owned(),
                _ => format!("binding = {number}"),
            };
            found.name = Some(variable);
        }
        Target::Hlsl => {
            if let Some(place) = between(text, &format!("{name} : register("), ")") {
                found.place = format!("register({place})");
            }
        }
        Target::Msl => {
            if let Some(index) = between(text, &format!("& {name} [[buffer("), ")") {
                found.place = format!("[[buffer({index})]]");
                found.index = index.parse().unwrap_or(*number);
            }
            if let Some(index) = between(text, &format!(" {name} [[texture("), ")") {
                found.place = format!("[[texture({index})]]");
                found.index = index.parse().unwrap_or(*number);
            }
        }
    }
    found
}

/// What stands between the first `before` and the next `after`.
fn between<'a>(text: &'a str, before: &str, after: &str) -> Option<&'a str> {
    let (_, rest) = text.split_once(before)?;
    let (found, _) = rest.split_once(after)?;
    Some(found)
}

/// The name of the block of GLSL in which a variable is declared.
fn block(text: &str, variable: &str) -> Option<String> {
    let is_declared = |line: &&str| line.starts_with("layout(") && line.contains(variable);
    let (head, _) = text.lines().find(is_declared)?.split_once(" {")?;
    head.split_whitespace().last().map(str::to_owned)
}

/// Where Metal's shaders read the lengths of arrays, which naga numbers as its module does.
fn buffer_sizes(shader: &Shader, validated: &Validated, text: &str) -> Option<BufferSizes> {
    let buffer = between(text, "_mslBufferSizes& _buffer_sizes [[buffer(", ")")?;
    let members = between(text, "struct _mslBufferSizes {", "}")?;
    let kind = |member: &str| -> Option<BindingKind> {
        let number: usize = member.trim().strip_prefix("uint size")?.parse().ok()?;
        let mut variables = validated.module.global_variables.iter();
        let (_, variable) = variables.find(|(handle, _)| handle.index() == number)?;
        let at = variable.binding.as_ref()?;
        let is_it = |b: &&Binding| (b.group, b.binding) == (at.group, at.binding);
        shader.bindings.iter().find(is_it).map(|b| b.kind)
    };
    Some(BufferSizes {
        buffer: buffer.parse().ok()?,
        of: members.split(';').filter_map(kind).collect(),
    })
}
