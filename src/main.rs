//! The program `graintwin`: parses its arguments, does one verb and says how it ended.

mod cli;

use std::process::ExitCode;

/// The one place that turns an outcome into an exit code. Wrong arguments end in clap, with 2.
fn main() -> ExitCode {
    let ended = cli::parse(std::env::args_os()).and_then(|cli| cli::run(&cli));
    let code = match &ended {
        Ok(cli::Outcome::Done) => 0,
        Err(cli::Failure::Other(_)) => 1,
        Err(cli::Failure::Input(_)) => 2,
        Ok(cli::Outcome::Incomplete) => 3,
    };
    if let Err(failure) = ended {
        cli::output::complain(&failure);
    }
    ExitCode::from(code)
}
