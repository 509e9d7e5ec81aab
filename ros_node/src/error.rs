//! What can go wrong between a node and the network.

use crate::environment::EnvironmentError;
use crate::security::SecurityError;

/// A node that cannot join, or a message that cannot be sent.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RosNodeError {
    /// An environment variable of ROS has a value that is none of its own.
    #[error(transparent)]
    Environment(#[from] EnvironmentError),
    /// A name that is none.
    #[error("`{name}` is no name of {what}; expected {expected}")]
    Name {
        /// What was to be named.
        what: &'static str,
        /// What came.
        name: String,
        /// What it may be.
        expected: &'static str,
    },
    /// A parameter that is given when the program starts cannot be.
    #[error("the parameter {name} of {node} cannot be {value}: {reason}")]
    Parameter {
        /// Absolute name of the node.
        node: String,
        /// The parameter.
        name: String,
        /// What was given.
        value: String,
        /// Why not, and how to mend it.
        reason: String,
    },
    /// The parameters that are given when the program starts do not go together.
    #[error("the parameters of {node} cannot be: {reason}")]
    Parameters {
        /// Absolute name of the node.
        node: String,
        /// Why not, and how to mend it.
        reason: String,
    },
    /// Security is asked for and cannot be had.
    #[error("security is asked for (ROS_SECURITY_ENABLE=true), but {0}")]
    Security(#[from] SecurityError),
    /// Signals cannot be watched.
    #[error("SIGINT and SIGTERM cannot be watched: {0}")]
    Signals(String),
    /// The runtime for the nodes' background work does not start.
    #[error(
        "the threads for ROS 2 cannot be started: {0}; the system may be out of threads or memory"
    )]
    Runtime(std::io::Error),
    /// Packets of other machines cannot be kept out.
    #[error(
        "ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST cannot be kept: {0}, so that any machine on the network could command this one; let the \
         program filter its sockets (Linux with /proc, and setsockopt SO_ATTACH_FILTER and SCM_RIGHTS not forbidden by the container's seccomp \
         profile), or set ROS_AUTOMATIC_DISCOVERY_RANGE=SUBNET if everybody on the network may command this machine"
    )]
    Scope(String),
    /// The participant cannot join the network.
    #[error(
        "cannot join ROS domain {domain}: {detail}; check that the network interface is up, or use another ROS_DOMAIN_ID"
    )]
    Join {
        /// The domain.
        domain: u16,
        /// What the middleware said.
        detail: String,
    },
    /// A node, topic or publisher is refused.
    #[error("cannot make {what}: {detail}; {}", how_to_make(detail))]
    Create {
        /// What was to be made.
        what: String,
        /// What the middleware said.
        detail: String,
    },
    /// A service did not answer.
    #[error("{service} gave no answer: {detail}; does its node run on this domain?")]
    NoAnswer {
        /// The service.
        service: String,
        /// What happened instead.
        detail: String,
    },
    /// Another node said no.
    #[error("{node} refused {what}: {reason}")]
    Refused {
        /// The node.
        node: String,
        /// What was asked of it.
        what: &'static str,
        /// What it said.
        reason: String,
    },
    /// A message was not taken.
    #[error(
        "a message on {topic} was not sent: {detail}; a reliable subscriber may be slower than the publisher"
    )]
    Publish {
        /// The topic.
        topic: String,
        /// What the middleware said.
        detail: String,
    },
}

fn how_to_make(refusal: &str) -> &'static str {
    if refusal.contains("not allowed by security") {
        "the permissions of this process's enclave do not name it"
    } else {
        "names of ROS 2 are letters, digits and underscores, with slashes between"
    }
}

impl RosNodeError {
    /// Whether the user can mend it: an argument, a parameter, an environment variable.
    #[must_use]
    pub const fn is_bad_input(&self) -> bool {
        match self {
            Self::Environment(_)
            | Self::Name { .. }
            | Self::Parameter { .. }
            | Self::Parameters { .. }
            | Self::Security(_) => true,
            Self::Signals(_)
            | Self::Runtime(_)
            | Self::Scope(_)
            | Self::Join { .. }
            | Self::Create { .. }
            | Self::NoAnswer { .. }
            | Self::Refused { .. }
            | Self::Publish { .. } => false,
        }
    }
}
