//! The public face of a shader: its structs, the signature of its function, the entry points.

use super::function::EntryText;
use super::name::{Scope, identifier};
use super::table::{ARGUMENT, ARGUMENT_TYPE, push_variable};
use super::{
    Binding, BindingKind, Entry, EntryPoint, FOOTPRINTS_BINDING, OUTPUTS_BINDING, Options,
    OutputField, PARAMETERS_BINDING, PIXELS_PER_ROW, ParameterField, Stage, WORKGROUP_SIZE,
};
use crate::ir::{Program, Type};
use std::fmt::Write;
use std::sync::LazyLock;

/// How the entry spells the eight scalars of the footprint.
const FOOTPRINT_PATHS: [&str; 8] = [
    "footprint.cell.x",
    "footprint.cell.y",
    "footprint.uv.x",
    "footprint.uv.y",
    "footprint.du.x",
    "footprint.du.y",
    "footprint.dv.x",
    "footprint.dv.y",
];

/// How the entry spells the twelve scalars of the position.
const POSITION_PATHS: [&str; 12] = [
    "position.cell.x",
    "position.cell.y",
    "position.cell.z",
    "position.xyz.x",
    "position.xyz.y",
    "position.xyz.z",
    "position.dx.x",
    "position.dx.y",
    "position.dx.z",
    "position.dy.x",
    "position.dy.y",
    "position.dy.z",
];

const AXES: [&str; 4] = ["x", "y", "z", "w"];

/// The names of the module scope that callers see.
#[derive(Debug)]
pub(super) struct Names {
    /// The texture's function.
    pub(super) function: String,
    /// The struct of its parameters.
    pub(super) parameters: String,
    /// The struct of its outputs.
    pub(super) outputs: String,
    /// The array of all tables.
    pub(super) tables: String,
}

/// The parameters and outputs as structs.
#[derive(Debug)]
pub(super) struct Face {
    /// The members of the struct of parameters, with their uniform layout.
    pub(super) parameters: Vec<ParameterField>,
    /// The size of that struct in bytes; 0 without parameters.
    pub(super) parameters_size: u32,
    /// The members of the struct of outputs.
    pub(super) outputs: Vec<OutputField>,
    /// Whether the position in space is an argument.
    pub(super) position: bool,
}

/// The WGSL type of `components` scalars.
fn type_text(scalar: Type, components: usize) -> String {
    let suffix = match scalar {
        Type::F32 => "f",
        Type::I32 => "i",
        Type::U32 => "u",
        Type::Bool => {
            return if components == 1 {
                "bool".into()
            } else {
                format!("vec{components}<bool>")
            };
        }
    };
    if components == 1 {
        scalar.name().to_owned()
    } else {
        format!("vec{components}{suffix}")
    }
}

/// The type of a parameter's member: truth values are not host-shareable, so they are `u32` there.
fn shared(scalar: Type) -> Type {
    if scalar == Type::Bool {
        Type::U32
    } else {
        scalar
    }
}

