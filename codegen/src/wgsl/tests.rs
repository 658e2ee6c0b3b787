//! Tests of the emitted text.

use super::{DECLARATIONS, Entry, Options, emit};
use crate::ir::{Builder, FOOTPRINT, Float, Int, Interface, Module, Port, Program};
use crate::target::validate;
use mipless_graph::Type as GraphType;
use proptest::prelude::*;

fn port(name: &str, ty: GraphType) -> Port {
    Port {
        name: name.to_owned(),
        ty,
        default: vec![0.0; ty.components()],
    }
}

fn interface(name: &str, parameters: Vec<Port>, outputs: Vec<Port>) -> Interface {
    Interface {
        name: name.to_owned(),
        parameters,
        outputs,
        moments: false,
        position: false,
    }
}

/// A builder of an entry.
fn entry(name: &str) -> Builder {
    Builder::new(name, "The whole texture.")
}

/// The footprint's parameters: the cell, and the numbers after it.
fn footprint(b: &Builder) -> ([Int<'_>; 2], [Float<'_>; 6]) {
    let [x, y, numbers @ ..] = FOOTPRINT.map(|(name, ty)| b.scalar_param(name, ty));
    ([x.int(), y.int()], numbers.map(|number| number.float()))
}

/// A program of the entry and what it calls, with these outputs and no parameters.
fn program(b: &Builder, mut module: Module, name: &str, outputs: Vec<Port>) -> Program {
    b.finish(&mut module);
    Program {
        module,
        interface: interface(name, Vec::new(), outputs),
    }
}

/// A texture with a helper, a loop, an `if` and a parameter.
fn marble() -> Program {
    let mut module = Module::default();
    let b = &Builder::new("octave", "One octave of something.");
    let index = b.uint_param("index");
    let [mean, slope, x] = b.float_params(["mean", "slope", "x"]);
    let wave = (index.to_float() * x).sin();
    b.result("mean", mean + wave);
    b.result("slope", slope * wave);
    let octave = b.finish(&mut module);

    let b = &Builder::new("fine", "A detail.");
    b.uint_param("index");
    b.result("state", b.float_param("state") * 0.5);
    let fine = b.finish(&mut module);

    let b = &entry("marble");
    let (_, [u, _, du, ..]) = footprint(b);
    let scale = b.float_param("scale");
    let x = u * scale;
    let [mean, slope] = b.fold(&octave, b.uint(5), [0.0, 1.0].map(|x| b.float(x)), x);
    b.name(mean, "swirl_mean");
    b.name(slope, "swirl_slope");
    let times = du.lt(scale).select(1u32, 0u32);
    let veins = b.fold(&fine, times, mean, ()) - (slope - x);
    b.name(veins, "veins");
    b.result("r", veins);
    b.result("g", veins * 0.5);
    b.result("b", b.float(1.0));
    let parameters = vec![Port {
        default: vec![6.0],
        ..port("scale", GraphType::Float)
    }];
    let mut program = program(
        b,
        module,
        "marble",
        vec![port("base_color", GraphType::Color3)],
    );
    program.interface.parameters = parameters;
    program
}

fn assert_valid(source: &str) {
    if let Err(error) = validate(source) {
        panic!("{error}\n{source}");
    }
}

