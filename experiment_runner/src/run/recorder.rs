//! The bag of a run: cycles, the status of the experiment, and everything needed to repeat it.

use std::collections::BTreeMap;
use std::path::Path;

use msgs::friction_msgs::ExperimentStatus;
use msgs::std_msgs::Header;
use msgs::topics;

use super::{RunError, RunOptions};
use crate::bag::{BagError, BagOptions, BagSummary, BagWriter};
use crate::cycle::CycleSample;
use crate::messages::{CycleTopics, EncodedCycle};
use crate::rig::RigChoice;

/// Pause between two runs on the bag's time axis [ns]. The shaft is at rest then.
const PAUSE_NS: u64 = 1_000_000_000;

/// Hands out the time at which each run starts: one after the other, as on a rig.
#[derive(Debug, Clone, Copy)]
pub(super) struct Timeline {
    next_ns: u64,
}

impl Timeline {
    /// Times from `epoch` on [ns since the Unix epoch].
    pub const fn from(epoch: u64) -> Self {
        Self { next_ns: epoch }
    }

    /// Start of a run of `seconds` [ns since the Unix epoch].
    pub fn start_of(&mut self, seconds: f64) -> u64 {
        let start = self.next_ns;
        self.next_ns += (seconds * 1e9).round() as u64 + PAUSE_NS;
        start
    }
}

/// Cycles of one run that go into the bag, encoded on the thread that ran it.
#[derive(Debug)]
pub(super) struct Kept {
    every: Option<u64>,
    cycles: Vec<EncodedCycle>,
    error: Option<BagError>,
}

impl Kept {
    /// Keeps one of `every` so many cycles, or none.
    pub const fn one_of(every: Option<u64>) -> Self {
        Self { every, cycles: Vec::new(), error: None }
    }

    /// Takes a cycle in, if it is one to be kept.
    pub fn add(&mut self, sample: &CycleSample) {
        if self.every.is_some_and(|every| sample.measurement.cycle.is_multiple_of(every))
            && self.error.is_none()
        {
            let mut cycle = EncodedCycle::default();
            match cycle.encode(sample) {
                Ok(()) => self.cycles.push(cycle),
                Err(error) => self.error = Some(error),
            }
        }
    }
}

/// The bag that is being written.
pub(super) struct Recorder {
    bag: BagWriter,
    topics: CycleTopics,
    bag_path: String,
}

impl Recorder {
    /// Starts the bag with the seed, the version and the options of the run.
    pub fn create(dir: &Path, options: &RunOptions) -> Result<Self, RunError> {
        let mut bag = BagWriter::create(dir, BagOptions::default())?;
        let topics = CycleTopics::open(&mut bag)?;
        let about = BTreeMap::from([
            ("program".to_owned(), format!("frictionlab {}", env!("CARGO_PKG_VERSION"))),
            ("experiment".to_owned(), options.experiment.as_str().to_owned()),
            ("seed".to_owned(), options.seed.to_string()),
            ("rig".to_owned(), options.rig.to_string()),
            (
                "epoch".to_owned(),
                match options.rig {
                    RigChoice::Simulated => "2017-11-01T00:00:00Z, fixed for offline runs".to_owned(),
                    _ => "the clock of this machine".to_owned(),
                },
            ),
            ("recorded".to_owned(), options.record.describe().to_owned()),
        ]);
        bag.metadata("frictionlab", about)?;
        let text = serde_json::to_string_pretty(options)
            .map_err(|e| RunError::Describe { what: "JSON", detail: e.to_string() })?;
        bag.attach("options.json", "application/json", text.as_bytes())?;
        Ok(Self { bag, topics, bag_path: dir.display().to_string() })
    }

    /// Writes the cycles that were kept.
    pub fn write(&mut self, kept: Kept) -> Result<(), RunError> {
        if let Some(error) = kept.error {
            return Err(error.into());
        }
        for cycle in &kept.cycles {
            self.topics.write(&mut self.bag, cycle)?;
        }
        Ok(())
    }

    /// Says on `/experiment_status` what begins.
    pub fn status(
        &mut self,
        stamp_ns: u64,
        experiment: &str,
        stage: &str,
        progress: f64,
    ) -> Result<(), RunError> {
        let status = ExperimentStatus {
            header: Header::at(stamp_ns),
            experiment: experiment.to_owned(),
            stage: stage.to_owned(),
            progress,
            bag_path: self.bag_path.clone(),
            ..Default::default()
        };
        Ok(self.bag.write(topics::EXPERIMENT_STATUS.name, stamp_ns, &status)?)
    }

    /// Keeps a file with the bag.
    pub fn attach(&mut self, name: &str, media_type: &str, text: &str) -> Result<(), RunError> {
        Ok(self.bag.attach(name, media_type, text.as_bytes())?)
    }

    /// Hands everything to the system.
    pub fn flush(&mut self) -> Result<(), RunError> {
        Ok(self.bag.flush()?)
    }

    /// Closes the bag.
    pub fn finish(self) -> Result<BagSummary, RunError> {
        Ok(self.bag.finish()?)
    }
}
