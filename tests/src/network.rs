//! Programs that speak DDS, in a network namespace of their own with loopback only.

use std::io::Write;
use std::process::{Command, Stdio};
use std::sync::{Mutex, MutexGuard, PoisonError};

use serde_json::Value;

use crate::python::{self, Distribution};

/// A command in a network namespace of its own, so that nothing leaves this machine and nothing
/// else is heard.
///
/// # Panics
/// Where the system grants none: the test says what it needs by [`needs`](macro@crate::needs).
pub fn namespaced() -> Command {
    let flags = machine::namespace_flags().expect("a network namespace");
    let mut command = Command::new("unshare");
    command.args(flags).args(["bash", "-c", machine::LOOPBACK_ONLY, "--"]);
    command
}

/// The turn of a session: six nodes at 1 kHz are enough for one machine, so that one session comes
/// after the other. It ends where this is dropped.
pub fn turn() -> MutexGuard<'static, ()> {
    static TURN: Mutex<()> = Mutex::new(());
    TURN.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Runs a script of `tests/python/` with the real rclpy in a namespace of its own, and reads the
/// JSON it prints. The nodes' programs are given to it as the folder in which they lie.
///
/// # Panics
/// When either cannot be had, or the script fails or prints something else; the message carries
/// what it said.
pub fn session(script: &str, arguments: &[&str]) -> Value {
    session_at(Place::Loopback, Distribution::Kilted, script, arguments)
}

/// As [`session`], elsewhere or with another distribution of ROS 2.
///
/// # Panics
/// As [`session`].
pub fn session_at(
    place: Place,
    distribution: Distribution,
    script: &str,
    arguments: &[&str],
) -> Value {
    let _turn = turn();
    let python = python::interpreter_of(distribution);
    let mut command = place.command();
    command.arg(&python).arg(python::script(script)).arg(crate::node_programs()).args(arguments);
    command.env("ROS_DOMAIN_ID", "74");
    report(command).0
}

/// Runs a session: the JSON that it prints, and what it says on standard error.
///
/// # Panics
/// When it fails or prints something else; the message carries what it said.
pub fn report(mut command: Command) -> (Value, String) {
    let logs = tempfile::tempdir().expect("a folder");
    let output = command.env("ROS_LOG_DIR", logs.path()).output().expect("it starts");
    let told = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{command:?}: {told}");
    let printed = String::from_utf8_lossy(&output.stdout);
    let report = serde_json::from_str(&printed)
        .unwrap_or_else(|error| panic!("{command:?} printed {printed}: {error}\n{told}"));
    (report, told)
}

