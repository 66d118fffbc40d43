//! What is done with every bag that the fuzzer makes.

use std::path::Path;
use std::sync::LazyLock;

use graintwin::record::reader::{Bag, Source};
use graintwin::scene::{self, Node};

/// The joint `ram` moves a wall, by way of either message.
static NODE: LazyLock<Node> = LazyLock::new(|| {
    let joints = "{joints: {ram: {wall: z_max, zero: first}}}";
    let joint = "{joints: {ram: {wall: x_min}}}";
    let text = format!(
        "pack: {{file: none.csv}}\nnode: {{joint_states: {joints}, joint_trajectory: {joint}}}\n"
    );
    scene::parse(&text, Path::new("fuzz.yaml")).expect("a valid scene").node
});

/// Reads all that there is to read in the MCAP file `bytes`, in every way.
pub fn read(bytes: &[u8]) {
    let bag = Bag::from_bytes(Path::new("fuzz.mcap"), bytes);
    let survey = bag.survey().expect("bytes in memory can be read");
    let messages = bag.messages().filter(Result::is_ok).count() as u64;
    assert_eq!(messages, survey.messages(), "a message is counted otherwise");
    bag.commands().for_each(drop);
    let obvious = [None];
    let named = survey.topics.keys().take(8).map(|name| Some(name.as_str()));
    for topic in obvious.into_iter().chain(named) {
        let Ok(intakes) = bag.intakes(&Source::new(&NODE, topic)) else { continue };
        let mut last = 0;
        for item in intakes {
            let Ok((time, _)) = item else { break };
            assert!(last <= time, "commands out of order");
            last = time;
        }
    }
    for attachment in survey.attachments.iter().take(16) {
        let found = bag.attachment(&attachment.name);
        assert!(matches!(found, Ok(Some(_))), "an attachment that is there is not found");
    }
}
