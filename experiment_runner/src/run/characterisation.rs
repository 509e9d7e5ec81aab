//! What experiments 2 to 4 find.

use serde::Serialize;

use super::mean_record::MeanRecord;
use crate::characterise::Measured;

/// What experiments 2 to 4 found; none of those that were not run.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Characterisation {
    /// Experiment 2: one entry a frequency.
    pub lag: Vec<LagFigures>,
    /// Experiment 3, stage 1: upwards and downwards.
    pub ramps: Vec<BreakawayFigures>,
    /// Experiment 3, stage 2: the closed loops.
    pub closures: Vec<ClosureFigures>,
    /// Experiment 4: ramps and sines.
    pub rates: Vec<BreakawayFigures>,
    /// What went otherwise than planned.
    pub notes: Vec<String>,
    /// Recordings, means over the repetitions, for the files beside the bag.
    #[serde(skip)]
    pub(crate) records: Vec<(String, MeanRecord)>,
    /// The nested path, means over the repetitions: displacement \[rad\] and torque [N m].
    #[serde(skip)]
    pub(crate) path: (Vec<f64>, Vec<f64>),
}

/// Frictional lag at one frequency.
#[derive(Debug, Clone, Serialize)]
pub struct LagFigures {
    /// Angular frequency [rad/s].
    pub frequency: f64,
    /// Loop area [N m rad/s].
    pub area: Measured,
    /// Standard error of the mean area that the stated noise of the torque leads to [N m rad/s].
    pub area_noise: f64,
    /// Whole periods of a run.
    pub periods: u32,
    /// Velocity over one period, mean over the repetitions [rad/s].
    pub velocity: Vec<f64>,
    /// Friction torque over one period, mean over the repetitions [N m].
    pub torque: Vec<f64>,
}

impl LagFigures {
    /// Whether the area is clear of zero by three of its uncertainties.
    #[must_use]
    pub fn visible(&self) -> bool {
        self.area.mean.abs() > 3.0 * self.area.uncertainty().max(self.area_noise)
    }
}

/// Breakaway under one excitation.
#[derive(Debug, Clone, Serialize)]
pub struct BreakawayFigures {
    /// The excitation.
    pub excitation: String,
    /// Rate of the driving torque at the onset, mean over the repetitions [N m/s].
    pub rate: f64,
    /// Friction torque at the onset [N m].
    pub torque: Measured,
    /// Highest friction torque before gross motion [N m].
    pub peak: Measured,
    /// Displacement at the onset \[rad\].
    pub displacement: Measured,
}

/// One closed loop of the nested path.
#[derive(Debug, Clone, Serialize)]
pub struct ClosureFigures {
    /// Turn at which it begins and turn at which it ends, from 1.
    pub turns: (usize, usize),
    /// Torque level of both [N m].
    pub level: f64,
    /// Displacement at the end minus at the beginning \[rad\].
    pub gap: Measured,
    /// Work that the loop takes \[J\].
    pub work: Measured,
}
