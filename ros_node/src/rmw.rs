//! What `RMW_IMPLEMENTATION` asks for. The laboratory's middleware is built in, and talks to each
//! of the others in the other's way.

use std::env;

use crate::quoted;

/// The environment variable.
pub const VARIABLE: &str = "RMW_IMPLEMENTATION";
/// The middlewares that were tried.
const UNDERSTOOD: [&str; 3] =
    ["rmw_fastrtps_cpp", "rmw_fastrtps_dynamic_cpp", "rmw_cyclonedds_cpp"];

/// What is said of it, in a sentence.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Said {
    /// It is well so.
    Fine(String),
    /// It is not what somebody expects.
    Warning(String),
}

/// What is to be said of the environment; `None` where it asks for nothing.
pub(crate) fn said() -> Option<Said> {
    of(env::var_os(VARIABLE)?.to_string_lossy().trim())
}

/// What is to be said of a value of the variable; `None` of an empty one.
#[must_use]
pub fn of(value: &str) -> Option<Said> {
    let said = match value {
        "" => return None,
        known if UNDERSTOOD.contains(&known) => Said::Fine(format!(
            "{VARIABLE} is {known}: this program has a middleware of its own, which talks to nodes of Fast DDS and of Cyclone DDS, each in its way"
        )),
        zenoh if zenoh.contains("zenoh") => Said::Warning(format!(
            "{VARIABLE} asks for Zenoh, but this program speaks DDS: nodes over Zenoh do not see it"
        )),
        other => Said::Warning(format!(
            "{VARIABLE} is `{}`, and changes nothing here: expected {}, with whose nodes this program talks",
            quoted(other),
            UNDERSTOOD.join(", ")
        )),
    };
    Some(said)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_understood_is_fine_and_the_rest_gets_a_sentence() {
        assert_eq!(of(""), None);
        for known in UNDERSTOOD {
            assert!(matches!(of(known), Some(Said::Fine(said)) if said.contains(known)));
        }
        assert!(matches!(of("rmw_zenoh_cpp"), Some(Said::Warning(said)) if said.contains("Zenoh")));
        for unknown in ["rmw_cyclone", "fastdds", "RMW_CYCLONEDDS_CPP"] {
            let Some(Said::Warning(said)) = of(unknown) else { panic!("{unknown} passes") };
            assert!(said.contains(unknown) && said.contains("rmw_cyclonedds_cpp"), "{said}");
        }
    }
}
