//! How a Quanser card is opened.

use super::{QuanserOptions, QuanserRig, find_library};
use crate::RigError;
use crate::back_end::{
    BackEnd, Listed, Place, RigDescription, RigFactory, RigSetup, SensorsPresent,
};
use crate::safety::SafetyLimits;

/// A Quanser card, by the vendor's identifier: `0` for the first one, `0@tcpip://HOST:PORT` through
/// the vendor's proxy.
#[derive(Debug, Clone, Copy, Default)]
pub struct QuanserFactory;

impl RigFactory for QuanserFactory {
    fn name(&self) -> &'static str {
        "quanser"
    }

    fn about(&self) -> &'static str {
        "a servo on a Quanser card, through the vendor's HIL library"
    }

    fn place(&self) -> Place {
        Place::Optional { what: "CARD", usual: "0" }
    }

    fn listed(&self) -> Vec<Listed> {
        vec![match find_library() {
            Ok(library) => Listed::ready(
                self.name(),
                format!(
                    "HIL library {} is there; which cards are, only opening one tells",
                    library.display()
                ),
            ),
            Err(error) => Listed::absent(self.name(), error.to_string()),
        }]
    }

    fn open(&self, place: Option<&str>, setup: &RigSetup) -> Result<BackEnd, RigError> {
        let mut options = QuanserOptions::default();
        options.card = place.map_or(options.card, str::to_owned);
        let range = options.voltage_range();
        options.voltage_limit = SafetyLimits::voltage_within(setup.limits.voltage, range)?;
        let mut limits = SafetyLimits { voltage: options.voltage_limit, ..SafetyLimits::default() };
        if options.torque.is_none() {
            limits.sensors.torque_range = None;
        }
        let description = RigDescription {
            name: options.card_type.clone(),
            firmware: None,
            period: options.period,
            voltage_range: range,
            counts_per_turn: options.encoder_counts_per_turn,
            scales: None,
        };
        Ok(BackEnd {
            limits,
            sensors: SensorsPresent { torque: options.torque.is_some(), current: false },
            about: Some(format!("Quanser card {} {}", options.card_type, options.card)),
            description: Some(description),
            rig: Box::new(QuanserRig::open(options)?),
        })
    }
}
