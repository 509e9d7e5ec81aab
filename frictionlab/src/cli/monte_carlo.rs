//! `frictionlab monte-carlo`: what compensation is worth when its parameters are wrong.

use std::path::Path;
use std::thread;
use std::time::Instant;

use anyhow::Context;
use clap::ValueEnum;
use friction_model::ModelName;

use super::in_parts;
use crate::interruption;
use experiment_runner::compensation::{Arm, Means};
use files::Folder;
use report::{linked, render_page};
use studies::monte_carlo::{
    BeliefErrors, Setting, Sharing, Study, StudyOptions, Task, page::page, terminal::summary,
};
use work::BadInput;
use work::Interrupted;
use work::destination::ToFolder;
use work::model_name::model_name;
use work::part::{self, InParts, Part};
use work::progress::{Progress, about};
use work::saying::Saying;

/// Name of the command, of its folders and of its parts.
const WORK: &str = "monte-carlo";

/// Compensate with wrong parameters, a thousand times
///
/// In every draw each parameter of the compensating models, and each drive constant that the
/// compensation uses, is wrong by its own factor within +-20 %; the sensors have noise and
/// converter steps, and the linear controller keeps its gains. Every technique over every model
/// then follows the same references under the same errors and noise. The report says how many times
/// smaller the mean square of the error becomes than with the linear controller alone (percentiles
/// over the draws), how often compensation makes it worse, what it costs in volts, and how often
/// each model is the best.
///
///   frictionlab monte-carlo
///   frictionlab monte-carlo --task position-tracking --model lugre,gms,xiong,proposed --means
///   feedback,feedforward frictionlab monte-carlo --plant all --model lugre,gms,xiong,proposed
///   --draws 100     # plant x observer frictionlab monte-carlo --error 0 --draws 10               
///                            # with exact parameters frictionlab monte-carlo --setting thesis --sharing own --means feedback --model lugre,gms,xiong,proposed
#[derive(Debug, clap::Args)]
#[command(verbatim_doc_comment)]
pub struct MonteCarloArgs {
    /// What has to be followed
    #[arg(long, value_enum, value_name = "TASK", default_value_t)]
    task: TaskArg,

    /// Models that compensate, separated by commas
    #[arg(long, value_delimiter = ',', value_parser = model_name, value_name = "NAMES", default_value = "lugre,proposed")]
    model: Vec<ModelName>,

    /// By what means they compensate, separated by commas [default: every technique]
    #[arg(long, value_enum, value_delimiter = ',', value_name = "MEANS")]
    means: Vec<Means>,

    /// Friction of the plant: names separated by commas, or `all` for each of the compensating
    /// models in turn
    #[arg(long, value_delimiter = ',', value_name = "NAMES", default_value = "proposed")]
    plant: Vec<String>,

    /// Draws
    #[arg(long, value_name = "N", default_value_t = 1000, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    draws: u32,

    /// Largest error of a parameter [%], from 0 to below 100
    #[arg(long, value_name = "PERCENT", default_value_t = 20.0, allow_negative_numbers = true)]
    error: f64,

    /// Which models share an error
    #[arg(long, value_enum, default_value_t)]
    sharing: Sharing,

    /// Units and sensors
    #[arg(long, value_enum, default_value_t)]
    setting: Setting,

    /// Seed of errors and noise; the same seed gives the same figures
    #[arg(long, default_value_t = 1)]
    seed: u64,

    #[command(flatten)]
    to: ToFolder,

    #[command(flatten)]
    parts: InParts,

    /// Threads [default: all cores]; the figures do not depend on it
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    jobs: Option<u16>,

    /// Print nothing but errors
    #[arg(long)]
    quiet: bool,
    #[command(flatten)]
    saying: Saying,
}

/// [`Task`] on the command line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum)]
enum TaskArg {
    /// r = 0.30 sin(0.107 t) rad/s, 58.7 s
    VelocityTracking,
    /// r = 1.0 sin(0.546 t) rad, 20 s
    PositionTracking,
    /// One after the other
    #[default]
    Both,
}

