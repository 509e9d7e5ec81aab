//! The clocks: resolution, jumps of the system clock, who keeps it right, and what sets the
//! processor's pace.

use std::{
    fs,
    path::Path,
    sync::Arc,
    sync::atomic::{AtomicBool, Ordering},
    thread::{self, JoinHandle},
    time::Duration,
};

use rustix::time::{ClockId, Timespec, clock_getres, clock_gettime};

use super::Finding;

/// Time between two comparisons of the clocks.
const SAMPLING: Duration = Duration::from_millis(20);
/// Readings further apart than this are taken again \[ns\]: something came between.
const BRACKET: i128 = 50_000;
/// Jump of the system clock that stamps suffer from \[ns\].
const JUMP: i128 = 1_000_000;
/// Rate at which the system clock is being corrected that is worth a look [us/s].
const DRIFT: f64 = 500.0;
/// Resolution of the monotonic clock that a loop of 1 kHz needs \[ns\].
const RESOLUTION: i128 = 100_000;

/// Compares the clocks until it is asked what it saw.
pub(super) struct ClockWatch {
    over: Arc<AtomicBool>,
    thread: Option<JoinHandle<Seen>>,
}

/// What was seen of the system clock against the monotonic one.
#[derive(Debug, Clone, Copy, Default)]
struct Seen {
    /// Time on the monotonic clock from the first to the last comparison \[ns\].
    length: i128,
    /// What the system clock went ahead in that time \[ns\].
    ahead: i128,
    /// The largest step between two comparisons \[ns\].
    step: i128,
    comparisons: u32,
}

impl ClockWatch {
    pub(super) fn start() -> Self {
        let over = Arc::new(AtomicBool::new(false));
        let ends = Arc::clone(&over);
        let watch = move || watch(|| ends.load(Ordering::Relaxed));
        let thread = thread::Builder::new().name("clocks".into()).spawn(watch).ok();
        Self { over, thread }
    }

    /// All findings about clocks. `several_machines`: stamps of different clocks will meet.
    pub(super) fn findings(mut self, several_machines: bool) -> Vec<Finding> {
        self.over.store(true, Ordering::Relaxed);
        let seen = self.thread.take().and_then(|thread| thread.join().ok()).unwrap_or_default();
        vec![
            resolution(),
            jumps(&seen),
            synchronisation(Path::new("/"), several_machines),
            governor(Path::new("/")),
        ]
    }
}

impl Drop for ClockWatch {
    fn drop(&mut self) {
        self.over.store(true, Ordering::Relaxed);
    }
}

fn nanoseconds(time: Timespec) -> i128 {
    i128::from(time.tv_sec) * 1_000_000_000 + i128::from(time.tv_nsec)
}

/// The monotonic clock and how far the system clock is ahead of it \[ns\], read within [`BRACKET`]
/// if that can be had.
fn compare() -> (i128, i128) {
    let mut best = (i128::MAX, 0, 0);
    for _ in 0..10 {
        let before = nanoseconds(clock_gettime(ClockId::Monotonic));
        let system = nanoseconds(clock_gettime(ClockId::Realtime));
        let after = nanoseconds(clock_gettime(ClockId::Monotonic));
        if after - before < best.0 {
            let middle = before + (after - before) / 2;
            best = (after - before, middle, system - middle);
        }
        if best.0 < BRACKET {
            break;
        }
    }
    (best.1, best.2)
}

fn watch(over: impl Fn() -> bool) -> Seen {
    let (first, offset) = compare();
    let mut seen = Seen::default();
    let mut last = offset;
    while !over() {
        thread::sleep(SAMPLING);
        let (now, offset_now) = compare();
        let step = offset_now - last;
        if step.abs() > seen.step.abs() {
            seen.step = step;
        }
        last = offset_now;
        seen.length = now - first;
        seen.ahead = offset_now - offset;
        seen.comparisons += 1;
    }
    seen
}

fn resolution() -> Finding {
    let nanoseconds = nanoseconds(clock_getres(ClockId::Monotonic));
    let source =
        fs::read_to_string("/sys/devices/system/clocksource/clocksource0/current_clocksource");
    let source = source.map_or_else(|_| String::new(), |name| format!(", kept by {}", name.trim()));
    let finding = if nanoseconds <= RESOLUTION {
        Finding::fine("monotonic clock", format!("fine enough for a loop of 1 kHz{source}"))
    } else {
        Finding::broken(
            "monotonic clock",
            format!("too coarse for a loop of 1 kHz{source}"),
            "use a kernel with high-resolution timers (CONFIG_HIGH_RES_TIMERS), started without `highres=off`",
        )
    };
    finding.with("resolution", nanoseconds as f64, "ns")
}

