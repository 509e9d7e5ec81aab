//! Adaptation of the pre-sliding stiffness, which enters nonlinearly, by a gradient law over models
//! side by side.
//!
//! Three observers of the same model follow the same velocity: softer by a factor `s`, as given,
//! and stiffer by `s`. At the position `p` between -1 and 1 on the logarithm of the stiffness the
//! estimate is the interpolation between its neighbours,
//!
//! ```text
//! F^(p)  = F_0 + |p| (F_(sgn p) - F_0)
//! p'     = g e S / (n^2 + S^2),     S = d F^ / d p,     e = F_f - F^_f
//! ```
//!
//! all signals through the same filter. The normalised gradient is bounded, `p` is projected onto
//! [-1, 1], and where the stiffness does not matter (gross sliding) `S` vanishes and `p` stands
//! still. Interpolating the torques in place of the states keeps every model's own invariants: the
//! estimate is a mean of valid ones.

use friction_model::{AnyModel, TimeStep, TorqueSource, Unit};
use serde::{Deserialize, Serialize};

use super::{Measured, measured::check_source};
use crate::error::{positive, within};
use crate::finite::held;
use crate::velocity_estimator::LowPass;
use crate::{FrictionObserver, NominalDrive, ObserverError, Seen};

/// How the stiffness is followed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StiffnessOptions {
    /// Factor s between neighbouring models, above 1 and at most 10.
    pub span: f64,
    /// Rate g of the gradient law \[1/s\], above zero and at most 100.
    pub rate: f64,
    /// Sensitivity n that counts as weak \[N m\], above zero.
    pub weak: f64,
    /// Errors up to this magnitude teach nothing \[N m\], zero or more.
    pub dead_zone: f64,
    /// Slowest smoothed speed from which it learns \[rad/s\], above zero.
    pub slowest: f64,
    /// Time constant of the filters \[s\], above zero and at most 1.
    pub filter: f64,
    /// Where the friction torque comes from.
    pub source: TorqueSource,
}

impl StiffnessOptions {
    /// For the thesis's test bed.
    pub const SRV02: Self = Self {
        span: 2.0,
        rate: 2.0,
        weak: 0.02,
        dead_zone: 0.002,
        slowest: 0.005,
        filter: 0.03,
        source: TorqueSource::Voltage,
    };

    /// Checks every field.
    ///
    /// # Errors
    /// [`ObserverError::OutOfRange`] names the field; [`ObserverError::TorqueSource`] a source that
    /// observers have not.
    pub fn check(&self) -> Result<(), ObserverError> {
        check_source(self.source)?;
        within("span", self.span, 1.01..=10.0, "from 1.01 to 10")?;
        positive("rate", self.rate)?;
        within("rate", self.rate, 0.0..=100.0, "above 0 and at most 100 1/s")?;
        positive("weak", self.weak)?;
        within("dead_zone", self.dead_zone, 0.0..=1e3, "from 0 to 1e3 N m")?;
        positive("slowest", self.slowest)?;
        positive("filter", self.filter)?;
        within("filter", self.filter, 0.0..=1.0, "above 0 and at most 1 s")
    }
}

/// The model with every stiffness multiplied and every breakaway deflection divided by `factor`, as
/// far as it has any and accepts it.
fn stiffened(model: &AnyModel, factor: f64) -> AnyModel {
    let parameters = model.parameters();
    parameters.table().iter().fold(*model, |model, row| {
        let changed = match row.unit {
            Unit::Stiffness => model.scaled(row.name, factor),
            Unit::Deflection => model.scaled(row.name, 1.0 / factor),
            _ => return model,
        };
        changed.unwrap_or(model)
    })
}

/// The stiffness while it runs: two models beside the one that the estimator has.
#[derive(Debug, Clone)]
pub struct Stiffness {
    options: StiffnessOptions,
    dt: f64,
    softer: FrictionObserver,
    stiffer: FrictionObserver,
    measured: Measured,
    estimate: LowPass,
    sensitivity: LowPass,
    position: f64,
}

