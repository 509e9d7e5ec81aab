//! The drive with friction: a [`Body`] that a motor turns.

use friction_model::{Body, FrictionModel, Moment};

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
    body: Body<M>,
    /// Drive torque per volt, A K_m / R_a [N m/V], for a shaft on which the whole friction torque acts.
    torque_per_volt: f64,
    back_emf: f64,
}

impl<M: FrictionModel> Plant<M> {
    /// A plant at rest at position zero.
    ///
    /// Of friction that is coupled as volts only a part acts on the shaft; that is a shaft with the same friction, but so much more
    /// inertia and drive torque.
    #[must_use]
    pub fn new(drive: &Drive, coupling: FrictionCoupling, model: M) -> Self {
        let coupling = drive.friction_volts(coupling) / drive.volts_per_newton_metre();
        Self {
            body: Body::new(model, drive.parameters().inertia / coupling),
            torque_per_volt: 1.0 / (drive.volts_per_newton_metre() * coupling),
            back_emf: drive.back_emf(),
        }
    }

    /// Position, velocity and friction while `volts` are applied.
    #[inline]
    #[must_use]
    pub fn truth(&self, volts: f64) -> Truth {
        let &Moment { position, velocity, .. } = self.body.moment();
        let friction = self.body.friction(self.torque_per_volt * (volts - self.back_emf * velocity));
        Truth { position, velocity, friction }
    }

    /// Advances by `h` [s] with `volts` held.
    #[inline]
    pub fn advance(&mut self, volts: f64, h: f64) {
        let Self { body, torque_per_volt, back_emf } = self;
        body.advance(h, |at| (*torque_per_volt * (volts - *back_emf * at.velocity)).into());
    }

    /// Velocity [rad/s].
    pub(crate) const fn velocity(&self) -> f64 {
        self.body.moment().velocity
    }

    #[cfg(test)]
    const fn position(&self) -> f64 {
        self.body.moment().position
    }
}

#[cfg(test)]
mod tests {
    use friction_model::{Coulomb, FrictionModel, LuGre, Proposed, Stribeck, Viscous, ViscousParameters};

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
            assert!((plant.velocity() - expected).abs() < 1e-8, "step {step}");
        }
    }

    /// Steady state: `w = K (u - 4.8426 F(w))`.
    fn settles_on_the_characteristic<M: FrictionModel>(model: M) {
        let mut plant = plant(model.clone());
        for _ in 0..4000 {
            plant.advance(3.0, 5e-4);
        }
        let w = plant.velocity();
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
        assert_eq!((plant.position(), plant.velocity()), (0.0, 0.0));
        assert!((plant.truth(volts).friction - 0.9 * 0.0994).abs() < 1e-6);
        plant.advance(1.2 * 0.0994 * 4.8426, 5e-4);
        assert!(plant.velocity() > 0.0);
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
        assert_eq!(plant.velocity(), 0.0);
        let rest = plant.position();
        plant.advance(0.0, 5e-4);
        assert_eq!(plant.position(), rest);
    }

    #[test]
    fn friction_as_volts_is_weaker_by_the_drives_constant() {
        let drive = Drive::srv02(TimeConstant::Thesis);
        let model = Coulomb::test_bed();
        let mut plant = Plant::new(&drive, FrictionCoupling::NewtonMetreAsVolt, model);
        for _ in 0..4000 {
            plant.advance(3.0, 5e-4);
        }
        assert!((plant.velocity() - drive.gain() * (3.0 - 0.0925)).abs() < 1e-9);
    }
}
