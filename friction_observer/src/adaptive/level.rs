//! Adaptation of the friction level: one factor on the model's torque.
//!
//! `F^ = theta F_model`, `theta` by recursive least squares of the measured friction torque on the
//! model's, both through the same filter.

use friction_model::{TimeStep, TorqueSource};
use serde::{Deserialize, Serialize};

use super::{Excitation, LeastSquares, Measured, measured::check_source};
use crate::error::{positive, within};
use crate::finite::held;
use crate::velocity_estimator::LowPass;
use crate::{NominalDrive, ObserverError, Seen};

/// How the friction level is followed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LevelOptions {
    /// Share of the feedforward estimate in the torque that the factor multiplies, from 0 to 1.
    pub share: f64,
    /// Where the friction torque comes from.
    pub source: TorqueSource,
    /// Time constant of the filters \[s\], above zero and at most 1.
    pub filter: f64,
    /// Time of sliding in which the past is forgotten to 1/e \[s\], from 0.01 to 1e4.
    pub forgetting: f64,
    /// Standard deviation of the measured torque after the filter \[N m\], above zero.
    pub noise: f64,
    /// Standard deviation of the factor at the start, which it may never exceed, above zero.
    pub deviation: f64,
    /// Lowest factor, above zero.
    pub lowest: f64,
    /// Highest factor, at least the lowest and at most 10.
    pub highest: f64,
    /// Factor at the start, between lowest and highest.
    pub start: f64,
    /// When it may learn.
    pub excitation: Excitation,
}

impl LevelOptions {
    /// For the thesis's test bed.
    pub const SRV02: Self = Self {
        share: 0.0,
        source: TorqueSource::Voltage,
        filter: 0.03,
        forgetting: 2.0,
        noise: 0.05,
        deviation: 0.3,
        lowest: 0.3,
        highest: 2.0,
        start: 1.0,
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
        positive("deviation", self.deviation)?;
        positive("lowest", self.lowest)?;
        within("highest", self.highest, self.lowest..=10.0, "at least `lowest` and at most 10")?;
        within("start", self.start, self.lowest..=self.highest, "between `lowest` and `highest`")?;
        self.excitation.check()
    }
}

/// The friction level while it runs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrictionLevel {
    measured: Measured,
    model: LowPass,
    estimate: LeastSquares<1>,
}

impl FrictionLevel {
    /// A level that is what the model says times `start`, called once every `dt`.
    ///
    /// # Errors
    /// [`ObserverError::OutOfRange`] names the option.
    pub fn new(
        options: &LevelOptions,
        drive: &NominalDrive,
        dt: TimeStep,
    ) -> Result<Self, ObserverError> {
        options.check()?;
        drive.check()?;
        let forgetting = (-dt.seconds() / options.forgetting).exp();
        let bounds = [(options.lowest, options.highest)];
        let noise = options.noise * options.noise;
        Ok(Self {
            measured: Measured::new(options.source, options.excitation, options.filter, drive, dt),
            model: LowPass::new(options.filter, dt).at_zero(),
            estimate: LeastSquares::new(
                [options.start],
                [options.deviation],
                bounds,
                forgetting,
                noise,
            ),
        })
    }

    /// Learns from a cycle: `velocity` is the estimated one, `model_torque` the torque of the model
    /// that is driven by it.
    #[inline]
    pub fn learn(&mut self, velocity: f64, seen: &Seen, model_torque: f64) {
        let Some(sample) = self.measured.take(velocity, seen, model_torque) else { return };
        let model = self.model.step(held(model_torque));
        if sample.rich {
            self.estimate.update([model], sample.torque);
        }
    }

    /// The factor.
    #[inline]
    #[must_use]
    pub fn factor(&self) -> f64 {
        let [factor] = self.estimate.parameters();
        factor
    }

    /// Back to rest. What was learned stays.
    pub fn reset(&mut self) {
        self.measured.reset();
        self.model = self.model.at_zero();
    }
}
