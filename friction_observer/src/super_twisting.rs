//! Sliding mode of second order: the super-twisting law beside a linear controller (Levant 1993;
//! its Lyapunov function and gains: Moreno and Osorio 2012; Levant 2003).
//!
//! ```text
//! s   = (w - w_r) + c e
//! F^  = J (-k_1 |s|^(1/2) sign s + z),     z' = -k_2 sign s
//! k_1 = 1.5 L^(1/2),   k_2 = 1.1 L,   L = (largest |dF/dt|) / J
//! ```
//!
//! `e` is the controlled error with the weight `c`, zero in a loop of velocity, `J` the inertia of
//! the nominal drive. Whatever friction does within that rate, `s` comes to zero in finite time,
//! without a model. A reversal is faster than any rate: there `s` leaves zero and comes back.
//!
//! # In steps
//!
//! Taken forward, the law chatters: the root has no bound on its slope at zero. Here the root is
//! taken where it will be after a time `h`, the horizon, as implicit steps take it (Polyakov,
//! Efimov, Brogliato 2019; Brogliato, Polyakov, Efimov 2020):
//!
//! ```text
//! x^2 + h k_1 x = |s|,     -k_1 x sign s     in place of     -k_1 |s|^(1/2) sign s
//! z' = -k_2 sat(s / (h^2 k_2))
//! ```
//!
//! With `h` of one period this is their step, but for `z`, which keeps its own law so that constant
//! friction leaves no `s`. A longer `h` is softer. For a small `s` the whole is a PI of gain `J/h`
//! and `J/h^2`: what delay and noise make of it is what they make of that PI. For a large one it is
//! the law above. It does not chatter by itself; it multiplies noise by at most `J/h`.

use ::parameters::{ValueRange, parameters};
use friction_model::TimeStep;

use crate::finite::believed;
use crate::{NominalDrive, ObserverError};

parameters! {
    /// What a super-twisting compensator is made of.
    #[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
    #[serde(deny_unknown_fields)]
    pub struct SuperTwistingOptions {
        slope: f64, "Weight of the controlled error in the sliding variable",
            more("zero in a velocity loop"), unit("1/s"), range(ValueRange::Double(0.0, 10_000.0));
        rate: f64, "Fastest change of friction that is followed", unit("N m/s"),
            range(ValueRange::POSITIVE);
        horizon: f64, "Time within which a small deviation is taken back, at least a period",
            unit("s"), range(ValueRange::Double(0.0001, 1.0));
        limit: f64, "Largest magnitude of its estimate", unit("N m"),
            range(ValueRange::POSITIVE);
    }
}

impl SuperTwistingOptions {
    /// For the velocity loop of the thesis's test bed.
    pub const SRV02: Self = Self { slope: 0.0, rate: 5.0, horizon: 0.008, limit: 0.3 };

    /// For its position loop.
    pub const SRV02_POSITION: Self = Self { slope: 20.0, ..Self::SRV02 };
}

/// Factors of the two gains (Levant 2003).
const FIRST: f64 = 1.5;
const SECOND: f64 = 1.1;

/// A super-twisting compensator running at a fixed period.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SuperTwisting {
    slope: f64,
    /// Both gains, `k_1` \[rad^(1/2)/s^(3/2)\] and `k_2` [rad/s^3].
    gains: (f64, f64),
    horizon: f64,
    inertia: f64,
    /// Largest magnitude of `F^ / J` [rad/s^2].
    most: f64,
    dt: f64,
    /// The integral z [rad/s^2].
    integral: f64,
}

impl SuperTwisting {
    /// A compensator at rest, called once every `dt`.
    ///
    /// # Errors
    /// [`ObserverError::OutOfRange`] names the option.
    pub fn new(
        options: &SuperTwistingOptions,
        drive: &NominalDrive,
        dt: TimeStep,
    ) -> Result<Self, ObserverError> {
        options.check()?;
        drive.check()?;
        let inertia = drive.inertia();
        let most_rate = options.rate / inertia;
        Ok(Self {
            slope: options.slope,
            gains: (FIRST * most_rate.sqrt(), SECOND * most_rate),
            horizon: options.horizon.max(dt.seconds()),
            inertia,
            most: options.limit / inertia,
            dt: dt.seconds(),
            integral: 0.0,
        })
    }

