//! The drive with friction, integrated.
//!
//! Dynamic friction models are integrated together with the shaft by the classical Runge-Kutta method. Models that are
//! discontinuous at zero velocity (Coulomb, Stribeck) stick and break away as events: the shaft is held while the drive's
//! torque is within the breakaway level, and a change of sign of the velocity ends a slip.

use friction_model::{ContinuousState, FrictionModel, State};

use crate::{Drive, FrictionCoupling};

/// What a simulation knows and no sensor shows.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Truth {
    /// Position [rad].
    pub position: f64,
    /// Velocity [rad/s].
    pub velocity: f64,
    /// Friction torque [N m].
    pub friction: f64,
}

/// The shaft of a drive under the friction of model `M`.
#[derive(Debug, Clone)]
pub struct Plant<M: FrictionModel> {
    model: M,
    friction: State<M::Continuous, M::Memory>,
    position: f64,
    velocity: f64,
    /// Drive torque per volt, A K_m / R_a [N m/V].
    torque_per_volt: f64,
    back_emf: f64,
    inverse_inertia: f64,
    /// Part of the friction torque that acts on the shaft: 1, unless friction is coupled as volts.
    coupling: f64,
}

/// Velocity that counts as an infinitely slow slip for models discontinuous at zero.
const CREEP: f64 = 1e-12;

impl<M: FrictionModel> Plant<M> {
    /// A plant at rest at position zero.
    #[must_use]
    pub fn new(drive: &Drive, coupling: FrictionCoupling, model: M) -> Self {
        let friction = model.rest();
        Self {
            model,
            friction,
            position: 0.0,
            velocity: 0.0,
            torque_per_volt: 1.0 / drive.volts_per_newton_metre(),
            back_emf: drive.back_emf(),
            inverse_inertia: 1.0 / drive.parameters().inertia,
            coupling: drive.friction_volts(coupling) / drive.volts_per_newton_metre(),
        }
    }

    /// Torque that `volts` exert on the shaft at `velocity` [N m].
    #[inline]
    fn drive_torque(&self, volts: f64, velocity: f64) -> f64 {
        self.torque_per_volt * (volts - self.back_emf * velocity)
    }

    /// Position, velocity and friction while `volts` are applied.
    #[inline]
    #[must_use]
    pub fn truth(&self, volts: f64) -> Truth {
        let friction = match self.model.breakaway() {
            Some(breakaway) if self.velocity == 0.0 => {
                (self.drive_torque(volts, 0.0) / self.coupling).clamp(-breakaway, breakaway)
            }
            _ => self.model.evaluate(&self.friction.continuous, &self.friction.memory, self.velocity).force,
        };
        Truth { position: self.position, velocity: self.velocity, friction }
    }

    /// Advances by `h` [s] with `volts` held.
    #[inline]
    pub fn advance(&mut self, volts: f64, h: f64) {
        match self.model.breakaway() {
            None => self.runge_kutta(volts, h, None),
            Some(breakaway) => self.advance_with_events(volts, h, breakaway),
        }
    }

    fn advance_with_events(&mut self, volts: f64, h: f64, breakaway: f64) {
        let direction = if self.velocity != 0.0 {
            self.velocity.signum()
        } else {
            let torque = self.drive_torque(volts, 0.0);
            if torque.abs() <= self.coupling * breakaway {
                return;
            }
            torque.signum()
        };
        let (position, velocity) = (self.position, self.velocity);
        self.runge_kutta(volts, h, Some(direction));
        if self.velocity * direction <= 0.0 && velocity != 0.0 {
            // The slip ended inside the step, after the fraction of it that linear deceleration takes.
            let fraction = velocity / (velocity - self.velocity);
            self.position = position + 0.5 * velocity * fraction * h;
            self.velocity = 0.0;
        } else if self.velocity * direction < 0.0 {
            self.velocity = 0.0;
        }
    }

