//! The `frictionlab` command: from unknown friction to a compensated axis.

use std::process::ExitCode;

use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};
use frictionlab::cli::help::prepared;
use frictionlab::cli::{
    bag, commission, compare, completions, design, exit_code, export, features, identify_drive,
    identify_joints, identify_servo, identify_stiction, look, manual, models, monte_carlo,
    protocols, report, rig, run, runs, samples, simulate, told, truth_matrix, view,
};
use machine_rig::MachineFactory;
use rig_driver::RigRegistry;
use work::Interrupted;
use work::suggestion::with_suggestion;

/// A friction laboratory: characterise, identify and compensate the friction of one servo axis
///
/// Start with `frictionlab run`: it does the whole job on the simulated test bed and leaves a
/// report to open in a browser. `frictionlab identify FILE.csv` does it with your own recording.
#[derive(Debug, Parser)]
#[command(name = "frictionlab", version)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    Run(Box<run::RunCommand>),
    Look(Box<look::LookArgs>),
    // Boxed: its many options would make every other command as large.
    Identify(Box<identification::asked::IdentifyArgs>),
    IdentifyDrive(Box<identify_drive::IdentifyDriveArgs>),
    IdentifyServo(Box<identify_servo::IdentifyServoArgs>),
    IdentifyStiction(Box<identify_stiction::IdentifyStictionArgs>),
    Bag(bag::BagArgs),
    Commission(Box<commission::CommissionCommand>),
    Compare(compare::CompareArgs),
    Completions(completions::CompletionsArgs),
    Design(studies::design::asked::DesignArgs),
    Export(Box<export::ExportArgs>),
    Features(features::FeaturesArgs),
    Manual(manual::ManualArgs),
    Models(models::ModelsArgs),
    MonteCarlo(monte_carlo::MonteCarloArgs),
    Protocols(protocols::ProtocolsArgs),
    Report(report::ReportArgs),
    Rig(Box<rig::RigArgs>),
    Runs(runs::RunsArgs),
    Samples(samples::SamplesArgs),
    Simulate(simulate::SimulateArgs),
    TruthMatrix(truth_matrix::TruthMatrixArgs),
    View(view::BagViewArgs),
    #[cfg(feature = "ros")]
    Doctor(frictionlab::cli::doctor::DoctorArgs),
    #[cfg(feature = "ros")]
    Launch(frictionlab::cli::launch::LaunchArgs),
    #[cfg(feature = "ros")]
    Live(frictionlab::cli::live::LiveArgs),
    #[cfg(feature = "ros")]
    Node(frictionlab::cli::node::NodeArgs),
    #[cfg(feature = "ros")]
    Security(frictionlab::cli::security::SecurityArgs),
    #[cfg(feature = "ros")]
    Serve(frictionlab::cli::serve::ServeArgs),
}

