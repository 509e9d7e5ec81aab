//! The limit cycle that friction and integral action make of a regulated position.

use serde::{Deserialize, Serialize};

/// A sustained oscillation.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct LimitCycle {
    /// Half the distance of the extremes \[rad\].
    pub amplitude: f64,
    /// Mean time between two crossings of the middle in the same direction \[s\].
    pub period: f64,
    /// Whole periods that were seen.
    pub periods: u32,
}

impl LimitCycle {
    /// Part of a record that belongs to the transient.
    const TRANSIENT: f64 = 0.4;

    /// The limit cycle in samples `dt` \[s\] apart: of the last three fifths of the record, if it
    /// crosses its middle three times in the same direction or more, with an amplitude of at least
    /// `least` \[rad\] that the second half of them keeps to three fifths.
    ///
    /// A crossing counts once the signal has gone by three tenths of the amplitude beyond the
    /// middle on the other side, so that noise and steps of a sensor do not make periods.
    #[must_use]
    pub fn find(samples: &[f64], dt: f64, least: f64) -> Option<Self> {
        let settled = samples.get((Self::TRANSIENT * samples.len() as f64) as usize..)?;
        let (low, high) = extremes(settled)?;
        let (middle, amplitude) = (0.5 * (low + high), 0.5 * (high - low));
        let (low, high) = extremes(settled.get(settled.len() / 2..)?)?;
        if !(amplitude >= least && 0.5 * (high - low) >= 0.6 * amplitude) {
            return None;
        }
        let band = 0.3 * amplitude;
        let mut below = false;
        let mut rises = Vec::new();
        for (index, value) in settled.iter().enumerate() {
            if *value < middle - band {
                below = true;
            } else if below && *value > middle + band {
                below = false;
                rises.push(index);
            }
        }
        let (first, last) = (rises.first()?, rises.last()?);
        let periods = u32::try_from(rises.len() - 1).ok().filter(|&periods| periods >= 2)?;
        Some(Self { amplitude, period: (last - first) as f64 * dt / f64::from(periods), periods })
    }
}

/// Least and largest; `None` of nothing, or where something is not a number.
fn extremes(values: &[f64]) -> Option<(f64, f64)> {
    let mut found = None;
    for &value in values {
        if !value.is_finite() {
            return None;
        }
        let (low, high) = found.unwrap_or((value, value));
        found = Some((f64::min(low, value), f64::max(high, value)));
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sine(amplitude: f64, decay: f64, offset: f64) -> Vec<f64> {
        let at = |k: u32| {
            let t = f64::from(k) * 0.01;
            offset + amplitude * (-decay * t).exp() * (std::f64::consts::TAU * t / 7.0).sin()
        };
        (0..10_000).map(at).collect()
    }

    #[test]
    fn a_sustained_oscillation_has_its_amplitude_and_period() {
        let found = LimitCycle::find(&sine(0.2, 0.0, 1.0), 0.01, 1e-3).unwrap();
        assert!(
            (found.amplitude - 0.2).abs() < 1e-5 && (found.period - 7.0).abs() < 0.01,
            "{found:?}"
        );
        assert!((7..=8).contains(&found.periods));
    }

    #[test]
    fn what_dies_down_or_is_too_small_is_none() {
        assert_eq!(LimitCycle::find(&sine(0.2, 0.05, 0.0), 0.01, 1e-3), None);
        assert_eq!(LimitCycle::find(&sine(0.0005, 0.0, 0.0), 0.01, 1e-3), None);
        assert_eq!(LimitCycle::find(&vec![0.3; 1000], 0.01, 1e-3), None);
        assert_eq!(LimitCycle::find(&[], 0.01, 1e-3), None);
        assert_eq!(LimitCycle::find(&vec![f64::NAN; 1000], 0.01, 1e-3), None);
    }

    #[test]
    fn steps_of_a_sensor_make_no_periods() {
        let rounded: Vec<f64> = sine(0.01, 0.0, 0.0)
            .iter()
            .map(|value| (value / 1.534e-3).floor() * 1.534e-3)
            .collect();
        let found = LimitCycle::find(&rounded, 0.01, 3e-3).unwrap();
        assert!((found.period - 7.0).abs() < 0.05, "{found:?}");
    }
}
