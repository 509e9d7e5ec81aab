//! A servo's log, brought to an even grid.

use crate::IdentError;

/// Period of the grid and of the simulation \[s\].
pub const TIME_STEP: f64 = 0.005;

/// A first time stamp up to here counts as it is: the recorder began to count when the motion began.
/// Later ones, and those below zero, are those of a clock that counts from elsewhere \[s\].
const LATEST_START: f64 = 0.1;

/// A log as it was recorded: a pendulum on a position-controlled servo. The channels have one
/// length.
#[derive(Debug, Clone, PartialEq)]
pub struct RawServoLog {
    /// Mass of the pendulum \[kg\].
    pub mass: f64,
    /// From the axis to the mass \[m\].
    pub length: f64,
    /// Position gain in the servo's own units.
    pub gain: f64,
    /// Supply voltage \[V\].
    pub supply: f64,
    /// Mass of the arm, a thin rod from the axis to the mass \[kg\]; zero where it has none.
    pub arm_mass: f64,
    /// Command that the position loop takes off per speed, in units of the servo's command: duty
    /// cycle or ampere, times \[s/rad\]; zero where it takes none.
    pub damping: f64,
    /// Time of each sample \[s\], increasing.
    pub time: Vec<f64>,
    /// Measured position \[rad\].
    pub position: Vec<f64>,
    /// Measured speed \[rad/s\].
    pub speed: Vec<f64>,
    /// Position asked for \[rad\].
    pub goal: Vec<f64>,
    /// Whether the motor was driven.
    pub enabled: Vec<bool>,
}

/// A log on the grid t = 0, [`TIME_STEP`], ... below the last time stamp. Time stamps that count from
/// elsewhere, as those of a clock do, are counted from the first one.
///
/// Every channel is interpolated linearly; before the first sample the first two are extrapolated.
/// The motor counts as driven where the interpolated flag exceeds one half.
#[derive(Debug, Clone, PartialEq)]
pub struct ServoLog {
    pub(super) mass: f64,
    pub(super) length: f64,
    pub(super) gain: f64,
    pub(super) supply: f64,
    pub(super) arm_mass: f64,
    pub(super) damping: f64,
    pub(super) position: Vec<f64>,
    pub(super) first_speed: f64,
    pub(super) goal: Vec<f64>,
    pub(super) enabled: Vec<bool>,
}

