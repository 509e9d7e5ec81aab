//! The loop's health as a ROS 2 message.

use msgs::{
    diagnostic_msgs::{DiagnosticArray, DiagnosticStatus, KeyValue},
    std_msgs::Header,
};
use ros_node::timing::Timing;

/// The loop's health over the last second, and its losses since the start.
pub(super) fn message(
    stamp_ns: u64,
    timing: &Timing,
    not_recorded: u64,
    not_published: u64,
) -> DiagnosticArray {
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
            hardware_id: String::new(),
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
        let level = |timing: &Timing, not_recorded, not_published| {
            let status = message(1, timing, not_recorded, not_published).status.remove(0);
            (status.level, status.message)
        };
        assert_eq!(level(&Timing::default(), 0, 0), (DiagnosticStatus::OK, "in time".into()));
        let late = Timing { overruns: 2, ..Timing::default() };
        assert_eq!(level(&late, 0, 0).0, DiagnosticStatus::WARN);
        assert_eq!(level(&late, 0, 4).1, "4 cycles were not published");
        assert_eq!(level(&late, 3, 4).0, DiagnosticStatus::ERROR);
    }
}
