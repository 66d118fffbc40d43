//! The fastest twin with forces: one glass bead between six walls, and a long path for it.
#![allow(dead_code, reason = "each test takes what it needs of it")]

use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Makes `scene.yaml` with the section `record`, and `path.csv` with `commands` commands, in
/// `folder`; one increment takes well below a millisecond.
pub(crate) fn write_bead(folder: &Path, record: &str, commands: u64) {
    let (radius, half) = (1e-4, 1e-4 - 1e-7);
    fs::write(folder.join("bead.csv"), format!("x,y,z,radius\n0,0,0,{radius}\n")).unwrap();
    let scene = format!(
        "materials: {{glass: {{young: 70e9, poisson: 0.2, density: 2420}}}}\n\
         pack:\n  file: bead.csv\n  material: glass\n  \
         box: {{min: [-{half}, -{half}, -{half}], max: [{half}, {half}, {half}]}}\n\
         record: {record}\n"
    );
    fs::write(folder.join("scene.yaml"), scene).unwrap();
    let mut path = "stamp,z_max\n".to_owned();
    for command in 1..=commands {
        let way = (command % 200) as f64 * 1e-10;
        writeln!(path, "{:.3},{way:e}", command as f64 * 1e-3).unwrap();
    }
    fs::write(folder.join("path.csv"), path).unwrap();
}

/// `graintwin run` of that in `folder`, recording into `run` there.
pub(crate) fn run_and_record(folder: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_graintwin"));
    command.current_dir(folder).env_remove("RUST_LOG").args(arguments());
    command
}

/// What comes behind the program's name.
pub(crate) fn arguments() -> [&'static str; 9] {
    ["run", "scene.yaml", "--commands", "path.csv", "--record", "run", "--threads", "1", "--json"]
}

/// The files of a recording in `folder`, in order.
pub(crate) fn parts(folder: &Path) -> Vec<PathBuf> {
    let Ok(entries) = fs::read_dir(folder) else { return Vec::new() };
    let mut files: Vec<PathBuf> = entries
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "mcap"))
        .collect();
    files.sort_by_key(|path| (path.as_os_str().len(), path.clone()));
    files
}
