//! A long recording of a rig is taken as it is asked for, not into memory.
#![cfg(feature = "mcap")]
#![allow(clippy::unwrap_used, reason = "a test that fails may panic")]
#![allow(unsafe_code, reason = "an allocator that counts is unsafe to write")]

use std::alloc::{GlobalAlloc, Layout, System};
use std::collections::BTreeMap;
use std::fs::File;
use std::io::BufWriter;
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};

use graintwin::command::request::Intake;
use graintwin::msg::{Described, Header, JointState, Time, cdr};
use graintwin::record::reader::{Bag, Source};
use graintwin::scene;
use mcap::records::MessageHeader;

/// The system's allocator, counting the bytes in use and the most there were.
struct Counting;

static IN_USE: AtomicUsize = AtomicUsize::new(0);
static MOST: AtomicUsize = AtomicUsize::new(0);

// SAFETY: every call is passed on to the system's allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        let now = IN_USE.fetch_add(layout.size(), Ordering::SeqCst) + layout.size();
        MOST.fetch_max(now, Ordering::SeqCst);
        // SAFETY: the caller keeps the contract of `alloc`.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, at: *mut u8, layout: Layout) {
        IN_USE.fetch_sub(layout.size(), Ordering::SeqCst);
        // SAFETY: the caller keeps the contract of `dealloc`, and `alloc` gave `at`.
        unsafe { System.dealloc(at, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Messages: five minutes at 1 kHz.
const LENGTH: u32 = 300_000;

/// Most that reading may hold \[bytes\]: a chunk of 1 MiB and 4096 messages with what they are kept
/// in. All commands at once are 60 MB and more.
const BOUND: usize = 8 << 20;

/// Writes a rig's joints, every two messages exchanged.
fn write(file: &Path) {
    let options = mcap::WriteOptions::new().chunk_size(Some(1 << 20)).profile("ros2");
    let mut writer = options.create(BufWriter::new(File::create(file).unwrap())).unwrap();
    let kind = JointState::TYPE;
    let definition = kind.definition();
    let schema = writer.add_schema(&kind.full_name(), "ros2msg", definition.as_bytes()).unwrap();
    let channel = writer.add_channel(schema, "/press/joints", "cdr", &BTreeMap::new()).unwrap();
    let mut bytes = Vec::new();
    for number in (0..LENGTH).map(|number| number ^ 1) {
        let stamp = Time { sec: (number / 1000) as i32, nanosec: number % 1000 * 1_000_000 };
        let message = JointState {
            header: Header { stamp, frame_id: String::new() },
            name: vec!["ram".into()],
            position: vec![f64::from(number)],
            ..JointState::default()
        };
        cdr::encode(&message, &mut bytes).unwrap();
        let time = u64::from(number) * 1_000_000;
        let header =
            MessageHeader { channel_id: channel, sequence: 0, log_time: time, publish_time: time };
        writer.write_to_known_channel(&header, &bytes).unwrap();
    }
    writer.finish().unwrap();
}

/// The only test of this program: others beside it would allocate too.
#[test]
fn a_long_recording_is_never_in_memory_as_a_whole() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("rig.mcap");
    write(&file);
    let text = "pack: {file: none.csv}\nnode: {joint_states: {joints: {ram: {wall: z_max}}}}\n";
    let scene = scene::parse(text, Path::new("scene.yaml")).unwrap();

    let before = IN_USE.load(Ordering::SeqCst);
    MOST.store(before, Ordering::SeqCst);
    let intakes = Bag::open(&file).unwrap().intakes(&Source::new(&scene.node, None)).unwrap();
    assert_eq!(intakes.messages(), u64::from(LENGTH));
    assert_eq!(intakes.topics().collect::<Vec<_>>(), ["/press/joints"]);
    let mut count = 0;
    for item in intakes {
        let (time, intake) = item.unwrap();
        let Intake::Command(command) = intake else { panic!("{intake:?}") };
        assert_eq!(time, count * 1_000_000);
        count += 1;
        assert_eq!(command.sequence, count);
    }
    assert_eq!(count, u64::from(LENGTH));
    let most = MOST.load(Ordering::SeqCst) - before;
    assert!(most < BOUND, "{most} bytes");
}
