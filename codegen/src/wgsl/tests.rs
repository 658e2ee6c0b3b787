//! Tests of the emitted text.

use super::{Entry, Options, emit};
use crate::ir::{Builder, FOOTPRINT, Interface, Module, Port, Program, Type, Value};
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

/// A builder of an entry with the footprint's parameters.
fn entry(name: &str) -> (Builder, Vec<Value>) {
    let mut b = Builder::new(name, "The whole texture.");
    let footprint = FOOTPRINT
        .iter()
        .map(|&(name, ty)| b.param(name, ty))
        .collect();
    (b, footprint)
}

/// A texture with a helper, a loop, an `if` and a parameter.
fn marble() -> Program {
    let mut module = Module::default();
    let mut b = Builder::new("octave", "One octave of something.");
    let index = b.param("index", Type::U32);
    let (mean, slope) = (b.param_f32("mean"), b.param_f32("slope"));
    let x = b.param_f32("x");
    let turn = b.float_u(index);
    let phase = b.mul(turn, x);
    let wave = b.sin(phase);
    let mean = b.add(mean, wave);
    let slope = b.mul(slope, wave);
    b.result("mean", mean);
    b.result("slope", slope);
    let octave = b.finish(&mut module);

    let mut b = Builder::new("fine", "A detail.");
    b.param("index", Type::U32);
    let state = b.param_f32("state");
    let next = b.scale(state, 0.5);
    b.result("state", next);
    let fine = b.finish(&mut module);

    let (mut b, footprint) = entry("marble");
    let scale = b.param_f32("scale");
    let x = b.mul(footprint[2], scale);
    let (count, zero, one) = (b.u32(5), b.f32(0.0), b.f32(1.0));
    let swirl = b.fold(&octave, count, &[zero, one], &[x]);
    b.name(swirl[0], "swirl_mean");
    b.name(swirl[1], "swirl_slope");
    let far = b.lt(footprint[4], scale);
    let (once, never) = (b.u32(1), b.u32(0));
    let times = b.select(far, once, never);
    let detail = b.fold(&fine, times, &[swirl[0]], &[]);
    let sum = b.sub(swirl[1], x);
    let sum = b.sub(detail[0], sum);
    b.name(sum, "veins");
    let half = b.scale(sum, 0.5);
    b.result("r", sum);
    b.result("g", half);
    b.result("b", one);
    b.finish(&mut module);
    let parameters = vec![Port {
        default: vec![6.0],
        ..port("scale", GraphType::Float)
    }];
    let outputs = vec![port("base_color", GraphType::Color3)];
    Program {
        module,
        interface: interface("marble", parameters, outputs),
    }
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
    let t1 = sin(x * f32(index));
    return MarbleOctave(mean + t1, slope * t1);
}

/// A detail.
fn marble_fine(index: u32, state: f32) -> f32 {
    return state * 0.5;
}

/// The whole texture.
fn marble(footprint: Footprint, parameters: MarbleParameters) -> MarbleOutputs {
    let t1 = footprint.uv.x * parameters.scale;
    var swirl = MarbleOctave(0.0, 1.0);
    for (var i = 0u; i < 5u; i++) {
        swirl = marble_octave(i, swirl.mean, swirl.slope, t1);
    }
    var fine = swirl.mean;
    if footprint.du.x < parameters.scale {
        fine = marble_fine(0u, fine);
    }
    let veins = fine - (swirl.slope - t1);
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
    let (mut b, footprint) = entry("kinds");
    let on = b.param("on", Type::Bool);
    let tint = ["r", "g", "b"].map(|n| b.param_f32(n));
    let steps = b.param("steps", Type::I32);
    let warp = ["x", "y"].map(|n| b.param_f32(n));
    let least = b.i32(i32::MIN);
    let steps = b.max_i(steps, least);
    let red = b.select(on, tint[0], warp[1]);
    b.result("steps", steps);
    b.result("on", on);
    for value in [red, tint[1], tint[2], footprint[3]] {
        b.result("tint", value);
    }
    let zero = b.f32(0.0);
    (0..6).for_each(|_| b.result("variance", zero));
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
        let shader = emit(&program, &Options { entry });
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
    let (mut b, footprint) = entry("ramp");
    let (cell, far) = (b.cast_u(footprint[0]), b.u32(9));
    let loads = [
        b.load(first, cell),
        b.load(second, cell),
        b.load(second, far),
    ];
    loads.iter().for_each(|&v| b.result("value", v));
    b.finish(&mut module);
    let outputs = vec![port("value", GraphType::Vector3)];
    let program = Program {
        module,
        interface: interface("ramp", Vec::new(), outputs),
    };
    let shader = emit(
        &program,
        &Options {
            entry: Entry::Compute,
        },
    );
    assert_valid(&shader.source);
    assert!(
        shader.source.contains("ramp_tables[min(t1, 1u)]"),
        "{}",
        shader.source
    );
    assert!(shader.source.contains("ramp_tables[2u + min(t1, 2u)]"));
    assert!(shader.source.contains("ramp_tables[4u]"));
    assert_eq!(shader.tables.unwrap().data(), [1.0, 2.0, 3.0, 4.0, 5.0]);
    assert!(!shader.source.contains("parameters"), "there are none");
}

