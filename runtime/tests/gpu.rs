//! Tests on whatever graphics adapter this machine has; they show as ignored where it has none.

use std::time::Duration;

use libtest_mimic::{Arguments, Trial};
use mipless_runtime::gpu::{AdapterChoice, ComputeShader, Gpu, GpuError};
use mipless_runtime::job::Job;
use mipless_runtime::view::{Size, Sphere, View};

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
        on_device(
            "a_device_evaluates_the_footprints_of_the_cpu",
            evaluates_the_footprints,
        ),
        on_device("a_bad_shader_is_an_error", a_bad_shader_is_an_error),
        Trial::test("automatic_choice_never_opens_a_software_adapter", automatic),
    ];
    libtest_mimic::run(&Arguments::from_args(), trials).exit();
}

const POSITION: &str = "
struct Footprint { cell: vec2i, uv: vec2f, du: vec2f, dv: vec2f }
@group(0) @binding(0) var<storage, read> footprints: array<Footprint>;
@group(0) @binding(1) var<uniform> scale: vec4f;
@group(0) @binding(2) var<storage, read_write> results: array<f32>;
@group(0) @binding(3) var<storage, read> tables: array<f32>;
@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let i = id.x;
    if i >= arrayLength(&footprints) { return; }
    let f = footprints[i];
    results[3 * i] = f32(f.cell.x) + f.uv.x;
    results[3 * i + 1] = scale.y * f.du.x;
    results[3 * i + 2] = f.dv.y + tables[1];
}";

fn shader(source: &str) -> ComputeShader<'_> {
    ComputeShader {
        source,
        entry: "main",
        workgroup: 64,
        results: ["a", "b", "c"].map(String::from).to_vec(),
        parameters: bytemuck::cast_slice(&[0.0f32, 2.0]).to_vec(),
        tables: vec![0.0, 0.5],
    }
}

fn evaluates_the_footprints(gpu: &Gpu) {
    let pipeline = gpu.pipeline(&shader(POSITION)).unwrap();
    // More pixels than the first chunk, and a view with a background.
    let (size, view) = (Size::new(233, 151), View::Sphere(Sphere::default()));
    for scale in [2.0f32, 3.0] {
        gpu.set_parameters(&pipeline, bytemuck::cast_slice(&[0.0f32, scale]))
            .unwrap();
        let (image, timing) = gpu.render(&pipeline, &view, size, Job::default()).unwrap();
        let mut covered = 0;
        for index in 0..size.pixels() {
            let got = [0, 1, 2].map(|c| image.channels()[c][index]);
            let Some(f) = view.footprint(size, index) else {
                assert_eq!(got, [0.0; 3]);
                continue;
            };
            covered += 1;
            assert_eq!(
                got,
                [f.cell[0] as f32 + f.uv[0], scale * f.du[0], f.dv[1] + 0.5]
            );
        }
        assert_eq!(timing.footprints, covered);
        assert!(timing.best() > Duration::ZERO);
    }
}

fn a_bad_shader_is_an_error(gpu: &Gpu) {
    let wrong_type = POSITION.replace("let i = id.x;", "let i = id.x + 1.0f;");
    let no_entry = POSITION.replace("fn main", "fn other");
    for source in ["this is not WGSL", &wrong_type, &no_entry] {
        let result = gpu.pipeline(&shader(source));
        assert!(matches!(result, Err(GpuError::Validation(_))), "{result:?}");
    }
    gpu.pipeline(&shader(POSITION)).unwrap();
}

fn automatic_choice_never_opens_a_software_adapter() {
    match Gpu::new(AdapterChoice::HardwareOnly) {
        Ok(gpu) => assert!(!gpu.report().software, "{}", gpu.report()),
        Err(error) => assert!(matches!(error, GpuError::NoAdapter(_)), "{error}"),
    }
}
