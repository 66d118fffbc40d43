//! A CycloneDDS peer plays the measured rig log to the program; what it receives is held against
//! a twin that got the same commands without any network.

use std::fs;
use std::path::Path;
use std::process;
use std::sync::Arc;

use graintwin::command::{Command, Disposition};
use graintwin::pack::{self, Pack};
use graintwin::path;
use graintwin::report::Demand;
use graintwin::scene::{self, LoadPath, Scene};
use graintwin::sink::Served;
use graintwin::twin::Twin;

use crate::peer;

/// Grains of the pack: enough for a contact network of several chunks.
const GRAINS: usize = 500;

/// The scene of the rig log with a smaller pack and nothing that moves the walls but the topic,
/// and the log as commands.
fn rig_log() -> (Scene, Pack, Vec<Command>) {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("launch_configs/rig_log.yaml");
    let mut loaded = scene::load(&file).unwrap();
    loaded.scene.pack.generate.as_mut().unwrap().grains = GRAINS;
    let pack = pack::build(&loaded).unwrap();
    let commands = path::commands(&loaded.scene.load_path, loaded.folder(), &pack.bounds).unwrap();
    loaded.scene.load_path = LoadPath::default();
    loaded.scene.node.virtual_rig = false;
    (loaded.scene, pack, commands)
}

/// What a twin answers when it is asked for everything.
fn without_network(mut twin: Twin, commands: &[Command]) -> Vec<Arc<Served>> {
    let first = Served { command: None, report: twin.start(Demand::ALL) };
    let answers = commands.iter().map(|command| Served {
        command: Some(command.clone()),
        report: twin.apply(command, Demand::ALL),
    });
    std::iter::once(first).chain(answers).map(Arc::new).collect()
}

/// The program, killed when a test gives up.
struct Program(process::Child);

impl Program {
    fn start(scene: &Path) -> Self {
        let program = process::Command::new(env!("CARGO_BIN_EXE_graintwin"))
            .arg("run")
            .arg(scene)
            .args(["--ros", "--threads", "1"])
            .spawn()
            .unwrap();
        Self(program)
    }

    fn terminate(mut self) -> process::ExitStatus {
        let pid = self.0.id().to_string();
        assert!(process::Command::new("kill").args(["-TERM", &pid]).status().unwrap().success());
        self.0.wait().unwrap()
    }
}

impl Drop for Program {
    fn drop(&mut self) {
        // An error says that it has ended.
        self.0.kill().ok();
    }
}

#[test]
fn a_cyclone_peer_plays_the_rig_log_and_gets_every_answer_of_the_twin() {
    peer::alone_with_peer(
        a_cyclone_peer_plays_the_rig_log_and_gets_every_answer_of_the_twin,
        |python| {
            let (scene, pack, commands) = rig_log();
            let expected = without_network(Twin::new(&scene, &pack, 1).unwrap(), &commands);
            let applied = |one: &&Arc<Served>| one.report.disposition == Disposition::Applied;
            assert_eq!(expected.iter().filter(applied).count(), 1 + 84);

            let folder = tempfile::tempdir().unwrap();
            let file = folder.path().join("scene.yaml");
            fs::write(&file, scene.to_yaml().unwrap()).unwrap();
            let program = Program::start(&file);
            let played = peer::start(python, folder.path(), &commands, Some(8)).wait().unwrap();
            let ended = program.terminate();
            assert!(played.success());
            assert!(ended.success(), "{ended}");
            peer::compare(python, folder.path(), &expected, &["solve_seconds"]);
        },
    );
}
