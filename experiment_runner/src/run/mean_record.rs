//! The means over the repetitions of a run under a profile.

use friction_ident::FrictionTorque;
use recording::csv_table::CsvTable;
use serde::{Deserialize, Serialize};

use crate::characterise::Channels;
use crate::characterise::channels::block_means;
use crate::protocol::Displacement;

/// The means over the repetitions of a group, one value a cycle, as long as the shortest run.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub struct MeanRecord {
    /// Time \[s\].
    #[serde(with = "crate::exact::column")]
    pub time: Vec<f64>,
    /// Position \[rad\].
    #[serde(with = "crate::exact::column")]
    pub position: Vec<f64>,
    /// Velocity [rad/s].
    #[serde(with = "crate::exact::column")]
    pub velocity: Vec<f64>,
    /// Voltage \[V\].
    #[serde(with = "crate::exact::column")]
    pub voltage: Vec<f64>,
    /// Current \[A\]; empty on a rig that does not measure it.
    #[serde(with = "crate::exact::column")]
    pub current: Vec<f64>,
    /// Friction torque by the chosen source [N m].
    #[serde(with = "crate::exact::column")]
    pub torque: Vec<f64>,
    runs: f64,
}

impl MeanRecord {
    /// The record of one run.
    pub(super) fn one(
        channels: Channels,
        friction: FrictionTorque,
        displacement: Displacement,
    ) -> Self {
        let position = match displacement {
            Displacement::Encoder => channels.encoder,
            Displacement::Potentiometer => channels.potentiometer,
        };
        let Channels { time, velocity, voltage, current, .. } = channels;
        Self { time, position, velocity, voltage, current, torque: friction.torque, runs: 1.0 }
    }

    /// Takes one run in.
    pub(super) fn add(&mut self, one: &Self) {
        if self.runs == 0.0 {
            self.time.clone_from(&one.time);
        }
        self.time.truncate(one.time.len());
        let runs = self.runs;
        let into = |sum: &mut Vec<f64>, values: &[f64]| {
            if runs == 0.0 {
                *sum = values.to_vec();
            }
            sum.truncate(values.len());
            if runs > 0.0 {
                sum.iter_mut()
                    .zip(values)
                    .for_each(|(sum, value)| *sum += (value - *sum) / (runs + 1.0));
            }
        };
        into(&mut self.position, &one.position);
        into(&mut self.velocity, &one.velocity);
        into(&mut self.voltage, &one.voltage);
        into(&mut self.current, &one.current);
        into(&mut self.torque, &one.torque);
        self.runs += 1.0;
    }
}

impl MeanRecord {
    /// From sample `first` on, `samples` at most, time counted from there.
    pub fn from(self, first: usize, samples: usize) -> Self {
        let start = self.time.get(first).copied().unwrap_or(0.0);
        let mut record =
            self.each(|values| values.iter().skip(first).take(samples).copied().collect());
        record.time.iter_mut().for_each(|t| *t -= start);
        record
    }

    /// Means of `size` samples each.
    pub fn thinned(self, size: usize) -> Self {
        self.each(|values| block_means(values, size))
    }

    pub(super) fn each(&self, change: impl Fn(&[f64]) -> Vec<f64>) -> Self {
        Self {
            time: change(&self.time),
            position: change(&self.position),
            velocity: change(&self.velocity),
            voltage: change(&self.voltage),
            current: change(&self.current),
            torque: change(&self.torque),
            runs: self.runs,
        }
    }

    /// As comma-separated values, as `frictionlab identify` reads them; with the current only where
    /// every sample has one.
    pub fn csv(&self) -> String {
        let with_current = !self.time.is_empty() && self.current.len() == self.time.len();
        let mut columns = vec!["t_s", "position_rad", "velocity_rad_s", "voltage_V"];
        columns.extend(with_current.then_some("current_A"));
        columns.push("torque_Nm");
        let mut table = CsvTable::new(columns);
        let rows = self
            .time
            .iter()
            .zip(&self.position)
            .zip(&self.velocity)
            .zip(&self.voltage)
            .zip(&self.torque);
        for (i, ((((t, x), w), u), torque)) in rows.enumerate() {
            table.cell(format_args!("{t:.6}"));
            table.cell(format_args!("{x:.8}"));
            table.cell(format_args!("{w:.7}"));
            table.cell(format_args!("{u:.7}"));
            if let Some(amperes) = self.current.get(i).filter(|_| with_current) {
                table.cell(format_args!("{amperes:.7}"));
            }
            table.cell(format_args!("{torque:.8}"));
            table.end_row();
        }
        table.text()
    }
}
