//! What is looked at, and how: the arguments that the verbs which evaluate a graph share.

use crate::load;
use crate::mistake::Mistake;
use crate::progress;
use crate::report::Report;
use crate::value;
use clap::{Args, ValueEnum};
use mipless::{Interface, Method, Options, Output, Parameter, PixelFilter, Program, Texture, Type};
use mipless_graph::{CheckOptions, suggest};
use mipless_runtime::cpu::Renderer;
use mipless_runtime::device::{Device, DeviceChoice};
use mipless_runtime::image::{Image, outputs};
use mipless_runtime::job::Job;
use mipless_runtime::lit::{self, Hiding, Lit, Sun};
use mipless_runtime::view::{Flat, Part, Size, View};
use std::path::Path;

/// The most pixels of a picture that is held in memory: with all their channels they fit that of common
/// machines.
const MOST_PIXELS: usize = 1 << 27;

/// The arguments.
#[derive(Args, Debug)]
#[group(skip)]
pub(crate) struct Arguments {
    /// The size of the picture in pixels [render: 1280x720, trade: 1280x720, compare: 480x270]
    #[arg(long, value_name = "WxH", value_parser = value::size)]
    size: Option<Size>,

    /// The output of the graph; needed when there are several [render: `all` for all of them]
    #[arg(long, value_name = "NAME")]
    output: Option<String>,

    /// Set an input of the graph: 0.5 or 0.1,0.2,0.3 or #rrggbb or true
    #[arg(long = "set", value_name = "INPUT=VALUE", value_parser = value::setting)]
    settings: Vec<(String, String)>,

    /// A plane to the horizon, a rectangle of texture space, or a lit sphere
    #[arg(long, value_enum, default_value = "plane")]
    view: ViewName,

