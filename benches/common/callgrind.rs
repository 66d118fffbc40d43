//! Instruction counts of a part of a bench, by callgrind.

use std::env;
use std::process::Command;

/// Set for the process under valgrind: what it is to run.
const ORDER: &str = "GRAINTWIN_BENCH_ORDER";

/// What this process is to run alone; `None` for the bench itself.
pub(crate) fn order() -> Option<String> {
    env::var(ORDER).ok()
}

/// What callgrind collects in, on the thread that calls it.
#[inline(never)]
pub(crate) fn measured(work: &mut dyn FnMut()) {
    work();
}

/// Instructions that this program spends within [`measured`] when it runs `order`; `None` when
/// valgrind is not installed.
pub(crate) fn instructions(order: &str) -> Option<f64> {
    let program = env::current_exe().expect("this program");
    let output = Command::new("valgrind")
        .args(["--tool=callgrind", "--toggle-collect=*callgrind*measured*"])
        .arg("--callgrind-out-file=/dev/null")
        .arg(program)
        .env(ORDER, order)
        .output()
        .ok()?;
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{text}");
    let line = text.lines().find_map(|line| line.split_once("Collected : "));
    Some(line.expect("callgrind says what it collected").1.trim().parse().expect("a number"))
}
