//! Voltage that shows a drive: steps, a pseudo-random binary sequence, a chirp, a slow triangle.

use rig_driver::HIGHEST_VOLTAGE;
use serde::{Deserialize, Serialize};

use super::ProtocolFile;
use super::quantity::{Dimension, Quantity};
use super::{ProtocolError, count, within};
use crate::profile::{DrivenQuantity, Excitation, Profile, Segment};

/// Excitation of a drive by its voltage, without a controller.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DriveExcitationProtocol {
    /// What is driven.
    pub excitation: Excitation,
    /// Largest magnitude of the voltage \[V\].
    pub highest: f64,
    /// How far the shaft may turn from where it began \[rad\].
    pub travel: f64,
    /// Repetitions.
    pub repetitions: u32,
}

impl DriveExcitationProtocol {
    /// Time that the experiment takes on a rig \[s\].
    #[must_use]
    pub fn rig_seconds(&self) -> f64 {
        f64::from(self.repetitions) * self.excitation.profile.duration()
    }
}

impl ProtocolFile for DriveExcitationProtocol {
    const NAME: &'static str = "drive-excitation";
    const TEXT: &'static str = include_str!("../../protocols/drive-excitation.yaml");
    type Sheet = Sheet;
}

/// The file's form.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sheet {
    #[serde(rename = "experiment")]
    _experiment: String,
    steps: Option<Steps>,
    prbs: Option<Prbs>,
    chirp: Option<Chirp>,
    triangle: Option<Triangle>,
    travel: Quantity,
    repetitions: u32,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Steps {
    levels: Vec<Quantity>,
    duration: Quantity,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Prbs {
    amplitude: Quantity,
    bit: Quantity,
    duration: Quantity,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Chirp {
    amplitude: Quantity,
    from: Quantity,
    to: Quantity,
    duration: Quantity,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Triangle {
    amplitude: Quantity,
    period: Quantity,
    periods: u32,
}

const fn hold(level: f64, duration: f64) -> Segment {
    Segment::Line { from: level, to: level, duration }
}

impl TryFrom<Sheet> for DriveExcitationProtocol {
    type Error = ProtocolError;

    fn try_from(sheet: Sheet) -> Result<Self, ProtocolError> {
        let volts =
            |quantity, key: &str| within(quantity, key, Dimension::Voltage, 1e-3, HIGHEST_VOLTAGE);
        let time = |quantity, key: &str| within(quantity, key, Dimension::Time, 1e-3, 3600.0);
        let frequency =
            |quantity, key: &str| within(quantity, key, Dimension::AngularVelocity, 0.01, 500.0);
        let mut highest: f64 = 0.0;
        let mut segments = Vec::new();
        if let Some(Steps { levels, duration }) = &sheet.steps {
            let duration = time(*duration, "steps.duration")?;
            for (i, level) in levels.iter().enumerate() {
                let level = volts(*level, &format!("steps.levels[{i}]"))?;
                highest = highest.max(level);
                for level in [level, 0.0, -level, 0.0] {
                    segments.push(hold(level, duration));
                }
            }
        }
        if let Some(Prbs { amplitude, bit, duration }) = &sheet.prbs {
            let amplitude = volts(*amplitude, "prbs.amplitude")?;
            let (bit, duration) = (time(*bit, "prbs.bit")?, time(*duration, "prbs.duration")?);
            highest = highest.max(amplitude);
            let bits = (duration / bit).round().clamp(1.0, 1e6) as usize;
            segments
                .extend(bits_of(bits).map(|up| hold(if up { amplitude } else { -amplitude }, bit)));
            segments.push(Segment::REST);
        }
        if let Some(Chirp { amplitude, from, to, duration }) = &sheet.chirp {
            let amplitude = volts(*amplitude, "chirp.amplitude")?;
            highest = highest.max(amplitude);
            let (from, to) = (frequency(*from, "chirp.from")?, frequency(*to, "chirp.to")?);
            let duration = time(*duration, "chirp.duration")?;
            // As much forwards as backwards from the first half wave on.
            let phase = std::f64::consts::FRAC_PI_2;
            segments.push(Segment::Wave { level: 0.0, amplitude, phase, from, to, duration });
            segments.push(Segment::REST);
        }
        if let Some(Triangle { amplitude, period, periods }) = &sheet.triangle {
            let amplitude = volts(*amplitude, "triangle.amplitude")?;
            highest = highest.max(amplitude);
            let period = time(*period, "triangle.period")?;
            for _ in 0..count(*periods, "triangle.periods", 1, 1000)? {
                segments.extend(Segment::path(0.0, &[amplitude, -amplitude, 0.0], period));
            }
        }
        if segments.is_empty() {
            let expected = "one or more of steps, prbs, chirp and triangle";
            return Err(ProtocolError::new("drive-excitation", "nothing", expected));
        }
        segments.insert(0, Segment::REST);
        segments.push(Segment::REST);
        Ok(Self {
            excitation: Excitation {
                quantity: DrivenQuantity::Voltage,
                profile: Profile::new(segments),
            },
            highest,
            travel: within(sheet.travel, "travel", Dimension::Angle, 1e-3, 1e4)?,
            repetitions: count(sheet.repetitions, "repetitions", 1, 1000)?,
        })
    }
}

/// Bits of the maximum-length sequence of x^9 + x^5 + 1, period 511: almost as many ones as zeros,
/// whatever comes before.
fn bits_of(number: usize) -> impl Iterator<Item = bool> {
    let mut register: u16 = 0x1ff;
    (0..number).map(move |_| {
        let bit = (register ^ (register >> 4)) & 1;
        register = (register >> 1) | (bit << 8);
        register & 1 == 1
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_shipped_protocol_stays_within_its_voltage_and_drives_both_ways() {
        let protocol = DriveExcitationProtocol::shipped().unwrap();
        let profile = &protocol.excitation.profile;
        let values: Vec<f64> = (0..=(profile.duration() * 1e3) as u32)
            .map(|ms| profile.at(f64::from(ms) * 1e-3).0)
            .collect();
        let highest = values.iter().fold(0.0f64, |most, volts| most.max(volts.abs()));
        assert!((highest - protocol.highest).abs() < 1e-9, "{highest}");
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        assert!(mean.abs() < 0.1, "{mean}");
        assert_eq!((values[0], *values.last().unwrap()), (0.0, 0.0));
    }

    #[test]
    fn the_binary_sequence_has_the_longest_period() {
        let bits: Vec<bool> = bits_of(1022).collect();
        assert_eq!(bits[..511], bits[511..]);
        let ones = bits[..511].iter().filter(|bit| **bit).count();
        assert_eq!(ones, 256);
        assert!((1..511).all(|shift| bits[..511] != bits[shift..shift + 511]));
    }

    #[test]
    fn a_part_may_be_left_out_but_not_all() {
        let text = "experiment: drive-excitation\nsteps: {levels: [2 V], duration: 1 s}\ntravel: 3 rad\nrepetitions: 2\n";
        let protocol = DriveExcitationProtocol::read(text).unwrap();
        assert_eq!((protocol.highest, protocol.travel, protocol.repetitions), (2.0, 3.0, 2));
        let empty = "experiment: drive-excitation\ntravel: 3 rad\nrepetitions: 2\n";
        assert!(DriveExcitationProtocol::read(empty).unwrap_err().to_string().contains("prbs"));
        let much = text.replace("2 V", "61 V");
        assert!(
            DriveExcitationProtocol::read(&much)
                .unwrap_err()
                .to_string()
                .contains("steps.levels[0]")
        );
    }
}
