//! The drive with friction: a [`Body`] that a motor turns.

use friction_model::{Body, FrictionModel, Moment, Motor};

use crate::FrictionCoupling;

/// What a simulation knows and no sensor shows.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Truth {
    /// Position \[rad\].
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
    /// Drive torque per volt, A K_m / R_a [N m/V], for a shaft on which the whole friction torque
    /// acts.
    torque_per_volt: f64,
    back_emf: f64,
    /// Inertia of that shaft [kg m^2].
    inertia: f64,
    /// Friction torque over the model's.
    friction_factor: f64,
}

impl<M: FrictionModel> Plant<M> {
    /// A plant at rest at position zero.
    ///
    /// Of friction that is coupled as volts only a part acts on the shaft; that is a shaft with the
    /// same friction, but so much more inertia and drive torque.
    #[must_use]
    pub fn new(motor: &Motor, coupling: FrictionCoupling, model: M) -> Self {
        let coupling = coupling.volts_per_newton_metre(motor) / motor.volts_per_newton_metre();
        let inertia = motor.inertia / coupling;
        Self {
            body: Body::new(model, inertia),
            torque_per_volt: 1.0 / (motor.volts_per_newton_metre() * coupling),
            back_emf: motor.back_emf(),
            inertia,
            friction_factor: 1.0,
        }
    }

    /// From now on the friction torque is `factor` times the model's, above zero. For the model
    /// that is a shaft with so much less inertia and drive torque.
    pub fn set_friction_factor(&mut self, factor: f64) {
        if factor != self.friction_factor {
            self.friction_factor = factor;
            self.body.set_inertia(self.inertia / factor);
        }
    }

    /// Position, velocity and friction while `volts` are applied.
    #[inline]
    #[must_use]
    pub fn truth(&self, volts: f64) -> Truth {
        let &Moment { position, velocity, .. } = self.body.moment();
        let torque_per_volt = self.torque_per_volt / self.friction_factor;
        let friction = self.body.friction(torque_per_volt * (volts - self.back_emf * velocity));
        Truth { position, velocity, friction: self.friction_factor * friction }
    }

    /// Advances by `h` \[s\] with `volts` held.
    #[inline]
    pub fn advance(&mut self, volts: f64, h: f64) {
        let (torque_per_volt, back_emf) =
            (self.torque_per_volt / self.friction_factor, self.back_emf);
        self.body.advance(h, |at| (torque_per_volt * (volts - back_emf * at.velocity)).into());
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
    use friction_model::{
        Coulomb, FrictionModel, LuGre, Proposed, Stribeck, Viscous, ViscousParameters,
    };

    use super::*;

    fn plant<M: FrictionModel>(model: M) -> Plant<M> {
        Plant::new(&Motor::SRV02, FrictionCoupling::Physical, model)
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
        let drive = Motor::SRV02;
        let expected =
            drive.gain() * (3.0 - drive.volts_per_newton_metre() * model.steady_state(w));
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

    /// With friction times 1.3 the steady state is `w = K (u - 1.3 r F(w))`, and the shaft without
    /// friction is as quick as before.
    #[test]
    fn a_friction_factor_scales_the_friction_and_nothing_else() {
        let mut plant = plant(Proposed::test_bed());
        plant.set_friction_factor(1.3);
        for _ in 0..4000 {
            plant.advance(3.0, 5e-4);
        }
        let (w, drive) = (plant.velocity(), Motor::SRV02);
        let friction = 1.3 * Proposed::test_bed().steady_state(w);
        let expected = drive.gain() * (3.0 - drive.volts_per_newton_metre() * friction);
        assert!((w - expected).abs() < 1e-9, "{w} is not {expected}");
        assert!((plant.truth(3.0).friction - friction).abs() < 1e-9);
        let mut free = Plant::new(
            &drive,
            FrictionCoupling::Physical,
            Viscous::try_from(ViscousParameters { f_v: 0.0 }).unwrap(),
        );
        free.set_friction_factor(1.3);
        (0..100).for_each(|_| free.advance(2.0, 5e-4));
        let expected = 2.0 * drive.gain() * (1.0 - (-0.05 / drive.time_constant()).exp());
        assert!((free.velocity() - expected).abs() < 1e-8);
    }

    #[test]
    fn friction_as_volts_is_weaker_by_the_drives_constant() {
        let drive = Motor::SRV02;
        let model = Coulomb::test_bed();
        let mut plant = Plant::new(&drive, FrictionCoupling::NewtonMetreAsVolt, model);
        for _ in 0..4000 {
            plant.advance(3.0, 5e-4);
        }
        assert!((plant.velocity() - drive.gain() * (3.0 - 0.0925)).abs() < 1e-9);
    }
}
