//! How much friction there is now, of what the curve says.
//!
//! While a reference is followed with its friction fed forward, what feedback still adds tells how
//! much was fed too little: friction that went on to change after it was measured, as a drive does
//! that is still warming up. That is a straight fit of feedback's voltage on what was fed, beside a
//! constant and a slope over the place, away from the reversals.

use experiment_runner::cycle::CycleSample;
use nalgebra::{Matrix3, Vector3};

/// Share of the highest speed from which on a cycle counts.
const AWAY: f64 = 0.3;
/// The least change that matters.
const MATTERS: f64 = 0.003;
/// Times that tell the same may differ by this share of the change.
const ALIKE: f64 = 0.5;
/// The least and the most friction that is believed, of what the curve says.
const BELIEVED: (f64, f64) = (0.8, 1.2);

/// What a cycle says.
#[derive(Debug, Clone, Copy)]
struct Fed {
    /// Where the reference is \[rad\], and how fast [rad/s].
    place: f64,
    velocity: f64,
    /// What was fed of the friction, and what feedback added \[V\].
    friction: f64,
    added: f64,
}

impl From<&CycleSample> for Fed {
    fn from(now: &CycleSample) -> Self {
        Self {
            place: now.reference.position,
            velocity: now.reference.velocity,
            friction: now.command.friction,
            added: now.command.linear,
        }
    }
}

/// The share of the friction that was fed that is missing; none where nothing was fed.
fn missing(seen: &[Fed]) -> Option<f64> {
    let fastest = seen.iter().map(|now| now.velocity.abs()).fold(0.0, f64::max);
    let (mut normal, mut right) = (Matrix3::<f64>::zeros(), Vector3::<f64>::zeros());
    for now in seen.iter().filter(|now| now.velocity.abs() > AWAY * fastest) {
        let row = Vector3::new(now.friction, 1.0, now.place);
        normal += row * row.transpose();
        right += row * now.added;
    }
    let found = normal.try_inverse()? * right;
    Some(found[0]).filter(|share| share.is_finite())
}

/// How much friction there is now, by two times or more that were driven at `level`; as before where
/// these do not tell the same, or nothing that matters.
#[must_use]
pub fn level_now(level: f64, times: &[Vec<CycleSample>]) -> f64 {
    let share = |seen: &Vec<CycleSample>| missing(&seen.iter().map(Fed::from).collect::<Vec<_>>());
    let shares: Option<Vec<f64>> = times.iter().map(share).collect();
    shares.map_or(level, |shares| agreed(level, &shares))
}

/// The level by shares that are missing.
fn agreed(level: f64, shares: &[f64]) -> f64 {
    if shares.len() < 2 {
        return level;
    }
    let mean = shares.iter().sum::<f64>() / shares.len() as f64;
    let alike = shares.iter().all(|share| (share - mean).abs() < ALIKE * mean.abs());
    if !alike || mean.abs() < MATTERS {
        return level;
    }
    // The last is nearest to now.
    let last = shares.last().copied().unwrap_or(mean);
    (level * (1.0 + last)).clamp(BELIEVED.0, BELIEVED.1)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn driven(missing: f64) -> Vec<Fed> {
        let cycle = |k: u32| {
            let (place, velocity) = (0.01 * f64::from(k)).sin_cos();
            let friction = 0.5 * velocity.signum();
            let scatter = 1e-3 * (f64::from(k) * 2.4).sin();
            Fed {
                place,
                velocity,
                friction,
                added: missing * friction + 0.03 + 0.2 * place + scatter,
            }
        };
        (0..1257).map(cycle).collect()
    }

    #[test]
    fn friction_that_changed_is_told_beside_a_load() {
        assert!((missing(&driven(-0.06)).unwrap() + 0.06).abs() < 2e-3);
        assert_eq!(missing(&[]), None);
    }

    #[test]
    fn what_did_not_change_or_is_told_once_only_stays() {
        assert!((agreed(1.0, &[-0.05, -0.06]) - 0.94).abs() < 1e-12);
        assert_eq!(agreed(1.0, &[0.001, 0.001]), 1.0);
        assert_eq!(agreed(0.97, &[-0.05, 0.05]), 0.97);
        assert_eq!(agreed(1.0, &[-0.05]), 1.0);
    }
}
