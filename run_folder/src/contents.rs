//! Parameters, figures and settings of a document, by their places in it.

use std::collections::BTreeMap;

use serde::Serialize;
use serde_json::{Map, Value};

use crate::kind::Kind;

/// Parts of a document that say what was asked for.
const SETTINGS: [&str; 8] =
    ["options", "settings", "asked", "wanted", "setting", "seed", "noise", "seeds"];
/// Parts that are neither what was asked for nor what was found.
const BESIDE: [&str; 12] = [
    "format",
    "format_version",
    "program_version",
    "origin",
    "timing",
    "bag",
    "sessions",
    "reconnections",
    "thesis_tables",
    "status",
    "files",
    "path",
];
/// Texts by which the members of a list are known.
const NAMES: [&str; 6] = ["name", "arm", "model", "task", "experiment", "file"];
/// Parts of what was found that say it once more: each repetition, ends of intervals by number.
const AGAIN: [&str; 3] = ["runs", "intervals", "repetition"];
/// Longest list whose members are looked at: longer ones are measured points.
const LONGEST: usize = 60;
/// Deepest place.
const DEEP: usize = 16;
/// Half width of a 95 % interval in standard errors.
const NORMAL_95: f64 = 1.96;

/// A number that was found, with its 95 % interval where it has one.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Quantity {
    /// Value; none where it was not identified at all.
    pub value: Option<f64>,
    /// Unit, where the document says it.
    pub unit: Option<String>,
    /// Lower end of the interval; none where it is open or not known.
    pub low: Option<f64>,
    /// Upper end.
    pub high: Option<f64>,
}

/// What a document holds.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Contents {
    /// What was found with an interval, by its place: `models.lugre.parameters.f_c`.
    pub parameters: BTreeMap<String, Quantity>,
    /// Other numbers that were found.
    pub figures: BTreeMap<String, f64>,
    /// What was asked for: each value as JSON.
    pub settings: BTreeMap<String, String>,
}

impl Contents {
    /// Of the document of a run.
    pub(crate) fn of(kind: Kind, document: &Value) -> Self {
        let mut found = Self::default();
        // Of recordings and of machines in a list there is nothing to hold beside another.
        if matches!(kind, Kind::Recording) {
            return found;
        }
        for (name, part) in document.as_object().into_iter().flatten() {
            match name.as_str() {
                name if BESIDE.contains(&name) || AGAIN.contains(&name) => {}
                name if SETTINGS.contains(&name) => found.setting(name.to_owned(), part, 0),
                name => found.result(name.to_owned(), part, 0),
            }
        }
        found
    }

    fn setting(&mut self, place: String, value: &Value, deep: usize) {
        match value {
            Value::Object(parts) if deep < DEEP && !parts.is_empty() => {
                for (name, part) in parts {
                    self.setting(format!("{place}.{name}"), part, deep + 1);
                }
            }
            Value::Array(list) if list.iter().any(Value::is_object) && list.len() <= LONGEST => {
                for (at, part) in list.iter().enumerate() {
                    self.setting(format!("{place}.{}", named(part, at)), part, deep + 1);
                }
            }
            other => {
                self.settings.insert(place, other.to_string());
            }
        }
    }

    fn result(&mut self, place: String, value: &Value, deep: usize) {
        match value {
            Value::Object(parts) => {
                if let Some(quantity) = quantity(parts) {
                    self.parameters.insert(place, quantity);
                } else if deep < DEEP {
                    for (name, part) in parts {
                        if !AGAIN.contains(&name.as_str()) {
                            self.result(format!("{place}.{name}"), part, deep + 1);
                        }
                    }
                }
            }
            Value::Array(list)
                if deep < DEEP && list.len() <= LONGEST && list.iter().all(Value::is_object) =>
            {
                for (at, part) in list.iter().enumerate() {
                    self.result(format!("{place}.{}", named(part, at)), part, deep + 1);
                }
            }
            Value::Number(number) => {
                self.figures.extend(number.as_f64().map(|number| (place, number)));
            }
            _ => {}
        }
    }
}

/// The name of a member of a list, or its number from 1.
fn named(part: &Value, at: usize) -> String {
    let name = NAMES.iter().find_map(|name| words(&part[*name]));
    match (name, part["repetition"].as_u64()) {
        (Some(name), None) => name,
        (Some(name), Some(repetition)) => format!("{name}.{}", repetition + 1),
        (None, _) => (at + 1).to_string(),
    }
}

