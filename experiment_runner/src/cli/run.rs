//! `frictionlab run`: experiments on the test bed.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;

use anyhow::Context;
use controller::ControllerOptions;
use friction_model::{AnyModel, ModelName};
use rig_driver::{Drive, FrictionCoupling, Sensors, SimulationOptions, TimeConstant};

use super::{BadInput, Interrupted, model_name};
use crate::progress::Progress;
use crate::protocol::{ConstantVelocityProtocol, TrackingProtocol};
use crate::run::{
    self, Comparison, Compensators, Experiment, Outcome, RecordPolicy, RunError, RunOptions, Status,
    read_parameter_file,
};
use crate::test_bed::TestBed;

/// Run experiments on the simulated test bed
///
/// `frictionlab run` alone does the whole job: it drives the rig at 80 constant velocities (10 repetitions, two sets),
/// identifies the Stribeck curve, compensates with what it found and compares none, LuGre and the proposed model in
/// velocity and position tracking. The output folder gets the bag, parameters.yaml, report.html and run.json.
#[derive(Debug, clap::Args)]
pub struct RunArgs {
    /// What to run
    #[arg(value_enum, default_value_t)]
    pub experiment: Experiment,
    /// Output folder; must be new or empty [default: runs/EXPERIMENT-N with the first free N]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Seed of the sensors' noise; the same seed gives the same run
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Models that compensate, each compared with none at all
    #[arg(long, value_name = "NAMES", value_delimiter = ',', default_value = "lugre,proposed", value_parser = model_name)]
    pub model: Vec<ModelName>,
    /// The simulated plant's own friction model
    #[arg(long, value_name = "NAME", default_value = "proposed", value_parser = model_name)]
    pub plant: ModelName,
    /// Parameters of the compensating models: a parameters.yaml of an earlier run [default: the thesis's test bed]
    #[arg(long, value_name = "FILE")]
    pub parameters: Option<PathBuf>,
    /// A short protocol to try things out: 20 velocities of 6 s, 2 repetitions
    #[arg(long)]
    pub quick: bool,
    /// Repetitions of every experiment [default: 10 at constant velocity, 5 in tracking]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub repetitions: Option<u32>,
    /// How much goes into the bag
    #[arg(long, value_enum, default_value_t)]
    pub record: RecordPolicy,
    /// Time constant of the drive: the thesis's chapter 6 and its data sheet disagree
    #[arg(long, value_enum, default_value_t)]
    pub time_constant: TimeConstantArg,
    /// Friction as a torque, or taken off the volts as in the thesis's own simulations
    #[arg(long, value_enum, default_value_t)]
    pub friction: FrictionArg,
    /// Sensors without noise and steps, for studies of the models alone
    #[arg(long)]
    pub ideal_sensors: bool,
    /// Motor voltage limit [V], at most the card's 10 V
    #[arg(long, value_name = "VOLTS", default_value_t = 6.0)]
    pub voltage_limit: f64,
    /// Threads [default: all cores]; the results do not depend on it
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub jobs: Option<u16>,
    /// No progress bar and no summary
    #[arg(long)]
    pub quiet: bool,
}

/// [`TimeConstant`] on the command line.
#[derive(Debug, Clone, Copy, Default, clap::ValueEnum)]
pub enum TimeConstantArg {
    /// T = .02388 s
    #[default]
    Thesis,
    /// T = .01734 s
    Datasheet,
}

/// [`FrictionCoupling`] on the command line.
#[derive(Debug, Clone, Copy, Default, clap::ValueEnum)]
pub enum FrictionArg {
    /// As a torque: 4.84 V per N m
    #[default]
    Physical,
    /// 1 V per N m
    AsVolts,
}

/// Runs it.
///
/// # Errors
/// [`BadInput`] for what the user can mend, [`Interrupted`] after ctrl-C.
pub fn execute(args: &RunArgs) -> anyhow::Result<()> {
    let options = options(args)?;
    let folder = match &args.out {
        Some(folder) => folder.clone(),
        None => first_free(options.experiment.as_str()),
    };
    let cancel = Arc::new(AtomicBool::new(false));
    let handler = Arc::clone(&cancel);
    ctrlc::set_handler(move || handler.store(true, Ordering::Relaxed)).context("cannot watch for ctrl-C")?;

    let progress = Progress::new(options.rig_seconds(), args.quiet);
    let outcome = run::execute(&options, &folder, &progress, &cancel);
    progress.finish();
    let outcome = outcome.map_err(|error| match error {
        error @ (RunError::Describe { .. } | RunError::Identification(_)) => anyhow::Error::new(error),
        error @ RunError::Bag(_) => BadInput(format!("{error}; --out DIR names another folder")).into(),
        error => BadInput(error.to_string()).into(),
    })?;
    if !args.quiet {
        super::print(&summary(&outcome))?;
    }
    if outcome.results.status == Status::Interrupted {
        return Err(Interrupted(format!(
            "stopped before the end; the bag in {} is whole as far as it goes, and so is the report",
            outcome.folder.join("bag").display()
        ))
        .into());
    }
    Ok(())
}

