//! What the suites share: the graphs that every suite runs over, the methods, random numbers that
//! are the same in every run, and all tolerances.
//!
//! | suite | holds |
//! |---|---|
//! | `agreement` | one program gives the same numbers in f32, in f64 and on a graphics device |
//! | `shaders` | every shader that can be emitted is valid, and translates to every target |
//! | `snapshots` | the IR and the WGSL of every graph, and that compilation is deterministic |
//! | `stability` | no footprint, however extreme, gives anything but a finite number in range |
//! | `properties` | random graphs, nodes with any input set, and mutilated documents |
//! | `composition` | the laws that every graph keeps, by random graphs over the whole catalogue |
//! | `fuzz` | bytes from outside are taken or refused with a place: documents, IR, settings, pictures |
//! | `statistics` | what the noises claim of themselves, as hypothesis tests |
//! | `field` | graphs as strangers write them are filtered, and nowhere worse than a point |
//! | `bounds` | nodes with two bounds, in any order, given in any way |
//! | `reach` | the values that the check says signals can have, and divisors that may be 0 |
//! | `names` | whatever things are called, every target compiles |
//! | `linear` | what a graph costs grows as the graph does |
//! | `parity` | nodes with a name of MaterialX's compute at a point what its shader computes |
//! | `shading` | what `shade` makes of filtered surfaces, against facets that are shaded one by one |
//! | `closure` | the errors that the check predicts, against rendered truth |
//! | `importing`, `importing_json` | what each rule makes of documents of other tools |
//! | `corpus` | public documents of other tools, where they are at hand |
//! | `sessions` | edits are taken back, and what they make is what their text makes |
//! | `tidy` | the order of the house: arrows, generated files, names |
//! | `book` | the pages of the nodes and their pictures |
//! | `links` | what all documents link to, show and quote |

pub mod book;
pub mod case;
pub mod document;
pub mod generated;
pub mod large;
pub mod law;
pub mod markdown;
pub mod measured;
pub mod mutation;
pub mod random_edit;
pub mod random_graph;
pub mod reduce;
pub mod shown;
pub mod surface;
pub mod thumbnail;
pub mod timing;
pub mod tolerance;
pub mod varied;

use mipless::Method;
pub use mipless::conformance::random;
use std::path::PathBuf;

/// The root of the workspace.
pub fn root() -> PathBuf {
    let tests = PathBuf::from(env!("CARGO_MANIFEST_DIR"));
    tests
        .parent()
        .expect("the suite lies in the workspace")
        .to_owned()
}

/// Every kind of method, the ones with a number at the least that shows what they do.
pub const METHODS: [Method; 8] = [
    Method::Point,
    Method::Naive,
    Method::Ensemble,
    Method::Local,
    Method::Quad,
    Method::Auto,
    Method::Split(4),
    Method::Supersample(16),
];

/// A method's name without characters that file names and test filters stumble over.
pub fn name_of(method: Method) -> String {
    method.to_string().replace(':', "_")
}

/// Whether an environment variable asks for something: it is set, and neither empty nor 0.
pub fn asked(variable: &str) -> bool {
    std::env::var(variable).is_ok_and(|value| !value.is_empty() && value != "0")
}

/// How many random cases a test tries: `usual`, or ten times as many where `MIPLESS_LONG` is set.
pub fn cases(usual: u32) -> u32 {
    if asked("MIPLESS_LONG") {
        10 * usual
    } else {
        usual
    }
}

/// The page of the book for people who depend on the crate: its examples run as tests.
#[cfg(doctest)]
#[doc = include_str!("../../docs/book/src/tool.md")]
pub mod tool {}

/// The page of the book for people who write an editor.
#[cfg(doctest)]
#[doc = include_str!("../../docs/book/src/sessions.md")]
pub mod sessions {}
