//! Experiments 3 and 4: when the shaft breaks away under a rising torque.
//!
//! Gross motion is a displacement that no pre-sliding reaches. Sliding begins (the onset) with the
//! last stretch before gross motion in which the speed is above both limits of the [`OnsetRule`]: a
//! smallest speed, clear of the sensor's noise, and a multiple of the mean speed since the torque
//! began to rise. Before sliding a contact is a spring that softens: its speed under a steady ramp
//! is the ramp's rate over the stiffness, and grows several times only where the stiffness is
//! nearly gone. The ratio of the test bed's spring is 2.5 at 0.8 of the breakaway displacement.
//! Inertia alone gives 3 (x grows with the cube of time), so that a ratio near it fails above some
//! 2 N m/s.
//!
//! Two torques are reported, for published statements about the rate of the torque disagree by
//! which of them is meant: the friction at the onset, and the highest friction before gross motion.

use friction_ident::{FrictionTorque, IdentError, zero_phase::LowPass};
use serde::{Deserialize, Serialize};

use super::Channels;
use crate::profile::REST;
use crate::protocol::{Displacement, OnsetRule};

/// Low-pass of speed, displacement and peak torque: cutoff \[Hz\], second order in each direction.
const CUTOFF: f64 = 20.0;

/// Breakaway of one run. Magnitudes, whatever the direction.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Breakaway {
    /// Time from the beginning of the rise to the onset \[s\].
    pub time: f64,
    /// Friction torque at the onset [N m].
    pub torque: f64,
    /// Its standard deviation by the drive's constants [N m].
    pub torque_systematic: f64,
    /// Highest smoothed friction torque before gross motion [N m]; noise raises it.
    pub peak: f64,
    /// Displacement at the onset \[rad\].
    pub displacement: f64,
}

/// Why there is no breakaway.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum NoBreakaway {
    /// The shaft stayed.
    #[error(
        "the shaft moved {moved:.4} rad at most, less than the gross motion of {gross_motion} rad: raise `up_to` or the amplitude in the protocol"
    )]
    Stuck {
        /// Largest displacement \[rad\].
        moved: f64,
        /// What would have been gross motion \[rad\].
        gross_motion: f64,
    },
    /// The motion never differed from what pre-sliding explains.
    #[error(
        "the speed never rose above {ratio} times the mean speed: the torque rises too fast for the onset to be told; lower the rate, or `onset.ratio`"
    )]
    TooFast {
        /// Smallest ratio that counts.
        ratio: f64,
    },
    /// The recording cannot be filtered.
    #[error(transparent)]
    Recording(#[from] IdentError),
}

