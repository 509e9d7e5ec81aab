//! The observer: a friction model driven by the measured velocity, with error injection (thesis
//! section 5.2).
//!
//! ```text
//! x^' = f(x^, v) - k e,     F^ = F(x^, x^', v)
//! ```
//!
//! for every state of the model, `e` the controlled output minus its reference (eqs. 5.12 to 5.14,
//! with the terms in `sigma v` that 5.13 leaves out). The last of these equations contains the
//! rates, so that part of the injection is plain proportional gain: `sigma k` N m per unit of error
//! for a model with micro-damping `sigma`.

use friction_model::{AnyModel, AnyStepper, ModelName, RunningContact, Scheme, TimeStep};

use crate::{Estimate, Source};

/// A friction model that follows the measured velocity in real time: a built-in one, chosen while
/// the program runs, or any that [steps](friction_model::Stepper).
#[derive(Debug, Clone)]
pub struct FrictionObserver<C = AnyStepper> {
    stepper: C,
    source: Source,
}

impl FrictionObserver {
    /// An observer over `model`, at rest, called once every `dt`; each velocity is held for it.
    #[must_use]
    pub fn new(model: &AnyModel, dt: TimeStep) -> Self {
        Self::by(Scheme::Held, model, dt)
    }

    /// An observer over `model`, at rest, stepped by `scheme` once every `dt`.
    #[must_use]
    pub fn by(scheme: Scheme, model: &AnyModel, dt: TimeStep) -> Self {
        Self { stepper: model.start_by(scheme, dt), source: Source::Model(model.name()) }
    }

    /// The model that estimates.
    #[must_use]
    pub const fn model(&self) -> ModelName {
        self.stepper.name()
    }
}

impl<C: RunningContact> FrictionObserver<C> {
    /// An observer over a contact of a model that need not be built in, called once a period of
    /// the contact.
    #[must_use]
    pub fn over(contact: C) -> Self {
        let source = Source::OwnModel(contact.model_name());
        Self { stepper: contact, source }
    }

    /// The friction now at the measured `velocity` \[rad/s\], with the inner quantities of the same
    /// moment. `measured_torque` \[N m\], where there is a sensor, is compared with the estimate.
    ///
    /// A velocity that is not a finite number is not believed: the estimate is zero torque and the
    /// model stays where it is.
    #[inline]
    pub fn observe(&mut self, velocity: f64, measured_torque: Option<f64>) -> Estimate {
        self.observe_injected(velocity, 0.0, measured_torque)
    }

    /// [`observe`](Self::observe) with `rate`, which is `-k e`, in the derivative of every state of
    /// the model.
    #[inline]
    pub fn observe_injected(
        &mut self,
        velocity: f64,
        rate: f64,
        measured_torque: Option<f64>,
    ) -> Estimate {
        let before = self.stepper.internals(velocity);
        let torque = if !velocity.is_finite() {
            0.0
        } else if rate == 0.0 {
            self.stepper.step(velocity)
        } else {
            self.stepper.step_injected(velocity, rate)
        };
        // After a step the state is that of the next moment, or of this one.
        let internals = match self.stepper.scheme() {
            Scheme::Held => before,
            Scheme::Mean => self.stepper.internals(velocity),
        };
        Estimate {
            source: self.source,
            torque,
            deflection: internals.deflection,
            gamma: internals.gamma,
            regime: internals.regime,
            velocity,
            residual: measured_torque.map(|measured| measured - torque),
        }
    }

    /// The part of the friction at `velocity` \[rad/s\] that is viscous \[N m\].
    #[inline]
    #[must_use]
    pub fn viscous(&self, velocity: f64) -> f64 {
        self.stepper.viscous(velocity)
    }

    /// Back to rest.
    pub fn reset(&mut self) {
        self.stepper.reset();
    }
}

#[cfg(test)]
mod tests {
    use friction_model::{FrictionModel, Proposed, Regime, State, rk4};

    use super::*;

    fn observer(name: ModelName) -> FrictionObserver {
        FrictionObserver::new(&AnyModel::test_bed(name), TimeStep::new(1e-3).unwrap())
    }

    /// At 1 kHz with the true velocity and parameters the observer stays within 2 % of static
    /// friction of the true model.
    #[test]
    fn follows_the_true_friction_through_reversals() {
        let velocity = |t: f64| 0.3 * (1.5 * t).sin() + 0.05 * (9.0 * t).sin();
        let plant = Proposed::test_bed();
        let mut state: State<_, _> = plant.rest();
        let mut observer = observer(ModelName::Proposed);
        let mut truth = 0.0;
        for k in 0..8000u32 {
            let t = f64::from(k) * 1e-3;
            let estimate = observer.observe(velocity(t), Some(truth));
            assert!(estimate.residual.unwrap().abs() < 0.02 * 0.0994, "at {t} s: {estimate:?}");
            for j in 0..10 {
                let t = t + f64::from(j) * 1e-4;
                truth = rk4::step(
                    &plant,
                    &mut state,
                    [velocity(t), velocity(t + 5e-5), velocity(t + 1e-4)],
                    1e-4,
                );
            }
        }
    }

    /// Stepped by the mean, the estimate is ten times nearer, and the deflection is that of now.
    #[test]
    fn the_mean_follows_ten_times_nearer() {
        let velocity = |t: f64| 0.3 * (1.5 * t).sin() + 0.05 * (9.0 * t).sin();
        let model = AnyModel::test_bed(ModelName::LuGre);
        let errors = |scheme| {
            let mut observer = FrictionObserver::by(scheme, &model, TimeStep::new(1e-3).unwrap());
            let mut truth = model.start_by(Scheme::Mean, TimeStep::new(1e-5).unwrap());
            let (mut torque, mut deflection) = (0.0f64, 0.0f64);
            for k in 0..400_000u32 {
                let v = velocity(f64::from(k) * 1e-5);
                let true_torque = truth.step(v);
                if k % 100 == 0 {
                    let estimate = observer.observe(v, None);
                    let true_deflection = truth.internals(v).deflection;
                    torque = torque.max((estimate.torque - true_torque).abs());
                    deflection = deflection.max((estimate.deflection - true_deflection).abs());
                }
            }
            (torque, deflection)
        };
        let (held, mean) = (errors(Scheme::Held), errors(Scheme::Mean));
        assert!(mean.0 < 0.1 * held.0 && mean.1 < 0.1 * held.1, "{held:?} held, {mean:?} mean");
    }

    #[test]
    fn knows_sticking_from_sliding() {
        let mut observer = observer(ModelName::Proposed);
        assert_eq!(observer.observe(0.001, None).regime, Regime::Stick);
        for _ in 0..500 {
            observer.observe(1.0, None);
        }
        let sliding = observer.observe(1.0, None);
        assert_eq!(sliding.regime, Regime::Slip);
        assert_eq!(sliding.residual, None);
    }

    #[test]
    fn does_not_believe_a_velocity_that_is_not_a_number() {
        for name in ModelName::ALL {
            let mut observer = observer(name);
            for _ in 0..100 {
                observer.observe(0.5, None);
            }
            let mut untouched = observer.clone();
            assert_eq!(observer.observe(f64::NAN, None).torque, 0.0);
            assert_eq!(observer.observe(0.5, None), untouched.observe(0.5, None), "{name}");
        }
    }
}
