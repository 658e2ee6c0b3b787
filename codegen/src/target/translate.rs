//! Translation of a shader into another shading language.

use super::glsl;
use super::included::included;
use super::language::{Target, TranslateError};
use super::validate::{Validated, validate};
use crate::wgsl::{BindingKind, Shader, TableForm};
use naga::ResourceBinding;
use naga::back::{hlsl, msl, spv};
use std::fmt;

/// A translated shader: text in UTF-8, or the bytes of SPIR-V (little endian).
pub type Translated = Vec<u8>;

/// Validates a shader and translates it: see [`Validated::translate`].
///
/// # Errors
/// If the target refuses the shader ([`Target::refuses`]), or naga rejects it.
pub fn translate(shader: &Shader, target: Target) -> Result<Translated, TranslateError> {
    validate(&shader.source)?.translate(shader, target)
}

impl Validated {
    /// Translates the shader that this is naga's form of; for several targets it is read once.
    /// Bindings keep their numbers: GLSL's `binding`, HLSL's registers (space 0), Metal's buffer
    /// indices. Metal's shaders read the byte lengths of their arrays from buffer 8, or from the one
    /// behind the last binding if that is higher, in the order in which the text declares them.
    ///
    /// Of a shader without an entry point GLSL, HLSL and Metal get a text to include: it has no
    /// `#version`, and what two textures share (`Footprint`, naga's helpers) is guarded, so that several
    /// stand in one file.
    ///
    /// # Errors
    /// If the target refuses the shader ([`Target::refuses`]), or naga's back end rejects it.
    pub fn translate(&self, shader: &Shader, target: Target) -> Result<Translated, TranslateError> {
        if let Some(refused) = target.refuses(shader) {
            return Err(refused);
        }
        let is_included = shader.entry_point.is_none();
        let (module, info) = (&self.module, &self.info);
        let failed = |error: &dyn fmt::Display| TranslateError::BackEnd(target, error.to_string());
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
            Target::Glsl | Target::GlslEs => {
                let text = glsl::write(self, shader, target)?;
                Ok(text.into_bytes())
            }
            Target::Hlsl => {
                let options = hlsl::Options::default();
                let pipeline = hlsl::PipelineOptions { entry_point: None };
                let mut text = String::new();
                hlsl::Writer::new(&mut text, &options, &pipeline)
                    .write(module, info, None)
                    .map_err(|e| failed(&e))?;
                if is_included {
                    text = included(&text);
                }
                Ok(text.into_bytes())
            }
            Target::Msl => {
                let resources = resources().map(|(at, binding)| {
                    let is_texture = binding.kind == BindingKind::Tables
                        && shader.table_form != TableForm::Storage;
                    let slot = Some(binding.binding as u8);
                    let target = msl::BindTarget {
                        buffer: slot.filter(|_| !is_texture),
                        texture: slot.filter(|_| is_texture),
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
                    per_entry_point_map: (shader.entry_point.iter())
                        .map(|entry| (entry.name.clone(), slots.clone()))
                        .collect(),
                    fake_missing_bindings: false,
                    ..msl::Options::default()
                };
                let pipeline = msl::PipelineOptions::default();
                let (mut text, _) =
                    msl::write_string(module, info, &options, &pipeline).map_err(|e| failed(&e))?;
                if is_included {
                    text = included(&text);
                }
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