/// Finds the breakaway of a run that rests for [`REST`] and then is driven by a rising torque in
/// `direction` (1 or -1).
///
/// # Errors
/// [`NoBreakaway`].
pub fn find_breakaway(
    channels: &Channels,
    friction: &FrictionTorque,
    rule: &OnsetRule,
    displacement: Displacement,
    direction: f64,
) -> Result<Breakaway, NoBreakaway> {
    let rate = 1.0 / channels.period;
    let filter = LowPass::butterworth(2, CUTOFF.min(rate / 5.0), rate)?;
    let smooth = |values: &[f64]| -> Result<Vec<f64>, IdentError> {
        filter.filter(&values.iter().map(|value| direction * value).collect::<Vec<f64>>())
    };
    let position = match displacement {
        Displacement::Encoder => &channels.encoder,
        Displacement::Potentiometer => &channels.potentiometer,
    };
    let rest = ((REST / channels.period) as usize).clamp(1, position.len().max(1));
    let zero = direction * position.iter().take(rest).sum::<f64>() / rest as f64;
    let moved: Vec<f64> = smooth(position)?.into_iter().map(|x| x - zero).collect();
    let speed = smooth(&channels.velocity)?;
    let Some(gross) = moved.iter().position(|&x| x > rule.gross_motion) else {
        let moved = moved.iter().copied().fold(0.0, f64::max);
        return Err(NoBreakaway::Stuck { moved, gross_motion: rule.gross_motion });
    };
    let slides = |&i: &usize| {
        let elapsed = (i.saturating_sub(rest) + 1) as f64 * channels.period;
        speed[i] > rule.speed.max(rule.ratio * moved[i] / elapsed)
    };
    // Once the shaft slides the mean speed catches up: the last stretch that counts need not reach
    // to the gross motion.
    let onset = (rest..=gross).rev().skip_while(|i| !slides(i)).take_while(slides).last();
    let Some(onset) = onset else { return Err(NoBreakaway::TooFast { ratio: rule.ratio }) };
    // A line through the last tenth of the rise, read at its end.
    let samples = ((onset - rest.min(onset)) / 10).max(20).min(onset);
    let window = onset - samples..=onset;
    let at_onset = |torque: &[f64]| torque.get(window.clone()).map_or(0.0, end_of_line);
    let peak = smooth(&friction.torque)?.into_iter().take(gross + 1).fold(0.0, f64::max);
    Ok(Breakaway {
        time: (onset - rest.min(onset)) as f64 * channels.period,
        torque: direction * at_onset(&friction.torque),
        torque_systematic: friction.propagate(at_onset),
        peak,
        displacement: moved[onset],
    })
}

/// Value at the last sample of the least-squares line through evenly spaced values.
fn end_of_line(values: &[f64]) -> f64 {
    let n = values.len() as f64;
    let centre = 0.5 * (n - 1.0);
    let mean = values.iter().sum::<f64>() / n;
    let (mut along, mut squares) = (0.0, 0.0);
    for (i, value) in values.iter().enumerate() {
        let x = i as f64 - centre;
        along += x * value;
        squares += x * x;
    }
    if squares > 0.0 { mean + along / squares * centre } else { mean }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_line_is_read_at_its_end() {
        let line: Vec<f64> = (0..50).map(|i| 0.3 + 0.01 * f64::from(i)).collect();
        assert!((end_of_line(&line) - 0.79).abs() < 1e-12);
        assert_eq!(end_of_line(&[2.5]), 2.5);
    }

    /// A spring that lets go: x = t/100 until 5 s, then a steady 1 rad/s.
    #[test]
    fn the_onset_is_where_the_motion_breaks_and_stays() {
        let mut channels = Channels::new(1e-3);
        for i in 0..6000 {
            let t = f64::from(i) * 1e-3;
            let since = (t - REST).max(0.0);
            // A moment's jerk before, which does not last.
            let jerk = if (2.0..2.05).contains(&t) { 0.05 } else { 0.0 };
            let (x, w) = if since < 5.0 {
                (0.001 * since, 0.001 + jerk)
            } else {
                (0.005 + (since - 5.0), 1.0)
            };
            channels.time.push(t);
            channels.potentiometer.push(-x);
            channels.velocity.push(-w);
            channels.torque.push(-0.02 * since.min(5.0));
        }
        let friction = FrictionTorque {
            source: friction_ident::TorqueSource::Sensor,
            torque: channels.torque.clone(),
            noise: 0.0,
            constants: vec![],
        };
        let rule = OnsetRule { speed: 0.02, ratio: 4.0, gross_motion: 0.1 };
        let find = |direction| {
            find_breakaway(&channels, &friction, &rule, Displacement::Potentiometer, direction)
        };
        let found = find(-1.0).unwrap();
        assert!((found.time - 5.0).abs() < 0.02, "{found:?}");
        assert!(
            (found.torque - 0.1).abs() < 1e-3 && (found.displacement - 0.005).abs() < 1e-3,
            "{found:?}"
        );
        let message = find(1.0).unwrap_err().to_string();
        assert!(message.contains("up_to"), "{message}");
    }
}
