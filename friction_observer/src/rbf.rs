//! A compensator that learns the friction-speed curve while it runs: a network of radial basis
//! functions with weights adapted on line.
//!
//! ```text
//! F^(v)  = s(v) sum_i w_i b_i(v),     b_i = h_i / sum h,     h_i = exp(-(|v| - c_i)^2 / (2 d_i^2))
//! on the side of v w'     = g e phi_f / (1/4 + |phi_f|^2) - g sigma |e| w,     e = F_f - w .
//! phi_f,   while |e| > dead zone
//! ```
//!
//! `F` is the friction torque through the inverse of the nominal drive, `phi_i = s b_i`, and the
//! index f means through the same low-pass filter, so that curve and measurement are compared at
//! the same delay (filtered regressor). Fixed centres on both sides of zero: each direction learns
//! its own curve. `s(v) = sat(v/v_0)` replaces the sign. The law is the normalised gradient with
//! dead zone, e-modification (Narendra and Annaswamy 1987) and projection onto a bound: weights
//! stay within it whatever the data. Trained networks with other centres are
//! `friction_model::RbfNetwork`.
//!
//! It needs no friction model and no identification; it compensates nothing until it has been at a
//! speed, and it knows no pre-sliding.

use friction_model::TimeStep;
use serde::{Deserialize, Serialize};

use crate::error::{positive, within};
use crate::finite::believed;
use crate::velocity_estimator::LowPass;
use crate::{DriveInverse, NominalDrive, ObserverError};

/// Centres on each side.
const BELLS: usize = 8;

/// Speeds on which the bells are centred \[rad/s\].
const CENTRES: [f64; BELLS] = [0.0, 0.06, 0.14, 0.28, 0.55, 1.1, 2.2, 4.4];

/// What a learning compensator is made of.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RbfOptions {
    /// Rate g of learning \[1/s\], above zero and at most 100.
    pub rate: f64,
    /// Leakage sigma of the weights \[1/(N m)\], zero or more.
    pub leakage: f64,
    /// Errors up to this magnitude teach nothing \[N m\], zero or more.
    pub dead_zone: f64,
    /// Largest magnitude of a weight, and of the estimate \[N m\], above zero.
    pub limit: f64,
    /// Speed v_0 up to which the sign is smoothed \[rad/s\], above zero.
    pub smooth_speed: f64,
    /// Slowest speed at which something is learned \[rad/s\], above zero; well above the velocity's
    /// noise.
    pub slowest: f64,
    /// Time constant of the filters of measurement and regressor \[s\], above zero.
    pub filter: f64,
    /// Share of the reference's velocity in the velocity at which the curve is read, from 0 to 1.
    /// Learning always uses the shaft's own.
    pub share: f64,
}

impl RbfOptions {
    /// For the thesis's test bed.
    pub const SRV02: Self = Self {
        rate: 10.0,
        leakage: 0.02,
        dead_zone: 0.002,
        limit: 0.5,
        smooth_speed: 0.01,
        slowest: 0.02,
        filter: 0.01,
        share: 1.0,
    };

    /// Checks every field.
    ///
    /// # Errors
    /// [`ObserverError::OutOfRange`] names the field.
    pub fn check(&self) -> Result<(), ObserverError> {
        positive("rate", self.rate)?;
        within("rate", self.rate, 0.0..=100.0, "above 0 and at most 100 1/s")?;
        within("leakage", self.leakage, 0.0..=1e3, "from 0 to 1e3 1/(N m)")?;
        within("dead_zone", self.dead_zone, 0.0..=1e3, "from 0 to 1e3 N m")?;
        positive("limit", self.limit)?;
        positive("smooth_speed", self.smooth_speed)?;
        positive("slowest", self.slowest)?;
        positive("filter", self.filter)?;
        within("share", self.share, 0.0..=1.0, "from 0 to 1")
    }
}

