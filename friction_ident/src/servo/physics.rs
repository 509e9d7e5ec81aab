//! What a set of parameters means: every coefficient of the equations of motion.

use super::parameter::ServoParameter::{self, *};

/// All coefficients; an effect that is not fitted has its neutral value. The units are those of
/// [`ServoParameter`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Physics {
    values: [f64; ServoParameter::ALL.len()],
}

/// What friction grows with.
const FRICTION: [ServoParameter; 12] = [
    Coulomb,
    Viscous,
    Load,
    ExternalLoad,
    MotorLoad,
    StribeckCoulomb,
    StribeckLoad,
    StribeckExternal,
    StribeckMotor,
    QuadraticExternal,
    QuadraticMotor,
    LoadSquared,
];

impl Physics {
    /// The given parameters, all others neutral.
    pub fn new(parameters: &[ServoParameter], values: &[f64]) -> Self {
        let mut physics =
            Self { values: std::array::from_fn(|i| ServoParameter::ALL[i].neutral()) };
        for (&parameter, &value) in parameters.iter().zip(values) {
            physics.set(parameter, value);
            // One coefficient for both torques.
            match parameter {
                Load => {
                    physics.set(ExternalLoad, value);
                    physics.set(MotorLoad, value);
                }
                StribeckLoad => {
                    physics.set(StribeckExternal, value);
                    physics.set(StribeckMotor, value);
                }
                _ => {}
            }
        }
        physics
    }

    /// One coefficient.
    pub fn get(&self, parameter: ServoParameter) -> f64 {
        self.values[parameter as usize]
    }

    /// The same with every part of the friction times `factor`.
    pub fn with_friction(&self, factor: f64) -> Self {
        let mut physics = *self;
        for part in FRICTION {
            physics.set(part, factor * self.get(part));
        }
        physics
    }

    fn set(&mut self, parameter: ServoParameter, value: f64) {
        self.values[parameter as usize] = value;
    }

    /// Whether friction has a part that falls with speed.
    pub fn has_stribeck(&self) -> bool {
        [StribeckCoulomb, StribeckExternal, StribeckMotor, QuadraticExternal, QuadraticMotor]
            .iter()
            .any(|&parameter| self.get(parameter) != 0.0)
    }
}
