//! A body under friction: `m x'' = F_e - F`, integrated together with the friction's states.
//!
//! Dynamic friction models are integrated with the body by the classical Runge-Kutta method. Models
//! that are discontinuous at zero velocity ([`FrictionModel::holding`]) stick and break away as
//! events: the body is held while the applied force lies within the holding levels, and a change of
//! sign of the velocity ends a slip.

use crate::{ContinuousState, FrictionModel, Real, State};

/// Where a body is when the applied force is asked for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moment<const A: usize = 0> {
    /// Time since the start \[s\].
    pub time: f64,
    /// Position \[m or rad\].
    pub position: f64,
    /// Velocity \[m/s or rad/s\].
    pub velocity: f64,
    /// States of whatever drives the body, for instance a controller's integral.
    pub driver: [f64; A],
}

/// What drives the body at a moment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drive<const A: usize = 0> {
    /// Applied force \[N\] or torque \[N m\].
    pub force: f64,
    /// Rates of the driver's states.
    pub rates: [f64; A],
}

impl From<f64> for Drive<0> {
    /// A force alone.
    fn from(force: f64) -> Self {
        Self { force, rates: [] }
    }
}

/// A body of given inertia under the friction of `M`, with `A` states of its driver.
#[derive(Debug, Clone)]
pub struct Body<M: FrictionModel, const A: usize = 0> {
    model: M,
    friction: State<M::Continuous, M::Memory>,
    inverse_inertia: f64,
    moment: Moment<A>,
    /// Applied force at the last step, for its rate.
    applied: f64,
    force_rate: f64,
}

/// Velocity that counts as an infinitely slow slip for models discontinuous at zero.
const CREEP: f64 = 1e-12;

impl<M: FrictionModel, const A: usize> Body<M, A> {
    /// A body of `inertia` \[kg or kg m^2\], above zero, at rest at position zero.
    #[must_use]
    pub fn new(model: M, inertia: f64) -> Self {
        let moment = Moment { time: 0.0, position: 0.0, velocity: 0.0, driver: [0.0; A] };
        let friction = model.rest();
        Self {
            model,
            friction,
            inverse_inertia: 1.0 / inertia,
            moment,
            applied: 0.0,
            force_rate: 0.0,
        }
    }

    /// Gives the body another `inertia` \[kg or kg m^2\], above zero; it keeps its velocity.
    pub fn set_inertia(&mut self, inertia: f64) {
        self.inverse_inertia = 1.0 / inertia;
    }

    /// Where it is.
    #[must_use]
    pub const fn moment(&self) -> &Moment<A> {
        &self.moment
    }

    /// The friction's state.
    #[must_use]
    pub const fn friction_state(&self) -> &State<M::Continuous, M::Memory> {
        &self.friction
    }

    /// The friction now, while `applied` acts.
    #[inline]
    #[must_use]
    pub fn friction(&self, applied: f64) -> f64 {
        match self.model.holding(self.force_rate) {
            Some(holding) if self.moment.velocity.abs() <= holding.band => holding.force(applied),
            _ => {
                let State { continuous, memory } = &self.friction;
                self.model.evaluate(continuous, memory, self.moment.velocity).force
            }
        }
    }

    /// Advances by `h` \[s\] under the force and driver that `drive` gives at each moment.
    #[inline]
    pub fn advance(&mut self, h: f64, drive: impl Fn(&Moment<A>) -> Drive<A>) {
        // Models without stiction never look at the rate; the compiler drops its computation for
        // them.
        match self.model.holding(self.force_rate) {
            None => self.runge_kutta(h, drive, None),
            Some(_) => self.advance_with_events(h, drive),
        }
    }

    fn advance_with_events(&mut self, h: f64, drive: impl Fn(&Moment<A>) -> Drive<A>) {
        let applied = drive(&self.moment).force;
        self.force_rate =
            if self.moment.time > 0.0 { (applied - self.applied).abs() / h } else { 0.0 };
        self.applied = applied;
        let Some(holding) = self.model.holding(self.force_rate) else { return };
        let Moment { position, velocity, .. } = self.moment;
        let resting = velocity.abs() <= holding.band;
        if holding.holds(velocity, applied) {
            self.moment.velocity = 0.0;
            self.hold(h, drive);
            return;
        }
        let direction = if resting { applied.signum() } else { velocity.signum() };
        self.runge_kutta(h, drive, Some(direction));
        if self.moment.velocity * direction <= 0.0 {
            if !resting {
                // The slip ended inside the step, after the fraction of it that linear deceleration
                // takes.
                let fraction = velocity / (velocity - self.moment.velocity);
                self.moment.position = position + 0.5 * velocity * fraction * h;
            }
            self.moment.velocity = 0.0;
        }
    }

    /// The body rests for `h`; only time and the driver go on.
    fn hold(&mut self, h: f64, drive: impl Fn(&Moment<A>) -> Drive<A>) {
        let here = self.moment;
        let after = |rates: &[f64; A], h: f64| Moment {
            time: here.time + h,
            driver: here.driver.plus_scaled(rates, h),
            ..here
        };
        let k1 = drive(&here).rates;
        let k2 = drive(&after(&k1, 0.5 * h)).rates;
        let k3 = drive(&after(&k2, 0.5 * h)).rates;
        let k4 = drive(&after(&k3, h)).rates;
        self.moment.time += h;
        self.moment.driver = sum(&here.driver, [&k1, &k2, &k3, &k4], h);
        self.model.commit(&mut self.friction, 0.0, h);
    }

