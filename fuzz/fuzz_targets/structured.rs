//! Files whose lengths and sums are right, so that what is inside is reached, with a lie now and
//! then.
#![no_main]

use std::io::Write;

use arbitrary::Arbitrary;
use graintwin::msg::{
    BoundaryCommand, Described, Dissociation, JointState, JointTrajectory, ShearCommand, WallTargets,
};

const MAGIC: &[u8] = b"\x89MCAP0\r\n";

/// Most that contents are repeated to \[bytes\]: the generator is not what is tested.
const LARGEST: usize = 1 << 20;

#[derive(Arbitrary, Debug)]
struct File {
    pieces: Vec<Piece>,
    summary: Vec<Entry>,
    /// Overwrites these eight bytes, counted from the front.
    lies: Vec<(u16, u64)>,
    /// Leaves this much away at the end.
    cut: Option<u16>,
    summed: bool,
}

#[derive(Arbitrary, Debug)]
enum Piece {
    Chunk { packing: Packing, entries: Vec<Entry>, lie: Option<Lie> },
    Entry(Entry),
    Attachment { name: String, data: Vec<u8>, summed: bool },
    Metadata { name: String, pairs: Vec<(String, String)> },
    Other { opcode: u8, body: Vec<u8> },
}

#[derive(Arbitrary, Clone, Copy, Debug)]
enum Packing {
    None,
    Zstd,
    Lz4,
    Unknown,
}

#[derive(Arbitrary, Debug)]
struct Lie {
    unpacked: Option<u64>,
    sum: bool,
    packed: Option<u64>,
    /// Makes the contents this often as long.
    repeat: u8,
}

#[derive(Arbitrary, Debug)]
enum Entry {
    Schema { id: u8, kind: Kind, other: bool },
    Channel { id: u8, schema: u8, topic: u8, other: bool },
    Message { channel: u8, time: u32, data: Data },
    Zeros { channel: u8, count: u32 },
    Other { opcode: u8, body: Vec<u8>, length: Option<u64> },
}

#[derive(Arbitrary, Clone, Copy, Debug)]
enum Kind {
    Boundary,
    Targets,
    Dissociation,
    Shear,
    States,
    Trajectory,
    Unknown,
}

#[derive(Arbitrary, Debug)]
enum Data {
    Any(Vec<u8>),
    /// Joints as they ought to be.
    Joints {
        big: bool,
        names: Vec<bool>,
        positions: Vec<f64>,
        points: Vec<(u8, Vec<f64>)>,
    },
    /// Whatever, behind a right beginning.
    Cdr {
        big: bool,
        body: Vec<u8>,
    },
}

libfuzzer_sys::fuzz_target!(|file: File| {
    graintwin_fuzz::read(&file.bytes());
});

impl File {
    fn bytes(&self) -> Vec<u8> {
        let mut bytes = MAGIC.to_vec();
        record(&mut bytes, 1, |body| {
            text(body, "ros2");
            text(body, "");
        });
        self.pieces.iter().for_each(|piece| piece.write(&mut bytes));
        let sum = if self.summed { crc32fast::hash(&bytes) } else { 0 };
        record(&mut bytes, 15, |body| body.extend(sum.to_le_bytes()));
        self.summary.iter().for_each(|entry| entry.write(&mut bytes));
        record(&mut bytes, 2, |body| body.extend([0; 20]));
        bytes.extend(MAGIC);
        for &(at, lie) in self.lies.iter().take(2) {
            if let Some(there) = bytes.get_mut(usize::from(at)..usize::from(at) + 8) {
                there.copy_from_slice(&lie.to_le_bytes());
            }
        }
        if let Some(cut) = self.cut {
            bytes.truncate(bytes.len() - usize::from(cut).min(bytes.len()));
        }
        bytes
    }
}

impl Piece {
    fn write(&self, to: &mut Vec<u8>) {
        match self {
            Self::Entry(entry) => entry.write(to),
            Self::Other { opcode, body } => record(to, *opcode, |to| to.extend(body)),
            Self::Attachment { name, data, summed } => record(to, 9, |body| {
                body.extend([0; 16]);
                text(body, name);
                text(body, "");
                body.extend((data.len() as u64).to_le_bytes());
                body.extend(data);
                let sum = if *summed { crc32fast::hash(body) } else { 0 };
                body.extend(sum.to_le_bytes());
            }),
            Self::Metadata { name, pairs } => record(to, 12, |body| {
                text(body, name);
                let mut all = Vec::new();
                for (key, value) in pairs {
                    text(&mut all, key);
                    text(&mut all, value);
                }
                body.extend((all.len() as u32).to_le_bytes());
                body.extend(all);
            }),
            Self::Chunk { packing, entries, lie } => record(to, 6, |body| {
                let mut contents = Vec::new();
                entries.iter().for_each(|entry| entry.write(&mut contents));
                let repeat = lie.as_ref().map_or(1, |lie| lie.repeat.max(1));
                let most = LARGEST / contents.len().max(1);
                let contents = contents.repeat(usize::from(repeat).min(most.max(1)));
                let packed = packing.pack(&contents);
                body.extend([0; 16]);
                let unpacked = lie.as_ref().and_then(|lie| lie.unpacked);
                body.extend(unpacked.unwrap_or(contents.len() as u64).to_le_bytes());
                let wrong = lie.as_ref().is_some_and(|lie| lie.sum);
                body.extend((crc32fast::hash(&contents) ^ u32::from(wrong)).to_le_bytes());
                text(body, packing.name());
                let length = lie.as_ref().and_then(|lie| lie.packed);
                body.extend(length.unwrap_or(packed.len() as u64).to_le_bytes());
                body.extend(packed);
            }),
        }
    }
}

