//! What is wrong with a text that is no servo log: the entry and the field, and what stands there.

use serde_json::{Map, Value};

/// Numbers that the header must have, with their units.
const NEEDED: [(&str, &str); 3] =
    [("mass", " [kg]"), ("length", " [m]"), ("kp", " in the servo's own units")];
/// Numbers that it may have.
const OPTIONAL: [&str; 3] = ["vin", "arm_mass", "damping"];
/// Numbers that each entry must have, with their units.
const IN_ENTRIES: [(&str, &str); 3] =
    [("timestamp", " [s]"), ("position", " [rad]"), ("goal_position", " [rad]")];
/// Numbers that it may have.
const OPTIONAL_IN_ENTRIES: [&str; 2] = ["speed", "input_volts"];
/// A longer text is not read a second time for it \[bytes\].
const LONGEST: usize = 1 << 26;
/// How much of what stands there is told.
const TOLD: usize = 40;

/// The first thing that is wrong; none where the text is no JSON, or nothing is found.
pub(super) fn complaint(text: &[u8]) -> Option<String> {
    if text.len() > LONGEST {
        return None;
    }
    let document: Value = serde_json::from_slice(text).ok()?;
    let Value::Object(log) = &document else {
        return Some(format!(
            "expected one object with the fields mass, length, kp and entries, but found {}",
            shown(&document)
        ));
    };
    of_header(log).or_else(|| match log.get("entries") {
        None => Some("it has no `entries`: expected a list with one entry a sample".to_owned()),
        Some(Value::Array(entries)) => entries
            .iter()
            .enumerate()
            .find_map(|(index, entry)| of_entry(entry).map(|why| (index, why)))
            .map(|(index, why)| format!("entry {} of `entries`, counted from 1: {why}", index + 1)),
        Some(other) => Some(format!(
            "`entries` must be a list with one entry a sample, but is {}",
            shown(other)
        )),
    })
}

/// What is wrong with a text that is no JSON: programs in Python write NaN, which JSON has not.
pub(super) fn no_json(text: &[u8], error: &serde_json::Error) -> String {
    /// How far before and behind the place of the error the word may stand.
    const AROUND: usize = 10;
    let line = text.split(|&byte| byte == b'\n').nth(error.line().saturating_sub(1));
    let line = line.unwrap_or_default();
    let from = error.column().saturating_sub(AROUND).min(line.len());
    let near = line.get(from..line.len().min(error.column() + AROUND)).unwrap_or_default();
    let has = |word: &[u8]| near.windows(word.len()).any(|part| part == word);
    if has(b"NaN") || has(b"Infinity") {
        format!("{error}: JSON has no NaN and no Infinity; leave out that entry")
    } else {
        error.to_string()
    }
}

fn of_header(log: &Map<String, Value>) -> Option<String> {
    let needed = NEEDED.iter().find_map(|(name, unit)| match log.get(*name) {
        None => Some(format!("missing field `{name}`: the header must have it, a number{unit}")),
        Some(value) => no_number(name, unit, value),
    });
    needed.or_else(|| OPTIONAL.iter().find_map(|name| no_optional(log, name)))
}

fn of_entry(entry: &Value) -> Option<String> {
    let Value::Object(entry) = entry else {
        return Some(format!("expected an object with its fields, but found {}", shown(entry)));
    };
    let needed = IN_ENTRIES.iter().find_map(|(name, unit)| match entry.get(*name) {
        None => Some(format!("missing field `{name}`: each entry must have it, a number{unit}")),
        Some(value) => no_number(name, unit, value),
    });
    needed.or_else(|| OPTIONAL_IN_ENTRIES.iter().find_map(|name| no_optional(entry, name))).or_else(
        || {
            let switch = entry.get("torque_enable")?;
            let said = matches!(switch.as_f64(), Some(value) if value == 0.0 || value == 1.0);
            (!(switch.is_boolean() || said))
                .then(|| format!("`torque_enable` must be true or false, but is {}", shown(switch)))
        },
    )
}

fn no_optional(of: &Map<String, Value>, name: &str) -> Option<String> {
    no_number(name, ", or be left out", of.get(name).filter(|value| !value.is_null())?)
}

fn no_number(name: &str, unit: &str, value: &Value) -> Option<String> {
    if value.is_number() {
        return None;
    }
    let quoted = value.as_str().is_some_and(|text| text.trim().parse::<f64>().is_ok());
    let mend = if quoted { "; write it without quotation marks" } else { "" };
    Some(format!("`{name}` must be a number{unit}, but is {}{mend}", shown(value)))
}

/// A value in words, shortened.
fn shown(value: &Value) -> String {
    match value {
        Value::Null => "null, which is no value".to_owned(),
        Value::Array(_) => "a list".to_owned(),
        Value::Object(_) => "an object".to_owned(),
        Value::String(text) => match text.char_indices().nth(TOLD) {
            Some((end, _)) => format!("the text \"{}...\"", &text[..end]),
            None => format!("the text \"{text}\""),
        },
        other => other.to_string(),
    }
}
