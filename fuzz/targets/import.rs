//! A document of another tool becomes a graph that loads, or says why not. Its first letter says of
//! which tool: `m` of MaterialX, `p` of Material Maker, any other of glTF.
#![no_main]

use libfuzzer_sys::fuzz_target;
use mipless::{Texture, specs};
use mipless_import::{Format, Options, import};

fuzz_target!(|text: &str| {
    let Some(first) = text.chars().next() else {
        return;
    };
    let format = match first {
        'm' => Format::MaterialX,
        'p' => Format::MaterialMaker,
        _ => Format::Gltf,
    };
    let specs = specs();
    let options = Options {
        specs: &specs,
        ..Options::default()
    };
    let imported = import(format, "document", &text[first.len_utf8()..], &options);
    match imported.document {
        Some(document) => {
            // What it names may be a file that is not there, or a number that a port refuses.
            let _ = Texture::from_json(&document.to_text());
        }
        None => assert!(!imported.findings.is_empty(), "refused without a reason"),
    }
});
