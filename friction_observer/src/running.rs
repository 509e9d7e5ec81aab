//! A technique while it runs.

use friction_model::{AnyModel, ModelName, Regime, Scheme, TimeStep};

use crate::adaptive::{FrictionLevel, FrictionParameters, Stiffness};
use crate::{
    DisturbanceObserver, Estimate, EstimatorOptions, FrictionObserver, FuzzyCompensator,
    ObserverError, RbfCompensator, Seen, Source, SuperTwisting, Technique, VelocityEstimator,
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
    SuperTwisting(SuperTwisting),
    Fuzzy(FuzzyCompensator),
}

/// A model at the reference's velocity, beside a technique that has none.
#[derive(Debug, Clone)]
struct Ahead {
    observer: FrictionObserver,
    share: f64,
    volts_per_newton_metre: f64,
    /// Its torque of the cycle before \[N m\].
    before: f64,
}

impl Ahead {
    /// The voltage of the cycle before without its part, and its torque now.
    #[inline]
    fn step(&mut self, seen: &Seen) -> (f64, f64) {
        let rest = seen.voltage - self.volts_per_newton_metre * self.before;
        self.before = self.share * self.observer.observe(seen.reference_velocity, None).torque;
        (rest, self.before)
    }

    fn reset(&mut self) {
        self.observer.reset();
        self.before = 0.0;
    }
}

/// Velocity and technique at a fixed period.
#[derive(Debug, Clone)]
pub(crate) struct Running {
    velocity: VelocityEstimator,
    injection: f64,
    engine: Engine,
    ahead: Option<Ahead>,
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
            Technique::SuperTwisting(twisting) => {
                Engine::SuperTwisting(SuperTwisting::new(twisting, drive, dt)?)
            }
            Technique::Fuzzy(fuzzy) => Engine::Fuzzy(FuzzyCompensator::new(fuzzy)?),
        };
        let beside = options.ahead > 0.0 && !options.technique.needs_model();
        let ahead = beside.then(|| Ahead {
            observer: FrictionObserver::by(*scheme, model, dt),
            share: options.ahead,
            volts_per_newton_metre: drive.volts_per_newton_metre,
            before: 0.0,
        });
        let velocity = VelocityEstimator::new(options.velocity, drive, dt)?;
        Ok(Self { velocity, injection: options.injection, engine, ahead, model: model.name() })
    }

    /// Estimated velocity \[rad/s\] and friction now.
    #[inline]
    pub(crate) fn estimate(&mut self, seen: &Seen) -> (f64, Estimate) {
        let velocity = self.velocity.estimate(seen);
        // An error that is not finite injects nothing.
        let rate = -self.injection * seen.error;
        let rate = if rate.is_finite() { rate } else { 0.0 };
        // What a technique without a model observes is what the model beside it leaves.
        let (rest, asked) =
            self.ahead.as_mut().map_or((seen.voltage, 0.0), |ahead| ahead.step(seen));
        let off = velocity - seen.reference_velocity;
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
                let torque = observer.observe(velocity, rest);
                without_model(Source::DisturbanceObserver, asked + torque, velocity, seen)
            }
            Engine::Rbf(compensator) => {
                let torque = compensator.observe(velocity, seen.reference_velocity, rest);
                without_model(Source::RbfCompensator, asked + torque, velocity, seen)
            }
            Engine::SuperTwisting(twisting) => {
                let torque = twisting.observe(off, seen.error);
                without_model(Source::SuperTwisting, asked + torque, velocity, seen)
            }
            Engine::Fuzzy(fuzzy) => {
                let torque = fuzzy.observe(off, seen.error);
                without_model(Source::Fuzzy, asked + torque, velocity, seen)
            }
        };
        (velocity, estimate)
    }

    pub(crate) fn reset(&mut self) {
        self.velocity.reset();
        self.ahead.iter_mut().for_each(Ahead::reset);
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
            Engine::SuperTwisting(twisting) => twisting.reset(),
            Engine::Fuzzy(_) => {}
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
            Engine::Feedforward(_)
            | Engine::Pair(_)
            | Engine::Disturbance(_)
            | Engine::Rbf(_)
            | Engine::SuperTwisting(_)
            | Engine::Fuzzy(_) => Adapted::Nothing,
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
