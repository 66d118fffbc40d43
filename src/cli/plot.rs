//! `graintwin plot`

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::anyhow;

use graintwin::record::reader::Bag;
use graintwin::view::{self, History, Sheet};

use super::{Failure, Outcome, output};

/// Draws a recording: stresses, volume change, moduli, coordination, friction, energies, contact
/// forces, their directions and chains, motion of the grains, cracks and solver effort, as SVG and PNG.
///
/// Writes overview with the four most telling charts, and stress_strain, stress_path,
/// volume_change, wall_forces, moduli, coordination, friction, energy, effort, forces, fabric,
/// network, hydrate, motion and cement, of discs biaxial, roses, interior, profiles and grains, and
/// prints the names of the files. Charts bear the name of the scene and the
/// units of their axes. What the recording does not hold is left out, and so is friction where no
/// contact carried any. A damaged recording is drawn as far as it can be read, and the exit code is
/// 3.
#[derive(Debug, clap::Args)]
#[command(after_long_help = "Example:\n  graintwin plot bags/rig_log --out plots/rig_log")]
pub(super) struct Args {
    /// A bag: its folder, or .mcap.
    bag: PathBuf,

    /// Folder for the charts; files of their names are replaced [default: `plots` beside the
    /// .mcap file].
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,

    /// What to write: SVG, which stays sharp at any size, PNG, which is twice as fine as a screen
    /// and brings its letters along, or both.
    #[cfg(feature = "png")]
    #[arg(long, value_enum, default_value_t = Format::Both)]
    format: Format,
}

/// Kinds of files to write.
#[cfg(feature = "png")]
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum Format {
    Svg,
    Png,
    Both,
}

pub(super) fn run(args: &Args) -> Result<Outcome, Failure> {
    let bag = Bag::open(&args.bag).map_err(Failure::input)?;
    let history = History::read(&bag).map_err(Failure::input)?;
    let outcome = tell_losses(&history);
    let title = history.scene.clone().unwrap_or_else(|| stem(&args.bag));
    let sheets = view::sheets(&history, &title);
    if sheets.is_empty() {
        return Err(Failure::Input(nothing(&args.bag, &history)));
    }
    let folder = args.out.clone().unwrap_or_else(|| beside(&args.bag));
    fs::create_dir_all(&folder).map_err(|error| unwritable(&folder, &error))?;
    for (name, sheet) in sheets {
        write(args, &folder.join(name), &sheet)?;
    }
    Ok(outcome)
}

/// Writes the files of a sheet, named as `stem` with the ending of each.
#[cfg(feature = "png")]
fn write(args: &Args, stem: &Path, sheet: &Sheet) -> Result<(), Failure> {
    if args.format != Format::Png {
        write_file(&stem.with_extension("svg"), sheet.to_svg().as_bytes())?;
    }
    if args.format != Format::Svg {
        let file = stem.with_extension("png");
        let png = sheet.to_png().map_err(|error| anyhow!("{}: {error}", file.display()));
        write_file(&file, &png.map_err(Failure::Other)?)?;
    }
    Ok(())
}

#[cfg(not(feature = "png"))]
fn write(_: &Args, stem: &Path, sheet: &Sheet) -> Result<(), Failure> {
    write_file(&stem.with_extension("svg"), sheet.to_svg().as_bytes())
}

fn write_file(file: &Path, bytes: &[u8]) -> Result<(), Failure> {
    fs::write(file, bytes).map_err(|error| unwritable(file, &error))?;
    output::print(&format!("{}\n", file.display()))
}

fn tell_losses(history: &History) -> Outcome {
    for topic in &history.passed_over {
        tracing::warn!("passed over {topic}");
    }
    if history.runs > 1 {
        let (number, runs) = (history.number, history.runs);
        tracing::info!("the bag holds {runs} runs, one after each reset; drawn is run {number}");
    }
    if let Some(damage) = &history.damage {
        tracing::error!("{damage}");
    }
    if history.unreadable > 0 {
        tracing::error!("{} messages are not what their topic says", history.unreadable);
    }
    match history.damage.is_none() && history.unreadable == 0 {
        true => Outcome::Done,
        false => Outcome::Incomplete,
    }
}

fn nothing(bag: &Path, history: &History) -> anyhow::Error {
    let what = if history.run.is_empty() { "holds no" } else { "holds no finite value in its" };
    anyhow!(
        "{} {what} graintwin_msgs/msg/PackState, WallForces, Moduli, ContactNetwork, Fabric or \
         GrainMotion: there is nothing to draw",
        bag.display()
    )
}

/// The name of the bag, for one that does not say its scene.
fn stem(bag: &Path) -> String {
    let name = bag.file_stem().unwrap_or(bag.as_os_str());
    name.to_string_lossy().into_owned()
}

fn beside(bag: &Path) -> PathBuf {
    let folder = if bag.is_dir() { Some(bag) } else { bag.parent() };
    folder.unwrap_or(Path::new("")).join("plots")
}

fn unwritable(path: &Path, error: &std::io::Error) -> Failure {
    Failure::Other(anyhow!("cannot write {}: {error}; --out names another folder", path.display()))
}
