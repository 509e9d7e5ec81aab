//! What ROS 2 parameter files say of single nodes, for programs that are none.

use std::collections::BTreeMap;

use parameters::ParameterValue;
use parameters::file::{FileError, Parameters};
use serde::Serialize;
use serde::de::DeserializeOwned;
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

/// A section that cannot be had of a parameter file.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum SectionError {
    /// No ROS 2 parameter file.
    #[error(transparent)]
    File(#[from] FileError),
    /// It says nothing of the node.
    #[error("there is no node `rig_driver` in it")]
    NoNode,
    /// It says nothing of the section.
    #[error("`rig_driver` has no `{section}` in it")]
    NoSection {
        /// The section.
        section: &'static str,
    },
    /// A value is not what it should be, or a name is not known.
    #[error("in `{section}`: {detail}")]
    Value {
        /// The section.
        section: &'static str,
        /// What is wrong in it.
        detail: String,
    },
    /// A whole number, which a node would not take for a real one.
    #[error("in `{section}`: {name} is a real number: write {whole}.0")]
    Whole {
        /// The section.
        section: &'static str,
        /// The parameter.
        name: String,
        /// What came.
        whole: i64,
    },
}

impl SectionError {
    /// Whether there is nothing of the kind in the file.
    #[must_use]
    pub const fn is_missing(&self) -> bool {
        matches!(self, Self::NoNode | Self::NoSection { .. })
    }
}

/// The parameters of `/rig_driver` that stand under `section`.
///
/// # Errors
/// [`SectionError`] says what is wrong in the text.
pub fn of_rig_driver<T: DeserializeOwned + Serialize>(
    text: &str,
    section: &'static str,
) -> Result<T, SectionError> {
    let file = Parameters::parse(text)?;
    let node = file.of_node("/rig_driver");
    if node.is_empty() {
        return Err(SectionError::NoNode);
    }
    let prefix = format!("{section}.");
    let within: BTreeMap<_, _> = node
        .into_iter()
        .filter_map(|(name, value)| Some((name.strip_prefix(&prefix)?.to_owned(), value)))
        .collect();
    if within.is_empty() {
        return Err(SectionError::NoSection { section });
    }
    let found: T = serde_json::from_value(tree(&within).into())
        .map_err(|error| SectionError::Value { section, detail: error.to_string() })?;
    // A node would not take a whole number for a real one either.
    let written = serde_json::to_value(&found).unwrap_or_default();
    for (name, value) in within {
        if let ParameterValue::Integer(whole) = value
            && written.get(&name).is_some_and(Value::is_f64)
        {
            return Err(SectionError::Whole { section, name, whole });
        }
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use serde::Deserialize;

    use super::*;

    #[derive(Debug, PartialEq, Serialize, Deserialize)]
    #[serde(deny_unknown_fields)]
    struct Gear {
        ratio: f64,
        sign: i8,
    }

    #[test]
    fn a_section_is_read_under_every_name_that_means_the_node() {
        let read = |node: &str, body: &str| {
            of_rig_driver::<Gear>(&format!("{node}:\n  ros__parameters:\n{body}"), "gear")
        };
        let good = "    gear: {ratio: 70.0, sign: -1}\n";
        for node in ["/rig_driver", "rig_driver", "/**/rig_driver", "/**", "/*"] {
            assert_eq!(read(node, good), Ok(Gear { ratio: 70.0, sign: -1 }), "{node}");
        }
        for (node, body, said) in [
            ("/controller", good, "rig_driver"),
            ("/axis_1/rig_driver", good, "rig_driver"),
            ("/rig_driver", "    rig: simulated\n", "gear"),
            ("/rig_driver", "    gear: {ratio: 70, sign: -1}\n", "write 70.0"),
            ("/rig_driver", "    gear: {ratio: 70.0, sine: -1}\n", "sine"),
        ] {
            let error = read(node, body).unwrap_err().to_string();
            assert!(error.contains(said), "{node}: {error}");
        }
    }
}