    /// What it takes for friction now \[N m\], from the velocity's and the controlled `error`, both
    /// measured minus wanted. What is not finite is not believed: the torque is zero then and the
    /// integral stays.
    #[inline]
    pub fn observe(&mut self, velocity_error: f64, error: f64) -> f64 {
        let (Some(fast), Some(off)) = (believed(velocity_error), believed(error)) else {
            return 0.0;
        };
        let s = fast + self.slope * off;
        let (first, second) = self.gains;
        // The root where it will be after the horizon; of the two forms of the solution the one
        // that does not cancel.
        let b = self.horizon * first;
        let x = 2.0 * s.abs() / (b + (b * b + 4.0 * s.abs()).sqrt());
        let side = (s / (self.horizon * self.horizon * second)).clamp(-1.0, 1.0);
        self.integral = (self.integral - self.dt * second * side).clamp(-self.most, self.most);
        let asked = self.integral - first * x * s.signum();
        self.inertia * asked.clamp(-self.most, self.most)
    }

    /// Back to rest.
    pub const fn reset(&mut self) {
        self.integral = 0.0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn compensator(options: SuperTwistingOptions) -> SuperTwisting {
        SuperTwisting::new(&options, &NominalDrive::SRV02, TimeStep::new(1e-3).unwrap()).unwrap()
    }

    /// `J w' = F^ - F` with friction within the rate: the deviation after half a second.
    fn deviation(options: SuperTwistingOptions, friction: impl Fn(f64) -> f64) -> f64 {
        let mut running = compensator(options);
        let (mut w, mut last) = (0.0f64, 0.0f64);
        for k in 0..3000u32 {
            let torque = running.observe(w, 0.0);
            w += 1e-3 / NominalDrive::SRV02.inertia() * (torque - friction(1e-3 * f64::from(k)));
            if k > 500 {
                last = last.max(w.abs());
            }
        }
        last
    }

    #[test]
    fn friction_within_the_rate_is_taken_away_without_a_model() {
        let options = SuperTwistingOptions { horizon: 0.002, ..SuperTwistingOptions::SRV02 };
        assert!(deviation(options, |_| 0.09) < 1e-9, "constant friction leaves nothing");
        // Its fastest change is 2 N m/s of 5.
        let left = deviation(options, |t| 0.1 * (20.0 * t).sin());
        let alone = 0.1 / (20.0 * NominalDrive::SRV02.inertia());
        assert!(left < 0.01 * alone, "{left} of {alone}");
    }

    #[test]
    fn it_does_not_chatter_in_steps() {
        let mut running =
            compensator(SuperTwistingOptions { horizon: 1e-3, ..SuperTwistingOptions::SRV02 });
        let (mut w, mut before) = (0.3, 0.0);
        for k in 0..2000 {
            let torque = running.observe(w, 0.0);
            w += 1e-3 / NominalDrive::SRV02.inertia() * (torque - 0.05);
            if k > 1000 {
                assert!((torque - before).abs() < 1e-9, "{k}: {torque} after {before}");
            }
            before = torque;
        }
    }

    #[test]
    fn near_zero_it_is_the_pi_that_its_page_says() {
        let options = SuperTwistingOptions::SRV02;
        let (h, j) = (options.horizon, NominalDrive::SRV02.inertia());
        let mut running = compensator(options);
        let s = 1e-9;
        let first = running.observe(s, 0.0);
        let second = running.observe(s, 0.0);
        assert!((first / (-j * s * (1.0 / h + 1e-3 / (h * h))) - 1.0).abs() < 1e-4);
        assert!(((second - first) / (-j * s * 1e-3 / (h * h)) - 1.0).abs() < 1e-4);
    }
}
