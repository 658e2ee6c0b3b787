//! Inputs that become constants.

use crate::mistake::{Mistake, Status};
use crate::scene::inputs;
use crate::value;
use clap::Args;
use mipless::{BakeError, Diagnostic, Texture};
use mipless_graph::{CheckOptions, suggest};
use std::path::Path;

/// The argument.
#[derive(Args, Clone, Debug, Default)]
#[group(skip)]
pub(crate) struct Arguments {
    /// Make an input a constant for good, so that what follows from it is worked out by the compiler:
    /// 0.5 or 0.1,0.2,0.3 or #rrggbb or true
    #[arg(long = "bake", value_name = "INPUT=VALUE", value_parser = value::setting)]
    pub(crate) constants: Vec<(String, String)>,
}

impl Arguments {
    /// The texture with these constants.
    pub(crate) fn apply(
        &self,
        path: &Path,
        texture: Texture,
        options: &CheckOptions,
    ) -> Result<Texture, Mistake> {
        if self.constants.is_empty() {
            return Ok(texture);
        }
        let constants: Vec<(&str, &str)> = (self.constants.iter())
            .map(|(name, value)| (name.as_str(), value.as_str()))
            .collect();
        let parameters = texture.parameters();
        texture.baked(&constants, options).map_err(|error| {
            let message = format!("`--bake`: {error}");
            let diagnostics = match error {
                BakeError::Mistakes(mistakes) => return Mistake::graph(path, mistakes),
                BakeError::NoInput(name) => {
                    let near = suggest(&name, parameters.iter().map(|p| p.name.as_str()));
                    let near = near.map(|near| format!("did you mean `{near}`? "));
                    let help = near.unwrap_or_default() + &inputs(parameters);
                    Diagnostic::error("unknown-input", message).help(help)
                }
                BakeError::Value(name, _) => {
                    let index = parameters.iter().position(|p| p.name == name);
                    let said = index.map_or(&[][..], |index| &parameters[index..=index]);
                    Diagnostic::error("bad-setting", message).help(inputs(said))
                }
            };
            Mistake {
                status: Status::Usage,
                file: Some(path.display().to_string()),
                diagnostics: vec![diagnostics],
            }
        })
    }
}
