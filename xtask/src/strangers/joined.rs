//! Parts of a search over machines become one.

use std::path::Path;

use anyhow::{Result, ensure};
use serde::{Deserialize, Serialize};
use work::part::{self, Part};

use super::{Case, Strangers};

/// Name of the work in the documents of its parts.
const WORK: &str = "strangers";

/// What was asked: parts of one search have the same.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
struct Asked {
    machines: u32,
    first: u64,
    mujoco: bool,
    #[serde(default)]
    near_rest: bool,
    with: Vec<String>,
    alone: bool,
}

impl From<&Strangers> for Asked {
    fn from(asked: &Strangers) -> Self {
        let Strangers { machines, first, mujoco, near_rest, with, alone, .. } = asked;
        Self {
            machines: *machines,
            first: *first,
            mujoco: *mujoco,
            near_rest: *near_rest,
            with: with.clone(),
            alone: *alone,
        }
    }
}

/// What a part found.
#[derive(Debug, Serialize, Deserialize)]
struct Found {
    asked: Asked,
    cases: Vec<Case>,
}

/// The document of a part.
///
/// # Errors
/// If it cannot be said in JSON, a mistake of this program.
pub(super) fn document(asked: &Strangers, part: Part, cases: Vec<Case>) -> Result<String> {
    part::document(WORK, part, &Found { asked: asked.into(), cases })
}

/// The machines of all parts in a folder, in their order; and the sentence that parts are missing,
/// where some are.
///
/// # Errors
/// Where a part is of another search.
pub(super) fn join(asked: &Strangers, folder: &Path) -> Result<(Vec<Case>, Option<String>)> {
    let parts = part::read::<Found>(folder, WORK)?;
    let lacking = parts.lacking();
    let mut cases = Vec::new();
    for found in parts.found {
        let path = found.path.display();
        ensure!(found.result.asked == Asked::from(asked), "{path}: it is of another search");
        let machines = found.part.range(asked.machines).len();
        ensure!(found.result.cases.len() == machines, "{path}: expected {machines} machines");
        cases.extend(found.result.cases);
    }
    Ok((cases, lacking))
}
