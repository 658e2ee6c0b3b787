//! The languages of shaders, and why one has no translation.

use super::validate::ValidateError;
use crate::wgsl::{Shader, Stage, TableForm};
use std::fmt;

/// A shading language.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Target {
    /// The emitted text itself.
    Wgsl,
    /// SPIR-V 1.3 (Vulkan 1.1).
    Spirv,
    /// GLSL 4.50.
    Glsl,
    /// GLSL ES 3.00 (WebGL 2).
    GlslEs,
    /// HLSL, shader model 5.1.
    Hlsl,
    /// Metal Shading Language 2.0.
    Msl,
}

impl Target {
    /// Every target.
    pub const ALL: [Self; 6] = [
        Self::Wgsl,
        Self::Spirv,
        Self::Glsl,
        Self::GlslEs,
        Self::Hlsl,
        Self::Msl,
    ];

    /// The name on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Wgsl => "wgsl",
            Self::Spirv => "spirv",
            Self::Glsl => "glsl",
            Self::GlslEs => "glsl-es",
            Self::Hlsl => "hlsl",
            Self::Msl => "msl",
        }
    }

    /// The target of that name.
    pub fn by_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|target| target.name() == name)
    }

    /// The extension of its files, for the stage of the entry point.
    pub const fn extension(self, stage: Option<Stage>) -> &'static str {
        match (self, stage) {
            (Self::Wgsl, _) => "wgsl",
            (Self::Spirv, _) => "spv",
            (Self::Glsl, Some(Stage::Compute)) => "comp",
            (Self::Glsl, Some(Stage::Fragment)) => "frag",
            (Self::Glsl, None) => "glsl",
            (Self::GlslEs, Some(_)) => "es.frag",
            (Self::GlslEs, None) => "es.glsl",
            (Self::Hlsl, _) => "hlsl",
            (Self::Msl, _) => "metal",
        }
    }

    /// Whether the language cannot hold a function without an entry point.
    pub const fn needs_entry(self) -> bool {
        matches!(self, Self::Spirv)
    }

    /// Where its shaders read tables from, if they are asked to read them from `tables`.
    pub const fn tables(self, tables: TableForm) -> TableForm {
        match (self, tables) {
            (Self::GlslEs, TableForm::Storage) => TableForm::Texture,
            _ => tables,
        }
    }

    /// Why there is no translation of a shader, if the language cannot hold it.
    pub fn refuses(self, shader: &Shader) -> Option<TranslateError> {
        let stage = shader.entry_point.as_ref().map(|entry| entry.stage);
        let reads_buffer = shader.tables.is_some() && shader.table_form == TableForm::Storage;
        match (self, stage) {
            (_, None) if self.needs_entry() => Some(TranslateError::NeedsEntry(self)),
            (Self::GlslEs, Some(Stage::Compute)) => {
                Some(TranslateError::Lacks(self, "compute shaders"))
            }
            (Self::GlslEs, _) if reads_buffer => Some(TranslateError::Lacks(
                self,
                "storage buffers, where the tables are",
            )),
            _ => None,
        }
    }
}

/// Why a shader has no translation.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum TranslateError {
    /// The target has no functions without an entry point, and the shader has no entry point.
    NeedsEntry(Target),
    /// The language has not what the shader needs.
    Lacks(Target, &'static str),
    /// The shader is not valid WGSL: a bug of the emitter.
    Invalid(ValidateError),
    /// naga's back end rejects the shader, in its words.
    BackEnd(Target, String),
}

impl fmt::Display for TranslateError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NeedsEntry(target) => write!(
                f,
                "{} cannot hold a function without an entry point",
                target.name()
            ),
            Self::Lacks(target, what) => write!(f, "{} has no {what}", target.name()),
            Self::Invalid(error) => error.fmt(f),
            Self::BackEnd(target, error) => write!(f, "{}: {error}", target.name()),
        }
    }
}

impl std::error::Error for TranslateError {}

impl From<ValidateError> for TranslateError {
    fn from(error: ValidateError) -> Self {
        Self::Invalid(error)
    }
}
