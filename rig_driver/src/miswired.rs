//! A rig wired wrong on purpose: to try calibration, and to practise it.

use std::str::FromStr;

use strum::{EnumString, IntoStaticStr, VariantArray};

use crate::{Measurement, Rig, RigError};

/// What is wrong with the wiring. The default is right.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Miswiring {
    /// The motor's leads are swapped: a positive voltage turns it backwards.
    pub motor_reversed: bool,
    /// The encoder's lines are swapped.
    pub encoder_reversed: bool,
    /// What the tachometer shows over the true velocity, below zero if its leads are swapped.
    pub tachometer_gain: f64,
    /// What it shows at rest [rad/s].
    pub tachometer_zero: f64,
    /// The torque sensor's sign is wrong.
    pub torque_reversed: bool,
    /// What it shows without torque [N m].
    pub torque_zero: f64,
    /// The tachometer's plug is out: it shows zero.
    pub tachometer_unplugged: bool,
    /// The encoder's plug is out: it stands still.
    pub encoder_unplugged: bool,
}

impl Default for Miswiring {
    fn default() -> Self {
        Self {
            motor_reversed: false,
            encoder_reversed: false,
            tachometer_gain: 1.0,
            tachometer_zero: 0.0,
            torque_reversed: false,
            torque_zero: 0.0,
            tachometer_unplugged: false,
            encoder_unplugged: false,
        }
    }
}

/// Mistakes as they are named; behind `=` stands a number where one is wanted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, EnumString, IntoStaticStr, VariantArray)]
#[strum(serialize_all = "kebab-case")]
enum Mistake {
    Motor,
    Encoder,
    Torque,
    EncoderUnplugged,
    TachometerUnplugged,
    Tachometer,
    TachometerZero,
    TorqueZero,
}

impl Mistake {
    /// What the number behind it is; none where there is no number.
    const fn number(self) -> Option<&'static str> {
        match self {
            Self::Tachometer => Some("GAIN"),
            Self::TachometerZero => Some("RAD_S"),
            Self::TorqueZero => Some("NM"),
            _ => None,
        }
    }

    /// All of them, as they are written.
    fn grammar() -> String {
        let form = |mistake: &Self| {
            let name: &str = mistake.into();
            mistake.number().map_or_else(|| name.to_owned(), |number| format!("{name}={number}"))
        };
        Self::VARIANTS.iter().map(form).collect::<Vec<_>>().join(", ")
    }
}

/// A text that names no mistake in a wiring.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum MiswiringError {
    /// There is no such mistake.
    #[error("`{0}` is no mistake known here; there are {there}", there = Mistake::grammar())]
    Unknown(String),
    /// Behind the mistake stands no finite number.
    #[error("`{0}` wants a number, as in {0}=0.5")]
    NoNumber(String),
}

impl FromStr for Miswiring {
    type Err = MiswiringError;

    /// Reads mistakes parted by commas, as in `encoder,tachometer=0.9,torque-zero=0.05`.
    fn from_str(text: &str) -> Result<Self, MiswiringError> {
        let mut wiring = Self::default();
        for said in text.split(',') {
            let (name, value) =
                said.split_once('=').map_or((said, None), |(name, value)| (name, Some(value)));
            let mistake = name.parse::<Mistake>().ok();
            // A number behind what wants none is no mistake known.
            let mistake = mistake.filter(|mistake| value.is_none() || mistake.number().is_some());
            let mistake = mistake.ok_or_else(|| MiswiringError::Unknown(said.to_owned()))?;
            let number = || {
                value
                    .and_then(|value| value.parse::<f64>().ok())
                    .filter(|value| value.is_finite())
                    .ok_or_else(|| MiswiringError::NoNumber(name.to_owned()))
            };
            match mistake {
                Mistake::Motor => wiring.motor_reversed = true,
                Mistake::Encoder => wiring.encoder_reversed = true,
                Mistake::Torque => wiring.torque_reversed = true,
                Mistake::EncoderUnplugged => wiring.encoder_unplugged = true,
                Mistake::TachometerUnplugged => wiring.tachometer_unplugged = true,
                Mistake::Tachometer => wiring.tachometer_gain = number()?,
                Mistake::TachometerZero => wiring.tachometer_zero = number()?,
                Mistake::TorqueZero => wiring.torque_zero = number()?,
            }
        }
        Ok(wiring)
    }
}

/// A rig with mistakes in its wiring.
#[derive(Debug)]
pub struct Miswired<R> {
    rig: R,
    wiring: Miswiring,
}

impl<R: Rig> Miswired<R> {
    /// The rig with these mistakes.
    #[must_use]
    pub const fn new(rig: R, wiring: Miswiring) -> Self {
        Self { rig, wiring }
    }
}

impl<R: Rig> Rig for Miswired<R> {
    fn beneath(&self) -> Option<&dyn Rig> {
        Some(&self.rig)
    }

    fn beneath_mut(&mut self) -> Option<&mut dyn Rig> {
        Some(&mut self.rig)
    }

    fn period(&self) -> f64 {
        self.rig.period()
    }

    fn measure(&mut self) -> Measurement {
        let Miswiring {
            motor_reversed, encoder_reversed, tachometer_gain, torque_reversed, ..
        } = self.wiring;
        let seen = self.rig.measure();
        let encoder =
            if encoder_reversed { -1 } else { 1 } * i64::from(!self.wiring.encoder_unplugged);
        let torque = if torque_reversed { -1.0 } else { 1.0 };
        let motor = if motor_reversed { -1.0 } else { 1.0 };
        let tachometer = if self.wiring.tachometer_unplugged {
            0.0
        } else {
            tachometer_gain * seen.tachometer_velocity + self.wiring.tachometer_zero
        };
        Measurement {
            encoder_counts: encoder * seen.encoder_counts,
            encoder_position: encoder as f64 * seen.encoder_position,
            tachometer_velocity: tachometer,
            torque: torque * seen.torque + self.wiring.torque_zero,
            voltage_asked: motor * seen.voltage_asked,
            voltage_applied: motor * seen.voltage_applied,
            ..seen
        }
    }

    fn apply(&mut self, volts: f64) -> Result<(), RigError> {
        self.rig.apply(if self.wiring.motor_reversed { -volts } else { volts })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mistakes_are_read_from_words_and_unknown_ones_name_those_there_are() {
        let wiring: Miswiring = "motor,tachometer=-0.9,torque-zero=0.05".parse().unwrap();
        let expected = Miswiring {
            motor_reversed: true,
            tachometer_gain: -0.9,
            torque_zero: 0.05,
            ..Miswiring::default()
        };
        assert_eq!(wiring, expected);
        assert!(
            "colour".parse::<Miswiring>().unwrap_err().to_string().contains("encoder-unplugged")
        );
        assert!(
            "tachometer".parse::<Miswiring>().unwrap_err().to_string().contains("tachometer=0.5")
        );
        assert!("torque-zero=NaN".parse::<Miswiring>().is_err());
    }
}
