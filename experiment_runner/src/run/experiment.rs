//! What a run is made of. Anybody can write an experiment: implement [`Experiment`] and run
//! [`Selection::alone`] of it.

use std::collections::BTreeMap;
use std::fmt;
use std::sync::Arc;

use report::figure::Block;
use serde::{Serialize, Serializer};
use serde_json::Value;
use work::sequencer::Completion;

use super::bench::Bench;
use super::recorder::{Recorder, Timeline};
use super::results::Identification;
use super::sorted::Sorted;
use super::{Characterisation, Compensators, RunError, RunOptions};
use crate::constant_velocity::SteadyRun;
use crate::protocol::ProtocolError;

/// Puts a protocol that was read in the place of the usual one.
pub type Put = Box<dyn FnOnce(&mut RunOptions)>;

/// One experiment: what it drives, and what it makes of it.
pub trait Experiment: fmt::Debug + Send + Sync {
    /// Its name on the command line, in protocol files and on `/experiment_status`.
    fn name(&self) -> &'static str;

    /// What it does, in one line.
    fn about(&self) -> &'static str;

    /// Time that it takes on a rig \[s\].
    fn rig_seconds(&self, options: &RunOptions) -> f64;

    /// Does it: drives the rig, and leaves in `running.found` what came of it.
    ///
    /// # Errors
    /// [`RunError`] for what ends the run. What a rig says in the middle of it is no error: the
    /// runs end early, and [`Progressed::completion`] says so.
    fn carry_out(&self, running: &mut Running<'_, '_>) -> Result<Progressed, RunError>;

    /// Its protocol file that is part of the program, with comments; none if it takes no file.
    fn protocol(&self) -> Option<&'static str> {
        None
    }

    /// Reads a protocol file of its own.
    ///
    /// # Errors
    /// [`ProtocolError`] with the key, or the line and column, that is wrong.
    fn read(&self, _text: &str) -> Result<Put, ProtocolError> {
        Err(ProtocolError::None { name: self.name() })
    }

    /// Whether it runs only with a protocol file that somebody gives.
    fn needs_protocol(&self) -> bool {
        false
    }

    /// Makes it short, to try things out.
    fn shorten(&self, _options: &mut RunOptions) {}

    /// Sets how often each of its runs is repeated.
    fn repeat(&self, _options: &mut RunOptions, _repetitions: u32) {}

    /// Whether it reads the friction torque: a rig must then have what tells it.
    fn reads_torque(&self) -> bool {
        true
    }

    /// Whether it can run with these options. Nothing has moved or been written by then.
    ///
    /// # Errors
    /// [`RunError`] says what is out of range.
    fn check(&self, _options: &RunOptions) -> Result<(), RunError> {
        Ok(())
    }
}

/// How far an experiment came.
#[derive(Debug, Clone, PartialEq)]
pub struct Progressed {
    /// Whether all its runs were driven.
    pub completion: Completion,
    /// Time on the rig \[s\].
    pub rig_seconds: f64,
    /// Why the experiments behind it make no sense, where its own runs came to their end.
    pub ended: Option<String>,
}

impl Progressed {
    /// So much rig time \[s\], and nothing against going on.
    #[must_use]
    pub const fn new(completion: Completion, rig_seconds: f64) -> Self {
        Self { completion, rig_seconds, ended: None }
    }
}

/// A run under way, as its experiments see it.
pub struct Running<'bench, 'run> {
    pub(crate) bench: &'run Bench<'bench>,
    pub(crate) recorder: &'run mut Recorder,
    pub(crate) timeline: &'run mut Timeline,
    /// Parameters of the compensating models; what an experiment identifies takes their place.
    pub models: &'run mut Compensators,
    /// What was found so far.
    pub found: &'run mut Found,
}

impl<'bench> Running<'bench, '_> {
    /// What was asked for.
    #[must_use]
    pub const fn options(&self) -> &'bench RunOptions {
        self.bench.options
    }
}

/// What the experiments of a run found.
#[derive(Debug, Default)]
pub struct Found {
    /// Points at constant velocity.
    pub steady: Vec<SteadyRun>,
    /// The Stribeck curve through them.
    pub identification: Option<Identification>,
    /// Experiments 2 to 4.
    pub characterisation: Characterisation,
    /// Compensations compared.
    pub(crate) tracked: Sorted,
    /// Figures of other experiments, by name: each is a key of `run.json`.
    pub own: BTreeMap<String, Value>,
    /// What other experiments show on the page.
    pub blocks: Vec<Block>,
    /// Tables of other experiments: name of the file, comma-separated values.
    pub tables: Vec<(String, String)>,
}

/// What a run does: one experiment, or several one after the other.
#[derive(Debug, Clone)]
pub struct Selection {
    name: &'static str,
    about: &'static str,
    parts: Vec<Arc<dyn Experiment>>,
}

impl Selection {
    /// One experiment.
    #[must_use]
    pub fn alone(experiment: Arc<dyn Experiment>) -> Self {
        Self { name: experiment.name(), about: experiment.about(), parts: vec![experiment] }
    }

    /// Several, in that order, under a name of their own.
    #[must_use]
    pub const fn of(
        name: &'static str,
        about: &'static str,
        parts: Vec<Arc<dyn Experiment>>,
    ) -> Self {
        Self { name, about, parts }
    }

    /// Its name on the command line.
    #[must_use]
    pub const fn as_str(&self) -> &'static str {
        self.name
    }

    /// What it does, in one line.
    #[must_use]
    pub const fn about(&self) -> &'static str {
        self.about
    }

    /// Its experiments, in their order.
    pub fn parts(&self) -> impl Iterator<Item = &dyn Experiment> {
        self.parts.iter().map(AsRef::as_ref)
    }

    /// Whether the experiment of that name is part of it.
    #[must_use]
    pub fn includes(&self, name: &str) -> bool {
        self.parts().any(|part| part.name() == name)
    }
}

/// Selections differ in their names.
impl PartialEq for Selection {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

impl Serialize for Selection {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        to.serialize_str(self.name)
    }
}