/// Runs it.
///
/// # Errors
/// [`BadInput`] for what the user can mend, [`Interrupted`] after ctrl-C.
pub fn execute(args: &MonteCarloArgs) -> anyhow::Result<()> {
    let options = options(args)?;
    if let Some(parts) = &args.parts.join {
        return joined(args, &options, parts);
    }
    let draws = args.parts.part.unwrap_or(Part::WHOLE).range(options.draws);
    let folder = args.to.reserve(WORK)?;
    let cancel = interruption::watch(interruption::WRITING)?;

    args.saying.begin();
    let progress = Progress::counting(options.length(draws.len()), "draws", args.quiet);
    progress.stage("compensating with wrong parameters");
    if !args.quiet
        && let Some(seconds) = options.expected_seconds(draws.len())?
    {
        eprintln!(
            "monte-carlo: {} on {} threads; ctrl-C keeps what is there",
            about(seconds),
            options.workers
        );
    }
    let started = Instant::now();
    let study = options.make(draws, &progress, &cancel);
    let seconds = started.elapsed().as_secs_f64();
    progress.finish();
    let study = study?;
    if let Some(part) = args.parts.part {
        if study.stopped {
            return Err(Interrupted(in_parts::STOPPED.to_owned()).into());
        }
        return in_parts::wrote(WORK, part, &study, (&folder, args.saying, args.quiet));
    }
    let runs = study.runs();
    let speed = format!(
        "{runs} runs in {seconds:.1} s, {:.0} a second on {} threads\n",
        runs as f64 / seconds,
        options.workers,
    );
    wrote(args, &study, &folder, &speed)?;
    if study.stopped {
        let what = "stopped before the end; the draws done by then are in the report";
        return Err(Interrupted(what.to_owned()).into());
    }
    Ok(())
}

/// Joins parts.
fn joined(args: &MonteCarloArgs, options: &StudyOptions, parts: &Path) -> anyhow::Result<()> {
    let parts = part::read(parts, WORK)?;
    let study = options.join(&parts)?;
    wrote(args, &study, &args.to.reserve(WORK)?, "")?;
    in_parts::joined(parts.lacking())
}

/// Writes and prints a study.
fn wrote(args: &MonteCarloArgs, study: &Study, folder: &Folder, speed: &str) -> anyhow::Result<()> {
    let json = serde_json::to_string(study).context("cannot describe the results")?;
    folder.write(&[
        ("report.html", render_page(&linked(page(study), ["monte-carlo.json"]))),
        ("monte-carlo.json", json.clone()),
    ])?;
    let report = folder.join("report.html");
    let text = format!("{}{speed}Report  {}\n", summary(study), report.display());
    args.saying.result(args.quiet, &json, &text)
}

fn options(args: &MonteCarloArgs) -> Result<StudyOptions, BadInput> {
    if !(0.0..100.0).contains(&args.error) {
        return Err(BadInput(format!(
            "--error must be a number of per cent from 0 to below 100, but is {}",
            args.error
        )));
    }
    let models = without_repeats(&args.model);
    let means = if args.means.is_empty() { Means::value_variants() } else { args.means.as_slice() };
    let plants = if args.plant.iter().any(|name| name == "all") {
        models.clone()
    } else {
        args.plant
            .iter()
            .map(|name| model_name(name).map_err(|error| BadInput(error.to_string())))
            .collect::<Result<Vec<_>, _>>()?
    };
    Ok(StudyOptions {
        tasks: match args.task {
            TaskArg::VelocityTracking => vec![Task::VelocityTracking],
            TaskArg::PositionTracking => vec![Task::PositionTracking],
            TaskArg::Both => Task::ALL.to_vec(),
        },
        plants: without_repeats(&plants),
        arms: Arm::all(&without_repeats(means), &models),
        draws: args.draws,
        errors: BeliefErrors {
            fraction: args.error / 100.0,
            sharing: args.sharing,
            seed: args.seed,
        },
        setting: args.setting,
        workers: args
            .jobs
            .map_or_else(|| thread::available_parallelism().map_or(1, usize::from), usize::from),
    })
}

/// The first of each, in their order.
fn without_repeats<T: Copy + PartialEq>(items: &[T]) -> Vec<T> {
    let mut kept = Vec::with_capacity(items.len());
    for &item in items {
        if !kept.contains(&item) {
            kept.push(item);
        }
    }
    kept
}
