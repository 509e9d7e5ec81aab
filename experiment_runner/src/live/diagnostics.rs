//! The loop's health as a ROS 2 message.

use std::sync::atomic::Ordering;

use msgs::{
    diagnostic_msgs::{DiagnosticArray, DiagnosticStatus, KeyValue},
    std_msgs::Header,
};
use ros_node::timing::Timing;

use super::Counters;

/// The loop's health over the last second, and its losses since the start.
pub(super) fn message(stamp_ns: u64, timing: &Timing, counters: &Counters, not_sent: u64) -> DiagnosticArray {
    let not_published = counters.not_published.load(Ordering::Relaxed) + not_sent;
    let not_recorded = counters.not_recorded.load(Ordering::Relaxed);
    let (level, text) = match (not_recorded, not_published, timing.overruns) {
        (0, 0, 0) => (DiagnosticStatus::OK, "in time".to_owned()),
        (0, 0, late) => (DiagnosticStatus::WARN, format!("{late} cycles were late")),
        (0, lost, _) => (DiagnosticStatus::WARN, format!("{lost} cycles were not published")),
        (lost, ..) => (DiagnosticStatus::ERROR, format!("{lost} cycles are missing in the bag")),
    };
    let value = |key: &str, value: String| KeyValue { key: key.to_owned(), value };
    let microseconds = |key: &str, number: f64| value(key, format!("{number:.1}"));
    DiagnosticArray {
        header: Header::at(stamp_ns),
        status: vec![DiagnosticStatus {
            level,
            name: "experiment_runner: control loop".to_owned(),
            message: text,
            hardware_id: "simulated".to_owned(),
            values: vec![
                value("cycles", timing.cycles.to_string()),
                microseconds("period p50 [us]", timing.period.p50),
                microseconds("period p99 [us]", timing.period.p99),
                microseconds("period p99.9 [us]", timing.period.p999),
                microseconds("period max [us]", timing.period.max),
                microseconds("execution p50 [us]", timing.execution.p50),
                microseconds("execution p99 [us]", timing.execution.p99),
                microseconds("execution p99.9 [us]", timing.execution.p999),
                microseconds("execution max [us]", timing.execution.max),
                value("overruns", timing.overruns.to_string()),
                value("not published", not_published.to_string()),
                value("not recorded", not_recorded.to_string()),
            ],
        }],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_worst_loss_is_the_one_told() {
        let counters = Counters::default();
        let level = |timing: &Timing, counters: &Counters, not_sent| {
            let status = message(1, timing, counters, not_sent).status.remove(0);
            (status.level, status.message)
        };
        assert_eq!(level(&Timing::default(), &counters, 0), (DiagnosticStatus::OK, "in time".into()));
        let late = Timing { overruns: 2, ..Timing::default() };
        assert_eq!(level(&late, &counters, 0).0, DiagnosticStatus::WARN);
        assert_eq!(level(&late, &counters, 4).1, "4 cycles were not published");
        counters.not_recorded.store(3, Ordering::Relaxed);
        assert_eq!(level(&late, &counters, 4).0, DiagnosticStatus::ERROR);
    }
}
