//! What --commands names.

use std::path::Path;

#[cfg(feature = "mcap")]
use anyhow::anyhow;

use graintwin::command::Command;
use graintwin::command::request::Intake;
use graintwin::path;
#[cfg(feature = "mcap")]
use graintwin::record::reader::{self, Bag, Source};
#[cfg(feature = "mcap")]
use graintwin::scene::Node;

use super::Failure;

/// Commands from elsewhere than the scene.
pub(super) enum Commands {
    /// Of a CSV.
    Known(Vec<Command>),
    /// Of a bag.
    #[cfg(feature = "mcap")]
    Recorded(Recorded),
}

/// Commands of a bag, which may be too large for memory.
pub(super) struct Recorded {
    /// Them, and what else was meant as such.
    pub(super) intakes: Box<dyn Iterator<Item = Result<Intake, Failure>>>,
    /// Messages that they are in.
    pub(super) messages: usize,
}

/// All of them, for a rig that plays them. One that could not be read asks for NaN.
#[cfg(all(feature = "mcap", feature = "ros"))]
pub(super) fn all(recorded: Recorded) -> Result<Vec<Command>, Failure> {
    let command = |intake| match intake {
        Intake::Command(command) | Intake::Malformed(command, _) => Some(command),
        Intake::Request(_) => None,
    };
    recorded.intakes.filter_map(|item| item.map(command).transpose()).collect()
}

/// The commands of a CSV.
#[cfg(not(feature = "mcap"))]
pub(super) fn read(file: &Path) -> Result<Commands, Failure> {
    Ok(Commands::Known(path::read_csv(file)?))
}

/// The commands of a CSV or a bag; `topic` and the joints of `node` say which of a bag's messages
/// are meant.
#[cfg(feature = "mcap")]
pub(super) fn read(file: &Path, topic: Option<&str>, node: &Node) -> Result<Commands, Failure> {
    if reader::is_bag(file) {
        return recorded(file, &Source::new(node, topic)).map(Commands::Recorded);
    }
    if topic.is_some() {
        return Err(Failure::Input(anyhow!(
            "--topic names a topic of a bag, and {} is none",
            file.display()
        )));
    }
    Ok(Commands::Known(path::read_csv(file)?))
}

#[cfg(feature = "mcap")]
fn recorded(file: &Path, source: &Source<'_>) -> Result<Recorded, Failure> {
    let bag = Bag::open(file).map_err(Failure::input)?;
    let intakes = bag.intakes(source).map_err(Failure::input)?;
    if let Some(damage) = intakes.damage() {
        return Err(Failure::Input(anyhow!("{damage}")));
    }
    let messages = intakes.messages() as usize;
    let intakes = intakes.map(|item| item.map(|(_, intake)| intake).map_err(Failure::input));
    Ok(Recorded { intakes: Box::new(intakes), messages })
}