/// A learning compensator at a fixed period. It starts with all weights zero.
#[derive(Debug, Clone)]
pub struct RbfCompensator {
    options: RbfOptions,
    dt: f64,
    inverse: DriveInverse,
    torque: LowPass,
    regressor: [[LowPass; BELLS]; 2],
    weights: [[f64; BELLS]; 2],
}

impl RbfCompensator {
    /// A compensator that has learned nothing, called once every `dt`.
    ///
    /// # Errors
    /// [`ObserverError::OutOfRange`] names the option.
    pub fn new(
        options: &RbfOptions,
        drive: &NominalDrive,
        dt: TimeStep,
    ) -> Result<Self, ObserverError> {
        options.check()?;
        drive.check()?;
        let filter = LowPass::new(options.filter, dt).at_zero();
        Ok(Self {
            options: *options,
            dt: dt.seconds(),
            inverse: DriveInverse::new(drive, dt),
            torque: filter,
            regressor: [[filter; BELLS]; 2],
            weights: [[0.0; BELLS]; 2],
        })
    }

    /// The friction now \[N m\], learned from the `velocity` \[rad/s\] and the `voltage` \[V\]
    /// applied since the last call, and read at a velocity between it and that of the reference.
    /// Readings that are not finite are not believed: the torque is zero then, and the weights
    /// stay.
    #[inline]
    pub fn observe(&mut self, velocity: f64, reference_velocity: f64, voltage: f64) -> f64 {
        let raw = self.inverse.torque(velocity, voltage);
        let Some(velocity) = believed(velocity) else { return 0.0 };
        if let Some(torque) = raw {
            self.learn(velocity, torque);
        }
        let asked = believed(reference_velocity).unwrap_or(velocity);
        let read_at = velocity + self.options.share * (asked - velocity);
        let (side, sign) = self.side(read_at);
        let (bells, total) = bells(read_at.abs());
        let weights = self.weights.get(side).unwrap_or(&[0.0; BELLS]);
        let sum: f64 = weights.iter().zip(&bells).map(|(w, b)| w * b).sum();
        (sign * sum / total).clamp(-self.options.limit, self.options.limit)
    }

    /// One step of the gradient law.
    #[inline]
    fn learn(&mut self, velocity: f64, torque: f64) {
        let (side, sign) = self.side(velocity);
        let (bells, total) = bells(velocity.abs());
        let measured = self.torque.step(torque);
        let (mut predicted, mut square) = (0.0, 0.0);
        for (i, (filters, weights)) in self.regressor.iter_mut().zip(&self.weights).enumerate() {
            let here = if i == side { sign / total } else { 0.0 };
            for ((filter, weight), bell) in filters.iter_mut().zip(weights).zip(&bells) {
                let regressor = filter.step(here * bell);
                predicted += weight * regressor;
                square += regressor * regressor;
            }
        }
        let error = measured - predicted;
        let RbfOptions { rate, leakage, dead_zone, limit, slowest, .. } = self.options;
        if error.abs() <= dead_zone || velocity.abs() < slowest {
            return;
        }
        // What exceeds the dead zone, cut to the bound: no reading moves the weights by more than a
        // reading that is possible.
        let beyond = (error - dead_zone.copysign(error)).clamp(-limit, limit);
        let gain = self.dt * rate;
        let leak = 1.0 - (gain * leakage * beyond.abs()).min(1.0);
        for (filters, weights) in self.regressor.iter().zip(&mut self.weights) {
            for (filter, weight) in filters.iter().zip(weights) {
                let regressor = filter.output().unwrap_or(0.0);
                let step = gain * beyond * regressor / (0.25 + square);
                *weight = (leak * *weight + step).clamp(-limit, limit);
            }
        }
    }

    /// Which side a velocity belongs to, and its smoothed sign.
    #[inline]
    fn side(&self, velocity: f64) -> (usize, f64) {
        (usize::from(velocity < 0.0), (velocity / self.options.smooth_speed).clamp(-1.0, 1.0))
    }

