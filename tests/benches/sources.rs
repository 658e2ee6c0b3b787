//! What every source of detail knows of itself in a footprint, against dense numerical truth.
//!
//! `cargo bench -p mipless-tests --bench sources [-- FAMILY…]` prints Markdown: for each source, nine
//! footprints, round and 8:1 (of the same area) at 0°, 20° and 45°: the error of the filtered mean in
//! standard deviations of the noise, and the relative error of the local standard deviation,
//! mean |σ̂ − σ| / mean σ, for `ensemble`, `local` and `quad`. A figure that misses its target is
//! **bold**.
//!
//! A family is one file in `sources/`: it fills a [`table::Source`] for each of its nodes and adds
//! itself to [`FAMILIES`].

#[path = "sources/cells.rs"]
mod cells;
#[path = "sources/cost.rs"]
mod cost;
#[path = "sources/footprint.rs"]
mod footprint;
#[path = "sources/gabor.rs"]
mod gabor;
#[path = "sources/perlin.rs"]
mod perlin;
#[path = "sources/phasor.rs"]
mod phasor;
#[path = "sources/spectral.rs"]
mod spectral;
#[path = "sources/table.rs"]
mod table;
#[path = "sources/truth.rs"]
mod truth;

/// The families, by the names that the command line takes.
const FAMILIES: [(&str, fn()); 5] = [
    ("cells", cells::run),
    ("spectral", spectral::run),
    ("gabor", gabor::run),
    ("perlin", perlin::run),
    ("phasor", phasor::run),
];

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if arguments.iter().any(|argument| argument == "--test") {
        return;
    }
    let wanted: Vec<&String> = arguments.iter().filter(|a| !a.starts_with('-')).collect();
    for name in &wanted {
        assert!(
            FAMILIES.iter().any(|family| family.0 == name.as_str()),
            "{name} is no family of sources"
        );
    }
    for (name, run) in FAMILIES {
        if wanted.is_empty() || wanted.iter().any(|w| w.as_str() == name) {
            println!("\n## {name}\n");
            run();
        }
    }
}
