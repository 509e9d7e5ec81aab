//! Whether a fitted axis model explains a recording, or has taken up what it does not contain.
//!
//! A least-squares fit without gravity puts the weight into inertia and friction: its parameters are
//! wrong and their errors small. What is left then says so: it is large, or it goes with the
//! position, the velocity or the acceleration.

use std::fmt;

use crate::axis_structure::AxisStructure;
use crate::conditioning::Conditioned;
use crate::drift::{drift, wander};
use crate::parameter_id::ParameterId;
use crate::rigid_axis::Prediction;

/// Share of the force's mean square that a model must explain to be trusted.
pub const LEAST_EXPLAINED: f64 = 0.9;
/// Share of what a model leaves that may go with one quantity.
pub const MOST_PATTERN: f64 = 0.2;
/// Root mean square of such a pattern over that of the force, below which nobody would notice.
const NOTICED: f64 = 0.02;
/// A prediction of another recording that is off by this factor more than was to be expected says
/// that what was found does not hold there.
pub const MOST_ELSEWHERE: f64 = 2.0;
/// Factor by which a structure may be further off than a simpler one on another recording.
pub const MOST_OUTDONE: f64 = 1.05;
/// Ranges of a quantity over which means of the residual are taken.
const BINS: usize = 12;

/// What a residual may go with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// Position.
    Position,
    /// Velocity.
    Velocity,
    /// Acceleration.
    Acceleration,
}

impl Quantity {
    /// What is usually missing where a residual goes with it.
    const fn missing(self) -> &'static str {
        match self {
            Self::Position => "gravity, a spring or a force that repeats along the axis",
            Self::Velocity => "friction of each direction, a Stribeck curve or a delay",
            Self::Acceleration => "a delay, elasticity or an inertia that changes",
        }
    }
}

impl fmt::Display for Quantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Position => "position",
            Self::Velocity => "velocity",
            Self::Acceleration => "acceleration",
        })
    }
}

/// Why a fit is not to be trusted as a whole.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum FitDoubt {
    /// It leaves too much.
    #[error(
        "explains only {:.1} % of the force's mean square (below {:.0} %): something acts \
         that it does not have, or sign or scale of the force are wrong. Its parameters are not to \
         be trusted, whatever their errors",
        100.0 * explained, 100.0 * LEAST_EXPLAINED
    )]
    Unexplained {
        /// Share of the mean square of the force that it explains.
        explained: f64,
    },
    /// What it leaves is no noise.
    #[error(
        "leaves a residual of which {:.0} % goes with the {quantity}: it lacks {}, and its \
         parameters have taken up part of that",
        100.0 * share, quantity.missing()
    )]
    Pattern {
        /// What it goes with.
        quantity: Quantity,
        /// Share of the residual's mean square.
        share: f64,
    },
    /// The friction does not stay the same.
    #[error(
        "leaves a residual that says that friction {} while it was recorded, by {:.0} % from the beginning to the end (an \
         axis that warms up, or faster motion late than early that it does not follow): its \
         parameters have taken up part of that. Record the axis warm, or fast and slow motion in turns",
        if *change < 0.0 { "fell" } else { "grew" }, 100.0 * change.abs()
    )]
    Drifts {
        /// Change as a share of the friction's root mean square.
        change: f64,
    },
    /// A constant force does not stay the same.
    #[error(
        "leaves a residual that says that a constant force {} while it was recorded, by {:.0} % of the friction from the beginning \
         to the end (a zero of the sensor that wanders, a load that changes): its parameters have \
         taken up part of that. Take the zero before and after, or record for a shorter time",
        if *change < 0.0 { "fell" } else { "grew" }, 100.0 * change.abs()
    )]
    Wanders {
        /// Change as a share of the friction's root mean square.
        change: f64,
    },
    /// Its parts are not those of one axis.
    #[error(
        "is off by {together:.1} % of the force, where two fits, one to the first {:.0} % of what was recorded and one to the rest, \
         are off by {apart:.1} %: they have {id} at {} and at {}. The axis or its load is not the same throughout. Its parameters are \
         not to be trusted, whatever their errors; identify each part, or each recording, by itself",
        100.0 * share, digits(*first), digits(*second)
    )]
    Parts {
        /// Relative error of one fit to all \[%\].
        together: f64,
        /// The same of two fits \[%\].
        apart: f64,
        /// Where they part, as a share of what was recorded.
        share: f64,
        /// The parameter in which they differ most.
        id: ParameterId,
        /// Its value before.
        first: f64,
        /// Its value after.
        second: f64,
    },
    /// Friction of its own that gives energy.
    #[error(
        "has {id} below zero by more than its error, which friction cannot be: that stands for something \
         it lacks, or the motion does not tell its parts apart (one speed does not). Its parameters are \
         not to be trusted, whatever their errors"
    )]
    Impossible {
        /// The parameter.
        id: ParameterId,
    },
    /// It does not hold in another recording.
    #[error(
        "is off by {there:.1} % of the force on the other recording, where {expected:.1} % was to \
         be expected: what was found does not hold there (other speeds, another load, an axis that \
         has changed, a force that is recorded late). Its parameters are not to be trusted, \
         whatever their errors"
    )]
    Elsewhere {
        /// Relative error that the recording itself promises \[%\].
        expected: f64,
        /// Relative error of the prediction \[%\].
        there: f64,
    },
    /// A simpler structure does better in another recording.
    #[error(
        "is off by {there:.1} % of the force on the other recording, where {simpler} is off by \
         {simpler_there:.1} %: what it has more describes the recording it was fitted to, and does \
         not hold there. For such motion take --structure {simpler}"
    )]
    Outdone {
        /// Relative error of the prediction \[%\].
        there: f64,
        /// The structure that has less.
        simpler: AxisStructure,
        /// Relative error of its prediction \[%\].
        simpler_there: f64,
    },
}

