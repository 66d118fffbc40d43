//! What others rely on: messages, their bytes, the interface package, launch files, the layout.
#![allow(clippy::unwrap_used, reason = "a test that fails may panic")]

mod cdr;
mod foxglove_layout;
mod interface_package;
mod launch_configs;
mod messages;
#[path = "../common/python.rs"]
mod python;
#[path = "../common/shape.rs"]
mod shape;
