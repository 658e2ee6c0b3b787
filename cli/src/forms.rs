//! The shader files of `compile`: a text for every target and form, and the tables that they read.

use clap::ValueEnum;
use mipless::form::Form;
use mipless::target::{Range, Target, TranslateError, Validated, validate};
use mipless::wgsl::{self, Shader, TABLE_WIDTH, TableForm};
use mipless_runtime::image::Image;
use mipless_runtime::image_file::{Format, encode};
use mipless_runtime::view::Size;
use std::path::Path;

/// The name of a form.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, ValueEnum)]
pub(crate) enum FormName {
    NagaOil,
    Wesl,
    Godot,
    Unity,
    Unreal,
    Threejs,
    Materialx,
}

impl From<FormName> for Form {
    fn from(name: FormName) -> Self {
        match name {
            FormName::NagaOil => Self::NagaOil,
            FormName::Wesl => Self::Wesl,
            FormName::Godot => Self::Godot,
            FormName::Unity => Self::Unity,
            FormName::Unreal => Self::Unreal,
            FormName::Threejs => Self::ThreeJs,
            FormName::Materialx => Self::MaterialX,
        }
    }
}

/// Where shaders read tables from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum TablesName {
    #[default]
    Storage,
    Texture,
    Argument,
}

impl From<TablesName> for TableForm {
    fn from(name: TablesName) -> Self {
        match name {
            TablesName::Storage => Self::Storage,
            TablesName::Texture => Self::Texture,
            TablesName::Argument => Self::Argument,
        }
    }
}

/// A file: its key in the manifest, what follows the texture's name, its bytes.
pub(crate) type File = (String, &'static str, Vec<u8>);

/// How a graph is emitted where nothing is special: as its first target or form wants it.
pub(crate) fn emission(targets: &[Target], forms: &[Form], asked: wgsl::Options) -> wgsl::Options {
    match (targets.first(), forms.first()) {
        (Some(target), _) => wgsl::Options {
            tables: target.tables(asked.tables),
            ..asked
        },
        (None, Some(form)) => form.emission(asked),
        (None, None) => asked,
    }
}

/// The files of a texture: `emit` emits it, `shader` is what it emits by `emission`.
pub(crate) fn files(
    (targets, forms): (&[Target], &[Form]),
    emit: impl Fn(&wgsl::Options) -> Shader,
    (shader, emission): (&Shader, wgsl::Options),
    name: &str,
    range: impl Fn(&str) -> Range,
) -> Result<Vec<File>, TranslateError> {
    let mut files = Vec::new();
    // Most want what the first wants: a text is read once.
    let mut last = (emission, shader.clone(), read(shader, &emission)?);
    let mut texture = false;
    let mut at = |options: wgsl::Options, last: &mut (wgsl::Options, Shader, Validated)| {
        if last.0 != options {
            let shader = emit(&options);
            let validated = read(&shader, &options)?;
            *last = (options, shader, validated);
        }
        texture |= options.tables != TableForm::Storage;
        Ok::<_, TranslateError>(())
    };
    for &target in targets {
        let options = wgsl::Options {
            tables: target.tables(emission.tables),
            ..emission
        };
        at(options, &mut last)?;
        let (_, shader, validated) = &last;
        let bytes = validated.translate(shader, target)?;
        let stage = shader.entry_point.as_ref().map(|entry| entry.stage);
        files.push((target.name().to_owned(), target.extension(stage), bytes));
    }
    for &form in forms {
        at(form.emission(emission), &mut last)?;
        let (_, shader, validated) = &last;
        let written = form.files(validated, shader, name, &range)?;
        let several = written.len() > 1;
        for file in written {
            let key = match several {
                true => format!("{} {}", form.name(), file.extension),
                false => form.name().to_owned(),
            };
            files.push((key, file.extension, file.text.into_bytes()));
        }
    }
    if let Some(tables) = &shader.tables {
        let numbers = if texture {
            tables.texels()
        } else {
            tables.data()
        };
        let bytes = numbers.iter().flat_map(|x| x.to_le_bytes()).collect();
        files.push(("tables".to_owned(), "tables.bin", bytes));
        // Engines read pictures.
        let wants_picture = |form: &Form| form.tables().is_some() && !matches!(form, Form::ThreeJs);
        if forms.iter().any(wants_picture) {
            let size = Size {
                width: TABLE_WIDTH,
                height: tables.rows(),
            };
            let image = Image::new(size, &["Y"], vec![tables.texels()]);
            let bytes = encode(Path::new("tables.exr"), &image, Format::Exr);
            let bytes = bytes.expect("one channel of finite size is a possible EXR");
            files.push(("tables picture".to_owned(), "tables.exr", bytes));
        }
    }
    Ok(files)
}

/// Reads and validates a text; one that declares no `Footprint` behind its declaration.
fn read(shader: &Shader, options: &wgsl::Options) -> Result<Validated, TranslateError> {
    let validated = if options.shared_footprint {
        validate(&format!("{}{}", *wgsl::DECLARATIONS, shader.source))
    } else {
        validate(&shader.source)
    };
    Ok(validated?)
}
