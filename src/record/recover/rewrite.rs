//! A file again, with what is whole.

use std::collections::{BTreeMap, HashMap};
use std::io::Write;
use std::sync::Arc;

use mcap::Attachment;

use super::account::{Account, File};
use super::track::stands_for_itself;
use crate::record::bag::{BagError, Channel, Contents, Part, Schema, When};
use crate::record::reader::{self, Item, Items, Message, ReadError};
use crate::record::{END, RECOVERED, metadata};
use crate::scene;

/// Why a file could not be written again.
#[derive(Debug, thiserror::Error)]
pub(super) enum RewriteError {
    #[error(transparent)]
    Read(#[from] ReadError),
    #[error(transparent)]
    Write(#[from] BagError),
}

/// Writes what is whole of `file`, whose pieces are `items`, to `to` under `name`; gives that back
/// with what it holds.
pub(super) fn rewrite<W: Write>(
    account: &Account,
    file: &File,
    items: Items,
    name: &str,
    to: W,
) -> Result<(W, Contents), RewriteError> {
    let mut part = Part::new(to, &scene::Record::default())?;
    // A channel is known by its address, which its messages share.
    let mut channels: HashMap<*const reader::Channel, (usize, Arc<reader::Channel>)> =
        HashMap::new();
    let (mut number, mut kept) = (file.before, 0);
    let mut end = None;
    for item in items {
        match item {
            Ok(Item::Channel(channel)) => {
                let schema = channel.schema.as_deref().map(|schema| Schema {
                    name: &schema.name,
                    encoding: &schema.encoding,
                    data: &schema.data,
                });
                let place = part.channel(Channel::from(&*channel), schema.as_ref());
                channels.insert(Arc::as_ptr(&channel), (place, channel));
            }
            Ok(Item::Message(message)) => {
                number += 1;
                let known = channels.get(&Arc::as_ptr(&message.channel));
                let keep = number <= account.whole || stands_for_itself(&message);
                if let Some((place, _)) = known.filter(|_| keep) {
                    let Message { sequence, log_time, publish_time, data, .. } = &message;
                    let (sequence, log_time, publish_time) = (*sequence, *log_time, *publish_time);
                    part.write(*place, When { sequence, log_time, publish_time }, data)?;
                    part.close_full_chunk()?;
                    kept += 1;
                }
            }
            Ok(Item::Attachment { times: (log_time, create_time), name, media_type, data }) => {
                let data = data.into();
                part.attach(&Attachment { log_time, create_time, name, media_type, data })?;
            }
            // It is made anew, with what is in the file now.
            Ok(Item::Metadata { name, .. }) if name == metadata::RECORD => {}
            Ok(Item::Metadata { name, values }) if name == END => end = Some(values),
            Ok(Item::Metadata { name, values }) => part.metadata(&name, values)?,
            Err(ReadError::Damaged { .. }) => break,
            Err(error) => return Err(error.into()),
        }
    }
    let dropped = number - file.before - kept;
    if let Some(values) = end.filter(|_| dropped == 0) {
        part.metadata(END, values)?;
    }
    part.metadata(RECOVERED, about(file, kept, dropped))?;
    Ok(part.finish(name)?)
}

/// What was recovered.
fn about(file: &File, kept: u64, dropped: u64) -> BTreeMap<String, String> {
    let bytes = std::fs::metadata(&file.path).map_or(0, |found| found.len());
    let source = file.path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let damage = match &file.damage {
        Some(ReadError::Damaged { damage, .. }) => damage.to_string(),
        _ => "none".into(),
    };
    BTreeMap::from([
        ("source".into(), source),
        ("bytes".into(), bytes.to_string()),
        ("kept".into(), kept.to_string()),
        ("dropped".into(), dropped.to_string()),
        ("damage".into(), damage),
        ("version".into(), env!("CARGO_PKG_VERSION").into()),
    ])
}