#[test]
fn a_small_texture_reads_well() {
    let shader = emit(&marble(), &Options::default());
    assert_valid(&shader.source);
    let expected = "\
/// Where a pixel lies in texture space: its centre at cell + uv, the change of uv to the next
/// pixel on the right (du) and below (dv).
struct Footprint {
    cell: vec2i,
    uv: vec2f,
    du: vec2f,
    dv: vec2f,
}

struct MarbleParameters {
    scale: f32,
}

struct MarbleOutputs {
    base_color: vec3f,
}

struct MarbleOctave {
    mean: f32,
    slope: f32,
}

/// One octave of something.
fn marble_octave(index: u32, mean: f32, slope: f32, x: f32) -> MarbleOctave {
    let t_a = sin(x * f32(index));
    return MarbleOctave(mean + t_a, slope * t_a);
}

/// A detail.
fn marble_fine(index: u32, state: f32) -> f32 {
    return state * 0.5;
}

/// The whole texture.
fn marble(footprint: Footprint, parameters: MarbleParameters) -> MarbleOutputs {
    let t_a = footprint.uv.x * parameters.scale;
    var swirl = MarbleOctave(0.0, 1.0);
    for (var i = 0u; i < 5u; i++) {
        swirl = marble_octave(i, swirl.mean, swirl.slope, t_a);
    }
    var fine = swirl.mean;
    if footprint.du.x < parameters.scale {
        fine = marble_fine(0u, fine);
    }
    let veins = fine - (swirl.slope - t_a);
    return MarbleOutputs(vec3f(veins, veins * 0.5, 1.0));
}
";
    assert_eq!(shader.source, expected);
    assert_eq!(
        (shader.parameters[0].offset, shader.parameters_size),
        (0, 16)
    );
}

#[test]
fn parameters_have_the_uniform_layout_and_outputs_may_be_of_any_type() {
    let b = &entry("kinds");
    let (_, [_, v, ..]) = footprint(b);
    let on = b.param::<bool>("on");
    let tint = b.float_params(["r", "g", "b"]);
    let steps = b.int_param("steps");
    let [_, y] = b.float_params(["x", "y"]);
    b.result("steps", steps.max(i32::MIN));
    b.result("on", on);
    for value in [on.select(tint[0], y), tint[1], tint[2], v] {
        b.result("tint", value);
    }
    (0..6).for_each(|_| b.result("variance", b.float(0.0)));
    let mut module = Module::default();
    b.finish(&mut module);
    let parameters = vec![
        port("on", GraphType::Boolean),
        port("tint", GraphType::Color3),
        port("int", GraphType::Integer),
        port("warp", GraphType::Vector2),
    ];
    let outputs = vec![
        port("steps", GraphType::Integer),
        port("on", GraphType::Boolean),
        port("Base Color", GraphType::Color4),
    ];
    let interface = Interface {
        moments: true,
        position: false,
        ..interface("float", parameters, outputs)
    };
    let program = Program { module, interface };
    for entry in [Entry::None, Entry::Fragment, Entry::Compute] {
        let shader = emit(&program, &entry.into());
        assert_valid(&shader.source);
        assert_eq!(shader.function, "float_value");
        let offsets: Vec<u32> = shader.parameters.iter().map(|p| p.offset).collect();
        assert_eq!((offsets, shader.parameters_size), (vec![0, 16, 28, 32], 48));
        assert_eq!(shader.parameters[2].field, "int_value");
        assert_eq!(shader.scalars_per_pixel(), 12);
        assert!(shader.source.contains("Base_Color_variance: vec4f"));
        // naga computes the layout by itself.
        let module = validate(&shader.source).unwrap().module;
        let members = module.types.iter().find_map(|(_, ty)| match &ty.inner {
            naga::TypeInner::Struct { members, span }
                if ty.name.as_deref() == Some("FloatParameters") =>
            {
                Some((members.iter().map(|m| m.offset).collect::<Vec<_>>(), *span))
            }
            _ => None,
        });
        assert_eq!(members, Some((vec![0, 16, 28, 32], 48)));
        let bytes = shader.pack_parameters(&[1.0, 0.1, 0.2, 0.3, -7.0, 0.5, 0.25]);
        assert_eq!(bytes[0..4], 1_u32.to_le_bytes());
        assert_eq!(bytes[28..32], (-7_i32).to_le_bytes());
        assert_eq!(bytes[36..40], 0.25_f32.to_le_bytes());
    }
}

