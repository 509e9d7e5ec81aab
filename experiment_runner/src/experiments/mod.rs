//! The experiments, one file each, and their registry: [`all`]. To add one, write its file and a
//! line in [`all`]; the command, the node, the lists and the tests over all read from there.

mod breakaway_rate;
mod compensation;
mod constant_velocity;
mod drive_excitation;
mod excitations;
mod pre_sliding;
mod sequence;
mod tracking;
mod varying_velocity;

#[cfg(test)]
mod tests;

use std::sync::Arc;

use controller::ControlMode;

pub use self::breakaway_rate::BreakawayRate;
pub use self::compensation::Compensation;
pub use self::constant_velocity::ConstantVelocity;
pub use self::drive_excitation::DriveExcitation;
pub use self::pre_sliding::PreSliding;
pub use self::sequence::Sequence;
pub use self::tracking::Tracking;
pub use self::varying_velocity::VaryingVelocity;
use crate::protocol::{ProtocolError, experiment_of};
use crate::run::experiment::{Experiment, Selection};

/// Every experiment, in the order in which lists show them.
#[must_use]
pub fn all() -> Vec<Arc<dyn Experiment>> {
    vec![
        Arc::new(ConstantVelocity),
        Arc::new(VaryingVelocity),
        Arc::new(PreSliding),
        Arc::new(BreakawayRate),
        Arc::new(Compensation),
        Arc::new(DriveExcitation),
        Arc::new(Sequence),
        Arc::new(Tracking(ControlMode::Velocity)),
        Arc::new(Tracking(ControlMode::Position)),
    ]
}

/// Everything that a run can be: several experiments in a row, or one.
#[must_use]
pub fn selections() -> Vec<Selection> {
    let mut selections = vec![whole_job(), characterise()];
    selections.extend(all().into_iter().map(Selection::alone));
    selections
}

/// Characterise, identify, compensate with what was identified, compare.
#[must_use]
pub fn whole_job() -> Selection {
    Selection::of(
        "all",
        "Characterise, identify, compensate with what was identified, compare",
        vec![
            Arc::new(ConstantVelocity),
            Arc::new(Tracking(ControlMode::Velocity)),
            Arc::new(Tracking(ControlMode::Position)),
        ],
    )
}

/// Experiments 1 to 4.
#[must_use]
pub fn characterise() -> Selection {
    Selection::of(
        crate::run::CHARACTERISE,
        "Experiments 1 to 4: constant and varying velocity, pre-sliding, breakaway against rate",
        vec![
            Arc::new(ConstantVelocity),
            Arc::new(VaryingVelocity),
            Arc::new(PreSliding),
            Arc::new(BreakawayRate),
        ],
    )
}

/// The selection of that name.
#[must_use]
pub fn selection(name: &str) -> Option<Selection> {
    selections().into_iter().find(|selection| selection.as_str() == name)
}

/// The experiment that a protocol file describes.
///
/// # Errors
/// [`ProtocolError`] if there is none, with those that there are.
pub fn of_protocol(text: &str) -> Result<Arc<dyn Experiment>, ProtocolError> {
    let name = experiment_of(text)?;
    let with_protocol = || all().into_iter().filter(|one| one.protocol().is_some());
    with_protocol().find(|experiment| experiment.name() == name).ok_or_else(|| {
        let known = with_protocol().map(|one| one.name()).collect::<Vec<_>>().join(", ");
        ProtocolError::Unknown { name, known }
    })
}