    /// One step; `slipping` in a direction keeps a discontinuous model on that side of zero velocity.
    #[inline]
    fn runge_kutta(&mut self, volts: f64, h: f64, slipping: Option<f64>) {
        let x = self.friction.continuous;
        let w = self.velocity;
        let rates = |x: &M::Continuous, w: f64| {
            let seen = match slipping {
                Some(direction) if w * direction <= 0.0 => CREEP * direction,
                _ => w,
            };
            let friction = self.model.evaluate(x, &self.friction.memory, seen);
            let torque = self.drive_torque(volts, w) - self.coupling * friction.force;
            (self.inverse_inertia * torque, friction.rates)
        };
        let (a1, k1) = rates(&x, w);
        let w2 = w + 0.5 * h * a1;
        let (a2, k2) = rates(&x.plus_scaled(&k1, 0.5 * h), w2);
        let w3 = w + 0.5 * h * a2;
        let (a3, k3) = rates(&x.plus_scaled(&k2, 0.5 * h), w3);
        let w4 = w + h * a3;
        let (a4, k4) = rates(&x.plus_scaled(&k3, h), w4);
        self.position += h / 6.0 * (w + 2.0 * (w2 + w3) + w4);
        self.velocity = w + h / 6.0 * (a1 + 2.0 * (a2 + a3) + a4);
        self.friction.continuous = x
            .plus_scaled(&k1, h / 6.0)
            .plus_scaled(&k2, h / 3.0)
            .plus_scaled(&k3, h / 3.0)
            .plus_scaled(&k4, h / 6.0);
        self.model.commit(&mut self.friction);
    }
}

#[cfg(test)]
mod tests {
    use friction_model::{Coulomb, LuGre, Proposed, Stribeck, Viscous, ViscousParameters};

    use super::*;
    use crate::TimeConstant;

    fn plant<M: FrictionModel>(model: M) -> Plant<M> {
        Plant::new(&Drive::srv02(TimeConstant::Thesis), FrictionCoupling::Physical, model)
    }

    /// Without friction the step response is that of a first-order lag.
    #[test]
    fn without_friction_it_is_a_first_order_lag() {
        let mut plant = plant(Viscous::try_from(ViscousParameters { f_v: 0.0 }).unwrap());
        let (k, t) = (1.0 / (70.0 * 0.00767), 0.02388);
        for step in 1..=100 {
            plant.advance(2.0, 5e-4);
            let expected = 2.0 * k * (1.0 - (-f64::from(step) * 5e-4 / t).exp());
            assert!((plant.velocity - expected).abs() < 1e-8, "step {step}");
        }
    }

    /// Steady state: `w = K (u - 4.8426 F(w))`.
    fn settles_on_the_characteristic<M: FrictionModel>(model: M) {
        let mut plant = plant(model.clone());
        for _ in 0..4000 {
            plant.advance(3.0, 5e-4);
        }
        let w = plant.velocity;
        let drive = Drive::srv02(TimeConstant::Thesis);
        let expected = drive.gain() * (3.0 - drive.volts_per_newton_metre() * model.steady_state(w));
        assert!((w - expected).abs() < 1e-9, "{:?}: {w} is not {expected}", M::NAME);
        assert!((plant.truth(3.0).friction - model.steady_state(w)).abs() < 1e-9);
    }

    #[test]
    fn every_model_settles_on_its_steady_characteristic() {
        settles_on_the_characteristic(Coulomb::test_bed());
        settles_on_the_characteristic(Viscous::test_bed());
        settles_on_the_characteristic(Stribeck::test_bed());
        settles_on_the_characteristic(LuGre::test_bed());
        settles_on_the_characteristic(Proposed::test_bed());
    }

    #[test]
    fn below_breakaway_a_static_model_holds_the_shaft_and_shows_the_applied_torque() {
        let mut plant = plant(Stribeck::test_bed());
        let volts = 0.9 * 0.0994 * 4.8426;
        for _ in 0..1000 {
            plant.advance(volts, 5e-4);
        }
        assert_eq!((plant.position, plant.velocity), (0.0, 0.0));
        assert!((plant.truth(volts).friction - 0.9 * 0.0994).abs() < 1e-6);
        plant.advance(1.2 * 0.0994 * 4.8426, 5e-4);
        assert!(plant.velocity > 0.0);
    }

    #[test]
    fn a_slip_ends_at_rest() {
        let mut plant = plant(Coulomb::test_bed());
        for _ in 0..200 {
            plant.advance(2.0, 5e-4);
        }
        for _ in 0..400 {
            plant.advance(0.0, 5e-4);
        }
        assert_eq!(plant.velocity, 0.0);
        let rest = plant.position;
        plant.advance(0.0, 5e-4);
        assert_eq!(plant.position, rest);
    }

    #[test]
    fn friction_as_volts_is_weaker_by_the_drives_constant() {
        let drive = Drive::srv02(TimeConstant::Thesis);
        let model = Coulomb::test_bed();
        let mut plant = Plant::new(&drive, FrictionCoupling::NewtonMetreAsVolt, model);
        for _ in 0..4000 {
            plant.advance(3.0, 5e-4);
        }
        assert!((plant.velocity - drive.gain() * (3.0 - 0.0925)).abs() < 1e-9);
    }
}
