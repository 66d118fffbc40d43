//! What is in a bag.

use std::path::Path;

use graintwin::record::reader::Bag;

use crate::cli::{Failure, Outcome};

/// Also says how it ends: a damaged bag is reported up to the damage.
pub(super) fn describe(file: &Path) -> Result<(String, Outcome), Failure> {
    let survey = Bag::open(file).and_then(|bag| bag.survey()).map_err(Failure::input)?;
    let mut text = format!("bag             {}\n", file.display());
    let mut line = |name: &str, what: &str| text.push_str(&format!("{name:<16}{what}\n"));
    if let Some((first, last)) = survey.times {
        line(
            "recorded",
            &format!("{} messages over {:.3} s", survey.messages(), (last - first) as f64 * 1e-9),
        );
    }
    for (topic, found) in &survey.topics {
        line("", &format!("{:>7}  {topic} ({}, {})", found.messages, found.kind, found.encoding));
    }
    for attachment in &survey.attachments {
        line("attachment", &format!("{} ({} bytes)", attachment.name, attachment.bytes));
    }
    for (name, record) in &survey.metadata {
        for (key, value) in record.iter().filter(|(_, value)| !value.contains('\n')) {
            line("metadata", &format!("{name}: {key} = {value}"));
        }
    }
    let Some(damage) = survey.damage else {
        line("state", "whole");
        return Ok((text, Outcome::Done));
    };
    line("state", &format!("damaged: {damage}"));
    Ok((text, Outcome::Incomplete))
}
