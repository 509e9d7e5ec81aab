//! What a run does.

use std::path::PathBuf;

use friction_model::ModelName;
use rig_driver::Calibration;
use serde::{Deserialize, Serialize};

use super::experiment::Selection;
use super::{Compensators, Origins};
use crate::characterise::TorqueReading;
use crate::compensation::{Arm, Means};
use crate::constant_velocity::SteadyJob;
use crate::protocol::{
    BreakawayRateProtocol, CompensationProtocol, ConstantVelocityProtocol, DriveExcitationProtocol,
    PreSlidingProtocol, SequenceProtocol, TrackingProtocol, VaryingVelocityProtocol,
};
use crate::test_bed::TestBed;
use crate::tracking::TrackingJob;
use rig_setup::{RigChoice, RigDescription, RigLimits};

/// How much of a run goes into the bag.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "snake_case")]
pub enum RecordPolicy {
    /// What a person looks at: the first repetition of everything, constant velocities at 50 Hz;
    /// below 300 MB
    #[default]
    Thinned,
    /// Every sample of every repetition: several gigabytes for the full protocol
    Full,
}

impl RecordPolicy {
    /// Every how many cycles a sample of this point is kept; `None` for not at all.
    #[must_use]
    pub const fn every_of_steady(self, job: &SteadyJob) -> Option<u64> {
        match (self, job.repetition) {
            (Self::Full, _) => Some(1),
            (Self::Thinned, 0) => Some(20),
            (Self::Thinned, _) => None,
        }
    }

    /// Every how many cycles a sample of this run is kept.
    #[must_use]
    pub const fn every_of_tracking(self, job: &TrackingJob) -> u64 {
        match (self, job.repetition) {
            (Self::Full, _) | (Self::Thinned, 0) => 1,
            (Self::Thinned, _) => 10,
        }
    }

    /// What was kept, in words, for the report.
    #[must_use]
    pub const fn describe(self) -> &'static str {
        match self {
            Self::Thinned => {
                "The bag is thinned: of the constant velocities it holds the first repetition of each set at 50 Hz, of tracking the first \
                 repetition at the full rate and the others at a tenth of it. All figures were computed from every sample. \
                 `--record full` keeps everything."
            }
            Self::Full => "The bag holds every sample of every repetition.",
        }
    }
}

/// How fast a simulated rig is driven.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Pace {
    /// As fast as the processors go.
    #[default]
    Offline,
    /// At the pace of the clock, one run after the other.
    RealTime,
}

/// A rig profile that a run uses.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ProfileUsed {
    /// Its file.
    pub file: PathBuf,
    /// What the real rig said of itself when the profile was written: another one is refused.
    pub description: Option<RigDescription>,
}

/// Everything a run needs to know.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RunOptions {
    /// Which experiments.
    pub experiment: Selection,
    /// Which rig. A real one takes the simulated one's place in the bench: its period, and its
    /// voltage limit where that is lower.
    pub rig: RigChoice,
    /// The rig profile that counts; none without one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rig_profile: Option<ProfileUsed>,
    /// What corrects a real rig's readings.
    pub calibration: Option<Calibration>,
    /// What was set for the rig beside the usual limits.
    pub limits: RigLimits,
    /// The bench.
    pub test_bed: TestBed,
    /// Models that compensate, each compared with none at all.
    pub models: Vec<ModelName>,
    /// By what means they compensate.
    pub means: Vec<Means>,
    /// Parameters of the compensating models; identified static parameters take their place where
    /// the run identifies.
    pub compensators: Compensators,
    /// Where the parameters come from that are no defaults; `run.json` has it as `origin`.
    #[serde(skip)]
    pub origins: Origins,
    /// Seed of everything random.
    pub seed: u64,
    /// How fast it goes.
    pub pace: Pace,
    /// How much is recorded.
    pub record: RecordPolicy,
    /// Friction at constant velocity.
    pub constant_velocity: ConstantVelocityProtocol,
    /// Friction under a varying velocity.
    pub varying_velocity: VaryingVelocityProtocol,
    /// Friction before sliding.
    pub pre_sliding: PreSlidingProtocol,
    /// Breakaway against the rate of the torque.
    pub breakaway_rate: BreakawayRateProtocol,
    /// Voltage that shows the drive.
    pub drive_excitation: DriveExcitationProtocol,
    /// A sequence of one's own.
    pub sequence: Option<SequenceProtocol>,
    /// Where the friction torque of experiments 1 to 4 is from.
    pub torque: TorqueReading,
    /// Tasks that compensations are compared in.
    pub compensation: CompensationProtocol,
    /// What is computed besides.
    #[serde(rename = "thesis_tables", serialize_with = "super::appendix::was_wanted")]
    pub appendix: Option<super::Appendix>,
    /// Tracking of velocity.
    pub velocity_tracking: TrackingProtocol,
    /// Tracking of position.
    pub position_tracking: TrackingProtocol,
    /// Threads; the results do not depend on it.
    #[serde(skip)]
    pub workers: usize,
}