impl Packing {
    fn name(self) -> &'static str {
        match self {
            Self::None => "",
            Self::Zstd => "zstd",
            Self::Lz4 => "lz4",
            Self::Unknown => "brotli",
        }
    }

    fn pack(self, contents: &[u8]) -> Vec<u8> {
        match self {
            Self::None | Self::Unknown => contents.to_vec(),
            Self::Zstd => zstd::stream::encode_all(contents, 1).expect("zstd packs"),
            Self::Lz4 => {
                let builder = lz4::EncoderBuilder::new().build(Vec::new());
                let mut encoder = builder.expect("lz4 begins");
                encoder.write_all(contents).expect("lz4 packs");
                encoder.finish().0
            }
        }
    }
}

impl Entry {
    fn write(&self, to: &mut Vec<u8>) {
        match self {
            Self::Schema { id, kind, other } => record(to, 3, |body| {
                body.extend(u16::from(id % 4).to_le_bytes());
                let (name, mut definition) = kind.schema();
                text(body, &name);
                text(body, "ros2msg");
                if *other {
                    definition.push_str("\nfloat64 more\n");
                }
                text(body, &definition);
            }),
            Self::Channel { id, schema, topic, other } => record(to, 4, |body| {
                body.extend(u16::from(id % 4).to_le_bytes());
                body.extend(u16::from(schema % 4).to_le_bytes());
                text(body, ["/rig", "/joints", "/graintwin/commands", ""][usize::from(topic % 4)]);
                text(body, if *other { "json" } else { "cdr" });
                body.extend(0_u32.to_le_bytes());
            }),
            Self::Message { channel, time, data } => record(to, 5, |body| {
                message(body, *channel, u64::from(*time));
                data.write(body);
            }),
            // They pack to nothing.
            Self::Zeros { channel, count } => record(to, 5, |body| {
                message(body, *channel, 0);
                body.resize(body.len() + (count % (1 << 16)) as usize, 0);
            }),
            Self::Other { opcode, body, length } => {
                to.push(*opcode);
                to.extend(length.unwrap_or(body.len() as u64).to_le_bytes());
                to.extend(body);
            }
        }
    }
}

impl Kind {
    fn schema(self) -> (String, String) {
        let kind = match self {
            Self::Boundary => BoundaryCommand::TYPE,
            Self::Targets => WallTargets::TYPE,
            Self::Dissociation => Dissociation::TYPE,
            Self::Shear => ShearCommand::TYPE,
            Self::States => JointState::TYPE,
            Self::Trajectory => JointTrajectory::TYPE,
            Self::Unknown => return ("std_msgs/msg/String".into(), "string data\n".into()),
        };
        (kind.full_name(), kind.definition())
    }
}

impl Data {
    fn write(&self, to: &mut Vec<u8>) {
        match self {
            Self::Any(bytes) => to.extend(bytes),
            Self::Cdr { big, body } => {
                to.extend([0, u8::from(!big), 0, 0]);
                to.extend(body);
            }
            Self::Joints { big, names, positions, points } => {
                let mut cdr = Cdr { big: *big, bytes: Vec::new() };
                cdr.count(5);
                cdr.count(7);
                cdr.text("");
                cdr.count(names.len());
                names.iter().for_each(|right| cdr.text(if *right { "ram" } else { "other" }));
                if points.is_empty() {
                    cdr.floats(positions);
                    cdr.floats(&[]);
                    cdr.floats(&[]);
                } else {
                    cdr.count(points.len());
                    for (time, positions) in points {
                        cdr.floats(positions);
                        (0..3).for_each(|_| cdr.floats(&[]));
                        cdr.count(usize::from(*time));
                        cdr.count(0);
                    }
                }
                to.extend([0, u8::from(!big), 0, 0]);
                to.extend(cdr.bytes);
            }
        }
    }
}

struct Cdr {
    big: bool,
    bytes: Vec<u8>,
}

impl Cdr {
    fn align(&mut self, to: usize) {
        self.bytes.resize(self.bytes.len().next_multiple_of(to), 0);
    }

    fn count(&mut self, count: usize) {
        self.align(4);
        let count = count as u32;
        self.bytes.extend(if self.big { count.to_be_bytes() } else { count.to_le_bytes() });
    }

    fn text(&mut self, text: &str) {
        self.count(text.len() + 1);
        self.bytes.extend(text.as_bytes());
        self.bytes.push(0);
    }

    fn floats(&mut self, floats: &[f64]) {
        self.count(floats.len());
        for float in floats {
            self.align(8);
            self.bytes.extend(if self.big { float.to_be_bytes() } else { float.to_le_bytes() });
        }
    }
}

fn message(body: &mut Vec<u8>, channel: u8, time: u64) {
    body.extend(u16::from(channel % 4).to_le_bytes());
    body.extend(0_u32.to_le_bytes());
    body.extend(time.to_le_bytes());
    body.extend(time.to_le_bytes());
}

fn record(to: &mut Vec<u8>, opcode: u8, fill: impl FnOnce(&mut Vec<u8>)) {
    let mut body = Vec::new();
    fill(&mut body);
    to.push(opcode);
    to.extend((body.len() as u64).to_le_bytes());
    to.extend(body);
}

fn text(to: &mut Vec<u8>, text: &str) {
    to.extend((text.len() as u32).to_le_bytes());
    to.extend(text.as_bytes());
}
