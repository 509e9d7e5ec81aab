//! The `frictionlab` command, one file a subcommand.

mod advice;
pub mod bag;
pub mod commission;
mod commission_args;
mod commission_consent;
mod commission_errand;
mod commission_planned;
mod commission_protocols;
mod commission_trial;
mod commission_words;
pub mod compare;
pub mod completions;
pub mod design;
#[cfg(feature = "ros")]
pub mod doctor;
pub mod export;
mod failure;
pub mod features;
pub mod help;
pub(crate) mod hold_out;
pub mod identify;
pub mod identify_drive;
pub mod identify_joints;
pub mod identify_servo;
pub mod identify_stiction;
mod in_parts;
#[cfg(feature = "ros")]
pub mod launch;
#[cfg(feature = "ros")]
pub mod live;
pub mod look;
pub mod manual;
pub mod models;
pub mod monte_carlo;
#[cfg(feature = "ros")]
pub mod node;
pub mod protocols;
pub mod report;
mod resume;
pub mod rig;
pub mod run;
pub mod runs;
pub mod samples;
#[cfg(feature = "ros")]
pub mod security;
#[cfg(feature = "ros")]
pub mod serve;
pub mod simulate;
pub mod truth_matrix;
pub mod view;

use experiment_runner::errand::Errands;
pub use failure::{exit_code, told};

/// What the runner offers beside experiments.
pub const ERRANDS: Errands = Errands(&[&commission_errand::Commission]);

/// Tells which bags of earlier runs in `runs` were cut off, and how to save them.
fn offer_recovery(runs: &std::path::Path) {
    for bag in recording::bag::cut_bags(runs) {
        if let Some(run) = bag.parent().filter(|run| experiment_runner::run::Journal::is_in(run)) {
            eprintln!(
                "the run in {} was cut off by a kill or a crash: `frictionlab run --resume {}` goes on with it",
                run.display(),
                run.display()
            );
            continue;
        }
        eprintln!(
            "{} was cut off by a kill or a crash: `frictionlab bag recover {}` saves what it holds",
            bag.display(),
            bag.display()
        );
    }
}
