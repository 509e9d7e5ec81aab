//! Which rig an experiment uses: one that is opened here, or that of running nodes.

use std::fmt;
use std::str::FromStr;

use rig_driver::registry::{AddressError, Opened, RigAddress, RigRegistry, RigSetup};
use serde::{Serialize, Serializer};

use super::RigSetupError;

/// A rig as it is named on the command line.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum RigChoice {
    /// The simulated test bed.
    #[default]
    Simulated,
    /// Any other rig that is opened here.
    Opened(RigAddress),
    /// Whatever rig the running ROS 2 nodes drive, with their observer and controller.
    Nodes {
        /// Namespace of the axis, as in `/axis_1`; none for that of whoever asks.
        namespace: Option<String>,
    },
}

impl FromStr for RigChoice {
    type Err = AddressError;

    fn from_str(text: &str) -> Result<Self, AddressError> {
        let refused = |why: &str| AddressError {
            text: text.to_owned(),
            why: why.to_owned(),
            expected: Self::grammar(),
        };
        match text.strip_prefix("nodes").map(|axis| axis.strip_prefix(':').ok_or(axis)) {
            Some(Err("")) => return Ok(Self::Nodes { namespace: None }),
            Some(Ok(axis)) if !axis.trim_matches('/').is_empty() => {
                return Ok(Self::Nodes { namespace: Some(format!("/{}", axis.trim_matches('/'))) });
            }
            Some(Ok(_)) => {
                return Err(refused("the namespace of an axis is missing, as in nodes:/axis_1"));
            }
            _ => {}
        }
        let address: RigAddress =
            text.parse().map_err(|error: AddressError| refused(&error.why))?;
        let simulated = address == RigAddress::simulated();
        Ok(if simulated { Self::Simulated } else { Self::Opened(address) })
    }
}

impl fmt::Display for RigChoice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Simulated => RigAddress::simulated().fmt(f),
            Self::Opened(address) => address.fmt(f),
            Self::Nodes { namespace: None } => f.write_str("nodes"),
            Self::Nodes { namespace: Some(axis) } => write!(f, "nodes:{axis}"),
        }
    }
}

impl Serialize for RigChoice {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        to.collect_str(self)
    }
}

impl RigChoice {
    /// What may be chosen, in a few words.
    #[must_use]
    pub fn grammar() -> String {
        format!(
            "{}; or nodes[:NAMESPACE] for the rig of running ROS 2 nodes",
            RigRegistry::installed().grammar()
        )
    }

    /// Whether it is another rig than the simulated test bed, opened here.
    #[must_use]
    pub const fn is_opened(&self) -> bool {
        matches!(self, Self::Opened(_))
    }

    /// Whether nobody can be hurt: it is simulated here.
    #[must_use]
    pub fn is_simulated(&self) -> bool {
        match self {
            Self::Simulated => true,
            Self::Opened(address) => address.is_simulated(),
            Self::Nodes { .. } => false,
        }
    }

    /// Whether an explicit sequence may open it anew by itself after its line failed.
    #[must_use]
    pub fn comes_back(&self) -> bool {
        matches!(self, Self::Opened(address) if address.comes_back())
    }

    /// Opens the rig with the motor at zero volts.
    ///
    /// # Errors
    /// [`RigSetupError`] says what is missing or refused.
    pub fn open(&self, setup: &RigSetup) -> Result<Opened, RigSetupError> {
        match self {
            Self::Opened(address) => Ok(address.open(setup)?),
            Self::Simulated => Ok(RigAddress::simulated().open(setup)?),
            Self::Nodes { .. } => Err(RigSetupError::NotDriven("the rig of the running nodes is driven by these; here a rig of one's own is needed, as in serial:/dev/ttyACM0".to_owned())),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rigs_are_read_by_name_and_written_back_the_same() {
        for text in ["simulated", "nodes", "nodes:/axis_1", "quanser:0", "serial:/dev/ttyACM0"] {
            assert_eq!(text.parse::<RigChoice>().unwrap().to_string(), text);
        }
        assert_eq!("nodes:axis_1/".parse::<RigChoice>().unwrap().to_string(), "nodes:/axis_1");
        assert_eq!("simulated".parse::<RigChoice>().unwrap(), RigChoice::Simulated);
        let said = |text: &str| text.parse::<RigChoice>().unwrap_err().to_string();
        assert!(said("nodes:").contains("nodes:/axis_1"));
        for wrong in ["", "serial", "simulated:1", "nodes_of_mine", "usb"] {
            let said = said(wrong);
            assert!(said.contains("serial:/dev/ttyACM0") && said.contains("nodes"), "{said}");
        }
    }
}