/// Lays out the parameters and outputs of a program.
///
/// # Panics
/// If the entry's scalars do not match the interface: a bug of the compiler.
pub(super) fn face(program: &Program) -> Face {
    let (entry, interface) = (program.module.entry(), &program.interface);
    let mut scope = Scope::default();
    let mut parameters = Vec::new();
    let (mut first, mut offset) = (interface.place(), 0_u32);
    for port in &interface.parameters {
        let components = port.ty.components();
        assert!(components > 0, "the parameter {} has no number", port.name);
        let align = [4, 8, 16, 16][components - 1];
        offset = offset.next_multiple_of(align);
        parameters.push(ParameterField {
            name: port.name.clone(),
            field: scope.take(identifier(&port.name)),
            ty: port.ty,
            scalar: shared(entry.params[first].ty),
            offset,
            default: port.default.clone(),
        });
        offset += 4 * components as u32;
        first += components;
    }
    assert_eq!(
        entry.params.len(),
        first,
        "parameters of the entry and of its interface"
    );

    let mut scope = Scope::default();
    let mut outputs: Vec<OutputField> = Vec::new();
    let mut first = 0;
    for variance in [false, true]
        .into_iter()
        .take(1 + usize::from(interface.moments))
    {
        for port in &interface.outputs {
            let suffix = if variance { " variance" } else { "" };
            outputs.push(OutputField {
                name: port.name.clone(),
                field: scope.take(identifier(&format!("{}{suffix}", port.name))),
                ty: port.ty,
                scalar: entry.ty(entry.results[first].1),
                variance,
                first: first as u32,
            });
            first += port.ty.components();
        }
    }
    assert_eq!(
        entry.results.len(),
        first,
        "results of the entry and of its interface"
    );
    assert!(first > 0, "a texture has an output");
    Face {
        parameters,
        parameters_size: offset.next_multiple_of(16),
        outputs,
        position: interface.position,
    }
}

/// The struct of the footprint.
const FOOTPRINT: &str = "\
/// Where a pixel lies in texture space: its centre at cell + uv, the change of uv to the next
/// pixel on the right (du) and below (dv).
struct Footprint {
    cell: vec2i,
    uv: vec2f,
    du: vec2f,
    dv: vec2f,
}

";

/// The struct of the position in space.
const POSITION: &str = "\
/// Where a pixel lies in space: its centre at cell + xyz, the change to the next pixel on the
/// right (dx) and below (dy).
struct Position {
    cell: vec3i,
    xyz: vec3f,
    dx: vec3f,
    dy: vec3f,
}

";

/// What every texture of a module reads: the structs `Footprint` and `Position`, for shaders that do
/// not declare them ([`Options::shared_footprint`]).
pub static DECLARATIONS: LazyLock<String> = LazyLock::new(|| format!("{FOOTPRINT}{POSITION}"));

/// Appends `Footprint` and the structs of parameters and outputs.
pub(super) fn push_structs(out: &mut String, names: &Names, face: &Face, options: &Options) {
    if !options.shared_footprint {
        out.push_str(FOOTPRINT);
        if face.position {
            out.push_str(POSITION);
        }
    }
    let mut push = |name: &str, fields: &mut dyn Iterator<Item = (&str, String)>| {
        out.push_str("struct ");
        out.push_str(name);
        out.push_str(" {\n");
        for (field, ty) in fields {
            writeln!(out, "    {field}: {ty},").expect("a string takes all text");
        }
        out.push_str("}\n\n");
    };
    if !face.parameters.is_empty() {
        let mut fields = (face.parameters.iter())
            .map(|p| (p.field.as_str(), type_text(p.scalar, p.ty.components())));
        push(&names.parameters, &mut fields);
    }
    let mut fields = face
        .outputs
        .iter()
        .map(|o| (o.field.as_str(), type_text(o.scalar, o.ty.components())));
    push(&names.outputs, &mut fields);
}

