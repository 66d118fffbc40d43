//! `graintwin generate`

use std::path::PathBuf;

use indicatif::MultiProgress;

use graintwin::pack;

use super::specimen::Specimen;
use super::{Cli, Failure, Outcome, output, specimen};

/// Makes the pack of a scene, prepares it and stores it.
///
/// PACK.csv gets one grain a row: x, y, z, radius in m, young in Pa, poisson, density in kg/m³,
/// friction. The box goes into PACK.json beside it, the contact history of a pack prepared with
/// friction into PACK.history.json. Reading them gives the same bits.
#[derive(Debug, clap::Args)]
#[command(after_long_help = "Example:\n  \
    graintwin generate launch_configs/quickstart.yaml --out beads.csv\n\n\
    A scene uses it by   pack: {file: beads.csv}")]
pub(super) struct Args {
    /// The scene, YAML.
    scene: PathBuf,

    /// Where the pack goes; a file that is there is replaced.
    #[arg(long, value_name = "PACK.csv")]
    out: PathBuf,
}

pub(super) fn run(args: &Args, cli: &Cli, bars: &MultiProgress) -> Result<Outcome, Failure> {
    let Some(loaded) = cli.scene(&args.scene)? else { return Ok(Outcome::Done) };
    let Specimen { pack, prepared } = specimen::build(&loaded, cli.threads(), bars)?;
    pack::save(&pack, &args.out)?;
    let history = match pack.history {
        Some(_) => format!(", its history in {}", pack::history_file(&args.out).display()),
        None => String::new(),
    };
    let text = format!(
        "{} with its box in {}{history}\n{}{}",
        args.out.display(),
        pack::box_file(&args.out).display(),
        specimen::preparation(&prepared),
        specimen::describe(&pack, loaded.scene.dimension),
    );
    output::print(&text)?;
    Ok(Outcome::Done)
}
