//! May the control loop have the processor when it wants it, and how late is it here?

use std::{fs, thread};

use ros_node::{
    deadlines::{self, Deadlines, PRIORITY, RealtimeRefused},
    timing::{Percentiles, Stopwatch},
};
use rustix::process::{Resource, getrlimit};

use super::Finding;

/// Period of the bare loop \[ns\].
const PERIOD: u64 = 1_000_000;
/// Its cycles: two seconds.
const CYCLES: u64 = 2000;
/// Lateness of the 99th percentile beyond which the loop suffers \[us\]: half a period.
const LATE: f64 = 500.0;
/// Lateness beyond which voltages no longer count, by the driver's default of `safety.command_age`
/// \[us\].
const HOPELESS: f64 = 20_000.0;

/// All of it. Takes two seconds.
pub(super) fn check() -> Vec<Finding> {
    // On a thread of its own, so that nothing else here gets that priority.
    let measured = thread::spawn(|| {
        let granted = deadlines::realtime();
        (granted, bare_loop())
    })
    .join();
    let mut findings = match measured {
        Ok((granted, lateness)) => {
            let real_time = granted.is_ok();
            vec![priority(granted), loop_lateness(&lateness, real_time)]
        }
        Err(_) => vec![Finding::broken(
            "bare loop at 1 kHz",
            "the measuring thread broke off",
            "try again; if it stays, the system refuses threads (`ulimit -u`)",
        )],
    };
    findings.extend([memory_lock(), load()]);
    findings
}

fn priority(granted: Result<(), RealtimeRefused>) -> Finding {
    let limit = getrlimit(Resource::Rtprio).current;
    let finding = match granted {
        Ok(()) => Finding::fine("real-time priority", "SCHED_FIFO is granted to the control loop"),
        Err(error) => Finding::look(
            "real-time priority",
            format!(
                "SCHED_FIFO is refused ({error}); the loop runs, but is late when the machine is busy"
            ),
            format!(
                "as root, write `YOUR_USER - rtprio {PRIORITY}` into /etc/security/limits.d/rt.conf and log in again; in a container, start it with \
                 --cap-add=SYS_NICE --ulimit rtprio={PRIORITY}"
            ),
        ),
    };
    let finding = finding.with("priority asked for", f64::from(PRIORITY), "");
    match limit {
        Some(limit) => finding.with("limit of this user (rtprio)", limit as f64, ""),
        None => finding,
    }
}

/// How late the cycles of a loop begin that does nothing.
fn bare_loop() -> Percentiles {
    let mut stopwatch = Stopwatch::new();
    let first = deadlines::now_ns() + PERIOD;
    for cycle in 0..CYCLES {
        let deadline = first + cycle * PERIOD;
        let (now, _) = Deadlines::new(deadline, PERIOD).wait();
        // Zero would not be counted.
        stopwatch.note(now.saturating_sub(deadline).max(1), 0);
    }
    stopwatch.timing(0).period
}

fn loop_lateness(late: &Percentiles, real_time: bool) -> Finding {
    let class = if real_time { "SCHED_FIFO" } else { "ordinary priority" };
    let subject = "bare loop at 1 kHz";
    let mend = if real_time {
        "end other programs; give the loop a core of its own (kernel option `isolcpus`), or use a kernel with PREEMPT_RT; virtual machines share their cores with others"
    } else {
        "allow real-time priority, see above; end other programs"
    };
    let finding = if late.p99 > HOPELESS {
        Finding::broken(
            subject,
            format!("with {class}, one cycle in a hundred begins after voltages have expired"),
            mend,
        )
    } else if late.p99 > LATE {
        Finding::look(
            subject,
            format!("with {class}, one cycle in a hundred begins more than half a period late"),
            mend,
        )
    } else {
        Finding::fine(subject, format!("with {class}, cycles begin in time"))
    };
    finding
        .with("lateness p50", late.p50, "us")
        .with("lateness p99", late.p99, "us")
        .with("latest", late.max, "us")
}

/// Nothing here locks memory, so no limit of it is a fault.
fn memory_lock() -> Finding {
    let subject = "memory locking limit";
    match getrlimit(Resource::Memlock).current {
        None => Finding::fine(subject, "unlimited"),
        Some(bytes) => Finding::fine(
            subject,
            "limited; the nodes do not lock memory, so it matters only while the system swaps",
        )
        .with("limit (memlock)", bytes as f64 / 1024.0, "KiB"),
    }
}

fn load() -> Finding {
    let cores = thread::available_parallelism().map_or(1, |cores| cores.get()) as f64;
    let load = fs::read_to_string("/proc/loadavg").ok().and_then(|text| {
        text.split_whitespace().next().and_then(|first| first.parse::<f64>().ok())
    });
    match load {
        None => Finding::fine("load", "this system does not tell it").with("cores", cores, ""),
        Some(load) => {
            let finding = if load > cores {
                Finding::look(
                    "load",
                    "more programs want to run than there are cores; without real-time priority the loop waits for them",
                    "end what is not needed while a rig runs",
                )
            } else {
                Finding::fine("load", "there are cores to spare")
            };
            finding.with("cores", cores, "").with("load over the last minute", load, "")
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::doctor::Verdict;

    #[test]
    fn half_a_period_is_late_and_the_age_limit_of_voltages_is_broken() {
        let of =
            |p99| loop_lateness(&Percentiles { p50: 50.0, p99, p999: p99, max: p99 }, true).verdict;
        assert_eq!(
            [of(499.0), of(501.0), of(20_001.0)],
            [Verdict::Fine, Verdict::LookAtThis, Verdict::Broken]
        );
    }

    #[test]
    fn a_refused_priority_says_how_to_get_it() {
        let finding = priority(Err(RealtimeRefused("EPERM".to_owned())));
        assert_eq!(finding.verdict, Verdict::LookAtThis);
        assert!(finding.mend.is_some_and(|mend| mend.contains("rtprio 50")));
    }
}
