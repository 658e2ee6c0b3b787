//! The calls of `mipless serve`: their parameters, which are what the schema is made of.

use mipless::session::Edit;
use schemars::{JsonSchema, SchemaGenerator, generate::SchemaSettings};
use serde::Deserialize;
use serde_json::{Map, Value, json};

/// Opens a session. One of `text`, `document` and `saved`, or none for an empty graph.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Open {
    /// What the session is called in all other calls; a session of this name is closed.
    pub(super) session: String,
    /// The text of a graph.
    #[serde(default)]
    pub(super) text: Option<String>,
    /// A graph as JSON.
    #[serde(default)]
    pub(super) document: Option<Value>,
    /// What `session/save` gave.
    #[serde(default)]
    pub(super) saved: Option<Value>,
    /// What the graph is called if it does not say.
    #[serde(default)]
    pub(super) name: Option<String>,
    /// By which method it is filtered, `local` if it is not said.
    #[serde(default)]
    pub(super) method: Option<String>,
}

/// Names a session.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Named {
    /// The session.
    pub(super) session: String,
}

/// Does an edit.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct DoEdit {
    /// The session.
    pub(super) session: String,
    /// The edit.
    pub(super) edit: Edit,
}

/// Changes how a session compiles.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct SetMethod {
    /// The session.
    pub(super) session: String,
    /// `point`, `local`, `auto` or another one.
    pub(super) method: String,
}

/// Asks for the shader of an output.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Shader {
    /// The session.
    pub(super) session: String,
    /// The output; its shader gives those of the same program too.
    pub(super) output: String,
    /// `none`, `fragment` or `compute`.
    #[serde(default)]
    pub(super) entry: Option<String>,
    /// Whether the tables come with it, in base64: f32, little-endian.
    #[serde(default)]
    pub(super) tables: bool,
}

/// Asks for a picture of an output, or of any node. It is answered when it is done; before that, each coarse
/// picture is a notification `picture`.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Render {
    /// The session.
    pub(super) session: String,
    /// The output of the graph.
    #[serde(default)]
    pub(super) output: Option<String>,
    /// In place of an output, the node; inside of sub-graphs its path.
    #[serde(default)]
    pub(super) node: Option<String>,
    /// The output of the node, `out` if it is not said.
    #[serde(default)]
    pub(super) port: Option<String>,
    /// The width in pixels.
    pub(super) width: u32,
    /// The height in pixels.
    pub(super) height: u32,
    /// `flat`, `plane` or `sphere`; `flat` if it is not said.
    #[serde(default)]
    pub(super) view: Option<String>,
    /// The part of texture space that the flat view shows: left, top, right, bottom.
    #[serde(default)]
    pub(super) window: Option<[f64; 4]>,
    /// By which method a node is shown, `point` if it is not said. An output is shown by that of its session.
    #[serde(default)]
    pub(super) method: Option<String>,
    /// `png` (sRGB) or `raw` (f32, little-endian, row by row), in base64; `png` if it is not said.
    #[serde(default)]
    pub(super) format: Option<String>,
    /// The sides of the blocks of coarse pictures, in pixels, the largest first.
    #[serde(default)]
    pub(super) blocks: Vec<u32>,
}

/// Asks for a picture now and again after each change of the session, as notifications `preview`.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Watch {
    /// What the previews are called; one of this name is replaced.
    pub(super) watch: String,
    /// The picture.
    pub(super) picture: Render,
}

/// Ends previews.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Unwatch {
    /// What they are called.
    pub(super) watch: String,
}

/// Cancels a picture.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Cancel {
    /// The `id` of its call.
    pub(super) id: Value,
}

/// Asks for the catalogue.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Nodes {
    /// One type of node; without it, all.
    #[serde(default)]
    pub(super) name: Option<String>,
}

/// Nothing.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Nothing {}

type Parameters = fn(&mut SchemaGenerator) -> schemars::Schema;

fn parameters<T: JsonSchema>(generator: &mut SchemaGenerator) -> schemars::Schema {
    generator.subschema_for::<T>()
}

