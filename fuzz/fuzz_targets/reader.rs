//! Arbitrary bytes as an MCAP file.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| graintwin_fuzz::read(bytes));
