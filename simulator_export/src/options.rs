//! What whoever exports can say beside the target.

use crate::given::Cogging;
use crate::{Refusal, Target};

/// How a motor turns volts into torque, for gains in volts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Volts {
    /// Volts that hold one N m (or N): resistance over torque constant, at the joint.
    pub per_effort: f64,
    /// Volts that the motion induces \[V s/rad or V s/m\], at the joint.
    pub back_emf: f64,
}

/// A motor as BAM has it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Motor {
    /// Torque constant \[N m/A\].
    pub kt: f64,
    /// Resistance \[ohm\].
    pub resistance: f64,
}

/// The friction that a robot's own model has at scale 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reference {
    /// Its Coulomb level \[N m\].
    pub f_c: f64,
    /// Its viscous coefficient \[N m s/rad\].
    pub f_v: f64,
}

/// What is written beside friction, and what is accepted.
#[derive(Debug, Clone, PartialEq)]
pub struct Options {
    /// The joint's name in the target.
    pub joint: String,
    /// Inertia of the rotor at the joint \[kg m^2 or kg\].
    pub armature: Option<f64>,
    /// Torque that depends on the angle.
    pub cogging: Option<Cogging>,
    /// Inertia of the whole axis \[kg m^2 or kg\], for kA.
    pub inertia: Option<f64>,
    /// The motor, for gains in volts.
    pub volts: Option<Volts>,
    /// The friction of the robot's own model at scale 1, for scales.
    pub reference: Option<Reference>,
    /// The motor, for BAM.
    pub motor: Option<Motor>,
    /// What BAM calls the actuator.
    pub actuator: Option<String>,
    /// Write what is further from the identified friction than the bars allow.
    pub accept_error: bool,
    /// Write parameters that were never identified.
    pub accept_unidentified: bool,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            joint: "joint".to_owned(),
            armature: None,
            cogging: None,
            inertia: None,
            volts: None,
            reference: None,
            motor: None,
            actuator: None,
            accept_error: false,
            accept_unidentified: false,
        }
    }
}

impl Options {
    /// Whether all of it can be, and has a place in the target.
    pub(crate) fn check(&self, target: Target) -> Result<(), Refusal> {
        let name = &self.joint;
        if !is_joint(name) {
            return Err(Refusal::Joint { name: name.clone() });
        }
        if let Some(name) = self.actuator.as_ref().filter(|name| !is_joint(name)) {
            return Err(Refusal::Joint { name: name.clone() });
        }
        let above = [
            ("the armature", self.armature),
            ("the inertia", self.inertia),
            ("volts per N m", self.volts.map(|volts| volts.per_effort)),
            ("the reference's Coulomb level", self.reference.map(|of| of.f_c)),
            ("the reference's viscous coefficient", self.reference.map(|of| of.f_v)),
            ("the torque constant", self.motor.map(|motor| motor.kt)),
            ("the resistance", self.motor.map(|motor| motor.resistance)),
        ];
        for (what, value) in above {
            if let Some(value) = value.filter(|value| !(*value > 0.0 && value.is_finite())) {
                return Err(Refusal::Value { what, expected: "a finite number above zero", value });
            }
        }
        let any = [
            ("the back-EMF", self.volts.map(|volts| volts.back_emf)),
            ("the amplitude of the cogging", self.cogging.map(|cogging| cogging.amplitude)),
            ("the periods of the cogging", self.cogging.map(|cogging| cogging.periods)),
        ];
        for (what, value) in any {
            if let Some(value) = value.filter(|value| !(*value >= 0.0 && value.is_finite())) {
                let expected = "a finite number, zero or more";
                return Err(Refusal::Value { what, expected, value });
            }
        }
        if let Some(value) = self.cogging.map(|cogging| cogging.phase).filter(|x| !x.is_finite()) {
            return Err(Refusal::Value {
                what: "the phase of the cogging",
                expected: "a finite number",
                value,
            });
        }
        let places = [
            ("an armature", self.armature.is_some(), target.has_armature()),
            ("cogging", self.cogging.is_some(), target.has_cogging()),
            ("an inertia", self.inertia.is_some(), target == Target::KsKvKa),
            ("volts per N m", self.volts.is_some(), target == Target::KsKvKa),
            ("a reference", self.reference.is_some(), target == Target::Ur),
            ("a motor", self.motor.is_some(), target == Target::Bam),
            ("an actuator", self.actuator.is_some(), target == Target::Bam),
        ];
        match places.into_iter().find(|(_, given, place)| *given && !place) {
            Some((what, ..)) => Err(Refusal::NoPlace { target, what }),
            None => Ok(()),
        }
    }
}

/// Whether a name stands in every format as it is.
fn is_joint(name: &str) -> bool {
    let begins = name.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_');
    let is_name = |c: char| c.is_ascii_alphanumeric() || "_-./".contains(c);
    begins && name.chars().all(is_name) && name.len() <= 200
}
