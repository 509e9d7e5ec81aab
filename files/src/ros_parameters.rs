//! What ROS 2 parameter files say of single nodes, for programs that are none.

use std::collections::BTreeMap;

use parameters::ParameterValue;
use parameters::file::{FileError, Parameters};
use serde_json::{Map, Value};

/// Values by dotted names as a tree of maps.
#[must_use]
pub fn tree(values: &BTreeMap<String, ParameterValue>) -> Map<String, Value> {
    let mut tree = Map::new();
    for (name, value) in values {
        let (path, key) = name.rsplit_once('.').unwrap_or(("", name));
        let mut place = &mut tree;
        for part in path.split('.').filter(|part| !part.is_empty()) {
            let inner = place.entry(part).or_insert_with(|| Map::new().into());
            if !inner.is_object() {
                *inner = Map::new().into();
            }
            let Value::Object(inner) = inner else { return tree };
            place = inner;
        }
        // What is no number in JSON is null; whoever reads it says so.
        place.insert(key.to_owned(), serde_json::to_value(value).unwrap_or_default());
    }
    tree
}

/// The file, if the text is a ROS 2 parameter file and not another kind of YAML.
///
/// # Errors
/// [`FileError`] if it is one with a mistake.
pub fn file(text: &str) -> Result<Option<Parameters>, FileError> {
    match Parameters::parse(text) {
        Ok(file) if file.nodes().is_empty() => Ok(None),
        Ok(file) => Ok(Some(file)),
        Err(error) if text.contains("ros__parameters") => Err(error),
        Err(_) => Ok(None),
    }
}
