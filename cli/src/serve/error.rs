//! What a call ends with that has no result.

use mipless::Diagnostic;
use serde_json::{Value, json};

pub(super) const PARSE: i64 = -32700;
pub(super) const REQUEST: i64 = -32600;
pub(super) const METHOD: i64 = -32601;
pub(super) const PARAMETERS: i64 = -32602;
pub(super) const INTERNAL: i64 = -32603;
pub(super) const MISTAKES: i64 = -32001;
pub(super) const LIMIT: i64 = -32002;
pub(super) const CANCELLED: i64 = -32003;
pub(super) const SESSION: i64 = -32004;

/// An error of JSON-RPC.
#[derive(Clone, Debug)]
pub(super) struct Failure {
    pub(super) code: i64,
    pub(super) message: String,
    pub(super) data: Option<Value>,
}

impl Failure {
    pub(super) fn new(code: i64, message: impl Into<String>) -> Self {
        Self {
            code,
            message: message.into(),
            data: None,
        }
    }

    /// The first error stands for all, which come with it.
    pub(super) fn mistakes(diagnostics: &[Diagnostic]) -> Self {
        let first = diagnostics.iter().find(|diagnostic| diagnostic.is_error());
        let message = first
            .or(diagnostics.first())
            .map(|first| first.message.as_str());
        Self {
            code: MISTAKES,
            message: message.unwrap_or("the graph has mistakes").to_owned(),
            data: Some(json!({ "diagnostics": diagnostics })),
        }
    }

    pub(super) fn to_json(&self) -> Value {
        let mut error = json!({ "code": self.code, "message": self.message });
        if let Some(data) = &self.data {
            error["data"] = data.clone();
        }
        error
    }
}
