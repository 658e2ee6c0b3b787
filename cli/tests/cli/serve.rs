//! `mipless serve` as clients meet it, among them hostile ones.

use mipless::conformance::random::Random;
use serde_json::{Value, json};
use std::io::{self, BufRead, BufReader, Write};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::thread;

struct Client {
    child: Child,
    to: Option<ChildStdin>,
    from: BufReader<ChildStdout>,
}

impl Client {
    fn new(arguments: &[&str]) -> Self {
        let mut child = Command::new(env!("CARGO_BIN_EXE_mipless"))
            .arg("serve")
            .args(arguments)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .expect("the command starts");
        let to = child.stdin.take();
        let from = BufReader::new(child.stdout.take().expect("an output"));
        Self { child, to, from }
    }

    fn send(&mut self, text: &str) {
        let to = self.to.as_mut().expect("it is open");
        to.write_all(text.as_bytes()).expect("it reads");
        to.write_all(b"\n").expect("it reads");
    }

    fn read(&mut self) -> Value {
        let mut line = String::new();
        self.from.read_line(&mut line).expect("text");
        serde_json::from_str(&line).unwrap_or_else(|error| panic!("{line:?}: {error}"))
    }

    /// The answer to a call; what is sent without being asked for is kept.
    fn call(&mut self, method: &str, parameters: Value, more: &mut Vec<Value>) -> Value {
        let call =
            json!({ "jsonrpc": "2.0", "id": method, "method": method, "params": parameters });
        self.send(&call.to_string());
        loop {
            let message = self.read();
            if message["id"] == method {
                return message;
            }
            more.push(message);
        }
    }

    /// The most memory that the process has had, in KiB.
    fn memory(&self) -> Option<u64> {
        let path = format!("/proc/{}/status", self.child.id());
        let status = std::fs::read_to_string(path).ok()?;
        let line = status.lines().find(|line| line.starts_with("VmHWM"))?;
        line.split_whitespace().nth(1)?.parse().ok()
    }

    fn end(mut self) {
        drop(self.to.take());
        // Whatever is still being told: a pipe that nobody empties would hold the server up.
        io::copy(&mut self.from, &mut io::sink()).expect("bytes");
        let status = self.child.wait().expect("it ends");
        assert!(status.success(), "{status}");
    }
}

const CLOUDS: &str = r##"{ "version": 1, "name": "clouds",
    "inputs": { "scale": { "type": "float", "value": 4, "min": 0.5, "max": 64 } },
    "nodes": {
        "noise": { "type": "fractal2d", "inputs": { "frequency": { "input": "scale" } } },
        "color": { "type": "colorramp", "inputs": { "in": { "node": "noise" },
            "stops": [ { "at": -0.5, "value": "#2a5f9e" }, { "at": 0.5, "value": "#ffffff" } ] } } },
    "outputs": { "height": { "node": "noise" }, "base_color": { "node": "color" } } }"##;

#[test]
fn a_session_is_opened_edited_shown_and_saved() {
    let mut client = Client::new(&[]);
    let mut told = Vec::new();
    let told = &mut told;
    let opened = client.call(
        "session/open",
        json!({ "session": "a", "text": CLOUDS }),
        told,
    );
    assert_eq!(opened["result"]["diagnostics"], json!([]), "{opened}");
    let edit = json!({ "edit": "set_input", "input": "scale", "value": 8 });
    let change = client.call(
        "session/edit",
        json!({ "session": "a", "edit": edit }),
        told,
    );
    assert_eq!(change["result"]["parameters"], json!(["scale"]));
    assert_eq!(change["result"]["shaders"], json!([]));

    let render =
        json!({ "session": "a", "output": "base_color", "width": 32, "height": 16, "blocks": [8] });
    let picture = client.call("render", render, told);
    assert!(
        picture["result"]["data"]
            .as_str()
            .is_some_and(|data| data.starts_with("iVBORw0KGgo"))
    );
    let coarse = told.pop().expect("a coarse picture");
    assert_eq!(
        (&coarse["method"], &coarse["params"]["block"]),
        (&json!("picture"), &json!(8))
    );
    let render =
        json!({ "session": "a", "node": "noise", "width": 2, "height": 2, "format": "raw" });
    let picture = client.call("render", render, told);
    assert_eq!(picture["result"]["data"].as_str().map(str::len), Some(24));

    let shader = json!({ "session": "a", "output": "base_color", "entry": "fragment" });
    let shader = client.call("session/shader", shader, told);
    let source = shader["result"]["source"].as_str().expect("a text");
    assert!(source.contains("fn clouds(footprint"));

    // A mistake is told, and taken back.
    let watched = json!({ "session": "a", "output": "height", "width": 4, "height": 4 });
    client.call("watch", json!({ "watch": "w", "picture": watched }), told);
    let edit = json!({ "edit": "set", "node": "color", "input": "in", "value": "nonsense" });
    let change = client.call(
        "session/edit",
        json!({ "session": "a", "edit": edit }),
        told,
    );
    assert_eq!(
        change["result"]["broken"],
        json!(["base_color"]),
        "{change}"
    );
    assert!(
        told.iter()
            .any(|message| message["method"] == "diagnostics")
    );
    client.call("session/undo", json!({ "session": "a" }), told);
    let outputs = client.call("session/outputs", json!({ "session": "a" }), told);
    assert_eq!(outputs["result"]["outputs"][1]["is_current"], true);
    while !told.iter().any(|message| message["method"] == "preview") {
        told.push(client.read());
    }

    let saved = client.call("session/save", json!({ "session": "a" }), told);
    let saved = &saved["result"]["saved"];
    let again = client.call(
        "session/open",
        json!({ "session": "b", "saved": saved }),
        told,
    );
    assert_eq!(
        again["result"]["inputs"][0]["value"],
        json!([8.0]),
        "{again}"
    );
    let edit = json!({ "edit": "rename", "node": "nois", "to": "x" });
    let refused = client.call(
        "session/edit",
        json!({ "session": "b", "edit": edit }),
        told,
    );
    assert_eq!(
        refused["error"]["data"]["diagnostics"][0]["help"],
        "did you mean `noise`?"
    );
    let ended = client.call("shutdown", json!({}), told);
    assert_eq!(ended["result"], Value::Null);
    client.end();
}

