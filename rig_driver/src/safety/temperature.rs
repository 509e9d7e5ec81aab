//! Temperature of the winding by a model.

use super::{MotorThermal, SafetyLimits};

/// Hottest rise that is told apart \[K\]: copper has long melted.
const HOTTEST: f64 = 2000.0;

/// The winding's temperature over time. Whatever comes in, it is a finite number and never below
/// ambient: what cannot be counts as what heats most.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Winding {
    motor: MotorThermal,
    /// Largest voltage of the amplifier, and of the motor as a generator \[V\].
    voltage: f64,
    /// Above ambient \[K\].
    rise: f64,
}

impl Winding {
    /// A motor at ambient temperature behind an amplifier of `voltage` \[V\].
    pub(super) const fn new(motor: MotorThermal, voltage: f64) -> Self {
        Self { motor, voltage, rise: 0.0 }
    }

    /// Advances by `dt` \[s\] with `volts` on a shaft at `velocity` [rad/s]. The larger one of the
    /// current that was measured and the one that follows from the voltage heats.
    ///
    /// A shaft that is driven by no more than the limit cannot generate more than the limit, so no
    /// current is above twice what the limit drives through the winding at rest. A velocity that is
    /// no number counts as rest, where the motor is hottest; one beyond what the limit can reach
    /// never as cooler than that. A current that is no number counts as not measured; a step that
    /// is none, or goes backwards, as none.
    pub(super) fn advance(&mut self, dt: f64, volts: f64, velocity: f64, measured: Option<f64>) {
        if dt.is_nan() || dt <= 0.0 {
            return;
        }
        let MotorThermal {
            armature_resistance, back_emf, thermal_resistance, time_constant, ..
        } = self.motor;
        let limit = self.voltage;
        let volts = if volts.is_nan() { limit } else { volts.clamp(-limit, limit) };
        let generated = back_emf * if velocity.is_finite() { velocity } else { 0.0 };
        let within = generated.clamp(-limit, limit);
        let turning = (volts - within).abs();
        // What no motor here can do is no reason to think it cooler than at rest.
        let across = if within == generated { turning } else { turning.max(volts.abs()) };
        let modelled = across / armature_resistance;
        let largest = 2.0 * limit / armature_resistance;
        let measured = measured.filter(|current| !current.is_nan()).map_or(0.0, f64::abs);
        let current = modelled.max(measured.min(largest));
        let steady = (current * current * armature_resistance * thermal_resistance).min(HOTTEST);
        // Backward Euler: stable and monotone however long the step.
        let part = if dt.is_finite() { dt / (time_constant + dt) } else { 1.0 };
        self.rise = (self.rise + (steady - self.rise) * part).clamp(0.0, HOTTEST);
    }

    /// Temperature [degrees C].
    pub(super) fn temperature(&self) -> f64 {
        self.motor.ambient + self.rise
    }

    /// Says how warm the motor is [degrees C], as far as that is known from elsewhere.
    pub(super) fn set(&mut self, temperature: f64) {
        let rise = if temperature.is_nan() { HOTTEST } else { temperature - self.motor.ambient };
        self.rise = rise.clamp(0.0, HOTTEST);
    }

    pub(super) fn is_hot(&self) -> bool {
        self.temperature() > self.motor.limit
    }

    pub(super) fn has_cooled(&self) -> bool {
        self.temperature() < self.motor.limit - 10.0
    }
}

impl SafetyLimits {
    /// The winding's rise above ambient that is assumed where nobody knows it \[K\]: the hottest
    /// from which a motor that was too hot may go on.
    #[must_use]
    pub fn assumed_rise(&self) -> f64 {
        self.motor.map_or(0.0, |motor| (motor.limit - 10.0 - motor.ambient).max(0.0))
    }

    /// The rise that is left of `rise` \[K\] after `seconds` without a current. A time that is no
    /// number or negative cools nothing.
    #[must_use]
    pub fn cooled_rise(&self, rise: f64, seconds: f64) -> f64 {
        let seconds = if seconds > 0.0 { seconds } else { 0.0 };
        self.motor.map_or(0.0, |motor| rise * (-seconds / motor.time_constant).exp())
    }

