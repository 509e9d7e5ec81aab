//! Parameters of the node `rig_driver`, and the rig that they describe.

use friction_model::{Motor, TorqueSource};
use ros_node::parameters::{Declaration, Declared, ParameterError, Values};

use crate::{
    Rig, RigError,
    parameters::RigParameters,
    registry::{RigAddress, RigSetup},
    safety::Supervised,
};

/// Every parameter of the node. `rig` is the rig that is given when the program starts: only a
/// simulated one activates itself.
#[must_use]
pub fn declarations(rig: &str) -> Vec<Declaration> {
    RigParameters::for_rig(rig).declarations()
}

/// What the parameters say, read.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct RigSettings {
    address: RigAddress,
    setup: RigSetup,
    pub(super) torque_source: TorqueSource,
    pub(super) torque_filter: f64,
    /// The rig in words.
    pub(super) name: String,
    /// Where the motor's temperature is kept; empty for the place where programs keep such things.
    pub(super) state_folder: String,
}

impl RigSettings {
    /// Reads and checks the parameters as a whole.
    ///
    /// # Errors
    /// [`ParameterError`] with the reason, for people.
    pub(super) fn read(values: &Values) -> Result<Self, ParameterError> {
        if values.boolean("use_sim_time") {
            return Err(ParameterError::refused(
                "use_sim_time must be false: the rig runs by the system's clock, and stamps what it measures with it",
            ));
        }
        let said = RigParameters::default().with(values);
        let (address, setup) = said.setup()?;
        Ok(Self {
            setup,
            torque_source: said.torque_source.0,
            torque_filter: said.torque_filter,
            name: address.to_string(),
            address,
            state_folder: said.state_folder,
        })
    }

    /// Whether the rig is a simulated one.
    pub(super) fn is_simulated(&self) -> bool {
        self.address.is_simulated()
    }

    /// Names of limits in which `other` differs.
    pub(super) fn differing(&self, other: &Self) -> Vec<&'static str> {
        let (here, there) = (&self.setup.limits, &other.setup.limits);
        [
            ("rig", self.address != other.address),
            ("voltage_limit", here.voltage != there.voltage),
            ("safety.slew", here.slew != there.slew),
            ("safety.velocity", here.velocity != there.velocity),
            ("safety.travel", here.travel != there.travel),
            ("safety.command_age", here.command_age != there.command_age),
            ("safety.command_lost", here.command_lost != there.command_lost),
            ("safety.cycle_late", here.cycle_late != there.cycle_late),
            ("safety.cycle_lost", here.cycle_lost != there.cycle_lost),
            ("calibration", self.setup.calibration != other.setup.calibration),
        ]
        .into_iter()
        .filter_map(|(name, differs)| differs.then_some(name))
        .collect()
    }

    /// The motor that the parameters describe.
    pub(super) const fn motor(&self) -> Motor {
        self.setup.simulation.drive
    }

    /// Opens the rig with its motor at zero volts, under the safety layer, unconfigured.
    ///
    /// # Errors
    /// [`RigError`] says what is missing or refused.
    pub(super) fn open(&self) -> Result<Supervised<Box<dyn Rig + Send>>, RigError> {
        self.address.open(&self.setup)?.supervised()
    }
}

/// Whether `rig` is the address of a simulated rig.
pub(super) fn is_simulated(rig: &str) -> bool {
    rig.parse::<RigAddress>().is_ok_and(|address| address.is_simulated())
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use ros_node::{ParameterValue, parameters::ParameterStore};

    use super::{super::limits_guard::is_limit, *};
    use crate::{SimulationOptions, safety::SafetyLimits};

    fn read(given: &[(&str, ParameterValue)]) -> Result<RigSettings, String> {
        let given: BTreeMap<_, _> =
            given.iter().map(|(name, value)| ((*name).to_owned(), value.clone())).collect();
        let store = ParameterStore::new(declarations("simulated"), &given, Box::new(|_, _| Ok(())))
            .map_err(|error| error.to_string())?;
        RigSettings::read(store.values()).map_err(|error| error.to_string())
    }

    #[test]
    fn the_defaults_are_the_test_bed_under_its_limits() {
        let settings = read(&[]).unwrap();
        let default = SimulationOptions::default();
        assert_eq!(
            settings.setup,
            RigSetup { limits: settings.setup.limits, ..RigSetup::default() }
        );
        let rig = settings.open().unwrap();
        let limits = SafetyLimits::for_simulation(&default);
        assert_eq!(*rig.supervisor().limits(), SafetyLimits { cycle_lost: f64::MAX, ..limits });
        assert!(!rig.supervisor().state().moves());
    }

    /// What the guard keeps from being changed says so.
    #[test]
    fn every_limit_says_when_it_is_taken() {
        for one in declarations("simulated") {
            let said = one.allowed().contains("allow_limits");
            assert_eq!(is_limit(one.name()), said, "{}", one.name());
        }
    }

    #[test]
    fn what_cannot_be_is_refused_by_name() {
        let text = |value: &str| ParameterValue::String(value.to_owned());
        for (name, value, said) in [
            ("rig", text("usb"), "serial:/dev/ttyACM0"),
            ("rig", text("serial:"), "serial:/dev/ttyACM0"),
            ("rig", text("serial:/dev/x@fast"), "baud"),
            ("calibration.encoder_sign", ParameterValue::Integer(0), "encoder_sign"),
            ("calibration.tachometer_gain", ParameterValue::Double(0.0), "tachometer_gain"),
            ("safety.command_lost", ParameterValue::Double(0.001), "command_lost"),
            ("voltage_limit", ParameterValue::Double(11.0), "voltage_limit"),
        ] {
            let message = read(&[(name, value)]).unwrap_err();
            assert!(message.contains(said), "{name}: {message}");
        }
    }
}
