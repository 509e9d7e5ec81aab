//! Adaptation of the parameters that enter linearly while sliding.
//!
//! ```text
//! F^ = theta_1 C + theta_2 C exp(-(v/v_s)^2) + theta_3 v + theta_4
//! ```
//!
//! with `C` the contact's part of the model's torque, `C = F_model - f_v v`: `theta_1` scales the
//! Coulomb level, `theta_2` the rise towards the static level (the shape over velocity is the
//! model's), `theta_3` is the viscous coefficient, and `theta_4` half the difference between the
//! directions. Starting at `(1, 0, f_v, 0)` the estimate is the model's. Pre-sliding, lag and
//! memory of the model remain, scaled with the levels.

use friction_model::{AnyModel, TimeStep, TorqueSource};
use serde::{Deserialize, Serialize};

use super::{Excitation, LeastSquares, Measured, measured::check_source};
use crate::error::{positive, within};
use crate::finite::held;
use crate::velocity_estimator::LowPass;
use crate::{NominalDrive, ObserverError, Seen};

/// How the parameters are followed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ParameterOptions {
    /// Share of the feedforward estimate, from 0 to 1.
    pub share: f64,
    /// Where the friction torque comes from.
    pub source: TorqueSource,
    /// Time constant of the filters \[s\], above zero and at most 1.
    pub filter: f64,
    /// Time of sliding in which the past is forgotten to 1/e \[s\], from 0.01 to 1e4.
    pub forgetting: f64,
    /// Standard deviation of the measured torque after the filter \[N m\], above zero.
    pub noise: f64,
    /// Largest relative change of the Coulomb level, from 0 to 0.9; the rise towards the static
    /// level may change by half of it.
    pub range: f64,
    /// Largest viscous coefficient \[N m s/rad\], zero or more.
    pub most_viscous: f64,
    /// Largest offset between the directions, as a share of the model's torque at v_s, from 0 to 1.
    pub most_asymmetric: f64,
    /// Stribeck velocity for models that have none \[rad/s\], above zero.
    pub stribeck_velocity: f64,
    /// When it may learn.
    pub excitation: Excitation,
}

impl ParameterOptions {
    /// For the thesis's test bed.
    pub const SRV02: Self = Self {
        share: 0.0,
        source: TorqueSource::Voltage,
        filter: 0.03,
        forgetting: 8.0,
        noise: 0.05,
        range: 0.7,
        most_viscous: 0.15,
        most_asymmetric: 0.3,
        stribeck_velocity: 0.14,
        excitation: Excitation::SRV02,
    };

    /// Checks every field.
    ///
    /// # Errors
    /// [`ObserverError::OutOfRange`] names the field; [`ObserverError::TorqueSource`] a source that
    /// observers have not.
    pub fn check(&self) -> Result<(), ObserverError> {
        check_source(self.source)?;
        within("share", self.share, 0.0..=1.0, "from 0 to 1")?;
        positive("filter", self.filter)?;
        within("filter", self.filter, 0.0..=1.0, "above 0 and at most 1 s")?;
        within("forgetting", self.forgetting, 0.01..=1e4, "from 0.01 to 1e4 s")?;
        positive("noise", self.noise)?;
        within("range", self.range, 0.0..=0.9, "from 0 to 0.9")?;
        within("most_viscous", self.most_viscous, 0.0..=1e6, "from 0 to 1e6 N m s/rad")?;
        within("most_asymmetric", self.most_asymmetric, 0.0..=1.0, "from 0 to 1")?;
        positive("stribeck_velocity", self.stribeck_velocity)?;
        self.excitation.check()
    }
}

/// The parameters while they run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrictionParameters {
    measured: Measured,
    model: [LowPass; 3],
    estimate: LeastSquares<4>,
    inverse_stribeck_velocity: f64,
}

impl FrictionParameters {
    /// Parameters that are the model's, called once every `dt`.
    ///
    /// # Errors
    /// [`ObserverError::OutOfRange`] names the option.
    pub fn new(
        model: &AnyModel,
        options: &ParameterOptions,
        drive: &NominalDrive,
        dt: TimeStep,
    ) -> Result<Self, ObserverError> {
        options.check()?;
        drive.check()?;
        let stribeck_velocity = model.parameter("v_s").unwrap_or(options.stribeck_velocity);
        let level = held(model.steady_state(stribeck_velocity)).abs();
        let viscous = model.parameter("f_v").unwrap_or(0.0);
        let (half, offset) = (0.5 * options.range, options.most_asymmetric * level);
        let bounds = [
            (1.0 - options.range, 1.0 + options.range),
            (-half, half),
            (0.0, options.most_viscous.max(viscous)),
            (-offset, offset),
        ];
        // A deviation of zero would divide by zero: a parameter that may not move has bounds that
        // meet.
        let deviations = bounds.map(|(low, high)| (0.25 * (high - low)).max(1e-9));
        let forgetting = (-dt.seconds() / options.forgetting).exp();
        let noise = options.noise * options.noise;
        Ok(Self {
            measured: Measured::new(options.source, options.excitation, options.filter, drive, dt),
            model: [LowPass::new(options.filter, dt).at_zero(); 3],
            estimate: LeastSquares::new(
                [1.0, 0.0, viscous, 0.0],
                deviations,
                bounds,
                forgetting,
                noise,
            ),
            inverse_stribeck_velocity: 1.0 / stribeck_velocity,
        })
    }

    /// Learns from a cycle: `velocity` is the estimated one, `contact` the torque of the model that
    /// is driven by it, without its viscous part.
    #[inline]
    pub fn learn(&mut self, velocity: f64, seen: &Seen, contact: f64) {
        let Some(sample) = self.measured.take(velocity, seen, contact) else { return };
        let [contact, rise, velocity, offset] = self.regressor(held(velocity), held(contact));
        let [first, second, third] = &mut self.model;
        let regressor = [first.step(contact), second.step(rise), third.step(velocity), offset];
        if sample.rich {
            self.estimate.update(regressor, sample.torque);
        }
    }

    /// The torque \[N m\] with the parameters as they are, of a model whose contact carries
    /// `contact` \[N m\] at `velocity` \[rad/s\].
    #[inline]
    #[must_use]
    pub fn torque(&self, velocity: f64, contact: f64) -> f64 {
        let regressor = self.regressor(velocity, contact);
        regressor.iter().zip(self.estimate.parameters()).map(|(x, theta)| x * theta).sum()
    }

    #[inline]
    fn regressor(&self, velocity: f64, contact: f64) -> [f64; 4] {
        let r = velocity * self.inverse_stribeck_velocity;
        [contact, contact * (-r * r).exp(), velocity, 1.0]
    }

    /// The parameters: factor of the Coulomb level, rise towards the static level, viscous
    /// coefficient \[N m s/rad\] and offset between the directions \[N m\].
    #[must_use]
    pub fn parameters(&self) -> [f64; 4] {
        self.estimate.parameters()
    }

    /// Back to rest. What was learned stays.
    pub fn reset(&mut self) {
        self.measured.reset();
        self.model = self.model.map(LowPass::at_zero);
    }
}
