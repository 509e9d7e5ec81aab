//! `--hold-out FIELD=VALUE[,VALUE]`: logs chosen by any field of their header.

use recording::servo_log::ServoFile;
use serde_json::Value;
use work::BadInput;

/// A field of the header and the values of the logs to hold out.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct HoldOut {
    field: String,
    values: Vec<String>,
}

impl HoldOut {
    /// Reads `FIELD=VALUE[,VALUE]`; a number alone means the gain.
    pub(super) fn parse(text: &str) -> Result<Self, String> {
        let (field, values) = match text.split_once('=') {
            Some((field, values)) => (field.trim(), values),
            None if text.trim().parse::<f64>().is_ok() => ("kp", text),
            None => ("", ""),
        };
        let values: Vec<String> = values.split(',').map(|value| value.trim().to_owned()).collect();
        if field.is_empty() || values.iter().any(String::is_empty) {
            return Err(
                "expected a field of the header and its values, as in kp=400 or trajectory=sin_sin,lift_and_drop"
                    .to_owned(),
            );
        }
        Ok(Self { field: field.to_owned(), values })
    }

    /// Whether it holds the log out.
    pub(super) fn takes(&self, log: &ServoFile) -> bool {
        let here = log.header.get(&self.field);
        here.is_some_and(|here| self.values.iter().any(|value| is(here, value)))
    }

    /// Refuses values that no log has.
    pub(super) fn check(&self, logs: &[ServoFile]) -> Result<(), BadInput> {
        for value in &self.values {
            let has = |log: &ServoFile| log.header.get(&self.field).is_some_and(|v| is(v, value));
            if logs.iter().any(has) {
                continue;
            }
            let mut present: Vec<String> =
                logs.iter().filter_map(|log| log.header.get(&self.field)).map(told).collect();
            present.sort();
            present.dedup();
            let field = &self.field;
            return Err(BadInput(if present.is_empty() {
                let mut fields: Vec<&str> =
                    logs.iter().flat_map(|log| log.header.keys()).map(String::as_str).collect();
                fields.sort_unstable();
                fields.dedup();
                format!(
                    "--hold-out {field}={value}: no log's header has the field {field}; there are {}",
                    fields.join(", ")
                )
            } else {
                format!(
                    "--hold-out {field}={value}: no log has this value; the logs have {}",
                    present.join(", ")
                )
            }));
        }
        Ok(())
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
        for text in ["hard", "kp=", "=4", "kp=4,,5"] {
            assert!(HoldOut::parse(text).is_err(), "{text}");
        }
    }
}
