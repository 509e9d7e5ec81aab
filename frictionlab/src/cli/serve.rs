//! `frictionlab serve`: experiments and identification for whoever asks over ROS 2.

use std::path::{Path, PathBuf};
use std::sync::LazyLock;
use std::time::Duration;

use anyhow::Context;
use clap::ValueHint;
use ros_node::parameters::{Declared, Parameters};
use ros_node::{Arguments, Discovery, Lost, Participant, Stop, Watch};

use experiment_runner::asked::rig::{Chosen, RigParser, choose};
use experiment_runner::server::desk::UsualRig;
use experiment_runner::server::node::Runner;
use experiment_runner::server::parameters::RunnerParameters;
use rig_setup::RigChoice;

use crate::viewing::{Heard, NodesView, Shelf, Shown, ViewArgs, refused};

/// Run experiments for whoever asks over ROS 2
///
/// Offers the action /experiment_runner/run_experiment and the services start_experiment,
/// list_experiments, identify and abort beside it, and says on /experiment_status what goes on.
/// Experiments are those of `frictionlab run`, with its options, and leave the same folder; beside
/// them there is `commission`, with the options of that command. One runs at a time. Requests use no other rigs than those given here, read files only in the folder
/// of runs and in --inputs, and write only in the folder of runs. ROS_DOMAIN_ID is honoured; only
/// this machine sees it unless ROS_AUTOMATIC_DISCOVERY_RANGE=SUBNET. Ctrl-C ends what runs, keeps
/// its bag, and leaves.
///
/// The executable `experiment_runner` is the same with the arguments of ROS.
#[derive(Debug, clap::Args)]
pub struct ServeArgs {
    /// The folder of runs.
    #[arg(long, value_name = "DIR", value_hint = ValueHint::DirPath,
        default_value = USUAL.runs.as_str(), help = meaning("runs"))]
    pub runs: String,
    /// The usual rig.
    #[arg(long, value_name = "RIG", value_parser = RigParser, hide_possible_values = true, help = format!(
        "{} [default: the rig of --rig-file, else simulated]",
        meaning("rig")
    ))]
    pub rig: Option<RigChoice>,
    /// Rig profile: address, calibration, limits and drive in one file; it counts for every
    /// experiment on its rig
    /// [default: rig.yaml of this folder, where --rig names the rig that it is of]
    #[arg(long, value_name = "FILE")]
    pub rig_file: Option<PathBuf>,
    /// The rigs that are allowed.
    #[arg(long, value_name = "RIGS", value_delimiter = ',',
        default_value = USUAL.allow_rigs.as_str(), help = meaning("allow_rigs"))]
    pub allow_rigs: Vec<RigChoice>,
    /// One more folder.
    #[arg(long, value_name = "DIR", value_hint = ValueHint::DirPath,
        default_value = USUAL.inputs.as_str(), hide_default_value = true, help = meaning("inputs"))]
    pub inputs: String,
    /// The view.
    #[command(flatten)]
    pub view: ViewArgs,
    /// Print nothing but errors
    #[arg(long)]
    pub quiet: bool,
}

/// The parameters of the node, from which the options come.
pub(super) static USUAL: LazyLock<RunnerParameters> = LazyLock::new(RunnerParameters::default);

/// What a parameter of the runner is.
pub(super) fn meaning(name: &str) -> String {
    meaning_of(&*USUAL, name)
}

/// What a parameter of a node is, as the help of an option says it.
pub(super) fn meaning_of(parameters: &impl Declared, name: &str) -> String {
    let declared = parameters.declarations();
    let found = declared.iter().find(|one| one.name() == name);
    found.map(|one| one.description().to_owned()).unwrap_or_default()
}

impl ServeArgs {
    /// The parameters of a node that does the same on `rig`.
    fn parameters(&self, rig: &RigChoice) -> RunnerParameters {
        let rigs: Vec<String> = self.allow_rigs.iter().map(ToString::to_string).collect();
        RunnerParameters {
            runs: self.runs.clone(),
            inputs: self.inputs.clone(),
            allow_rigs: rigs.join(","),
            rig: rig.to_string(),
            ..RunnerParameters::default()
        }
    }
}