impl Stiffness {
    /// Starts at the stiffness of `model`, called once every `dt`.
    ///
    /// # Errors
    /// [`ObserverError::OutOfRange`] names the option.
    pub fn new(
        model: &AnyModel,
        options: &StiffnessOptions,
        drive: &NominalDrive,
        dt: TimeStep,
    ) -> Result<Self, ObserverError> {
        options.check()?;
        drive.check()?;
        let filter = LowPass::new(options.filter, dt).at_zero();
        Ok(Self {
            options: *options,
            dt: dt.seconds(),
            softer: FrictionObserver::new(&stiffened(model, 1.0 / options.span), dt),
            stiffer: FrictionObserver::new(&stiffened(model, options.span), dt),
            measured: Measured::new(
                options.source,
                super::Excitation::SRV02,
                options.filter,
                drive,
                dt,
            ),
            estimate: filter,
            sensitivity: filter,
            position: 0.0,
        })
    }

    /// The torque now \[N m\], where the model as given carries `torque`; learns from the cycle.
    #[inline]
    pub fn torque(&mut self, velocity: f64, rate: f64, seen: &Seen, torque: f64) -> f64 {
        let softer = self.softer.observe_injected(velocity, rate, None).torque;
        let stiffer = self.stiffer.observe_injected(velocity, rate, None).torque;
        let sample = self.measured.take(velocity, seen, torque);
        let slope = if self.position < 0.0 { torque - softer } else { stiffer - torque };
        let estimate = torque + self.position * slope;
        if let Some(sample) = sample {
            let sensitivity = self.sensitivity.step(held(slope));
            let error = sample.torque - self.estimate.step(held(estimate));
            if error.abs() > self.options.dead_zone && sample.velocity.abs() >= self.options.slowest
            {
                let beyond = error - self.options.dead_zone.copysign(error);
                let weak = self.options.weak;
                let step = beyond * sensitivity / (weak * weak + sensitivity * sensitivity);
                let moved = self.position + self.dt * self.options.rate * step.clamp(-1.0, 1.0);
                self.position = moved.clamp(-1.0, 1.0);
            }
        }
        estimate
    }

    /// The factor on the model's stiffness, `s^p`.
    #[must_use]
    pub fn factor(&self) -> f64 {
        self.options.span.powf(self.position)
    }

    /// Back to rest. What was learned stays.
    pub fn reset(&mut self) {
        self.softer.reset();
        self.stiffer.reset();
        self.measured.reset();
        for filter in [&mut self.estimate, &mut self.sensitivity] {
            *filter = filter.at_zero();
        }
    }
}

#[cfg(test)]
mod tests {
    use friction_model::ModelName;

    use super::*;

    /// A contact that is softer or stiffer than the model, in small motions to and fro, seen by a
    /// torque sensor: the factor goes there, and stays in its bounds.
    #[test]
    fn the_stiffness_goes_to_that_of_the_contact() {
        let dt = TimeStep::new(1e-3).unwrap();
        for name in [ModelName::LuGre, ModelName::Proposed] {
            for truth in [0.6, 1.0, 1.6, 5.0] {
                let model = AnyModel::test_bed(name);
                let options =
                    StiffnessOptions { source: TorqueSource::Sensor, ..StiffnessOptions::SRV02 };
                let mut stiffness =
                    Stiffness::new(&model, &options, &NominalDrive::SRV02, dt).unwrap();
                let mut contact = FrictionObserver::new(&stiffened(&model, truth), dt);
                let mut given = FrictionObserver::new(&model, dt);
                for k in 0..60_000 {
                    let velocity = 0.02 * (4e-3 * f64::from(k)).sin();
                    let torque = Some(contact.observe(velocity, None).torque);
                    let seen = Seen { velocity, torque, ..Seen::default() };
                    let own = given.observe(velocity, None).torque;
                    stiffness.torque(velocity, 0.0, &seen, own);
                }
                let expected = f64::clamp(truth, 0.5, 2.0);
                let found = stiffness.factor();
                assert!((found / expected - 1.0).abs() < 0.2, "{name}: {found}, not {expected}");
            }
        }
    }
}
