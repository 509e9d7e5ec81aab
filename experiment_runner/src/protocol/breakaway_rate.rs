//! Experiment 4: breakaway against the rate at which the torque rises.

use serde::{Deserialize, Serialize};

use super::ProtocolFile;
use super::pre_sliding::{OnsetSheet, ramp};
use super::quantity::{Dimension, Quantity};
use super::{Displacement, OnsetRule, ProtocolError, count, within};
use crate::profile::{Profile, Segment};

/// Experiment 4 of the thesis.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BreakawayRateProtocol {
    /// Rates of the ramps of torque [N m/s].
    pub rates: Vec<f64>,
    /// Torque at which a ramp ends if nothing slides [N m].
    pub up_to: f64,
    /// Amplitude of the sines of torque [N m].
    pub amplitude: f64,
    /// Their angular frequencies [rad/s].
    pub frequencies: Vec<f64>,
    /// When sliding begins.
    pub onset: OnsetRule,
    /// Which sensor shows the displacement.
    pub displacement: Displacement,
    /// Repetitions.
    pub repetitions: u32,
}

impl BreakawayRateProtocol {
    /// The ramp of a rate [N m/s].
    #[must_use]
    pub fn ramp(&self, rate: f64) -> Profile {
        ramp(rate, self.up_to, 1.0)
    }

    /// Half a period of the sine of angular frequency `w` [rad/s].
    #[must_use]
    pub fn sine(&self, w: f64) -> Profile {
        let duration = std::f64::consts::PI / w;
        let wave = Segment::Wave {
            level: 0.0,
            amplitude: self.amplitude,
            phase: 0.0,
            from: w,
            to: w,
            duration,
        };
        Profile::new(vec![Segment::REST, wave])
    }

    /// A short form to try things out.
    #[must_use]
    pub fn quick(self) -> Self {
        Self { repetitions: self.repetitions.min(3), ..self }
    }

    /// Time that the experiment takes on a rig \[s\].
    #[must_use]
    pub fn rig_seconds(&self) -> f64 {
        let ramps: f64 = self.rates.iter().map(|&rate| self.ramp(rate).duration()).sum();
        let sines: f64 = self.frequencies.iter().map(|&w| self.sine(w).duration()).sum();
        f64::from(self.repetitions) * (ramps + sines)
    }
}

impl ProtocolFile for BreakawayRateProtocol {
    const NAME: &'static str = "breakaway-rate";
    const TEXT: &'static str = include_str!("../../protocols/breakaway-rate.yaml");
    type Sheet = Sheet;
}

/// The file's form.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sheet {
    #[serde(rename = "experiment")]
    _experiment: String,
    ramps: Ramps,
    sines: Sines,
    onset: OnsetSheet,
    displacement: Displacement,
    repetitions: u32,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Ramps {
    rates: Vec<Quantity>,
    up_to: Quantity,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Sines {
    amplitude: Quantity,
    frequencies: Vec<Quantity>,
}

impl TryFrom<Sheet> for BreakawayRateProtocol {
    type Error = ProtocolError;

    fn try_from(sheet: Sheet) -> Result<Self, ProtocolError> {
        let list = |list: &[Quantity], key: &str, dimension, least, most| {
            let each =
                |(i, &quantity)| within(quantity, &format!("{key}[{i}]"), dimension, least, most);
            list.iter().enumerate().map(each).collect::<Result<Vec<f64>, _>>()
        };
        Ok(Self {
            rates: list(&sheet.ramps.rates, "ramps.rates", Dimension::TorqueRate, 1e-4, 100.0)?,
            up_to: within(sheet.ramps.up_to, "ramps.up_to", Dimension::Torque, 1e-4, 10.0)?,
            amplitude: within(
                sheet.sines.amplitude,
                "sines.amplitude",
                Dimension::Torque,
                1e-4,
                10.0,
            )?,
            frequencies: list(
                &sheet.sines.frequencies,
                "sines.frequencies",
                Dimension::AngularVelocity,
                0.01,
                200.0,
            )?,
            onset: sheet.onset.try_into()?,
            displacement: sheet.displacement,
            repetitions: count(sheet.repetitions, "repetitions", 1, 1000)?,
        })
    }
}
