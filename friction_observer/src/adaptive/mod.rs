//! Friction models that follow friction which drifts: on-line estimation of the friction level and
//! of selected parameters.
//!
//! * [`FrictionLevel`]: one factor on the model's torque.
//! * [`FrictionParameters`]: the parameters that enter linearly while sliding.
//! * [`Stiffness`]: the stiffness of pre-sliding, which enters nonlinearly, by a gradient law over
//!   models side by side.
//! * [`LeastSquares`]: recursive least squares with forgetting, limits of the covariance and of the
//!   parameters.
//!
//! All compare the model's torque with the torque that the nominal drive infers from voltage and
//! velocity, both through the same filter, so that no torque sensor is needed; where there is one
//! it can be used instead. All stand still while the excitation is poor ([`Excitation`]).

mod excitation;
mod least_squares;
mod level;
mod measured;
mod parameters;
mod stiffness;

pub use excitation::Excitation;
pub use least_squares::LeastSquares;
pub use level::{FrictionLevel, LevelOptions};
pub use measured::Measured;
pub use parameters::{FrictionParameters, ParameterOptions};
pub use stiffness::{Stiffness, StiffnessOptions};
