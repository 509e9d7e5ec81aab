//! What a program offers on request beside experiments: long work on a rig that has options, a
//! folder and results of its own, such as a commission.

use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use clap::Command;
use msgs::friction_msgs::EstimatedParameter;
use rig_setup::RigChoice;
use work::progress::Progress;

/// Work that can be asked for by name.
pub trait Errand: Send + Sync {
    /// Its name, as an experiment has one.
    fn name(&self) -> &'static str;

    /// What it does, in one line.
    fn about(&self) -> &'static str;

    /// Its options, as the command line has them.
    fn command(&self) -> Command;

    /// Options that are about the terminal, or for whoever starts the runner: a request has none of
    /// them.
    fn reserved(&self) -> &'static [&'static str];

    /// Time that it usually takes on a rig \[s\].
    fn rig_seconds(&self) -> f64;

    /// What is to be done on that rig, with its profile where one counts. Nothing has moved or been
    /// written by then.
    ///
    /// # Errors
    /// What was wrong with the options, for people.
    fn prepare(
        &self,
        options: &[String],
        rig: &RigChoice,
        profile: Option<&Path>,
    ) -> Result<Box<dyn Prepared>, String>;
}

/// Work that was asked for, with its options.
pub trait Prepared: Send {
    /// Time that it may take on a rig \[s\].
    fn rig_seconds(&self) -> f64;

    /// The folder in which it goes on; none for a new one.
    fn resumes(&self) -> Option<PathBuf>;

    /// Does it; once `cancel` is set it ends at zero volts and keeps what is done.
    fn carry_out(
        self: Box<Self>,
        folder: &Path,
        progress: &Progress,
        cancel: &Arc<AtomicBool>,
    ) -> Carried;
}

/// How work ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ending {
    /// At its end.
    Complete,
    /// Somebody stopped it.
    Stopped,
    /// It could not go on.
    Failed,
}

/// What came of work.
#[derive(Debug, Clone)]
pub struct Carried {
    /// How it ended.
    pub ending: Ending,
    /// For people: what happened, and how to go on.
    pub message: String,
    /// What was found.
    pub parameters: Vec<EstimatedParameter>,
}

/// The work that a program offers.
#[derive(Clone, Copy, Default)]
pub struct Errands(pub &'static [&'static dyn Errand]);

impl Errands {
    /// That of the name.
    #[must_use]
    pub fn named(&self, name: &str) -> Option<&'static dyn Errand> {
        self.0.iter().copied().find(|errand| errand.name() == name)
    }
}

impl fmt::Debug for Errands {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_list().entries(self.0.iter().map(|errand| errand.name())).finish()
    }
}

/// Two programs differ in what they offer, not in where its code lies.
impl PartialEq for Errands {
    fn eq(&self, other: &Self) -> bool {
        self.0.iter().map(|errand| errand.name()).eq(other.0.iter().map(|errand| errand.name()))
    }
}

impl Eq for Errands {}