#[test]
fn limits_are_kept_and_pictures_cancelled() {
    let mut client = Client::new(&[
        "--max-nodes",
        "3",
        "--max-pixels",
        "4194304",
        "--max-message",
        "2000",
    ]);
    let mut told = Vec::new();
    let told = &mut told;
    client.call(
        "session/open",
        json!({ "session": "a", "text": CLOUDS }),
        told,
    );
    let code = |answer: &Value| answer["error"]["code"].as_i64();
    let more = json!({ "edit": "duplicate", "nodes": ["noise", "color"] });
    let more = client.call(
        "session/edit",
        json!({ "session": "a", "edit": more }),
        told,
    );
    assert_eq!(code(&more), Some(-32002), "{more}");
    let text = client.call("session/text", json!({ "session": "a" }), told);
    assert!(
        !text["result"]["text"]
            .as_str()
            .expect("a text")
            .contains("noise_2")
    );
    client.send(&"x".repeat(5000));
    assert_eq!(client.read()["error"]["code"], -32600);
    let large = json!({ "session": "a", "output": "height", "width": 4000, "height": 4000 });
    assert_eq!(code(&client.call("render", large, told)), Some(-32002));

    // A large picture is stopped, and what follows is not held up.
    let render = json!({ "session": "a", "output": "base_color", "width": 2048, "height": 2048 });
    client.send(&json!({ "id": 7, "method": "render", "params": render }).to_string());
    let cancelled = client.call("cancel", json!({ "id": 7 }), told);
    assert_eq!(cancelled["result"]["cancelled"], true);
    let stopped = told.pop().unwrap_or_else(|| client.read());
    assert_eq!((&stopped["id"], code(&stopped)), (&json!(7), Some(-32003)));
    // Without a folder for it, no file is read.
    let open = json!({ "version": 1, "nodes": { "i": { "type": "image", "inputs": { "file": "/etc/passwd" } } },
        "outputs": { "out": { "node": "i" } } });
    let opened = client.call(
        "session/open",
        json!({ "session": "f", "document": open }),
        told,
    );
    assert!(
        opened["result"]["diagnostics"][0]["severity"] == "error",
        "{opened}"
    );
    client.end();
}

