//! `frictionlab run`: experiments on the test bed.

use std::path::Path;

use experiment_runner::asked::rig::choose;
use experiment_runner::asked::{RunArgs, given, options};
use experiment_runner::run::{self, Beginning, Journal, Outcome, RunError, RunOptions, Status};
use experiment_runner::test_bed::TestBedError;
use rig_driver::RigError;
use rig_setup::{RigChoice, RigSetupError};
use work::destination::RUNS;
use work::progress::{Progress, about};
use work::saying::document;
use work::{BadInput, Interrupted};

use crate::interruption;
use crate::viewing::ViewArgs;

// What it does is said by its options.
#[expect(missing_docs, reason = "a doc comment here would take the place of the command's help")]
#[derive(Debug, clap::Args)]
pub struct RunCommand {
    /// The view.
    #[command(flatten)]
    pub view: ViewArgs,
    /// The runs.
    #[command(flatten)]
    pub run: RunArgs,
}

/// Runs it.
///
/// # Errors
/// [`BadInput`] for what the user can mend, [`Interrupted`] after ctrl-C.
pub fn execute(command: &RunCommand) -> anyhow::Result<()> {
    let RunCommand { view, run: args } = command;
    if let Some(folder) = &args.resume {
        let (folder, given, journal) = super::resume::open(args, folder)?;
        let options = options(&given, &thesis::BESIDE)?;
        journal.require_asked(&options).map_err(worded)?;
        run::check_options(&options).map_err(worded)?;
        return run_in((&given, view), &options, &folder, Beginning::Resumed(Box::new(journal)));
    }
    let options = options(args, &thesis::BESIDE)?;
    run::check_options(&options).map_err(worded)?;
    let folder = args.to.reserve(options.experiment.as_str())?;
    let beginning = Beginning::Anew { force: args.to.force, words: super::resume::words() };
    run_in((args, view), &options, folder.path(), beginning)
}

fn run_in(
    (args, view): (&RunArgs, &ViewArgs),
    options: &RunOptions,
    folder: &Path,
    beginning: Beginning,
) -> anyhow::Result<()> {
    let cancel = interruption::watch(interruption::WRITING)?;
    args.saying.begin();
    let paced = options.rig != RigChoice::Simulated || args.real_time;
    if paced && !args.quiet {
        let name = options.experiment.as_str();
        eprintln!(
            "{name}: {} of rig time; ctrl-C keeps what is there",
            about(options.rig_seconds())
        );
    }

    if !args.quiet {
        if matches!(beginning, Beginning::Anew { .. }) {
            super::offer_recovery(Path::new(RUNS));
        }
        // Read once more for what there is to say; it is what was used.
        if let Some(note) = given(&args.parameters)?.note() {
            eprintln!("{note}");
        }
        if let Some(note) = choose(args.rig.as_ref(), args.rig_file.as_deref())?.note {
            eprintln!("{note}");
        }
    }
    let progress = Progress::new(options.rig_seconds(), args.quiet);
    let view =
        view.of_bags("run", (options.experiment.as_str(), folder), &cancel, &progress, args.quiet)?;
    let outcome = run::execute_in(options, folder, beginning, &progress, &cancel);
    progress.finish();
    let told = tell(args, outcome, folder);
    if let Some(view) = view {
        if let Err(error) = &told {
            eprintln!("it ended: {}", super::told(error));
        }
        view.stay(args.quiet);
    }
    told
}

/// Tells what a run came to.
fn tell(args: &RunArgs, outcome: Result<Outcome, RunError>, folder: &Path) -> anyhow::Result<()> {
    let outcome = outcome.map_err(|error| {
        if Journal::is_in(folder) && !matches!(error, RunError::Resume { .. }) {
            eprintln!("what was measured is kept{}", super::resume::hint(folder));
        }
        worded(error)
    })?;
    let document = if args.saying.json { document(&outcome.results)? } else { String::new() };
    args.saying.result(args.quiet, &document, &run::terminal::summary(&outcome))?;
    if let Some(why) = &outcome.results.ended {
        anyhow::bail!(
            "the run ended early: {why}; the bag in {} is whole as far as it goes, and so is the report{}",
            outcome.folder.join("bag").display(),
            super::resume::hint(folder)
        );
    }
    if outcome.results.status == Status::Interrupted {
        return Err(Interrupted(format!(
            "stopped before the end; the bag in {} is whole as far as it goes, and so is the report{}",
            outcome.folder.join("bag").display(),
            super::resume::hint(folder)
        ))
        .into());
    }
    Ok(())
}

/// A run's error, where the command line has other words for it.
fn worded(error: RunError) -> anyhow::Error {
    match error {
        RunError::TestBed(TestBedError::Rig(RigError::OutOfRange { name, value, expected })) => {
            BadInput(named_option(name, value, &expected)).into()
        }
        RunError::TestBed(TestBedError::Rig(RigError::BeyondRange { limit, range }))
        | RunError::Setup(RigSetupError::Rig(RigError::BeyondRange { limit, range })) => {
            BadInput(beyond_range(limit, range)).into()
        }
        RunError::Bag(error) if error.is_bad_input() => {
            BadInput(format!("{error}; --out DIR names another folder")).into()
        }
        error => error.into(),
    }
}

/// A voltage limit that the rig cannot put out, by where it is set.
pub(super) fn beyond_range(limit: f64, range: f64) -> String {
    format!(
        "--voltage-limit (or `limits.voltage` of the rig profile) must be at most {range} V, the voltage range of this rig by its own description, but is {limit} V"
    )
}

/// A parameter of the rig that is out of range, by the option that sets it.
fn named_option(name: &str, value: f64, expected: &str) -> String {
    if name == "voltage_limit" {
        format!("--voltage-limit must be {expected}, but is {value} V")
    } else {
        format!(
            "{name} must be {expected}, but is {value}; the drive's constants come from --drive"
        )
    }
}
