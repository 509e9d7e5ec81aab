//! `frictionlab identify-servo`: friction of a position-controlled servo from its logs.

use std::path::PathBuf;
use std::thread;

use friction_ident::servo::{Effort, FrictionLevel};

use crate::interruption;
use identification::servo::{Settings, document, identify, page, terminal};
use recording::servo_log::{self, NamedServoLog};
use work::BadInput;
use work::Interrupted;
use work::destination::ToFolder;
use work::progress::Progress;
use work::saying::Saying;

/// Find a servo's friction in the logs of its position loop
///
/// Each log is a JSON file as the tool bam (Better Actuator Models) records it: a pendulum of known
/// mass and length follows a goal. The servo is simulated from the first sample of each log on, and
/// an evolution strategy looks for the parameters whose position is closest. Friction comes in the
/// levels of arXiv 2410.08650, m1 (Coulomb, viscous) to m6 (load, direction of power, Stribeck),
/// and one of our own, progressive, which grows faster than the load.
///
/// Logs of one gain may be held out to see what the result is worth where it was not fitted:
///
///   frictionlab identify-servo xl330/*.json --hold-out kp=400 --level m6 --seeds 10
///
/// Each seed ends in another minimum. The table says which parameters they agree on. Ctrl-C stops
/// the searches and reports the best so far.
#[derive(Debug, clap::Args)]
#[command(verbatim_doc_comment)]
pub struct IdentifyServoArgs {
    /// Logs.
    #[arg(value_name = "LOG.json", required = true)]
    logs: Vec<PathBuf>,

    /// Hold out the logs of this gain; may be repeated.
    #[arg(long, value_name = "kp=GAIN", value_parser = gain)]
    hold_out: Vec<f64>,

    /// Friction level.
    #[arg(long, value_name = "LEVEL", default_value = "m6", value_parser = level)]
    level: FrictionLevel,

    /// Searches, each from its own seed.
    #[arg(long, value_name = "N", default_value_t = 10, value_parser = clap::value_parser!(u32).range(1..=1000))]
    seeds: u32,

    /// The first seed.
    #[arg(long, value_name = "SEED", default_value_t = 0)]
    seed: u64,

    /// Simulations of all logs in each search.
    #[arg(long, value_name = "N", default_value_t = 30_000, value_parser = clap::value_parser!(u32).range(1..))]
    evaluations: u32,

    /// Simulate every candidate to its end.
    #[arg(long)]
    whole: bool,

    /// Threads [default: all cores].
    #[arg(long, value_name = "N")]
    jobs: Option<std::num::NonZeroUsize>,

    #[command(flatten)]
    to: ToFolder,

    /// Print nothing but errors.
    #[arg(long)]
    quiet: bool,
    #[command(flatten)]
    saying: Saying,
}

fn gain(text: &str) -> Result<f64, String> {
    let number = text.strip_prefix("kp=").unwrap_or(text);
    match number.parse::<f64>() {
        Ok(value) if value > 0.0 && value.is_finite() => Ok(value),
        _ => Err("expected a gain, as in kp=400".to_owned()),
    }
}

fn level(text: &str) -> Result<FrictionLevel, String> {
    text.parse().map_err(|_| format!("expected one of {}", FrictionLevel::NAMES.join(", ")))
}

/// Reads, searches, writes `servo.json` and `report.html`, and prints a table.
///
/// # Errors
/// [`BadInput`] for whatever is wrong with the logs or the output folder, [`Interrupted`] after
/// ctrl-C, with the results so far written.
pub fn execute(args: &IdentifyServoArgs) -> anyhow::Result<()> {
    let mut train: Vec<NamedServoLog> = Vec::new();
    let mut held_out = Vec::new();
    for path in &args.logs {
        let named = servo_log::read(path)?;
        if args.hold_out.contains(&named.log.gain()) {
            held_out.push(named)
        } else {
            train.push(named)
        }
    }
    for gain in &args.hold_out {
        if !held_out.iter().any(|named| named.log.gain() == *gain) {
            let mut present: Vec<String> =
                train.iter().map(|named| named.log.gain().to_string()).collect();
            present.dedup();
            return Err(BadInput(format!(
                "--hold-out kp={gain}: no log has this gain; the logs have {}",
                present.join(", ")
            ))
            .into());
        }
    }
    let workers = args
        .jobs
        .map_or_else(|| thread::available_parallelism().map_or(1, usize::from), usize::from);
    let settings = Settings {
        level: args.level,
        seeds: args.seeds as usize,
        first_seed: args.seed,
        effort: Effort { evaluations: args.evaluations as usize, abandon: !args.whole },
        workers,
    };
    let folder = args.to.reserve("identify-servo")?;
    let cancel = interruption::watch(interruption::WRITING)?;
    let total = u64::from(args.seeds) * u64::from(args.evaluations);
    args.saying.begin();
    let progress = Progress::counting(total, "simulations", args.quiet);
    let found = identify(&train, &held_out, &settings, &cancel, &progress);
    progress.finish();
    let found = found.map_err(|error| BadInput(error.to_string()))?;

    let files = [
        ("servo.json", document::render(&found, &train, &held_out)),
        (
            "report.html",
            report::render_page(&report::linked(
                page::page(&found, &train, &held_out),
                ["servo.json"],
            )),
        ),
    ];
    folder.write(&files)?;
    let report = folder.join("report.html");
    let text = format!("{}\nReport  {}\n", terminal::render(&found), report.display());
    args.saying.result(args.quiet, &files[0].1, &text)?;
    if found.stopped {
        return Err(Interrupted(format!(
            "stopped before the end; the best so far is in {}",
            folder.path().display()
        ))
        .into());
    }
    Ok(())
}