/// Runs it until ctrl-C.
///
/// # Errors
/// [`RosNodeError`](ros_node::RosNodeError) for an environment variable that is none of ROS's, or security that is asked for
/// and cannot be had; an error if the network cannot be joined.
pub fn execute(args: &ServeArgs) -> anyhow::Result<()> {
    ros_node::ends_within(ros_node::ENDS_WITHIN_WRITING);
    ros_node::terminal::tell_panics();
    let stop = Stop::on_signals().context("cannot watch for ctrl-C")?;
    let discovery = Discovery::from_environment()?;
    if !args.quiet {
        super::offer_recovery(Path::new(&args.runs));
    }
    let chosen = choose(args.rig.as_ref(), args.rig_file.as_deref())?;
    if let Some(note) = chosen.note.as_ref().filter(|_| !args.quiet) {
        work::saying::print(&format!("{note}\n"))?;
    }
    while let Some(lost) = serve(args, &chosen, &discovery, &stop)? {
        work::saying::print(&format!("{lost}; experiment_runner starts anew\n"))?;
    }
    Ok(())
}

/// Joins, and answers until the wish to end or until the middleware is lost; how it was lost.
fn serve(
    args: &ServeArgs,
    chosen: &Chosen,
    discovery: &Discovery,
    stop: &Stop,
) -> anyhow::Result<Option<Lost>> {
    let arguments = Arguments::default().or_enclave("/experiment_runner");
    let participant = Participant::join_with(discovery, arguments)?;
    let node = participant.node("experiment_runner")?;
    Parameters::usual(&node)?;
    let usual = UsualRig::default();
    usual.set(chosen.rig.clone());
    let axis = &node.identity().namespace;
    let permissions = args.parameters(&chosen.rig).permissions(axis)?.offering(super::ERRANDS);
    let profile = chosen.profile.as_ref().filter(|_| chosen.of_real().is_some());
    let permissions =
        permissions.with_profile(profile.map(|(file, _)| (chosen.rig.clone(), file.clone())));
    let runner = Runner::new(&node, permissions, usual)?;
    let view = args.view.options("serve").map(|options| {
        let discovery = *discovery;
        let join = move || {
            Participant::join_with(
                &discovery,
                Arguments::default().or_enclave("/experiment_runner"),
            )
        };
        let shown = Shown { heard: Heard::Network, experiments: true, reference: false };
        let shelf = Shelf::new(args.view.runs(&args.runs));
        NodesView::open(&options, &participant, (shown, shelf), Box::new(join))
    });
    let view = view.transpose().map_err(refused)?;
    let middleware = Watch::start(stop).context("no thread can be started")?;
    if !args.quiet {
        work::saying::print(&format!(
            "experiment_runner is ready on domain {}; experiments run on the rig `{}` unless their request names another; runs go to {}; ctrl-C ends it\n",
            discovery.domain, chosen.rig, args.runs
        ))?;
    }
    if let Some(view) = &view {
        eprintln!("{}", view.words());
    }
    while !middleware.stop().wait(Duration::from_secs(1)) {}
    let lost = middleware.end().filter(|_| !stop.is_set());
    // In this order: the experiment ends and its result is sent, then the node leaves, then the
    // participant.
    drop(runner);
    drop(view);
    drop(node);
    drop(participant);
    Ok(lost)
}

#[cfg(test)]
mod tests {
    use clap::{Args, Command};

    use super::*;

    #[test]
    fn the_options_are_the_parameters_of_the_node() {
        let command = ServeArgs::augment_args(Command::new("serve"));
        for one in USUAL.declarations() {
            let said = command.get_arguments().find(|arg| {
                arg.get_long().is_some_and(|long| long.replace('-', "_") == one.name())
            });
            match said {
                Some(arg) => {
                    let help = arg.get_help().unwrap().to_string();
                    assert!(help.contains(one.description()), "{help}");
                }
                None => assert_eq!(one.name(), "autostart"),
            }
        }
    }
}
