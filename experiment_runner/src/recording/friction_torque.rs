//! Friction from what a rig measures: a torque sensor, or what drives the axis less what accelerates it.
//!
//! Without a sensor `F = T - J a`, where the driving torque `T` is a column of its own, or `(A Km / Ra) (u - A Km w)` from the motor's voltage, or `A Km i`
//! from its current (thesis eqs. 4.4 to 4.7 with the inductance left out).

use friction_ident::Given;
use serde::Serialize;

use super::rosbag::Motor;

/// Where the friction comes from.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum TorqueSource {
    /// The force column is friction.
    #[default]
    Sensor,
    /// The force column drives the axis.
    Driving,
    /// The column is the motor's voltage \[V\].
    Voltage(Motor),
    /// The column is the motor's current \[A\].
    Current(Motor),
}

/// What the inertia adds to the uncertainty of the friction.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct AddedUncertainty {
    /// Its root mean square over the samples \[N or N m\].
    pub rms: f64,
    /// At the largest acceleration \[N or N m\].
    pub largest: f64,
}

impl TorqueSource {
    /// Whether the inertia must be known.
    pub fn needs_inertia(self) -> bool {
        self != Self::Sensor
    }

    /// In words.
    pub fn describe(self) -> &'static str {
        match self {
            Self::Sensor => "the torque or force column",
            Self::Driving => "the driving force less inertia times acceleration",
            Self::Voltage(_) => "the motor's voltage and speed, less inertia times acceleration",
            Self::Current(_) => "the motor's current, less inertia times acceleration",
        }
    }

    /// What drives the axis [N or N m], or the friction itself, from a sample of the column and the velocity.
    pub fn torque(self, column: f64, velocity: f64) -> f64 {
        match self {
            Self::Sensor | Self::Driving => column,
            Self::Voltage(motor) => motor.torque(column, velocity),
            Self::Current(motor) => motor.gear_ratio * motor.motor_constant * column,
        }
    }

    /// Friction from the column, the velocity and the acceleration, and what the inertia's error adds.
    pub fn friction(
        self,
        column: &[f64],
        velocity: &[f64],
        acceleration: &[f64],
        inertia: Option<Given>,
    ) -> (Vec<f64>, Option<AddedUncertainty>) {
        let driven: Vec<f64> = column.iter().zip(velocity).map(|(&c, &v)| self.torque(c, v)).collect();
        let Some(inertia) = inertia.filter(|_| self.needs_inertia()) else { return (driven, None) };
        let friction = driven.iter().zip(acceleration).map(|(t, a)| t - inertia.value * a).collect();
        let squares = acceleration.iter().map(|a| a * a).sum::<f64>() / acceleration.len().max(1) as f64;
        let largest = acceleration.iter().fold(0.0f64, |largest, a| largest.max(a.abs()));
        let added = AddedUncertainty {
            rms: inertia.standard_error * squares.sqrt(),
            largest: inertia.standard_error * largest,
        };
        (friction, Some(added))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_sources_give_the_same_friction() {
        let (inertia, friction) = (Given { value: 0.0026, standard_error: 1e-4 }, 0.09);
        let motor = Motor::default();
        let constant = motor.gear_ratio * motor.motor_constant;
        let (v, a) = (1.5, -20.0);
        let torque = friction + inertia.value * a;
        let current = torque / constant;
        let voltage = current * motor.resistance + constant * v;
        for (source, column) in [
            (TorqueSource::Sensor, friction),
            (TorqueSource::Driving, torque),
            (TorqueSource::Voltage(motor), voltage),
            (TorqueSource::Current(motor), current),
        ] {
            let (found, added) = source.friction(&[column], &[v], &[a], Some(inertia));
            assert!((found[0] - friction).abs() < 1e-14, "{source:?}");
            assert_eq!(added.is_some(), source.needs_inertia());
            assert!(added.is_none_or(|added| (added.largest - 2e-3).abs() < 1e-15));
        }
    }
}
