//! What a jog did, in a few lines.

use std::collections::VecDeque;
use std::fmt::Write;

use rig_driver::Measurement;

/// Time over which the encoder's speed is taken \[s\]: one count of 4096 a turn is 0.03 rad/s over
/// it.
const WINDOW: f64 = 0.05;
/// Counts by which a shaft gives that friction holds, elastically; `rig check` takes half of its
/// eight for that too.
const STANDS: i64 = 4;

/// What was seen while the shaft was to move.
#[derive(Debug, Clone, Default)]
pub struct JogSummary {
    first: Option<Measurement>,
    last: Option<Measurement>,
    volts: Option<(f64, f64)>,
    farthest: i64,
    recent: VecDeque<(f64, f64)>,
    peak_encoder: f64,
    peak_tachometer: f64,
    tachometer_sum: f64,
    cycles: u32,
    cut: bool,
}

impl JogSummary {
    /// Takes a cycle in.
    pub fn add(&mut self, seen: &Measurement) {
        let first = *self.first.get_or_insert(*seen);
        let volts = seen.voltage_applied;
        // The first measurement shows the voltage from before.
        if seen.cycle > first.cycle {
            let (least, most) = self.volts.unwrap_or((volts, volts));
            self.volts = Some((least.min(volts), most.max(volts)));
        }
        let counts = seen.encoder_counts - first.encoder_counts;
        if counts.abs() > self.farthest.abs() {
            self.farthest = counts;
        }
        self.recent.push_back((seen.time, seen.encoder_position));
        while self.recent.front().is_some_and(|(time, _)| seen.time - time > WINDOW) {
            self.recent.pop_front();
        }
        if let Some(&(time, position)) = self.recent.front()
            && seen.time - time > 0.8 * WINDOW
        {
            let speed = (seen.encoder_position - position) / (seen.time - time);
            if speed.abs() > self.peak_encoder.abs() {
                self.peak_encoder = speed;
            }
        }
        if seen.tachometer_velocity.abs() > self.peak_tachometer.abs() {
            self.peak_tachometer = seen.tachometer_velocity;
        }
        self.tachometer_sum += seen.tachometer_velocity;
        self.cycles += 1;
        self.cut |= seen.saturated;
        self.last = Some(*seen);
    }

    /// Whether the encoder says that the shaft moved.
    #[must_use]
    pub const fn moved(&self) -> bool {
        self.farthest.abs() > STANDS
    }

    /// The summary, in lines.
    #[must_use]
    pub fn text(&self) -> String {
        let (Some(first), Some(last), Some((least, most))) = (self.first, self.last, self.volts)
        else {
            return "the jog was over before the motor had a voltage\n".to_owned();
        };
        let seconds = last.time - first.time;
        let mut text = String::new();
        let volts = if most - least < 0.005 || least >= 0.0 || most <= 0.0 {
            format!("{:+.2} V", if most.abs() > least.abs() { most } else { least })
        } else {
            format!("{least:+.2} to {most:+.2} V")
        };
        let cut = if self.cut { ", cut at the limit" } else { "" };
        // Writing to a string cannot fail.
        let _ = writeln!(text, "applied        {volts} for {seconds:.2} s{cut}");
        let mean = self.tachometer_sum / f64::from(self.cycles.max(1));
        if self.moved() {
            let counts = last.encoder_counts - first.encoder_counts;
            let travel = last.encoder_position - first.encoder_position;
            let _ = writeln!(
                text,
                "travel         {travel:+.3} rad ({counts:+} counts) by the encoder"
            );
            let _ = writeln!(
                text,
                "peak velocity  {:+.3} rad/s by the encoder, {:+.3} rad/s by the tachometer",
                self.peak_encoder, self.peak_tachometer
            );
        } else {
            let _ = writeln!(
                text,
                "travel         none: the encoder stayed within {STANDS} counts. Friction holds the shaft below a voltage that `frictionlab rig check` finds; if more does not \
                 move it either, look at the amplifier's enable and supply, the motor's leads and the encoder's plug"
            );
            let _ = writeln!(
                text,
                "tachometer     mean {mean:+.3} rad/s, at most {:+.3} rad/s",
                self.peak_tachometer
            );
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn jog(volts: f64, speed: f64) -> JogSummary {
        let mut summary = JogSummary::default();
        for cycle in 0..=1000u16 {
            let time = f64::from(cycle) * 1e-3;
            let counts = (speed * time * 4096.0 / std::f64::consts::TAU) as i64;
            summary.add(&Measurement {
                cycle: cycle.into(),
                time,
                encoder_counts: counts,
                encoder_position: counts as f64 * std::f64::consts::TAU / 4096.0,
                tachometer_velocity: speed,
                voltage_applied: if cycle == 0 { 0.0 } else { volts },
                ..Default::default()
            });
        }
        summary
    }

    #[test]
    fn it_says_what_was_applied_how_far_and_how_fast() {
        let text = jog(-0.8, -0.5).text();
        assert!(text.contains("-0.80 V for 1.00 s") && text.contains("(-325 counts)"), "{text}");
        assert!(text.contains("-0.500 rad/s by the tachometer"), "{text}");
    }

    #[test]
    fn it_says_that_nothing_moved_where_nothing_did() {
        let still = jog(0.3, 0.0);
        assert!(
            !still.moved() && still.text().contains("none: the encoder stayed"),
            "{}",
            still.text()
        );
        assert!(JogSummary::default().text().contains("before"));
    }
}
