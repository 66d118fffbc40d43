//! MCAP files byte by byte, so that they can be wrong.
#![allow(dead_code, reason = "each test takes what it needs of it")]

use std::io::Write;

use graintwin::msg::MessageType;

pub(crate) const MAGIC: &[u8] = b"\x89MCAP0\r\n";

pub(crate) const FOOTER: u8 = 2;
pub(crate) const SCHEMA: u8 = 3;
pub(crate) const CHANNEL: u8 = 4;
pub(crate) const MESSAGE: u8 = 5;
pub(crate) const CHUNK: u8 = 6;
pub(crate) const METADATA: u8 = 12;
pub(crate) const DATA_END: u8 = 15;

/// Opcode, length and body.
pub(crate) fn record(opcode: u8, body: &[u8]) -> Vec<u8> {
    let mut record = vec![opcode];
    record.extend((body.len() as u64).to_le_bytes());
    record.extend(body);
    record
}

pub(crate) fn text(text: &str) -> Vec<u8> {
    let mut bytes = (text.len() as u32).to_le_bytes().to_vec();
    bytes.extend(text.as_bytes());
    bytes
}

pub(crate) fn schema(id: u16, name: &str, definition: &str) -> Vec<u8> {
    let id = id.to_le_bytes().to_vec();
    record(SCHEMA, &[id, text(name), text("ros2msg"), text(definition)].concat())
}

pub(crate) fn schema_of(id: u16, kind: &'static MessageType) -> Vec<u8> {
    schema(id, &kind.full_name(), &kind.definition())
}

pub(crate) fn channel(id: u16, schema: u16, topic: &str) -> Vec<u8> {
    let mut body = [id.to_le_bytes(), schema.to_le_bytes()].concat();
    body.extend([text(topic), text("cdr"), vec![0; 4]].concat());
    record(CHANNEL, &body)
}

pub(crate) fn message(channel: u16, time: u64, data: &[u8]) -> Vec<u8> {
    let mut body = [&channel.to_le_bytes()[..], &[0; 4]].concat();
    body.extend([time.to_le_bytes(), time.to_le_bytes()].concat());
    body.extend(data);
    record(MESSAGE, &body)
}

/// A chunk of `packed` bytes that says what it is packed with, and how long its contents are.
pub(crate) fn chunk(packing: &str, unpacked: u64, packed: &[u8]) -> Vec<u8> {
    let mut body = vec![0; 16];
    body.extend(unpacked.to_le_bytes());
    body.extend([0; 4]);
    body.extend(text(packing));
    body.extend((packed.len() as u64).to_le_bytes());
    body.extend(packed);
    record(CHUNK, &body)
}

/// A chunk of these records as it ought to be.
pub(crate) fn zstd(records: &[u8]) -> Vec<u8> {
    let packed = zstd::stream::encode_all(records, 19).unwrap();
    chunk("zstd", records.len() as u64, &packed)
}

/// A chunk of these records as it ought to be.
pub(crate) fn lz4(records: &[u8]) -> Vec<u8> {
    let mut encoder = lz4::EncoderBuilder::new().build(Vec::new()).unwrap();
    encoder.write_all(records).unwrap();
    chunk("lz4", records.len() as u64, &encoder.finish().0)
}

/// A whole file of these records, without sums.
pub(crate) fn file(records: &[Vec<u8>]) -> Vec<u8> {
    let ends = [record(DATA_END, &[0; 4]), record(FOOTER, &[0; 20])].concat();
    [MAGIC, &records.concat(), &ends, MAGIC].concat()
}