/// Every call: its name, what it does and gives, and its parameters.
pub(super) const CALLS: [(&str, &str, Parameters); 22] = [
    (
        "initialize",
        "Gives the version of the program, its calls and its limits.",
        parameters::<Nothing>,
    ),
    (
        "nodes",
        "Gives the catalogue, or one node.",
        parameters::<Nodes>,
    ),
    (
        "session/open",
        "Opens a session, and gives its diagnostics and its outputs.",
        parameters::<Open>,
    ),
    ("session/close", "Closes a session.", parameters::<Named>),
    (
        "session/edit",
        "Does an edit, and gives what has changed: `shaders`, `removed`, `broken`, `parameters`.",
        parameters::<DoEdit>,
    ),
    (
        "session/commit",
        "Ends a gesture: the next edit is a step of its own.",
        parameters::<Named>,
    ),
    (
        "session/undo",
        "Takes the last step back, and gives what has changed, or null.",
        parameters::<Named>,
    ),
    (
        "session/redo",
        "Does again what was taken back, and gives what has changed, or null.",
        parameters::<Named>,
    ),
    (
        "session/reload",
        "Reads the files again that the graph names, and gives what has changed.",
        parameters::<Named>,
    ),
    (
        "session/set_method",
        "Compiles by another method, and gives what has changed.",
        parameters::<SetMethod>,
    ),
    (
        "session/diagnostics",
        "Gives all mistakes and warnings.",
        parameters::<Named>,
    ),
    (
        "session/outputs",
        "Gives the outputs, each with its type, and whether it is current or the last good one.",
        parameters::<Named>,
    ),
    (
        "session/inputs",
        "Gives the inputs of the graph with their values and ranges.",
        parameters::<Named>,
    ),
    (
        "session/shader",
        "Gives the WGSL of an output, its parameters, bindings and tables.",
        parameters::<Shader>,
    ),
    (
        "session/text",
        "Gives the text of the graph.",
        parameters::<Named>,
    ),
    (
        "session/save",
        "Gives the session as data, with its steps of undo.",
        parameters::<Named>,
    ),
    (
        "render",
        "Gives a picture, its channels and its size.",
        parameters::<Render>,
    ),
    (
        "watch",
        "Sends a picture now and after each change.",
        parameters::<Watch>,
    ),
    ("unwatch", "Ends that.", parameters::<Unwatch>),
    (
        "cancel",
        "Stops a picture, whose call then ends with an error.",
        parameters::<Cancel>,
    ),
    ("schema", "Gives this schema.", parameters::<Nothing>),
    (
        "shutdown",
        "Stops everything and ends.",
        parameters::<Nothing>,
    ),
];

/// What is sent without being asked for.
const NOTIFICATIONS: [(&str, &str); 3] = [
    (
        "diagnostics",
        "`session` and its `diagnostics`, whenever they are others.",
    ),
    (
        "picture",
        "A coarse picture of a call of `render`: its `id`, the side `block` of its blocks, and the picture.",
    ),
    (
        "preview",
        "A picture of a `watch`, with the `session`, or the `error` why there is none.",
    ),
];

/// The errors that calls end with.
const ERRORS: [(i64, &str); 9] = [
    (super::error::PARSE, "what was sent is no JSON"),
    (
        super::error::REQUEST,
        "it is no call, or larger than the limit",
    ),
    (super::error::METHOD, "there is no such call"),
    (super::error::PARAMETERS, "its parameters are wrong"),
    (
        super::error::INTERNAL,
        "a bug of this program; the session is closed",
    ),
    (
        super::error::MISTAKES,
        "the graph or the edit has mistakes: `data` holds the diagnostics",
    ),
    (super::error::LIMIT, "it is beyond a limit"),
    (super::error::CANCELLED, "it was cancelled"),
    (
        super::error::SESSION,
        "there is no such session, or no such output",
    ),
];

/// The schema of the protocol.
pub(super) fn schema() -> Value {
    let mut generator = SchemaSettings::draft2020_12().into_generator();
    let calls = CALLS.iter().map(|(name, doc, parameters)| {
        let parameters = parameters(&mut generator);
        let call = json!({ "description": doc, "params": parameters });
        ((*name).to_owned(), call)
    });
    let calls: Map<String, Value> = calls.collect();
    let notifications = NOTIFICATIONS.iter();
    let notifications: Map<String, Value> = notifications
        .map(|(name, doc)| ((*name).to_owned(), json!({ "description": doc })))
        .collect();
    let errors = ERRORS.iter();
    let errors: Map<String, Value> = errors
        .map(|(code, doc)| (code.to_string(), json!(doc)))
        .collect();
    json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "The calls of mipless serve, JSON-RPC 2.0",
        "calls": calls,
        "notifications": notifications,
        "errors": errors,
        "$defs": generator.definitions(),
    })
}
