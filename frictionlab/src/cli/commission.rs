//! `frictionlab commission`: from an unknown motor to a compensated one.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;

use commission::hand_over::{believed, summary};
use commission::run::clear;
use commission::trial::Trial;
use commission::{Board, Outcome};
use experiment_runner::asked::rig::choose;
use experiment_runner::protocol::ConstantVelocityProtocol;
use rig_setup::RigChoice;
use work::Interrupted;
use work::ending::told;
use work::progress::Progress;

pub use super::commission_args::CommissionArgs;
use super::commission_consent::consent;
use super::commission_planned::{Planned, asked, checked, ended, kept, planned};
use super::commission_words::worded;
use crate::interruption;
use crate::viewing::{CommissionView, ViewArgs};

// What it does is said by its options.
#[expect(missing_docs, reason = "a doc comment here would take the place of the command's help")]
#[derive(Debug, clap::Args)]
pub struct CommissionCommand {
    /// The view.
    #[command(flatten)]
    pub view: ViewArgs,
    /// The commission.
    #[command(flatten)]
    pub commission: CommissionArgs,
}

/// Runs it.
///
/// # Errors
/// [`BadInput`](work::BadInput) for what the user can mend, [`Interrupted`] after ctrl-C.
pub fn execute(command: &CommissionCommand) -> anyhow::Result<()> {
    let CommissionCommand { view, commission: args } = command;
    checked(args)?;
    if let Some(machines) = args.trial {
        let (seed, wanted) = (args.seed, args.want.clone());
        let protocol = args.protocols.then(ConstantVelocityProtocol::default);
        let allowed = 60.0 * args.minutes;
        let cores = || thread::available_parallelism().map_or(1, usize::from);
        let workers = args.jobs.map_or_else(cores, usize::from);
        let trial = Trial { machines, seed, wanted, allowed, protocol, workers };
        return super::commission_trial::execute(&trial, args);
    }
    if args.protocols {
        let asked = asked(args, &choose(Some(&RigChoice::Simulated), None)?)?;
        return super::commission_protocols::execute(&asked, &args.to, args.quiet, args.saying);
    }
    let planned = planned(args)?;
    if let Some(note) = planned.note.as_ref().filter(|_| !args.quiet) {
        eprintln!("{note}");
    }
    let stop = interruption::watch(interruption::DRIVING)?;
    if args.clear {
        clear(&planned.asked).map_err(worded)?;
    }
    let board = Board::default();
    let view = view.of_commission(&board, &stop, args.quiet)?;
    let outcome = commissioned(args, planned, (&stop, &board), view.as_ref());
    if let Some(view) = &view {
        view.ends(outcome.as_ref().map(|_| ()).map_err(told));
    }
    if let Ok((outcome, folder)) = &outcome {
        let text = format!(
            "{}report          {}\nparameters      {}\n",
            summary(&outcome.found, &args.want),
            folder.join("report.html").display(),
            folder.join("parameters.yaml").display()
        );
        args.saying.result(args.quiet, &outcome.document, &text)?;
    }
    if let Some(view) = &view {
        if let Err(error) = &outcome {
            eprintln!("it ended: {}", told(error));
        }
        view.stay(args.quiet);
    }
    outcome.map(drop)
}

/// Looks at the rig, asks, and does the stages; what came of it, and where it is.
fn commissioned(
    args: &CommissionArgs,
    planned: Planned,
    (stop, board): (&Arc<AtomicBool>, &Board),
    view: Option<&CommissionView>,
) -> anyhow::Result<(Outcome, PathBuf)> {
    let (known, identity) = planned.look()?;
    let travel = planned.asked.travel;
    let believed = believed(&identity.rig, &known, travel, args.minutes);
    if !args.quiet {
        eprint!("{believed}");
    }
    if let Some(view) = view {
        view.believes(&believed);
    }
    if !planned.asked.rig.is_simulated() && !args.yes {
        consent(view, stop)?;
    }
    if stop.load(Ordering::SeqCst) {
        return Err(Interrupted("stopped; nothing has moved".to_owned()).into());
    }
    let asked = planned.asked.clone();
    let dossier = planned.begin(&identity, || Ok(args.to.reserve("commission")?.into_path()))?;
    if let Some(view) = view {
        view.begins(dossier.folder());
    }
    args.saying.begin();
    let progress = Progress::in_words(asked.allowed, args.quiet);
    let outcome = commission::run_watched(&asked, &known, &dossier, stop, (&progress, board));
    progress.finish();
    let folder = dossier.folder().to_owned();
    outcome.map(|outcome| (outcome, folder)).map_err(|error| {
        if let Some(view) = view {
            view.hints(kept(&error, &dossier));
        }
        ended(error, &dossier)
    })
}
