//! Forms: the texture's function in the file that a host takes.
//!
//! A form is a text about a function that a target translates: a header, a wrapper that takes what the
//! host has at hand (a coordinate, its derivatives, the host's own types) and calls the function. None
//! changes the function, so that all hosts show the same pixels.

mod glsl;
mod hlsl;
mod library;
mod materialx;
mod script;
mod wgsl_module;

use crate::target::{Range, TranslateError, Validated};
use crate::wgsl::{Entry, Options, Shader, TableForm};
use library::Library;

/// A kind of file that a host takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Form {
    /// A WGSL module that naga_oil (Bevy) imports.
    NagaOil,
    /// A module of WESL.
    Wesl,
    /// A shader include of Godot 4.
    Godot,
    /// A file for the Custom Function node of Unity's Shader Graph.
    Unity,
    /// A file that a Custom node of Unreal Engine includes.
    Unreal,
    /// Modules of JavaScript for three.js: nodes (TSL, WebGPU) and a raw material (WebGL 2).
    ThreeJs,
    /// A node definition of MaterialX with an implementation for `genglsl`.
    MaterialX,
}

/// A file of a form.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FormFile {
    /// What follows the texture's name: `gdshaderinc`.
    pub extension: &'static str,
    /// Its text.
    pub text: String,
}

impl Form {
    /// Every form.
    pub const ALL: [Self; 7] = [
        Self::NagaOil,
        Self::Wesl,
        Self::Godot,
        Self::Unity,
        Self::Unreal,
        Self::ThreeJs,
        Self::MaterialX,
    ];

    /// The name on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Self::NagaOil => "naga-oil",
            Self::Wesl => "wesl",
            Self::Godot => "godot",
            Self::Unity => "unity",
            Self::Unreal => "unreal",
            Self::ThreeJs => "threejs",
            Self::MaterialX => "materialx",
        }
    }

    /// Where the form reads tables from: hosts of some bind textures themselves and pass them.
    pub const fn tables(self) -> Option<TableForm> {
        match self {
            Self::NagaOil | Self::Wesl => None,
            Self::Godot => Some(TableForm::Texture),
            Self::Unity | Self::Unreal | Self::ThreeJs | Self::MaterialX => {
                Some(TableForm::Argument)
            }
        }
    }

    /// How a texture is emitted for this form, where it is otherwise emitted like this.
    pub const fn emission(self, options: Options) -> Options {
        let tables = match self.tables() {
            Some(tables) => tables,
            None => options.tables,
        };
        Options {
            entry: Entry::None,
            shared_footprint: false,
            tables,
            ..options
        }
    }

    /// The files of a shader that was emitted for this form; `name` is that of the files, `range` what
    /// the graph allows for the input of that name.
    ///
    /// # Errors
    /// If naga's back end rejects the shader.
    pub fn files(
        self,
        validated: &Validated,
        shader: &Shader,
        name: &str,
        range: impl Fn(&str) -> Range,
    ) -> Result<Vec<FormFile>, TranslateError> {
        let library = |target| Library::new(validated, shader, target, name, &range);
        match self {
            Self::NagaOil => Ok(vec![wgsl_module::naga_oil(shader)]),
            Self::Wesl => Ok(vec![wgsl_module::wesl(shader, name)]),
            Self::Godot => Ok(vec![glsl::godot(&library(crate::target::Target::GlslEs)?)]),
            Self::Unity => Ok(vec![hlsl::unity(&library(crate::target::Target::Hlsl)?)]),
            Self::Unreal => Ok(vec![hlsl::unreal(&library(crate::target::Target::Hlsl)?)]),
            Self::ThreeJs => Ok(vec![
                script::nodes(&library(crate::target::Target::Wgsl)?),
                script::material(&library(crate::target::Target::GlslEs)?),
            ]),
            Self::MaterialX => {
                let library = library(crate::target::Target::Glsl)?;
                Ok(vec![
                    materialx::definition(&library),
                    materialx::source(&library),
                ])
            }
        }
    }
}

#[cfg(test)]
mod tests;