    /// The rectangle of texture space that the flat view shows [default: 0,0,1,1]
    #[arg(long, value_name = "X0,Y0,X1,Y1", allow_hyphen_values = true,
        value_parser = value::window)]
    window: Option<[f64; 4]>,

    /// Where the sun stands over a material: degrees counter-clockwise from the right, 90 is ahead, and
    /// degrees above the ground [default: 115,28 over a plane, 135,40 flat, 230,40 on a sphere]
    #[arg(long, value_name = "AZIMUTH,ELEVATION", allow_hyphen_values = true,
        value_parser = value::sun)]
    light: Option<Sun>,

    /// The filter over which a pixel is averaged; deviation in pixels
    #[arg(long, value_name = "gaussian:SD|box", default_value = "gaussian:0.5",
        value_parser = value::pixel_filter)]
    pixel_filter: PixelFilter,

    /// Where to evaluate: `auto` is a hardware GPU if there is one, else the CPU
    #[arg(long, value_enum, default_value = "auto")]
    device: DeviceName,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum ViewName {
    Plane,
    Flat,
    Sphere,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum DeviceName {
    Auto,
    Cpu,
    Gpu,
}

impl From<DeviceName> for DeviceChoice {
    fn from(name: DeviceName) -> Self {
        match name {
            DeviceName::Auto => Self::Auto,
            DeviceName::Cpu => Self::Cpu,
            DeviceName::Gpu => Self::Gpu,
        }
    }
}

/// A graph with everything that is needed to look at it.
#[derive(Debug)]
pub(crate) struct Scene {
    /// The graph.
    pub(crate) texture: Texture,
    /// The view.
    pub(crate) view: View,
    /// The size of the picture.
    pub(crate) size: Size,
    /// The pixel filter.
    pub(crate) filter: PixelFilter,
    /// The numbers of the graph's inputs, one a component, in order.
    pub(crate) parameters: Vec<f32>,
    /// The position of the output that is looked at; of several, of the first.
    pub(crate) output: usize,
    /// How many outputs are looked at, one behind the other.
    pub(crate) count: usize,
    /// The device that evaluates.
    pub(crate) device: Device,
    /// The sun, where a material is looked at: the texture's outputs are then its parts.
    pub(crate) sun: Option<Sun>,
    /// Whether the CPU takes the place of a device that fails.
    pub(crate) falls_back: bool,
}

impl Arguments {
    /// Loads the graph, checks the arguments against it, and opens the device.
    pub(crate) fn open(
        &self,
        graph: &Path,
        check: &CheckOptions,
        default: Size,
        report: &mut Report,
    ) -> Result<Scene, Mistake> {
        self.check()?;
        let texture = load::load(graph, check, report)?;
        let scene = self.scene(graph, texture, default)?;
        scene.fits(scene.size)?;
        Ok(scene)
    }

    /// Whether all outputs of a graph are meant.
    pub(crate) fn is_all(&self) -> bool {
        self.output.as_deref() == Some("all")
    }

    /// Checks what can be checked without the graph.
    pub(crate) fn check(&self) -> Result<(), Mistake> {
        if self.window.is_some() && self.view != ViewName::Flat {
            return Err(Mistake::usage("usage", "`--window` is for the flat view")
                .help("add `--view flat`"));
        }
        if let Some(sun) = self.light
            && sun.elevation <= 0.0
            && self.view != ViewName::Sphere
        {
            let message = format!(
                "a sun at {} degrees lights nothing of a plane",
                sun.elevation
            );
            return Err(Mistake::usage("light-below-horizon", message)
                .help("give it an elevation above 0, at most 90, or look at a `--view sphere`"));
        }
        if self.light.is_some() && self.output.is_some() {
            return Err(Mistake::usage(
                "usage",
                "`--light` lights a material, and `--output` shows a part",
            )
            .help("leave one of them out"));
        }
        Ok(())
    }

    /// A scene of a graph that is already loaded.
    pub(crate) fn scene(
        &self,
        graph: &Path,
        texture: Texture,
        default: Size,
    ) -> Result<Scene, Mistake> {
        let parameters = settings(&texture, &self.settings)?;
        let material = match self.output {
            Some(_) => None,
            None => texture.material(
                &lit::parts(),
                &CheckOptions {
                    allow_sampling: true,
                },
            ),
        };
        let is_lit = material.is_some();
        let texture = match material {
            Some(material) => material.map_err(|wrong| Mistake::graph(graph, wrong))?,
            None if self.light.is_some() => {
                return Err(Mistake::usage(
                    "no-surface",
                    "`--light` lights a material, and the graph has none",
                )
                .help("end the graph in a `surface`"));
            }
            None => texture,
        };
        let mut count = 1;
        let (texture, output) = if is_lit {
            (texture, 0)
        } else {
            // An output by the name `all` is an output.
            let all = self.is_all() && !texture.outputs().iter().any(|o| o.name == "all");
            if all {
                count = texture.outputs().len();
            }
            let output = match all {
                true => 0,
                false => output(&texture, self.shown(graph, &texture))?,
            };
            if all || texture.checked().graph().materials.is_empty() {
                (texture, output)
            } else {
                // Of a material most parts are read one by one, and each costs what it reads.
                let name = texture.outputs()[output].name.clone();
                (texture.with_outputs(&[&name]), 0)
            }
        };
        let view = match self.view {
            ViewName::Plane => View::default(),
            ViewName::Flat => {
                let window = self.window.unwrap_or(Flat::default().window);
                View::Flat(Flat { window })
            }
            ViewName::Sphere => View::Sphere(Default::default()),
        };
        let device = Device::open(self.device.into()).map_err(|error| {
            Mistake::usage("no-device", error).help("`--device cpu` works everywhere")
        })?;
        Ok(Scene {
            texture,
            sun: is_lit.then(|| self.light.unwrap_or_else(|| Sun::of(&view))),
            view,
            size: self.size.unwrap_or(default),
            filter: self.pixel_filter,
            parameters,
            output,
            count,
            device,
            falls_back: self.device == DeviceName::Auto,
        })
    }
}

impl Arguments {
    /// The output that is asked for: of a material that another tool wrote its colour, where nothing
    /// else is named.
    fn shown<'a>(&'a self, graph: &Path, texture: &'a Texture) -> Option<&'a str> {
        const COLORS: [&str; 5] = [
            "base_color",
            "albedo",
            "diffuseColor",
            "emission_color",
            "out",
        ];
        let is_foreign = mipless_import::Format::of(graph).is_some();
        let several = texture.outputs().len() > 1;
        let color = || {
            let has = |name: &&&str| texture.outputs().iter().any(|output| output.name == **name);
            COLORS.iter().find(has).copied()
        };
        self.output
            .as_deref()
            .or_else(|| if is_foreign && several { color() } else { None })
    }
}

impl Scene {
    /// The options for a method.
    pub(crate) fn options(&self, method: Method) -> Options {
        Options {
            method,
            filter: self.filter,
            ..Options::default()
        }
    }

    /// The name of the output that is looked at.
    pub(crate) fn output_name(&self) -> &str {
        match self.sun {
            Some(_) => "surface",
            None => &self.texture.outputs()[self.output].name,
        }
    }

    /// The names of the outputs that are looked at.
    pub(crate) fn outputs(&self) -> Vec<String> {
        match self.sun {
            Some(_) => vec![self.output_name().to_owned()],
            None => self
                .shown()
                .iter()
                .map(|output| output.name.clone())
                .collect(),
        }
    }

    /// Their types.
    pub(crate) fn types(&self) -> Vec<Type> {
        match self.sun {
            Some(_) => vec![Type::Color3],
            None => self.shown().iter().map(|output| output.ty).collect(),
        }
    }

    /// Whether the output at `index` of them is looked at as it is.
    pub(crate) fn is_color(&self, index: usize) -> bool {
        self.sun.is_some() || self.texture.is_color(&self.shown()[index])
    }

    fn shown(&self) -> &[Output] {
        &self.texture.outputs()[self.output..self.output + self.count]
    }

    /// Refuses a material where methods are compared on one number after the other.
    pub(crate) fn needs_part(&self) -> Result<(), Mistake> {
        match self.sun {
            None => Ok(()),
            Some(_) => Err(
                Mistake::usage("usage", "methods are measured on a part of a material")
                    .help("name it by `--output`"),
            ),
        }
    }

    /// The light on the material, if one is looked at.
    pub(crate) fn lit(&self, hiding: Hiding) -> Option<Lit> {
        self.sun.map(|sun| Lit::new(&self.view, sun, hiding))
    }

    /// Refuses a picture that does not fit the memory of common machines.
    pub(crate) fn fits(&self, size: Size) -> Result<(), Mistake> {
        if size.pixels() <= MOST_PIXELS {
            return Ok(());
        }
        let message = format!(
            "a picture of {} pixels is held in memory, and has at most {MOST_PIXELS}",
            size.pixels()
        );
        Err(Mistake::usage("too-large", message)
            .help("render a .png without `--moments`, which is written as it is made, or a `--tile` of it"))
    }

    /// The picture that people see.
    pub(crate) fn present(&self, image: &Image) -> Image {
        self.present_part(image, Part::all(self.size))
    }

    /// A part of it.
    pub(crate) fn present_part(&self, image: &Image, part: Part) -> Image {
        match self.sun {
            Some(_) => self.view.present_lit_part(image, part),
            None => self.view.present_part(image, part),
        }
    }

    /// The pictures that people see of all results over a part.
    pub(crate) fn pictures(
        &self,
        interface: &Interface,
        lit: Option<&Lit>,
        all: &Image,
        part: Part,
    ) -> Vec<Image> {
        if let Some(lit) = lit {
            return vec![self.present_part(&lit.light_part(interface, all, part), part)];
        }
        let shown = outputs(interface)
            .into_iter()
            .skip(self.output)
            .take(self.count);
        shown
            .map(|place| self.present_part(&all.mean(&place), part))
            .collect()
    }

    /// Evaluates the material over the view, and lights it.
    pub(crate) fn evaluate_lit(
        &mut self,
        options: &Options,
        lit: &Lit,
        report: &mut Report,
    ) -> Result<Image, Mistake> {
        let (program, all) = self.results(options, Part::all(self.size), report)?;
        Ok(lit.light(&program.interface, &all))
    }

    /// Evaluates the output that is looked at, over the view, without light and background. A GPU that was chosen on its own and fails is replaced by
    /// the CPU, with a warning.
    pub(crate) fn evaluate(
        &mut self,
        options: &Options,
        report: &mut Report,
    ) -> Result<Image, Mistake> {
        let (program, all) = self.results(options, Part::all(self.size), report)?;
        Ok(all.mean(&outputs(&program.interface)[self.output]))
    }

    /// The program, and all of its results over a part of the picture.
    pub(crate) fn results(
        &mut self,
        options: &Options,
        part: Part,
        report: &mut Report,
    ) -> Result<(Program, Image), Mistake> {
        let program = self.texture.compile(options);
        let label = options.method.to_string();
        let all = match self.on_gpu(&program, part, &label, report) {
            Some(Ok(image)) => image,
            Some(Err(error)) if self.falls_back => {
                let message = format!("{}: {error}; the CPU evaluates instead", self.device);
                report.warn("device-failed", message);
                self.device = Device::Cpu;
                self.on_cpu(&program, part, &label, report)?
            }
            Some(Err(error)) => {
                let message = format!("{}: {error}", self.device);
                return Err(Mistake::usage("device-failed", message)
                    .help("`--device cpu` works everywhere"));
            }
            None => self.on_cpu(&program, part, &label, report)?,
        };
        Ok((program, all))
    }

    fn on_cpu(
        &self,
        program: &Program,
        part: Part,
        label: &str,
        report: &Report,
    ) -> Result<Image, Mistake> {
        let mut renderer = Renderer::<f32>::new(program);
        renderer.set_parameters(&self.parameters);
        let render = |job: Job<'_>| renderer.render_part(&self.view, part, job);
        progress::watch(report, label, render)
            .map_err(|error| Mistake::usage("render-failed", error))
    }

    /// `None` if the device is no GPU.
    fn on_gpu(
        &self,
        program: &Program,
        part: Part,
        label: &str,
        report: &Report,
    ) -> Option<Result<Image, mipless_runtime::gpu::GpuError>> {
        let Device::Gpu(gpu) = &self.device else {
            return None;
        };
        let render = |job: Job<'_>| {
            let pipeline = gpu.pipeline(program)?;
            gpu.set_parameters(&pipeline, &self.parameters)?;
            Ok(gpu.render_part(&pipeline, &self.view, part, job)?.0)
        };
        Some(progress::watch(report, label, render))
    }
}

