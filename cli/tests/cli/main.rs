//! The command as people and scripts see it: exit statuses, files, standard streams.

mod audit;
mod bad_graphs;
mod bakes;
mod builds;
mod documents;
mod folder;
mod images;
mod light;
mod names;
mod overwrite;
mod serve;

use folder::{Folder, GRAPH, Run};
use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::Stdio;
use std::time::Duration;

const SMALL: &str = "--size 24x16 --device cpu";

#[test]
fn pictures_are_the_same_to_the_bit() {
    let folder = Folder::new();
    for view in ["plane", "flat", "sphere"] {
        let render = |name: &str, threads: &str| {
            let line =
                format!("render marble.json -o {name} --output base_color --view {view} {SMALL}");
            let output = folder
                .command(&line)
                .env("RAYON_NUM_THREADS", threads)
                .output();
            Run::new(&line, output.expect("the command starts"), Duration::ZERO)
                .is(0)
                .says("24×16")
                .says("method auto, CPU");
            folder.read(name)
        };
        for extension in ["png", "exr"] {
            let first = render(&format!("a.{extension}"), "1");
            assert_eq!(
                first,
                render(&format!("b.{extension}"), "3"),
                "{view} {extension}"
            );
        }
        let picture = image::load_from_memory(&folder.read("a.png")).expect("a PNG");
        assert_eq!((picture.width(), picture.height()), (24, 16));
        let colours: std::collections::BTreeSet<_> =
            picture.to_rgb8().pixels().map(|p| p.0).collect();
        assert!(colours.len() > 20, "{view}: {} colours", colours.len());
    }
}

#[test]
fn bits_settings_and_methods_matter() {
    let folder = Folder::new();
    let render = |more: &str| {
        let line = format!("render marble.json -o a.png --output base_color {SMALL} {more}");
        folder.run(&line).is(0);
        folder.read("a.png")
    };
    let plain = render("");
    assert_eq!(
        plain,
        render("--method auto --pixel-filter gaussian:0.5 --set scale=4 --bits 8")
    );
    for more in [
        "--set scale=8",
        "--set tint=#ff0000",
        "--set tint=1,0.5,0",
        "--bits 16",
        "--method point",
        "--method supersample:4",
        "--pixel-filter gaussian:2",
        "--view flat --window -1,-1,3,3",
    ] {
        assert_ne!(plain, render(more), "{more}");
    }
    let sixteen = image::load_from_memory(&render("--bits 16")).expect("a PNG");
    assert_eq!(sixteen.color(), image::ColorType::Rgb16);
}

#[test]
fn moments_have_their_channels() {
    let folder = Folder::new();
    let read = |method: &str, output: &str| {
        let line = format!(
            "render marble.json -o a.png --moments m.exr --output {output} --method {method} \
             --view flat --window 0,0,8,8 {SMALL}"
        );
        folder.run(&line).is(0).says("m.exr");
        let image = exr::prelude::read_first_flat_layer_from_file(folder.path("m.exr"));
        let channels = image.expect("an EXR").layer_data.channel_data.list;
        let numbers = |c: &exr::prelude::AnyChannel<exr::prelude::FlatSamples>| {
            (
                c.name.to_string(),
                c.sample_data.values_as_f32().collect::<Vec<f32>>(),
            )
        };
        channels.iter().map(numbers).collect::<Vec<_>>()
    };
    let names = |found: &[(String, Vec<f32>)]| {
        found
            .iter()
            .map(|(name, _)| name.clone())
            .collect::<Vec<_>>()
            .join(" ")
    };
    let auto = read("auto", "base_color");
    assert_eq!(
        names(&auto),
        "mean.B mean.G mean.R variance.B variance.G variance.R"
    );
    assert!(
        auto[5].1.iter().any(|&v| v > 1e-4),
        "a footprint has a variance"
    );
    let point = read("point", "height");
    assert_eq!(names(&point), "mean.Y variance.Y");
    assert!(point[1].1.iter().all(|&v| v == 0.0), "a point has none");
    let sampled = read("supersample:64", "height");
    assert!(sampled[1].1.iter().all(|&v| v >= 0.0) && sampled[1].1.iter().any(|&v| v > 1e-4));
}

