//! The memory that reading a recording takes.
#![cfg(all(feature = "mcap", target_os = "linux"))]
#![allow(clippy::unwrap_used, reason = "a test that fails may panic")]

#[path = "common/mcap_bytes.rs"]
mod mcap_bytes;

use std::fs;
use std::io::{self, Read, Write};
use std::path::Path;
use std::process::Command;

use graintwin::msg::{BoundaryCommand, Described, JointState, JointTrajectory, MessageType};
use graintwin::record::reader::SMALL_FILE_MEMORY;
use mcap_bytes::{CHANNEL, MESSAGE, SCHEMA, channel, chunk, file, record, schema_of, text};
use nix::sys::resource::{UsageWho, getrusage};

/// Largest file here \[bytes\].
const SMALL: usize = 120_000;

const SCENE: &str = "
pack: {file: grain.csv, box: {min: [-1.0e-3, -1.0e-3, -1.0e-3], max: [1.0e-3, 1.0e-3, 1.0e-3]}}
node:
  joint_states: {joints: {ram: {wall: z_max}}}
  joint_trajectory: {joints: {ram: {wall: z_max}}}
";

const GRAIN: &str =
    "x,y,z,radius,young,poisson,density,friction\n0,0,0,1.00001e-3,70e9,0.2,2500,0\n";

/// A chunk of `size` bytes of zeros in as few as zstd's format allows: blocks that repeat a byte.
fn zeros(size: usize) -> Vec<u8> {
    const BLOCK: usize = 128 << 10;
    // A window of 128 MiB, and no size.
    let mut packed = vec![0x28, 0xb5, 0x2f, 0xfd, 0x00, 17 << 3];
    let blocks = size / BLOCK;
    for block in 1..=blocks {
        let head = (BLOCK as u32) << 3 | 1 << 1 | u32::from(block == blocks);
        packed.extend_from_slice(&head.to_le_bytes()[..3]);
        packed.push(0);
    }
    chunk("zstd", size as u64, &packed)
}

/// A chunk of these bytes, each followed by so many of one kind. They are never in memory here.
fn packed(pieces: &[(Vec<u8>, u8, usize)]) -> Vec<u8> {
    let mut encoder = zstd::stream::Encoder::new(Vec::new(), 3).unwrap();
    let mut size = 0;
    for (bytes, filler, count) in pieces {
        encoder.write_all(bytes).unwrap();
        io::copy(&mut io::repeat(*filler).take(*count as u64), &mut encoder).unwrap();
        size += bytes.len() + count;
    }
    chunk("zstd", size as u64, &encoder.finish().unwrap())
}

/// A message of CDR that begins with a header without a frame and these numbers, and goes on with
/// `zeros`, in a chunk with its topic.
fn message_of(kind: &'static MessageType, numbers: &[u32], zeros: usize) -> Vec<u8> {
    let mut cdr = vec![0, 1, 0, 0];
    // Two numbers of the stamp; and an empty text.
    cdr.extend([0; 12]);
    cdr.extend(numbers.iter().flat_map(|number| number.to_le_bytes()));
    let mut begin = [schema_of(1, kind), channel(1, 1, "/rig")].concat();
    begin.push(MESSAGE);
    begin.extend((22 + cdr.len() as u64 + zeros as u64).to_le_bytes());
    begin.extend(1_u16.to_le_bytes());
    begin.extend([0; 20]);
    begin.extend(cdr);
    packed(&[(begin, 0, zeros)])
}

/// A type with a definition of `size` bytes.
fn type_of(id: u16, size: usize) -> (Vec<u8>, u8, usize) {
    let names = [text("a/msg/B"), text("ros2msg")].concat();
    let mut begin = vec![SCHEMA];
    begin.extend((2 + names.len() as u64 + 4 + size as u64).to_le_bytes());
    begin.extend(id.to_le_bytes());
    begin.extend(names);
    begin.extend((size as u32).to_le_bytes());
    (begin, b'#', size)
}