/// The numbers of all inputs, with these set.
fn settings(texture: &Texture, settings: &[(String, String)]) -> Result<Vec<f32>, Mistake> {
    let parameters = texture.parameters();
    let mut values: Vec<Vec<f32>> = parameters.iter().map(|p| p.value.numbers()).collect();
    let mut wrong = Vec::new();
    for (name, text) in settings {
        let Some(index) = parameters.iter().position(|p| p.name == *name) else {
            let names = parameters.iter().map(|p| p.name.as_str());
            let near = suggest(name, names).map(|near| format!("did you mean `{near}`? "));
            let message = format!("the graph has no input `{name}`");
            let help = near.unwrap_or_default() + &inputs(parameters);
            wrong.push(mipless::Diagnostic::error("unknown-input", message).help(help));
            continue;
        };
        match parameters[index].parse(text) {
            Ok(value) => values[index] = value.numbers(),
            Err(error) => {
                let message = format!("input `{name}`: {error}");
                let help = inputs(&parameters[index..=index]);
                wrong.push(mipless::Diagnostic::error("bad-setting", message).help(help));
            }
        }
    }
    if wrong.is_empty() {
        Ok(values.concat())
    } else {
        Err(Mistake {
            status: crate::mistake::Status::Usage,
            file: None,
            diagnostics: wrong,
        })
    }
}

