//! Whether what a friction model leaves repeats with every reversal: a dip or lost motion that the
//! model does not have.
//!
//! What is left then takes its place in the parameters that act near rest, and no error counts it
//! fully: a static level, a Stribeck velocity and a stiffness that describe another effect are off
//! by whatever suits the recording at hand.
//!
//! The residual in the direction of motion is gathered over ranges of the speed and of the way since
//! the last reversal, pass by pass: one pass lasts from a reversal to the next, and counts as one
//! observation, so that the colour of the noise within a pass does not matter. A range says that
//! something is missing where its mean over the passes is clear of chance, for all ranges together,
//! and as large as anybody would notice.

use serde::Serialize;

/// Ranges of speed and of way, each half of the one above.
const OCTAVES: usize = 9;
/// Passes below which a range says nothing.
const FEWEST_PASSES: usize = 6;
/// Deviations of a normal distribution beyond which a mean is no chance: once in 700 means, and
/// some twenty are looked at.
const BEYOND_CHANCE: f64 = 3.2;
/// Share of the friction's root mean square below which nobody would notice.
const NOTICED: f64 = 0.01;

/// What a friction model leaves near rest.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct LeftNearRest {
    /// What it goes with.
    pub with: NearRest,
    /// The residual in the direction of motion, its mean where that is clearest, as a share of the
    /// friction's root mean square.
    pub share: f64,
    /// Up to which speed \[m/s or rad/s\] or way \[m or rad\] that is.
    pub up_to: f64,
}

/// What a residual near rest goes with.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum NearRest {
    /// The speed.
    Speed,
    /// The way since the last reversal.
    Way,
}

impl std::fmt::Display for LeftNearRest {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let (with, missing) = match self.with {
            NearRest::Speed => ("the speed", "a dip"),
            NearRest::Way => ("the way since a reversal", "lost motion or a dip"),
        };
        write!(
            f,
            "what the fit leaves goes with {with} in pass after pass ({:+.0} % of the friction below \
             {:.2e}): the model lacks {missing}, and what it has near rest stands in for that",
            100.0 * self.share,
            self.up_to
        )
    }
}

/// Looks for a residual that repeats near rest. `residuals` (measured less predicted), `velocity` and
/// `way` since the last reversal have one value a row, in the order of time; `friction_size` is how
/// large friction is. The clearest range; none where nothing is clear of chance.
#[must_use]
pub fn left_near_rest(
    residuals: &[f64],
    friction_size: f64,
    velocity: &[f64],
    way: &[f64],
) -> Option<LeftNearRest> {
    let rows = residuals.len().min(velocity.len()).min(way.len());
    let passes = passes(velocity.get(..rows)?, way.get(..rows)?);
    let speed: Vec<f64> = velocity.iter().map(|v| v.abs()).collect();
    let mut clearest: Option<(f64, LeftNearRest)> = None;
    for (with, quantity) in [(NearRest::Speed, speed.as_slice()), (NearRest::Way, way)] {
        let quantity = quantity.get(..rows)?;
        let most = quantity.iter().filter(|x| x.is_finite()).fold(0.0f64, |most, x| most.max(*x));
        // The widest ranges are the motion at large: its errors are those of every parameter.
        for octave in 1..=OCTAVES {
            let high = most * 0.5f64.powi(octave as i32);
            let low = if octave == OCTAVES { 0.0 } else { 0.5 * high };
            let Some((mean, clear)) = over_passes(&passes, |k| {
                let inside = (low..high).contains(&quantity[k]);
                inside.then(|| residuals[k] * velocity[k].signum())
            }) else {
                continue;
            };
            let seen = clear > BEYOND_CHANCE && mean.abs() > NOTICED * friction_size;
            if seen && clearest.is_none_or(|(before, _)| clear > before) {
                clearest =
                    Some((clear, LeftNearRest { with, share: mean / friction_size, up_to: high }));
            }
        }
    }
    clearest.map(|(_, left)| left)
}

/// The pass of each row. A row that has come a shorter way than the one before it begins a new one.
fn passes(velocity: &[f64], way: &[f64]) -> Vec<usize> {
    let mut pass = 0;
    let mut before = (0.0, 0.0);
    velocity
        .iter()
        .zip(way)
        .map(|(&v, &way)| {
            if v * before.0 < 0.0 || way < before.1 {
                pass += 1;
            }
            before = (v, way);
            pass
        })
        .collect()
}

/// Mean of `of` over the rows where it has a value, and by how many deviations it is clear of zero,
/// one pass one observation.
fn over_passes(passes: &[usize], of: impl Fn(usize) -> Option<f64>) -> Option<(f64, f64)> {
    let mut sums: Vec<(usize, f64)> = Vec::new();
    let mut count = 0usize;
    for (k, &pass) in passes.iter().enumerate() {
        let Some(value) = of(k) else { continue };
        count += 1;
        match sums.last_mut() {
            Some((last, sum)) if *last == pass => *sum += value,
            _ => sums.push((pass, value)),
        }
    }
    let n = sums.len() as f64;
    if sums.len() < FEWEST_PASSES {
        return None;
    }
    let total: f64 = sums.iter().map(|(_, sum)| sum).sum();
    let spread: f64 = sums.iter().map(|(_, sum)| (sum - total / n).powi(2)).sum();
    let t = total.abs() / (spread * n / (n - 1.0)).sqrt();
    // Wallace (1959): Student's t as a normal deviation.
    let degrees = n - 1.0;
    let clear = (8.0 * degrees + 1.0) / (8.0 * degrees + 3.0)
        * (degrees * (t * t / degrees).ln_1p()).sqrt();
    clear.is_finite().then_some((total / count as f64, clear))
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_distr::StandardNormal;

    use super::*;

    /// A swing whose residual is noise and, in the direction of motion, `left` of the speed and way.
    fn found(left: impl Fn(f64, f64) -> f64) -> Option<LeftNearRest> {
        let mut rng = rand_pcg::Pcg64Mcg::seed_from_u64(11);
        let velocity: Vec<f64> = (0..8000).map(|k| (4e-3 * f64::from(k) * 3.0).sin()).collect();
        let (mut way, mut since, mut before) = (Vec::new(), 0.0, 0.0);
        for &v in &velocity {
            since = if v * before < 0.0 { 0.0 } else { since + v.abs() * 4e-3 };
            before = v;
            way.push(since);
        }
        let (mut colour, mut residual) = (0.0, Vec::new());
        for (v, way) in velocity.iter().zip(&way) {
            colour = 0.9 * colour + 0.1 * rng.sample::<f64, _>(StandardNormal);
            residual.push(colour + left(v.abs(), *way) * v.signum());
        }
        left_near_rest(&residual, 3.0, &velocity, &way)
    }

    #[test]
    fn noise_is_nothing_and_a_dip_or_lost_motion_is_told() {
        assert_eq!(found(|_, _| 0.0), None);
        let dip = found(|speed, _| 0.4 * (-(speed / 0.05f64).powi(2)).exp());
        assert!(dip.is_some_and(|left| left.share > 0.0), "{dip:?}");
        let lost = found(|_, way| if way < 0.03 { -0.4 } else { 0.0 });
        assert!(lost.is_some_and(|left| left.share < 0.0), "{lost:?}");
    }

    #[test]
    fn a_recording_of_few_passes_says_nothing() {
        assert_eq!(left_near_rest(&[1.0; 5], 1.0, &[1.0; 5], &[0.1; 5]), None);
        assert_eq!(left_near_rest(&[], 1.0, &[], &[]), None);
    }
}
