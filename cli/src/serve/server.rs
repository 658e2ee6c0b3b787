//! Calls, done in the order in which they come; what takes long is handed to the crew.

use super::error::{
    Failure, INTERNAL, LIMIT, METHOD, MISTAKES, PARAMETERS, PARSE, REQUEST, SESSION,
};
use super::job::{Crew, Receiver, Sight, Task, Work};
use super::message::{Framing, Writer};
use super::protocol::{
    CALLS, Cancel, DoEdit, Named, Nodes, Nothing, Open, Render, SetMethod, Shader, Unwatch, Watch,
    schema,
};
use super::{Limits, answer, notification};
use mipless::render::{Flat, Size, View};
use mipless::session::{Change, Compiled, Saved, Session, Setup};
use mipless::wgsl::Entry;
use mipless::{Catalogue, Files, Method, NoFiles, Options};
use serde::de::DeserializeOwned;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::io::Write;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;

/// What a server offers to every session.
pub(super) struct Offer {
    pub(super) catalogue: Catalogue,
    /// The folder that graphs may name files of.
    pub(super) files: Option<Arc<dyn Files + Send + Sync>>,
    pub(super) limits: Limits,
}

struct Held {
    session: Session,
    /// Of the messages that have made it: what its document and its steps of undo take, about.
    bytes: usize,
}

pub(super) struct Server<W> {
    offer: Offer,
    writer: Arc<Writer<W>>,
    crew: Arc<Crew<W>>,
    sessions: BTreeMap<String, Held>,
    watches: BTreeMap<String, Render>,
    /// How the present message came.
    framing: Framing,
    /// How many bytes it has.
    length: usize,
}

/// What became of a call.
enum Outcome {
    Done(Value),
    /// It is answered by the crew.
    Later,
    End,
}

type Result<T> = std::result::Result<T, Failure>;

fn read<T: DeserializeOwned>(parameters: Value) -> Result<T> {
    serde_json::from_value(parameters).map_err(|error| Failure::new(PARAMETERS, error.to_string()))
}

fn method(name: &str) -> Result<Method> {
    (name.parse()).map_err(|error| Failure::new(PARAMETERS, format!("`{name}`: {error}")))
}

fn options(name: Option<&str>, usual: Method) -> Result<Options> {
    Ok(Options {
        method: name.map_or(Ok(usual), method)?,
        ..Options::default()
    })
}

