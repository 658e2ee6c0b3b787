//! The forms of `compile`, and the tables that engines read as a picture.

use clap::ValueEnum;
use mipless::artifact::Artifact;
use mipless::form::Form;
use mipless::wgsl::TableForm;
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

/// Adds the tables as a picture, which engines read, where a form wants it.
pub(crate) fn push_picture(artifact: &mut Artifact, forms: &[Form]) {
    let wants_picture = |form: &Form| form.tables().is_some() && !matches!(form, Form::ThreeJs);
    let Some(texture) = &artifact.manifest.tables_texture else {
        return;
    };
    let tables = artifact.files.iter().find(|file| file.key == "tables");
    let Some(tables) = tables.filter(|_| forms.iter().any(wants_picture)) else {
        return;
    };
    let size = Size::new(texture.width, texture.height);
    let texels = tables.bytes.chunks_exact(4);
    let texels = texels
        .map(|x| f32::from_le_bytes([x[0], x[1], x[2], x[3]]))
        .collect();
    let image = Image::new(size, &["Y"], vec![texels]);
    let bytes = encode(Path::new("tables.exr"), &image, Format::Exr);
    artifact.push(
        "tables picture",
        "tables.exr",
        bytes.expect("one channel of finite size is a possible EXR"),
    );
}
