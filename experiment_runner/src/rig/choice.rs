//! Which rig: `simulated`, `quanser[:CARD]` or `serial:PORT`.

use std::fmt;
use std::path::PathBuf;
use std::str::FromStr;

use friction_model::AnyModel;
use rig_driver::quanser::{QuanserOptions, QuanserRig};
use rig_driver::safety::SafetyLimits;
use rig_driver::{Calibrated, Calibration, Miswired, Miswiring, Rig, RigError, SimulationOptions};
use serde::Serialize;

use super::RigSetupError;
use super::session::Pace;

/// A rig as it is named on the command line.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum RigChoice {
    /// The simulated test bed.
    #[default]
    Simulated,
    /// A Quanser card, by the vendor's identifier.
    Quanser {
        /// `0` for the first card, `0@tcpip://HOST:PORT` through the vendor's proxy.
        card: String,
    },
    /// A device on a serial port.
    Serial {
        /// The port.
        port: PathBuf,
    },
}

impl FromStr for RigChoice {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (kind, which) = text.split_once(':').map_or((text, None), |(kind, which)| (kind, Some(which)));
        match (kind, which) {
            ("simulated", None) => Ok(Self::Simulated),
            ("quanser", None) => Ok(Self::Quanser { card: "0".to_owned() }),
            ("quanser", Some(card)) if !card.is_empty() => Ok(Self::Quanser { card: card.to_owned() }),
            ("serial", Some(port)) if !port.is_empty() => Ok(Self::Serial { port: port.into() }),
            ("serial", _) => {
                Err("`serial` wants a port, as in serial:/dev/ttyACM0; `frictionlab rig list` finds them"
                    .to_owned())
            }
            _ => Err(format!(
                "`{text}` is no rig; there are `simulated`, `quanser` or `quanser:CARD`, and `serial:PORT` as in serial:/dev/ttyACM0"
            )),
        }
    }
}

impl fmt::Display for RigChoice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Simulated => f.write_str("simulated"),
            Self::Quanser { card } => write!(f, "quanser:{card}"),
            Self::Serial { port } => write!(f, "serial:{}", port.display()),
        }
    }
}

/// A rig that is open, with the limits that belong to it.
pub struct Opened {
    /// The rig, raw.
    pub rig: Box<dyn Rig + Send>,
    /// What the safety layer allows on it.
    pub limits: SafetyLimits,
    /// Who sets the pace.
    pub pace: Pace,
}

impl RigChoice {
    /// Opens the rig with the motor at zero volts. The simulated one has friction `friction`, noise of `seed`, and is wired as `wiring`
    /// says. With a `calibration` its readings are corrected.
    ///
    /// # Errors
    /// [`RigSetupError`] says what is missing or refused.
    pub fn open(
        &self,
        friction: AnyModel,
        seed: u64,
        wiring: Option<Miswiring>,
        calibration: Option<Calibration>,
    ) -> Result<Opened, RigSetupError> {
        let opened = match self {
            Self::Simulated => {
                let options = SimulationOptions { seed, ..SimulationOptions::default() };
                let rig = options.build(friction)?;
                Opened {
                    rig: match wiring {
                        Some(wiring) => Box::new(Miswired::new(rig, wiring)),
                        None => rig,
                    },
                    limits: SafetyLimits::for_simulation(&options),
                    pace: Pace::LockStep,
                }
            }
            Self::Quanser { card } => {
                let options = QuanserOptions { card: card.clone(), ..QuanserOptions::default() };
                let mut limits = SafetyLimits { voltage: options.voltage_limit, ..SafetyLimits::default() };
                if options.torque.is_none() {
                    limits.sensors.torque_range = None;
                }
                Opened { rig: Box::new(QuanserRig::open(options)?), limits, pace: Pace::Clock }
            }
            Self::Serial { port } => {
                return Err(RigSetupError::NotDriven(format!(
                    "this command does not drive a rig on a serial port yet; `frictionlab live --rig serial:{}` does",
                    port.display()
                )));
            }
        };
        Ok(match calibration {
            Some(calibration) => Opened { rig: calibrated(opened.rig, calibration)?, ..opened },
            None => opened,
        })
    }
}

fn calibrated(rig: Box<dyn Rig + Send>, calibration: Calibration) -> Result<Box<dyn Rig + Send>, RigError> {
    Ok(Box::new(Calibrated::new(rig, calibration)?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rigs_are_read_by_name_and_written_back_the_same() {
        for text in ["simulated", "quanser:0", "quanser:1@tcpip://rig:18920", "serial:/dev/ttyACM0"] {
            assert_eq!(text.parse::<RigChoice>().unwrap().to_string(), text);
        }
        assert_eq!("quanser".parse::<RigChoice>().unwrap().to_string(), "quanser:0");
        for wrong in ["", "serial", "serial:", "quanser:", "simulated:1", "usb"] {
            let said = wrong.parse::<RigChoice>().unwrap_err();
            assert!(said.contains("serial:/dev/ttyACM0"), "{said}");
        }
    }
}
