//! `graintwin completions`

use clap::CommandFactory;
use clap_complete::Shell;

use super::{Cli, Failure, Outcome, output};

/// Prints the completions of a shell.
#[derive(Debug, clap::Args)]
#[command(after_long_help = "Example:\n  \
    graintwin completions bash > ~/.local/share/bash-completion/completions/graintwin")]
pub(super) struct Args {
    /// The shell.
    shell: Shell,
}

pub(super) fn run(args: &Args) -> Result<Outcome, Failure> {
    let mut text = Vec::new();
    clap_complete::generate(args.shell, &mut Cli::command(), "graintwin", &mut text);
    output::print(&String::from_utf8_lossy(&text))?;
    Ok(Outcome::Done)
}
