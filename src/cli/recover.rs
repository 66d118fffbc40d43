//! `graintwin recover`

use std::path::PathBuf;

use graintwin::record::recover::{RecoverError, Recovered, recover};

use super::{Failure, Outcome, output};

/// Makes a whole bag of one that was cut off or damaged.
///
/// Of a recording of graintwin it keeps everything up to the last whole increment: command, measures
/// and report. What follows of an answer that was cut off is dropped, and counted; what came beside
/// the answers is kept. Of bags of other programs it keeps every message that can be read. The bag
/// itself is left as it is; one that is whole is copied.
#[derive(Debug, clap::Args)]
#[command(after_long_help = "Example:\n  graintwin recover bags/rig_log --out bags/rig_log_whole")]
pub(super) struct Args {
    /// The bag: its folder, or .mcap.
    bag: PathBuf,

    /// The folder to write to, which must be new or empty.
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
}

pub(super) fn run(args: &Args) -> Result<Outcome, Failure> {
    let Recovered { folder, files, rewritten, kept, dropped, left_out } =
        recover(&args.bag, &args.out).map_err(failure)?;
    let messages = format!("{kept} messages in {}", plural(files, "file"));
    let mut text = match (rewritten, left_out) {
        (0, 0) => format!(
            "{} is whole and was copied to {}: {messages}\n",
            args.bag.display(),
            folder.display()
        ),
        _ => format!("{} recovered to {}: {messages}\n", args.bag.display(), folder.display()),
    };
    if dropped > 0 {
        text += &format!("{dropped} messages of an answer that was cut off were dropped\n");
    }
    if left_out > 0 {
        let left_out = plural(left_out, "file");
        text += &format!("{left_out} behind the damage, or without a whole answer, left out\n");
    }
    output::print(&text)?;
    Ok(Outcome::Done)
}

fn failure(error: RecoverError) -> Failure {
    match error {
        RecoverError::Write { .. } => Failure::other(error),
        _ => Failure::input(error),
    }
}

fn plural(count: usize, what: &str) -> String {
    format!("{count} {what}{}", if count == 1 { "" } else { "s" })
}
