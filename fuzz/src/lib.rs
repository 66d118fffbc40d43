//! What is done with every bag that the fuzzer makes.

use std::path::Path;

use graintwin::record::reader::Bag;

/// Reads all that there is to read in the MCAP file `bytes`, in every way.
pub fn read(bytes: &[u8]) {
    let bag = Bag::from_bytes(Path::new("fuzz.mcap"), bytes);
    let survey = bag.survey().expect("bytes in memory can be read");
    let messages = bag.messages().filter(Result::is_ok).count() as u64;
    assert!(messages >= survey.messages(), "a message on a topic that is not there");
    bag.commands().for_each(drop);
    for attachment in survey.attachments.iter().take(16) {
        let found = bag.attachment(&attachment.name);
        assert!(matches!(found, Ok(Some(_))), "an attachment that is there is not found");
    }
}