#[test]
fn hostile_names_are_made_safe_and_unique() {
    let (mut b, footprint) = entry("entry");
    let mut last = footprint[2];
    for name in [
        "let",
        "fn",
        "float",
        "t1",
        "t2",
        "p1",
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
        let y = b.mul(last, footprint[3]);
        last = b.min(y, footprint[4]);
        b.name(last, name);
    }
    b.result("texture", last);
    let mut module = Module::default();
    b.finish(&mut module);
    let outputs = vec![port("texture", GraphType::Float)];
    let program = Program {
        module,
        interface: interface("texture", Vec::new(), outputs),
    };
    for entry in [Entry::Fragment, Entry::Compute] {
        let shader = emit(&program, &Options { entry });
        assert_valid(&shader.source);
        assert!(!shader.source.contains("__"), "{}", shader.source);
    }
}

/// A pseudo-random function of many instructions over everything that came before.
fn long_program(instructions: usize, seed: u32, near: u32) -> Program {
    let mut module = Module::default();
    let mut h = Builder::new("helper", "A helper.");
    let (x, y) = (h.param_f32("x"), h.param_f32("y"));
    let (sum, product) = (h.add(x, y), h.mul(x, y));
    h.result("sum", sum);
    h.result("product", product);
    let helper = h.finish(&mut module);
    let (mut b, footprint) = entry("long");
    let mut values = footprint[2..].to_vec();
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
            0..8 => b.add(a, c),
            8..15 => b.mul(a, c),
            15..17 => b.sin(a),
            17..19 => b.sub(a, c),
            _ => b.call(&helper, &[a, c])[random(2) as usize],
        };
        values.push(value);
    }
    // Everything counts, so nothing is dead.
    let mut sum = values[0];
    for &value in &values[values.len() - values.len() / 2..] {
        sum = b.add(sum, value);
    }
    b.result("sum", sum);
    b.finish(&mut module);
    let outputs = vec![port("sum", GraphType::Float)];
    Program {
        module,
        interface: interface("long", Vec::new(), outputs),
    }
}

/// The most lines between `fn` and the closing brace.
fn longest_function(source: &str) -> usize {
    let (mut longest, mut start) = (0, 0);
    for (number, line) in source.lines().enumerate() {
        if line.starts_with("fn ") {
            start = number;
        } else if line == "}" && start > 0 {
            longest = longest.max(number - start - 1);
            start = 0;
        }
    }
    longest
}

#[test]
fn long_functions_are_split_into_short_ones_that_validate() {
    // Local graphs, and the worst case, where everything reads anything before it.
    for near in [40, 20_000] {
        let program = long_program(20_000, 7, near);
        assert!(program.module.entry().insts.len() > 20_000);
        let options = Options {
            entry: Entry::Compute,
        };
        let shader = emit(&program, &options);
        assert_valid(&shader.source);
        let longest = longest_function(&shader.source);
        assert!(longest <= 200, "{longest} lines in a function");
        assert_eq!(shader, emit(&program, &options));
    }
}

#[test]
fn functions_of_many_parameters_take_them_packed() {
    let mut module = Module::default();
    let mut h = Builder::new("many", "Many parameters.");
    let params: Vec<_> = (0..300).map(|i| h.param_f32(format!("x_{i}"))).collect();
    let sum = params.iter().copied().reduce(|a, b| h.add(a, b)).unwrap();
    h.result("sum", sum);
    let many = h.finish(&mut module);
    let (mut b, footprint) = entry("caller");
    let arguments: Vec<_> = (0..300).map(|i| footprint[2 + i % 6]).collect();
    let sum = b.call(&many, &arguments)[0];
    b.result("sum", sum);
    b.finish(&mut module);
    let outputs = vec![port("sum", GraphType::Float)];
    let program = Program {
        module,
        interface: interface("caller", Vec::new(), outputs),
    };
    let shader = emit(&program, &Options::default());
    assert_valid(&shader.source);
    assert!(shader.source.contains("args: CallerManyArgs"));
}

#[test]
fn constants_that_do_not_evaluate_are_left_to_run_time() {
    let (mut b, _) = entry("pole");
    let (one, zero) = (b.f32(1.0), b.f32(0.0));
    let pole = b.div(one, zero);
    b.result("pole", pole);
    let mut module = Module::default();
    b.finish(&mut module);
    let outputs = vec![port("pole", GraphType::Float)];
    let program = Program {
        module,
        interface: interface("pole", Vec::new(), outputs),
    };
    assert_valid(&emit(&program, &Options::default()).source);
}

proptest! {
    #[test]
    fn random_programs_are_valid(program in crate::ir::random::program()) {
        for entry in [Entry::None, Entry::Fragment, Entry::Compute] {
            let shader = emit(&program, &Options { entry });
            if let Err(error) = validate(&shader.source) {
                prop_assert!(false, "{}\n{}", error, shader.source);
            }
        }
    }
}
