//! Any model behind one set of virtual calls, so that an experiment is compiled once and not once a
//! model.

use friction_model::{
    AnyModel, Body, Drive, FrictionModel, Holding, Internals, ModelVisitor, Moment, ParameterSet,
    RunningContact, State, Stepper, TimeStep, rk4,
};

/// A friction model for experiments: what it says without a state, and experiments started with it
/// at rest.
pub struct Contact {
    erased: Box<dyn Erased>,
    shortest_lag: f64,
    slips: bool,
}

impl Contact {
    /// The contact that a built-in `model` describes.
    #[must_use]
    pub fn new(model: &AnyModel) -> Self {
        let parameters = model.parameters();
        Self::erased(model.visit(Erase), |name, f| parameters.each(name, f))
    }

    /// The contact that `model` describes, which need not be built in. A parameter with the name
    /// `tau` is taken for a time constant of the model, and where there is a `sigma`, its bristles
    /// for ones that slip ([`crate::TimeScales`]).
    #[must_use]
    pub fn of<M>(model: M) -> Self
    where
        M: FrictionModel<Continuous: Send + Sync, Memory: Send + Sync, Discrete: Send + Sync>
            + Send
            + Sync
            + 'static,
    {
        let parameters = model.parameters().clone();
        Self::erased(Erase.visit(model), |name, f| parameters.each(name, f))
    }

    fn erased(erased: Box<dyn Erased>, each: impl Fn(&str, &mut dyn FnMut(f64))) -> Self {
        let mut contact = Self { erased, shortest_lag: f64::INFINITY, slips: false };
        each("tau", &mut |tau| contact.shortest_lag = contact.shortest_lag.min(tau));
        each("sigma", &mut |_| contact.slips = true);
        contact
    }

    /// The shortest of the model's own time constants \[s\]; infinite where it has none.
    pub(crate) const fn shortest_lag(&self) -> f64 {
        self.shortest_lag
    }

    /// Whether the model has bristles that slip.
    pub(crate) const fn slips(&self) -> bool {
        self.slips
    }

    /// What the model calls itself, see [`FrictionModel::NAME`].
    #[must_use]
    pub fn name(&self) -> &'static str {
        self.erased.name()
    }

    /// The force after a long time at constant `velocity` \[N or N m\], see
    /// [`FrictionModel::steady_state`].
    #[must_use]
    pub fn steady_state(&self, velocity: f64) -> f64 {
        self.erased.steady_state(velocity)
    }

    /// The viscous part of the force at `velocity` \[N or N m\], see [`FrictionModel::viscous`].
    #[must_use]
    pub fn viscous(&self, velocity: f64) -> f64 {
        self.erased.viscous(velocity)
    }

    /// How a model discontinuous at zero velocity holds there while the applied force changes at
    /// `force_rate` \[N/s or N m/s\]; `None` for models that describe pre-sliding themselves, see
    /// [`FrictionModel::holding`].
    #[must_use]
    pub fn holding(&self, force_rate: f64) -> Option<Holding> {
        self.erased.holding(force_rate)
    }

    /// The contact at rest, to be moved with a prescribed velocity by the derivative form.
    #[must_use]
    pub fn prescribed(&self) -> Box<dyn Prescribed> {
        self.erased.prescribed()
    }

    /// The contact at rest, to be moved with a prescribed velocity by the fixed-step form with the
    /// period `dt`.
    #[must_use]
    pub fn fixed_step(&self, dt: TimeStep) -> Box<dyn RunningContact> {
        self.erased.fixed_step(dt)
    }

    /// A body of `inertia` \[kg or kg m^2\], above zero, at rest on the contact. Its driver has one
    /// state.
    #[must_use]
    pub fn body(&self, inertia: f64) -> Box<dyn FreeBody> {
        self.erased.body(inertia)
    }
}

/// A contact under a prescribed velocity, integrated by [`rk4::step`].
pub trait Prescribed {
    /// Advances by `dt` \[s\] under the velocity at the start, the middle and the end of the step
    /// \[m/s or rad/s\]; returns the force at the end \[N or N m\].
    fn step(&mut self, velocities: [f64; 3], dt: f64) -> f64;

    /// The force now, at `velocity` \[N or N m\].
    fn force(&self, velocity: f64) -> f64;

    /// The inner quantities at `velocity`.
    fn internals(&self, velocity: f64) -> Internals;
}

/// A [`Body`] with one driver state.
pub trait FreeBody {
    /// Where it is.
    fn moment(&self) -> &Moment<1>;

    /// The friction now, while `applied` acts \[N or N m\].
    fn friction(&self, applied: f64) -> f64;

    /// Advances by `h` \[s\] under `drive`.
    fn advance(&mut self, h: f64, drive: &dyn Fn(&Moment<1>) -> Drive<1>);

