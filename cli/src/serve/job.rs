//! What takes long: pictures and shaders, on threads of their own, stopped when they are cancelled or late.

use super::base64;
use super::error::{CANCELLED, Failure, INTERNAL, LIMIT, SESSION};
use super::message::{Framing, Writer};
use mipless::render::{Job, Picture, RenderError, Size, View};
use mipless::session::Compiled;
use mipless::wgsl;
use mipless_runtime::image::{Image, channel_names};
use mipless_runtime::image_file::{self, Bits, Format, Space};
use serde_json::{Value, json};
use std::collections::VecDeque;
use std::io::Write;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

/// How often it is looked whether something is late.
const LOOK: Duration = Duration::from_millis(20);

/// A picture that is to be evaluated.
pub(super) struct Sight {
    /// Which output of the program.
    pub(super) output: String,
    pub(super) numbers: Vec<f32>,
    pub(super) view: View,
    pub(super) size: Size,
    pub(super) is_raw: bool,
    pub(super) blocks: Vec<u32>,
}

pub(super) enum Work {
    Picture(Box<Sight>),
    Shader { entry: wgsl::Entry, tables: bool },
}

/// To whom the result goes.
#[derive(Clone, PartialEq)]
pub(super) enum Receiver {
    /// The call of this `id`; without one nobody is told.
    Call(Option<Value>),
    /// A watch, and its session.
    Watch(String, String),
}

pub(super) struct Task {
    pub(super) receiver: Receiver,
    pub(super) framing: Framing,
    pub(super) compiled: Arc<Compiled>,
    pub(super) work: Work,
}

/// What can be said of a task from outside.
struct Ticket {
    receiver: Receiver,
    cancel: AtomicBool,
    is_late: AtomicBool,
    deadline: Instant,
}

#[derive(Default)]
struct Queue {
    waiting: VecDeque<(Task, Arc<Ticket>)>,
    /// Those that wait and those that are at work.
    tickets: Vec<Arc<Ticket>>,
    is_closed: bool,
}

/// The threads, and what they are to do.
pub(super) struct Crew<W> {
    queue: Mutex<Queue>,
    changed: Condvar,
    writer: Arc<Writer<W>>,
    most: usize,
    seconds: Duration,
}