#[test]
fn tables_become_one_buffer_and_loads_stay_inside() {
    let mut module = Module::default();
    let first = module.table("first", vec![1.0, 2.0]);
    let second = module.table("second", vec![3.0, 4.0, 5.0]);
    let b = &entry("ramp");
    let ([cell, _], _) = footprint(b);
    let places = [
        (first, cell.to_uint()),
        (second, cell.to_uint()),
        (second, b.uint(9)),
    ];
    for (table, index) in places {
        b.result("value", b.load(table, index));
    }
    let program = program(b, module, "ramp", vec![port("value", GraphType::Vector3)]);
    let shader = emit(&program, &Entry::Compute.into());
    assert_valid(&shader.source);
    assert!(
        shader.source.contains("ramp_tables[min(t_a, 1u)]"),
        "{}",
        shader.source
    );
    assert!(shader.source.contains("ramp_tables[2u + min(t_a, 2u)]"));
    assert!(shader.source.contains("ramp_tables[4u]"));
    assert_eq!(shader.tables.unwrap().data(), [1.0, 2.0, 3.0, 4.0, 5.0]);
    assert!(!shader.source.contains("parameters"), "there are none");
}

#[test]
fn hostile_names_are_made_safe_and_unique() {
    let b = &entry("entry");
    let (_, [u, v, du, ..]) = footprint(b);
    let mut last = u;
    for name in [
        "let",
        "fn",
        "float",
        "t_a",
        "t_b",
        "p_a",
        "layer_1",
        "color2",
        "i",
        "args",
        "footprint",
        "parameters",
        "main",
        "möbius",
        "мир",
        "texture",
        "texture_tables",
        "texture_value",
        "select",
        "min",
        "lerp",
        "a__b",
    ] {
        last = (last * v).min(du);
        b.name(last, name);
    }
    b.result("texture", last);
    let outputs = vec![port("texture", GraphType::Float)];
    let program = program(b, Module::default(), "texture", outputs);
    for entry in [Entry::Fragment, Entry::Compute] {
        let shader = emit(&program, &entry.into());
        assert_valid(&shader.source);
        assert!(!shader.source.contains("__"), "{}", shader.source);
    }
}

#[test]
fn a_graph_may_be_called_as_what_the_entry_points_hold() {
    for name in [
        "footprint",
        "position",
        "parameters",
        "outputs",
        "index",
        "first",
        "id",
        "uv",
        "xyz",
    ] {
        let b = &entry("entry");
        let (_, [u, ..]) = footprint(b);
        b.result("value", u);
        let outputs = vec![port("value", GraphType::Float)];
        let program = program(b, Module::default(), name, outputs);
        for entry in [Entry::None, Entry::Fragment, Entry::Compute] {
            let shader = emit(&program, &entry.into());
            assert_valid(&shader.source);
            let function = format!("fn {name}_value(footprint: Footprint");
            assert!(shader.source.contains(&function), "{}", shader.source);
        }
    }
}

/// A pseudo-random function of many instructions over everything that came before.
fn long_program(instructions: usize, seed: u32, near: u32) -> Program {
    let mut module = Module::default();
    let h = &Builder::new("helper", "A helper.");
    let [x, y] = h.float_params(["x", "y"]);
    h.result("sum", x + y);
    h.result("product", x * y);
    let helper = h.finish(&mut module);
    let b = &entry("long");
    let mut values = footprint(b).1.to_vec();
    let mut state = seed;
    let mut random = |below: u32| {
        state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
        (state >> 8) % below
    };
    for _ in 0..instructions {
        let count = values.len() as u32;
        let mut pick = || values[(count - 1 - random(count.min(near))) as usize];
        let (a, c) = (pick(), pick());
        let value = match random(20) {
            0..8 => a + c,
            8..15 => a * c,
            15..17 => a.sin(),
            17..19 => a - c,
            _ => b.call(&helper, [a, c])[random(2) as usize],
        };
        values.push(value);
    }
    // Everything counts, so nothing is dead.
    let late = &values[values.len() - values.len() / 2..];
    b.result(
        "sum",
        late.iter().fold(values[0], |sum, &value| sum + value),
    );
    program(b, module, "long", vec![port("sum", GraphType::Float)])
}

