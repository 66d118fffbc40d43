//! Files that no recorder writes: refused with a sentence that says where and why, and everything
//! before that is read.

use std::fs;
use std::os::unix::fs::symlink;
use std::path::Path;

use graintwin::msg::{Described, JointState};
use graintwin::record::reader::{Bag, ReadError};

use crate::mcap_bytes::{
    CHUNK, FOOTER, MAGIC, METADATA, channel, chunk, file, lz4, message, record, schema, schema_of,
    text, zstd,
};

/// A topic and two messages.
fn before() -> Vec<Vec<u8>> {
    let records = [
        schema_of(1, JointState::TYPE),
        channel(1, 1, "/joints"),
        message(1, 5, b"one"),
        message(1, 6, b"two"),
    ];
    vec![zstd(&records.concat())]
}

/// What is wrong with a file of [`before`] and `bad`, whose two messages can be read all the same.
fn damage(bad: Vec<u8>) -> String {
    let good = before();
    let offset = MAGIC.len() + good.concat().len();
    let bytes = file(&[good, vec![bad]].concat());
    damage_at(&bytes, offset)
}

fn damage_at(bytes: &[u8], offset: usize) -> String {
    let bag = Bag::from_bytes(Path::new("rig.mcap"), bytes);
    let mut messages: Vec<_> = bag.messages().collect();
    let error = messages.pop().unwrap().unwrap_err();
    let data: Vec<_> = messages.into_iter().map(|message| message.unwrap().data).collect();
    assert_eq!(data, [b"one", b"two"], "{error}");
    let ReadError::Damaged { path, damage, messages } = &error else { panic!("{error}") };
    assert_eq!((path.as_path(), *messages), (Path::new("rig.mcap"), 2));
    assert_eq!(damage.offset, offset as u64, "{error}");
    assert!(error.to_string().starts_with(&format!("rig.mcap is damaged at byte {offset}: ")));
    let survey = bag.survey().unwrap();
    assert_eq!(survey.messages(), 2);
    assert_eq!(survey.damage.unwrap().to_string(), error.to_string());
    damage.reason.clone()
}

#[test]
fn a_file_as_it_ought_to_be_is_whole() {
    let more = [message(1, 7, b"three"), lz4(&message(1, 8, b"four"))];
    let bytes = file(&[before(), more.to_vec()].concat());
    let survey = Bag::from_bytes(Path::new("rig.mcap"), bytes).survey().unwrap();
    assert!(survey.damage.is_none(), "{:?}", survey.damage);
    assert_eq!((survey.messages(), survey.times), (4, Some((5, 8))));
}

#[test]
fn chunks_that_are_not_what_they_say_are_damage() {
    let packed = zstd::stream::encode_all(&[0; 1000][..], 3).unwrap();
    for (bad, expected) in [
        (chunk("zstd", 999, &packed), "unpacks to more than the 999 bytes"),
        (chunk("zstd", 1001, &packed), "unpacks to 1000 bytes and not to the 1001"),
        (chunk("zstd", 1000, &packed[..packed.len() - 1]), "cannot be unpacked"),
        (chunk("zstd", 300 << 20, &packed), "says it unpacks to 314572800; at most 67108864"),
        (chunk("zstd", u64::MAX, &packed), "says it unpacks to 18446744073709551615"),
        (chunk("zstd", 4, b"text"), "zstd did not pack"),
        // The first years of zstd, whose unpackers are still in the library.
        (chunk("zstd", 4, b"\x25\xb5\x2f\xfd\0\0\0\0"), "zstd did not pack"),
        (chunk("lz4", 4, b"no frame of lz4"), "cannot be unpacked"),
        (chunk("brotli", 4, b"text"), "packed with `brotli`; allowed: zstd, lz4"),
        (chunk("", 5, b"text"), "unpacks to 4 bytes and not to the 5"),
        (chunk("", 4, b"text"), "ends in the middle of a record"),
        (record(CHUNK, &[0; 20]), "impossible lengths or text"),
    ] {
        let reason = damage(bad);
        assert!(reason.contains(expected), "{reason}");
    }
}

#[test]
fn a_chunk_holds_topics_and_messages_only() {
    let inner = zstd(&message(1, 7, b"three"));
    assert_eq!(damage(zstd(&inner)), "a record of kind 6 in a chunk");
    let metadata = record(METADATA, &[text("name"), vec![0; 4]].concat());
    assert_eq!(damage(zstd(&metadata)), "a record of kind 12 in a chunk");
    // What other programs add is passed over.
    let bytes = file(&[before(), vec![zstd(&record(0x81, b"theirs"))]].concat());
    let survey = Bag::from_bytes(Path::new("rig.mcap"), bytes).survey().unwrap();
    assert!(survey.damage.is_none(), "{:?}", survey.damage);
}

