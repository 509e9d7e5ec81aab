//! The files: one format a file.

mod bam;
mod c_header;
mod isaac_lab;
mod ks_kv_ka;
mod mjcf;
mod mjlab;
mod newton;
mod ros2_control;
mod sdf;
mod ur;
mod urdf;
mod usd;

use friction_model::AnyModel;

use crate::contact::Contact;
use crate::cost::Cost;
use crate::options::Options;
use crate::{Given, Refusal, Target, Version};

/// What a format writes.
pub(crate) struct Drive<'a> {
    /// The friction as the target has it.
    pub(crate) contact: Contact,
    /// What it was made from.
    pub(crate) given: &'a Given,
    /// The target's version.
    pub(crate) version: Version,
    /// What is written beside friction.
    pub(crate) options: &'a Options,
    /// The lines of the head.
    pub(crate) head: Vec<String>,
    /// What the conversion costs.
    pub(crate) cost: Cost,
}

/// The file of a target.
pub(crate) fn render(target: Target, drive: &Drive<'_>) -> Result<String, Refusal> {
    Ok(match target {
        Target::Mjcf => mjcf::render(drive),
        Target::Mjlab => mjlab::render(drive),
        Target::Newton => newton::render(drive),
        Target::IsaacLab => isaac_lab::render(drive),
        Target::Urdf => urdf::render(drive),
        Target::Sdf => sdf::render(drive),
        Target::UsdPhysx => usd::physx(drive),
        Target::UsdNewton => usd::newton(drive),
        Target::Ros2Control => ros2_control::render(drive),
        Target::Ur => ur::render(drive)?,
        Target::Bam => bam::render(drive)?,
        Target::KsKvKa => ks_kv_ka::render(drive),
        Target::CHeader => c_header::render(drive),
    })
}

/// Whether the firmware's step function has this model itself.
pub(crate) fn has_step(model: &AnyModel) -> bool {
    c_header::has(model)
}

/// A number as every format reads it.
pub(crate) fn number(value: f64) -> String {
    format!("{value:?}")
}

/// An attribute of XML, with a space before it; nothing without a value.
pub(crate) fn attribute(name: &str, value: Option<f64>) -> String {
    value.map_or_else(String::new, |value| format!(" {name}=\"{}\"", number(value)))
}

/// The level and the viscous coefficient of a target that holds no more.
fn coulomb_viscous(contact: Contact) -> (f64, f64) {
    match contact {
        Contact::CoulombViscous { f_c, f_v }
        | Contact::StaticDynamicViscous { f_d: f_c, f_v, .. } => (f_c, f_v),
        // Such a target's releases hold nothing else.
        _ => (0.0, 0.0),
    }
}

/// The levels at rest and in motion, and the viscous coefficient.
fn static_dynamic_viscous(contact: Contact) -> (f64, f64, f64) {
    match contact {
        Contact::StaticDynamicViscous { f_s, f_d, f_v } => (f_s, f_d, f_v),
        other => {
            let (f_c, f_v) = coulomb_viscous(other);
            (f_c, f_c, f_v)
        }
    }
}

/// An argument of a call in Python; nothing without a value.
fn keyword(name: &str, value: Option<f64>) -> String {
    value.map_or_else(String::new, |value| format!("    {name}={},\n", number(value)))
}

/// Numbers as a tuple of Python.
fn tuple(values: &[f64]) -> String {
    let values: Vec<String> = values.iter().map(|value| number(*value)).collect();
    format!("({})", values.join(", "))
}

/// A name of Python and of C: what is none of their letters becomes `_`.
fn identifier(joint: &str) -> String {
    joint.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect()
}
