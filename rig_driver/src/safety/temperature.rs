//! Temperature of the winding by a model.

use super::MotorThermal;

/// The winding's temperature over time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Winding {
    motor: MotorThermal,
    /// Above ambient [K].
    rise: f64,
}

impl Winding {
    pub(super) const fn new(motor: MotorThermal) -> Self {
        Self { motor, rise: 0.0 }
    }

    /// Advances by `dt` [s] with `volts` on a shaft at `velocity` [rad/s]. The larger one of the current that was measured and the one
    /// that follows from the voltage heats.
    pub(super) fn advance(&mut self, dt: f64, volts: f64, velocity: f64, measured: Option<f64>) {
        let MotorThermal { armature_resistance, back_emf, thermal_resistance, time_constant, .. } =
            self.motor;
        let modelled = ((volts - back_emf * velocity) / armature_resistance).abs();
        let current = measured.map_or(modelled, |current| modelled.max(current.abs()));
        let steady = current * current * armature_resistance * thermal_resistance;
        // Backward Euler: stable and monotone however long the step.
        self.rise += (steady - self.rise) * dt / (time_constant + dt);
    }

    /// Temperature [degrees C].
    pub(super) fn temperature(&self) -> f64 {
        self.motor.ambient + self.rise
    }

    pub(super) fn is_hot(&self) -> bool {
        self.temperature() > self.motor.limit
    }

    pub(super) fn has_cooled(&self) -> bool {
        self.temperature() < self.motor.limit - 10.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::safety::SafetyLimits;

    #[test]
    fn a_stalled_motor_warms_as_the_exponential_of_its_time_constant() {
        let motor = SafetyLimits::default().motor.unwrap();
        let mut winding = Winding::new(motor);
        let steady = 6.0f64.powi(2) / 2.6 * 24.0;
        for step in 1..=40_000 {
            winding.advance(1e-3, 6.0, 0.0, None);
            let t = 1e-3 * f64::from(step);
            let expected = 25.0 + steady * (1.0 - (-t / 20.0).exp());
            assert!((winding.temperature() - expected).abs() < 0.02, "{t} s: {}", winding.temperature());
        }
    }

    #[test]
    fn a_turning_motor_is_cooler_than_a_stalled_one_and_a_measured_current_counts_if_it_is_larger() {
        let motor = SafetyLimits::default().motor.unwrap();
        let warmed = |velocity, measured| {
            let mut winding = Winding::new(motor);
            winding.advance(1.0, 6.0, velocity, measured);
            winding.temperature()
        };
        assert!(warmed(8.0, None) < warmed(0.0, None));
        assert_eq!(warmed(0.0, Some(0.1)), warmed(0.0, None));
        assert!(warmed(0.0, Some(5.0)) > warmed(0.0, None));
    }
}
