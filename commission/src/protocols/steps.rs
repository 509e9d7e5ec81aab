//! The thesis's constant velocities on any machine.
//!
//! The velocities are those of the protocol, as shares of the fastest; the fastest is that of the
//! machine. Lengths and repetitions are the protocol's. The loop is the commission's own, and so is
//! the reading: the mean voltage, since a torque sensor is seldom there. Every step goes one way, as
//! the protocol has it.

use controller::{ControllerOptions, Reference};
use experiment_runner::protocol::ConstantVelocityProtocol;
use friction_ident::statistics::line;
use rig_driver::Measurement;

use crate::axis::Axis;
use crate::friction::{Blocks, Curve, Point};
use crate::{CommissionError, Stage};

/// Share of what is dropped at the beginning in which the speed is reached.
const STARTING: f64 = 0.3;
/// A step whose speed misses the one that was asked for by more than this share was no steady
/// motion.
const STEADY: f64 = 0.2;
/// Share of the steps that have to be steady: fewer tell no curve.
const FEWEST: f64 = 0.25;

/// What the fixed protocol came to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fixed {
    /// The curve; none where too few steps were steady, or they show no friction.
    pub curve: Option<Curve>,
    /// Rig time \[s\].
    pub seconds: f64,
    /// Steps, and those that were steady.
    pub steps: (usize, usize),
}

/// Drives one set of the protocol up to `fastest` [rad/s].
///
/// # Errors
/// [`CommissionError`] if the rig refuses.
pub fn steps(
    axis: &mut Axis<'_>,
    blocks: &Blocks,
    protocol: &ConstantVelocityProtocol,
    fastest: f64,
) -> Result<Fixed, CommissionError> {
    let bench = axis.bench()?;
    let begun = axis.used();
    let top = protocol.velocities.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
    let mut points = Vec::new();
    let mut driven = 0;
    for _ in 0..protocol.repetitions {
        for velocity in protocol.velocities.iter().map(|velocity| velocity * fastest / top) {
            let start = STARTING * protocol.drop_first;
            let reference = |time: f64| reference(velocity, start, time);
            let friction =
                |now: &Reference| if now.velocity == 0.0 { 0.0 } else { blocks.friction };
            let controller: ControllerOptions = blocks.controller;
            let seconds = protocol.duration;
            let seen =
                axis.follow(&bench, Stage::Friction, seconds, controller, reference, friction)?;
            driven += 1;
            points.extend(point(&seen, velocity, protocol, bench.period(), axis.used()));
        }
    }
    let enough = points.len() as f64 >= FEWEST * driven as f64;
    let curve = enough.then(|| Curve::of(&points, 0.0).ok()).flatten();
    Ok(Fixed { curve, seconds: axis.used() - begun, steps: (driven, points.len()) })
}

/// Up to the speed within `start` seconds, and then at it.
fn reference(velocity: f64, start: f64, time: f64) -> Reference {
    if time < start {
        let pace = velocity / start;
        Reference { position: 0.5 * pace * time * time, velocity: pace * time, acceleration: pace }
    } else {
        Reference { position: velocity * (time - 0.5 * start), velocity, acceleration: 0.0 }
    }
}

/// The means of a step; none of one that was cut short or not steady.
fn point(
    seen: &[Measurement],
    velocity: f64,
    protocol: &ConstantVelocityProtocol,
    period: f64,
    time: f64,
) -> Option<Point> {
    let cycles = |seconds: f64| (seconds / period).round() as usize;
    let (first, last) =
        (cycles(protocol.drop_first), cycles(protocol.duration - protocol.drop_last));
    let path: Vec<(f64, f64)> =
        seen.get(first..=last)?.iter().map(|seen| (seen.time, seen.encoder_position)).collect();
    let told = line(&path)?.slope.value;
    if (told - velocity).abs() > STEADY * velocity {
        return None;
    }
    // A reading tells the voltage of the cycle before it.
    let volts = seen.get(first + 1..=last)?;
    let volts = volts.iter().map(|seen| seen.voltage_applied).sum::<f64>() / volts.len() as f64;
    Some(Point { velocity: told, volts, one_way: 0.0, uneven: 0.0, time })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_is_the_mean_of_what_counts() {
        let protocol = ConstantVelocityProtocol::quick();
        let seen = |speed: f64| -> Vec<Measurement> {
            (0..=6000)
                .map(|k| {
                    let time = 1e-3 * f64::from(k);
                    // What is dropped at both ends is wild.
                    let counts = (2.0..=5.5).contains(&time);
                    let voltage_applied = if counts { 0.8 } else { 5.0 };
                    let encoder_position = speed * time;
                    Measurement { time, encoder_position, voltage_applied, ..Default::default() }
                })
                .collect()
        };
        let found = point(&seen(0.3), 0.3, &protocol, 1e-3, 0.0).unwrap();
        assert!((found.velocity - 0.3).abs() < 1e-9 && (found.volts - 0.8).abs() < 1e-9);
        assert_eq!(point(&seen(0.2), 0.3, &protocol, 1e-3, 0.0), None);
        assert_eq!(point(&seen(0.3)[..3000], 0.3, &protocol, 1e-3, 0.0), None);
    }

    #[test]
    fn the_reference_of_a_step_is_smooth() {
        let h = 1e-5;
        for i in 1..300 {
            let time = 0.01 * f64::from(i) + 1e-3;
            let at = |time: f64| reference(0.4, 0.9, time);
            let speed = (at(time + h).position - at(time - h).position) / (2.0 * h);
            assert!((speed - at(time).velocity).abs() < 1e-6, "{time}");
        }
    }
}
