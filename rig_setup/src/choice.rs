//! Which rig: `simulated`, `quanser[:CARD]`, `serial:PORT[@BAUD]` or `nodes[:NAMESPACE]`.

use std::fmt;
use std::path::PathBuf;
use std::str::FromStr;

use friction_model::AnyModel;
use rig_driver::quanser::{QuanserOptions, QuanserRig};
use rig_driver::safety::SafetyLimits;
use rig_driver::serial::{self, SerialOptions, SerialRig};
use rig_driver::{Calibrated, Calibration, Miswired, Miswiring, Rig, RigError, SimulationOptions};
use serde::{Deserialize, Serialize};

use super::description::RigDescription;
use super::session::Pace;
use super::{RigLimits, RigSetupError};

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
        /// Baud rate.
        baud: u32,
    },
    /// Whatever rig the running ROS 2 nodes drive, with their observer and controller.
    Nodes {
        /// Namespace of the axis, as in `/axis_1`; none for that of whoever asks.
        namespace: Option<String>,
    },
}

impl FromStr for RigChoice {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (kind, which) =
            text.split_once(':').map_or((text, None), |(kind, which)| (kind, Some(which)));
        match (kind, which) {
            ("simulated", None) => Ok(Self::Simulated),
            ("nodes", None) => Ok(Self::Nodes { namespace: None }),
            ("nodes", Some(axis)) if !axis.trim_matches('/').is_empty() => {
                Ok(Self::Nodes { namespace: Some(format!("/{}", axis.trim_matches('/'))) })
            }
            ("nodes", Some(_)) => {
                Err("`nodes:` wants the namespace of an axis, as in nodes:/axis_1".to_owned())
            }
            ("quanser", None) => Ok(Self::Quanser { card: "0".to_owned() }),
            ("quanser", Some(card)) if !card.is_empty() => Ok(Self::Quanser { card: card.to_owned() }),
            ("serial", Some(port)) if !port.is_empty() && !port.starts_with('@') => {
                let (port, baud) = match port.rsplit_once('@') {
                    Some((port, baud)) => {
                        (port, baud.parse().map_err(|_| format!("`{baud}` is no baud rate"))?)
                    }
                    None => (port, SerialOptions::default().baud),
                };
                Ok(Self::Serial { port: port.into(), baud })
            }
            ("serial", _) => {
                Err("`serial` wants a port, as in serial:/dev/ttyACM0; `frictionlab rig list` finds them"
                    .to_owned())
            }
            _ => Err(format!(
                "`{text}` is no rig; there are `simulated`, `quanser` or `quanser:CARD`, `serial:PORT` as in serial:/dev/ttyACM0, and `nodes` for the running ROS 2 nodes"
            )),
        }
    }
}

impl fmt::Display for RigChoice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Simulated => f.write_str("simulated"),
            Self::Nodes { namespace: None } => f.write_str("nodes"),
            Self::Nodes { namespace: Some(axis) } => write!(f, "nodes:{axis}"),
            Self::Quanser { card } => write!(f, "quanser:{card}"),
            Self::Serial { port, baud } if *baud == SerialOptions::default().baud => {
                write!(f, "serial:{}", port.display())
            }
            Self::Serial { port, baud } => write!(f, "serial:{}@{baud}", port.display()),
        }
    }
}

/// How a rig is set up.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct RigSetup {
    /// What corrects its readings.
    pub calibration: Option<Calibration>,
    /// What an engineer set for it.
    pub limits: RigLimits,
}

/// A rig that is open, with the limits that belong to it.
pub struct Opened {
    /// The rig, raw.
    pub rig: Box<dyn Rig + Send>,
    /// What the safety layer allows on it.
    pub limits: SafetyLimits,
    /// Who sets the pace.
    pub pace: Pace,
    /// Which sensors there are.
    pub sensors: SensorsPresent,
    /// What a real rig says of itself, in a line.
    pub about: Option<String>,
    /// What a device says of itself, number by number.
    pub description: Option<RigDescription>,
}

/// Sensors that a rig may lack.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SensorsPresent {
    /// Friction torque.
    pub torque: bool,
    /// Motor current.
    pub current: bool,
}

