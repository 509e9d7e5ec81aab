//! The parameters of the models, each under the model's name.

use ::parameters::{Declaration, ParameterError, ParameterValue, ValueRange, Values};
use friction_model::{AnyModel, AnyParameters, ModelName, Parameter, Range};
use serde_json::{Map, Value, json};

const SIDES: [&str; 2] = ["forward", "backward"];

/// Adds every model's parameters with the test bed's values.
pub(super) fn declare(given: &[String], declared: &mut Vec<Declaration>) {
    for name in ModelName::ALL {
        declare_model(name, name.as_str(), given, declared);
        let prefix = format!("asymmetric.{name}");
        if given.iter().any(|given| given.starts_with(&format!("{prefix}."))) {
            for side in SIDES {
                declare_model(name, &format!("{prefix}.{side}"), given, declared);
            }
        }
    }
}

/// The parameters of one model under a prefix. A parameter that may be left out exists only if it
/// has a value or is given one.
fn declare_model(name: ModelName, prefix: &str, given: &[String], declared: &mut Vec<Declaration>) {
    let parameters = AnyParameters::test_bed(name);
    let written = match serde_json::to_value(parameters) {
        Ok(mut all) => all.get_mut(name.as_str()).map(Value::take).unwrap_or_default(),
        Err(_) => Value::Null,
    };
    for row in parameters.table() {
        let full = format!("{prefix}.{}", row.name);
        let default = match written.get(row.name).and_then(value) {
            Some(default) => default,
            None if given.contains(&full) => ParameterValue::Double(0.0),
            None => continue,
        };
        declared.push(declare_row(full, default, row));
    }
}

fn declare_row(full: String, default: ParameterValue, row: &Parameter) -> Declaration {
    let whole = matches!(default, ParameterValue::Integer(_));
    let declaration = Declaration::new(full, default, row.meaning);
    let range = match row.range {
        Range::Any => return declaration,
        Range::Such(words) => return declaration.constraint(words),
        Range::Positive => (f64::MIN_POSITIVE, f64::MAX),
        Range::NonNegative => (0.0, f64::MAX),
        Range::Within(low, high) => (low.next_up(), high),
        Range::FromTo(low, high) => (low, high),
    };
    declaration.range(if whole {
        ValueRange::Integer(range.0.ceil().max(0.0) as i64, range.1.min(f64::from(u32::MAX)) as i64)
    } else {
        ValueRange::Double(range.0, range.1)
    })
}

/// A value of a model's file as a parameter; none for what is left out.
fn value(written: &Value) -> Option<ParameterValue> {
    match written {
        Value::Number(number) if number.is_f64() => number.as_f64().map(ParameterValue::Double),
        Value::Number(number) => number.as_i64().map(ParameterValue::Integer),
        Value::Array(all) => {
            Some(ParameterValue::DoubleArray(all.iter().filter_map(Value::as_f64).collect()))
        }
        _ => None,
    }
}

/// A model's parameters by their full names, as in `lugre.f_s` or `asymmetric.lugre.forward.f_s`,
/// in the order of the model's table.
///
/// # Errors
/// [`ParameterError::Refused`] if the model cannot be described, which none built from finite
/// numbers is.
pub fn model_parameters(model: &AnyModel) -> Result<Vec<(String, ParameterValue)>, ParameterError> {
    fn into(found: &mut Vec<(String, ParameterValue)>, path: &str, written: &Value) {
        if let Value::Object(entries) = written {
            for (key, inner) in entries {
                let path = if path.is_empty() { key.clone() } else { format!("{path}.{key}") };
                into(found, &path, inner);
            }
        } else if let Some(value) = value(written) {
            found.push((path.to_owned(), value));
        }
    }
    let mut found = Vec::new();
    into(&mut found, "", &serde_json::to_value(model).map_err(ParameterError::refused)?);
    Ok(found)
}

/// The model of that name with its parameters; for each direction, where such are declared.
pub(super) fn read(name: ModelName, values: &Values) -> Result<AnyModel, ParameterError> {
    let side = |prefix: &str| {
        let mut read = Map::new();
        for row in AnyParameters::test_bed(name).table() {
            let value = match values.get(&format!("{prefix}.{}", row.name)) {
                Some(ParameterValue::Double(value)) => json!(value),
                Some(ParameterValue::Integer(value)) => json!(value),
                Some(ParameterValue::DoubleArray(all)) => json!(all),
                _ => continue,
            };
            read.insert(row.name.to_owned(), value);
        }
        read
    };
    let own = json!({ name.as_str(): side(name.as_str()) });
    let symmetric = serde_json::from_value::<AnyModel>(own).map_err(ParameterError::refused)?;
    let prefix = format!("asymmetric.{name}");
    let [forward, backward] = SIDES.map(|of| side(&format!("{prefix}.{of}")));
    if forward.is_empty() {
        return Ok(symmetric);
    }
    let both =
        json!({ "asymmetric": { name.as_str(): { "forward": forward, "backward": backward } } });
    serde_json::from_value(both).map_err(ParameterError::refused)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_model_stands_with_the_test_beds_parameters() {
        let mut declared = Vec::new();
        declare(&[], &mut declared);
        let values = Values::defaults(&declared);
        for name in ModelName::ALL {
            assert_eq!(read(name, &values).unwrap(), AnyModel::test_bed(name), "{name}");
        }
    }
}
