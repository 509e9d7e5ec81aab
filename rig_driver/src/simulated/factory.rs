//! How the simulated test bed is opened.

use crate::back_end::{BackEnd, Listed, Place, RigFactory, RigSetup, SensorsPresent};
use crate::safety::SafetyLimits;
use crate::{Miswired, Rig, RigError, SimulationOptions};

/// The simulated test bed, as [`RigSetup`] describes it.
#[derive(Debug, Clone, Copy, Default)]
pub struct SimulatedFactory;

impl RigFactory for SimulatedFactory {
    fn name(&self) -> &'static str {
        "simulated"
    }

    fn about(&self) -> &'static str {
        "the test bed of the thesis"
    }

    fn place(&self) -> Place {
        Place::None
    }

    fn is_simulated(&self) -> bool {
        true
    }

    fn listed(&self) -> Vec<Listed> {
        vec![Listed::ready(self.name(), "the test bed of the thesis, always there")]
    }

    fn open(&self, _: Option<&str>, setup: &RigSetup) -> Result<BackEnd, RigError> {
        let simulation = setup.simulation;
        let voltage_limit =
            SafetyLimits::voltage_within(setup.limits.voltage, simulation.voltage_range)?;
        let options = SimulationOptions { voltage_limit, ..simulation };
        let rig = options.build(setup.friction)?;
        let rig: Box<dyn Rig + Send> = match setup.wiring {
            Some(wiring) => Box::new(Miswired::new(rig, wiring)),
            None => rig,
        };
        Ok(BackEnd {
            rig,
            limits: SafetyLimits::for_simulation(&options),
            sensors: SensorsPresent { torque: true, current: true },
            about: None,
            description: None,
        })
    }
}
