//! What tells friction models apart, computed.

mod breakaway;
mod contact;
pub mod describing_function;
mod features;
mod frictional_lag;
pub mod limit_cycle;
mod non_drift;
mod non_local_memory;
mod sensitivity;
mod settle;
mod steady_state;
mod stick_slip;
mod thinned;
mod time_scales;
mod zero_crossing;

pub use breakaway::{Breakaway, BreakawayCourse, BreakawaySettings, breakaway};
pub use contact::{Contact, FreeBody, Prescribed};
pub use features::{FeatureFigure, FeatureSettings, Features, features};
pub use frictional_lag::{FrictionalLag, FrictionalLagCourse, FrictionalLagSettings, frictional_lag};
pub use non_drift::{NonDrift, NonDriftCourse, NonDriftSettings, non_drift};
pub use non_local_memory::{NonLocalMemory, NonLocalMemoryCourse, NonLocalMemorySettings, non_local_memory};
pub use sensitivity::{
    Elasticities, ParameterSensitivity, Response, Sensitivity, SensitivitySettings, sensitivity,
};
pub use settle::{Evidence, Figure, Settling, settle};
pub use steady_state::{SteadyState, SteadyStateCurve, SteadyStateSettings, steady_state};
pub use stick_slip::{Motion, StickSlip, StickSlipCourse, StickSlipSettings, stick_slip};
pub use time_scales::TimeScales;
pub use zero_crossing::{ZeroCrossing, ZeroCrossingCourse, ZeroCrossingSettings, zero_crossing};