    /// The weights [N m]: first those of forward motion, then those of backward motion, by speed.
    #[must_use]
    pub const fn weights(&self) -> &[[f64; BELLS]; 2] {
        &self.weights
    }

    /// Back to rest. What was learned stays.
    pub fn reset(&mut self) {
        self.inverse.reset();
        let filter = self.torque.at_zero();
        self.torque = filter;
        self.regressor = [[filter; BELLS]; 2];
    }
}

/// The bells at a speed, and their sum, which is above zero.
#[inline]
fn bells(speed: f64) -> ([f64; BELLS], f64) {
    let mut bells = [0.0; BELLS];
    let last = CENTRES[BELLS - 1];
    let mut total = 0.0;
    for (i, (bell, centre)) in bells.iter_mut().zip(&CENTRES).enumerate() {
        // Centres are about a factor of two apart: a width that grows with the speed lets
        // neighbours overlap alike.
        let width = if i == 0 { 0.03 } else { 0.35 * centre };
        let r = (speed.min(last) - centre) / width;
        *bell = (-0.5 * r * r).exp();
        total += *bell;
    }
    (bells, total)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn compensator() -> RbfCompensator {
        RbfCompensator::new(&RbfOptions::SRV02, &NominalDrive::SRV02, TimeStep::new(1e-3).unwrap())
            .unwrap()
    }

    /// Drives the nominal drive under `friction`, and lets the compensator watch.
    fn watch(compensator: &mut RbfCompensator, friction: impl Fn(f64) -> f64, seconds: u32) {
        let drive = NominalDrive::SRV02;
        let decay = (-1e-3 / drive.time_constant).exp();
        let mut w: f64 = 0.0;
        for k in 0..1000 * seconds {
            let volts = 1.5 * (0.9e-3 * f64::from(k)).sin();
            compensator.observe(w, w, volts);
            let push = volts - drive.volts_per_newton_metre * friction(w);
            w = decay * w + (1.0 - decay) * drive.gain * push;
        }
    }

    #[test]
    fn it_learns_the_curve_of_each_direction() {
        let friction =
            |v: f64| if v > 0.0 { 0.09 + 0.04 * v } else { 0.04 * v - 0.06 } * (v.abs() / 0.02).min(1.0);
        let mut compensator = compensator();
        watch(&mut compensator, friction, 60);
        for v in [0.1, 0.3, 0.8, 1.2, -0.1, -0.3, -0.8, -1.2] {
            let mut still = compensator.clone();
            let learned = still.observe(v, v, 0.0);
            assert!(
                (learned - friction(v)).abs() < 0.006,
                "at {v} rad/s: {learned}, not {}",
                friction(v)
            );
        }
    }

    #[test]
    fn the_weights_stay_within_their_bound_whatever_is_seen() {
        let mut compensator = compensator();
        for k in 0..50_000u32 {
            let v = if k.is_multiple_of(2) { 3.0 } else { -1e300 };
            let torque =
                compensator.observe(v, f64::NAN, [6.0, 1e300, f64::INFINITY][k as usize % 3]);
            assert!(torque.abs() <= 0.5);
        }
        assert!(compensator.weights().iter().flatten().all(|w| w.abs() <= 0.5));
    }

    #[test]
    fn at_rest_it_learns_nothing() {
        let mut compensator = compensator();
        watch(&mut compensator, |v: f64| 0.09 * (v / 0.02).clamp(-1.0, 1.0), 20);
        let before = *compensator.weights();
        // Noise of the tachometer at rest, with a voltage that the held shaft does not follow.
        for k in 0..60_000u32 {
            let noise = 0.009 * (f64::from(k) * 2.399).sin();
            compensator.observe(noise, 0.0, 0.3);
        }
        assert_eq!(before, *compensator.weights());
    }
}
