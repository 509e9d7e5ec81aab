//! How regular a running loop is, and how old the measurement behind each applied voltage, from
//! what its rig driver reports.

use friction_ident::statistics::upper_median;
use msgs::diagnostic_msgs::DiagnosticStatus;

use super::{
    Finding,
    heard::{Heard, node_of},
    participants::value,
};

/// Age of a command at the 99th percentile that is worth a look \[us\]: a quarter of what counts by
/// default.
const OLD: f64 = 5000.0;
/// Error of the period at the 99th percentile that is worth a look \[us\], for a period of 1 ms.
const IRREGULAR: f64 = 500.0;

/// Findings about every control loop that reports.
pub(super) fn check(heard: &Heard) -> Vec<Finding> {
    let loops: Vec<Finding> = heard
        .health
        .iter()
        .filter(|(_, reports)| {
            reports.iter().any(|report| value(report, "period p50 [us]").is_some())
        })
        .map(|(component, reports)| timing(&format!("/{}", node_of(component)), reports))
        .collect();
    if loops.is_empty() {
        vec![Finding::fine(
            "control loop",
            "no rig driver runs, so there is nothing to measure; `frictionlab launch` starts one with all nodes, then run this again beside it",
        )]
    } else {
        loops
    }
}

/// The values of one key in all reports that have it, those that are zero left out: nothing was
/// measured in that second.
fn values(reports: &[DiagnosticStatus], key: &str) -> Vec<f64> {
    let mut found: Vec<f64> = reports
        .iter()
        .filter_map(|report| value(report, key)?.parse().ok())
        .filter(|number: &f64| *number > 0.0)
        .collect();
    found.sort_by(f64::total_cmp);
    found
}

/// The middle second's value for medians, the worst second's for everything rarer.
fn figures(reports: &[DiagnosticStatus], quantity: &str) -> Option<(f64, f64)> {
    let mut medians = values(reports, &format!("{quantity} p50 [us]"));
    let tails = values(reports, &format!("{quantity} p99 [us]"));
    Some((upper_median(&mut medians)?, *tails.last()?))
}

fn timing(node: &str, reports: &[DiagnosticStatus]) -> Finding {
    let (period, age) = (figures(reports, "period"), figures(reports, "command age"));
    let Some((period_p50, period_p99)) = period else {
        return Finding::look(
            node,
            "it reports no cycles: the rig is not configured, or stands still",
            format!("`ros2 lifecycle set {node} configure`, then `activate`"),
        );
    };
    let finding = match age {
        Some((_, p99)) if p99 > OLD => Finding::look(
            node,
            "some voltages answer measurements that are old when they are applied; beyond safety.command_age (20 ms) they do not count",
            "end other programs, allow real-time priority (see scheduling), or close the loop in one process: `frictionlab live`",
        ),
        _ if period_p99 - period_p50 > IRREGULAR => Finding::look(
            node,
            "its period is irregular",
            "end other programs and allow real-time priority (see scheduling)",
        ),
        Some(_) => Finding::fine(node, "its loop is closed over DDS and in time"),
        None => Finding::fine(node, "its loop is in time; no voltage came over /motor_voltage"),
    };
    let finding = match age {
        Some((p50, p99)) => {
            finding.with("command age p50", p50, "us").with("command age p99", p99, "us")
        }
        None => finding,
    };
    let last =
        |key: &str| reports.last().and_then(|report| value(report, key)?.parse::<f64>().ok());
    let counts = [("overruns", last("overruns")), ("stale commands", last("stale commands"))];
    let finding = finding
        .with("period p50", period_p50, "us")
        .with("period p99", period_p99, "us")
        .with("reports heard", reports.len() as f64, "");
    counts.into_iter().fold(finding, |finding, (name, count)| match count {
        Some(count) => finding.with(format!("{name} since its start"), count, ""),
        None => finding,
    })
}

#[cfg(test)]
mod tests {
    use msgs::diagnostic_msgs::KeyValue;

    use super::*;
    use crate::doctor::Verdict;

    fn report(values: &[(&str, f64)]) -> DiagnosticStatus {
        DiagnosticStatus {
            name: "axis_1/rig_driver: control loop".into(),
            values: values
                .iter()
                .map(|(key, value)| KeyValue { key: (*key).into(), value: format!("{value:.1}") })
                .collect(),
            ..DiagnosticStatus::default()
        }
    }

    #[test]
    fn the_age_is_the_middle_of_the_medians_and_the_worst_of_the_tails() {
        let second = |p50: f64, p99: f64| {
            report(&[
                ("period p50 [us]", 1000.0),
                ("period p99 [us]", 1100.0),
                ("command age p50 [us]", p50),
                ("command age p99 [us]", p99),
                ("overruns", 3.0),
            ])
        };
        let reports =
            [second(0.0, 0.0), second(900.0, 2000.0), second(950.0, 1900.0), second(800.0, 1800.0)];
        let mut heard = Heard::default();
        heard.health.insert(reports[0].name.clone(), reports.to_vec());
        let finding = check(&heard).remove(0);
        let of = |name: &str| {
            finding.figures.iter().find(|figure| figure.name == name).map(|figure| figure.value)
        };
        assert_eq!((of("command age p50"), of("command age p99")), (Some(900.0), Some(2000.0)));
        assert_eq!(of("overruns since its start"), Some(3.0));
        assert_eq!(
            (finding.subject.as_str(), finding.verdict),
            ("/axis_1/rig_driver", Verdict::Fine)
        );
        assert_eq!(timing("/n", &[second(900.0, 6000.0)]).verdict, Verdict::LookAtThis);
    }

    #[test]
    fn without_a_loop_it_says_how_to_start_one() {
        assert!(check(&Heard::default())[0].found.contains("frictionlab launch"));
        let idle = report(&[("period p50 [us]", 0.0)]);
        assert_eq!(timing("/rig_driver", &[idle]).verdict, Verdict::LookAtThis);
    }
}
