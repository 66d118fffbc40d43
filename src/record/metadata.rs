//! rosbag2's description of a bag, version 9 as ROS 2 Jazzy writes it.

use super::bag::{Channel, Contents};
use crate::msg::topics::{Durability, Reliability, Topic};

/// Name of the metadata record with the description.
pub(super) const RECORD: &str = "rosbag2";

/// The description's key in that record.
pub(super) const KEY: &str = "serialized_metadata";

/// What a channel says of its quality of service, under this key.
pub(super) const QOS: &str = "offered_qos_profiles";

/// What a channel says of its type, under this key.
pub(super) const HASH: &str = "topic_type_hash";

/// A file of a bag.
#[derive(Clone, Debug)]
pub(super) struct File {
    pub(super) name: String,
    pub(super) contents: Contents,
}

/// The text of `metadata.yaml`.
pub(super) fn file(files: &[File]) -> String {
    let mut text = "rosbag2_bagfile_information:\n".to_owned();
    indent(&mut text, &body(files), "  ");
    text
}

/// The same without the outermost key, as it stands inside an MCAP file.
pub(super) fn body(files: &[File]) -> String {
    let all = together(files);
    let (start, duration, messages) = (all.start(), all.duration(), all.messages());
    let topics = if all.channels.is_empty() { " []\n".into() } else { topics(&all) };
    let mut text = format!(
        "version: 9\n\
         storage_identifier: mcap\n\
         duration:\n  nanoseconds: {duration}\n\
         starting_time:\n  nanoseconds_since_epoch: {start}\n\
         message_count: {messages}\n\
         topics_with_message_count:{topics}\
         compression_format: \"\"\n\
         compression_mode: \"\"\n\
         relative_file_paths:\n"
    );
    for file in files {
        text += &format!("  - {}\n", quoted(&file.name));
    }
    text += "files:\n";
    for file in files {
        text += &format!(
            "  - path: {}\n    \
                 starting_time:\n      nanoseconds_since_epoch: {}\n    \
                 duration:\n      nanoseconds: {}\n    \
                 message_count: {}\n",
            quoted(&file.name),
            file.contents.start(),
            file.contents.duration(),
            file.contents.messages()
        );
    }
    text + "custom_data: ~\nros_distro: jazzy\n"
}

/// The files as if they were one.
fn together(files: &[File]) -> Contents {
    let mut all = Contents::default();
    for File { contents, .. } in files {
        for time in contents.times.into_iter().flat_map(|(first, last)| [first, last]) {
            all.reaches(time);
        }
        for channel in &contents.channels {
            match all.channels.iter_mut().find(|known| known.topic == channel.topic) {
                Some(known) => known.messages += channel.messages,
                None => all.channels.push(channel.clone()),
            }
        }
    }
    all
}

fn topics(contents: &Contents) -> String {
    let mut text = "\n".to_owned();
    for channel in &contents.channels {
        let Channel { topic, kind, encoding, about, messages } = channel;
        text += &format!(
            "  - topic_metadata:\n      name: {}\n      type: {}\n      \
             serialization_format: {}\n",
            quoted(topic),
            quoted(kind),
            quoted(encoding),
        );
        match about.get(QOS).filter(|profiles| !profiles.trim().is_empty()) {
            Some(profiles) => {
                text += "      offered_qos_profiles:\n";
                indent(&mut text, profiles, "        ");
            }
            None => text += "      offered_qos_profiles: []\n",
        }
        let hash = quoted(about.get(HASH).map_or("", String::as_str));
        text += &format!("      type_description_hash: {hash}\n    message_count: {messages}\n");
    }
    text
}

/// JSON's quoting is YAML's too.
pub(super) fn quoted(text: &str) -> String {
    serde_json::Value::from(text).to_string()
}

/// The quality of service that playback offers again: a YAML list of one.
pub(super) fn offered_qos(topic: &Topic) -> String {
    const FOREVER: &str = "  sec: 9223372036\n    nsec: 854775807\n";
    let Reliability::Reliable = topic.qos.reliability;
    let durability = match topic.qos.durability {
        Durability::Volatile => "volatile",
        Durability::TransientLocal => "transient_local",
    };
    let depth = topic.qos.depth;
    format!(
        "- history: keep_last\n  \
           depth: {depth}\n  \
           reliability: reliable\n  \
           durability: {durability}\n  \
           deadline:\n  {FOREVER}  \
           lifespan:\n  {FOREVER}  \
           liveliness: automatic\n  \
           liveliness_lease_duration:\n  {FOREVER}  \
           avoid_ros_namespace_conventions: false\n"
    )
}

fn indent(text: &mut String, lines: &str, by: &str) {
    for line in lines.lines() {
        text.push_str(by);
        text.push_str(line);
        text.push('\n');
    }
}
