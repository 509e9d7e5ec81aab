//! What somebody else computes behind an experiment, for the run's page and record: the thesis's
//! tables of compensation are such a thing.

use std::fmt;
use std::sync::atomic::AtomicBool;

use identification::asked::friction::Beside as BesideFriction;
use report::figure::Block;
use serde::{Serialize, Serializer};
use serde_json::Value;
use work::progress::Progress;

use super::RunError;

/// Computes an appendix from the run's seed and number of threads. Once the switch is set it ends
/// with what there is.
pub type Compute = fn(u64, usize, &Progress, &AtomicBool) -> Result<Appended, RunError>;

/// An appendix that a run can have.
#[derive(Clone, Copy)]
pub struct Appendix {
    /// Time that it would take on a rig \[s\].
    pub rig_seconds: fn() -> f64,
    /// Computes it.
    pub compute: Compute,
}

/// An appendix that was computed.
#[derive(Debug, Clone, Default)]
pub struct Appended {
    /// For `run.json`.
    pub record: Value,
    /// For the page.
    pub blocks: Vec<Block>,
    /// For the terminal.
    pub text: String,
    /// Whether it is whole.
    pub complete: bool,
}

/// What a program has beside experiments and identification: nothing by default.
#[derive(Debug, Clone, Copy, Default)]
pub struct Beside {
    /// Behind an experiment.
    pub run: Option<Appendix>,
    /// Beside identified friction models.
    pub friction: Option<BesideFriction>,
}

impl fmt::Debug for Appendix {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Appendix")
    }
}

/// There is one appendix, and a run has it or not.
impl PartialEq for Appendix {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

impl Eq for Appendix {}

/// Two programs differ in what they have, not in where its code lies.
impl PartialEq for Beside {
    fn eq(&self, other: &Self) -> bool {
        self.run == other.run && self.friction.is_some() == other.friction.is_some()
    }
}

impl Eq for Beside {}

/// A record says that a run had it.
impl Serialize for Appendix {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        to.serialize_bool(true)
    }
}

/// False where a run had none.
pub(super) fn was_wanted<S: Serializer>(of: &Option<Appendix>, to: S) -> Result<S::Ok, S::Error> {
    to.serialize_bool(of.is_some())
}

impl Serialize for Appended {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        self.record.serialize(to)
    }
}
