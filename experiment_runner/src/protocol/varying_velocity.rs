//! Experiment 2: a velocity that varies without a reversal, v = bias - amplitude cos(w t) (thesis
//! eq. 4.14).

use serde::{Deserialize, Serialize};

use super::ProtocolFile;
use super::quantity::{Dimension, Quantity};
use super::{ProtocolError, count, within};
use crate::profile::{Profile, Segment};

/// Experiment 2 of the thesis.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct VaryingVelocityProtocol {
    /// Mean velocity [rad/s].
    pub bias: f64,
    /// Amplitude of the variation [rad/s], below the bias.
    pub amplitude: f64,
    /// Constant angular frequencies w [rad/s].
    pub frequencies: Vec<f64>,
    /// Time at the lowest velocity before the variation begins \[s\].
    pub run_in: f64,
    /// Length of the variation at each frequency \[s\].
    pub duration: f64,
    /// Dropped of it at the beginning \[s\].
    pub drop_first: f64,
    /// Frequency that the chirp reaches [rad/s].
    pub chirp_up_to: f64,
    /// Length of the chirp \[s\].
    pub chirp_duration: f64,
    /// Whether the reference also goes through the inverse of the drive.
    pub feed_forward: bool,
    /// Repetitions.
    pub repetitions: u32,
}

impl VaryingVelocityProtocol {
    /// The reference at angular frequency `w` [rad/s].
    #[must_use]
    pub fn sine(&self, w: f64) -> Profile {
        self.reference(w, w, self.duration)
    }

    /// The reference of the chirp, from 0 to its highest frequency.
    #[must_use]
    pub fn chirp(&self) -> Profile {
        self.reference(0.0, self.chirp_up_to, self.chirp_duration)
    }

    fn reference(&self, from: f64, to: f64, duration: f64) -> Profile {
        let slowest = self.bias - self.amplitude;
        Profile::new(vec![
            Segment::Line { from: slowest, to: slowest, duration: self.run_in },
            Segment::Wave {
                level: self.bias,
                amplitude: self.amplitude,
                phase: -std::f64::consts::FRAC_PI_2,
                from,
                to,
                duration,
            },
        ])
    }

    /// A short form to try things out.
    #[must_use]
    pub fn quick(self) -> Self {
        Self { duration: self.duration.min(12.0), repetitions: self.repetitions.min(3), ..self }
    }

    /// Time that the experiment takes on a rig \[s\].
    #[must_use]
    pub fn rig_seconds(&self) -> f64 {
        let each = self.frequencies.len() as f64 * (self.run_in + self.duration);
        f64::from(self.repetitions) * (each + self.run_in + self.chirp_duration)
    }
}

impl ProtocolFile for VaryingVelocityProtocol {
    const NAME: &'static str = "varying-velocity";
    const TEXT: &'static str = include_str!("../../protocols/varying-velocity.yaml");
    type Sheet = Sheet;
}

/// The file's form.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sheet {
    #[serde(rename = "experiment")]
    _experiment: String,
    bias: Quantity,
    amplitude: Quantity,
    frequencies: Vec<Quantity>,
    run_in: Quantity,
    duration: Quantity,
    drop_first: Quantity,
    chirp: Chirp,
    feed_forward: bool,
    repetitions: u32,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Chirp {
    up_to: Quantity,
    duration: Quantity,
}

impl TryFrom<Sheet> for VaryingVelocityProtocol {
    type Error = ProtocolError;

    fn try_from(sheet: Sheet) -> Result<Self, ProtocolError> {
        let bias = within(sheet.bias, "bias", Dimension::AngularVelocity, 1e-3, 50.0)?;
        let amplitude =
            within(sheet.amplitude, "amplitude", Dimension::AngularVelocity, 1e-4, 50.0)?;
        if amplitude >= bias {
            let expected =
                format!("below the bias {}, so that the velocity keeps its sign", sheet.bias);
            return Err(ProtocolError::new("amplitude", sheet.amplitude, expected));
        }
        let duration = within(sheet.duration, "duration", Dimension::Time, 0.1, 3600.0)?;
        let drop_first = within(sheet.drop_first, "drop_first", Dimension::Time, 0.0, 3600.0)?;
        let mut frequencies = Vec::with_capacity(sheet.frequencies.len());
        for (index, &quantity) in sheet.frequencies.iter().enumerate() {
            let key = format!("frequencies[{index}]");
            let w = within(quantity, &key, Dimension::AngularVelocity, 0.01, 200.0)?;
            let periods = (duration - drop_first) * w / std::f64::consts::TAU;
            if periods < 1.0 {
                let expected = format!(
                    "so high that a whole period lies between drop_first {} and duration {}",
                    sheet.drop_first, sheet.duration
                );
                return Err(ProtocolError::new(key, quantity, expected));
            }
            frequencies.push(w);
        }
        Ok(Self {
            bias,
            amplitude,
            frequencies,
            run_in: within(sheet.run_in, "run_in", Dimension::Time, 0.0, 600.0)?,
            duration,
            drop_first,
            chirp_up_to: within(
                sheet.chirp.up_to,
                "chirp.up_to",
                Dimension::AngularVelocity,
                0.01,
                200.0,
            )?,
            chirp_duration: within(
                sheet.chirp.duration,
                "chirp.duration",
                Dimension::Time,
                0.1,
                3600.0,
            )?,
            feed_forward: sheet.feed_forward,
            repetitions: count(sheet.repetitions, "repetitions", 1, 1000)?,
        })
    }
}