#[test]
fn wrong_usage_is_told_and_writes_nothing() {
    let folder = Folder::new();
    folder.write(
        "one.json",
        GRAPH.replace(r#", "height": { "node": "noise" }"#, ""),
    );
    fs::create_dir(folder.path("taken.png")).expect("a folder");
    let before = folder.files();
    for (line, text) in [
        ("", "Usage"),
        ("rendr", "render"),
        ("render one.json", "--out"),
        ("render missing.json -o a.png", "missing.json"),
        ("render one.json -o a.jpeg", ".png or .exr"),
        ("render one.json -o no/such/a.png", "no/such/a.png"),
        ("render one.json -o taken.png", "folder"),
        ("render one.json -o a.png --size 0x5", "--size"),
        ("render one.json -o a.png --size 9999999x5", "1048576"),
        (
            "render one.json -o a.png --set scal=3",
            "did you mean `scale`",
        ),
        ("render one.json -o a.png --set scale=1000", "0.5"),
        ("render one.json -o a.png --set scale=nan", "a number"),
        ("render one.json -o a.png --set scale", "INPUT=VALUE"),
        ("render one.json -o a.png --set tint=#12", "#rrggbb"),
        ("render one.json -o a.png --output color", "`base_color`"),
        ("render marble.json -o a.png", "`base_color`, `height`"),
        ("render one.json -o a.png --method trilinear", "split:4"),
        (
            "render one.json -o a.png --method supersample:0",
            "supersample:N",
        ),
        (
            "render one.json -o a.png --method local --tolerance 0.1",
            "--method",
        ),
        ("render one.json -o a.png --tolerance=-1", "above 0"),
        (
            "render one.json -o a.png --pixel-filter tent",
            "gaussian:SD",
        ),
        ("render one.json -o a.png --window 0,0,1,1", "--view flat"),
        (
            "render one.json -o a.png --view flat --window 0,0,0,1",
            "no area",
        ),
        ("render one.json -o a.png --bits 12", "16"),
        ("render one.json -o a.png --moments m.png", ".exr"),
        ("render one.json -o a.exr --moments a.exr", "same file"),
        ("compile one.json --out shaders --target cuda", "wgsl"),
        (
            "compile one.json --out shaders --target spirv --entry none",
            "entry point",
        ),
        ("compile one.json --out one.json", "no folder"),
        ("compile missing.json --out shaders", "missing.json"),
        ("check missing.json", "missing.json"),
        ("trade one.json --out one.json", "no folder"),
        ("compare one.json -o a.tiff", ".png"),
        ("nodes noize2d", "did you mean `noise2d`"),
        ("nodes fbm", "fractal2d"),
        ("new one.json", "exists"),
        ("new no/such/graph.json", "no/such"),
        ("completions tcsh", "bash"),
    ] {
        folder.run(line).is(2).says(text);
        assert_eq!(folder.files(), before, "{line}");
    }
}

#[test]
fn shaders_for_every_target() {
    let folder = Folder::new();
    folder
        .run("compile marble.json --out shaders --target wgsl,spirv,glsl,hlsl,msl")
        .is(0)
        .says("shaders/marble.wgsl");
    let shader = |name: &str| folder.read(&format!("shaders/{name}"));
    let wgsl = String::from_utf8(shader("marble.wgsl")).expect("text");
    assert!(wgsl.contains("fn marble(footprint: Footprint, parameters: MarbleParameters)"));
    assert_eq!(shader("marble.spv")[..4], 0x0723_0203u32.to_le_bytes());
    for name in ["marble.frag", "marble.hlsl", "marble.metal"] {
        assert!(shader(name).len() > 500, "{name}");
    }
    let manifest: Value =
        serde_json::from_slice(&shader("marble.json")).expect("the manifest is JSON");
    assert_eq!(manifest["function"], "marble");
    assert_eq!(manifest["entry_point"]["stage"], "fragment");
    assert_eq!(manifest["parameters"][0]["name"], "scale");
    assert_eq!(manifest["parameters"][0]["max"], 64.0);
    assert_eq!(manifest["files"]["spirv"], "marble.spv");

    folder.run("compile marble.json --out plain").is(0);
    let names: Vec<_> = fs::read_dir(folder.path("plain"))
        .expect("the folder")
        .map(|entry| entry.expect("an entry").file_name())
        .collect();
    assert_eq!(names.len(), 2, "{names:?}");
    let again = folder.read("plain/marble.wgsl");
    folder.run("compile marble.json --out plain").is(0);
    assert_eq!(
        again,
        folder.read("plain/marble.wgsl"),
        "the same graph, the same bytes"
    );

    folder
        .run("compile marble.json --out compute --entry compute --target glsl,wgsl")
        .is(0);
    assert!(folder.path("compute/marble.comp").is_file());
    folder
        .run("compile marble.json --out .")
        .is(2)
        .says("would replace a file that is read");
    assert_eq!(folder.read("marble.json"), GRAPH.as_bytes());
}

#[test]
fn of_several_inputs_the_worst_counts_and_all_are_processed() {
    let folder = Folder::new();
    folder.write("bad.json", "{");
    folder.write("other.json", GRAPH.replace("\"marble\"", "\"other\""));
    folder
        .run("check bad.json marble.json")
        .is(1)
        .says("bad.json");
    let run = folder.run("check marble.json other.json").is(0);
    assert!(
        run.out.contains("other.json") && run.out.contains("noise2d"),
        "{}",
        run.out
    );
    folder
        .run("check missing.json bad.json")
        .is(2)
        .says("missing.json")
        .says("bad.json");
    folder
        .run("compile bad.json marble.json missing.json other.json --out shaders")
        .is(2)
        .says("bad.json")
        .says("missing.json");
    assert!(folder.path("shaders/marble.wgsl").is_file());
    assert!(folder.path("shaders/other.wgsl").is_file());
    folder.write("twin.json", GRAPH);
    folder
        .run("compile marble.json twin.json --out twins")
        .is(2)
        .says("would both write");
}

#[test]
fn every_verb_speaks_json() {
    let folder = Folder::new();
    folder.write("bad.json", GRAPH.replace("noise2d", "noize2d"));
    let check = folder.run("check --json marble.json").is(0).json();
    assert_eq!(check["diagnostics"], Value::Array(Vec::new()));
    assert_eq!(check["signals"].as_array().map(Vec::len), Some(3));
    assert_eq!(
        folder.run("check bad.json --json").is(1).codes()[0],
        "unknown-node-type"
    );
    assert_eq!(
        folder.run("check missing.json --json").is(2).codes(),
        ["unreadable-file"]
    );
    assert_eq!(folder.run("render --json").is(2).codes(), ["usage"]);
    let line = format!("render marble.json -o a.png --output height {SMALL} --json");
    let render = folder.run(&line).is(0).json();
    assert_eq!(render["method"], "auto");
    assert_eq!(render["files"][0], "a.png");
    let line = format!("{line} --set scale=x");
    assert_eq!(folder.run(&line).is(2).codes(), ["bad-setting"]);
    let compile = folder
        .run("compile marble.json --out shaders --json")
        .is(0)
        .json();
    assert_eq!(compile["compiled"][0]["manifest"]["function"], "marble");
    let nodes = folder.run("nodes --json").is(0).json();
    assert!(nodes["nodes"]["noise2d"]["inputs"]["frequency"].is_object());
    assert_eq!(
        folder.run("nodes zzz --json").is(2).codes(),
        ["unknown-node-type"]
    );
    assert!(folder.run("schema --json").is(0).json()["schema"].is_object());
    assert!(folder.run("completions bash --json").is(0).json()["script"].is_string());
    assert_eq!(
        folder.run("new start.json --json").is(0).json()["files"][0],
        "start.json"
    );
}

#[test]
fn a_new_graph_is_a_good_start() {
    let folder = Folder::new();
    folder.run("new my-clouds.json").is(0);
    let check = folder.run("check my-clouds.json").is(0);
    assert_eq!(check.err, "");
    assert!(check.out.contains("gaussian"), "{}", check.out);
    folder
        .run(&format!(
            "render my-clouds.json -o a.png {SMALL} --set scale=8"
        ))
        .is(0);
    let text = String::from_utf8(folder.read("my-clouds.json")).expect("text");
    assert!(text.contains("mipless render my-clouds.json"), "{text}");
}

#[test]
fn tolerances_and_budgets_choose_the_method() {
    let folder = Folder::new();
    let render = |more: &str| {
        let line = format!(
            "render marble.json -o a.png --output height --view flat --window 0,0,2,2 {SMALL} \
             --json {more}"
        );
        folder.run(&line).is(0).json()
    };
    let easy = render("--tolerance 0.5");
    assert_eq!(easy["diagnostics"], Value::Array(Vec::new()));
    assert!(easy["plan"]["error"].as_f64() <= Some(0.5), "{easy}");
    assert_eq!(easy["method"], easy["plan"]["method"]);
    let measured = easy["plan"]["measured"].as_array().expect("measurements");
    assert_eq!(measured.len(), 9);
    let cheap = render("--budget 0.001");
    assert_eq!(cheap["diagnostics"][0]["code"], "budget-missed");
    assert_eq!(cheap["diagnostics"][0]["severity"], "warning");
}

#[test]
fn comparisons_and_trades_are_written() {
    let folder = Folder::new();
    let line = "compare marble.json -o c.png --output base_color --size 48x27 --device cpu";
    folder
        .run(line)
        .is(0)
        .says("point error")
        .says("auto error")
        .says("truth");
    let sheet = image::load_from_memory(&folder.read("c.png")).expect("a PNG");
    assert_eq!(sheet.width(), 3 * 48 + 4 * 8);

    let line = "trade marble.json --out t --output height --size 32x18 --device cpu";
    let run = folder.run(line).is(0).says("trade.png");
    assert!(run.out.contains("supersample:256"), "{}", run.out);
    let trade: Value = serde_json::from_slice(&folder.read("t/trade.json")).expect("JSON");
    let methods = trade["methods"].as_array().expect("methods");
    assert_eq!(methods.len(), 14);
    let of = |name: &str, key: &str| {
        let found = methods
            .iter()
            .find(|m| m["method"] == name)
            .expect("the method");
        found[key].as_f64().expect("a number")
    };
    assert_eq!(of("point", "cost"), 1.0);
    assert!(of("supersample:256", "cost") > of("supersample:4", "cost"));
    assert!(of("supersample:256", "error") < of("point", "error"));
    assert!(trade["noise_floor"].as_f64() > Some(0.0));
    image::load_from_memory(&folder.read("t/trade.png")).expect("a PNG");
}

#[test]
fn output_is_for_people_and_pipes() {
    let folder = Folder::new();
    let list = folder.run("nodes").is(0).out;
    assert!(
        list.contains("noise\n") && list.contains("  noise2d"),
        "{list}"
    );
    let page = folder.run("nodes noise2d").is(0).out;
    assert!(
        page.starts_with("# noise2d") && page.contains("frequency"),
        "{page}"
    );
    let schema = folder.run("schema").is(0).out;
    assert!(
        serde_json::from_str::<Value>(&schema)
            .expect("JSON")
            .is_object()
    );
    for shell in ["bash", "elvish", "fish", "powershell", "zsh"] {
        assert!(
            folder
                .run(&format!("completions {shell}"))
                .is(0)
                .out
                .contains("mipless")
        );
    }
    assert!(folder.run("--help").is(0).out.contains("trade"));
    assert!(
        folder
            .run("render --help")
            .is(0)
            .out
            .contains("--tolerance")
    );
    assert!(folder.run("--version").is(0).out.starts_with("mipless "));
}

#[test]
fn standard_input_is_a_graph_too() {
    let folder = Folder::new();
    let graph = fs::File::open(folder.path("marble.json")).expect("the graph");
    let mut command = folder.command("check -");
    let output = command.stdin(graph).output().expect("the command starts");
    let run = Run::new("check -", output, Duration::ZERO).is(0);
    assert!(run.out.contains("noise2d"), "{}", run.out);
}

#[cfg(unix)]
#[test]
fn a_reader_that_goes_away_is_no_mistake() {
    let folder = Folder::new();
    for line in [
        "schema",
        "nodes",
        "check marble.json --json",
        "completions bash",
        "--help",
    ] {
        let mut command = folder.command(line);
        let mut child = command
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("a child");
        drop(child.stdout.take());
        let output = child.wait_with_output().expect("the child ends");
        Run::new(line, output, Duration::ZERO).is(0);
    }
    let full = Path::new("/dev/full");
    if full.exists() {
        let target = fs::OpenOptions::new()
            .write(true)
            .open(full)
            .expect("the device");
        let output = folder
            .command("schema")
            .stdout(target)
            .output()
            .expect("a child");
        Run::new("schema > /dev/full", output, Duration::ZERO)
            .is(2)
            .says("cannot be written");
    }
}
