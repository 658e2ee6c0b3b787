//! WGSL text of a [`Program`]: readable, deterministic to the byte, accepted by naga.
//!
//! # The shader
//! A texture named `marble` becomes
//! ```wgsl
//! struct Footprint { cell: vec2i, uv: vec2f, du: vec2f, dv: vec2f }
//! struct MarbleParameters { scale: f32, … }
//! struct MarbleOutputs { base_color: vec3f, … }
//! fn marble(footprint: Footprint, parameters: MarbleParameters) -> MarbleOutputs
//! ```
//! - A graph that reads the position in space takes it as its second argument:
//!   `struct Position { cell: vec3i, xyz: vec3f, dx: vec3f, dy: vec3f }`, at cell + xyz, with the
//!   changes to the next pixel on the right and below.
//! - Without parameters there is no `MarbleParameters` and no second argument.
//! - With [`Interface::moments`](crate::ir::Interface::moments), `base_color_variance` and so on
//!   follow all means. A boolean parameter is a `u32`, not 0 for true.
//! - No derivative built-ins and no globals; one binding, [`TABLES_BINDING`], if there are tables.
//!   [`Options`] moves all bindings to another group and to higher numbers, and makes of the tables'
//!   buffer a texture, or a texture that the function takes as its first argument.
//! - Every other name begins with the texture's; none is a reserved word of WGSL, GLSL, HLSL or MSL,
//!   and none ends in a digit, so that naga's writers and naga_oil leave it as it is.
//! - No function has more than about 200 statements: long ones call their parts.
//!
//! # The compute entry point
//! `marble_compute` evaluates an array of footprints, with workgroups of [`WORKGROUP_SIZE`]:
//! | binding of group 0 | holds |
//! |---|---|
//! | 0 storage, read | `array<Footprint>`: 32 bytes each: `cell` 2 × i32, `uv`, `du`, `dv` 2 × f32 each; where the position is read, `array<Pixel>`: 96 bytes each, the footprint and then `cell` 3 × i32, `xyz`, `dx`, `dy` 3 × f32 each, each in 16 bytes |
//! | 1 uniform | the struct of parameters, laid out as [`Shader::parameters`] says and packed by [`Shader::pack_parameters`]; absent without parameters |
//! | 2 storage, read and write | `array<f32>`: for each footprint all scalars of all outputs in order, without padding; integers and truth values (0, 1) as f32 |
//! | 3 storage, read | the tables, [`Tables::data`]; absent without tables; as a texture ([`TableForm`]) [`Tables::texels`], in rows of [`TABLE_WIDTH`], one `f32` a texel |
//!
//! Pixel `index` is invocation `(index % 65536, index / 65536)`, so dispatch [`workgroups`]. What is
//! not below the length of binding 0 does nothing.
//!
//! # Shading
//! From [`emit_shaded`] there are two functions of a material's parts (see [`crate::shade`]), which take the
//! struct of outputs:
//! ```wgsl
//! fn marble_shade(surface: MarbleOutputs, view: vec3f, light: vec3f, light_color: vec3f) -> vec3f
//! fn marble_shade_sky(surface: MarbleOutputs, view: vec3f, sky: array<vec3f, 9>) -> vec3f
//! ```
//!
//! # The fragment entry point
//! `marble_fragment` takes `uv` at location 0 and returns one `vec4f` per output, at locations 0, 1,
//! …: a single number as grey, alpha 1 where there is none. `du` and `dv` are its screen-space
//! derivatives; parameters and tables are bound as above.

mod apart;
mod entry;
mod expression;
mod function;
mod gap;
mod name;
mod part;
mod reserved;
mod shading;
mod spelled;
mod statement;
mod table;
mod wrapped;

pub(crate) use gap::Spelled;
pub use name::identifier;

use crate::ir::{FunctionId, Inst, Numbers, Program, Type};
pub use entry::DECLARATIONS;
use entry::{Names, entry_text, face, push_entry_point, push_structs};
use function::{Context, Signature};
pub(crate) use name::camel;
use name::{Scope, callable, internal};
use serde::Serialize;
pub use table::{TABLE_WIDTH, TableForm};

