//! `graintwin check`

#[cfg(feature = "mcap")]
mod bag;
mod pack;
mod scene;

use std::path::PathBuf;

use anyhow::anyhow;

#[cfg(feature = "mcap")]
use graintwin::record::reader::is_bag;

use super::{Cli, Failure, Outcome, output};

/// Says whether a scene, a pack or a bag is right, and what is in it.
///
/// A scene is checked with the pack and the load path files that it names; a pack that is still to
/// be made or prepared is not. What is wrong is named with file, line and field. Of a damaged bag
/// is told what can still be read, and the exit code is 3.
#[derive(Debug, clap::Args)]
#[command(after_long_help = "Example:\n  graintwin check launch_configs/quickstart.yaml")]
pub(super) struct Args {
    /// A scene (.yaml, .yml), a pack (.csv), or a bag (its folder, or .mcap).
    file: PathBuf,
}

pub(super) fn run(args: &Args, cli: &Cli) -> Result<Outcome, Failure> {
    let file = args.file.as_path();
    let extension = file.extension().and_then(|extension| extension.to_str()).unwrap_or("");
    let text = match extension {
        "yaml" | "yml" => match cli.scene(file)? {
            Some(loaded) => scene::describe(&loaded)?,
            None => return Ok(Outcome::Done),
        },
        "csv" => pack::describe(file)?,
        #[cfg(feature = "mcap")]
        _ if is_bag(file) => {
            let (text, outcome) = bag::describe(file)?;
            output::print(&text)?;
            return Ok(outcome);
        }
        _ => {
            return Err(Failure::Input(anyhow!(
                "{}: a name ending in `{extension}` tells no kind of file; allowed: .yaml or .yml \
                 for a scene, .csv for a pack, .mcap or a folder for a bag",
                file.display()
            )));
        }
    };
    output::print(&text)?;
    Ok(Outcome::Done)
}
