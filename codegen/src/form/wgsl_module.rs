//! Modules of WGSL that a linker imports: naga_oil's and WESL's.

use super::FormFile;
use crate::wgsl::Shader;

/// A module of naga_oil, as Bevy has it.
pub(super) fn naga_oil(shader: &Shader) -> FormFile {
    let function = &shader.function;
    FormFile {
        extension: "naga_oil.wgsl",
        text: format!(
            "#define_import_path mipless::{function}\n\n\
             // #import mipless::{function}::{{{function}, Footprint}}\n\n{}",
            shader.source
        ),
    }
}

/// A module of WESL: WGSL as it is, imported by the name of its file.
pub(super) fn wesl(shader: &Shader, name: &str) -> FormFile {
    let function = &shader.function;
    FormFile {
        extension: "wesl",
        text: format!(
            "// import package::{name}::{{{function}, Footprint}};\n\n{}",
            shader.source
        ),
    }
}
