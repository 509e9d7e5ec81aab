//! What a winding bears, so that whoever drives rests before the safety layer has to stop the motor.
//!
//! How warm it is the safety layer says ([`Rig::winding_rise`](rig_driver::Rig::winding_rise)).

use rig_driver::safety::MotorThermal;

/// Share of the rise that is allowed from which on nothing is begun, and to which it cools first.
const WARM: f64 = 0.5;
const COOL: f64 = 0.3;
/// Share of it at which whatever goes on is ended.
const HOT: f64 = 0.85;

/// A winding that is watched.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Heat(pub MotorThermal);

impl Heat {
    /// The rise that is allowed \[K\].
    const fn allowed(&self) -> f64 {
        self.0.limit - self.0.ambient
    }

    /// What the motor bears at rest for ever \[V\].
    #[must_use]
    pub fn continuous(&self) -> f64 {
        (self.allowed() * self.0.armature_resistance / self.0.thermal_resistance).sqrt()
    }

    /// Voltage that a shaft at rest bears for `seconds`, begun cool \[V\].
    #[must_use]
    pub fn bearable(&self, seconds: f64) -> f64 {
        let part = 1.0 - (-seconds / self.0.time_constant).exp();
        self.continuous() * (COOL / part).sqrt()
    }

    /// Whether a winding that is `rise` \[K\] above ambient is about to be too warm.
    #[must_use]
    pub fn is_hot(&self, rise: f64) -> bool {
        rise > HOT * self.allowed()
    }

    /// Time for one that is `rise` \[K\] above ambient to rest before anything is begun \[s\].
    #[must_use]
    pub fn pause(&self, rise: f64) -> f64 {
        if rise <= WARM * self.allowed() {
            return 0.0;
        }
        self.0.time_constant * (rise / (COOL * self.allowed())).ln()
    }
}

#[cfg(test)]
mod tests {
    use rig_driver::safety::SafetyLimits;

    use super::*;

    fn heat() -> Heat {
        Heat(MotorThermal {
            armature_resistance: 2.0,
            back_emf: 0.5,
            thermal_resistance: 10.0,
            time_constant: 20.0,
            ambient: 25.0,
            limit: 105.0,
        })
    }

    /// As the safety layer has it.
    #[test]
    fn a_motor_at_its_continuous_voltage_warms_to_its_limit_and_cools_in_the_pause() {
        let volts = heat().continuous();
        assert!((volts - 4.0).abs() < 1e-12);
        let limits =
            SafetyLimits { voltage: volts, motor: Some(heat().0), ..SafetyLimits::default() };
        let rise = limits.heated_rise(0.0, 1e4);
        assert!((rise - 80.0).abs() < 1e-6 && heat().is_hot(rise), "{rise}");
        let left = limits.cooled_rise(rise, heat().pause(rise));
        assert!((left - 24.0).abs() < 1e-6 && heat().pause(left) == 0.0, "{left}");
        let volts = heat().bearable(5.0);
        let limits = SafetyLimits { voltage: volts, ..limits };
        assert!((limits.heated_rise(0.0, 5.0) - 24.0).abs() < 1e-6);
    }
}