#[test]
fn topics_and_types_are_described_once_and_in_order() {
    let schema_again = |definition| schema(1, &JointState::TYPE.full_name(), definition);
    for (bad, expected) in [
        (schema_again("float64 x"), "type 1 is described a second time, and otherwise"),
        (channel(1, 1, "/others"), "channel 1 is described a second time, and otherwise"),
        (channel(2, 7, "/others"), "channel 2 has type 7, which is not described"),
        (schema(0, "a/msg/B", "float64 x"), "type 0 is described"),
        (message(9, 1, b"three"), "a message on channel 9, which is not described"),
        (channel(2, 1, "/others\x1b[2J"), "impossible lengths or text"),
        (channel(2, 1, &"x".repeat(600)), "impossible lengths or text"),
    ] {
        for bad in [zstd(&bad), bad] {
            let reason = damage(bad);
            assert!(reason.contains(expected), "{reason}");
        }
    }
    // Again, but the same.
    let again = [schema_of(1, JointState::TYPE), channel(1, 1, "/joints")];
    let bytes = file(&[before(), again.to_vec()].concat());
    let survey = Bag::from_bytes(Path::new("rig.mcap"), bytes).survey().unwrap();
    assert!(survey.damage.is_none(), "{:?}", survey.damage);
    // A topic may have no type.
    let bytes = file(&[channel(3, 0, "/untyped"), message(3, 1, b"three")]);
    let survey = Bag::from_bytes(Path::new("rig.mcap"), bytes).survey().unwrap();
    assert_eq!(survey.topics["/untyped"].kind, "");
}

#[test]
fn descriptions_without_end_are_damage() {
    let schemas: Vec<u8> =
        (2..40).flat_map(|id| schema(id, "a/msg/B", &"#".repeat(1 << 20))).collect();
    let reason = damage(zstd(&schemas));
    assert_eq!(reason, "topics and types are described in more than 16777216 bytes");
}

#[test]
fn lengths_beyond_the_file_or_any_sense_are_damage() {
    for (opcode, length, expected) in [
        (5, 1 << 40, "a record of kind 5 with more than 536870912 bytes"),
        (3, 17 << 20, "a record of kind 3 with more than 16777216 bytes"),
        (5, 1 << 20, "the file ends in the middle of a record"),
        (0x81, u64::MAX, "the file ends in the middle of a record"),
        (0, 0, "a record of kind 0"),
        (FOOTER, 20, "the file ends before its data do"),
    ] {
        let bad = [&[opcode][..], &u64::to_le_bytes(length)].concat();
        let reason = damage(bad);
        assert!(reason.contains(expected), "{reason}");
    }
}

#[test]
fn the_end_of_a_file_is_its_end() {
    let whole = file(&before());
    let reason = damage_at(&[&whole[..], b"more"].concat(), whole.len());
    assert_eq!(reason, "more bytes behind the end");
    let mut other_mark = whole.clone();
    *other_mark.last_mut().unwrap() = b'!';
    let reason = damage_at(&other_mark, whole.len() - MAGIC.len());
    assert_eq!(reason, "not the mark that MCAP files begin and end with");
    // Data behind the data's end.
    let footer = MAGIC.len() + 9 + 20;
    let late = message(1, 9, b"late");
    let at = whole.len() - footer;
    let reason = damage_at(&[&whole[..at], &late, &whole[at..]].concat(), at);
    assert_eq!(reason, "a record of kind 5 behind the data's end");
}

#[test]
fn what_is_called_like_a_part_and_is_no_file_is_refused() {
    let parent = tempfile::tempdir().unwrap();
    let refused = |name: &str, make: &dyn Fn(&Path)| {
        let folder = parent.path().join(name);
        fs::create_dir(&folder).unwrap();
        fs::write(folder.join("rig_0.mcap"), file(&before())).unwrap();
        fs::write(folder.join("notes.txt"), "what else is there is no matter").unwrap();
        assert_eq!(Bag::open(&folder).unwrap().survey().unwrap().messages(), 2);
        let part = folder.join("rig_1.mcap");
        make(&part);
        [Bag::open(&folder).unwrap_err(), Bag::open(&part).unwrap_err()]
    };
    let folder = refused("folder", &|part| fs::create_dir(part).unwrap());
    let device = refused("device", &|part| symlink("/dev/zero", part).unwrap());
    // Opening a pipe without a writer would never end.
    let pipe = refused("pipe", &|part| {
        assert!(std::process::Command::new("mkfifo").arg(part).status().unwrap().success());
    });
    for refusal in [&folder[0], &device[0], &device[1], &pipe[0], &pipe[1]] {
        assert!(matches!(refusal, ReadError::NoFile(_)), "{refusal}");
        assert!(refusal.to_string().ends_with("rig_1.mcap is no file"), "{refusal}");
    }
    // By itself it is a folder without a bag.
    assert!(matches!(&folder[1], ReadError::NoBag(_)), "{}", folder[1]);
    for refusal in refused("circle", &|part| symlink(part, part).unwrap()) {
        assert!(matches!(refusal, ReadError::Io { .. }), "{refusal}");
    }
    for refusal in refused("nothing", &|part| symlink("nowhere.mcap", part).unwrap()) {
        assert!(matches!(refusal, ReadError::Io { .. }), "{refusal}");
    }
}

/// Of a split bag, parts after the damaged one are not read: what they continue is not there.
#[test]
fn a_damaged_part_ends_the_bag_and_is_named() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("rig_0.mcap"), file(&before())).unwrap();
    fs::write(folder.path().join("rig_1.mcap"), "no bag").unwrap();
    fs::write(folder.path().join("rig_2.mcap"), file(&before())).unwrap();
    let survey = Bag::open(folder.path()).unwrap().survey().unwrap();
    assert_eq!(survey.messages(), 2);
    let damage = survey.damage.unwrap().to_string();
    assert!(damage.contains("rig_1.mcap is damaged at byte 0: not the mark"), "{damage}");
}
