//! `completions`: scripts for shells.

use crate::mistake::Mistake;
use crate::report::Report;
use clap::{Args, Command};
use clap_complete::Shell;

/// The arguments of `completions`.
#[derive(Args, Debug)]
pub(crate) struct Arguments {
    /// The shell
    #[arg(value_enum)]
    shell: Shell,
}

/// Prints the script of a shell.
#[expect(clippy::unnecessary_wraps, reason = "the verbs share a signature")]
pub(crate) fn run(
    arguments: &Arguments,
    mut command: Command,
    report: &mut Report,
) -> Result<(), Mistake> {
    let mut script = Vec::new();
    clap_complete::generate(arguments.shell, &mut command, "mipless", &mut script);
    let script = String::from_utf8_lossy(&script).into_owned();
    report.print(&script);
    report.result("script", script);
    Ok(())
}
