//! `frictionlab commission`: from an unknown motor to a compensated one.

use std::io::{BufRead, IsTerminal};

use commission::hand_over::{believed, summary};
use commission::run::clear;
use commission::trial::Trial;
use experiment_runner::asked::rig::choose;
use experiment_runner::protocol::ConstantVelocityProtocol;
use rig_setup::RigChoice;
use work::BadInput;
use work::progress::Progress;

pub use super::commission_args::CommissionArgs;
use super::commission_planned::{asked, checked, ended, planned};
use super::commission_words::worded;
use crate::interruption;
use crate::viewing::ViewArgs;

/// The options of a commission, and of its view.
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
/// [`BadInput`] for what the user can mend, [`Interrupted`](work::Interrupted) after ctrl-C.
pub fn execute(command: &CommissionCommand) -> anyhow::Result<()> {
    let CommissionCommand { view, commission: args } = command;
    checked(args)?;
    if let Some(machines) = args.trial {
        let (seed, wanted) = (args.seed, args.want.clone());
        let protocol = args.protocols.then(ConstantVelocityProtocol::default);
        let trial = Trial { machines, seed, wanted, allowed: 60.0 * args.minutes, protocol };
        return super::commission_trial::execute(&trial, &args.to, args.quiet, args.saying);
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
    let (known, identity) = planned.look()?;
    if !args.quiet {
        let travel = planned.asked.travel;
        eprint!("{}", believed(&identity.rig, &known, travel, args.minutes));
    }
    if !planned.asked.rig.is_simulated() && !args.yes {
        consent()?;
    }
    let asked = planned.asked.clone();
    let dossier = planned.begin(&identity, || Ok(args.to.reserve("commission")?.into_path()))?;
    args.saying.begin();
    let progress = Progress::in_words(asked.allowed, args.quiet);
    let view = view.of_bags("commission", "commission", &stop, &progress, args.quiet)?;
    let outcome = commission::run(&asked, &known, &dossier, &stop, &progress);
    progress.finish();
    drop(view);
    let outcome = outcome.map_err(|error| ended(error, &dossier))?;
    let text = format!(
        "{}report          {}\nparameters      {}\n",
        summary(&outcome.found, &asked.wanted),
        dossier.folder().join("report.html").display(),
        dossier.folder().join("parameters.yaml").display()
    );
    args.saying.result(args.quiet, &outcome.document, &text)
}

/// Asks whoever sits there.
fn consent() -> anyhow::Result<()> {
    let input = std::io::stdin();
    if !input.is_terminal() {
        return Err(BadInput(
            "nobody is there to say that the shaft may turn: --yes says it".to_owned(),
        )
        .into());
    }
    eprint!("May the shaft turn? Type yes: ");
    let mut answer = String::new();
    input.lock().read_line(&mut answer)?;
    if answer.trim() == "yes" {
        return Ok(());
    }
    Err(BadInput("nothing has moved: the answer was not yes".to_owned()).into())
}