/// The binding of the footprints, in group 0.
pub const FOOTPRINTS_BINDING: u32 = 0;
/// The binding of the parameters, in group 0.
pub const PARAMETERS_BINDING: u32 = 1;
/// The binding of the outputs, in group 0.
pub const OUTPUTS_BINDING: u32 = 2;
/// The binding of the tables, in group 0.
pub const TABLES_BINDING: u32 = 3;
/// Invocations in a workgroup of the compute entry point.
pub const WORKGROUP_SIZE: u32 = 64;
/// Invocations in a row of a dispatch of the compute entry point.
pub const PIXELS_PER_ROW: u32 = 1 << 16;

/// How many workgroups the compute entry point needs for so many pixels, in x, y and z.
pub const fn workgroups(pixels: u32) -> [u32; 3] {
    if pixels <= PIXELS_PER_ROW {
        [pixels.div_ceil(WORKGROUP_SIZE), 1, 1]
    } else {
        [
            PIXELS_PER_ROW / WORKGROUP_SIZE,
            pixels.div_ceil(PIXELS_PER_ROW),
            1,
        ]
    }
}

/// Which entry point goes with the function.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Entry {
    /// None: the function alone, to be called from other shaders.
    #[default]
    None,
    /// A fragment shader.
    Fragment,
    /// A compute shader over an array of footprints.
    Compute,
}

/// How to emit. The default is the function alone, with its tables in a buffer at binding 3 of group 0.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Options {
    /// The entry point.
    pub entry: Entry,
    /// The group of all bindings.
    pub group: u32,
    /// What is added to the numbers of all bindings: the tables are at this + [`TABLES_BINDING`].
    pub binding: u32,
    /// Whether `Footprint` and `Position` are declared elsewhere, so that several textures stand in
    /// one module: the text is valid only behind [`DECLARATIONS`].
    pub shared_footprint: bool,
    /// Where the tables are read from, if there are any.
    pub tables: TableForm,
}

impl From<Entry> for Options {
    fn from(entry: Entry) -> Self {
        Self {
            entry,
            ..Self::default()
        }
    }
}

/// The stage of an entry point.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Stage {
    /// A fragment shader.
    Fragment,
    /// A compute shader.
    Compute,
}

/// An entry point.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct EntryPoint {
    /// The function's name.
    pub name: String,
    /// Its stage.
    pub stage: Stage,
}

/// What a binding holds: see the module's documentation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum BindingKind {
    /// The footprints of the pixels.
    Footprints,
    /// The parameters.
    Parameters,
    /// The outputs of the pixels.
    Outputs,
    /// The tables.
    Tables,
}

/// A buffer that the shader reads or writes.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Binding {
    /// The group.
    pub group: u32,
    /// The binding in its group.
    pub binding: u32,
    /// The variable's name.
    pub name: String,
    /// What it holds.
    pub kind: BindingKind,
}

/// A member of the struct of parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct ParameterField {
    /// The input's name in the graph.
    pub name: String,
    /// The member's name.
    pub field: String,
    /// The type in the graph.
    pub ty: mipless_graph::Type,
    /// The type of each component in the struct; `U32` for booleans.
    pub scalar: Type,
    /// The first byte in the uniform struct.
    pub offset: u32,
    /// The default, one number a component.
    pub default: Vec<f32>,
}

/// A member of the struct of outputs.
#[derive(Clone, Debug, PartialEq)]
pub struct OutputField {
    /// The output's name in the graph.
    pub name: String,
    /// The member's name.
    pub field: String,
    /// The type in the graph.
    pub ty: mipless_graph::Type,
    /// The type of each component.
    pub scalar: Type,
    /// Whether it is the variance of that output, not its mean.
    pub variance: bool,
    /// The position of the first component among all scalars of a pixel.
    pub first: u32,
}

/// All tables of a shader, one after the other.
#[derive(Clone, Debug, PartialEq)]
pub struct Tables {
    /// Their numbers, in order; computed when they are first read.
    pub numbers: Vec<Numbers>,
    /// Each table's name, first number and length.
    pub entries: Vec<(String, u32, u32)>,
}

