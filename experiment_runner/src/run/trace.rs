//! What the report draws of a run over time.

use serde::{Deserialize, Serialize};

use crate::cycle::CycleSample;

/// Signals over time, kept at a tenth of the loop's rate.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(crate) struct Trace {
    /// Time \[s\].
    #[serde(with = "crate::exact::column")]
    pub t: Vec<f64>,
    /// Reference [rad/s or rad].
    #[serde(with = "crate::exact::column")]
    pub reference: Vec<f64>,
    /// Response of the shaft [rad/s or rad].
    #[serde(with = "crate::exact::column")]
    pub response: Vec<f64>,
    /// Reference minus response [rad/s or rad].
    #[serde(with = "crate::exact::column")]
    pub error: Vec<f64>,
    /// Friction as the torque sensor shows it [N m].
    #[serde(with = "crate::exact::column")]
    pub friction_measured: Vec<f64>,
    /// Friction as it is, where the rig is simulated [N m].
    #[serde(with = "crate::exact::column")]
    pub friction_true: Vec<f64>,
    /// Friction as the observer estimates it [N m].
    #[serde(with = "crate::exact::column")]
    pub friction_estimated: Vec<f64>,
    /// Voltage of the motor \[V\].
    #[serde(with = "crate::exact::column")]
    pub voltage: Vec<f64>,
}

impl Trace {
    /// Cycles from one kept sample to the next.
    const EVERY: u64 = 10;

    /// Takes a cycle in.
    pub fn add(&mut self, sample: &CycleSample) {
        if !sample.measurement.cycle.is_multiple_of(Self::EVERY) {
            return;
        }
        let error = sample.error();
        self.t.push(sample.measurement.time);
        self.reference.push(sample.command.reference);
        self.response.push(sample.command.reference - error);
        self.error.push(error);
        self.friction_measured.push(sample.measurement.torque);
        self.friction_true.push(sample.truth.map_or(f64::NAN, |truth| truth.friction));
        self.friction_estimated.push(sample.estimate.torque);
        self.voltage.push(sample.command.total);
    }
}