fn jumps(seen: &Seen) -> Finding {
    let subject = "system clock";
    if seen.comparisons == 0 {
        return Finding::look(
            subject,
            "it was not compared with the monotonic clock: the system refused a thread",
            "try again",
        );
    }
    let drift = seen.ahead as f64 / (seen.length.max(1) as f64 * 1e-6);
    let finding = if seen.step.abs() > JUMP {
        Finding::look(
            subject,
            "it jumped while this program looked; stamps before and after do not belong together",
            "let chrony or systemd-timesyncd finish (`timedatectl`), and let only one program set the clock",
        )
    } else if drift.abs() > DRIFT {
        Finding::look(
            subject,
            "it is being corrected fast; periods computed from stamps are wrong by as much",
            "wait until the clock is synchronised (`timedatectl`, `chronyc tracking`)",
        )
    } else {
        Finding::fine(subject, "it goes with the monotonic clock, without jumps")
    };
    finding
        .with("watched for", seen.length as f64 * 1e-9, "s")
        .with("largest step", seen.step as f64 * 1e-3, "us")
        .with("drift against the monotonic clock", drift, "us/s")
}

/// Who keeps the clock right, from what the usual programs leave in the file system.
fn synchronisation(root: &Path, several_machines: bool) -> Finding {
    let subject = "synchronisation";
    let keeper = [
        ("run/systemd/timesync/synchronized", "systemd-timesyncd"),
        ("run/chrony/chronyd.pid", "chrony"),
        ("run/ntpd.pid", "ntpd"),
        ("run/ptp4l", "ptp4l"),
    ]
    .into_iter()
    .find(|(file, _)| root.join(file).exists());
    match (keeper, several_machines) {
        (Some((_, name)), _) => Finding::fine(subject, format!("{name} keeps the system clock")),
        (None, false) => Finding::fine(
            subject,
            "no program that keeps the system clock right was found; on one machine all stamps have one clock",
        ),
        (None, true) => Finding::look(
            subject,
            "no program that keeps the system clock right was found, and nodes of other machines may take part",
            "run chrony on all machines: a voltage counts for 20 ms after its stamp, so their clocks must agree better than that",
        ),
    }
}

/// What sets the processor's pace.
fn governor(root: &Path) -> Finding {
    let subject = "processor frequency";
    let mut found: Vec<String> = Vec::new();
    for entry in fs::read_dir(root.join("sys/devices/system/cpu")).into_iter().flatten().flatten() {
        if let Ok(name) = fs::read_to_string(entry.path().join("cpufreq/scaling_governor")) {
            found.push(name.trim().to_owned());
        }
    }
    let cores = found.len() as f64;
    found.sort();
    found.dedup();
    if found.is_empty() {
        return Finding::fine(
            subject,
            "this system does not say what sets it, as is usual for virtual machines",
        );
    }
    let names = found.join(", ");
    let finding = if found == ["performance"] {
        Finding::fine(subject, "governor performance")
    } else {
        Finding::look(
            subject,
            format!("governor {names}: a core that slept wakes slowly, and the loop waits for it"),
            "`sudo cpupower frequency-set -g performance` while rigs run",
        )
    };
    finding.with("cores", cores, "")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::doctor::Verdict;

    #[test]
    fn a_jump_and_a_fast_correction_are_told_apart() {
        let quiet = Seen { length: 2_000_000_000, ahead: 40_000, step: 3_000, comparisons: 100 };
        assert_eq!(jumps(&quiet).verdict, Verdict::Fine);
        let jumped = Seen { step: -20_000_000, ..quiet };
        assert!(jumps(&jumped).found.contains("jumped"));
        let corrected = Seen { ahead: 2_000_000, ..quiet };
        assert!(jumps(&corrected).found.contains("corrected"));
        assert_eq!(jumps(&corrected).figures[2].value, 1000.0);
        assert_eq!(jumps(&Seen::default()).verdict, Verdict::LookAtThis);
    }

    #[test]
    fn the_governor_is_read_off_every_core() {
        let root = tempfile::tempdir().expect("a folder");
        assert_eq!(governor(root.path()).verdict, Verdict::Fine);
        for (core, name) in [("cpu0", "performance\n"), ("cpu1", "powersave\n")] {
            let folder = root.path().join("sys/devices/system/cpu").join(core).join("cpufreq");
            fs::create_dir_all(&folder).expect("a folder");
            fs::write(folder.join("scaling_governor"), name).expect("a file");
        }
        let finding = governor(root.path());
        assert_eq!((finding.verdict, finding.figures[0].value), (Verdict::LookAtThis, 2.0));
        assert!(finding.found.contains("performance, powersave"), "{}", finding.found);
    }

    #[test]
    fn without_synchronisation_several_machines_are_worth_a_look() {
        let root = tempfile::tempdir().expect("a folder");
        assert_eq!(synchronisation(root.path(), true).verdict, Verdict::LookAtThis);
        assert_eq!(synchronisation(root.path(), false).verdict, Verdict::Fine);
        fs::create_dir_all(root.path().join("run/chrony")).expect("a folder");
        fs::write(root.path().join("run/chrony/chronyd.pid"), "1").expect("a file");
        assert!(synchronisation(root.path(), true).found.contains("chrony"));
    }

    #[test]
    fn the_clocks_of_this_machine_are_compared() {
        let watch = ClockWatch::start();
        thread::sleep(Duration::from_millis(100));
        let findings = watch.findings(false);
        let jumps =
            findings.iter().find(|finding| finding.subject == "system clock").expect("a finding");
        assert!(jumps.figures[0].value > 0.0, "{jumps:?}");
        let resolution = &findings[0].figures[0];
        assert!(resolution.value >= 1.0 && resolution.unit == "ns", "{resolution:?}");
    }
}
