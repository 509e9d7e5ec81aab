//! What the rounds share: the device with its books, processes by number, and the counts.

use std::fmt;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{Duration, Instant};

use rand::RngExt;
use rand_pcg::Pcg64Mcg;
use serde_json::Value;
use tests::emulated_rig::EmulatedRig;

pub mod launch;
pub mod live;
pub mod serve;

/// Longest wait for what must come on a machine that is busy with other tests.
pub const PATIENCE: Duration = Duration::from_secs(60);
/// `safety.command_age` in cycles of the device: what a dead controller's last command is worth to
/// the driver.
const COMMAND_AGE: u64 = 20;
/// How often something is started that does not come to drive: on a machine that is busy with other
/// tests a driver gives up a line that is silent for .1 s.
pub const ATTEMPTS: u32 = 10;

/// The emulated rig that all processes of a test drive one after the other.
pub struct Device {
    rig: EmulatedRig,
    validity: u64,
}

impl Device {
    pub fn start() -> Self {
        let mut rig = EmulatedRig::start(&[]);
        let validity = rig.status()["validity_limit_cycles"].as_u64().expect("a number");
        Self { rig, validity }
    }

    pub fn name(&self) -> String {
        self.rig.name()
    }

    pub fn folder(&self) -> &Path {
        self.rig.folder()
    }

    /// A name in the device's folder that is not there yet.
    pub fn new_folder(&self, stem: &str) -> PathBuf {
        (0..)
            .map(|n| self.folder().join(format!("{stem}-{n}")))
            .find(|path| !path.exists())
            .expect("a name")
    }

    pub fn driven(&mut self) -> u64 {
        self.rig.book("driven")
    }

    /// Waits for the validity and one cycle: a driver that is gone moves nothing after that.
    pub fn pass_validity(&mut self) -> Value {
        self.rig.pass(self.validity + 1)
    }

    /// The same after a controller is gone: its last command has an age of its own in the driver.
    pub fn pass_age_and_validity(&mut self) -> Value {
        self.rig.pass(COMMAND_AGE + self.validity + 1)
    }

    /// Waits until the motor gets volts again, at most so long and while `alive`; whether it does.
    pub fn drives(&mut self, at_most: Duration, mut alive: impl FnMut() -> bool) -> bool {
        let before = self.driven();
        let until = Instant::now() + at_most;
        while self.driven() < before + 20 {
            if !alive() || Instant::now() > until {
                return false;
            }
            std::thread::sleep(Duration::from_millis(5));
        }
        true
    }

    /// The promise so far: no voltage without permission, none beyond the validity.
    pub fn assert_safe(&mut self, what: &str) {
        let status = self.rig.status();
        let books = &status["books"];
        assert_eq!(books["driven_without_permission"], 0, "{what}: {books}");
        for book in ["longest_drive_after_a_command", "longest_drive_after_a_measurement"] {
            assert!(
                books[book].as_u64().is_some_and(|cycles| cycles <= self.validity),
                "{what}: {books}"
            );
        }
    }

    pub fn finish(self) {
        self.rig.finish();
    }
}

/// What was done, for the report.
#[derive(Default)]
pub struct Counts {
    pub rounds: u32,
    pub kills: u32,
    pub stops: u32,
    pub continued: u32,
}

impl fmt::Display for Counts {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { rounds, kills, stops, continued } = self;
        write!(to, "{rounds} rounds, {kills} kills, {stops} stops, {continued} of them continued")
    }
}

/// Sends a signal, as `-KILL`. Whether the process was there.
pub fn signal(pid: u32, name: &str) -> bool {
    let kill = Command::new("kill").args([name, &pid.to_string()]).output().expect("kill starts");
    kill.status.success()
}

/// A moment of up to 60 ms.
pub fn moment(random: &mut Pcg64Mcg) {
    std::thread::sleep(Duration::from_micros(random.random_range(0..60_000)));
}

/// Parent and state of a process or thread, where it is.
fn stat(folder: &Path) -> Option<(u32, char)> {
    let text = std::fs::read_to_string(folder.join("stat")).ok()?;
    let mut rest = text.rsplit_once(')')?.1.split_whitespace();
    let state = rest.next()?.chars().next()?;
    Some((rest.next()?.parse().ok()?, state))
}

fn proc(pid: u32) -> PathBuf {
    Path::new("/proc").join(pid.to_string())
}

/// Sends a signal after which no thread of the process does anything, `-STOP` or `-KILL`, and waits
/// until that is so: on a busy machine it takes a while. Whether the process was there.
pub fn still(pid: u32, name: &str) -> bool {
    let there = signal(pid, name);
    let until = Instant::now() + PATIENCE;
    let acts = |thread: std::fs::DirEntry| {
        stat(&thread.path()).is_some_and(|(_, state)| !matches!(state, 'T' | 't' | 'Z' | 'X'))
    };
    while std::fs::read_dir(proc(pid).join("task")).is_ok_and(|threads| threads.flatten().any(acts))
    {
        assert!(Instant::now() < until, "{name} has no effect on {pid}");
        std::thread::sleep(Duration::from_micros(200));
    }
    there
}

/// Whether a process runs or could: a dead one that nobody has asked after is gone.
pub fn runs(pid: u32) -> bool {
    stat(&proc(pid)).is_some_and(|(_, state)| !matches!(state, 'Z' | 'X'))
}

/// Children of a process: number and program, or the node that it is, as in
/// `frictionlab node rig_driver`.
pub fn children(pid: u32) -> Vec<(u32, String)> {
    let entries = std::fs::read_dir("/proc").expect("processes");
    entries
        .filter_map(|entry| entry.ok()?.file_name().to_str()?.parse::<u32>().ok())
        .filter(|child| stat(&proc(*child)).is_some_and(|(parent, _)| parent == pid))
        .filter_map(|child| {
            let line = std::fs::read(proc(child).join("cmdline")).ok()?;
            let words: Vec<String> = line
                .split(|byte| *byte == 0)
                .map(|word| String::from_utf8_lossy(word).into_owned())
                .collect();
            if let [_, command, node, ..] = &words[..]
                && command == "node"
            {
                return Some((child, node.clone()));
            }
            let program = std::fs::read_link(proc(child).join("exe")).ok()?;
            Some((child, program.file_name()?.to_str()?.to_owned()))
        })
        .collect()
}

/// One process that drives by itself: killed, or stopped and then continued or killed.
pub fn round_of_one(
    pid: u32,
    what: &str,
    device: &mut Device,
    random: &mut Pcg64Mcg,
    counts: &mut Counts,
) {
    counts.rounds += 1;
    moment(random);
    if random.random::<bool>() {
        counts.stops += 1;
        assert!(still(pid, "-STOP"), "{what}: it ended by itself");
        let status = device.pass_validity();
        assert_eq!(status["voltage"], 0, "{what}: after SIGSTOP: {status}");
        device.assert_safe(what);
        if random.random::<bool>() {
            counts.continued += 1;
            moment(random);
            signal(pid, "-CONT");
            moment(random);
            device.assert_safe(what);
        }
    }
    counts.kills += 1;
    // It may have ended by itself after it was continued.
    still(pid, "-KILL");
    let status = device.pass_validity();
    assert_eq!(status["voltage"], 0, "{what}: after SIGKILL: {status}");
    device.assert_safe(what);
}
