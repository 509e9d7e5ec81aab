//! What `/diagnostics` shows of the axis.

use std::sync::{Arc, atomic::Ordering};

use msgs::{
    diagnostic_msgs::{DiagnosticArray, DiagnosticStatus, KeyValue},
    std_msgs::Header,
};
use ros_node::{NodeClock, SUBSCRIBERS_THAT_LAG, lifecycle::Phase};

use super::{super::parameters::RigSettings, Axis};
use crate::node::locked::locked;
use crate::station::Presence;

impl Axis {
    /// The limits in force, those of the rig that is open and not those that are set; and which of
    /// them wait for the next configuration.
    fn limits_in_force(&self, wanted: Option<&RigSettings>) -> Vec<KeyValue> {
        let value = |key: &str, value: String| KeyValue { key: key.to_owned(), value };
        let in_force = locked(&self.in_force);
        let Some((settings, limits)) =
            in_force.as_ref().filter(|_| self.station.presence() == Presence::Running)
        else {
            return vec![value("limits in force", "none: no rig is open".to_owned())];
        };
        let waiting = wanted.map(|wanted| settings.differing(wanted)).unwrap_or_default();
        let waiting = if waiting.is_empty() { "nothing".to_owned() } else { waiting.join(", ") };
        let travel = limits.travel.map_or("not limited".to_owned(), |travel| {
            format!("{} to {}, margin {}", travel.min, travel.max, travel.margin)
        });
        let cycle_lost = if limits.cycle_lost < f64::MAX {
            limits.cycle_lost.to_string()
        } else {
            "never".to_owned()
        };
        vec![
            value("rig in force", settings.name.clone()),
            value("voltage limit in force [V]", limits.voltage.to_string()),
            value("safety.slew in force [V/s]", limits.slew.to_string()),
            value("safety.velocity in force [rad/s]", limits.velocity.to_string()),
            value("safety.travel in force [rad]", travel),
            value("safety.command_age in force [s]", limits.command_age.to_string()),
            value("safety.command_lost in force [s]", limits.command_lost.to_string()),
            value("safety.cycle_late in force [s]", limits.cycle_late.to_string()),
            value("safety.cycle_lost in force [s]", cycle_lost),
            value("waits for configure", waiting),
        ]
    }

    /// Diagnostics; `wanted` is what the parameters say, `lagging` how many subscribers do not keep
    /// up.
    pub(in super::super) fn diagnostics(
        &self,
        clock: &NodeClock,
        phase: Phase,
        wanted: Option<&RigSettings>,
        lagging: u64,
    ) -> DiagnosticArray {
        let counters = Arc::clone(&locked(&self.counters));
        let (_, not_published) = self.published();
        let overruns = counters.overruns.load(Ordering::Relaxed);
        let stale = counters.stale.load(Ordering::Relaxed);
        let (timing, ages, state, fault, rise) = {
            let mut seen = locked(&self.seen);
            let told = (
                seen.stopwatch.timing(overruns),
                seen.ages.timing(0),
                seen.state,
                seen.fault,
                seen.rise,
            );
            seen.stopwatch.clear();
            seen.ages.clear();
            told
        };
        let stop = self.station.latch.is_set();
        let (level, message) = match (fault, not_published + overruns) {
            _ if stop => (
                DiagnosticStatus::ERROR,
                "the emergency stop is set; clear_fault, configure and activate to go on"
                    .to_owned(),
            ),
            (Some(report), _) => (DiagnosticStatus::ERROR, report.to_string()),
            (None, 0) => (DiagnosticStatus::OK, format!("{state}, in time")),
            (None, _) => (
                DiagnosticStatus::WARN,
                format!("{state}; {overruns} cycles were late, {not_published} not published"),
            ),
        };
        let value = |key: &str, value: String| KeyValue { key: key.to_owned(), value };
        let microseconds = |key: &str, number: f64| value(key, format!("{number:.1}"));
        let mut values = vec![
            value("node", phase.label().to_owned()),
            value("state", state.to_string()),
            value("emergency stop", if stop { "set" } else { "not set" }.to_owned()),
            value("cycles", timing.cycles.to_string()),
            microseconds("period p50 [us]", timing.period.p50),
            microseconds("period p99 [us]", timing.period.p99),
            microseconds("execution p99 [us]", timing.execution.p99),
            microseconds("command age p50 [us]", ages.period.p50),
            microseconds("command age p99 [us]", ages.period.p99),
            value("overruns", overruns.to_string()),
            value("stale commands", stale.to_string()),
            value("not published", not_published.to_string()),
            value(SUBSCRIBERS_THAT_LAG, lagging.to_string()),
        ];
        if let Some(rise) = rise {
            values.push(value("winding above ambient [K]", format!("{rise:.1}")));
        }
        values.extend(self.limits_in_force(wanted));
        DiagnosticArray {
            header: Header::at(clock.now_ns()),
            status: vec![DiagnosticStatus {
                level,
                name: format!("{}: control loop", self.name),
                message,
                hardware_id: "rig".to_owned(),
                values,
            }],
        }
    }
}
