//! The command line.

#![expect(
    rustdoc::broken_intra_doc_links,
    reason = "options are read in a terminal, where units are not escaped"
)]

use std::path::PathBuf;

use friction_model::{AnyModel, ModelName};
use machine_rig::Machine;
use rig_driver::{HIGHEST_VOLTAGE, Rig, SimulationOptions};
use rig_protocol::{Channels, Hello, Name};

use crate::line::Odds;

/// The simulated rig behind the serial protocol, on a pseudo-terminal, in real time
///
/// Prints `ready PATH` once PATH can be opened: `frictionlab live --rig serial:PATH`, or any
/// program that speaks the protocol. It ends at ctrl-C, or at the end of its standard input with
/// --until-eof, and leaves a summary in JSON.
///
/// Lines on standard input make faults, each counted in frames of the protocol or in cycles of the
/// device:
///
///   lose N | duplicate N | corrupt N | split N | delay N CYCLES   the next N frames, of both
///   directions;
///                           with `from-host` or `from-device` behind it, of that one
///   garbage BYTES           random bytes to the host and to the device
///   reboot [CYCLES]         the device is silent for CYCLES (200), then starts anew
///   unplug CYCLES           the port is gone for CYCLES, then it is back; the device keeps running
///   hang CYCLES             the device sends nothing for CYCLES, with the port open
///   fault | stop | release  a fault of the driver stage; the emergency stop's switch pressed,
///   released version V               the device speaks version V of the protocol
///   status                  prints the summary so far, in one line
///   quit                    ends
#[derive(Debug, Clone, clap::Parser)]
#[command(version, verbatim_doc_comment)]
pub(crate) struct Options {
    /// A symbolic link to the pseudo-terminal, whose own name changes when it is unplugged
    #[arg(long, value_name = "PATH")]
    pub(crate) link: Option<PathBuf>,
    /// The plant's friction model
    #[arg(long, value_name = "NAME", default_value = "proposed")]
    pub(crate) plant: ModelName,
    /// Machine in the motor's place, described by this file: its period, sensors, converters and
    /// wiring are those of the device [default: the thesis's test bed]
    #[arg(long, value_name = "FILE", conflicts_with_all = ["plant", "period", "voltage_range", "without"])]
    pub(crate) machine: Option<PathBuf>,
    /// Seed of the sensors' noise and of the faults
    #[arg(long, default_value_t = 1)]
    pub(crate) seed: u64,
    /// Period of the device's cycle [us]
    #[arg(long, value_name = "US", default_value_t = 1000, value_parser = clap::value_parser!(u32).range(100..=10_000))]
    pub(crate) period: u32,
    /// Largest magnitude of the motor voltage that the device puts out, and tells of itself [V]
    #[arg(long, value_name = "V", default_value_t = 6.0, value_parser = volts)]
    pub(crate) voltage_range: f64,
    /// The device's limit of a command's validity [us]
    #[arg(long, value_name = "US", default_value_t = 20_000)]
    pub(crate) validity_limit: u32,
    /// The device goes inactive when its host is silent for this long [us]
    #[arg(long, value_name = "US", default_value_t = 250_000)]
    pub(crate) host_timeout: u32,
    /// Leave out a sensor
    #[arg(long, value_name = "SENSOR", value_enum)]
    pub(crate) without: Vec<Sensor>,
    /// Version of the protocol that the device speaks
    #[arg(long, value_name = "V", default_value_t = rig_protocol::VERSION)]
    pub(crate) speak_version: u8,
    /// Part of the frames that are lost, from 0 to 1
    #[arg(long, value_name = "P", default_value_t = 0.0, value_parser = part)]
    pub(crate) lose: f64,
    /// Part of the frames that come twice
    #[arg(long, value_name = "P", default_value_t = 0.0, value_parser = part)]
    pub(crate) duplicate: f64,
    /// Part of the frames with a byte changed
    #[arg(long, value_name = "P", default_value_t = 0.0, value_parser = part)]
    pub(crate) corrupt: f64,
    /// Part of the frames that come some cycles late
    #[arg(long, value_name = "P", default_value_t = 0.0, value_parser = part)]
    pub(crate) delay: f64,
    /// By how many cycles they are late
    #[arg(long, value_name = "CYCLES", default_value_t = 5)]
    pub(crate) delay_cycles: u32,
    /// Part of the frames that come in two halves, a cycle apart
    #[arg(long, value_name = "P", default_value_t = 0.0, value_parser = part)]
    pub(crate) split: f64,
    /// End after so many cycles
    #[arg(long, value_name = "N")]
    pub(crate) cycles: Option<u64>,
    /// End when standard input ends
    #[arg(long)]
    pub(crate) until_eof: bool,
    /// File for the summary [default: standard output]
    #[arg(long, value_name = "FILE")]
    pub(crate) summary: Option<PathBuf>,
}

