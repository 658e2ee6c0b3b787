//! A checked graph with its catalogue.

use crate::{Options, Program, TextureEvaluator};
use mipless_graph::{
    CheckOptions, Checked, Diagnostic, Document, NodeSpec, Output, Parameter, Severity, Signal,
    check, load,
};

/// The specs of the catalogue.
pub fn specs() -> Vec<&'static NodeSpec> {
    crate::catalogue()
        .iter()
        .map(|definition| definition.spec)
        .collect()
}

/// A texture graph without mistakes.
#[derive(Clone, Debug)]
pub struct Texture {
    checked: Checked,
    document: Document,
    warnings: Vec<Diagnostic>,
}

impl Texture {
    /// Loads and checks a JSON graph.
    ///
    /// # Errors
    /// Every mistake, located, and the warnings with them.
    pub fn from_json(text: &str) -> Result<Self, Vec<Diagnostic>> {
        Self::with_options(text, &CheckOptions::default())
    }

    /// The same; `options` may allow signals without statistics, which only
    /// [`crate::Method::Supersample`] filters.
    ///
    /// # Errors
    /// Every mistake, located, and the warnings with them.
    pub fn with_options(text: &str, options: &CheckOptions) -> Result<Self, Vec<Diagnostic>> {
        let loaded = load(text, &specs());
        let (Some(graph), Some(document)) = (loaded.graph, loaded.document) else {
            return Err(loaded.diagnostics);
        };
        let mut warnings = loaded.diagnostics;
        debug_assert!(warnings.iter().all(|d| d.severity == Severity::Warning));
        match check(graph, options) {
            Ok(checked) => {
                warnings.extend(checked.warnings().iter().cloned());
                Ok(Self {
                    checked,
                    document,
                    warnings,
                })
            }
            Err(mistakes) => {
                warnings.extend(mistakes);
                Err(warnings)
            }
        }
    }

    /// The document, to edit and to save; load the result again.
    pub fn document(&self) -> &Document {
        &self.document
    }

    /// The checked graph.
    pub fn checked(&self) -> &Checked {
        &self.checked
    }

    /// The warnings of loading and checking.
    pub fn warnings(&self) -> &[Diagnostic] {
        &self.warnings
    }

    /// The graph's inputs.
    pub fn parameters(&self) -> &[Parameter] {
        &self.checked.graph().parameters
    }

    /// The graph's outputs.
    pub fn outputs(&self) -> &[Output] {
        &self.checked.graph().outputs
    }

    /// What the check says of each node's signal.
    pub fn signals(&self) -> &[Signal] {
        self.checked.signals()
    }

    /// Compiles the graph for both back ends.
    pub fn compile(&self, options: &Options) -> Program {
        mipless_codegen::compile(&self.checked, crate::catalogue(), options)
    }

    /// Compiles the graph for evaluation on the CPU, with its inputs at their defaults.
    pub fn evaluator(&self, options: &Options) -> TextureEvaluator {
        TextureEvaluator::new(self.parameters().to_vec(), &self.compile(options))
    }
}
