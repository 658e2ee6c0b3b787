//! Tests on whatever graphics adapter this machine has; they show as ignored where it has none.

use std::time::Duration;

use libtest_mimic::{Arguments, Trial};
use mipless_codegen::ir::{Builder, FOOTPRINT, Interface, Module, Port, Program, dot};
use mipless_codegen::wgsl::{Entry, emit};
use mipless_runtime::cpu::Renderer;
use mipless_runtime::gpu::{AdapterChoice, Gpu, GpuError};
use mipless_runtime::job::Job;
use mipless_runtime::metrics::difference;
use mipless_runtime::view::{Size, View};

fn main() {
    let none = matches!(Gpu::new(AdapterChoice::Any), Err(GpuError::NoAdapter(_)));
    let on_device = |name: &str, test: fn(&Gpu)| {
        let run = move || {
            test(&Gpu::new(AdapterChoice::Any)?);
            Ok(())
        };
        Trial::test(name, run).with_ignored_flag(none)
    };
    let automatic = || {
        automatic_choice_never_opens_a_software_adapter();
        Ok(())
    };
    let trials = vec![
        on_device("a_device_agrees_with_the_cpu", a_device_agrees_with_the_cpu),
        on_device("a_bad_shader_is_an_error", a_bad_shader_is_an_error),
        Trial::test("automatic_choice_never_opens_a_software_adapter", automatic),
    ];
    libtest_mimic::run(&Arguments::from_args(), trials).exit();
}

/// Waves that turn in a fold, a table read by cell, and an integer hash, over every footprint
/// number, with a parameter and moments.
fn program() -> Program {
    let mut module = Module::default();
    let table = module.table("steps", vec![0.25, -0.5, 1.0, 0.125, 0.75]);

    let b = &Builder::new("turn", "One turn.");
    let index = b.uint_param("index");
    let [x, y, angle] = ["x", "y", "angle"].map(|name| b.float_param(name));
    let angle = angle * index.to_float();
    let (sin, cos) = (angle.sin(), angle.cos());
    b.result("x", cos * x - sin * y);
    b.result("y", sin * x + cos * y);
    let turn = b.finish(&mut module);

    let b = &Builder::new("waves", "Waves.");
    let [cell_x, cell_y, numbers @ ..] = FOOTPRINT.map(|(name, ty)| b.scalar_param(name, ty));
    let [u, v, change @ ..] = numbers.map(|number| number.float());
    let frequency = b.float_param("frequency");
    let [x, y] = b.fold(&turn, b.uint(5), [u, v], frequency);
    let area = dot(change, change);
    let height = x / (area + 1.0);
    let [cell_x, cell_y] = [cell_x, cell_y].map(|cell| cell.int().to_uint());
    let hash = ((cell_x * 0x9e37_79b1) ^ cell_y) & 7;
    b.result("height", height);
    b.result("step_x", b.load(table, hash));
    b.result("step_y", y);
    b.result("height_variance", height.square());
    b.result("step_x_variance", area);
    b.result("step_y_variance", height.square());
    b.finish(&mut module);
    let port = |name: &str, ty, default: &[f32]| Port {
        name: name.into(),
        ty,
        default: default.to_vec(),
    };
    let interface = Interface {
        name: "waves".into(),
        parameters: vec![port("frequency", mipless_graph::Type::Float, &[0.5])],
        outputs: vec![
            port("height", mipless_graph::Type::Float, &[]),
            port("step", mipless_graph::Type::Vector2, &[]),
        ],
        moments: true,
        position: false,
    };
    Program { module, interface }
}

fn a_device_agrees_with_the_cpu(gpu: &Gpu) {
    let program = program();
    let pipeline = gpu.pipeline(&program).unwrap();
    let mut renderer = Renderer::<f32>::new(&program);
    // More pixels than the first chunk and than a row of the dispatch, and views with background.
    let size = Size::new(433, 331);
    for (name, frequency) in [("sphere", 0.5f32), ("plane", -1.75)] {
        let view = View::by_name(name).unwrap();
        gpu.set_parameters(&pipeline, &[frequency]).unwrap();
        renderer.set_parameters(&[frequency]);
        for _ in 0..3 {
            let (image, timing) = gpu.render(&pipeline, &view, size, Job::default()).unwrap();
            let expected = renderer.render(&view, size, None, Job::default()).unwrap();
            assert_eq!(image.names(), expected.names());
            let mask = view.mask(size);
            for (channel, name) in image.names().iter().enumerate() {
                let scale = expected.channels()[channel]
                    .iter()
                    .fold(1.0f32, |a, b| a.max(b.abs()));
                let pairs = image.channels()[channel]
                    .iter()
                    .zip(&expected.channels()[channel]);
                // Devices may round divisions and trigonometric functions less precisely.
                let worst = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
                assert!(worst <= 2e-5 * scale, "{name}: {worst:e} of {scale:e}");
            }
            assert!(difference(&image, &expected, Some(&mask)).rms.is_finite());
            let covered = mask.iter().filter(|&&covered| covered).count() as u64;
            assert_eq!(timing.footprints, covered);
            assert!(timing.best() > Duration::ZERO);
        }
    }
}

fn a_bad_shader_is_an_error(gpu: &Gpu) {
    let good = emit(&program(), &Entry::Compute.into());
    let broken = [
        ("fn ", "this is not WGSL "),
        ("id.x + id.y", "id.x + 1.5f"),
        ("fn waves_compute", "fn other"),
        ("@binding(2)", "@binding(7)"),
    ];
    for (from, to) in broken {
        let mut shader = good.clone();
        shader.source = good.source.replace(from, to);
        assert_ne!(shader.source, good.source, "{from}");
        let result = gpu.pipeline_of(shader);
        assert!(
            matches!(result, Err(GpuError::Validation(_))),
            "{to}: {result:?}"
        );
    }
    gpu.pipeline_of(good).unwrap();
}

fn automatic_choice_never_opens_a_software_adapter() {
    match Gpu::new(AdapterChoice::HardwareOnly) {
        Ok(gpu) => assert!(!gpu.report().software, "{}", gpu.report()),
        Err(error) => assert!(matches!(error, GpuError::NoAdapter(_)), "{error}"),
    }
}