/// Files that are made to fill memory.
fn hostile() -> Vec<(&'static str, Vec<u8>)> {
    const LARGE: usize = 15 << 20;
    let types: Vec<_> = (1..9).map(|id| packed(&[type_of(id, LARGE)])).collect();
    let topics: Vec<u8> = (1..30_000).flat_map(|id| channel(id, 1, "/t")).collect();
    // With a word of another word each.
    let words: Vec<u8> = (1..30_000)
        .flat_map(|id| {
            let mut body = [id, 1_u16].map(u16::to_le_bytes).concat();
            body.extend([text("/t"), text("cdr"), vec![10, 0, 0, 0]].concat());
            body.extend([text("a"), text("b")].concat());
            record(CHANNEL, &body)
        })
        .collect();
    let of = |kind, numbers: &[u32], zeros| file(&[message_of(kind, numbers, zeros)]);
    let length =
        |opcode: u8, length: u64| file(&[[&[opcode][..], &length.to_le_bytes()[..]].concat()]);
    vec![
        ("zeros", file(&[zeros(64 << 20)])),
        ("many_zeros", file(&vec![zeros(64 << 20); 8])),
        ("more_zeros_than_allowed", file(&[zeros(512 << 20)])),
        ("large_message", of(JointState::TYPE, &[1 << 28], 63 << 20)),
        // An empty text is four zeros.
        ("many_names", of(JointState::TYPE, &[2_000_000], 8_000_000 + 12)),
        // A point of empty arrays is 24.
        ("many_points", of(JointTrajectory::TYPE, &[0, 340_000], 24 * 340_000)),
        ("long_session", of(BoundaryCommand::TYPE, &[60 << 20], (60 << 20) + 80)),
        ("large_types", file(&types)),
        ("many_topics", file(&[packed(&[type_of(1, LARGE), (topics, 0, 0)])])),
        ("many_topics_with_words", file(&[packed(&[type_of(1, LARGE / 4), (words, 0, 0)])])),
        ("long_message", length(5, 512 << 20)),
        ("long_chunk", length(6, 512 << 20)),
        ("long_attachment", length(9, 512 << 20)),
        ("long_metadata", length(12, 16 << 20)),
        ("long_other", length(0x81, u64::MAX)),
        ("many_small_chunks", file(&vec![chunk("", 0, b""); 600])),
    ]
}

/// The most memory of the largest child so far \[bytes\].
fn largest_child() -> usize {
    getrusage(UsageWho::RUSAGE_CHILDREN).unwrap().max_rss() as usize * 1024
}

/// The most memory of this program so far \[bytes\].
fn own() -> usize {
    let status = fs::read_to_string("/proc/self/status").unwrap();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:")).unwrap();
    line.trim().trim_end_matches(" kB").parse::<usize>().unwrap() * 1024
}

/// The only test of this program: others beside it would have children too.
#[test]
fn a_small_file_takes_no_more_memory_than_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    fs::write(at("scene.yaml"), SCENE).unwrap();
    fs::write(at("grain.csv"), GRAIN).unwrap();
    let run = |arguments: &[&Path]| {
        let ended = Command::new(env!("CARGO_BIN_EXE_graintwin")).args(arguments).output().unwrap();
        (ended.status.code(), String::from_utf8(ended.stderr).unwrap())
    };
    for (name, bytes) in hostile() {
        assert!(bytes.len() < SMALL, "{name}: {}", bytes.len());
        let bag = at(&format!("{name}.mcap"));
        fs::write(&bag, bytes).unwrap();
        let [run_verb, scene, check, option] = ["run", "scene.yaml", "check", "--commands"]
            .map(|word| if word.contains('.') { at(word) } else { word.into() });
        let (code, said) = run(&[&check, &bag]);
        assert!(matches!(code, Some(0 | 3)), "check {name}: {code:?}\n{said}");
        let (code, said) = run(&[&run_verb, &scene, &option, &bag]);
        assert!(matches!(code, Some(2 | 3)), "run {name}: {code:?}\n{said}");
        let most = largest_child();
        assert!(most < SMALL_FILE_MEMORY, "{name}: {most} bytes");
    }
    // What is measured is theirs: a child counts that of its parent, until it is a program of its
    // own.
    assert!(own() < 64 << 20);
    assert!(largest_child() > 128 << 20);
}
