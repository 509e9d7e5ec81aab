//! Steady points, and what every fit through them asks of them.

use serde::Serialize;

use crate::IdentError;
use crate::place::Place;

/// One steady point: the mean friction at a constant velocity.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct SteadyPoint {
    /// Velocity \[rad/s or m/s\], either sign.
    pub velocity: f64,
    /// Friction \[N m or N\]; positive opposes positive velocity.
    pub torque: f64,
    /// Standard deviation of `torque`, for all points or for none. Only the ratios count: the
    /// overall scale is taken from the scatter around the curve.
    pub deviation: Option<f64>,
    /// Where it was measured, if that is known: what a spring or gravity adds depends on it.
    #[serde(skip)]
    pub place: Option<Place>,
}

impl SteadyPoint {
    /// A point without a standard deviation of its own.
    pub fn new(velocity: f64, torque: f64) -> Self {
        Self { velocity, torque, deviation: None, place: None }
    }
}

/// Smallest standard deviation, as a share of the largest: beside such a point the others would
/// count for nothing.
const SMALLEST_SHARE: f64 = 1e-9;
/// Torques and speeds below this are rounding \[SI units\].
const SMALLEST: f64 = 1e-50;

/// What a curve through steady points needs.
pub(crate) struct Needed {
    /// The curve.
    pub what: &'static str,
    /// How many points.
    pub points: usize,
    /// How many different speeds above zero.
    pub speeds: usize,
    /// What may be lowered instead, if anything.
    pub lower: Option<&'static str>,
}

/// Checks the points and returns the slowest and fastest speed.
pub(crate) fn check_points(
    points: &[SteadyPoint],
    needed: &Needed,
) -> Result<(f64, f64), IdentError> {
    if points.len() < needed.points {
        return Err(IdentError::TooFewSamples {
            what: needed.what,
            needed: needed.points,
            found: points.len(),
            lower: needed.lower,
        });
    }
    for (index, point) in points.iter().enumerate() {
        for (channel, value) in [("the velocity", point.velocity), ("the torque", point.torque)] {
            if !crate::finite::usable(value) {
                return Err(IdentError::NotFinite { channel, index, value });
            }
        }
        match point.deviation {
            Some(value) if !(value > 0.0 && value.is_finite()) => {
                return Err(IdentError::StandardDeviation { index, value });
            }
            None if points.iter().any(|other| other.deviation.is_some()) => {
                return Err(IdentError::MixedDeviations { index });
            }
            _ => {}
        }
    }
    let deviations =
        || points.iter().enumerate().filter_map(|(index, point)| Some((index, point.deviation?)));
    let largest = deviations().map(|(_, value)| value).fold(0.0, f64::max);
    if let Some((index, value)) = deviations().find(|(_, value)| *value < SMALLEST_SHARE * largest)
    {
        return Err(IdentError::DeviationRange { index, value, largest });
    }
    if points.iter().all(|point| point.torque.abs() < SMALLEST) {
        return Err(IdentError::ZeroForce);
    }
    let speeds = different_speeds(points);
    match (speeds.first(), speeds.last()) {
        (Some(&slowest), Some(&fastest)) if speeds.len() >= needed.speeds => Ok((slowest, fastest)),
        _ => Err(IdentError::TooFewSpeeds { needed: needed.speeds, found: speeds.len() }),
    }
}

/// The speeds above zero, slowest first. Repetitions at one speed differ by a rounding at most;
/// closer than a millionth counts as the same, and below a billionth of the fastest is rest.
pub(crate) fn different_speeds(points: &[SteadyPoint]) -> Vec<f64> {
    let fastest = points.iter().map(|point| point.velocity.abs()).fold(0.0, f64::max);
    let least = (SMALLEST_SHARE * fastest).max(SMALLEST);
    let mut speeds: Vec<_> =
        points.iter().map(|point| point.velocity.abs()).filter(|&speed| speed > least).collect();
    speeds.sort_by(f64::total_cmp);
    speeds.dedup_by(|a, b| *a <= *b * (1.0 + 1e-6));
    speeds
}

/// Square roots of the points' weights. Weights are relative: their mean square is one, so that the
/// residual keeps its unit.
pub(crate) fn relative_weights(points: &[SteadyPoint]) -> Vec<f64> {
    // Over a power of two of their size they are of a usual size, whatever the unit, and lose no
    // bit.
    let largest = points.iter().filter_map(|point| point.deviation).fold(0.0, f64::max);
    let size = if largest > 0.0 { largest.log2().floor().exp2() } else { 1.0 };
    let inverse = |point: &SteadyPoint| point.deviation.map_or(1.0, |deviation| size / deviation);
    let mean: f64 =
        points.iter().map(|point| inverse(point).powi(2)).sum::<f64>() / points.len() as f64;
    points.iter().map(|point| inverse(point) / mean.sqrt()).collect()
}