/// A message that a client might send, or somebody who is none.
fn message(random: &mut Random, number: usize) -> Vec<u8> {
    let session = *random.choose(&["a", "b", "c", "", "nobody"]);
    let name = *random.choose(&["noise", "color", "x", "scale", "height", "base_color"]);
    let value = random
        .choose(&[
            json!(1),
            json!("#ffffff"),
            json!([]),
            json!(null),
            json!(1e300),
            json!({}),
            json!({ "input": "scale" }),
        ])
        .clone();
    let edit = match random.below(8) {
        0 => json!({ "edit": "add", "nodes": { name: { "type": "noise2d" } } }),
        1 => json!({ "edit": "remove", "nodes": [name] }),
        2 => json!({ "edit": "connect", "node": name, "input": "in", "from": "noise" }),
        3 => json!({ "edit": "set", "node": name, "input": "frequency", "value": value }),
        4 => json!({ "edit": "set_input", "input": "scale", "value": value }),
        5 => json!({ "edit": "group", "nodes": [name], "name": "g" }),
        6 => json!({ "edit": "set_extra", "extra": "x".repeat(random.below(2000)) }),
        _ => json!({ "edit": name, "nodes": value }),
    };
    let mut methods = vec![("session/edit", json!({ "session": session, "edit": edit })); 4];
    for name in [
        "session/undo",
        "session/redo",
        "session/commit",
        "session/save",
        "session/text",
        "session/close",
        "session/outputs",
        "session/nothing",
    ] {
        methods.push((name, json!({ "session": session })));
    }
    let open = json!({ "session": session, "text": CLOUDS });
    let shader = json!({ "session": session, "output": name });
    let render = json!({ "session": session, "output": name, "width": random.below(40), "height": 8,
        "blocks": [4, 0] });
    methods.extend([
        ("session/open", open.clone()),
        ("session/open", open),
        ("session/shader", shader),
        ("render", render.clone()),
        ("watch", json!({ "watch": "w", "picture": render })),
        ("unwatch", json!({ "watch": "w" })),
        (
            "cancel",
            json!({ "id": number - random.below(9).min(number) }),
        ),
    ]);
    let (method, mut parameters) = random.choose(&methods).clone();
    if random.happens(0.1) {
        parameters = value;
    }
    let id = if random.happens(0.9) {
        json!(number)
    } else {
        json!({ "an": "object" })
    };
    let call = json!({ "jsonrpc": "2.0", "id": id, "method": method, "params": parameters });
    let mut bytes = call.to_string().into_bytes();
    match random.below(12) {
        // Cut, changed, no text at all, deep, a batch, behind a head.
        0 => bytes.truncate(random.below(bytes.len())),
        1 => {
            for _ in 0..3 {
                let at = random.below(bytes.len());
                bytes[at] = random.bits() as u8;
            }
        }
        2 => bytes = (0..40).map(|_| random.bits() as u8).collect(),
        3 => bytes = "[".repeat(500).into_bytes(),
        4 => bytes = json!([call, 5, call]).to_string().into_bytes(),
        5 => {
            let head = format!("Content-Length: {}\r\n\r\n", bytes.len());
            bytes = [head.as_bytes(), &bytes].concat();
        }
        _ => {}
    }
    if random.happens(0.001) {
        bytes = vec![b'y'; 100_000];
    }
    bytes.push(b'\n');
    bytes
}

#[test]
fn ten_thousand_random_and_hostile_messages_leave_the_server_as_it_was() {
    let mut client = Client::new(&[
        "--max-message",
        "50000",
        "--max-sessions",
        "3",
        "--max-document",
        "100000",
    ]);
    let mut to = client.to.take().expect("it is open");
    let writer = thread::spawn(move || {
        let mut random = Random::new(15);
        for number in 0..10_000 {
            to.write_all(&message(&mut random, number))
                .expect("the server lives");
        }
        // Whatever was left open of a head or of a line ends here.
        to.write_all(b"\n\n\n").expect("the server lives");
        let last = json!({ "id": "last", "method": "session/open", "params": { "session": "a", "text": CLOUDS } });
        writeln!(to, "{last}").expect("the server lives");
        to
    });
    let (mut results, mut errors, mut bugs) = (0, 0, Vec::new());
    loop {
        let mut line = Vec::new();
        let length = client.from.read_until(b'\n', &mut line).expect("bytes");
        assert!(length > 0, "the server has ended");
        // Answers to what came behind heads have heads, and no line's end behind them.
        let line = String::from_utf8(line).expect("text");
        for text in line.split("Content-Length:") {
            let Some(start) = text.find('{') else {
                continue;
            };
            let mut stream =
                serde_json::Deserializer::from_str(&text[start..]).into_iter::<Value>();
            while let Some(Ok(message)) = stream.next() {
                results += usize::from(message.get("result").is_some());
                errors += usize::from(message.get("error").is_some());
                if message["error"]["code"] == -32603 {
                    bugs.push(message.to_string());
                }
                if message["id"] == "last" {
                    assert!(message.get("result").is_some(), "{message}");
                    let to = writer.join().expect("all is written");
                    assert!(bugs.is_empty(), "{}", bugs.join("\n"));
                    assert!(
                        results > 500 && errors > 500,
                        "{results} results, {errors} errors"
                    );
                    let memory = client.memory();
                    assert!(memory.is_none_or(|kib| kib < 1 << 20), "{memory:?} KiB");
                    println!("{results} results, {errors} errors, {memory:?} KiB");
                    client.to = Some(to);
                    client.end();
                    return;
                }
            }
        }
    }
}
