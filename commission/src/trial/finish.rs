//! The task at the end: a sine, and a small move that has to be held.

use friction_ident::statistics::root_mean_square;
use serde::{Deserialize, Serialize};

use crate::axis::Axis;
use crate::bed::{Arm, Bed};
use crate::{CommissionError, Stage, hunting};

/// Length of the move and what follows, and the last part of it in which the shaft has to rest \[s\].
const SECONDS: f64 = 14.0;
const HELD: f64 = 9.0;

/// How a loop does on it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Finish {
    /// Root mean square error of the sine \[rad\].
    pub error: f64,
    /// What is missed at the end of the move \[rad\].
    pub missed: f64,
    /// Whether it hunts while it holds.
    pub hunts: bool,
}

/// Does the task.
pub(super) fn finish(axis: &mut Axis<'_>, bed: &Bed, arm: Arm) -> Result<Finish, CommissionError> {
    let bench = axis.bench()?;
    let error = bed.try_out(axis, &bench, Stage::Proof, arm)?;
    let held =
        bed.move_and_hold(axis, &bench, Stage::Proof, (arm, true), (SECONDS - HELD, SECONDS))?;
    Ok(Finish {
        error,
        missed: root_mean_square(&held),
        hunts: hunting::hunts(&held, bed.encoder_step()),
    })
}