impl ServoLog {
    /// Checks a log and brings it to the grid.
    ///
    /// # Errors
    /// [`IdentError`] for channels that differ in length, are not finite or too short, for time
    /// that does not increase, and for a header that no servo can have.
    pub fn new(raw: &RawServoLog) -> Result<Self, IdentError> {
        for (what, value) in [
            ("mass", raw.mass),
            ("length", raw.length),
            ("position gain", raw.gain),
            ("supply voltage", raw.supply),
        ] {
            if !(value > 0.0 && crate::finite::usable(value)) {
                return Err(IdentError::ServoHeader { what, value });
            }
        }
        for (what, value) in [
            ("arm mass (0 without an arm)", raw.arm_mass),
            ("damping (0 without one)", raw.damping),
        ] {
            if !(value >= 0.0 && crate::finite::usable(value)) {
                return Err(IdentError::ServoHeader { what, value });
            }
        }
        let n = raw.time.len();
        if n < 3 {
            return Err(IdentError::TooFewSamples {
                what: "a servo log",
                needed: 3,
                found: n,
                lower: None,
            });
        }
        let channels: [(&'static str, &[f64]); 4] = [
            ("the time", &raw.time),
            ("the position", &raw.position),
            ("the speed", &raw.speed),
            ("the goal", &raw.goal),
        ];
        for (channel, values) in channels {
            if values.len() != n {
                return Err(IdentError::UnequalLengths {
                    channel,
                    found: values.len(),
                    expected: n,
                });
            }
            if let Some((index, &value)) =
                values.iter().enumerate().find(|(_, value)| !crate::finite::usable(**value))
            {
                return Err(IdentError::NotFinite { channel, index, value });
            }
        }
        if raw.enabled.len() != n {
            let channel = "the torque switch";
            return Err(IdentError::UnequalLengths {
                channel,
                found: raw.enabled.len(),
                expected: n,
            });
        }
        if let Some(index) = raw.time.windows(2).position(|pair| pair[1] <= pair[0]) {
            return Err(IdentError::TimeOrder { index: index + 1, time: raw.time[index + 1] });
        }
        let since = if (0.0..=LATEST_START).contains(&raw.time[0]) { 0.0 } else { raw.time[0] };
        let time: Vec<f64> = raw.time.iter().map(|time| time - since).collect();
        let duration = time[n - 1];
        if !(duration > 3.0 * TIME_STEP && duration < 1e5) {
            return Err(IdentError::ServoHeader { what: "duration", value: duration });
        }
        Ok(Self::resampled(raw, &time, duration))
    }

    fn resampled(raw: &RawServoLog, time: &[f64], duration: f64) -> Self {
        let mut frame = 0;
        let samples = (0..)
            .map(|step| f64::from(step) * TIME_STEP)
            .take_while(|&t| t < duration)
            .map(|t| {
                while frame + 2 < time.len() && t > time[frame + 1] {
                    frame += 1;
                }
                (frame, (t - time[frame]) / (time[frame + 1] - time[frame]))
            })
            .collect::<Vec<_>>();
        let on_grid = |values: &[f64]| -> Vec<f64> {
            samples
                .iter()
                .map(|&(i, share)| values[i] + (values[i + 1] - values[i]) * share)
                .collect()
        };
        let switch: Vec<f64> = raw.enabled.iter().map(|&on| f64::from(u8::from(on))).collect();
        let speed = on_grid(&raw.speed);
        Self {
            mass: raw.mass,
            length: raw.length,
            gain: raw.gain,
            supply: raw.supply,
            arm_mass: raw.arm_mass,
            damping: raw.damping,
            position: on_grid(&raw.position),
            first_speed: speed[0],
            goal: on_grid(&raw.goal),
            enabled: on_grid(&switch).into_iter().map(|on| on > 0.5).collect(),
        }
    }

    /// Position gain in the servo's own units.
    pub fn gain(&self) -> f64 {
        self.gain
    }

    /// Samples on the grid.
    pub fn samples(&self) -> usize {
        self.position.len()
    }

    /// Measured position on the grid \[rad\].
    pub fn position(&self) -> &[f64] {
        &self.position
    }

    /// Measured speed at the start \[rad/s\].
    pub fn first_speed(&self) -> f64 {
        self.first_speed
    }

    /// Whether the motor is driven, on the grid.
    pub fn enabled(&self) -> &[bool] {
        &self.enabled
    }

    /// Position asked for, on the grid \[rad\].
    pub fn goal(&self) -> &[f64] {
        &self.goal
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn raw(from: f64) -> RawServoLog {
        let since: Vec<f64> = (0..200).map(|k| 0.01 * f64::from(k)).collect();
        RawServoLog {
            mass: 0.5,
            length: 0.1,
            gain: 100.0,
            supply: 7.4,
            arm_mass: 0.0,
            damping: 0.0,
            position: since.iter().map(|t| (4.0 * t).sin()).collect(),
            speed: since.iter().map(|t| 4.0 * (4.0 * t).cos()).collect(),
            goal: since.iter().map(|t| (4.2 * t).sin()).collect(),
            enabled: vec![true; 200],
            time: since.iter().map(|t| from + t).collect(),
        }
    }

    /// Before, the first two samples were carried on back to zero, as a motion that never was.
    #[test]
    fn a_clock_that_began_elsewhere_changes_nothing() {
        let plain = ServoLog::new(&raw(0.0)).unwrap();
        for from in [60.0, -3.0, 1.7e9] {
            let shifted = ServoLog::new(&raw(from)).unwrap();
            assert!(shifted.samples().abs_diff(plain.samples()) <= 1, "{from}");
            let off = plain.position().iter().zip(shifted.position());
            assert!(off.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) < 1e-5, "{from}");
        }
    }
}