/// Gives `cases` to a script of `tests/python/` with the real rclpy and reads the JSON it prints.
///
/// # Panics
/// As [`session`].
pub fn peer(script: &str, cases: &Value) -> Value {
    let python = python::interpreter("rclpy");
    let mut command = namespaced();
    let logs = tempfile::tempdir().expect("a folder");
    let mut running = command
        .arg(&python)
        .arg(python::script(script))
        .env("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
        .env("ROS_LOG_DIR", logs.path())
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("unshare starts");
    let mut input = running.stdin.take().expect("its input is ours");
    input.write_all(cases.to_string().as_bytes()).expect("it reads");
    drop(input);
    let output = running.wait_with_output().expect("it ends");
    let told = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{script}: {told}");
    serde_json::from_slice(&output.stdout)
        .unwrap_or_else(|error| panic!("{script}: {error}\n{told}"))
}

/// MTU of an ordinary network card \[bytes\].
pub const ORDINARY_MTU: u16 = 1500;
/// MTU of a network with jumbo frames \[bytes\].
pub const JUMBO_MTU: u16 = 9000;

/// Two machines on one network, as PCs have it: this one is 192.0.2.1, and 192.0.2.2 is the network
/// namespace of the process `$OTHER_MACHINE`; `$THIS_MACHINE` is a process here. The loopback has
/// no multicast, which is routed to the network card. The first argument is the MTU; the second is
/// what `tc` does with packets that wait for the wire, or empty.
const TWO_MACHINES: &str = r#"
mtu=$1 queue=$2; shift 2
ip link set lo up || exit 125
unshare -n sleep infinity & other=$!
trap 'kill $other' EXIT
until [ "$(readlink /proc/$other/ns/net)" != "$(readlink /proc/self/ns/net)" ]; do sleep 0.01; done
ip link add card mtu $mtu type veth peer name wire mtu $mtu && ip link set wire netns $other || exit 125
ip addr add 192.0.2.1/24 dev card && ip link set card up && ip route add 224.0.0.0/4 dev card || exit 125
nsenter -t $other -n bash -c 'ip link set lo up && ip addr add 192.0.2.2/24 dev wire && ip link set wire up && ip route add 224.0.0.0/4 dev wire' || exit 125
if [ -n "$queue" ]; then
  tc qdisc add dev card root $queue && nsenter -t $other -n tc qdisc add dev wire root $queue || exit 125
fi
export OTHER_MACHINE=$other THIS_MACHINE=$$
"$@"
"#;

/// A queue of 20 kB before a wire of 50 Mbit/s: what is sent faster is lost.
const SHORT_QUEUE: &str = "tbf rate 50mbit burst 10kb limit 20kb";

/// A command on a machine with another one on its network, whose cards take packets of `mtu` bytes:
/// `$OTHER_MACHINE` is a process there, for `nsenter -t $OTHER_MACHINE -n`.
///
/// # Panics
/// Where the system grants no such thing.
pub fn two_machines(mtu: u16) -> Command {
    machines(mtu, "")
}

fn machines(mtu: u16, queue: &str) -> Command {
    for flags in machine::NAMESPACE_FLAGS {
        let command = || {
            let mut command = Command::new("unshare");
            command.args(flags).args(["bash", "-c", TWO_MACHINES, "--", &mtu.to_string(), queue]);
            command
        };
        let probe = command().arg("true").stdout(Stdio::null()).stderr(Stdio::null()).status();
        if probe.is_ok_and(|status| status.success()) {
            return command();
        }
    }
    panic!("no two network namespaces");
}

/// Where the laboratory's programs run, and where the script runs that asks them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// Both on a machine that has a loopback with multicast and nothing else.
    Loopback,
    /// Both on one PC: it has a network card, and its loopback has no multicast. They keep to the
    /// machine.
    OnePc,
    /// As [`Place::OnePc`], but they look for others on the network.
    OnePcOnItsNetwork,
    /// The programs on one PC and the script on another, with packets of at most so many bytes
    /// between them.
    TwoPcs(u16),
    /// As [`Place::TwoPcs`] of [`ORDINARY_MTU`], and whoever sends too much at once loses some of
    /// it.
    CrowdedNetwork,
}

impl Place {
    /// Where a test is run: at `short`, and in the long tier everywhere.
    #[must_use]
    pub fn of_tier(short: Self) -> Vec<Self> {
        if std::env::var_os("FRICTION_FULL").is_none() {
            return vec![short];
        }
        vec![
            Self::TwoPcs(ORDINARY_MTU),
            Self::TwoPcs(JUMBO_MTU),
            Self::CrowdedNetwork,
            Self::Loopback,
            Self::OnePc,
            Self::OnePcOnItsNetwork,
        ]
    }

    /// A command there, for the script.
    ///
    /// # Panics
    /// Where the system grants no such place.
    pub fn command(self) -> Command {
        let mut command = match self {
            Self::Loopback => namespaced(),
            Self::OnePc | Self::OnePcOnItsNetwork => two_machines(ORDINARY_MTU),
            Self::TwoPcs(mtu) => two_machines(mtu),
            Self::CrowdedNetwork => machines(ORDINARY_MTU, SHORT_QUEUE),
        };
        if matches!(self, Self::TwoPcs(_) | Self::CrowdedNetwork) {
            // `processes.py` starts the programs where $PROGRAMS_MACHINE is.
            let there = r#"PROGRAMS_MACHINE=$THIS_MACHINE exec nsenter -t $OTHER_MACHINE -n "$@""#;
            command.args(["bash", "-c", there, "--"]);
        }
        let keep_to_it = matches!(self, Self::Loopback | Self::OnePc);
        command
            .env("ROS_AUTOMATIC_DISCOVERY_RANGE", if keep_to_it { "LOCALHOST" } else { "SUBNET" });
        command
    }
}

/// Runs a test of the running test program that is ignored elsewhere, by `command`, with variables
/// of the environment. Returns what it printed.
///
/// # Panics
/// When it fails; the message carries what it said.
pub fn run_ignored(
    mut command: Command,
    test: &str,
    variables: &[(&str, &std::ffi::OsStr)],
) -> String {
    let this = std::env::current_exe().expect("a running test knows its own file");
    let output = command
        .arg(this)
        .args(["--ignored", "--exact", test, "--nocapture"])
        .envs(variables.iter().copied())
        .output()
        .expect("it starts");
    let told = String::from_utf8_lossy(&output.stdout) + String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success() && told.contains("1 passed"), "{told}");
    told.into_owned()
}
