//! Parameters from a file, to be scored without a fit: those of this program's `servo.json` or the
//! peer's (bam), under its names.

use friction_ident::servo::{Physics, ServoParameter as P};
use serde_json::{Map, Value};
use work::BadInput;

/// The peer's names and ours.
const PEER: [(&str, P); 19] = [
    ("kt", P::TorqueConstant),
    ("R", P::Resistance),
    ("armature", P::Armature),
    ("q_offset", P::PositionOffset),
    ("friction_base", P::Coulomb),
    ("friction_viscous", P::Viscous),
    ("friction_stribeck", P::StribeckCoulomb),
    ("load_friction_base", P::Load),
    ("load_friction_stribeck", P::StribeckLoad),
    ("load_friction_motor", P::MotorLoad),
    ("load_friction_external", P::ExternalLoad),
    ("load_friction_motor_stribeck", P::StribeckMotor),
    ("load_friction_external_stribeck", P::StribeckExternal),
    ("load_friction_motor_quad", P::QuadraticMotor),
    ("load_friction_external_quad", P::QuadraticExternal),
    ("dtheta_stribeck", P::StribeckVelocity),
    ("alpha", P::StribeckExponent),
    ("error_gain_ratio", P::GainScale),
    ("max_velocity", P::GoalSpeed),
];
/// The peer's name of the delay, with its older one.
const PEER_DELAY: [&str; 2] = ["command_delay", "delay"];
/// The peer's fields that are no parameters.
const PEER_TEXTS: [&str; 2] = ["model", "actuator"];

/// Parameters to be scored.
#[derive(Debug, Clone, PartialEq)]
pub struct GivenParameters {
    /// Each with its value.
    pub values: Vec<(P, f64)>,
    /// The servo that the file names.
    pub actuator: Option<String>,
}

impl GivenParameters {
    /// Reads them.
    ///
    /// # Errors
    /// [`BadInput`] for a file that is neither form, a name that there is not, a value that is no
    /// number, and motor constants that are missing.
    pub fn read(file: &str, text: &str) -> Result<Self, BadInput> {
        let wrong = |why: String| BadInput(format!("{file}: {why}"));
        let document: Map<String, Value> = serde_json::from_str(text)
            .map_err(|error| wrong(format!("no file of servo parameters: {error}")))?;
        let values = match document.get("parameters") {
            Some(Value::Array(list)) => list
                .iter()
                .map(|entry| {
                    let name = entry.get("name").and_then(Value::as_str).unwrap_or_default();
                    let parameter = P::of_name(name);
                    let value = entry.get("value").and_then(Value::as_f64);
                    parameter.zip(value).ok_or_else(|| {
                        wrong(format!("parameter `{name}` is none of a servo, or has no number"))
                    })
                })
                .collect::<Result<Vec<_>, _>>()?,
            _ => flat(&document).map_err(wrong)?,
        };
        if let Some((parameter, value)) = values.iter().find(|(_, value)| !value.is_finite()) {
            return Err(wrong(format!("{} must be finite, but is {value}", parameter.name())));
        }
        for needed in [P::TorqueConstant, P::Resistance, P::Armature] {
            let value = values.iter().find(|(parameter, _)| *parameter == needed);
            if !value.is_some_and(|(_, value)| *value > 0.0) {
                return Err(wrong(format!(
                    "{} is missing or not above 0; a file of parameters is `servo.json` as identify-servo \
                     writes it, or the peer's with kt, R, armature, friction_base, ...",
                    needed.name()
                )));
            }
        }
        let text = |name: &str| document.get(name).and_then(Value::as_str).map(str::to_owned);
        Ok(Self { values, actuator: text("actuator").or_else(|| text("servo")) })
    }

    /// The coefficients; what the file does not have is neutral.
    pub fn physics(&self) -> Physics {
        let (parameters, values): (Vec<P>, Vec<f64>) = self.values.iter().copied().unzip();
        Physics::new(&parameters, &values)
    }
}

fn flat(document: &Map<String, Value>) -> Result<Vec<(P, f64)>, String> {
    document
        .iter()
        .filter(|(name, _)| !PEER_TEXTS.contains(&name.as_str()))
        .map(|(name, value)| {
            let known = PEER.iter().find(|(peer, _)| peer == name).map(|(_, parameter)| *parameter);
            let delay = PEER_DELAY.contains(&name.as_str()).then_some(P::Delay);
            let parameter = known.or(delay).or_else(|| P::of_name(name)).ok_or_else(|| {
                let names: Vec<&str> = PEER.iter().map(|(peer, _)| *peer).collect();
                format!("no parameter `{name}`; the peer's are {}", names.join(", "))
            })?;
            let value = value.as_f64().ok_or_else(|| format!("{name} must be a number"))?;
            Ok((parameter, value))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_peers_file_and_ours_are_read() {
        let peer = r#"{"kt": 0.4, "R": 3.5, "armature": 0.002, "load_friction_base": 0.2,
            "command_delay": 0.005, "model": "m3", "actuator": "xl330"}"#;
        let given = GivenParameters::read("m3.json", peer).unwrap();
        assert_eq!(given.actuator.as_deref(), Some("xl330"));
        let physics = given.physics();
        assert_eq!((physics.get(P::TorqueConstant), physics.get(P::Delay)), (0.4, 0.005));
        // One coefficient for both torques.
        assert_eq!((physics.get(P::ExternalLoad), physics.get(P::MotorLoad)), (0.2, 0.2));
        let own = r#"{"level": "m1", "servo": "xl330", "parameters": [{"name": "k_t", "value": 0.4},
            {"name": "r", "value": 3.5}, {"name": "armature", "value": 0.002}]}"#;
        assert_eq!(GivenParameters::read("servo.json", own).unwrap().values.len(), 3);
    }

    #[test]
    fn what_cannot_be_scored_is_refused_with_the_file() {
        for (text, said) in [
            ("[]", "no file of servo parameters"),
            (r#"{"kt": 0.4}"#, "r is missing"),
            (r#"{"kt": 0.4, "R": 3.5, "armature": 0.002, "frction": 1}"#, "no parameter `frction`"),
            (r#"{"kt": "a"}"#, "kt must be a number"),
            (r#"{"kt": 0.4, "R": 0, "armature": 0.002}"#, "r is missing or not above 0"),
        ] {
            let message = GivenParameters::read("p.json", text).unwrap_err().to_string();
            assert!(message.contains("p.json") && message.contains(said), "{message}");
        }
    }
}