fn main() -> ExitCode {
    // Before any address is read; nobody can have read one yet.
    let _ = RigRegistry::standard().with(MachineFactory).install();
    let mut command = prepared(Cli::command());
    let cli = command
        .try_get_matches_from_mut(std::env::args_os())
        .and_then(|given| Cli::from_arg_matches(&given))
        .unwrap_or_else(|error| with_suggestion(error, &command).exit());
    // A node reads the rest of its command line itself, and has its own way to end.
    #[cfg(feature = "ros")]
    if let Command::Node(args) = cli.command {
        return frictionlab::cli::node::execute(args);
    }
    #[cfg(feature = "ros")]
    if let Err(error) = ros_node::launched::end_with_launcher() {
        eprintln!("error: the end of its launcher cannot be watched for: {error}");
        return ExitCode::FAILURE;
    }
    let result = match cli.command {
        Command::Run(args) => run::execute(&args),
        Command::Look(args) => look::execute(&args),
        Command::Identify(args) => identify_joints::execute(*args),
        Command::IdentifyDrive(args) => identify_drive::execute(&args),
        Command::IdentifyServo(args) => identify_servo::execute(&args),
        Command::IdentifyStiction(args) => identify_stiction::execute(&args),
        Command::Bag(args) => bag::execute(&args),
        Command::Commission(args) => commission::execute(&args),
        Command::Compare(args) => compare::execute(&args),
        Command::Completions(args) => completions::execute(&args, &mut command),
        Command::Design(args) => design::execute(&args),
        Command::Export(args) => export::execute(&args),
        Command::Features(args) => features::execute(&args),
        Command::Manual(args) => manual::execute(&args, &command),
        Command::Models(args) => models::execute(&args),
        Command::MonteCarlo(args) => monte_carlo::execute(&args),
        Command::Protocols(args) => protocols::execute(&args),
        Command::Report(args) => report::execute(&args),
        Command::Rig(args) => rig::execute(&args),
        Command::Runs(args) => runs::execute(&args),
        Command::Samples(args) => samples::execute(&args),
        Command::Simulate(args) => simulate::execute(&args),
        Command::TruthMatrix(args) => truth_matrix::execute(&args),
        Command::View(args) => view::execute(&args),
        #[cfg(feature = "ros")]
        Command::Doctor(args) => frictionlab::cli::doctor::execute(&args),
        #[cfg(feature = "ros")]
        Command::Launch(args) => frictionlab::cli::launch::execute(&args),
        #[cfg(feature = "ros")]
        Command::Live(args) => frictionlab::cli::live::execute(&args),
        #[cfg(feature = "ros")]
        Command::Node(_) => return ExitCode::SUCCESS,
        #[cfg(feature = "ros")]
        Command::Security(args) => frictionlab::cli::security::execute(&args),
        #[cfg(feature = "ros")]
        Command::Serve(args) => frictionlab::cli::serve::execute(&args),
    };
    let Err(error) = result else { return ExitCode::SUCCESS };
    let mark = if error.is::<Interrupted>() { "" } else { "error: " };
    eprintln!("{mark}{}", told(&error));
    ExitCode::from(exit_code(&error))
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;

    /// Every command beneath, with its whole name.
    fn all(command: &clap::Command, before: &str) -> Vec<(String, clap::Command)> {
        let name = format!("{before} {}", command.get_name());
        let beneath = command.get_subcommands().flat_map(|command| all(command, &name));
        [(name.clone(), command.clone())].into_iter().chain(beneath.collect::<Vec<_>>()).collect()
    }

    #[test]
    fn the_help_of_a_command_is_its_own_and_not_that_of_a_group_of_options() {
        for (name, command) in all(&prepared(Cli::command()), "") {
            let about = command.get_about().map(ToString::to_string).unwrap_or_default();
            assert!(!about.is_empty() && !about.contains("ptions of"), "{name}: {about}");
        }
    }

    #[test]
    fn the_help_names_every_command_once_in_a_group_and_on_one_line() {
        let mut command = prepared(Cli::command());
        command.build();
        let help = command.clone().term_width(80).render_long_help().to_string();
        for name in
            command.get_subcommands().map(clap::Command::get_name).filter(|name| *name != "help")
        {
            let lines: Vec<&str> = help
                .lines()
                .filter(|line| {
                    line.strip_prefix("  ").is_some_and(|line| line.split(' ').next() == Some(name))
                })
                .collect();
            assert_eq!(lines.len(), 1, "{name}: {lines:?}");
            assert!(lines[0].chars().count() <= 80, "{}", lines[0]);
            assert!(lines[0].chars().count() > 25, "{name} says nothing");
        }
        assert!(!help.contains("Others:"), "a command is in no group:\n{help}");
        for title in [
            "Measure:",
            "Identify:",
            "Compensate:",
            "Live on ROS 2:",
            "Rig:",
            "Science:",
            "Files:",
            "Help:",
        ] {
            assert_eq!(
                help.matches(title).count(),
                usize::from(title != "Live on ROS 2:" || cfg!(feature = "ros"))
            );
        }
    }

    #[test]
    fn a_short_option_means_the_same_in_every_command() {
        let mut command = prepared(Cli::command());
        command.build();
        let mut meanings: BTreeMap<char, String> = BTreeMap::new();
        for (name, command) in all(&command, "") {
            for arg in command.get_arguments() {
                if let (Some(short), Some(long)) = (arg.get_short(), arg.get_long()) {
                    let before = meanings.entry(short).or_insert_with(|| long.to_owned());
                    assert_eq!(before, long, "-{short} of{name}");
                }
                let long = arg.get_long().unwrap_or_default();
                assert!(
                    !matches!(long, "quiet" | "verbose") || arg.get_short().is_some(),
                    "--{long} of{name}"
                );
            }
        }
        command.debug_assert();
    }

    #[test]
    fn every_option_of_every_command_is_explained() {
        let mut command = prepared(Cli::command());
        command.build();
        for (name, command) in all(&command, "") {
            for arg in command.get_arguments().filter(|arg| !arg.is_hide_set()) {
                assert!(arg.get_help().is_some(), "{} of{name}", arg.get_id());
            }
        }
    }
}
