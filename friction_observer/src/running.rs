//! A technique while it runs.

use friction_model::{AnyModel, ModelName, Regime, Scheme, TimeStep};

use crate::adaptive::{FrictionLevel, FrictionParameters, Stiffness};
use crate::{
    DisturbanceObserver, Estimate, EstimatorOptions, FrictionObserver, ObserverError,
    RbfCompensator, Seen, Source, Technique, VelocityEstimator,
};

/// A model driven by the measured velocity and, where it has a share, by the reference's.
#[derive(Debug, Clone)]
struct ModelPair {
    feedback: FrictionObserver,
    feedforward: FrictionObserver,
    share: f64,
}

/// What a pair of models says in a cycle.
struct PairEstimate {
    /// The mixed estimate.
    mixed: Estimate,
    /// Torque of the model driven by the measured velocity \[N m\].
    feedback: f64,
}

impl ModelPair {
    fn new(scheme: Scheme, model: &AnyModel, share: f64, dt: TimeStep) -> Self {
        let observer = FrictionObserver::by(scheme, model, dt);
        Self { feedback: observer.clone(), feedforward: observer, share }
    }

    #[inline]
    fn observe(&mut self, velocity: f64, rate: f64, seen: &Seen) -> PairEstimate {
        let by_shaft = self.feedback.observe_injected(velocity, rate, seen.torque);
        if self.share == 0.0 {
            return PairEstimate { mixed: by_shaft, feedback: by_shaft.torque };
        }
        let asked = self.feedforward.observe(seen.reference_velocity, seen.torque);
        let torque = by_shaft.torque + self.share * (asked.torque - by_shaft.torque);
        PairEstimate { mixed: retorqued(by_shaft, torque, seen), feedback: by_shaft.torque }
    }

    fn reset(&mut self) {
        self.feedback.reset();
        self.feedforward.reset();
    }
}

/// The same estimate with another torque.
#[inline]
fn retorqued(estimate: Estimate, torque: f64, seen: &Seen) -> Estimate {
    Estimate { torque, residual: seen.torque.map(|measured| measured - torque), ..estimate }
}

/// What makes the torque.
#[derive(Debug, Clone)]
#[expect(
    clippy::large_enum_variant,
    reason = "states live in place: the step path does not allocate"
)]
enum Engine {
    Feedforward(FrictionObserver),
    Pair(ModelPair),
    Level(ModelPair, FrictionLevel),
    Parameters(ModelPair, FrictionParameters),
    Stiffness(FrictionObserver, Stiffness),
    Disturbance(DisturbanceObserver),
    Rbf(RbfCompensator),
}

/// Velocity and technique at a fixed period.
#[derive(Debug, Clone)]
pub(crate) struct Running {
    velocity: VelocityEstimator,
    injection: f64,
    engine: Engine,
    model: ModelName,
}

impl Running {
    pub(crate) fn new(
        model: &AnyModel,
        options: &EstimatorOptions,
        dt: TimeStep,
    ) -> Result<Self, ObserverError> {
        options.check()?;
        let EstimatorOptions { drive, scheme, .. } = options;
        let pair = |share| ModelPair::new(*scheme, model, share, dt);
        let engine = match &options.technique {
            Technique::Feedback => Engine::Pair(pair(0.0)),
            Technique::Feedforward => Engine::Feedforward(FrictionObserver::by(*scheme, model, dt)),
            Technique::Both { share } => Engine::Pair(pair(*share)),
            Technique::Adaptive(level) => {
                Engine::Level(pair(level.share), FrictionLevel::new(level, drive, dt)?)
            }
            Technique::AdaptiveParameters(parameters) => Engine::Parameters(
                pair(parameters.share),
                FrictionParameters::new(model, parameters, drive, dt)?,
            ),
            Technique::AdaptiveStiffness(stiffness) => Engine::Stiffness(
                FrictionObserver::by(*scheme, model, dt),
                Stiffness::new(model, stiffness, drive, dt)?,
            ),
            Technique::DisturbanceObserver(observer) => {
                Engine::Disturbance(DisturbanceObserver::new(observer, drive, dt)?)
            }
            Technique::Rbf(rbf) => Engine::Rbf(RbfCompensator::new(rbf, drive, dt)?),
        };
        let velocity = VelocityEstimator::new(options.velocity, drive, dt)?;
        Ok(Self { velocity, injection: options.injection, engine, model: model.name() })
    }