    /// One step; `slipping` in a direction keeps a discontinuous model on that side of zero
    /// velocity.
    #[inline]
    fn runge_kutta(
        &mut self,
        h: f64,
        drive: impl Fn(&Moment<A>) -> Drive<A>,
        slipping: Option<f64>,
    ) {
        let here = self.moment;
        let x = self.friction.continuous;
        let rates = |x: &M::Continuous, at: &Moment<A>| {
            let seen = match slipping {
                Some(direction) if at.velocity * direction <= 0.0 => CREEP * direction,
                _ => at.velocity,
            };
            let friction = self.model.evaluate(x, &self.friction.memory, seen);
            let drive = drive(at);
            (self.inverse_inertia * (drive.force - friction.force), friction.rates, drive.rates)
        };
        let after = |velocity: f64, acceleration: f64, driver: &[f64; A], h: f64| Moment {
            time: here.time + h,
            position: here.position + h * velocity,
            velocity: here.velocity + h * acceleration,
            driver: here.driver.plus_scaled(driver, h),
        };
        let (a1, k1, d1) = rates(&x, &here);
        let at2 = after(here.velocity, a1, &d1, 0.5 * h);
        let (a2, k2, d2) = rates(&x.plus_scaled(&k1, 0.5 * h), &at2);
        let at3 = after(at2.velocity, a2, &d2, 0.5 * h);
        let (a3, k3, d3) = rates(&x.plus_scaled(&k2, 0.5 * h), &at3);
        let at4 = after(at3.velocity, a3, &d3, h);
        let (a4, k4, d4) = rates(&x.plus_scaled(&k3, h), &at4);
        self.moment = Moment {
            time: here.time + h,
            position: here.position
                + h / 6.0 * (here.velocity + 2.0 * (at2.velocity + at3.velocity) + at4.velocity),
            velocity: here.velocity + h / 6.0 * (a1 + 2.0 * (a2 + a3) + a4),
            driver: sum(&here.driver, [&d1, &d2, &d3, &d4], h),
        };
        self.friction.continuous = sum(&x, [&k1, &k2, &k3, &k4], h);
        self.model.commit(&mut self.friction, self.moment.velocity, h);
    }
}

/// `x + h/6 (k1 + 2 k2 + 2 k3 + k4)`.
#[inline]
pub(crate) fn sum<T: Real, C: ContinuousState<T>>(x: &C, k: [&C; 4], h: T) -> C {
    let [k1, k2, k3, k4] = k;
    let (sixth, third) = (h / T::of(6.0), h / T::of(3.0));
    x.plus_scaled(k1, sixth).plus_scaled(k2, third).plus_scaled(k3, third).plus_scaled(k4, sixth)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Coulomb, CoulombParameters, Stribeck, Viscous, ViscousParameters};

    /// A mass on a spring with light viscous friction: the damped oscillation in closed form.
    #[test]
    fn a_damped_oscillator_follows_the_closed_form() {
        let model = Viscous::try_from(ViscousParameters { f_v: 0.1 }).unwrap();
        let mut body = Body::<_, 0>::new(model, 1.0);
        let omega = (4.0f64 - 0.05 * 0.05).sqrt();
        for k in 1..=5000 {
            body.advance(1e-3, |at| Drive::from(4.0 * (1.0 - at.position)));
            let t = 1e-3 * f64::from(k);
            let expected =
                1.0 - (-0.05 * t).exp() * ((omega * t).cos() + 0.05 / omega * (omega * t).sin());
            assert!((body.moment().position - expected).abs() < 1e-11, "at {t} s");
        }
    }

    /// Coulomb friction takes `2 F_c / k` off each swing: the decay is linear, and it ends at rest.
    #[test]
    fn coulomb_friction_ends_an_oscillation_after_linear_decay() {
        let model = Coulomb::try_from(CoulombParameters { f_c: 0.1 }).unwrap();
        let mut body = Body::<_, 0>::new(model, 1.0);
        let mut turns = Vec::new();
        let mut before = 0.0;
        for _ in 0..200_000 {
            body.advance(1e-4, |at| Drive::from(1.05 - at.position));
            let Moment { position, velocity, .. } = *body.moment();
            if before != 0.0 && velocity == 0.0 {
                turns.push(position - 1.05);
            }
            before = velocity;
        }
        // From -1.05: 0.85, -0.65, 0.45, -0.25, 0.05, where the spring no longer overcomes 0.1.
        let expected = [0.85, -0.65, 0.45, -0.25, 0.05];
        assert_eq!(turns.len(), expected.len(), "{turns:?}");
        for (turn, expected) in turns.iter().zip(expected) {
            assert!((turn - expected).abs() < 1e-4, "{turns:?}");
        }
    }

    #[test]
    fn below_breakaway_friction_balances_what_is_applied() {
        let mut body = Body::<_, 1>::new(Stribeck::chapter_3(), 1.0);
        for _ in 0..1000 {
            body.advance(1e-3, |_| Drive { force: 1.4, rates: [2.0] });
        }
        assert_eq!(
            (body.moment().position, body.friction(1.4), body.friction(-3.0)),
            (0.0, 1.4, -1.5)
        );
        assert!((body.moment().driver[0] - 2.0).abs() < 1e-12, "the driver goes on");
    }
}
