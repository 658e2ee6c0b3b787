//! Translation of a shader into another shading language.

use super::{ValidateError, Validated, validate};
use crate::wgsl::{BindingKind, Shader, Stage};
use naga::back::{glsl, hlsl, msl, spv};
use naga::proc::BoundsCheckPolicies;
use naga::{ResourceBinding, ShaderStage};
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
    /// HLSL, shader model 5.1.
    Hlsl,
    /// Metal Shading Language 2.0.
    Msl,
}

impl Target {
    /// Every target.
    pub const ALL: [Self; 5] = [Self::Wgsl, Self::Spirv, Self::Glsl, Self::Hlsl, Self::Msl];

    /// The name on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Wgsl => "wgsl",
            Self::Spirv => "spirv",
            Self::Glsl => "glsl",
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
            (Self::Glsl, _) => "frag",
            (Self::Hlsl, _) => "hlsl",
            (Self::Msl, _) => "metal",
        }
    }

    /// Whether the language cannot hold a function without an entry point.
    pub const fn needs_entry(self) -> bool {
        matches!(self, Self::Spirv | Self::Glsl)
    }
}

/// A translated shader: text in UTF-8, or the bytes of SPIR-V (little endian).
pub type Translated = Vec<u8>;

/// Why a shader has no translation.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum TranslateError {
    /// The target has no functions without an entry point, and the shader has no entry point.
    NeedsEntry(Target),
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

/// Validates a shader and translates it: see [`Validated::translate`].
///
/// # Errors
/// If the target needs an entry point that the shader has not, or naga rejects the shader.
pub fn translate(shader: &Shader, target: Target) -> Result<Translated, TranslateError> {
    validate(&shader.source)?.translate(shader, target)
}

impl Validated {
    /// Translates the shader that this is naga's form of; for several targets it is read once.
    /// Bindings keep their numbers: GLSL's `binding`, HLSL's registers (space 0), Metal's buffer
    /// indices. Metal's shaders read the byte lengths of their arrays from buffer 8, or from the one
    /// behind the last binding if that is higher, in the order in which the text declares them.
    ///
    /// # Errors
    /// If the target needs an entry point that the shader has not, or naga's back end rejects it.
    pub fn translate(&self, shader: &Shader, target: Target) -> Result<Translated, TranslateError> {
        if target.needs_entry() && shader.entry_point.is_none() {
            return Err(TranslateError::NeedsEntry(target));
        }
        let (module, info) = (&self.module, &self.info);
        let failed = |error: &dyn fmt::Display| TranslateError::BackEnd(target, error.to_string());
        let entry = shader.entry_point.as_ref().map(|entry| {
            let stage = match entry.stage {
                Stage::Fragment => ShaderStage::Fragment,
                Stage::Compute => ShaderStage::Compute,
            };
            (stage, entry.name.clone())
        });
        let resources = || {
            (shader.bindings.iter()).map(|b| {
                (
                    ResourceBinding {
                        group: b.group,
                        binding: b.binding,
                    },
                    b,
                )
            })
        };
        match target {
            Target::Wgsl => Ok(shader.source.clone().into_bytes()),
            Target::Spirv => {
                let options = spv::Options {
                    lang_version: (1, 3),
                    flags: spv::WriterFlags::DEBUG | spv::WriterFlags::LABEL_VARYINGS,
                    ..spv::Options::default()
                };
                let words = spv::write_vec(module, info, &options, None).map_err(|e| failed(&e))?;
                Ok(words.into_iter().flat_map(u32::to_le_bytes).collect())
            }
            Target::Glsl => {
                let options = glsl::Options {
                    version: glsl::Version::Desktop(450),
                    writer_flags: glsl::WriterFlags::empty(),
                    binding_map: resources().map(|(at, b)| (at, b.binding as u8)).collect(),
                    ..glsl::Options::default()
                };
                let (shader_stage, entry_point) =
                    entry.ok_or(TranslateError::NeedsEntry(target))?;
                let pipeline = glsl::PipelineOptions {
                    shader_stage,
                    entry_point,
                    multiview: None,
                };
                let policies = BoundsCheckPolicies::default();
                let mut text = String::new();
                glsl::Writer::new(&mut text, module, info, &options, &pipeline, policies)
                    .and_then(|mut writer| writer.write())
                    .map_err(|e| failed(&e))?;
                Ok(text.into_bytes())
            }
            Target::Hlsl => {
                let options = hlsl::Options::default();
                let pipeline = hlsl::PipelineOptions { entry_point: None };
                let mut text = String::new();
                hlsl::Writer::new(&mut text, &options, &pipeline)
                    .write(module, info, None)
                    .map_err(|e| failed(&e))?;
                Ok(text.into_bytes())
            }
            Target::Msl => {
                let resources = resources().map(|(at, binding)| {
                    let target = msl::BindTarget {
                        buffer: Some(binding.binding as u8),
                        mutable: binding.kind == BindingKind::Outputs,
                        ..msl::BindTarget::default()
                    };
                    (at, target)
                });
                let slots = msl::EntryPointResources {
                    resources: resources.collect(),
                    sizes_buffer: Some(sizes_buffer(shader)),
                    ..msl::EntryPointResources::default()
                };
                let options = msl::Options {
                    lang_version: (2, 0),
                    per_entry_point_map: entry
                        .into_iter()
                        .map(|(_, name)| (name, slots.clone()))
                        .collect(),
                    fake_missing_bindings: false,
                    ..msl::Options::default()
                };
                let pipeline = msl::PipelineOptions::default();
                let (text, _) =
                    msl::write_string(module, info, &options, &pipeline).map_err(|e| failed(&e))?;
                Ok(text.into_bytes())
            }
        }
    }
}

/// Where Metal's shaders read the byte lengths of their arrays: behind all bindings.
fn sizes_buffer(shader: &Shader) -> u8 {
    let last = shader.bindings.iter().map(|b| b.binding).max();
    last.map_or(8, |last| last.max(7) as u8 + 1)
}

#[cfg(test)]
mod tests;