impl<W: Write + Send + 'static> Crew<W> {
    /// Threads that do at most `most` tasks, each in so many seconds.
    pub(super) fn new(
        writer: Arc<Writer<W>>,
        most: usize,
        seconds: Duration,
    ) -> (Arc<Self>, Vec<thread::JoinHandle<()>>) {
        let crew = Arc::new(Self {
            queue: Mutex::default(),
            changed: Condvar::new(),
            writer,
            most,
            seconds,
        });
        let mut threads = Vec::new();
        // Two, so that a preview need not wait for a large picture.
        for _ in 0..2 {
            let crew = Arc::clone(&crew);
            threads.push(thread::spawn(move || crew.run()));
        }
        let watchman = Arc::clone(&crew);
        threads.push(thread::spawn(move || watchman.watch()));
        (crew, threads)
    }

    fn lock(&self) -> MutexGuard<'_, Queue> {
        self.queue.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Adds a task, unless there are too many.
    pub(super) fn add(&self, task: Task) -> Result<(), Failure> {
        let mut queue = self.lock();
        if queue.tickets.len() >= self.most {
            let message = format!("{} pictures and shaders are under way", self.most);
            return Err(Failure::new(LIMIT, message));
        }
        let ticket = Arc::new(Ticket {
            receiver: task.receiver.clone(),
            cancel: AtomicBool::new(false),
            is_late: AtomicBool::new(false),
            deadline: Instant::now() + self.seconds,
        });
        queue.tickets.push(Arc::clone(&ticket));
        queue.waiting.push_back((task, ticket));
        self.changed.notify_all();
        Ok(())
    }

    /// Stops what goes to a receiver; whether there was something.
    pub(super) fn cancel(&self, receiver: impl Fn(&Receiver) -> bool) -> bool {
        let mut queue = self.lock();
        let mut found = false;
        for ticket in queue.tickets.iter().filter(|t| receiver(&t.receiver)) {
            ticket.cancel.store(true, Ordering::Relaxed);
            found = true;
        }
        // Nobody waits for a preview that has not begun: it makes room for the next one.
        let Queue {
            waiting, tickets, ..
        } = &mut *queue;
        waiting.retain(|(task, ticket)| {
            let is_gone = matches!(task.receiver, Receiver::Watch(..)) && receiver(&task.receiver);
            if is_gone {
                tickets.retain(|known| !Arc::ptr_eq(known, ticket));
            }
            !is_gone
        });
        found
    }

    /// Lets the threads end when all is done.
    pub(super) fn close(&self) {
        self.lock().is_closed = true;
        self.changed.notify_all();
    }

    fn watch(&self) {
        loop {
            thread::sleep(LOOK);
            let queue = self.lock();
            if queue.is_closed && queue.tickets.is_empty() {
                return;
            }
            let now = Instant::now();
            for ticket in queue.tickets.iter().filter(|t| t.deadline < now) {
                ticket.is_late.store(true, Ordering::Relaxed);
                ticket.cancel.store(true, Ordering::Relaxed);
            }
        }
    }

    fn run(&self) {
        loop {
            let (task, ticket) = {
                let mut queue = self.lock();
                loop {
                    if let Some(next) = queue.waiting.pop_front() {
                        break next;
                    }
                    if queue.is_closed {
                        return;
                    }
                    let waited = self.changed.wait(queue);
                    queue = waited.unwrap_or_else(PoisonError::into_inner);
                }
            };
            let done = catch_unwind(AssertUnwindSafe(|| self.work(&task, &ticket)));
            let result = done.unwrap_or_else(|_| {
                Err(Failure::new(INTERNAL, "this graph is a bug of the program"))
            });
            let result = result.map_err(|failure| {
                if ticket.is_late.load(Ordering::Relaxed) {
                    let seconds = self.seconds.as_secs_f64();
                    return Failure::new(LIMIT, format!("it takes longer than {seconds} seconds"));
                }
                failure
            });
            self.lock().tickets.retain(|t| !Arc::ptr_eq(t, &ticket));
            self.deliver(&task, result);
        }
    }

    fn deliver(&self, task: &Task, result: Result<Value, Failure>) {
        match &task.receiver {
            Receiver::Call(None) => {}
            Receiver::Call(Some(id)) => {
                let answer = super::answer(id, result);
                self.writer.write(&answer, task.framing);
            }
            Receiver::Watch(watch, session) => {
                // One that was cancelled has a successor.
                if result
                    .as_ref()
                    .is_err_and(|failure| failure.code == CANCELLED)
                {
                    return;
                }
                let mut parameters = match result {
                    Ok(picture) => picture,
                    Err(failure) => json!({ "error": failure.to_json() }),
                };
                parameters["watch"] = json!(watch);
                parameters["session"] = json!(session);
                let preview = super::notification("preview", parameters);
                self.writer.write(&preview, task.framing);
            }
        }
    }

    fn work(&self, task: &Task, ticket: &Ticket) -> Result<Value, Failure> {
        if ticket.cancel.load(Ordering::Relaxed) {
            return Err(Failure::new(CANCELLED, "it was cancelled"));
        }
        match &task.work {
            Work::Shader { entry, tables } => Ok(shader(&task.compiled, *entry, *tables)),
            Work::Picture(sight) => self.picture(task, sight, &ticket.cancel),
        }
    }

    fn picture(&self, task: &Task, sight: &Sight, cancel: &AtomicBool) -> Result<Value, Failure> {
        let mut evaluator = task.compiled.evaluator();
        // The program may be an older one, of other inputs, which keeps its own values.
        drop(evaluator.set_numbers(&sight.numbers));
        let channels: Vec<usize> = (evaluator.channels().iter().enumerate())
            .filter(|(_, channel)| channel.output == sight.output && !channel.is_variance)
            .map(|(index, _)| index)
            .collect();
        let Some(&first) = channels.first() else {
            return Err(Failure::new(
                SESSION,
                format!("no output `{}`", sight.output),
            ));
        };
        let (all, ty) = (evaluator.channels().len(), evaluator.channels()[first].ty);
        let encoded = |block: u32, pixels: &[f32]| -> Result<Value, Failure> {
            let of = |channel: &usize| {
                let channel = *channel;
                pixels.chunks(all).map(move |pixel| pixel[channel])
            };
            let data = if sight.is_raw {
                let pixels = pixels.chunks(all);
                base64::of_numbers(pixels.flat_map(|pixel| channels.iter().map(|&c| pixel[c])))
            } else {
                let planes: Vec<Vec<f32>> = channels.iter().map(|c| of(c).collect()).collect();
                let image = Image::new(sight.size, channel_names(ty), planes);
                // A preview is looked at, whatever it shows.
                let png = Format::Png(Bits::Eight, Space::Srgb);
                let bytes = image_file::encode(Path::new("picture.png"), &image, png);
                let failed = |error| Failure::new(INTERNAL, format!("{error}"));
                base64::encode(&bytes.map_err(failed)?)
            };
            Ok(json!({
                "format": if sight.is_raw { "raw" } else { "png" },
                "width": sight.size.width,
                "height": sight.size.height,
                "type": ty.name(),
                "block": block,
                "data": data,
            }))
        };
        let picture = Picture::of_view(&sight.view, sight.size);
        let mut pixels = vec![0.0; picture.numbers(&evaluator)];
        let mut coarse = |block: u32, pixels: &[f32]| {
            if block > 1
                && let Receiver::Call(Some(id)) = &task.receiver
                && let Ok(mut picture) = encoded(block, pixels)
            {
                picture["id"] = id.clone();
                let message = super::notification("picture", picture);
                self.writer.write(&message, task.framing);
            }
        };
        let job = Job {
            cancel: Some(cancel),
            blocks: &sight.blocks,
            progress: Some(&mut coarse),
        };
        evaluator
            .render(&picture, &mut pixels, job)
            .map_err(|error| match error {
                RenderError::Cancelled => Failure::new(CANCELLED, "it was cancelled"),
                RenderError::Buffer { .. } => Failure::new(INTERNAL, error.to_string()),
            })?;
        encoded(1, &pixels)
    }
}