impl FitDoubt {
    /// Whether it is of the recording, and not of what is fitted to it.
    #[must_use]
    pub const fn is_of_the_recording(&self) -> bool {
        matches!(self, Self::Drifts { .. } | Self::Wanders { .. })
    }

    /// Whether no parameter of the fit is to be trusted, and not only its last digits.
    #[must_use]
    pub const fn condemns(&self) -> bool {
        matches!(
            self,
            Self::Unexplained { .. }
                | Self::Impossible { .. }
                | Self::Elsewhere { .. }
                | Self::Parts { .. }
        )
    }
}

/// Whether a fit fails on a recording that it has not seen, where a relative error of `expected`
/// \[%\] of a force of the mean square `power` was promised: more than [`MOST_ELSEWHERE`] times as
/// far off, in the unit of the force and as a share of it.
pub fn elsewhere(expected: f64, power: f64, there: &Prediction) -> Option<FitDoubt> {
    let measured = mean_square(&there.measured);
    let promised = expected.max(100.0 * NOTICED);
    let share = there.relative_error / promised;
    let size = share * (measured / power).sqrt();
    let fails = share.min(size) > MOST_ELSEWHERE;
    fails.then_some(FitDoubt::Elsewhere { expected, there: there.relative_error })
}

/// Whether the best of some simpler structures does clearly better on another recording, with their
/// relative errors there \[%\].
pub fn outdone(
    there: &Prediction,
    simpler: impl IntoIterator<Item = (AxisStructure, f64)>,
) -> Option<FitDoubt> {
    let there = there.relative_error;
    let best = simpler.into_iter().min_by(|a, b| a.1.total_cmp(&b.1));
    let (simpler, simpler_there) = best.filter(|best| there > MOST_OUTDONE * best.1)?;
    Some(FitDoubt::Outdone { there, simpler, simpler_there })
}

/// Three significant digits.
fn digits(value: f64) -> f64 {
    format!("{value:.2e}").parse().unwrap_or(value)
}

fn mean_square(values: &[f64]) -> f64 {
    values.iter().map(|value| value * value).sum::<f64>() / values.len().max(1) as f64
}

/// What is wrong with a fit as a whole; nothing where it explains the recording.
pub fn doubts(prediction: &Prediction, recording: &Conditioned) -> Vec<FitDoubt> {
    let columns = [
        (Quantity::Position, recording.position.as_ref()),
        (Quantity::Velocity, Some(&recording.velocity)),
        (Quantity::Acceleration, Some(&recording.acceleration)),
    ];
    let rows = |(quantity, column): (Quantity, Option<&Vec<f64>>)| {
        Some((quantity, at_rows(column?, prediction, recording)?))
    };
    let columns: Vec<_> = columns.into_iter().filter_map(rows).collect();
    let mut doubts = doubts_of(&prediction.residual(), &prediction.measured, &columns);
    doubts.extend(drift(prediction).map(|change| FitDoubt::Drifts { change }));
    doubts.extend(wander(prediction).map(|change| FitDoubt::Wanders { change }));
    doubts
}

