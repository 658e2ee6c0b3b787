//! Validation of a shader by naga.

use naga::valid::{Capabilities, ModuleInfo, ValidationFlags, Validator};
use std::fmt;

/// A shader that naga has read and found valid.
#[derive(Debug)]
pub struct Validated {
    /// naga's form of it.
    pub module: naga::Module,
    /// What the validator found out about it.
    pub info: ModuleInfo,
}

/// Why naga rejects a shader: text that shows the place in the source.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ValidateError(pub String);

impl fmt::Display for ValidateError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for ValidateError {}

/// Reads WGSL text and validates it.
///
/// # Errors
/// If it does not parse or is not valid.
pub fn validate(source: &str) -> Result<Validated, ValidateError> {
    let module = naga::front::wgsl::parse_str(source)
        .map_err(|error| ValidateError(error.emit_to_string(source)))?;
    checked(module, source)
}

/// Validates a module that was read before and has changed since.
pub(super) fn revalidate(module: naga::Module) -> Result<Validated, ValidateError> {
    checked(module, "")
}

fn checked(module: naga::Module, source: &str) -> Result<Validated, ValidateError> {
    let mut validator = Validator::new(ValidationFlags::all(), Capabilities::default());
    let info = validator
        .validate(&module)
        .map_err(|error| ValidateError(error.emit_to_string(source)))?;
    Ok(Validated { module, info })
}
