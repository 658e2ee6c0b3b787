//! The JSON Schema (draft 2020-12) of manifests, for the tools that read them.

use serde_json::{Map, Value, json};

/// The schema of manifests.
pub fn manifest_schema() -> Value {
    let text = || json!({ "type": "string" });
    let count = || json!({ "type": "integer", "minimum": 0 });
    let number = || json!({ "type": "number" });
    let digest = || json!({ "type": "string", "pattern": "^[0-9a-f]{64}$" });
    let list = |of: &str| json!({ "type": "array", "items": { "$ref": format!("#/$defs/{of}") } });
    let kind = || json!({ "enum": ["footprints", "parameters", "outputs", "tables"] });
    let scalar = || json!({ "enum": ["f32", "i32", "u32", "bool"] });
    let entry = json!({ "anyOf": [{ "$ref": "#/$defs/entry_point" }, { "type": "null" }] });
    let location = || list("location");

    let definitions = [
        (
            "source",
            "What was compiled.",
            vec![
                (
                    "file",
                    text(),
                    "The name of the graph's file, without folders.",
                ),
                ("sha256", digest(), "The SHA-256 of its bytes."),
                ("files", list("read"), "What else was read."),
                ("key", digest(), "A digest of compiler, graph and options."),
            ],
            vec![],
        ),
        (
            "read",
            "A file that the graph reads.",
            vec![
                ("name", text(), "The name that the graph says."),
                ("sha256", digest(), "The SHA-256 of its bytes."),
            ],
            vec![],
        ),
        (
            "argument",
            "An argument of the function.",
            vec![
                ("name", text(), "Its name."),
                ("type", text(), "The name of its struct."),
            ],
            vec![],
        ),
        (
            "struct",
            "A struct in a buffer.",
            vec![
                ("name", text(), "Its name."),
                (
                    "size",
                    count(),
                    "The bytes from one to the next in an array.",
                ),
                ("fields", list("field"), "Its members, in order."),
            ],
            vec![],
        ),
        (
            "field",
            "A member of a struct.",
            vec![
                ("name", text(), "Its name."),
                (
                    "scalar",
                    text(),
                    "The type of a component, or the name of a struct.",
                ),
                ("components", count(), "The number of components."),
                ("offset", count(), "The first byte."),
            ],
            vec![],
        ),
        (
            "entry_point",
            "An entry point.",
            vec![
                ("name", text(), "Its name."),
                (
                    "stage",
                    json!({ "enum": ["fragment", "compute"] }),
                    "Its stage.",
                ),
            ],
            vec![],
        ),
        (
            "dispatch",
            "How a compute entry point is dispatched.",
            vec![
                (
                    "workgroup_size",
                    json!({ "type": "array", "items": count(), "minItems": 3, "maxItems": 3 }),
                    "The invocations of a workgroup.",
                ),
                (
                    "row",
                    count(),
                    "Pixel i is the invocation (i mod row, i / row).",
                ),
                (
                    "footprint_bytes",
                    count(),
                    "The bytes of a pixel in the buffer of footprints.",
                ),
                (
                    "output_numbers",
                    count(),
                    "The f32 of a pixel in the buffer of outputs.",
                ),
            ],
            vec![],
        ),
        (
            "parameter",
            "An input of the graph.",
            vec![
                ("name", text(), "Its name in the graph."),
                ("field", text(), "The member's name in the shader."),
                ("type", text(), "Its type in the graph."),
                ("scalar", scalar(), "The type of a component in the buffer."),
                ("offset", count(), "Its first byte in the buffer."),
                (
                    "default",
                    json!({ "type": "array", "items": number() }),
                    "One number a component.",
                ),
            ],
            vec![
                (
                    "min",
                    number(),
                    "The smallest value that the graph was checked for.",
                ),
                (
                    "max",
                    number(),
                    "The largest value that the graph was checked for.",
                ),
                ("soft_min", number(), "Where a slider starts."),
                ("soft_max", number(), "Where a slider ends."),
                ("doc", text(), "What it means."),
            ],
        ),
        (
            "output",
            "An output of the graph.",
            vec![
                ("name", text(), "Its name in the graph."),
                ("field", text(), "The member's name in the shader."),
                ("type", text(), "Its type in the graph."),
                (
                    "variance",
                    json!({ "type": "boolean" }),
                    "Whether it is a variance, not a mean.",
                ),
                ("first", count(), "Its first number among those of a pixel."),
                (
                    "color_space",
                    json!({ "enum": ["linear-rec709", "data"] }),
                    "Of colours, or of what is none.",
                ),
            ],
            vec![
                (
                    "predicted_error",
                    number(),
                    "The largest sRGB RMS error that is to be expected.",
                ),
                (
                    "errors",
                    list("error"),
                    "What was measured, by the size of a pixel.",
                ),
            ],
        ),
        (
            "error",
            "The sRGB RMS error where pixels have one size.",
            vec![
                ("pixel", number(), "The width of a pixel, in uv."),
                ("error", number(), "The error."),
                ("point", number(), "That of a point without a filter."),
            ],
            vec![],
        ),
        (
            "binding",
            "A buffer.",
            vec![
                ("group", count(), "Its group."),
                ("binding", count(), "Its number in the group."),
                ("name", text(), "The variable's name."),
                ("kind", kind(), "What it holds."),
                (
                    "access",
                    json!({ "enum": ["uniform", "storage-read", "storage-read-write", "texture"] }),
                    "How it is read.",
                ),
                ("element", text(), "What it holds one of, or an array of."),
                ("stride", count(), "The bytes of an element."),
            ],
            vec![],
        ),
        (
            "data",
            "The contents of the buffer of tables.",
            vec![
                ("scalar", scalar(), "The type of a number."),
                (
                    "byte_order",
                    json!({ "const": "little-endian" }),
                    "The order of its bytes.",
                ),
                ("length", count(), "How many numbers there are."),
                ("sha256", digest(), "The SHA-256 of its bytes."),
            ],
            vec![],
        ),
        (
            "texture",
            "A texture that holds the tables row by row, one number a texel.",
            vec![
                ("width", count(), "Its columns."),
                ("height", count(), "Its rows."),
                (
                    "format",
                    json!({ "const": "r32float" }),
                    "The format of a texel.",
                ),
            ],
            vec![],
        ),
        (
            "table",
            "A table.",
            vec![
                ("name", text(), "A readable name."),
                ("first", count(), "Its first number in the buffer."),
                ("length", count(), "How many numbers it has."),
            ],
            vec![(
                "error",
                number(),
                "The largest error of reading between its numbers.",
            )],
        ),
        (
            "target",
            "The text for a target.",
            vec![
                ("file", text(), "Its file."),
                ("sha256", digest(), "The SHA-256 of its bytes."),
                (
                    "key",
                    digest(),
                    "A digest of the options that concern this text alone.",
                ),
                ("language", text(), "The language and its version."),
                (
                    "bindings",
                    list("bound"),
                    "Every buffer, in the order of `bindings`.",
                ),
            ],
            vec![
                ("function", text(), "The function as this text calls it."),
                (
                    "entry_point",
                    json!({ "$ref": "#/$defs/entry_point" }),
                    "As this text calls it.",
                ),
                (
                    "varyings",
                    location(),
                    "What a fragment entry point takes from the vertices.",
                ),
                ("colors", location(), "What a fragment entry point writes."),
                (
                    "buffer_sizes",
                    json!({ "$ref": "#/$defs/buffer_sizes" }),
                    "Metal: the byte lengths of arrays.",
                ),
            ],
        ),
        (
            "bound",
            "A buffer as a target's text calls it.",
            vec![
                ("kind", kind(), "What it holds."),
                ("place", text(), "Where it is bound, as the text spells it."),
                ("index", count(), "The number in that place."),
            ],
            vec![
                ("name", text(), "The variable's name."),
                ("block", text(), "GLSL: the name of the block around it."),
            ],
        ),
        (
            "location",
            "Something at a location.",
            vec![
                ("of", text(), "`uv`, `xyz`, or the name of an output."),
                ("location", count(), "The location."),
                ("name", text(), "What the text calls it."),
            ],
            vec![],
        ),
        (
            "buffer_sizes",
            "Where Metal's shaders read the byte lengths of arrays, each a 32-bit unsigned integer.",
            vec![
                ("buffer", count(), "The index of the buffer."),
                (
                    "of",
                    json!({ "type": "array", "items": kind() }),
                    "The arrays, in order.",
                ),
            ],
            vec![],
        ),
    ];
    let definitions: Map<String, Value> = (definitions.into_iter())
        .map(|(name, says, required, optional)| (name.to_owned(), object(says, required, optional)))
        .collect();

    let names = json!({ "type": "object", "additionalProperties": { "type": "string" } });
    let targets = json!({ "type": "object", "additionalProperties": { "$ref": "#/$defs/target" } });
    let mut schema = object(
        "What a host needs to know of a compiled texture.",
        vec![
            ("compiler", text(), "The compiler and its version."),
            ("method", text(), "How it was compiled."),
            (
                "pixel_filter",
                text(),
                "The filter over which a pixel is averaged.",
            ),
            ("function", text(), "The texture's function."),
            ("arguments", list("argument"), "Its arguments, in order."),
            ("result", text(), "The struct that it returns."),
            (
                "structs",
                list("struct"),
                "The structs that stand in buffers.",
            ),
            ("entry_point", entry, "The entry point, if there is one."),
            (
                "parameters",
                list("parameter"),
                "The members of the struct of parameters, in order.",
            ),
            (
                "parameters_size",
                count(),
                "The bytes of that struct; 0 without parameters.",
            ),
            (
                "outputs",
                list("output"),
                "The members of the struct of outputs, in order.",
            ),
            ("bindings", list("binding"), "Every buffer."),
            (
                "tables",
                list("table"),
                "The tables in the buffer of tables, in order.",
            ),
            ("files", names, "All files beside the manifest."),
        ],
        vec![
            (
                "source",
                json!({ "$ref": "#/$defs/source" }),
                "Where it came from.",
            ),
            (
                "shading",
                json!({ "type": "array", "items": text() }),
                "The functions that light it: by a light, and by a sky.",
            ),
            (
                "dispatch",
                json!({ "$ref": "#/$defs/dispatch" }),
                "Of a compute entry point.",
            ),
            (
                "tables_data",
                json!({ "$ref": "#/$defs/data" }),
                "The buffer of tables.",
            ),
            (
                "tables_texture",
                json!({ "$ref": "#/$defs/texture" }),
                "The same as a texture.",
            ),
            ("targets", targets, "The texts, by the names of targets."),
        ],
    );
    schema["$schema"] = "https://json-schema.org/draft/2020-12/schema".into();
    schema["title"] = "Mipless manifest".into();
    schema["$defs"] = definitions.into();
    schema
}

type Property = (&'static str, Value, &'static str);

/// An object with these properties and no others.
fn object(says: &str, required: Vec<Property>, optional: Vec<Property>) -> Value {
    let names: Vec<&str> = required.iter().map(|property| property.0).collect();
    let names = json!(names);
    let mut properties = Map::new();
    for (name, mut of, says) in required.into_iter().chain(optional) {
        of["description"] = says.into();
        properties.insert(name.to_owned(), of);
    }
    json!({
        "type": "object",
        "description": says,
        "required": names,
        "additionalProperties": false,
        "properties": properties,
    })
}
