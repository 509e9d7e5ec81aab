//! Values and requests between JSON and ROS.

use ros_node::ParameterValue;
use serde_json::{Number, Value, json};

/// A parameter's value as JSON. What is no number is told as text, since JSON has no word for it.
pub(super) fn value(of: &ParameterValue) -> Value {
    let double = |number: f64| {
        Number::from_f64(number).map_or_else(|| json!(number.to_string()), Value::Number)
    };
    match of {
        ParameterValue::NotSet => Value::Null,
        ParameterValue::Boolean(value) => json!(value),
        ParameterValue::Integer(value) => json!(value),
        ParameterValue::Double(value) => double(*value),
        ParameterValue::String(value) => json!(value),
        ParameterValue::ByteArray(value) => json!(value),
        ParameterValue::BooleanArray(value) => json!(value),
        ParameterValue::IntegerArray(value) => json!(value),
        ParameterValue::DoubleArray(value) => value.iter().map(|one| double(*one)).collect(),
        ParameterValue::StringArray(value) => json!(value),
    }
}

/// What JSON says of a parameter that has the type of `now`.
///
/// # Errors
/// What was expected and what came.
pub(super) fn typed(said: &Value, now: &ParameterValue) -> Result<ParameterValue, String> {
    let doubles = || {
        let all = said.as_array()?.iter().map(Value::as_f64);
        all.collect::<Option<Vec<f64>>>().map(ParameterValue::DoubleArray)
    };
    let typed = match now {
        ParameterValue::Boolean(_) => said.as_bool().map(ParameterValue::Boolean),
        ParameterValue::Integer(_) => whole(said).map(ParameterValue::Integer),
        ParameterValue::Double(_) => said.as_f64().map(ParameterValue::Double),
        ParameterValue::String(_) => {
            said.as_str().map(|text| ParameterValue::String(text.to_owned()))
        }
        ParameterValue::DoubleArray(_) => doubles(),
        _ => None,
    };
    typed.ok_or_else(|| format!("must be of type {}, but is {said}", now.kind()))
}

/// A whole number, also one that was written with a fraction of nothing.
fn whole(said: &Value) -> Option<i64> {
    said.as_i64().or_else(|| {
        let number = said.as_f64().filter(|number| number.fract() == 0.0)?;
        // Beyond this not every whole number is one of a double.
        (number.abs() <= 9.007_199_254_740_992e15).then_some(number as i64)
    })
}

/// A request: `usual` with what was said in its place.
///
/// # Errors
/// Which field there is not.
pub(super) fn with(mut usual: Value, said: &Value) -> Result<Value, String> {
    let (Value::Object(fields), Value::Object(said)) = (&mut usual, said) else {
        return Ok(said.clone());
    };
    for (name, value) in said {
        let known: Vec<&String> = fields.keys().collect();
        let Some(field) = fields.get(name) else {
            return Err(format!("there is no field {name}; there are {known:?}"));
        };
        let value = with(field.clone(), value)?;
        fields.insert(name.clone(), value);
    }
    Ok(usual)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_takes_the_type_that_the_parameter_has() {
        let double = ParameterValue::Double(1.0);
        assert_eq!(typed(&json!(3), &double), Ok(ParameterValue::Double(3.0)));
        let integer = ParameterValue::Integer(1);
        assert_eq!(typed(&json!(3.0), &integer), Ok(ParameterValue::Integer(3)));
        assert!(typed(&json!(3.5), &integer).is_err());
        assert!(typed(&json!(1e300), &integer).is_err());
        assert!(typed(&json!("x"), &double).is_err());
        assert!(typed(&Value::Null, &double).is_err());
        assert_eq!(value(&ParameterValue::Double(f64::NAN)), json!("NaN"));
    }

    #[test]
    fn what_is_not_said_stays_usual() {
        let usual = json!({ "a": 1, "b": { "c": 2, "d": 3 } });
        assert_eq!(
            with(usual.clone(), &json!({ "b": { "c": 5 } })),
            Ok(json!({ "a": 1, "b": { "c": 5, "d": 3 } }))
        );
        assert!(with(usual, &json!({ "x": 5 })).unwrap_err().contains("no field x"));
    }
}