impl<W: Write + Send + 'static> Server<W> {
    pub(super) fn new(offer: Offer, writer: Arc<Writer<W>>, crew: Arc<Crew<W>>) -> Self {
        Self {
            offer,
            writer,
            crew,
            sessions: BTreeMap::new(),
            watches: BTreeMap::new(),
            framing: Framing::Line,
            length: 0,
        }
    }

    /// Does what a message says; whether to go on.
    pub(super) fn message(&mut self, bytes: &[u8], framing: Framing) -> bool {
        self.framing = framing;
        self.length = bytes.len();
        let message = match serde_json::from_slice(bytes) {
            Ok(message) => message,
            Err(error) => {
                self.refuse(&Failure::new(PARSE, error.to_string()), framing);
                return true;
            }
        };
        match message {
            Value::Array(calls) if !calls.is_empty() => {
                // A batch is so many calls, each answered as any other is.
                calls.into_iter().all(|call| self.call(call))
            }
            call => self.call(call),
        }
    }

    /// Answers what is no call.
    pub(super) fn refuse(&self, failure: &Failure, framing: Framing) {
        let refused = answer(&Value::Null, Err(failure.clone()));
        self.writer.write(&refused, framing);
    }

    fn call(&mut self, call: Value) -> bool {
        let Value::Object(mut call) = call else {
            self.refuse(&Failure::new(REQUEST, "a call is an object"), self.framing);
            return true;
        };
        let id = call.remove("id");
        let is_id = |id: &Value| id.is_string() || id.is_number() || id.is_null();
        let name = match call.remove("method") {
            Some(Value::String(name))
                if call.get("jsonrpc").is_none_or(|version| version == "2.0")
                    && id.as_ref().is_none_or(is_id) =>
            {
                name
            }
            _ => {
                let failure = Failure::new(REQUEST, "a call has a `method`, and an `id`");
                self.refuse(&failure, self.framing);
                return true;
            }
        };
        let parameters = call.remove("params").unwrap_or_else(|| json!({}));
        let session = parameters.get("session").and_then(Value::as_str);
        let session = session.map(str::to_owned);
        let done = catch_unwind(AssertUnwindSafe(|| {
            self.named(&name, parameters, id.clone())
        }));
        let result = done.unwrap_or_else(|_| {
            // What it has left of the session is not known.
            if let Some(session) = session {
                self.sessions.remove(&session);
            }
            Err(Failure::new(
                INTERNAL,
                "a bug of the program; the session is closed",
            ))
        });
        let (result, goes_on) = match result {
            Ok(Outcome::Later) => return true,
            Ok(Outcome::Done(value)) => (Ok(value), true),
            Ok(Outcome::End) => (Ok(Value::Null), false),
            Err(failure) => (Err(failure), true),
        };
        if let Some(id) = id {
            self.writer.write(&answer(&id, result), self.framing);
        }
        goes_on
    }

    fn named(&mut self, name: &str, parameters: Value, id: Option<Value>) -> Result<Outcome> {
        let done = match name {
            "initialize" => {
                read::<Nothing>(parameters)?;
                self.introduction()
            }
            "schema" => {
                read::<Nothing>(parameters)?;
                schema()
            }
            "nodes" => self.nodes(&read(parameters)?)?,
            "shutdown" => {
                read::<Nothing>(parameters)?;
                self.crew.cancel(|_| true);
                return Ok(Outcome::End);
            }
            "session/open" => self.open(read(parameters)?)?,
            "session/close" => {
                let Named { session } = read(parameters)?;
                self.session(&session)?;
                self.sessions.remove(&session);
                self.watches.retain(|_, render| render.session != session);
                Value::Null
            }
            "session/edit" => self.edit(read(parameters)?)?,
            "session/commit" => {
                self.changed(read(parameters)?, |session| Some(session.commit()))?
            }
            "session/undo" => self.changed(read(parameters)?, Session::undo)?,
            "session/redo" => self.changed(read(parameters)?, Session::redo)?,
            "session/reload" => {
                self.changed(read(parameters)?, |session| Some(session.reload()))?
            }
            "session/set_method" => {
                let SetMethod {
                    session,
                    method: name,
                } = read(parameters)?;
                let options = options(Some(&name), Method::Local)?;
                self.changed(Named { session }, |session| {
                    Some(session.set_options(options))
                })?
            }
            "session/diagnostics" => {
                let session = self.of(parameters)?;
                json!({ "diagnostics": session.diagnostics() })
            }
            "session/outputs" => json!({ "outputs": outputs(self.of(parameters)?) }),
            "session/inputs" => json!({ "inputs": inputs(self.of(parameters)?) }),
            "session/text" => json!({ "text": self.of(parameters)?.to_text() }),
            "session/save" => json!({ "saved": self.of(parameters)?.save() }),
            "session/shader" => return self.shader(&read(parameters)?, id),
            "render" => {
                let render: Render = read(parameters)?;
                let (compiled, work) = self.sight(&render)?;
                return self.later(Receiver::Call(id), compiled, work);
            }
            "watch" => {
                let Watch { watch, picture } = read(parameters)?;
                if self.watches.len() >= self.offer.limits.jobs {
                    return Err(Failure::new(LIMIT, "there are too many watches"));
                }
                self.session(&picture.session)?;
                self.watches.insert(watch.clone(), picture);
                self.show(&watch);
                Value::Null
            }
            "unwatch" => {
                let Unwatch { watch } = read(parameters)?;
                json!({ "ended": self.watches.remove(&watch).is_some() })
            }
            "cancel" => {
                let Cancel { id } = read(parameters)?;
                let cancelled = Receiver::Call(Some(id));
                json!({ "cancelled": self.crew.cancel(|receiver| *receiver == cancelled) })
            }
            _ => {
                let near = mipless_graph::suggest(name, CALLS.iter().map(|(name, ..)| *name));
                let near =
                    near.map_or_else(String::new, |near| format!("; did you mean `{near}`?"));
                return Err(Failure::new(
                    METHOD,
                    format!("there is no call `{name}`{near}"),
                ));
            }
        };
        Ok(Outcome::Done(done))
    }

    fn introduction(&self) -> Value {
        let calls: Vec<&str> = CALLS.iter().map(|(name, ..)| *name).collect();
        json!({
            "name": "mipless",
            "version": env!("CARGO_PKG_VERSION"),
            "calls": calls,
            "limits": self.offer.limits.to_json(),
        })
    }

    fn nodes(&self, nodes: &Nodes) -> Result<Value> {
        let all = self.offer.catalogue.definitions();
        match &nodes.name {
            None => Ok(mipless_nodes::describe(all)),
            Some(name) => {
                let found = all.iter().find(|def| def.spec.name == name);
                let found = found.ok_or_else(|| {
                    Failure::new(PARAMETERS, format!("there is no node `{name}`"))
                })?;
                Ok(mipless_nodes::describe(std::slice::from_ref(found)))
            }
        }
    }

    fn session(&mut self, name: &str) -> Result<&mut Held> {
        let missing = || Failure::new(SESSION, format!("there is no session `{name}`"));
        self.sessions.get_mut(name).ok_or_else(missing)
    }

    fn of(&mut self, parameters: Value) -> Result<&mut Session> {
        let Named { session } = read(parameters)?;
        Ok(&mut self.session(&session)?.session)
    }

    fn open(&mut self, open: Open) -> Result<Value> {
        let limits = self.offer.limits;
        if !self.sessions.contains_key(&open.session) && self.sessions.len() >= limits.sessions {
            let message = format!("{} sessions are open", limits.sessions);
            return Err(Failure::new(LIMIT, message));
        }
        let usual = Setup::default();
        let files = self.offer.files.clone();
        let setup = Setup {
            catalogue: self.offer.catalogue.clone(),
            name: open.name.unwrap_or(usual.name),
            files: files.unwrap_or_else(|| Arc::new(NoFiles)),
            options: options(open.method.as_deref(), Method::Local)?,
        };
        let session = match (open.text, open.document, open.saved) {
            (None, None, None) => Session::new(setup),
            (Some(text), None, None) => {
                Session::open_with(&text, setup).map_err(|m| Failure::mistakes(&m))?
            }
            (None, Some(document), None) => Session::open_with(&document.to_string(), setup)
                .map_err(|mistakes| Failure::mistakes(&mistakes))?,
            (None, None, Some(saved)) => {
                let saved: Saved = read(saved)?;
                Session::restore(&saved, setup)
                    .map_err(|error| Failure::new(MISTAKES, error.to_string()))?
            }
            _ => {
                let message = "one of `text`, `document` and `saved` is enough";
                return Err(Failure::new(PARAMETERS, message));
            }
        };
        if session.size() > limits.nodes {
            return Err(too_many(session.size(), limits.nodes));
        }
        let opened = json!({
            "diagnostics": session.diagnostics(),
            "outputs": outputs(&session),
            "inputs": inputs(&session),
        });
        let bytes = self.length;
        self.sessions.insert(open.session, Held { session, bytes });
        Ok(opened)
    }

    fn edit(
        &mut self,
        DoEdit {
            session: name,
            edit,
        }: DoEdit,
    ) -> Result<Value> {
        let (limits, length) = (self.offer.limits, self.length);
        let open = self.session(&name)?;
        let change = (open.session.apply(edit))
            .map_err(|refused| Failure::mistakes(std::slice::from_ref(&*refused)))?;
        let size = open.session.size();
        open.bytes += length;
        let is_long =
            open.bytes > limits.document && open.session.to_text().len() > limits.document;
        if size > limits.nodes || is_long {
            open.session.commit();
            open.session.undo();
            return Err(match is_long {
                true => {
                    let most = limits.document;
                    Failure::new(LIMIT, format!("the graph has more than {most} bytes"))
                }
                false => too_many(size, limits.nodes),
            });
        }
        if open.bytes > limits.document {
            // What can be taken back is what there is room for.
            open.session.clear_history();
            open.bytes = open.session.to_text().len();
        }
        self.tell(&name, &change);
        Ok(described(&change))
    }

    fn changed(
        &mut self,
        Named { session: name }: Named,
        change: impl FnOnce(&mut Session) -> Option<Change>,
    ) -> Result<Value> {
        let change = change(&mut self.session(&name)?.session);
        let Some(change) = change else {
            return Ok(Value::Null);
        };
        self.tell(&name, &change);
        Ok(described(&change))
    }

    /// Tells what has changed without being asked.
    fn tell(&mut self, session: &str, change: &Change) {
        if change.diagnostics_changed {
            let parameters = json!({ "session": session, "diagnostics": change.diagnostics });
            let message = notification("diagnostics", parameters);
            self.writer.write(&message, self.framing);
        }
        let watches: Vec<String> = (self.watches.iter())
            .filter(|(_, render)| render.session == session)
            .map(|(watch, _)| watch.clone())
            .collect();
        for watch in watches {
            self.show(&watch);
        }
    }

    /// Shows a watch anew, in place of what is under way for it.
    fn show(&mut self, watch: &str) {
        let Some(render) = self.watches.get(watch).cloned() else {
            return;
        };
        let receiver = Receiver::Watch(watch.to_owned(), render.session.clone());
        self.crew.cancel(|other| *other == receiver);
        let shown = self
            .sight(&render)
            .and_then(|(compiled, work)| self.later(receiver, compiled, work));
        if let Err(failure) = shown {
            let parameters = json!({
                "watch": watch,
                "session": render.session,
                "error": failure.to_json(),
            });
            self.writer
                .write(&notification("preview", parameters), self.framing);
        }
    }

    fn later(&self, receiver: Receiver, compiled: Arc<Compiled>, work: Work) -> Result<Outcome> {
        self.crew.add(Task {
            receiver,
            framing: self.framing,
            compiled,
            work,
        })?;
        Ok(Outcome::Later)
    }

    fn shader(&mut self, shader: &Shader, id: Option<Value>) -> Result<Outcome> {
        let session = &self.session(&shader.session)?.session;
        let output = session
            .output(&shader.output)
            .ok_or_else(|| no_output(&shader.output))?;
        let entry = match shader.entry.as_deref() {
            None | Some("none") => Entry::None,
            Some("fragment") => Entry::Fragment,
            Some("compute") => Entry::Compute,
            Some(other) => {
                let message = format!("`{other}` is neither none, fragment nor compute");
                return Err(Failure::new(PARAMETERS, message));
            }
        };
        let compiled = Arc::clone(&output.compiled);
        let tables = shader.tables;
        self.later(Receiver::Call(id), compiled, Work::Shader { entry, tables })
    }

    /// What a picture is evaluated from.
    fn sight(&mut self, render: &Render) -> Result<(Arc<Compiled>, Work)> {
        let most = self.offer.limits.pixels;
        let pixels = u64::from(render.width) * u64::from(render.height);
        if pixels == 0 || pixels > most {
            let message = format!("{pixels} pixels are not between 1 and {most}");
            return Err(Failure::new(LIMIT, message));
        }
        let view = render.view.as_deref().unwrap_or("flat");
        let view = match (view, render.window) {
            ("flat", Some(window)) => {
                if !window.iter().all(|edge| edge.is_finite()) {
                    return Err(Failure::new(PARAMETERS, "a window is finite"));
                }
                View::Flat(Flat { window })
            }
            (name, _) => View::by_name(name)
                .ok_or_else(|| Failure::new(PARAMETERS, format!("there is no view `{name}`")))?,
        };
        let is_raw = match render.format.as_deref() {
            None | Some("png") => false,
            Some("raw") => true,
            Some(other) => {
                let message = format!("`{other}` is neither png nor raw");
                return Err(Failure::new(PARAMETERS, message));
            }
        };
        if render.blocks.len() > 8 {
            return Err(Failure::new(LIMIT, "there are at most 8 coarse pictures"));
        }
        let session = &mut self.session(&render.session)?.session;
        let numbers = session.numbers();
        let (compiled, output) = match (&render.output, &render.node) {
            (Some(name), None) => {
                let output = session.output(name).ok_or_else(|| no_output(name))?;
                (Arc::clone(&output.compiled), name.clone())
            }
            (None, Some(node)) => {
                let options = options(render.method.as_deref(), Method::Point)?;
                let port = render.port.as_deref().unwrap_or("out");
                let compiled = session
                    .preview(node, port, &options)
                    .map_err(|mistakes| Failure::mistakes(&mistakes))?;
                let output = compiled.outputs()[0].name.clone();
                (compiled, output)
            }
            _ => {
                let message = "a picture is of an `output`, or of a `node`";
                return Err(Failure::new(PARAMETERS, message));
            }
        };
        let sight = Sight {
            output,
            numbers,
            view,
            size: Size::new(render.width, render.height),
            is_raw,
            blocks: render.blocks.clone(),
        };
        Ok((compiled, Work::Picture(Box::new(sight))))
    }
}

fn no_output(name: &str) -> Failure {
    Failure::new(
        SESSION,
        format!("there is no output `{name}` with a program"),
    )
}

fn too_many(nodes: usize, most: usize) -> Failure {
    Failure::new(LIMIT, format!("{nodes} nodes are more than {most}"))
}

fn outputs(session: &Session) -> Vec<Value> {
    let outputs = session.outputs().map(|output| {
        json!({
            "name": output.name,
            "type": output.ty.name(),
            "is_current": output.is_current,
        })
    });
    outputs.collect()
}

fn inputs(session: &Session) -> Vec<Value> {
    let inputs = session.parameters().iter().map(|input| {
        json!({
            "name": input.name,
            "type": input.ty.name(),
            "value": input.value.numbers(),
            "min": input.min,
            "max": input.max,
            "soft_min": input.soft_min,
            "soft_max": input.soft_max,
            "doc": input.doc,
        })
    });
    inputs.collect()
}

fn described(change: &Change) -> Value {
    json!({
        "diagnostics_changed": change.diagnostics_changed,
        "errors": change.diagnostics.iter().filter(|d| d.is_error()).count(),
        "shaders": change.shaders,
        "removed": change.removed,
        "broken": change.broken,
        "parameters": change.parameters,
    })
}
