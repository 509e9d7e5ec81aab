//! Experiments, their recorder, figures and report, and the `frictionlab` command built on them.

pub mod bag;
pub mod characterise;
pub mod cli;
mod commented_yaml;
pub mod compensation;
pub mod constant_velocity;
pub mod control_loop;
pub mod cycle;
pub mod design;
#[cfg(feature = "ros")]
pub mod doctor;
pub mod drive;
mod durable;
mod exact;
pub mod features;
pub mod identify;
mod input;
#[cfg(feature = "ros")]
pub mod launch;
#[cfg(feature = "ros")]
pub mod live;
pub mod messages;
pub mod models;
#[cfg(feature = "ros")]
pub mod nodes;
pub mod numbers;
pub mod output;
pub mod paced;
pub mod profile;
pub mod progress;
pub mod protocol;
#[cfg(feature = "ros")]
pub mod record;
pub mod recording;
pub mod report;
pub mod rig;
pub mod run;
#[cfg(feature = "ros")]
pub mod security;
pub mod sequencer;
pub mod server;
pub mod servo;
pub mod simulate;
pub mod stiction;
pub mod test_bed;
pub mod tracking;
pub mod truth_matrix;
pub mod waveform;