/// How the texture's function spells its parameters and result.
pub(super) fn entry_text(
    program: &Program,
    names: &Names,
    face: &Face,
    takes_tables: bool,
) -> EntryText {
    let mut signature = String::new();
    if takes_tables {
        write!(signature, "{ARGUMENT}: {ARGUMENT_TYPE}, ").expect("a string takes all text");
    }
    signature.push_str("footprint: Footprint");
    let mut parameters: Vec<String> = FOOTPRINT_PATHS.map(str::to_owned).into();
    if face.position {
        signature.push_str(", position: Position");
        parameters.extend(POSITION_PATHS.map(str::to_owned));
    }
    if !face.parameters.is_empty() {
        write!(signature, ", parameters: {}", names.parameters).expect("a string takes all text");
    }
    write!(signature, ") -> {}", names.outputs).expect("a string takes all text");
    let entry = program.module.entry();
    for field in &face.parameters {
        let components = field.ty.components();
        for axis in &AXES[..components] {
            let mut path = format!("parameters.{}", field.field);
            if components > 1 {
                path = format!("{path}.{axis}");
            }
            if entry.params[parameters.len()].ty == Type::Bool {
                path = format!("({path} != 0u)");
            }
            parameters.push(path);
        }
    }
    let mut results = vec![(format!("{}(", names.outputs), None)];
    for (index, output) in face.outputs.iter().enumerate() {
        let components = output.ty.components();
        let comma = if index > 0 { ", " } else { "" };
        let open = match components {
            1 => comma.to_owned(),
            n => format!("{comma}{}(", type_text(output.scalar, n)),
        };
        for component in 0..components {
            let text = if component == 0 {
                open.clone()
            } else {
                ", ".to_owned()
            };
            results.push((text, Some(output.first as usize + component)));
        }
        if components > 1 {
            results.push((")".to_owned(), None));
        }
    }
    results.push((")".to_owned(), None));
    EntryText {
        signature,
        arguments: Vec::new(),
        parameters,
        results,
    }
}

/// A scalar of an output as an f32.
fn as_f32(scalar: Type, path: &str) -> String {
    match scalar {
        Type::F32 => path.to_owned(),
        Type::I32 | Type::U32 | Type::Bool => format!("f32({path})"),
    }
}

/// Appends the entry point, if one is wanted; returns it and the bindings that it declares.
pub(super) fn push_entry_point(
    out: &mut String,
    scope: &mut Scope,
    options: &Options,
    names: &Names,
    face: &Face,
    takes_tables: bool,
) -> (Option<EntryPoint>, Vec<Binding>) {
    let (entry, group) = (options.entry, options.group);
    let mut bindings = Vec::new();
    let mut declare = |out: &mut String, binding, kind, words: &str, space: &str, ty: &str| {
        let name = scope.take(format!("{}_{words}", names.function));
        let binding = options.binding + binding;
        writeln!(
            out,
            "@group({group}) @binding({binding}) var<{space}> {name}: {ty};"
        )
        .expect("a string takes all text");
        bindings.push(Binding {
            group,
            binding,
            name: name.clone(),
            kind,
        });
        name
    };
    let stage = match entry {
        Entry::None => return (None, bindings),
        Entry::Fragment => Stage::Fragment,
        Entry::Compute => Stage::Compute,
    };
    if takes_tables {
        push_variable(out, options, &names.tables);
    }
    if entry == Entry::Compute && face.position {
        out.push_str("struct Pixel {\n    footprint: Footprint,\n    position: Position,\n}\n\n");
    }
    let footprints = (entry == Entry::Compute).then(|| {
        let kind = BindingKind::Footprints;
        declare(
            out,
            FOOTPRINTS_BINDING,
            kind,
            "footprints",
            "storage, read",
            if face.position {
                "array<Pixel>"
            } else {
                "array<Footprint>"
            },
        )
    });
    let parameters = (!face.parameters.is_empty()).then(|| {
        let kind = BindingKind::Parameters;
        declare(
            out,
            PARAMETERS_BINDING,
            kind,
            "uniforms",
            "uniform",
            &names.parameters,
        )
    });
    let pixels = (entry == Entry::Compute).then(|| {
        let kind = BindingKind::Outputs;
        declare(
            out,
            OUTPUTS_BINDING,
            kind,
            "pixels",
            "storage, read_write",
            "array<f32>",
        )
    });
    if !bindings.is_empty() {
        out.push('\n');
    }
    let argument = parameters.map_or(String::new(), |name| format!(", {name}"));
    let callee = if takes_tables {
        format!("{}({}, ", names.function, names.tables)
    } else {
        format!("{}(", names.function)
    };
    let name = match (footprints, pixels) {
        (Some(footprints), Some(pixels)) => {
            let name = scope.take(format!("{}_compute", names.function));
            push_compute(out, &name, &callee, face, [&footprints, &pixels, &argument]);
            name
        }
        _ => {
            let name = scope.take(format!("{}_fragment", names.function));
            push_fragment(out, scope, &name, names, face, [&callee, &argument]);
            name
        }
    };
    (Some(EntryPoint { name, stage }), bindings)
}