impl RunOptions {
    /// Compensations compared: none, and each model.
    #[must_use]
    pub fn arms(&self) -> usize {
        Arm::all(&self.means, &self.models).len()
    }

    /// Time that the run would take on a rig \[s\].
    #[must_use]
    pub fn rig_seconds(&self) -> f64 {
        let of_parts = self.experiment.parts().map(|part| part.rig_seconds(self));
        let mut seconds: f64 = of_parts.sum();
        if let Some(appendix) = self.appendix {
            seconds += (appendix.rig_seconds)();
        }
        seconds
    }
}

/// Independent streams from one seed (the finaliser of SplitMix64, Steele, Lea and Flood 2014).
#[must_use]
pub(crate) fn stream_seed(seed: u64, stream: u64) -> u64 {
    let mut z = seed.wrapping_add(stream.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15));
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

#[cfg(test)]
pub(crate) mod tests {
    use friction_model::AnyModel;

    use super::*;
    use crate::experiments;
    use crate::protocol::ProtocolFile;

    /// A run so short that a test can afford it.
    pub fn options() -> RunOptions {
        let simulation = rig_driver::SimulationOptions::default();
        RunOptions {
            rig: RigChoice::Simulated,
            rig_profile: None,
            calibration: None,
            limits: RigLimits::default(),
            experiment: experiments::whole_job(),
            test_bed: TestBed {
                simulation: Default::default(),
                friction: AnyModel::test_bed(ModelName::Proposed),
                controller: Default::default(),
                estimator: Default::default(),
            },
            means: vec![Means::Feedback],
            models: vec![ModelName::LuGre, ModelName::Proposed],
            compensators: Compensators::default(),
            origins: Origins::default(),
            seed: 1,
            pace: Pace::Offline,
            record: RecordPolicy::Thinned,
            constant_velocity: ConstantVelocityProtocol::quick(),
            varying_velocity: VaryingVelocityProtocol::shipped().unwrap().quick(),
            pre_sliding: PreSlidingProtocol::shipped().unwrap().quick(),
            breakaway_rate: BreakawayRateProtocol::shipped().unwrap().quick(),
            drive_excitation: DriveExcitationProtocol::shipped().unwrap(),
            sequence: None,
            compensation: CompensationProtocol::shipped().unwrap().repeated(1),
            appendix: None,
            torque: TorqueReading::new(
                Default::default(),
                &simulation.drive,
                &simulation.sensors,
                TorqueReading::RELATIVE_ERRORS,
            ),
            velocity_tracking: TrackingProtocol {
                duration: 10.0,
                repetitions: 2,
                ..TrackingProtocol::velocity()
            },
            position_tracking: TrackingProtocol {
                duration: 5.0,
                repetitions: 2,
                ..TrackingProtocol::position()
            },
            workers: 2,
        }
    }

    #[test]
    fn streams_differ() {
        let seeds: std::collections::BTreeSet<u64> = (0..4)
            .flat_map(|seed| (0..1000).map(move |stream| stream_seed(seed, stream)))
            .collect();
        assert_eq!(seeds.len(), 4000);
    }

    #[test]
    fn the_full_protocol_takes_seven_hours_on_a_rig() {
        let full = RunOptions {
            constant_velocity: ConstantVelocityProtocol::default(),
            velocity_tracking: TrackingProtocol::velocity(),
            position_tracking: TrackingProtocol::position(),
            ..options()
        };
        assert!((full.rig_seconds() - (24_000.0 + 15.0 * 58.7 + 15.0 * 20.0)).abs() < 1e-9);
    }
}
