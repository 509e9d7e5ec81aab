//! Where two JSON documents differ, in words.

use serde_json::Value;

/// Longest value that is told whole, in characters.
const LONGEST: usize = 80;

/// Each place where they differ: `seed was 1, is 7`.
pub(super) fn differences(then: &Value, now: &Value) -> Vec<String> {
    let mut found = Vec::new();
    compare(then, now, "", &mut found);
    found
}

fn compare(then: &Value, now: &Value, path: &str, found: &mut Vec<String>) {
    let below =
        |name: &str| if path.is_empty() { name.to_owned() } else { format!("{path}.{name}") };
    match (then, now) {
        (Value::Object(a), Value::Object(b)) => {
            let missing = Value::Null;
            for (name, then) in a {
                compare(then, b.get(name).unwrap_or(&missing), &below(name), found);
            }
            for (name, now) in b.iter().filter(|(name, _)| !a.contains_key(*name)) {
                compare(&missing, now, &below(name), found);
            }
        }
        (Value::Array(a), Value::Array(b)) if a.len() == b.len() => {
            for (i, (then, now)) in a.iter().zip(b).enumerate() {
                compare(then, now, &format!("{path}[{i}]"), found);
            }
        }
        (then, now) if then != now => {
            found.push(format!("{path} was {}, is {}", short(then), short(now)))
        }
        _ => {}
    }
}

/// A value that fits a sentence.
fn short(value: &Value) -> String {
    let text = if value.is_null() { "nothing".to_owned() } else { value.to_string() };
    if text.chars().count() <= LONGEST {
        text
    } else {
        text.chars().take(LONGEST - 3).collect::<String>() + "..."
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn every_difference_is_told_with_its_place() {
        let then = json!({"a": {"b": [1, {"c": 2.5}]}, "gone": 1, "list": [1], "same": "x"});
        let now = json!({"a": {"b": [1, {"c": 2.6}]}, "list": [1, 2], "same": "x", "come": "y".repeat(100)});
        let found = differences(&then, &now);
        assert_eq!(
            found[..3],
            ["a.b[1].c was 2.5, is 2.6", "gone was 1, is nothing", "list was [1], is [1,2]"]
        );
        assert!(
            found[3].starts_with("come was nothing, is \"yyy") && found[3].ends_with("..."),
            "{found:?}"
        );
        assert_eq!(found.len(), 4);
    }
}