impl RigChoice {
    /// Opens the rig with the motor at zero volts. The simulated one has friction `friction`, noise
    /// of `seed`, and is wired as `wiring` says. A calibration in `setup` corrects its readings.
    ///
    /// # Errors
    /// [`RigSetupError`] says what is missing or refused.
    pub fn open(
        &self,
        friction: AnyModel,
        seed: u64,
        wiring: Option<Miswiring>,
        setup: RigSetup,
    ) -> Result<Opened, RigSetupError> {
        let RigSetup { calibration, limits: set } = setup;
        let opened = match self {
            Self::Simulated => {
                let usual = SimulationOptions::default();
                let voltage_limit = SafetyLimits::voltage_within(set.voltage, usual.voltage_range)?;
                let options = SimulationOptions { seed, voltage_limit, ..usual };
                let rig = options.build(friction)?;
                Opened {
                    rig: match wiring {
                        Some(wiring) => Box::new(Miswired::new(rig, wiring)),
                        None => rig,
                    },
                    limits: SafetyLimits::for_simulation(&options),
                    pace: Pace::LockStep,
                    sensors: SensorsPresent { torque: true, current: true },
                    about: None,
                    description: None,
                }
            }
            Self::Nodes { .. } => return Err(RigSetupError::NotDriven("the rig of the running nodes is driven by `frictionlab run --rig nodes`; here a rig of one's own is needed, as in --rig serial:/dev/ttyACM0".to_owned())),
            Self::Quanser { card } => {
                let usual = QuanserOptions { card: card.clone(), ..QuanserOptions::default() };
                let voltage_limit = SafetyLimits::voltage_within(set.voltage, usual.voltage_range())?;
                let options = QuanserOptions { voltage_limit, ..usual };
                let mut limits = SafetyLimits { voltage: options.voltage_limit, ..SafetyLimits::default() };
                if options.torque.is_none() {
                    limits.sensors.torque_range = None;
                }
                let sensors = SensorsPresent { torque: options.torque.is_some(), current: false };
                let about = format!("Quanser card {} {card}", options.card_type);
                let description = RigDescription {
                    name: options.card_type.clone(),
                    firmware: None,
                    period: options.period,
                    voltage_range: options.voltage_range(),
                    counts_per_turn: options.encoder_counts_per_turn,
                    scales: None,
                };
                let rig = Box::new(QuanserRig::open(options)?);
                let description = Some(description);
                Opened { rig, limits, pace: Pace::Clock, sensors, about: Some(about), description }
            }
            Self::Serial { port, baud } => {
                let options = SerialOptions { baud: *baud, ..SerialOptions::default() };
                let rig = SerialRig::open(port, options).map_err(RigError::from)?;
                let (limits, channels) = (serial::limits(rig.hello()), rig.hello().channels);
                Opened {
                    limits,
                    pace: Pace::Device,
                    sensors: SensorsPresent { torque: channels.torque, current: channels.current },
                    about: Some(about(&rig)),
                    description: Some(RigDescription::of(rig.hello(), rig.period(), rig.voltage_range())),
                    rig: Box::new(rig),
                }
            }
        };
        let limits = set.on(opened.limits, opened.rig.voltage_range())?;
        let opened = Opened { limits, ..opened };
        Ok(match calibration {
            Some(calibration) => Opened { rig: calibrated(opened.rig, calibration)?, ..opened },
            None => opened,
        })
    }
}

/// What a device says of itself, in a line.
fn about(rig: &SerialRig) -> String {
    let hello = rig.hello();
    let [major, minor, patch] = hello.firmware;
    let limit = f64::from(hello.voltage_limit) * f64::from(hello.volts_per_count);
    format!(
        "{} (firmware {major}.{minor}.{patch}), {} us a cycle, at most {:.2} V; {}",
        hello.name.as_str(),
        hello.period_us,
        limit.abs(),
        rig.latency()
    )
}

fn calibrated(
    rig: Box<dyn Rig + Send>,
    calibration: Calibration,
) -> Result<Box<dyn Rig + Send>, RigError> {
    Ok(Box::new(Calibrated::new(rig, calibration)?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rigs_are_read_by_name_and_written_back_the_same() {
        for text in [
            "simulated",
            "nodes",
            "nodes:/axis_1",
            "quanser:0",
            "quanser:1@tcpip://rig:18920",
            "serial:/dev/ttyACM0",
            "serial:/dev/ttyUSB1@115200",
        ] {
            assert_eq!(text.parse::<RigChoice>().unwrap().to_string(), text);
        }
        assert_eq!("quanser".parse::<RigChoice>().unwrap().to_string(), "quanser:0");
        assert_eq!("nodes:axis_1/".parse::<RigChoice>().unwrap().to_string(), "nodes:/axis_1");
        assert!("nodes:".parse::<RigChoice>().unwrap_err().contains("nodes:/axis_1"));
        for wrong in ["", "serial", "serial:", "serial:@9600", "quanser:", "simulated:1", "usb"] {
            let said = wrong.parse::<RigChoice>().unwrap_err();
            assert!(said.contains("serial:/dev/ttyACM0"), "{said}");
        }
    }
}