fn push_compute(
    out: &mut String,
    name: &str,
    callee: &str,
    face: &Face,
    [footprints, pixels, argument]: [&str; 3],
) {
    let pixel = if face.position {
        format!("{footprints}[index].footprint, {footprints}[index].position")
    } else {
        format!("{footprints}[index]")
    };
    let scalars: usize = face.outputs.iter().map(|o| o.ty.components()).sum();
    write!(
        out,
        "@compute @workgroup_size({WORKGROUP_SIZE})\n\
         fn {name}(@builtin(global_invocation_id) id: vec3u) {{\n    \
             let index = id.x + id.y * {PIXELS_PER_ROW}u;\n    \
             if index >= arrayLength(&{footprints}) {{\n        return;\n    }}\n    \
             let outputs = {callee}{pixel}{argument});\n    \
             let first = index * {scalars}u;\n"
    )
    .expect("a string takes all text");
    for output in &face.outputs {
        let components = output.ty.components();
        for (component, axis) in AXES[..components].iter().enumerate() {
            let mut path = format!("outputs.{}", output.field);
            if components > 1 {
                path = format!("{path}.{axis}");
            }
            let value = as_f32(output.scalar, &path);
            let at = output.first as usize + component;
            writeln!(out, "    {pixels}[first + {at}u] = {value};")
                .expect("a string takes all text");
        }
    }
    out.push_str("}\n");
}

fn push_fragment(
    out: &mut String,
    scope: &mut Scope,
    name: &str,
    names: &Names,
    face: &Face,
    [callee, argument]: [&str; 2],
) {
    let means: Vec<&OutputField> = face.outputs.iter().filter(|o| !o.variance).collect();
    let colors: Vec<String> = (means.iter())
        .map(|output| {
            let components = output.ty.components();
            let path = format!("outputs.{}", output.field);
            let part = |axis: &str| as_f32(output.scalar, &format!("{path}.{axis}"));
            match components {
                1 => format!("vec4f(vec3f({}), 1.0)", as_f32(output.scalar, &path)),
                2 => format!("vec4f({}, {}, 0.0, 1.0)", part("x"), part("y")),
                3 => format!("vec4f({}, {}, {}, 1.0)", part("x"), part("y"), part("z")),
                _ => format!(
                    "vec4f({}, {}, {}, {})",
                    part("x"),
                    part("y"),
                    part("z"),
                    part("w")
                ),
            }
        })
        .collect();
    let (result, value) = if let [color] = &colors[..] {
        ("@location(0) vec4f".to_owned(), color.clone())
    } else {
        let targets = scope.take(format!("{}Targets", super::name::camel(&names.function)));
        writeln!(out, "struct {targets} {{").expect("a string takes all text");
        for (location, output) in means.iter().enumerate() {
            writeln!(out, "    @location({location}) {}: vec4f,", output.field)
                .expect("a string takes all text");
        }
        out.push_str("}\n\n");
        (targets.clone(), format!("{targets}({})", colors.join(", ")))
    };
    let (input, position, place) = if face.position {
        (
            ", @location(1) xyz: vec3f",
            "    let position = Position(vec3i(0i, 0i, 0i), xyz, dpdx(xyz), dpdy(xyz));\n",
            ", position",
        )
    } else {
        ("", "", "")
    };
    write!(
        out,
        "@fragment\nfn {name}(@location(0) uv: vec2f{input}) -> {result} {{\n    \
             let footprint = Footprint(vec2i(0i, 0i), uv, dpdx(uv), dpdy(uv));\n{position}    \
             let outputs = {callee}footprint{place}{argument});\n    return {value};\n}}\n"
    )
    .expect("a string takes all text");
}
