//! Experiments, their protocols, the loop that carries them out, and the node that runs them on
//! request.

pub mod asked;
pub mod characterise;
pub mod compensation;
pub mod constant_velocity;
pub mod control_loop;
pub mod cycle;
pub mod errand;
mod exact;
pub mod experiments;
pub mod messages;
pub mod models;
#[cfg(feature = "ros")]
pub mod nodes;
pub mod paced;
pub mod profile;
pub mod protocol;
pub mod run;
pub mod server;
pub mod test_bed;
pub mod tracking;
pub mod waveform;
