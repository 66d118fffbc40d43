//! The program killed in the middle of a run, and started again from what it saved.
#![cfg(feature = "mcap")]

use std::fs;
use std::path::Path;
use std::process::Command;

use graintwin::msg::{WallForces, cdr};
use graintwin::record::reader::Bag;
use serde_json::{Value, json};

use crate::program::{Program, Rig, Sent, alone_with_scene};

const PACK: &str = "pack: {generate: {grains: 60, radius: {uniform: [0.07e-3, 0.13e-3]},
                  material: glass, confining_stress: 1.0e7}}";

/// Friction, and services in the mapping of the peer.
const REST: &str = "
contact: {friction: {coefficient: 0.3}}
node: {service_mapping: cyclone}
";

/// A step of a wall \[m\]. It is a power of two, as long as the digits of a wall's place reach, so
/// that taking off what was gone before rounds nothing.
const STEP: f64 = 1.0 / (1_u64 << 34) as f64;

/// Commands in the whole run, and how many of them the pack that is saved has behind it.
const ALL: usize = 20;
const SAVED: usize = 10;

/// An absolute command that loads three walls and unloads one.
fn command(sequence: u64) -> Sent<'static> {
    let way = sequence as f64 * STEP;
    ("rig", sequence, 0, [way, 0.0, -way, 0.0, way, 2.0 * way])
}

/// Forces and moments on the walls in each message.
fn forces(messages: &[Value]) -> Vec<[&Value; 3]> {
    messages
        .iter()
        .map(|message| ["normal_force", "force", "moment"].map(|field| &message[field]))
        .collect()
}

/// What the bag of the killed run holds: whole increments up to its end.
fn the_bag_is_the_run_up_to_its_end(folder: &Path, commands: &[Sent<'_>], undisturbed: &[Value]) {
    let checked = Command::new(env!("CARGO_BIN_EXE_graintwin"))
        .current_dir(folder)
        .args(["check", "bag"])
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&checked.stdout);
    println!("{said}");
    assert_eq!(checked.status.code(), Some(3), "it says that the bag has no end: {said}");

    let bag = Bag::open(&folder.join("bag")).unwrap();
    let asked: Vec<_> = bag.commands().map_while(Result::ok).collect();
    // The save took longer than the recorder keeps anything to itself.
    assert!((SAVED..=ALL).contains(&asked.len()), "{}", asked.len());
    for (asked, sent) in asked.iter().zip(commands) {
        assert_eq!((asked.sequence, asked.ask.numbers()), (sent.1, sent.3));
    }
    let recorded: Vec<WallForces> = bag
        .messages()
        .map_while(Result::ok)
        .filter(|message| message.channel.topic == "/graintwin/wall_forces")
        .map(|message| cdr::decode(&message.data).unwrap())
        .collect();
    assert!(recorded.len() > SAVED, "{}", recorded.len());
    for (recorded, heard) in recorded.iter().zip(undisturbed) {
        assert_eq!(json!(recorded.normal_force), heard["normal_force"]);
        assert_eq!(json!(recorded.displacement), heard["displacement"]);
    }
    for attachment in ["scene.yaml", "pack.csv", "pack.json"] {
        assert!(said.contains(attachment), "{attachment}: {said}");
    }
}

#[test]
fn a_killed_program_goes_on_from_the_saved_pack_to_the_bits_of_an_undisturbed_run() {
    alone_with_scene(
        a_killed_program_goes_on_from_the_saved_pack_to_the_bits_of_an_undisturbed_run,
        &format!("{PACK}{REST}"),
        |python, folder| {
            let commands: Vec<Sent<'_>> = (1..=ALL as u64).map(command).collect();
            let undisturbed = {
                let program = Program::start(folder, "undisturbed", &[]);
                let mut rig = Rig::start(python, &["wall_forces"]);
                rig.send(&commands, 0.0);
                assert_eq!(rig.wait("wall_forces", 1 + ALL), 1 + ALL);
                assert!(program.terminate().0.success());
                rig.told("wall_forces")
            };

            let program = Program::start(folder, "killed", &["--record", "bag"]);
            let mut rig = Rig::start(python, &["report"]);
            rig.send(&commands[..SAVED], 0.0);
            assert_eq!(rig.wait("report", 1 + SAVED), 1 + SAVED);
            let answer = rig.call("save_pack", &json!({"path": "saved.csv"}));
            assert_eq!(answer["success"], true, "{answer}");
            rig.send(&commands[SAVED..], 0.0);
            rig.wait("report", 2 + SAVED);
            program.kill();
            drop(rig);
            the_bag_is_the_run_up_to_its_end(folder, &commands, &undisturbed);

            let scene = format!("pack: {{file: saved.csv}}{REST}");
            fs::write(folder.join("scene.yaml"), scene).unwrap();
            let program = Program::start(folder, "restarted", &[]);
            let mut rig = Rig::start(python, &["wall_forces", "state"]);
            // Displacements count from the start of the run, which is now the saved state: the rig
            // takes off those of the last command before it.
            let gone = commands[SAVED - 1].3;
            let rest: Vec<Sent<'_>> = commands[SAVED..]
                .iter()
                .map(|&(_, sequence, mode, way)| {
                    ("again", sequence, mode, std::array::from_fn(|w| way[w] - gone[w]))
                })
                .collect();
            rig.send(&rest, 0.0);
            let heard = 1 + ALL - SAVED;
            assert_eq!(rig.wait("wall_forces", heard), heard);
            let (again, state) = (rig.told("wall_forces"), rig.told("state"));
            assert!(program.terminate().0.success());
            assert_eq!((&state[0]["increment"], &state[0]["iterations"]), (&json!(0), &json!(0)));
            assert!(forces(&again) == forces(&undisturbed[SAVED..]), "{again:#?}");
        },
    );
}
