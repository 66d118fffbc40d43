//! The program `graintwin`.
fn main() {}