/// What a host needs of a shader.
fn shader(compiled: &Compiled, entry: wgsl::Entry, with_tables: bool) -> Value {
    let shader = compiled.shader(&entry.into());
    let parameters = shader.parameters.iter().map(|field| {
        json!({
            "name": field.name,
            "field": field.field,
            "type": field.ty.name(),
            "offset": field.offset,
        })
    });
    let outputs = shader.outputs.iter().map(|field| {
        json!({
            "name": field.name,
            "field": field.field,
            "type": field.ty.name(),
            "variance": field.variance,
        })
    });
    let tables = shader.tables.as_ref().map(|tables| {
        let entries = tables.entries.iter();
        let entries: Vec<Value> = entries
            .map(|(name, first, length)| json!({ "name": name, "first": first, "length": length }))
            .collect();
        let data = with_tables.then(|| base64::of_numbers(tables.data()));
        json!({ "entries": entries, "data": data })
    });
    json!({
        "source": shader.source,
        "function": shader.function,
        "entry_point": shader.entry_point,
        "bindings": shader.bindings,
        "parameters": parameters.collect::<Vec<_>>(),
        "parameters_size": shader.parameters_size,
        "outputs": outputs.collect::<Vec<_>>(),
        "tables": tables,
        "method": compiled.method().to_string(),
    })
}