impl Tables {
    /// All numbers, one table after the other.
    pub fn data(&self) -> Vec<f32> {
        self.numbers
            .iter()
            .flat_map(|numbers| numbers.iter().copied())
            .collect()
    }

    /// How many rows of [`TABLE_WIDTH`] numbers a texture of them has.
    pub fn rows(&self) -> u32 {
        let last = self.entries.last();
        last.map_or(0, |(_, first, length)| {
            (first + length).div_ceil(TABLE_WIDTH)
        })
    }

    /// The same numbers as a texture's texels, row by row: 0 behind the last.
    pub fn texels(&self) -> Vec<f32> {
        let mut texels = self.data();
        texels.resize((self.rows() * TABLE_WIDTH) as usize, 0.0);
        texels
    }
}

/// WGSL text and what a host needs to know of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Shader {
    /// The text.
    pub source: String,
    /// The texture's function.
    pub function: String,
    /// The functions that shade its outputs, if they were asked for: by a light, and by a sky.
    pub shading: Vec<String>,
    /// The entry point, if one was asked for.
    pub entry_point: Option<EntryPoint>,
    /// Every binding, in order.
    pub bindings: Vec<Binding>,
    /// The members of the struct of parameters, in order.
    pub parameters: Vec<ParameterField>,
    /// The size of that struct in bytes, a multiple of 16; 0 without parameters.
    pub parameters_size: u32,
    /// The members of the struct of outputs, in order.
    pub outputs: Vec<OutputField>,
    /// The contents of the binding of tables, if there are any.
    pub tables: Option<Tables>,
    /// Where they are read from.
    pub table_form: TableForm,
    /// The struct of outputs.
    pub outputs_struct: String,
    /// The struct of parameters, which is declared if there are any.
    pub parameters_struct: String,
    /// The variable of the tables, which is declared if there are any and they are no argument.
    pub tables_name: String,
    /// Whether the function takes the position in space as its second argument.
    pub position: bool,
}

impl Shader {
    /// How many numbers the compute entry point writes for each pixel.
    pub fn scalars_per_pixel(&self) -> usize {
        self.outputs.iter().map(|o| o.ty.components()).sum()
    }

    /// The bytes of the parameters' buffer for these numbers, one a component in the parameters'
    /// order; integers and truth values are converted.
    ///
    /// # Panics
    /// If there are not as many numbers as components.
    pub fn pack_parameters(&self, numbers: &[f32]) -> Vec<u8> {
        let components: usize = self.parameters.iter().map(|p| p.ty.components()).sum();
        assert_eq!(numbers.len(), components, "numbers for the parameters");
        let mut bytes = vec![0; self.parameters_size as usize];
        let mut numbers = numbers.iter();
        for field in &self.parameters {
            for (component, &number) in numbers.by_ref().take(field.ty.components()).enumerate() {
                let word = match field.scalar {
                    Type::F32 => number.to_le_bytes(),
                    Type::I32 => (number as i32).to_le_bytes(),
                    Type::U32 | Type::Bool => (number as u32).to_le_bytes(),
                };
                let at = field.offset as usize + 4 * component;
                bytes[at..at + 4].copy_from_slice(&word);
            }
        }
        bytes
    }
}

/// Emits a program.
///
/// # Panics
/// If the program breaks an invariant of the IR, or its interface does not fit its entry: see
/// [`verify`](crate::ir::verify).
pub fn emit(program: &Program, options: &Options) -> Shader {
    emitted(program, options, false)
}

/// Emits a program whose outputs are parts of a material, with functions that shade them: see the module's
/// documentation.
///
/// # Panics
/// As [`emit`].
pub fn emit_shaded(program: &Program, options: &Options) -> Shader {
    emitted(program, options, true)
}

