//! The examples of the reference pages.

/// The graph `NAME_example` of these nodes, one line each, whose output `out` is the node of that
/// name, or the one that is named after `=>`.
macro_rules! example {
    ($name:expr, $nodes:expr) => {
        example!($name => $name, $nodes)
    };
    ($name:expr => $out:expr, $nodes:expr) => {
        concat!(
            "{\n  \"version\": 1,\n  \"name\": \"",
            $name,
            "_example\",\n  \"nodes\": {",
            $nodes,
            "  },\n  \"outputs\": { \"out\": { \"node\": \"",
            $out,
            "\" } }\n}"
        )
    };
}