/// The same of any model: from what it leaves of what was measured, and what that may go with.
pub fn doubts_of(
    residual: &[f64],
    measured: &[f64],
    columns: &[(Quantity, Vec<f64>)],
) -> Vec<FitDoubt> {
    let power = mean_square(measured);
    let mut doubts = Vec::new();
    let explained = 1.0 - mean_square(residual) / power;
    if explained.is_nan() || explained < LEAST_EXPLAINED {
        doubts.push(FitDoubt::Unexplained { explained: explained.max(0.0) });
    }
    for (quantity, values) in columns {
        let (quantity, share) = (*quantity, pattern(residual, values));
        let size = (share.max(0.0) * mean_square(residual) / power).sqrt();
        if share > MOST_PATTERN && size > NOTICED {
            doubts.push(FitDoubt::Pattern { quantity, share });
        }
    }
    doubts
}

/// A column of the recording at the times of the prediction.
fn at_rows(column: &[f64], prediction: &Prediction, recording: &Conditioned) -> Option<Vec<f64>> {
    let dt = recording.time_step;
    let value = |&time: &f64| {
        recording.pieces.iter().rev().find_map(|piece| {
            let sample = ((time - piece.start) / dt).round() - recording.first as f64;
            let inside = sample >= 0.0 && sample < piece.kept.len() as f64;
            if inside { column.get(piece.kept.start + sample as usize).copied() } else { None }
        })
    };
    prediction.time.iter().map(value).collect()
}

/// Share of a residual that means over ranges of `values` predict: those of one half of the time
/// predict the other half, so that chance is no pattern. The smaller of both.
fn pattern(residual: &[f64], values: &[f64]) -> f64 {
    let n = residual.len().min(values.len());
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by(|&a, &b| values[a].total_cmp(&values[b]));
    let mut bin = vec![0; n];
    for (place, &row) in order.iter().enumerate() {
        bin[row] = place * BINS / n;
    }
    let mean = residual.iter().sum::<f64>() / n.max(1) as f64;
    let explained = |by: std::ops::Range<usize>, of: std::ops::Range<usize>| {
        let mut sums = [(0.0, 0usize); BINS];
        for row in by {
            sums[bin[row]].0 += residual[row] - mean;
            sums[bin[row]].1 += 1;
        }
        let (mut left, mut all) = (0.0, 0.0);
        for row in of {
            let (sum, count) = sums[bin[row]];
            let off = residual[row] - mean;
            left += (off - sum / count.max(1) as f64).powi(2);
            all += off * off;
        }
        if all > 0.0 { 1.0 - left / all } else { 0.0 }
    };
    f64::min(explained(0..n / 2, n / 2..n), explained(n / 2..n, 0..n / 2))
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_distr::StandardNormal;

    use super::*;
    use crate::{AxisModel, Conditioning, Signals, condition, fit_axis};

    /// A joint of 0.5 kg m^2 with friction, noise and `load`, which depends on its angle.
    fn found(load: impl Fn(f64) -> f64) -> Vec<FitDoubt> {
        let mut rng = rand_pcg::Pcg64Mcg::seed_from_u64(9);
        let time = || (0..20_000).map(|k| f64::from(k) * 1e-3);
        let place: Vec<f64> =
            time().map(|t| 0.9 * (1.1 * t).sin() + 0.5 * (2.9 * t).sin()).collect();
        let torque = |(t, q): (f64, &f64)| {
            let v = 0.99 * (1.1 * t).cos() + 1.45 * (2.9 * t).cos();
            let a = -1.089 * (1.1 * t).sin() - 4.205 * (2.9 * t).sin();
            0.5 * a
                + 0.4 * v
                + 1.2 * v.signum()
                + load(*q)
                + 0.1 * rng.sample::<f64, _>(StandardNormal)
        };
        let force: Vec<f64> = time().zip(&place).map(torque).collect();
        let signals = Signals {
            time_step: 1e-3,
            position: Some(&place),
            readings: None,
            velocity: None,
            force: &force,
        };
        let recording = condition(&signals, &Conditioning::for_time_step(1e-3)).unwrap();
        let fit = fit_axis(&recording, AxisModel::SYMMETRIC).unwrap();
        doubts(&fit.predict(&recording).unwrap(), &recording)
    }

    #[test]
    fn a_model_that_has_all_that_acts_is_not_doubted() {
        assert_eq!(found(|_| 0.3), []);
    }

    #[test]
    fn gravity_that_the_model_does_not_have_is_told() {
        let doubts = found(|q| 6.0 * (q - 0.7).cos());
        let of = |doubt: &FitDoubt| matches!(doubt, FitDoubt::Pattern { quantity, .. } if *quantity == Quantity::Position);
        assert!(doubts.iter().any(of), "{doubts:?}");
        assert!(matches!(doubts[0], FitDoubt::Unexplained { .. }), "{doubts:?}");
        let said: String = doubts.iter().map(ToString::to_string).collect();
        assert!(said.contains("gravity") && said.contains("not to be trusted"), "{said}");
    }
}