fn emitted(program: &Program, options: &Options, is_shaded: bool) -> Shader {
    let module = &program.module;
    let prefix = callable(identifier(&program.interface.name));
    let stem = prefix.strip_suffix("_value").unwrap_or(&prefix);
    let mut globals = Scope::default();
    globals.take("Footprint".to_owned());
    globals.take("Position".to_owned());
    globals.take("Pixel".to_owned());
    let names = Names {
        function: globals.take(prefix.clone()),
        parameters: globals.take(format!("{}Parameters", camel(stem))),
        outputs: globals.take(format!("{}Outputs", camel(stem))),
        tables: globals.take(format!("{stem}_tables")),
    };
    let face = face(program);

    let mut reached = vec![false; module.functions.len()];
    reached[module.functions.len() - 1] = true;
    let mut instructions = 0;
    for index in (0..module.functions.len()).rev() {
        if reached[index] {
            instructions += module.functions[index].insts.len();
            for inst in &module.functions[index].insts {
                if let Inst::Call(callee, _)
                | Inst::Fold {
                    function: callee, ..
                } = inst
                {
                    reached[callee.index()] = true;
                }
            }
        }
    }
    let last = module.functions.len() - 1;
    let signatures: Vec<Option<Signature>> = (module.functions.iter().enumerate())
        .map(|(index, function)| {
            if index == last {
                return Some(Signature::of_entry(&names.function));
            }
            reached[index].then(|| {
                let name = callable(internal(&format!("{stem}_{}", function.name)));
                let name = globals.take(name);
                Signature::new(name, function, &mut globals)
            })
        })
        .collect();

    let tables = (!module.tables.is_empty()).then(|| {
        let mut tables = Tables {
            numbers: Vec::new(),
            entries: Vec::new(),
        };
        let mut first = 0;
        for table in &module.tables {
            let length = table.data.len() as u32;
            tables.entries.push((table.name.clone(), first, length));
            tables.numbers.push(table.data.clone());
            first += length;
        }
        tables
    });
    let offsets: Vec<u32> = (tables.iter())
        .flat_map(|t| t.entries.iter().map(|e| e.1))
        .collect();
    let form = options.tables;
    let reader = (tables.is_some() && form != TableForm::Storage)
        .then(|| globals.take(format!("{stem}_number")));
    let mut context = Context {
        module,
        signatures: &signatures,
        globals,
        tables: &table::Reading::new(module, form, &names.tables, reader),
        table_offsets: &offsets,
        out: String::with_capacity(1024 + 40 * instructions),
    };
    push_structs(&mut context.out, &names, &face, options);
    if tables.is_some() {
        context.tables.push(&mut context.out, options);
    }
    let written: Vec<FunctionId> = (0..last)
        .filter(|&index| reached[index])
        .map(FunctionId::from_index)
        .collect();
    apart::write(&mut context, &written);
    let takes_tables = context.tables.is_argument_of(FunctionId::from_index(last));
    let text = entry_text(program, &names, &face, takes_tables);
    function::write(&mut context, FunctionId::from_index(last), Some(&text));
    let shading = if is_shaded {
        shading::push(&mut context, &names, &face, stem)
    } else {
        Vec::new()
    };

    let Context {
        mut globals,
        out: mut source,
        ..
    } = context;
    let (entry_point, mut bindings) = push_entry_point(
        &mut source,
        &mut globals,
        options,
        &names,
        &face,
        takes_tables,
    );
    source.truncate(source.trim_end().len());
    source.push('\n');
    let source = wrapped::wrapped(source);
    if tables.is_some() && (form != TableForm::Argument || entry_point.is_some()) {
        bindings.push(Binding {
            group: options.group,
            binding: options.binding + TABLES_BINDING,
            name: names.tables.clone(),
            kind: BindingKind::Tables,
        });
    }
    Shader {
        source,
        function: names.function,
        shading,
        entry_point,
        bindings,
        parameters: face.parameters,
        parameters_size: face.parameters_size,
        outputs: face.outputs,
        position: face.position,
        tables,
        table_form: form,
        outputs_struct: names.outputs,
        parameters_struct: names.parameters,
        tables_name: names.tables,
    }
}

#[cfg(all(test, feature = "targets"))]
mod tests;
