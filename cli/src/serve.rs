//! `serve`: sessions for other programs, by JSON-RPC 2.0 on standard input and output.

mod base64;
mod error;
mod job;
mod message;
mod protocol;
mod server;

use crate::mistake::Mistake;
use crate::report::Report;
use clap::Args;
use error::{Failure, REQUEST};
use job::Crew;
use message::{Framing, Incoming, Writer, read};
use mipless::{Catalogue, Files, Folder};
use serde_json::{Value, json};
use server::{Offer, Server};
use std::io::{self, BufReader};
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

/// The arguments of `serve`.
#[derive(Args, Debug)]
pub(crate) struct Arguments {
    /// Print the schema of the protocol, and do nothing else
    #[arg(long)]
    schema: bool,

    /// A folder whose graphs (.json) every session may use as sub-graphs
    #[arg(long, value_name = "DIR")]
    graphs: Option<PathBuf>,

    /// The most bytes of a message
    #[arg(long, value_name = "BYTES", default_value_t = 4 << 20)]
    max_message: usize,

    /// The most bytes of a graph, and of what can be taken back of it
    #[arg(long, value_name = "BYTES", default_value_t = 32 << 20)]
    max_document: usize,

    /// The most nodes of a graph, those of sub-graphs as often as they are used
    #[arg(long, value_name = "N", default_value_t = 20_000)]
    max_nodes: usize,

    /// The most pixels of a picture
    #[arg(long, value_name = "N", default_value_t = 1 << 24)]
    max_pixels: u64,

    /// The most sessions at a time
    #[arg(long, value_name = "N", default_value_t = 64)]
    max_sessions: usize,

    /// The most pictures and shaders that are under way at a time
    #[arg(long, value_name = "N", default_value_t = 64)]
    max_jobs: usize,

    /// The most seconds that a picture takes
    #[arg(long, value_name = "S", default_value_t = 60.0, value_parser = crate::value::positive)]
    max_seconds: f64,
}

/// What a client may ask for at most.
#[derive(Clone, Copy, Debug)]
struct Limits {
    message: usize,
    document: usize,
    nodes: usize,
    pixels: u64,
    sessions: usize,
    jobs: usize,
    seconds: f64,
}

impl Limits {
    fn to_json(self) -> Value {
        json!({
            "message": self.message,
            "document": self.document,
            "nodes": self.nodes,
            "pixels": self.pixels,
            "sessions": self.sessions,
            "jobs": self.jobs,
            "seconds": self.seconds,
        })
    }
}

/// The answer to a call.
fn answer(id: &Value, result: Result<Value, Failure>) -> Value {
    match result {
        Ok(result) => json!({ "jsonrpc": "2.0", "id": id, "result": result }),
        Err(failure) => json!({ "jsonrpc": "2.0", "id": id, "error": failure.to_json() }),
    }
}

/// What is sent without being asked for.
fn notification(name: &str, parameters: Value) -> Value {
    json!({ "jsonrpc": "2.0", "method": name, "params": parameters })
}

/// Serves until the input ends, or a client says `shutdown`.
pub(crate) fn run(arguments: &Arguments, report: &mut Report) -> Result<(), Mistake> {
    if arguments.schema {
        report.print(format_args!("{:#}\n", protocol::schema()));
        return Ok(());
    }
    let limits = Limits {
        message: arguments.max_message,
        document: arguments.max_document,
        nodes: arguments.max_nodes,
        pixels: arguments.max_pixels,
        sessions: arguments.max_sessions,
        jobs: arguments.max_jobs,
        seconds: arguments.max_seconds.min(1e6),
    };
    let mut catalogue = Catalogue::shipped();
    if let Some(folder) = &arguments.graphs {
        let failed = |error| Mistake::usage("usage", error);
        catalogue = catalogue.with_library(folder).map_err(failed)?;
    }
    // Graphs come from whoever speaks: they name no files unless a folder is given for it.
    let files = match report.root() {
        None => None,
        Some(root) => {
            let within = Folder(root.to_path_buf()).within(root);
            let within = within.map_err(|error| {
                Mistake::usage("usage", format!("`--root {}`: {error}", root.display()))
            })?;
            let files: Arc<dyn Files + Send + Sync> = Arc::new(within);
            Some(files)
        }
    };
    let offer = Offer {
        catalogue,
        files,
        limits,
    };
    let writer = Arc::new(Writer::new(io::stdout()));
    let seconds = Duration::from_secs_f64(limits.seconds);
    let (crew, threads) = Crew::new(Arc::clone(&writer), limits.jobs, seconds);
    let mut server = Server::new(offer, writer, Arc::clone(&crew));
    let mut input = BufReader::new(io::stdin().lock());
    while let Ok((incoming, framing)) = read(&mut input, limits.message as u64) {
        let goes_on = match incoming {
            Incoming::End => false,
            Incoming::Message(bytes) => server.message(&bytes, framing),
            Incoming::TooLarge => {
                let message = format!("a message has at most {} bytes", limits.message);
                server.refuse(&Failure::new(REQUEST, message), framing);
                true
            }
            Incoming::NoLength => {
                let message = "a head says `Content-Length: N`";
                server.refuse(&Failure::new(REQUEST, message), Framing::Line);
                true
            }
        };
        if !goes_on {
            break;
        }
    }
    crew.close();
    for thread in threads {
        // A thread that has panicked has said so where it was asked.
        drop(thread.join());
    }
    Ok(())
}