/// The inputs with their types, defaults and ranges.
pub(crate) fn inputs(parameters: &[Parameter]) -> String {
    if parameters.is_empty() {
        return "the graph has no inputs".to_owned();
    }
    let one = |p: &Parameter| {
        let value: Vec<String> = p.value.numbers().iter().map(f32::to_string).collect();
        let range = match (p.min, p.max) {
            (Some(min), Some(max)) => format!(", from {min} to {max}"),
            (Some(min), None) => format!(", at least {min}"),
            (None, Some(max)) => format!(", at most {max}"),
            (None, None) => String::new(),
        };
        format!("`{}` ({} {}{range})", p.name, p.ty, value.join(","))
    };
    let noun = if parameters.len() == 1 {
        "the input is"
    } else {
        "the inputs are"
    };
    format!(
        "{noun} {}",
        parameters.iter().map(one).collect::<Vec<_>>().join(", ")
    )
}

/// The position of the output that is asked for.
fn output(texture: &Texture, name: Option<&str>) -> Result<usize, Mistake> {
    let outputs = texture.outputs();
    let names: Vec<&str> = outputs.iter().map(|output| output.name.as_str()).collect();
    let listed = format!("the outputs are `{}`", names.join("`, `"));
    match name {
        None if names.len() == 1 => Ok(0),
        None => Err(
            Mistake::usage("which-output", "the graph has several outputs")
                .help(format!("add `--output NAME`; {listed}")),
        ),
        Some(name) => names
            .iter()
            .position(|known| *known == name)
            .ok_or_else(|| {
                let near = suggest(name, names.iter().copied());
                let near = near
                    .map(|near| format!("did you mean `{near}`? "))
                    .unwrap_or_default();
                Mistake::usage(
                    "unknown-output",
                    format!("the graph has no output `{name}`"),
                )
                .help(near + &listed)
            }),
    }
}

/// Refuses a path whose folder does not exist, before any work is done for it.
pub(crate) fn writable(path: &Path) -> Result<(), Mistake> {
    let folder = match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    let unwritable = |reason: &str| {
        Err(Mistake::usage(
            "unwritable-file",
            format!("{}: {reason}", path.display()),
        ))
    };
    if !folder.is_dir() {
        return unwritable("its folder does not exist");
    }
    if path.is_dir() {
        return unwritable("it is a folder");
    }
    Ok(())
}
