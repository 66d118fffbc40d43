//! A network that no other program is on, for tests that speak DDS.

use std::process::{Command, Stdio};
use std::sync::atomic::{AtomicU32, Ordering};

/// Set in the process that runs a test's body.
const INSIDE: &str = "GRAINTWIN_TEST_NETWORK";

/// How the loopback interface of the network is set up.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Loopback {
    /// With multicast: DDS implementations find each other at once.
    Multicast,
    /// As a machine has it: without.
    #[allow(dead_code, reason = "not every test program needs it")]
    Plain,
}

/// Runs `body` where nothing else speaks DDS: in a network namespace, or, where those are
/// forbidden, in a DDS domain that nobody else uses and over loopback only.
///
/// The test program starts itself again inside, for the one function `test`, whose body then runs.
pub(crate) fn alone<T: Fn()>(test: T, loopback: Loopback, body: impl FnOnce()) {
    if std::env::var_os(INSIDE).is_some() {
        body();
        return;
    }
    let name = name_of(&test);
    let program = std::env::current_exe().expect("a running program has a path");
    let mut command = match namespace_flag() {
        Some(flag) => {
            let mut command = Command::new("unshare");
            command.args([flag, "sh", "-c", script(loopback)]).arg(&program);
            command.env_remove("ROS_DOMAIN_ID").env_remove("CYCLONEDDS_URI");
            command
        }
        None => {
            let mut command = Command::new("sh");
            command.args(["-c", ENTER]).arg(&program);
            // Tests run side by side. Below 102, the ports of a domain are not those that Linux
            // gives away.
            static STARTED: AtomicU32 = AtomicU32::new(0);
            let started = STARTED.fetch_add(1, Ordering::Relaxed);
            let domain = 20 + (std::process::id() + started) % 80;
            command.env("ROS_DOMAIN_ID", domain.to_string()).env("CYCLONEDDS_URI", UNICAST);
            command
        }
    };
    let output = command
        .arg(name)
        .env(INSIDE, "1")
        .stdin(Stdio::null())
        .output()
        .expect("unshare or sh can be started");
    let said = String::from_utf8_lossy(&output.stdout);
    // Through the test's own capture, so that it shows only when the test fails.
    println!("{said}");
    assert!(
        output.status.success() && said.contains("1 passed"),
        "in its own network: {}\n{}",
        output.status,
        String::from_utf8_lossy(&output.stderr)
    );
}

/// The name of a function as the test program knows it.
pub(crate) fn name_of<T: Fn()>(_: &T) -> &'static str {
    let path = std::any::type_name::<T>();
    path.split_once("::").map_or(path, |(_, name)| name)
}

/// The flag with which this user can make a network namespace.
fn namespace_flag() -> Option<&'static str> {
    ["-n", "-rn"].into_iter().find(|flag| {
        let probe = Command::new("unshare").args([flag, "true"]).stderr(Stdio::null()).status();
        probe.is_ok_and(|status| status.success())
    })
}

fn script(loopback: Loopback) -> &'static str {
    match loopback {
        Loopback::Multicast => {
            "ip link set lo up && ip link set lo multicast on \
             && ip route add 224.0.0.0/4 dev lo && exec \"$0\" --exact \"$1\" --nocapture"
        }
        Loopback::Plain => "ip link set lo up && exec \"$0\" --exact \"$1\" --nocapture",
    }
}

const ENTER: &str = "exec \"$0\" --exact \"$1\" --nocapture";

/// CycloneDDS over loopback without multicast.
const UNICAST: &str = "<CycloneDDS><Domain><General><Interfaces>\
    <NetworkInterface address=\"127.0.0.1\"/></Interfaces><AllowMulticast>false</AllowMulticast>\
    </General><Discovery><ParticipantIndex>auto</ParticipantIndex>\
    <Peers><Peer address=\"127.0.0.1\"/></Peers></Discovery></Domain></CycloneDDS>";