fn options(args: &RunArgs) -> anyhow::Result<RunOptions> {
    let coupling = match args.friction {
        FrictionArg::Physical => FrictionCoupling::Physical,
        FrictionArg::AsVolts => FrictionCoupling::NewtonMetreAsVolt,
    };
    let drive = Drive::srv02(match args.time_constant {
        TimeConstantArg::Thesis => TimeConstant::Thesis,
        TimeConstantArg::Datasheet => TimeConstant::Datasheet,
    });
    let sensors = if args.ideal_sensors { Sensors::ideal() } else { Sensors::default() };
    let simulation = SimulationOptions {
        drive,
        friction_coupling: coupling,
        sensors,
        voltage_limit: args.voltage_limit,
        ..Default::default()
    };
    let mut controller = ControllerOptions::default();
    controller.compensation.volts_per_newton_metre = drive.friction_volts(coupling);
    let compensators = compensators(args.parameters.as_deref())?;
    let mut constant_velocity =
        if args.quick { ConstantVelocityProtocol::quick() } else { ConstantVelocityProtocol::default() };
    let mut velocity_tracking = TrackingProtocol::velocity();
    let mut position_tracking = TrackingProtocol::position();
    if args.quick {
        (velocity_tracking.repetitions, position_tracking.repetitions) = (1, 1);
    }
    if let Some(repetitions) = args.repetitions {
        constant_velocity.repetitions = repetitions;
        (velocity_tracking.repetitions, position_tracking.repetitions) = (repetitions, repetitions);
    }
    let mut models = args.model.clone();
    models.dedup();
    Ok(RunOptions {
        experiment: args.experiment,
        test_bed: TestBed { simulation, friction: AnyModel::test_bed(args.plant), controller },
        models,
        compensators,
        seed: args.seed,
        record: args.record,
        constant_velocity,
        velocity_tracking,
        position_tracking,
        workers: args
            .jobs
            .map_or_else(|| thread::available_parallelism().map_or(1, usize::from), usize::from),
    })
}

/// The models of a parameter file, or the test bed's where none is given.
pub(super) fn compensators(file: Option<&Path>) -> Result<Compensators, BadInput> {
    let Some(file) = file else { return Ok(Compensators::default()) };
    let say = |what: String| {
        BadInput(format!(
            "the parameter file {} cannot be used: {what}; expected a parameters.yaml as `frictionlab run` writes it",
            file.display()
        ))
    };
    let text = fs::read_to_string(file).map_err(|e| say(e.to_string()))?;
    read_parameter_file(&text).map_err(say)
}

/// The first folder `runs/EXPERIMENT-N` that is not there yet.
pub(super) fn first_free(experiment: &str) -> PathBuf {
    let candidate = |n: u32| PathBuf::from("runs").join(format!("{experiment}-{n}"));
    (1..).map(candidate).find(|folder| !folder.exists()).unwrap_or_else(|| candidate(0))
}

/// What was found, for the terminal.
fn summary(outcome: &Outcome) -> String {
    let results = &outcome.results;
    let mut text = String::new();
    if let Some(found) = &results.identification {
        text += "Stribeck curve\n";
        for p in &found.parameters {
            text += &match (p.estimate.unidentifiable, p.estimate.standard_error) {
                (Some(reason), _) => format!("  {:<4} not identifiable from these data: {reason}\n", p.name),
                (None, Some(error)) => {
                    format!("  {:<4} {:.5} ± {error:.0e} {}\n", p.name, p.estimate.value, p.unit)
                }
                (None, None) => {
                    format!("  {:<4} {:.5} {} (at its bound)\n", p.name, p.estimate.value, p.unit)
                }
            };
        }
    }
    for (title, comparison) in
        [("Velocity tracking", &results.velocity_tracking), ("Position tracking", &results.position_tracking)]
    {
        text += &comparison.as_ref().map_or(String::new(), |comparison| table(title, comparison));
    }
    let megabytes = results.bag.bytes as f64 * 1e-6;
    text += &format!(
        "{:.0} s of rig time in {:.1} s: {:.0} times real time\nReport  {}\nBag     {} ({} messages, {megabytes:.0} MB)\n",
        results.timing.rig_seconds,
        results.timing.wall_seconds,
        results.timing.times_real_time,
        outcome.folder.join("report.html").display(),
        outcome.folder.join(results.bag.folder).display(),
        results.bag.messages,
    );
    text
}

fn table(title: &str, comparison: &Comparison) -> String {
    let mut text = format!("{title:<20}{:>12}{:>9}{:>14}{:>9}\n", "mse", "better", "max error", "better");
    for row in &comparison.rows {
        text += &format!(
            "  {:<18}{:>12.3e}{:>7.1} %{:>14.4}{:>7.1} %\n",
            row.arm.label(),
            row.mse,
            row.mse_improvement,
            row.max_error,
            row.max_error_improvement
        );
    }
    text
}
