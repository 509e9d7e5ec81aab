//! Where each number of a run's parameters comes from.

use std::collections::BTreeMap;
use std::fmt;

use serde::Serialize;

/// Where a parameter's value comes from.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize)]
#[serde(tag = "from", rename_all = "snake_case")]
pub enum Origin {
    /// The program's own value: the thesis's test bed.
    #[default]
    Default,
    /// A file that was given.
    File {
        /// The file, as it was named.
        file: String,
    },
    /// An option of the command line.
    Option {
        /// Its name.
        option: String,
    },
    /// Identified by this run.
    Identified,
    /// Fitted by this run, but its points do not determine it.
    NotIdentifiable,
    /// Kept in proportion to a parameter that this run identified.
    InProportion {
        /// That parameter.
        to: String,
    },
    /// Fixed while this run identified the others.
    Fixed,
    /// The rig that was driven says so.
    Rig,
    /// Worked out of the drive's constants.
    Drive,
}

impl fmt::Display for Origin {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Default => f.write_str("default"),
            Self::File { file } => write!(f, "from {file}"),
            Self::Option { option } => write!(f, "from {option}"),
            Self::Identified => f.write_str("identified by this run"),
            Self::NotIdentifiable => {
                f.write_str("fitted by this run, but not identifiable from its measurements")
            }
            Self::InProportion { to } => write!(f, "moved in proportion to the identified {to}"),
            Self::Fixed => f.write_str("fixed while this run identified the others"),
            Self::Rig => f.write_str("from the rig that was driven"),
            Self::Drive => f.write_str("worked out of the drive's constants"),
        }
    }
}

/// Where the parameters come from, by their paths without `ros__parameters`, as in
/// `controller.pid.k_p`. What is not in it is a default.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize)]
#[serde(transparent)]
pub struct Origins(BTreeMap<String, Origin>);

impl Origins {
    /// Where the value at `path` comes from; what holds for a group holds for what is in it.
    #[must_use]
    pub fn of(&self, path: &str) -> Origin {
        let mut path = path;
        loop {
            if let Some(origin) = self.0.get(path) {
                return origin.clone();
            }
            let Some((group, _)) = path.rsplit_once('.') else { return Origin::Default };
            path = group;
        }
    }

    /// Says where the value, or the group of values, at `path` comes from.
    pub fn set(&mut self, path: impl Into<String>, origin: Origin) {
        self.0.insert(path.into(), origin);
    }

    /// Forgets what was said of `path` and of all that is in it.
    pub fn clear(&mut self, path: &str) {
        let within = format!("{path}.");
        self.0.retain(|known, _| known != path && !known.starts_with(&within));
    }

    /// Each value with its origin.
    pub fn iter(&self) -> impl Iterator<Item = (&str, &Origin)> {
        self.0.iter().map(|(path, origin)| (path.as_str(), origin))
    }

    /// Whether any value was identified by this run.
    #[must_use]
    pub fn any_identified(&self) -> bool {
        self.0.values().any(|origin| *origin == Origin::Identified)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_group_speaks_for_what_is_in_it() {
        let mut origins = Origins::default();
        let file = Origin::File { file: "drive.yaml".to_owned() };
        origins.set("rig_driver.drive", file.clone());
        origins.set("rig_driver.drive.inertia", Origin::Identified);
        assert_eq!(origins.of("rig_driver.drive.gear_ratio"), file);
        assert_eq!(origins.of("rig_driver.drive.inertia"), Origin::Identified);
        assert_eq!(origins.of("rig_driver.period"), Origin::Default);
        origins.clear("rig_driver.drive");
        assert_eq!(origins, Origins::default());
        let json = serde_json::to_value(file).unwrap();
        assert_eq!(json, serde_json::json!({ "from": "file", "file": "drive.yaml" }));
    }
}
