//! `schema`: the JSON Schema of graphs.

use crate::mistake::Mistake;
use crate::report::Report;

/// Prints it.
#[expect(clippy::unnecessary_wraps, reason = "the verbs share a signature")]
pub(crate) fn run(report: &mut Report) -> Result<(), Mistake> {
    let schema = mipless::schema(&mipless::specs());
    report.print(format_args!("{schema:#}\n"));
    report.result("schema", schema);
    Ok(())
}