    /// The inner quantities of the friction now.
    fn internals(&self) -> Internals;
}

/// What [`Contact`] asks of a model of any type.
trait Erased: Send + Sync {
    fn name(&self) -> &'static str;
    fn steady_state(&self, velocity: f64) -> f64;
    fn fixed_step(&self, dt: TimeStep) -> Box<dyn RunningContact>;
    fn viscous(&self, velocity: f64) -> f64;
    fn holding(&self, force_rate: f64) -> Option<Holding>;
    fn prescribed(&self) -> Box<dyn Prescribed>;
    fn body(&self, inertia: f64) -> Box<dyn FreeBody>;
}

struct Erase;

impl ModelVisitor for Erase {
    type Output = Box<dyn Erased>;

    fn visit<M>(self, model: M) -> Box<dyn Erased>
    where
        M: FrictionModel<Continuous: Send + Sync, Memory: Send + Sync, Discrete: Send + Sync>
            + Send
            + Sync
            + 'static,
    {
        Box::new(Of(model))
    }
}

/// A model of known type behind [`Erased`].
struct Of<M>(M);

impl<M: FrictionModel + Send + Sync + 'static> Erased for Of<M> {
    fn name(&self) -> &'static str {
        M::NAME
    }

    fn steady_state(&self, velocity: f64) -> f64 {
        self.0.steady_state(velocity)
    }

    fn fixed_step(&self, dt: TimeStep) -> Box<dyn RunningContact> {
        Box::new(Stepper::new(self.0.clone(), dt))
    }

    fn viscous(&self, velocity: f64) -> f64 {
        self.0.viscous(velocity)
    }

    fn holding(&self, force_rate: f64) -> Option<Holding> {
        self.0.holding(force_rate)
    }

    fn prescribed(&self) -> Box<dyn Prescribed> {
        Box::new(Moved { model: self.0.clone(), state: self.0.rest() })
    }

    fn body(&self, inertia: f64) -> Box<dyn FreeBody> {
        Box::new(Moving { model: self.0.clone(), body: Body::new(self.0.clone(), inertia) })
    }
}

struct Moved<M: FrictionModel> {
    model: M,
    state: State<M::Continuous, M::Memory>,
}

impl<M: FrictionModel> Prescribed for Moved<M> {
    fn step(&mut self, velocities: [f64; 3], dt: f64) -> f64 {
        rk4::step(&self.model, &mut self.state, velocities, dt)
    }

    fn force(&self, velocity: f64) -> f64 {
        self.model.evaluate(&self.state.continuous, &self.state.memory, velocity).force
    }

    fn internals(&self, velocity: f64) -> Internals {
        self.model.internals(&self.state, velocity)
    }
}

struct Moving<M: FrictionModel> {
    model: M,
    body: Body<M, 1>,
}

impl<M: FrictionModel> FreeBody for Moving<M> {
    fn moment(&self) -> &Moment<1> {
        self.body.moment()
    }

    fn friction(&self, applied: f64) -> f64 {
        self.body.friction(applied)
    }

    fn advance(&mut self, h: f64, drive: &dyn Fn(&Moment<1>) -> Drive<1>) {
        self.body.advance(h, drive);
    }

    fn internals(&self) -> Internals {
        self.model.internals(self.body.friction_state(), self.body.moment().velocity)
    }
}

#[cfg(test)]
mod tests {
    use friction_model::{ModelName, Proposed};

    use super::*;

    #[test]
    fn an_erased_contact_moves_as_the_model_itself() {
        let model = Proposed::chapter_3();
        let contact = Contact::new(&AnyModel::chapter_3(ModelName::Proposed));
        let (mut erased, mut state) = (contact.prescribed(), model.rest());
        let mut body = contact.body(2.0);
        let mut own = Body::<_, 1>::new(model, 2.0);
        for k in 0..2000 {
            let v = |j: i32| 0.01 * (1e-3 * f64::from(2 * k + j)).sin();
            let velocities = [v(0), v(1), v(2)];
            let force = rk4::step(&model, &mut state, velocities, 1e-3);
            assert_eq!(erased.step(velocities, 1e-3), force);
            assert_eq!(erased.force(v(2)), force);
            let drive = |at: &Moment<1>| Drive { force: 1.6 * at.time.sin(), rates: [at.position] };
            body.advance(1e-3, &drive);
            own.advance(1e-3, drive);
            assert_eq!(body.moment(), own.moment());
            assert_eq!(body.friction(0.0), own.friction(0.0));
            assert_eq!(
                body.internals(),
                model.internals(own.friction_state(), own.moment().velocity)
            );
        }
        assert!(body.moment().driver[0] != 0.0);
    }
}
