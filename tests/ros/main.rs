//! The node over DDS, with peers of other makes. Each test has a network of its own.
#![cfg(feature = "ros")]
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "a test may panic, and its capture keeps what it prints until then"
)]

mod citizen;
#[path = "../common/joined.rs"]
mod joined;
mod joints;
#[path = "../common/listener.rs"]
mod listener;
#[path = "../common/made_up.rs"]
mod made_up;
#[path = "../common/network.rs"]
mod network;
mod node;
#[path = "../common/partner.rs"]
mod partner;
#[path = "../common/peer.rs"]
mod peer;
mod pictures;
#[path = "../common/program.rs"]
mod program;
#[path = "../common/python.rs"]
mod python;
mod recorded;
mod replay;
mod rig_log;
mod robust;
mod robust_killed;
mod robust_rigs;
#[path = "../common/script.rs"]
mod script;
mod services;
