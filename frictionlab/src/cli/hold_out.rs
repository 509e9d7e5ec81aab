//! `--hold-out FIELD=VALUE[,VALUE]`: logs chosen by any field of their header.

use recording::servo_log::ServoFile;
use serde_json::Value;
use work::BadInput;

/// A field of the header and the values of the logs to hold out; no values where whoever asks did
/// not say them, which is refused once it is known which there are.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct HoldOut {
    field: String,
    values: Vec<String>,
}

const EXPECTED: &str = "expected a field of the header and its values, as in kp=400 or trajectory=sin_sin,lift_and_drop";

impl HoldOut {
    /// Reads `FIELD=VALUE[,VALUE]`; a number alone means the gain.
    pub(super) fn parse(text: &str) -> Result<Self, String> {
        let (field, values) = match text.split_once('=') {
            Some((field, values)) => (field.trim(), values),
            None if text.trim().parse::<f64>().is_ok() => ("kp", text),
            None => return Self::bare(text.trim()),
        };
        let values: Vec<String> = values.split(',').map(|value| value.trim().to_owned()).collect();
        if field.is_empty() || values.iter().any(String::is_empty) {
            return Err(EXPECTED.to_owned());
        }
        Ok(Self { field: field.to_owned(), values })
    }

    /// A field without values.
    fn bare(field: &str) -> Result<Self, String> {
        let is_name = |c: char| c.is_alphanumeric() || matches!(c, '_' | '-' | '.');
        if field.is_empty() || !field.chars().all(is_name) {
            return Err(EXPECTED.to_owned());
        }
        Ok(Self { field: field.to_owned(), values: Vec::new() })
    }

    /// Whether it holds the log out.
    pub(super) fn takes(&self, log: &ServoFile) -> bool {
        let here = log.header.get(&self.field);
        here.is_some_and(|here| self.values.iter().any(|value| is(here, value)))
    }

    /// Refuses values that no log has, and a field without values.
    pub(super) fn check(&self, logs: &[ServoFile]) -> Result<(), BadInput> {
        let field = &self.field;
        let has = |value: &String| {
            logs.iter().any(|log| log.header.get(field).is_some_and(|here| is(here, value)))
        };
        let missing = self.values.iter().find(|value| !has(value));
        if missing.is_none() && !self.values.is_empty() {
            return Ok(());
        }
        let mut present: Vec<String> =
            logs.iter().filter_map(|log| log.header.get(field)).map(told).collect();
        present.sort();
        present.dedup();
        let asked = missing.map_or_else(|| field.clone(), |value| format!("{field}={value}"));
        Err(BadInput(match (present.as_slice(), missing) {
            ([], _) => {
                let mut fields: Vec<&str> =
                    logs.iter().flat_map(|log| log.header.keys()).map(String::as_str).collect();
                fields.sort_unstable();
                fields.dedup();
                format!(
                    "--hold-out {asked}: no log's header has the field {field}; there are {}; say which of its \
                     values to hold out, as in kp=400",
                    fields.join(", ")
                )
            }
            (several, Some(_)) => format!(
                "--hold-out {asked}: no log has this value; the logs have {}",
                several.join(", ")
            ),
            (several, None) => format!(
                "--hold-out {asked}: say which logs to hold out, as in --hold-out '{field}={}'; the logs have {}",
                several[0],
                several.join(", ")
            ),
        }))
    }
}

fn told(value: &Value) -> String {
    value.as_str().map_or_else(|| value.to_string(), str::to_owned)
}

/// Numbers are compared as numbers: 0.10 is 0.1.
fn is(here: &Value, asked: &str) -> bool {
    match (here.as_f64(), asked.parse::<f64>()) {
        (Some(here), Ok(asked)) => here == asked,
        _ => told(here) == asked,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_and_words_are_compared_and_nonsense_is_refused() {
        let asked = HoldOut::parse("kp=100,400").unwrap();
        assert_eq!((asked.field.as_str(), asked.values.len()), ("kp", 2));
        assert_eq!(HoldOut::parse("400").unwrap().field, "kp");
        assert!(is(&serde_json::json!(0.1), "0.10") && is(&serde_json::json!("sin"), "sin"));
        assert!(!is(&serde_json::json!("sin"), "0.1"));
        assert!(HoldOut::parse("trajectory").unwrap().values.is_empty());
        for text in ["", "a b", "kp=", "=4", "kp=4,,5"] {
            assert!(HoldOut::parse(text).is_err(), "{text}");
        }
    }
}
