//! What every friction model keeps, to be checked in the tests of a model of your own.
//!
//! ```
//! use friction_model::{LuGre, invariants};
//!
//! invariants::check(&LuGre::test_bed()).unwrap();
//! ```

use crate::arithmetic::bounded;
use crate::{FrictionModel, ModelError, Stepper, TimeStep};

/// What a model does not keep.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Broken {
    /// A force or an inner quantity is not finite.
    #[error(
        "{what} must be a finite number whatever the velocity, but is {value} at {velocity}; bound the velocity with arithmetic::bounded"
    )]
    NotFinite {
        /// Which quantity.
        what: &'static str,
        /// What came.
        value: f64,
        /// The velocity \[m/s or rad/s\].
        velocity: f64,
    },
    /// In steady sliding the friction drives the motion.
    #[error(
        "steady sliding must take energy, but the force is {force} at {velocity}; friction opposes motion by having its sign"
    )]
    Drives {
        /// The force \[N or N m\].
        force: f64,
        /// The velocity \[m/s or rad/s\].
        velocity: f64,
    },
    /// The same motion gives another force.
    #[error(
        "the same motion from rest must give the same force to the last bit, but step {step} gives {first}, then {second}; keep all that the model remembers in its State"
    )]
    NotReproducible {
        /// Which step.
        step: u32,
        /// The force at first \[N or N m\].
        first: f64,
        /// The force the second time \[N or N m\].
        second: f64,
    },
    /// The model does not begin without force.
    #[error("a contact at rest must carry no force, but carries {0}; see FrictionModel::rest")]
    LoadedAtRest(f64),
    /// The period was refused.
    #[error(transparent)]
    Model(#[from] ModelError),
}

/// Velocities that a broken sensor may deliver, and some of a working one.
const VELOCITIES: [f64; 12] = [
    0.1,
    f64::NAN,
    -0.1,
    f64::INFINITY,
    1e-9,
    f64::NEG_INFINITY,
    0.0,
    1e300,
    -1e-3,
    f64::MIN_POSITIVE,
    -1e6,
    3.0,
];

/// Checks that `model` stays finite whatever a sensor says, at any period; that it takes energy in
/// steady sliding; that it begins without force, and that the same motion gives the same forces.
///
/// Whether it takes energy in every motion is not checked: several well-known models do not.
///
/// # Errors
/// The first thing that is [`Broken`].
pub fn check<M: FrictionModel>(model: &M) -> Result<(), Broken> {
    for velocity in [1e-6, 1e-3, 0.1, 1.0, 10.0].into_iter().flat_map(|v| [v, -v]) {
        let force = model.steady_state(velocity);
        finite("the steady state", force, velocity)?;
        if force * velocity < 0.0 {
            return Err(Broken::Drives { force, velocity });
        }
    }
    for seconds in [1e-5, 1e-3, 1e-2] {
        let mut contact = Stepper::new(model.clone(), TimeStep::new(seconds)?);
        let at_rest = contact.step(0.0);
        if at_rest.abs() > 1e-9 * model.steady_state(1.0).abs() {
            return Err(Broken::LoadedAtRest(at_rest));
        }
        for &velocity in VELOCITIES.iter().cycle().take(200) {
            finite("the force", contact.step(velocity), velocity)?;
            finite("the force", contact.step_injected(velocity, velocity), velocity)?;
            let inside = contact.internals(bounded(velocity));
            finite("the deflection", inside.deflection, velocity)?;
            finite("the level", inside.gamma, velocity)?;
        }
        let mut second = Stepper::new(model.clone(), TimeStep::new(seconds)?);
        contact.reset();
        for step in 0..2000 {
            let velocity = motion(step);
            let [first, second] = [&mut contact, &mut second].map(|one| one.step(velocity));
            if first.to_bits() != second.to_bits() {
                return Err(Broken::NotReproducible { step, first, second });
            }
        }
    }
    Ok(())
}

fn finite(what: &'static str, value: f64, velocity: f64) -> Result<(), Broken> {
    if value.is_finite() { Ok(()) } else { Err(Broken::NotFinite { what, value, velocity }) }
}

/// A triangle with a smaller one on it: sliding, reversals and inner loops.
fn motion(step: u32) -> f64 {
    let triangle = |period: u32| {
        let phase = f64::from(step % period) / f64::from(period);
        if phase < 0.5 { 4.0 * phase - 1.0 } else { 3.0 - 4.0 * phase }
    };
    0.3 * triangle(700) + 0.1 * triangle(90)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{AnyModel, ModelName, ModelVisitor};

    struct Check;

    impl ModelVisitor for Check {
        type Output = Result<(), Broken>;
        fn visit<M: FrictionModel>(self, model: M) -> Self::Output {
            check(&model)
        }
    }

    #[test]
    fn every_built_in_model_keeps_them() {
        for name in ModelName::ALL {
            let [a, b] = [AnyModel::test_bed(name), AnyModel::chapter_3(name)];
            for model in [a, b, AnyModel::asymmetric(&a, &b).unwrap()] {
                if let Err(broken) = model.visit(Check) {
                    panic!("{name}: {broken}");
                }
            }
        }
    }
}
