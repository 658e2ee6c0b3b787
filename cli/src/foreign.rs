//! How documents of other tools are read: the arguments that all verbs share.

use clap::Args;
use std::path::PathBuf;

/// How they are read.
#[derive(Args, Clone, Debug, Default)]
pub(crate) struct Arguments {
    /// Of a .mtlx or .gltf, read this material, shader or nodegraph alone [default: every material,
    /// or every nodegraph where there is none]
    #[arg(long, global = true, value_name = "NAME")]
    pub(crate) material: Option<String>,

    /// Where MaterialX's own documents are, for nodes that are made of other nodes [default: the
    /// folders in MATERIALX_SEARCH_PATH]
    #[arg(long, global = true, value_name = "DIR")]
    pub(crate) library: Option<PathBuf>,

    /// Refuse documents of which something is approximated
    #[arg(long, global = true)]
    pub(crate) strict: bool,

    /// Take what loads of a document, and leave out the outputs that do not
    #[arg(long, global = true, conflicts_with = "strict")]
    pub(crate) partial: bool,
}
