//! Experiments and identification on request: what the node `experiment_runner` does, whoever asks.
//!
//! [`request`] turns a request into the options that `frictionlab run` and `frictionlab identify`
//! would have, so that both ways know the same experiments, options, ranges and complaints;
//! [`listing`] tells which there are. [`desk`] runs one experiment at a time, and [`outcome`] words
//! what came of it. [`permissions`] says which rigs and files a request may use. [`identification`]
//! identifies models from a bag. [`node`] ties all of it to ROS 2.

pub mod desk;
pub mod ended;
pub mod identification;
pub mod listing;
#[cfg(feature = "ros")]
pub mod node;
pub mod outcome;
pub mod parameters;
pub mod permissions;
#[cfg(feature = "ros")]
mod program;
pub mod request;

#[cfg(feature = "ros")]
pub use program::program;

/// A request that is not carried out; the text says why and how to mend it.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Refusal {
    /// It cannot be carried out as it stands.
    #[error("{0}")]
    BadRequest(String),
    /// Another experiment runs.
    #[error(
        "{run_id} runs ({percent} % done): wait for its end, call the service abort, or set `preempt` to end it and run this one"
    )]
    Busy {
        /// Name of that run.
        run_id: String,
        /// How much of it is done [%].
        percent: u8,
    },
    /// The node is managed, and not active.
    #[error(
        "the experiment runner is not active: `ros2 lifecycle set /experiment_runner configure` and `activate` make it so"
    )]
    Inactive,
    /// The node is leaving.
    #[error("the experiment runner is shutting down: start it again and ask then")]
    Leaving,
}
