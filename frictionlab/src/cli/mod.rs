//! The `frictionlab` command, one file a subcommand.

pub mod bag;
pub mod completions;
pub mod design;
#[cfg(feature = "ros")]
pub mod doctor;
pub mod features;
pub mod help;
pub mod identify;
pub mod identify_drive;
pub mod identify_servo;
pub mod identify_stiction;
#[cfg(feature = "ros")]
pub mod launch;
#[cfg(feature = "ros")]
pub mod live;
pub mod manual;
pub mod models;
pub mod monte_carlo;
#[cfg(feature = "ros")]
pub mod node;
pub mod protocols;
mod resume;
pub mod rig;
pub mod run;
#[cfg(feature = "ros")]
pub mod security;
#[cfg(feature = "ros")]
pub mod serve;
pub mod simulate;
pub mod truth_matrix;

use files::{OutputError, is_full};
use work::{BadInput, Interrupted};

use crate::interruption;

/// The exit code of a program that ended with this error: 1 if it failed at its work, 2 for wrong
/// input, 128 plus its number after a signal.
#[must_use]
pub fn exit_code(error: &anyhow::Error) -> u8 {
    if error.is::<Interrupted>() {
        interruption::exit_code()
    } else if is_full(error.as_ref()) {
        1
    } else if error.is::<BadInput>() || error.is::<OutputError>() {
        2
    } else {
        1
    }
}

/// What a person is told of an error: each cause once, and of a full disk nothing but that it is
/// full.
#[must_use]
pub fn told(error: &anyhow::Error) -> String {
    let mut text = error.to_string();
    if !is_full(error.as_ref()) {
        for cause in error.chain().skip(1).map(ToString::to_string) {
            if !text.contains(&cause) {
                text = format!("{text}: {cause}");
            }
        }
    }
    text
}

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

#[cfg(test)]
mod tests {
    use std::io::{Error, ErrorKind};

    use super::*;
    use recording::bag::BagError;

    #[test]
    fn a_full_disk_is_a_failure_told_once_and_wrong_input_is_not() {
        let full = || Error::from(ErrorKind::StorageFull);
        let bag = BagError::Write { path: "runs/all-1/bag".into(), source: full() };
        let output = OutputError::Write { path: "a.csv".into(), source: full() };
        for error in [anyhow::Error::new(bag), anyhow::Error::new(output)] {
            assert_eq!(exit_code(&error), 1, "{error}");
            assert_eq!(told(&error).matches("no space left").count(), 1, "{}", told(&error));
        }
        let denied =
            OutputError::Write { path: "a.csv".into(), source: ErrorKind::PermissionDenied.into() };
        for error in [anyhow::Error::new(denied), BadInput("no such model".to_owned()).into()] {
            assert_eq!(exit_code(&error), 2, "{error}");
        }
        assert_eq!(exit_code(&anyhow::anyhow!("the rig failed")), 1);
        let wrapped = anyhow::anyhow!("inner").context("outer");
        assert_eq!(told(&wrapped), "outer: inner");
    }
}
