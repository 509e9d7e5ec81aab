//! The disturbance observer: friction as whatever the nominal drive does not explain (Ohnishi 1987;
//! Ohnishi, Shibata and Murakami 1996).
//!
//! ```text
//! F^ = Q(s) (u - P^-1(s) w) / r,     P(s) = K / (T s + 1),     Q(s) = 1 / (s/b + 1)^n
//! ```
//!
//! It knows no friction model, follows anything slower than `b`, and lags: a step of friction is
//! followed as by `Q`. Fed back, it acts as an integrator of about `b/s` beside the linear
//! controller: it is more gain, and amplifies the velocity's noise as gain does.

use ::parameters::{ValueRange, choices, parameters};
use friction_model::TimeStep;
use serde::{Deserialize, Serialize};

use crate::velocity_estimator::LowPass;
use crate::{DriveInverse, NominalDrive, ObserverError};

/// Order of the filter Q.
#[derive(
    Debug,
    Clone,
    Copy,
    PartialEq,
    Eq,
    Default,
    Serialize,
    Deserialize,
    strum::EnumString,
    strum::IntoStaticStr,
    strum::VariantNames,
)]
#[serde(rename_all = "snake_case")]
#[strum(serialize_all = "snake_case")]
pub enum FilterOrder {
    /// `1 / (s/b + 1)`.
    First,
    /// `1 / (s/b + 1)^2`: less noise, more lag.
    #[default]
    Second,
}

choices!(FilterOrder);

parameters! {
    /// What a disturbance observer is made of.
    #[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
    #[serde(deny_unknown_fields)]
    pub struct DisturbanceObserverOptions {
        bandwidth: f64, "Bandwidth of the disturbance observer's filter", unit("rad/s"),
            range(ValueRange::Double(0.1, 10_000.0));
        order: FilterOrder, "Order of its filter";
        limit: f64, "Largest magnitude of its estimate", unit("N m"),
            range(ValueRange::POSITIVE);
    }
}

impl DisturbanceObserverOptions {
    /// For the thesis's test bed with its tachometer.
    pub const SRV02: Self = Self { bandwidth: 100.0, order: FilterOrder::Second, limit: 1.0 };
}

/// A disturbance observer running at a fixed period.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DisturbanceObserver {
    inverse: DriveInverse,
    filters: [LowPass; 2],
    order: FilterOrder,
    limit: f64,
}

impl DisturbanceObserver {
    /// An observer at rest, called once every `dt`.
    ///
    /// # Errors
    /// [`ObserverError::OutOfRange`] names the option.
    pub fn new(
        options: &DisturbanceObserverOptions,
        drive: &NominalDrive,
        dt: TimeStep,
    ) -> Result<Self, ObserverError> {
        options.check()?;
        drive.check()?;
        let filter = LowPass::new(1.0 / options.bandwidth, dt).at_zero();
        Ok(Self {
            inverse: DriveInverse::new(drive, dt),
            filters: [filter; 2],
            order: options.order,
            limit: options.limit,
        })
    }

    /// The friction now \[N m\], from the `velocity` \[rad/s\] and the `voltage` \[V\] applied
    /// since the last call. Readings that are not finite are not believed: the torque is zero then,
    /// and the filters stay where they are.
    #[inline]
    pub fn observe(&mut self, velocity: f64, voltage: f64) -> f64 {
        let raw = self.inverse.torque(velocity, voltage);
        if !(velocity.is_finite() && voltage.is_finite()) {
            return 0.0;
        }
        let [first, second] = &mut self.filters;
        let once = match raw {
            Some(torque) => first.step(torque),
            None => first.output().unwrap_or(0.0),
        };
        let estimate = match self.order {
            FilterOrder::First => once,
            FilterOrder::Second => second.step(once),
        };
        estimate.clamp(-self.limit, self.limit)
    }

    /// Back to rest.
    pub fn reset(&mut self) {
        self.inverse.reset();
        self.filters = self.filters.map(LowPass::at_zero);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The nominal drive, started at rest, under a step of friction: the estimate is the step
    /// response of Q.
    fn step_response(order: FilterOrder, gain_error: f64) -> Vec<f64> {
        let drive = NominalDrive::SRV02;
        let dt = TimeStep::new(1e-3).unwrap();
        let options = DisturbanceObserverOptions { bandwidth: 50.0, order, limit: 1.0 };
        let believed = NominalDrive { gain: drive.gain * gain_error, ..drive };
        let mut observer = DisturbanceObserver::new(&options, &believed, dt).unwrap();
        let decay = (-1e-3 / drive.time_constant).exp();
        let mut w = 0.0;
        observer.observe(w, 0.0);
        (0..300)
            .map(|_| {
                let volts = 1.0;
                w = decay * w
                    + (1.0 - decay) * drive.gain * (volts - drive.volts_per_newton_metre * 0.1);
                observer.observe(w, volts)
            })
            .collect()
    }

    #[test]
    fn a_step_of_friction_comes_through_the_filter_and_nothing_else() {
        for (order, response) in [
            (FilterOrder::First, (|x: f64| 1.0 - (-x).exp()) as fn(f64) -> f64),
            (FilterOrder::Second, |x: f64| 1.0 - (1.0 + x) * (-x).exp()),
        ] {
            for (k, estimate) in (1u32..).zip(step_response(order, 1.0)) {
                let expected = 0.1 * response(50.0 * 1e-3 * f64::from(k));
                assert!(
                    (estimate - expected).abs() < 0.003,
                    "{order:?}, {k}: {estimate}, not {expected}"
                );
            }
        }
    }

    /// A wrong gain shows as friction that is not there: `w (1/K^ - 1/K) / r` in a steady state.
    #[test]
    fn an_error_of_the_gain_shows_as_friction() {
        let drive = NominalDrive::SRV02;
        let w = drive.gain * (1.0 - drive.volts_per_newton_metre * 0.1);
        let expected = 0.1 + w * (1.0 - 1.0 / 1.1) / drive.gain / drive.volts_per_newton_metre;
        let estimate = *step_response(FilterOrder::First, 1.1).last().unwrap();
        assert!((estimate - expected).abs() < 1e-4, "{estimate}, not {expected}");
    }
}
