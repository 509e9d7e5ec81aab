//! The nodes start with one drive: what each declares of it follows from one motor, bit by bit.

use friction_model::Motor;
use ros_node::ParameterValue;
use ros_node::parameters::Declaration;

fn declared(declarations: &[Declaration], name: &str) -> u64 {
    let found = declarations.iter().find(|declaration| declaration.name() == name);
    match found.unwrap_or_else(|| panic!("nobody declares {name}")).default_value() {
        ParameterValue::Double(value) => value.to_bits(),
        other => panic!("{name} is no number: {other:?}"),
    }
}

#[test]
fn every_node_declares_the_drive_of_the_same_motor() {
    let Motor { motor_constant, gear_ratio, armature_resistance, inertia } = Motor::SRV02;
    let (gain, time_constant) = (Motor::SRV02.gain(), Motor::SRV02.time_constant());
    let volts = Motor::SRV02.volts_per_newton_metre();
    let rig = rig_driver::node::declarations("simulated");
    let observer = friction_observer::node::declarations(&[]);
    let controller = controller::node::declarations(&[]);
    for (node, name, value) in [
        (&rig, "drive.motor_constant", motor_constant),
        (&rig, "drive.gear_ratio", gear_ratio),
        (&rig, "drive.armature_resistance", armature_resistance),
        (&rig, "drive.inertia", inertia),
        (&observer, "drive.gain", gain),
        (&observer, "drive.time_constant", time_constant),
        (&observer, "drive.volts_per_newton_metre", volts),
        (&controller, "drive.gain", gain),
        (&controller, "drive.time_constant", time_constant),
        (&controller, "volts_per_newton_metre", volts),
    ] {
        assert_eq!(declared(node, name), value.to_bits(), "{name}");
    }
}
