//! `parameters.yaml`: driver, observer and controller as a ROS 2 parameter file.

use controller::{ControllerOptions, ControllerParameters, VelocityLaw};
use friction_observer::parameters::{ObserverParameters, Regulated};
use parameters::file::Writer;
use parameters::{Declared, ParameterValue};

use super::Found;
use crate::CommissionError;
use crate::axis::Known;
use crate::bed::{Arm, Bed};

/// The file as text.
pub(super) fn render(known: &Known, found: &Found, bed: &Bed) -> Result<String, CommissionError> {
    let (controller, estimator) = bed.settings(found.control.arm);
    let mut file = Writer::default();
    let version = env!("CARGO_PKG_VERSION");
    file.comment(&format!("Commission of the rig {} by frictionlab {version}.", found.rig));
    file.comment(
        "Friction is told in volts: volts_per_newton_metre is 1, and what is called N m is V.",
    );
    let period = ParameterValue::Double(known.period);

    if found.control.arm == Arm::Load {
        file.comment(
            "The places of load.* are the rig's own count of that day: where it begins to count elsewhere, set the four to zero.",
        );
    }

    file.node("/rig_driver");
    file.value("voltage_limit", ParameterValue::Double(known.voltage), "as it was commissioned");
    let first = known.corrected_by.unwrap_or_default();
    for one in found.met.calibration.after(&first).declarations() {
        file.value(&format!("calibration.{}", one.name()), one.default_value().clone(), "found");
    }

    file.node("/friction_observer");
    let observer = ObserverParameters::saying(bed.friction(), &estimator, Regulated::Position)?;
    for (name, value) in observer {
        file.value(&name, value, "");
    }
    file.value("period", period.clone(), "of the rig");

    file.node("/controller");
    // The loop of `mode: velocity`, which is there to be switched to.
    let controller = match found.control.velocity {
        Some(velocity) => {
            ControllerOptions { velocity: VelocityLaw::Pi(velocity.gains), ..controller }
        }
        None => controller,
    };
    let said = ControllerParameters::of(&controller);
    let values = said.values();
    for declared in said.declarations() {
        let name = declared.name();
        if let Some(value) = values.get(name).filter(|_| !["period", "autostart"].contains(&name)) {
            file.value(name, value.clone(), "");
        }
    }
    file.value("period", period, "of the rig");
    Ok(file.text())
}
