//! Which domain and which networks, from the environment as ROS reads it.

use std::{env, net::IpAddr};

use crate::{EnvironmentError, RosNodeError};

/// Highest domain whose ports exist.
const LAST_DOMAIN: u16 = 232;

/// Where other participants are looked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Range {
    /// On this machine only: the laboratory's default, so that nobody's rig moves by accident.
    #[default]
    Localhost,
    /// On every network the machine is part of, as far as multicast reaches.
    Subnet,
}

/// How a participant finds others.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Discovery {
    /// ROS domain, 0 to 232.
    pub domain: u16,
    /// Where to look.
    pub range: Range,
}

impl Discovery {
    /// Reads `ROS_DOMAIN_ID` (default 0) and `ROS_AUTOMATIC_DISCOVERY_RANGE`. The latter may be
    /// `LOCALHOST`, `SUBNET` or `SYSTEM_DEFAULT`; unset, it means `LOCALHOST` here, where ROS
    /// itself would take `SUBNET`.
    ///
    /// # Errors
    /// [`RosNodeError::Environment`] names the variable and what it may be.
    pub fn from_environment() -> Result<Self, RosNodeError> {
        let read = |name| env::var_os(name).map(|value| value.to_string_lossy().into_owned());
        Self::from_values(
            read("ROS_DOMAIN_ID").as_deref(),
            read("ROS_AUTOMATIC_DISCOVERY_RANGE").as_deref(),
        )
    }

    /// What the environment asks for and cannot be had, in sentences.
    #[must_use]
    pub fn warnings() -> Vec<String> {
        let set = |name: &str| env::var(name).is_ok_and(|value| !value.is_empty());
        let mut warnings = Vec::new();
        if set("ROS_STATIC_PEERS") {
            warnings.push(
                "ROS_STATIC_PEERS is set, but this middleware finds others by multicast only: name this machine among the peers of \
                 the others, or use ROS_AUTOMATIC_DISCOVERY_RANGE=SUBNET where multicast reaches them"
                    .to_owned(),
            );
        }
        warnings
    }

    /// Like [`from_environment`](Self::from_environment), from values that stand for the two
    /// variables.
    ///
    /// # Errors
    /// [`RosNodeError::Environment`].
    pub fn from_values(domain: Option<&str>, range: Option<&str>) -> Result<Self, RosNodeError> {
        let domain = match domain.map(str::trim) {
            None | Some("") => 0,
            Some(text) => text.parse().ok().filter(|id| *id <= LAST_DOMAIN).ok_or_else(|| {
                RosNodeError::Environment(EnvironmentError {
                    name: "ROS_DOMAIN_ID",
                    expected: "a whole number from 0 to 232",
                    value: text.to_owned(),
                })
            })?,
        };
        let range = match range.map(str::trim) {
            None | Some("" | "LOCALHOST") => Range::Localhost,
            Some("SUBNET" | "SYSTEM_DEFAULT") => Range::Subnet,
            Some(text) => {
                return Err(RosNodeError::Environment(EnvironmentError {
                    name: "ROS_AUTOMATIC_DISCOVERY_RANGE",
                    expected: "LOCALHOST, SUBNET or SYSTEM_DEFAULT (OFF cannot be had: use a domain of your own)",
                    value: text.to_owned(),
                }));
            }
        };
        Ok(Self { domain, range })
    }

    /// Addresses the participant is bound to; `None` for all of them.
    pub(crate) fn networks(&self) -> Option<Vec<IpAddr>> {
        match self.range {
            Range::Localhost => Some(vec![IpAddr::V4(std::net::Ipv4Addr::LOCALHOST)]),
            Range::Subnet => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_said_means_this_machine_and_domain_zero() {
        let expected = Discovery { domain: 0, range: Range::Localhost };
        assert_eq!(Discovery::from_values(None, None).unwrap(), expected);
        assert_eq!(Discovery::from_values(Some(""), Some("")).unwrap(), expected);
    }

    #[test]
    fn values_are_those_of_ros() {
        let discovery = Discovery::from_values(Some("42"), Some("SUBNET")).unwrap();
        assert_eq!(discovery, Discovery { domain: 42, range: Range::Subnet });
        assert_eq!(discovery.networks(), None);
        let discovery = Discovery::from_values(Some("232"), Some("LOCALHOST")).unwrap();
        assert_eq!(discovery.domain, 232);
        assert_eq!(discovery.networks().unwrap(), [IpAddr::from([127, 0, 0, 1])]);
    }

    #[test]
    fn other_values_are_refused_with_the_variable_named() {
        for domain in ["233", "-1", "1.5", "lab"] {
            let error = Discovery::from_values(Some(domain), None).unwrap_err().to_string();
            assert!(error.contains("ROS_DOMAIN_ID") && error.contains(domain), "{error}");
        }
        for range in ["OFF", "localhost", "everywhere"] {
            let error = Discovery::from_values(None, Some(range)).unwrap_err().to_string();
            assert!(
                error.contains("ROS_AUTOMATIC_DISCOVERY_RANGE") && error.contains(range),
                "{error}"
            );
        }
    }
}
