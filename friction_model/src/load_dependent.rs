//! Friction that grows with the load: every level affine in the torque that the contact transmits.
//!
//! ```text
//! F(v, T) = (1 + c |T|) (F - f_v v) + f_v v
//! ```
//!
//! so that the Coulomb level is `F_c + c F_c |T|`, and likewise every other level of the model. `T`
//! is the transmitted torque \[N m\] (or force), `c` the relative increase per torque \[1/(N m)\];
//! the viscous part does not depend on the load. The thesis names load dependence as future work;
//! gears show it (the slope `c F_c` is what a load experiment measures).
//!
//! The model's own states do not see the load: more bristles carry a higher load, each deflecting
//! as before, so stiffness and levels grow together and the breakaway deflection stays. For a
//! constant load the model is as passive as it was; a load that changes while the bristles are
//! deflected works on them, and that work is not friction's.

use crate::{FrictionModel, ModelError, Range, Real, State, Stepper, TimeStep, Unit};

/// A model with load-dependent levels, stepped with velocity and load.
#[derive(Debug, Clone)]
pub struct LoadDependent<M: FrictionModel<T>, T: Real = f64> {
    stepper: Stepper<M, T>,
    gain: T,
}

impl<T: Real, M: FrictionModel<T>> LoadDependent<M, T> {
    /// Starts `model` at rest with the period `dt`; its levels rise by `gain` \[1/(N m)\] of
    /// themselves per unit of load.
    ///
    /// # Errors
    /// [`ModelError::OutOfRange`] unless `gain` is finite and not below zero.
    pub fn new(model: M, gain: T, dt: TimeStep) -> Result<Self, ModelError> {
        if Range::NonNegative.holds(gain) {
            Ok(Self { stepper: Stepper::new(model, dt), gain })
        } else {
            let (parameter, expected) = ("load_gain", Range::NonNegative);
            Err(ModelError::OutOfRange {
                model: M::NAME,
                parameter,
                value: gain.double(),
                unit: Unit::None,
                expected,
            })
        }
    }

    /// The friction now at `velocity` under the transmitted torque `load`; the state then advances
    /// by one period. A load that is not finite counts as none.
    #[inline]
    pub fn step(&mut self, velocity: T, load: T) -> T {
        let load = if load.is_finite() { load.abs() } else { T::ZERO };
        let velocity = crate::arithmetic::bounded(velocity);
        let force = self.stepper.step(velocity);
        let viscous = self.stepper.model().viscous(velocity);
        loaded(force, viscous, self.gain, load)
    }

    /// The model's state.
    #[must_use]
    pub const fn state(&self) -> &State<M::Continuous, M::Memory> {
        self.stepper.state()
    }
}

/// `force` of a contact, of which `viscous` is viscous, under the load's magnitude `load`.
#[inline]
#[must_use]
pub fn loaded<T: Real>(force: T, viscous: T, gain: T, load: T) -> T {
    (T::ONE + gain * load) * (force - viscous) + viscous
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Proposed;

    #[test]
    fn the_sliding_level_is_affine_in_the_load() {
        let model = Proposed::test_bed();
        let p = *model.parameters();
        let dt = TimeStep::new(1e-3).unwrap();
        for load in [0.0, 0.3, -0.3, 2.0] {
            let mut contact = LoadDependent::new(model, 0.5, dt).unwrap();
            let v = 3.0;
            let force = (0..2000).map(|_| contact.step(v, load)).last().unwrap();
            let expected = p.f_c * (1.0 + 0.5 * f64::abs(load)) + p.f_v * v;
            assert!((force - expected).abs() < 1e-9, "{load}: {force} is not {expected}");
        }
        assert!(LoadDependent::new(model, -0.1, dt).is_err());
    }
}