    /// The rise \[K\] that `seconds` at the largest voltage and at rest make of `rise`.
    #[must_use]
    pub fn heated_rise(&self, rise: f64, seconds: f64) -> f64 {
        self.motor.map_or(0.0, |motor| {
            let steady = (self.voltage * self.voltage / motor.armature_resistance
                * motor.thermal_resistance)
                .min(HOTTEST);
            let left = (-seconds / motor.time_constant).exp();
            rise.max(steady + (rise - steady) * left)
        })
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn limits() -> SafetyLimits {
        SafetyLimits::default()
    }

    #[test]
    fn a_stalled_motor_warms_as_the_exponential_of_its_time_constant() {
        let motor = limits().motor.unwrap();
        let mut winding = Winding::new(motor, 6.0);
        let steady = 6.0f64.powi(2) / 2.6 * 24.0;
        for step in 1..=40_000 {
            winding.advance(1e-3, 6.0, 0.0, None);
            let t = 1e-3 * f64::from(step);
            let expected = 25.0 + steady * (1.0 - (-t / 20.0).exp());
            assert!(
                (winding.temperature() - expected).abs() < 0.02,
                "{t} s: {}",
                winding.temperature()
            );
        }
    }

    #[test]
    fn a_turning_motor_is_cooler_than_a_stalled_one_and_a_measured_current_counts_if_it_is_larger()
    {
        let motor = limits().motor.unwrap();
        let warmed = |velocity, measured| {
            let mut winding = Winding::new(motor, 6.0);
            winding.advance(1.0, 6.0, velocity, measured);
            winding.temperature()
        };
        assert!(warmed(8.0, None) < warmed(0.0, None));
        assert_eq!(warmed(0.0, Some(0.1)), warmed(0.0, None));
        assert!(warmed(0.0, Some(5.0)) > warmed(0.0, None));
    }

    /// One absurd reading made the temperature infinite, and the next one made it not a number,
    /// which is above no limit.
    #[test]
    fn an_absurd_reading_does_not_blind_the_model() {
        let mut winding = Winding::new(limits().motor.unwrap(), 6.0);
        winding.advance(1e-3, 6.0, 1e300, Some(-1e300));
        assert!(winding.temperature() < 26.0, "{}", winding.temperature());
        let mut doubtful = winding;
        for _ in 0..20_000 {
            doubtful.advance(1e-3, 6.0, 1e6, None);
        }
        assert!(doubtful.is_hot(), "a tachometer that shows nonsense does not cool the motor");
        for _ in 0..20_000 {
            winding.advance(1e-3, 6.0, 0.0, None);
        }
        assert!(winding.is_hot());
    }

    #[test]
    fn what_is_not_known_is_assumed_warm_and_cools_by_its_time_constant() {
        let limits = limits();
        assert_eq!(limits.assumed_rise(), 65.0);
        assert!((limits.cooled_rise(65.0, 20.0) - 65.0 / std::f64::consts::E).abs() < 1e-9);
        for wrong in [f64::NAN, -5.0] {
            assert_eq!(limits.cooled_rise(65.0, wrong), 65.0);
        }
        assert!(limits.heated_rise(10.0, 2.0) > 35.0 && limits.heated_rise(500.0, 2.0) == 500.0);
        let mut winding = Winding::new(limits.motor.unwrap(), 6.0);
        winding.set(f64::NAN);
        assert!(winding.is_hot());
        winding.set(-300.0);
        assert_eq!(winding.temperature(), 25.0);
    }

    fn anything() -> impl Strategy<Value = f64> {
        prop_oneof![
            4 => -10.0..10.0,
            1 => any::<f64>(),
            1 => prop::sample::select(vec![f64::NAN, f64::INFINITY, -f64::INFINITY, f64::MAX, 5e-324, -0.0]),
        ]
    }

    proptest! {
        #[test]
        fn no_reading_makes_the_winding_cooler_than_ambient_or_no_number(
            steps in prop::collection::vec((anything(), anything(), anything(), prop::option::of(anything())), 1..50)
        ) {
            let motor = limits().motor.unwrap();
            let mut winding = Winding::new(motor, 6.0);
            winding.set(80.0);
            for (dt, volts, velocity, measured) in steps {
                let before = winding.temperature();
                winding.advance(dt, volts, velocity, measured);
                let now = winding.temperature();
                prop_assert!(now.is_finite() && now >= motor.ambient, "{now}");
                // It cools no faster than without any current.
                let left = if dt > 0.0 { motor.time_constant / (motor.time_constant + dt) } else { 1.0 };
                prop_assert!(now - motor.ambient >= (before - motor.ambient) * left - 1e-9, "{before} to {now}");
            }
        }
    }
}
