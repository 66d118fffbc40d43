//! What --commands names.

use std::path::Path;

#[cfg(feature = "mcap")]
use anyhow::anyhow;

use graintwin::path;
#[cfg(feature = "mcap")]
use graintwin::record::reader::{self, Bag, Source};
use graintwin::scene::Node;

use super::Failure;
use super::orders::Feed;
#[cfg(feature = "mcap")]
use super::orders::Recorded;
#[cfg(feature = "mcap")]
use super::pace::Pace;

/// The commands of a CSV.
#[cfg(not(feature = "mcap"))]
pub(super) fn read(file: &Path, _: Option<&str>, _: &Node) -> Result<Feed, Failure> {
    Ok(Feed::Known(path::read_csv(file)?))
}

/// The commands of a CSV or a bag; `topic` and the joints of `node` say which of a bag's messages
/// are meant.
#[cfg(feature = "mcap")]
pub(super) fn read(file: &Path, topic: Option<&str>, node: &Node) -> Result<Feed, Failure> {
    if reader::is_bag(file) {
        return recorded(file, &Source::new(node, topic), None).map(Feed::Recorded);
    }
    if topic.is_some() {
        return Err(Failure::Input(anyhow!(
            "--topic names a topic of a bag, and {} is none",
            file.display()
        )));
    }
    Ok(Feed::Known(path::read_csv(file)?))
}

/// The commands of the bag `file` that `source` means, at a pace or as fast as they are taken.
#[cfg(feature = "mcap")]
pub(super) fn recorded(
    file: &Path,
    source: &Source<'_>,
    mut pace: Option<Pace>,
) -> Result<Recorded, Failure> {
    let bag = Bag::open(file).map_err(Failure::input)?;
    let intakes = bag.intakes(source).map_err(Failure::input)?;
    if let Some(damage) = intakes.damage() {
        return Err(Failure::Input(anyhow!("{damage}")));
    }
    let messages = intakes.messages() as usize;
    let intakes = intakes.map_while(move |item| match (item, &mut pace) {
        (Ok((time, intake)), Some(pace)) => pace.wait(time).then_some(Ok(intake)),
        (Ok((_, intake)), None) => Some(Ok(intake)),
        (Err(error), _) => Some(Err(Failure::input(error))),
    });
    Ok(Recorded { intakes: Box::new(intakes), messages })
}
