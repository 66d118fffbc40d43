//! rosbag2's description of a bag, version 9 as ROS 2 Jazzy writes it.

use super::bag::Contents;
use crate::msg::topics::{Durability, Reliability, Topic};

/// The text of `metadata.yaml`.
pub(super) fn file(contents: &Contents, file_name: &str) -> String {
    let mut text = "rosbag2_bagfile_information:\n".to_owned();
    indent(&mut text, &body(contents, file_name), "  ");
    text
}

/// The same without the outermost key, as it stands inside an MCAP file.
pub(super) fn body(contents: &Contents, file_name: &str) -> String {
    // JSON's quoting is YAML's too.
    let file = serde_json::Value::from(file_name).to_string();
    let start = contents.first.unwrap_or(0);
    let duration = contents.duration();
    let messages = contents.messages();
    let topics = if contents.channels.is_empty() { " []\n".into() } else { topics(contents) };
    format!(
        "version: 9\n\
         storage_identifier: mcap\n\
         duration:\n  nanoseconds: {duration}\n\
         starting_time:\n  nanoseconds_since_epoch: {start}\n\
         message_count: {messages}\n\
         topics_with_message_count:{topics}\
         compression_format: \"\"\n\
         compression_mode: \"\"\n\
         relative_file_paths:\n  - {file}\n\
         files:\n  - path: {file}\n    \
             starting_time:\n      nanoseconds_since_epoch: {start}\n    \
             duration:\n      nanoseconds: {duration}\n    \
             message_count: {messages}\n\
         custom_data: ~\n\
         ros_distro: jazzy\n"
    )
}

fn topics(contents: &Contents) -> String {
    let mut text = "\n".to_owned();
    for channel in &contents.channels {
        let topic = channel.topic;
        text += &format!(
            "  - topic_metadata:\n      name: {}\n      type: {}\n      \
             serialization_format: cdr\n      offered_qos_profiles:\n",
            topic.recorded_name(),
            topic.kind.full_name(),
        );
        indent(&mut text, &offered_qos(topic), "        ");
        text += &format!(
            "      type_description_hash: {}\n    message_count: {}\n",
            topic.kind.hash, channel.messages
        );
    }
    text
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
