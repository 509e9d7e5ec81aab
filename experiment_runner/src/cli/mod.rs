//! The `frictionlab` command, one file a subcommand.

pub mod bag;
pub mod design;
pub(crate) mod destination;
#[cfg(feature = "ros")]
pub mod doctor;
mod drive_errors;
pub mod features;
pub mod help;
pub mod identify;
pub mod identify_drive;
pub mod identify_friction;
pub mod identify_servo;
pub mod identify_stiction;
mod interruption;
#[cfg(feature = "ros")]
pub mod launch;
#[cfg(feature = "ros")]
pub mod live;
pub mod models;
pub mod monte_carlo;
#[cfg(feature = "ros")]
pub mod node;
pub mod protocols;
mod resume;
pub mod rig;
pub(crate) mod rig_profile;
pub mod run;
pub mod saying;
#[cfg(feature = "ros")]
pub mod security;
#[cfg(feature = "ros")]
pub mod serve;
pub mod simulate;
pub mod suggestion;
pub mod truth_matrix;

use crate::output::{OutputError, is_full};

/// Something a person gave us that cannot be used: a file, a value, a folder. The text says what
/// was expected and how to mend it; the program ends with exit code 2.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub struct BadInput(pub String);

/// Stopped by the user; the text says what is left. The program ends with 128 plus the number of
/// the signal: 130 after ctrl-C.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub struct Interrupted(pub String);

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

/// A model's name on the command line.
fn model_name(text: &str) -> Result<friction_model::ModelName, String> {
    text.parse().map_err(|error: friction_model::ModelError| {
        let names = friction_model::ModelName::ALL.map(friction_model::ModelName::as_str);
        format!("{error}{}", suggestion::did_you_mean(text, names))
    })
}

/// Tells which bags of earlier runs in `runs` were cut off, and how to save them.
fn offer_recovery(runs: &std::path::Path) {
    for bag in crate::bag::cut_bags(runs) {
        if let Some(run) = bag.parent().filter(|run| crate::run::Journal::is_in(run)) {
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

/// Prints a text. Whoever reads may have seen enough (`| head`): that is no error.
fn print(text: &str) -> anyhow::Result<()> {
    use std::io::Write;
    match std::io::stdout().lock().write_all(text.as_bytes()) {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => {
            Err(anyhow::Error::new(error).context("the text cannot be printed"))
        }
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use std::io::{Error, ErrorKind};

    use super::*;
    use crate::bag::BagError;

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
