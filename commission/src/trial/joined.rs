//! Parts of a trial become one.

use serde::{Deserialize, Serialize};
use work::BadInput;
use work::part::Parts;

use super::{Case, Trial};
use crate::friction::wanted::Wanted;

/// What was asked: parts of one trial have the same.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Asked {
    machines: u32,
    seed: u64,
    wanted: Wanted,
    allowed_s: f64,
    protocols: bool,
}

impl From<&Trial> for Asked {
    fn from(trial: &Trial) -> Self {
        Self {
            machines: trial.machines,
            seed: trial.seed,
            wanted: trial.wanted.clone(),
            allowed_s: trial.allowed,
            protocols: trial.protocol.is_some(),
        }
    }
}

/// A part of a trial.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TrialPart {
    asked: Asked,
    cases: Vec<Case>,
}

impl TrialPart {
    /// What came of some of the machines of `trial`.
    #[must_use]
    pub fn new(trial: &Trial, cases: Vec<Case>) -> Self {
        Self { asked: trial.into(), cases }
    }
}

/// The machines of all parts, in their order.
///
/// # Errors
/// [`BadInput`] for a part of another trial.
pub fn join(trial: &Trial, parts: Parts<TrialPart>) -> Result<Vec<Case>, BadInput> {
    let mut cases = Vec::new();
    for part in parts.found {
        if part.result.asked != Asked::from(trial) {
            let why = "it is a part of a trial with other options; --join needs them as they were with --part";
            return Err(part.refused(why));
        }
        let machines = part.part.range(trial.machines).len();
        let found = part.result.cases.len();
        if found != machines {
            return Err(part.refused(format!("expected {machines} machines, but it has {found}")));
        }
        cases.extend(part.result.cases);
    }
    Ok(cases)
}