/// The most statements and braces between `fn` and the closing brace; a statement may have several
/// lines.
fn longest_function(source: &str) -> usize {
    let (mut longest, mut count) = (0, 0);
    for line in source.lines() {
        if line.starts_with("fn ") {
            count = 0;
        }
        count += usize::from(line.ends_with([';', '{', '}']));
        longest = longest.max(count);
    }
    longest
}

#[test]
fn long_functions_are_split_into_short_ones_that_validate() {
    // Local graphs, and the worst case, where everything reads anything before it.
    for near in [40, 20_000] {
        let program = long_program(20_000, 7, near);
        assert!(program.module.entry().insts.len() > 20_000);
        let options = Options::from(Entry::Compute);
        let shader = emit(&program, &options);
        assert_valid(&shader.source);
        let longest = longest_function(&shader.source);
        assert!(longest <= 200, "{longest} statements in a function");
        assert_eq!(shader, emit(&program, &options));
    }
}

#[test]
fn functions_of_many_parameters_take_them_packed() {
    let mut module = Module::default();
    let h = &Builder::new("many", "Many parameters.");
    h.result(
        "sum",
        h.sum((0..300).map(|i| h.float_param(format!("x_{i}")))),
    );
    let many = h.finish(&mut module);
    let b = &entry("caller");
    let (_, numbers) = footprint(b);
    let arguments: Vec<Float<'_>> = (0..300).map(|i| numbers[i % 6]).collect();
    b.result("sum", b.call(&many, arguments)[0]);
    let program = program(b, module, "caller", vec![port("sum", GraphType::Float)]);
    let shader = emit(&program, &Options::default());
    assert_valid(&shader.source);
    assert!(shader.source.contains("args: CallerManyArgs"));
}

#[test]
fn constants_that_do_not_evaluate_are_left_to_run_time() {
    let b = &entry("pole");
    footprint(b);
    b.result("pole", b.float(1.0) / 0.0);
    let outputs = vec![port("pole", GraphType::Float)];
    let program = program(b, Module::default(), "pole", outputs);
    assert_valid(&emit(&program, &Options::default()).source);
}

proptest! {
    #[test]
    fn random_programs_are_valid(program in crate::ir::random::program()) {
        for entry in [Entry::None, Entry::Fragment, Entry::Compute] {
            let shader = emit(&program, &entry.into());
            if let Err(error) = validate(&shader.source) {
                prop_assert!(false, "{}\n{}", error, shader.source);
            }
        }
    }
}

/// Every identifier of a text.
fn identifiers(text: &str) -> impl Iterator<Item = &str> {
    text.split(|c: char| !c.is_ascii_alphanumeric() && c != '_')
        .filter(|word| word.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_'))
}

#[test]
fn two_textures_stand_in_one_module_at_bindings_of_their_own() {
    let shader = |name: &str, binding: u32| {
        let mut module = Module::default();
        let table = module.table("ramp", vec![1.0, 2.0]);
        let b = &entry("entry");
        let (_, [u, ..]) = footprint(b);
        b.result("value", b.load(table, u.abs().to_int().to_uint()));
        let program = program(b, module, name, vec![port("value", GraphType::Float)]);
        let options = Options {
            group: 2,
            binding,
            shared_footprint: true,
            ..Options::default()
        };
        emit(&program, &options)
    };
    let [one, two] = [shader("one", 4), shader("two", 9)];
    assert_valid(&format!("{}{}{}", *DECLARATIONS, one.source, two.source));
    assert_eq!((one.bindings[0].group, one.bindings[0].binding), (2, 7));
    assert!(
        two.source
            .contains("@group(2) @binding(12) var<storage, read>")
    );
    assert!(!one.source.contains("struct Footprint"));
    assert!(identifiers(&one.source).any(|word| word == "one_tables"));
}
