//! BAM: a parameter file of its model m2, Stribeck without load.
//!
//! BAM reads keys that it knows and passes over others, so that the head stands under `about`. What
//! BAM does not find keeps its default, which would be somebody else's motor: it must be told.

use serde_json::{Map, Value, json};

use super::Drive;
use crate::contact::Contact;
use crate::{Axis, Refusal, Target};

pub(super) fn render(drive: &Drive<'_>) -> Result<String, Refusal> {
    let needs = |what| Refusal::Needs { target: Target::Bam, what };
    let options = drive.options;
    if drive.given.axis == Axis::Linear {
        return Err(needs("an axis that turns: its parameters are torques"));
    }
    let actuator = options.actuator.as_ref().ok_or_else(|| {
        needs("the actuator as BAM calls it, such as sts3215 or xl330: give --actuator NAME")
    })?;
    let motor = options.motor.ok_or_else(|| {
        needs("the motor, whose defaults are somebody else's: give --motor KT:RESISTANCE [N m/A, ohm]")
    })?;
    let armature = options
        .armature
        .ok_or_else(|| needs("the rotor's inertia at the joint: give --armature J [kg m^2]"))?;
    let Contact::Stribeck(p) = drive.contact else {
        return Err(needs("a Stribeck curve"));
    };
    let values = [
        ("about", json!(drive.head)),
        ("model", json!("m2")),
        ("actuator", json!(actuator)),
        ("kt", json!(motor.kt)),
        ("R", json!(motor.resistance)),
        ("armature", json!(armature)),
        ("q_offset", json!(0.0)),
        ("friction_base", json!(p.f_c)),
        ("friction_stribeck", json!(p.f_s - p.f_c)),
        ("dtheta_stribeck", json!(p.v_s)),
        ("alpha", json!(p.delta)),
        ("friction_viscous", json!(p.f_v)),
    ];
    let tree: Map<String, Value> =
        values.into_iter().map(|(key, value)| (key.to_owned(), value)).collect();
    Ok(format!("{:#}\n", Value::Object(tree)))
}