/// A text; of an object or a list the texts in it, as of `{"model": ["feedback", "lugre"]}`.
fn words(value: &Value) -> Option<String> {
    match value {
        Value::String(text) => Some(text.clone()),
        Value::Object(parts) => joined(parts.values()),
        Value::Array(list) => joined(list.iter()),
        _ => None,
    }
}

fn joined<'a>(parts: impl Iterator<Item = &'a Value>) -> Option<String> {
    let words: Vec<String> = parts.filter_map(words).collect();
    (!words.is_empty()).then(|| words.join(" "))
}

/// A number with an interval, in any of the forms in which documents have one.
fn quantity(parts: &Map<String, Value>) -> Option<Quantity> {
    let value = parts.get("value")?;
    if !(value.is_number() || value.is_null()) {
        return None;
    }
    let value = value.as_f64();
    let number = |name: &str| parts.get(name).and_then(Value::as_f64);
    let of_pair = ["interval", "interval_95"].iter().find_map(|name| {
        let pair = parts.get(*name)?;
        match pair {
            Value::Array(ends) if ends.len() == 2 => Some((ends[0].as_f64(), ends[1].as_f64())),
            Value::Object(ends) => {
                let end = |name: &str| ends.get(name).and_then(Value::as_f64);
                Some((end("low"), end("high")))
            }
            _ => None,
        }
    });
    let around = |half: f64| (value.map(|at| at - half), value.map(|at| at + half));
    let known = ["interval", "interval_95", "half_width_95", "standard_error", "low", "high"];
    if !known.iter().any(|name| parts.contains_key(*name)) {
        return None;
    }
    let (low, high) = of_pair
        .or_else(|| number("half_width_95").map(around))
        .or_else(|| {
            let ends = ["low", "high"];
            ends.iter()
                .any(|name| parts.contains_key(*name))
                .then(|| (number("low"), number("high")))
        })
        .or_else(|| number("standard_error").map(|error| around(NORMAL_95 * error)))
        .unwrap_or_default();
    let unit = parts.get("unit").and_then(Value::as_str).map(str::to_owned);
    Some(Quantity { value, unit, low, high })
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn intervals_are_read_in_every_form() {
        let of = |value: Value| Contents::of(Kind::Run, &json!({ "found": value })).parameters;
        let ends = |value: Value| {
            let found = of(value);
            let one = &found["found"];
            (one.value, one.low, one.high)
        };
        let wanted = (Some(2.0), Some(1.0), Some(3.0));
        assert_eq!(ends(json!({ "value": 2.0, "interval": [1.0, 3.0] })), wanted);
        assert_eq!(ends(json!({ "value": 2.0, "interval_95": [1.0, 3.0] })), wanted);
        assert_eq!(ends(json!({ "value": 2.0, "interval": { "low": 1.0, "high": 3.0 } })), wanted);
        assert_eq!(ends(json!({ "value": 2.0, "half_width_95": 1.0 })), wanted);
        assert_eq!(ends(json!({ "value": 2.0, "low": 1.0, "high": 3.0 })), wanted);
        assert_eq!(ends(json!({ "value": 2.0, "low": 1.0, "high": null })).2, None);
        assert_eq!(ends(json!({ "value": 2.0, "standard_error": 0.5 })).1, Some(1.02));
        assert!(of(json!({ "value": 2.0 })).is_empty(), "a number without an interval is a figure");
    }

    #[test]
    fn places_have_the_names_of_what_stands_there() {
        let document = json!({
            "options": { "seed": 1, "rates": [1.0, 2.0], "tasks": [{ "name": "slow", "period": 0.1 }] },
            "rows": [{ "arm": "none", "mse": 1.0 }, { "arm": "lugre", "mse": 0.5, "repetition": 1 },
                { "arm": { "model": ["feedback", "lugre"] }, "mse": 0.5 }],
            "runs": [{ "mse": 1.0 }],
            "points": [0.1, 0.2],
            "timing": { "wall_seconds": 3.0 },
        });
        let found = Contents::of(Kind::Run, &document);
        let settings: Vec<(&str, &str)> =
            found.settings.iter().map(|(a, b)| (a.as_str(), b.as_str())).collect();
        assert_eq!(
            settings,
            [
                ("options.rates", "[1.0,2.0]"),
                ("options.seed", "1"),
                ("options.tasks.slow.name", "\"slow\""),
                ("options.tasks.slow.period", "0.1")
            ]
        );
        let figures: Vec<&str> = found.figures.keys().map(String::as_str).collect();
        assert_eq!(figures, ["rows.feedback lugre.mse", "rows.lugre.2.mse", "rows.none.mse"]);
    }
}
