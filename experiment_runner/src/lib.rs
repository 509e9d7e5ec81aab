//! Experiments, their recorder, figures and report, and the `frictionlab` command built on them.

pub mod bag;
pub mod cli;
pub mod constant_velocity;
pub mod control_loop;
pub mod cycle;
pub mod features;
pub mod identify;
#[cfg(feature = "ros")]
pub mod live;
pub mod messages;
pub mod models;
pub mod output;
pub mod progress;
pub mod protocol;
pub mod recording;
pub mod report;
pub mod run;
pub mod sequencer;
pub mod servo;
pub mod simulate;
pub mod stiction;
pub mod test_bed;
pub mod tracking;
pub mod waveform;