/// A sensor that can be left out.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Sensor {
    /// Velocity
    Tachometer,
    /// Position by voltage
    Potentiometer,
    /// Friction torque
    Torque,
    /// Motor current
    Current,
}

fn volts(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if (0.1..=HIGHEST_VOLTAGE).contains(&value) => Ok(value),
        _ => Err(format!("a voltage range lies between 0.1 and {HIGHEST_VOLTAGE} V")),
    }
}

fn part(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if (0.0..=1.0).contains(&value) => Ok(value),
        _ => Err("a part lies between 0 and 1".into()),
    }
}

impl Options {
    /// The rig in the motor's place.
    pub(crate) fn motor(&self, machine: Option<&Machine>) -> anyhow::Result<Box<dyn Rig + Send>> {
        match machine {
            Some(machine) => Ok(machine.clone().rig()?),
            None => Ok(self.simulation().build(AnyModel::test_bed(self.plant))?),
        }
    }

    /// The test bed in the motor's place.
    fn simulation(&self) -> SimulationOptions {
        SimulationOptions {
            period: f64::from(self.period) * 1e-6,
            seed: self.seed,
            voltage_limit: self.voltage_range,
            voltage_range: self.voltage_range,
            ..SimulationOptions::default()
        }
    }

    /// What the device says of itself: a count is a step of the converter.
    pub(crate) fn hello(&self, machine: Option<&Machine>) -> anyhow::Result<Hello> {
        let simulation = match machine {
            Some(machine) => {
                // What a converter of its own limits is what it can put out.
                SimulationOptions { voltage_limit: machine.voltage_range, ..machine.options()? }
            }
            None => self.simulation(),
        };
        let sensors = &simulation.sensors;
        let sensed = machine.map(|machine| machine.sensed);
        let has = |sensor| match sensed {
            None => !self.without.contains(&sensor),
            Some(sensed) => match sensor {
                Sensor::Tachometer => sensed.tachometer,
                Sensor::Potentiometer => false,
                Sensor::Torque => sensed.torque,
                Sensor::Current => sensed.current,
            },
        };
        let scale = |sensor, step: f64| if has(sensor) { step as f32 } else { 0.0 };
        Ok(Hello {
            answers: None,
            session: None,
            name: Name::new("rig_emulator").unwrap_or_default(),
            firmware: [0, 2, 0],
            channels: Channels {
                tachometer: has(Sensor::Tachometer),
                potentiometer: has(Sensor::Potentiometer),
                torque: has(Sensor::Torque),
                current: has(Sensor::Current),
            },
            period_us: (1e6 * simulation.period).round() as u32,
            counts_per_turn: sensors.encoder_counts_per_turn,
            volts_per_count: sensors.voltage_resolution as f32,
            voltage_limit: (simulation.voltage_limit / sensors.voltage_resolution) as i16,
            tachometer_per_count: scale(Sensor::Tachometer, sensors.tachometer.resolution),
            potentiometer_per_count: scale(Sensor::Potentiometer, sensors.potentiometer.resolution),
            torque_per_count: scale(Sensor::Torque, sensors.torque.resolution),
            current_per_count: scale(Sensor::Current, sensors.current.resolution),
            validity_limit_us: self.validity_limit,
            host_timeout_us: self.host_timeout,
        })
    }

    /// How often frames go wrong by themselves.
    pub(crate) const fn odds(&self) -> Odds {
        Odds {
            lose: self.lose,
            duplicate: self.duplicate,
            corrupt: self.corrupt,
            delay: self.delay,
            split: self.split,
            delay_cycles: self.delay_cycles,
        }
    }
}