    /// Estimated velocity \[rad/s\] and friction now.
    #[inline]
    pub(crate) fn estimate(&mut self, seen: &Seen) -> (f64, Estimate) {
        let velocity = self.velocity.estimate(seen);
        // An error that is not finite injects nothing.
        let rate = -self.injection * seen.error;
        let rate = if rate.is_finite() { rate } else { 0.0 };
        let estimate = match &mut self.engine {
            Engine::Feedforward(observer) => observer.observe(seen.reference_velocity, seen.torque),
            Engine::Pair(pair) => pair.observe(velocity, rate, seen).mixed,
            Engine::Level(pair, level) => {
                let PairEstimate { mixed, feedback } = pair.observe(velocity, rate, seen);
                level.learn(velocity, seen, feedback);
                retorqued(mixed, level.factor() * mixed.torque, seen)
            }
            Engine::Parameters(pair, parameters) => {
                let PairEstimate { mixed, feedback } = pair.observe(velocity, rate, seen);
                if !velocity.is_finite() {
                    return (velocity, mixed);
                }
                let contact = feedback - pair.feedback.viscous(velocity);
                parameters.learn(velocity, seen, contact);
                let asked = if seen.reference_velocity.is_finite() {
                    seen.reference_velocity
                } else {
                    velocity
                };
                let at = velocity + pair.share * (asked - velocity);
                let carried = mixed.torque - pair.feedback.viscous(at);
                retorqued(mixed, parameters.torque(at, carried), seen)
            }
            Engine::Stiffness(observer, stiffness) => {
                let given = observer.observe_injected(velocity, rate, seen.torque);
                retorqued(given, stiffness.torque(velocity, rate, seen, given.torque), seen)
            }
            Engine::Disturbance(observer) => {
                let torque = observer.observe(velocity, seen.voltage);
                without_model(Source::DisturbanceObserver, torque, velocity, seen)
            }
            Engine::Rbf(compensator) => {
                let torque = compensator.observe(velocity, seen.reference_velocity, seen.voltage);
                without_model(Source::RbfCompensator, torque, velocity, seen)
            }
        };
        (velocity, estimate)
    }

    pub(crate) fn reset(&mut self) {
        self.velocity.reset();
        match &mut self.engine {
            Engine::Feedforward(observer) => observer.reset(),
            Engine::Pair(pair) => pair.reset(),
            Engine::Level(pair, level) => {
                pair.reset();
                level.reset();
            }
            Engine::Parameters(pair, parameters) => {
                pair.reset();
                parameters.reset();
            }
            Engine::Stiffness(observer, stiffness) => {
                observer.reset();
                stiffness.reset();
            }
            Engine::Disturbance(observer) => observer.reset(),
            Engine::Rbf(compensator) => compensator.reset(),
        }
    }

    pub(crate) const fn model(&self) -> ModelName {
        self.model
    }

    /// The adapted factors and parameters, for reports.
    pub(crate) fn adapted(&self) -> Adapted {
        match &self.engine {
            Engine::Level(_, level) => Adapted::Level(level.factor()),
            Engine::Parameters(_, parameters) => Adapted::Parameters(parameters.parameters()),
            Engine::Stiffness(_, stiffness) => Adapted::Stiffness(stiffness.factor()),
            Engine::Feedforward(_) | Engine::Pair(_) | Engine::Disturbance(_) | Engine::Rbf(_) => {
                Adapted::Nothing
            }
        }
    }
}

/// What an adaptation has come to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Adapted {
    /// Nothing is adapted.
    Nothing,
    /// Factor on the model's torque.
    Level(f64),
    /// Factor of the Coulomb level, rise towards the static level, viscous coefficient \[N m
    /// s/rad\] and offset between the directions \[N m\].
    Parameters([f64; 4]),
    /// Factor on the model's stiffness.
    Stiffness(f64),
}

#[inline]
fn without_model(source: Source, torque: f64, velocity: f64, seen: &Seen) -> Estimate {
    let regime = if torque == 0.0 { Regime::Stick } else { Regime::Slip };
    let residual = seen.torque.map(|measured| measured - torque);
    Estimate { source, torque, deflection: 0.0, gamma: 0.0, regime, velocity, residual }
}
