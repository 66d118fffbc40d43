//! `graintwin check`

mod pack;
mod scene;

use std::path::PathBuf;

use super::{Cli, Failure, Outcome, output};

/// Says whether a scene or a pack is right, and what is in it.
///
/// A scene is checked with the pack and the load path files that it names; a pack that is still to
/// be made is not made. What is wrong is named with file, line and field.
#[derive(Debug, clap::Args)]
#[command(after_long_help = "Example:\n  graintwin check launch_configs/quickstart.yaml")]
pub(super) struct Args {
    /// A scene (.yaml, .yml) or a pack (.csv).
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
        _ => {
            return Err(Failure::Input(anyhow::anyhow!(
                "{}: a name ending in `{extension}` tells no kind of file; allowed: .yaml or .yml \
                 for a scene, .csv for a pack",
                file.display()
            )));
        }
    };
    output::print(&text)?;
    Ok(Outcome::Done)
}
