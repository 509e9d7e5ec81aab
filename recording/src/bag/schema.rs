//! Definitions of message types in a bag: whether they are what they say, and what to put in the
//! place of a damaged one.

use msgs::RosMessage;
use msgs::diagnostic_msgs::DiagnosticArray;
use msgs::friction_msgs::{
    ControllerState, ExperimentStatus, FrictionEstimate, MotorVoltage, Reference, RigMeasurement,
};
use msgs::rosgraph_msgs::Clock;
use msgs::sensor_msgs::JointState;

/// Between the definitions of a schema.
const RULER: &str =
    "================================================================================";

/// What a definition is worth.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Judgement {
    /// It is a definition, and the known one where its hash names that.
    Sound,
    /// It is damaged, and its type's hash says that this is what it was.
    Mended(String),
    /// It is damaged, and nobody here knows what it was.
    Damaged,
}

/// Judges the definition `text` of the type `name`; `hash` is what its channel says of the type's
/// structure.
pub(super) fn judge(name: &str, encoding: &str, text: &[u8], hash: Option<&str>) -> Judgement {
    if encoding != "ros2msg" {
        return Judgement::Sound;
    }
    let found = std::str::from_utf8(text).ok().and_then(structure);
    let known = known(name).filter(|(_, of)| hash == Some(of));
    match (found, known) {
        (Some(found), Some((schema, _))) if Some(&found) == structure(&schema).as_ref() => {
            Judgement::Sound
        }
        (_, Some((schema, _))) => Judgement::Mended(schema),
        (Some(_), None) => Judgement::Sound,
        (None, None) => Judgement::Damaged,
    }
}

/// Schema and hash of a type of the laboratory.
fn known(name: &str) -> Option<(String, &'static str)> {
    fn of<M: RosMessage>() -> (String, String, &'static str) {
        (M::type_name(), M::schema(), M::TYPE_HASH)
    }
    let all = [
        of::<JointState>,
        of::<RigMeasurement>,
        of::<Reference>,
        of::<MotorVoltage>,
        of::<FrictionEstimate>,
        of::<ControllerState>,
        of::<ExperimentStatus>,
        of::<DiagnosticArray>,
        of::<Clock>,
    ];
    all.into_iter()
        .map(|of| of())
        .find(|(known, ..)| known == name)
        .map(|(_, schema, hash)| (schema, hash))
}

/// What a schema says without its comments: a line a field or constant, a line with its name before
/// each further definition. `None` for what is no `ros2msg`.
fn structure(text: &str) -> Option<Vec<String>> {
    let mut lines = Vec::new();
    let mut named = true;
    for line in text.lines() {
        let line = without_comment(line).trim();
        if line == RULER {
            named = false;
        } else if let Some(name) = line.strip_prefix("MSG:").filter(|_| !named) {
            named = true;
            lines.push(is_type(name.trim()).then(|| format!("MSG: {}", name.trim()))?);
        } else if !line.is_empty() {
            lines.push(
                Some(line)
                    .filter(|line| named && is_field(line))?
                    .split_whitespace()
                    .collect::<Vec<_>>()
                    .join(" "),
            );
        }
    }
    named.then_some(lines)
}

/// The line up to `#`, unless that stands in a text.
fn without_comment(line: &str) -> &str {
    let mut quote = None;
    for (at, c) in line.char_indices() {
        match (c, quote) {
            ('#', None) => return &line[..at],
            ('"' | '\'', None) => quote = Some(c),
            (c, Some(open)) if c == open => quote = None,
            _ => {}
        }
    }
    line
}

/// `TYPE name`, `TYPE name DEFAULT` or `TYPE NAME=VALUE`.
fn is_field(line: &str) -> bool {
    let Some((kind, rest)) = line.split_once(char::is_whitespace) else { return false };
    let name: String =
        rest.trim_start().chars().take_while(|c| c.is_ascii_alphanumeric() || *c == '_').collect();
    let behind = rest.trim_start()[name.len()..].chars().next();
    let spaced = behind.is_none_or(|c| c.is_whitespace() || c == '=');
    is_type(kind)
        && name.starts_with(|c: char| c.is_ascii_alphabetic())
        && spaced
        && !line.chars().any(char::is_control)
}

/// `float64`, `string<=20`, `std_msgs/Header`, `int8[]`, `int8[3]`, `int8[<=3]`.
fn is_type(text: &str) -> bool {
    let word = |text: &str| {
        text.starts_with(|c: char| c.is_ascii_alphabetic())
            && text.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
    };
    let number = |text: &str| !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
    let base = match text.strip_suffix(']').map(|rest| rest.rsplit_once('[')) {
        None => text,
        Some(Some((base, size))) if size.is_empty() || number(size.trim_start_matches("<=")) => {
            base
        }
        Some(_) => return false,
    };
    let base = match base.split_once("<=") {
        Some((base, length)) if number(length) => base,
        Some(_) => return false,
        None => base,
    };
    base.split('/').count() <= 3 && base.split('/').all(word)
}

#[cfg(test)]
mod tests {
    use super::*;

    const NAME: &str = "friction_msgs/msg/MotorVoltage";

    #[test]
    fn every_definition_of_the_laboratory_is_one() {
        for schema in [
            JointState::schema(),
            RigMeasurement::schema(),
            ExperimentStatus::schema(),
            DiagnosticArray::schema(),
            FrictionEstimate::schema(),
        ] {
            assert!(structure(&schema).is_some_and(|lines| lines.len() > 3), "{schema}");
        }
        let all = "int8 A=1\nstring<=5 s 'a#b' # no\nint8[<=3] x\npkg/Type[] y\nbool[3] z\n";
        assert_eq!(structure(all).unwrap().len(), 5);
        for wrong in
            ["float64", "8float x", "float64 x\u{1}", "a[ x", "a<=b x", "float64 \u{e9}", "int8 x!"]
        {
            assert_eq!(structure(wrong), None, "{wrong:?}");
        }
    }

    #[test]
    fn a_damaged_definition_is_mended_by_its_hash_or_given_up() {
        let hash = Some(MotorVoltage::TYPE_HASH);
        let whole = MotorVoltage::schema();
        assert_eq!(judge(NAME, "ros2msg", whole.as_bytes(), hash), Judgement::Sound);
        // Other words in a comment are no damage: ROS's own definitions have others.
        let commented = format!("# another comment\n{whole}");
        assert_eq!(judge(NAME, "ros2msg", commented.as_bytes(), hash), Judgement::Sound);
        for damaged in [
            whole.replace("float64 voltage", "float64 voltbge"),
            whole.replace("float64", "flo\u{0}t64"),
            String::new(),
        ] {
            assert_ne!(damaged, whole);
            assert_eq!(
                judge(NAME, "ros2msg", damaged.as_bytes(), hash),
                Judgement::Mended(whole.clone())
            );
        }
        assert_eq!(judge("there/msg/Else", "ros2msg", b"float64 \xff", None), Judgement::Damaged);
        assert_eq!(judge("there/msg/Else", "ros2msg", b"float64 x", None), Judgement::Sound);
        assert_eq!(judge("there/msg/Else", "ros2idl", b"struct", None), Judgement::Sound);
        // Another version of a type is no damage.
        assert_eq!(
            judge(NAME, "ros2msg", b"float64 volts", Some("RIHS01_other")),
            Judgement::Sound
        );
    }
}
