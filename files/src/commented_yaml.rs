//! A tree of values as YAML, with a comment behind each value.

use std::fmt::Write;

use serde_json::{Map, Value};

/// A number that every YAML reader, ROS's included, takes for a double: always with a point.
#[must_use]
pub fn number(value: f64) -> String {
    let text = if value != 0.0 && !(1e-4..1e15).contains(&value.abs()) {
        format!("{value:e}")
    } else {
        format!("{value}")
    };
    match text.split_once('e') {
        _ if text.contains('.') => text,
        Some((mantissa, exponent)) => format!("{mantissa}.0e{exponent}"),
        None => format!("{text}.0"),
    }
}

/// The tree as block YAML that ROS reads too: every number that is no integer has a point.
/// `comment` is asked for each value by its path, as in `/controller.ros__parameters.pid.k_p`; what
/// it says stands behind it on its line, nothing where it is empty.
pub fn render(tree: &Map<String, Value>, comment: &dyn Fn(&str) -> String) -> String {
    let mut text = String::new();
    block(&mut text, tree, "", 0, comment);
    text
}

/// Every value of the tree by its path.
pub fn leaves(tree: &Map<String, Value>) -> Vec<(String, &Value)> {
    fn into<'a>(found: &mut Vec<(String, &'a Value)>, tree: &'a Map<String, Value>, path: &str) {
        for (key, value) in tree {
            let path = joined(path, key);
            match value {
                Value::Object(map) if !map.is_empty() => into(found, map, &path),
                Value::Null => {}
                value => found.push((path, value)),
            }
        }
    }
    let mut found = Vec::new();
    into(&mut found, tree, "");
    found
}

fn joined(path: &str, key: &str) -> String {
    if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") }
}

fn block(
    text: &mut String,
    tree: &Map<String, Value>,
    path: &str,
    indent: usize,
    comment: &dyn Fn(&str) -> String,
) {
    for (key, value) in tree {
        let path = joined(path, key);
        // Writing to a string cannot fail.
        match value {
            Value::Object(map) if !map.is_empty() => {
                let _ = writeln!(text, "{:indent$}{key}:", "");
                block(text, map, &path, indent + 2, comment);
            }
            Value::Null => {}
            value => {
                let said: String =
                    comment(&path).chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
                let said = if said.is_empty() { said } else { format!("  # {said}") };
                let _ = writeln!(text, "{:indent$}{key}: {}{said}", "", inline(value));
            }
        }
    }
}

fn inline(value: &Value) -> String {
    match value {
        Value::Array(list) => {
            format!("[{}]", list.iter().map(inline).collect::<Vec<_>>().join(", "))
        }
        Value::Number(found) if found.is_f64() => number(found.as_f64().unwrap_or_default()),
        // The names of models and techniques are plain words; anything else is quoted as in JSON,
        // which YAML reads.
        Value::String(word)
            if !word.is_empty()
                && word.chars().all(|c| c.is_ascii_alphanumeric() || "_-".contains(c)) =>
        {
            word.clone()
        }
        other => other.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn every_value_has_its_comment_and_reads_back() {
        let tree = json!({
            "/node": { "ros__parameters": {
                "a": { "b": 2.0, "list": [1.0, 1e-7], "none": null },
                "count": 3, "name": "some_model", "odd": "a: #b",
            } },
        });
        let text = render(tree.as_object().unwrap(), &|path| format!("from {path}\nx"));
        assert!(text.contains("      b: 2.0  # from /node.ros__parameters.a.b x\n"), "{text}");
        assert!(text.contains("list: [1.0, 1.0e-7]  # from"), "{text}");
        let back: Value = serde_saphyr::from_str(&text).unwrap();
        assert_eq!(back["/node"]["ros__parameters"]["odd"], "a: #b");
        assert_eq!(back["/node"]["ros__parameters"]["a"]["list"][1], 1e-7);
        assert_eq!(back["/node"]["ros__parameters"]["count"], 3);
        assert_eq!(leaves(tree.as_object().unwrap()).len(), 5);
    }

    #[test]
    fn numbers_always_have_a_point() {
        for (value, text) in
            [(20.0, "20.0"), (0.0403, "0.0403"), (1e-7, "1.0e-7"), (1.5e-7, "1.5e-7"), (0.0, "0.0")]
        {
            assert_eq!(number(value), text);
            assert_eq!(text.parse::<f64>(), Ok(value));
        }
    }
}
