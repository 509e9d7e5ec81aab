//! `frictionlab identify-servo`: friction of a position-controlled servo from its logs.

use std::path::{Path, PathBuf};
use std::thread;

use friction_ident::servo::{Effort, FrictionLevel};

use super::hold_out::HoldOut;
use crate::interruption;
use identification::servo::description::ServoDescription;
use identification::servo::given::GivenParameters;
use identification::servo::logs::{NamedServoLog, check_motion, prepare};
use identification::servo::{Settings, document, evaluate, identify, page, terminal};
use recording::servo_log::{self, ServoFile};
use work::BadInput;
use work::Interrupted;
use work::destination::ToFolder;
use work::progress::Progress;
use work::saying::Saying;

/// Splits of the logs into disjoint halves.
const SPLITS: usize = 4;
/// Most delay that may be given \[s\].
const LONGEST_DELAY: f64 = 0.5;

/// Find a servo's friction in the logs of its position loop
///
/// Each log is a JSON file as the tool bam (Better Actuator Models) records it: a pendulum of known
/// mass and length follows a goal. The servo is simulated from the first sample of each log on, and
/// an evolution strategy looks for the parameters whose position is closest. Friction comes in the
/// levels of arXiv 2410.08650, m1 (Coulomb, viscous) to m6 (load, direction of power, Stribeck),
/// and one of our own, progressive, which grows faster than the load.
///
/// What is known of the servo (what its gain does, its limits, bounds) is taken from the
/// description that fits the logs' `motor`, or from --servo. --list-servos names those built in.
///
/// Logs of some gain, motion, mass, ... may be held out to see what the result is worth where it
/// was not fitted:
///
///   frictionlab identify-servo xl330/*.json --hold-out kp=400 --level m6 --seeds 10
///
/// Each seed ends in another minimum, and disjoint halves of the logs are fitted by themselves. The
/// table says which parameters they agree on. Ctrl-C stops the searches and reports the best so
/// far.
#[derive(Debug, clap::Args)]
#[command(verbatim_doc_comment)]
pub struct IdentifyServoArgs {
    /// Logs.
    #[arg(value_name = "LOG.json", required_unless_present = "list_servos")]
    logs: Vec<PathBuf>,

    /// The servo: a built-in name, or a file that describes it [default: the logs' `motor`].
    #[arg(long, value_name = "NAME|FILE.yaml")]
    servo: Option<String>,

    /// Name the built-in descriptions of servos, with an example of an own one.
    #[arg(long, exclusive = true)]
    list_servos: bool,

    /// Hold out the logs whose header has one of these values in this field; may be repeated.
    #[arg(long, value_name = "FIELD=VALUE[,VALUE]", value_parser = HoldOut::parse)]
    hold_out: Vec<HoldOut>,

    /// Score the parameters of this file (`servo.json`, or the peer's) on the logs, without a fit.
    #[arg(long, value_name = "PARAMS.json", conflicts_with_all = ["hold_out", "level", "delay", "seeds", "seed", "evaluations", "friction_varies", "whole", "jobs"])]
    evaluate: Option<PathBuf>,

    /// Friction level.
    #[arg(long, value_name = "LEVEL", default_value = "m6", value_parser = level)]
    level: FrictionLevel,

    /// Time from a goal to its effect: `fit` it, take `none`, or give it in seconds.
    #[arg(long, value_name = "fit|none|SECONDS", default_value = "fit", value_parser = delay)]
    delay: DelayChoice,

    /// Searches, each from its own seed.
    #[arg(long, value_name = "N", default_value_t = 10, value_parser = clap::value_parser!(u32).range(1..=1000))]
    seeds: u32,

    /// The first seed.
    #[arg(long, value_name = "SEED", default_value_t = 0)]
    seed: u64,

    /// Simulations of all logs in each search.
    #[arg(long, value_name = "N", default_value_t = 60_000, value_parser = clap::value_parser!(u32).range(1..))]
    evaluations: u32,

    /// How much friction may differ from one log to the next [%]: a candidate is judged with so much
    /// less and so much more friction too, three simulations in all, so that none wins by chance.
    /// With 0 it is judged by its own friction alone, as bam does.
    #[arg(long, value_name = "PERCENT", default_value_t = 10.0, value_parser = varies)]
    friction_varies: f64,

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

#[derive(Debug, Clone, Copy, PartialEq)]
enum DelayChoice {
    Fit,
    Given(f64),
}

fn delay(text: &str) -> Result<DelayChoice, String> {
    match (text, text.parse::<f64>()) {
        ("fit", _) => Ok(DelayChoice::Fit),
        ("none", _) => Ok(DelayChoice::Given(0.0)),
        (_, Ok(value)) if (0.0..=LONGEST_DELAY).contains(&value) => Ok(DelayChoice::Given(value)),
        _ => Err(format!("expected fit, none, or seconds from 0 to {LONGEST_DELAY}")),
    }
}

fn varies(text: &str) -> Result<f64, String> {
    let share = text.parse().ok().filter(|share| (0.0..=50.0).contains(share));
    share.ok_or_else(|| "expected per cent from 0 to 50".to_owned())
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
    if args.list_servos {
        return work::saying::print(&list()?);
    }
    let files: Vec<ServoFile> =
        args.logs.iter().map(|path| servo_log::read(path)).collect::<Result<_, _>>()?;
    let servo = description(args.servo.as_deref(), &files)?;
    for asked in &args.hold_out {
        asked.check(&files)?;
    }
    let mut notes = Vec::new();
    contradictions(&files, &servo, args.servo.is_some(), &mut notes);
    let (mut train, mut held_out) = (Vec::new(), Vec::new());
    for file in files {
        let held = args.hold_out.iter().any(|asked| asked.takes(&file));
        let named = prepare(file, &servo, &mut notes)?;
        if held { held_out.push(named) } else { train.push(named) }
    }
    check_motion(&train, &servo, &mut notes)?;
    check_motion(&held_out, &servo, &mut notes)?;
    if let Some(path) = &args.evaluate {
        return score(args, path, &servo, &train, &notes);
    }
    fit(args, &servo, &train, &held_out, notes)
}

fn fit(
    args: &IdentifyServoArgs,
    servo: &ServoDescription,
    train: &[NamedServoLog],
    held_out: &[NamedServoLog],
    mut notes: Vec<String>,
) -> anyhow::Result<()> {
    if servo.estimates_gain() {
        notes.push(format!(
            "what the gain of servo {} does is not known for certain: its scale is estimated (gain_scale). \
             Where the drive does not saturate, only its product with the torque constant over the resistance is determined",
            servo.name()
        ));
    }
    let workers = args
        .jobs
        .map_or_else(|| thread::available_parallelism().map_or(1, usize::from), usize::from);
    let settings = Settings {
        servo: servo.name().to_owned(),
        drive: servo.drive(),
        level: args.level,
        free: servo.free(args.level, args.delay == DelayChoice::Fit),
        delay: match args.delay {
            DelayChoice::Fit => None,
            DelayChoice::Given(delay) => Some(delay),
        },
        notes,
        splits: SPLITS,
        seeds: args.seeds as usize,
        first_seed: args.seed,
        effort: Effort {
            evaluations: args.evaluations as usize,
            abandon: !args.whole,
            friction_varies: 0.01 * args.friction_varies,
        },
        workers,
    };
    let folder = args.to.reserve("identify-servo")?;
    let cancel = interruption::watch(interruption::WRITING)?;
    let halves = SPLITS as u64 * u64::from(args.evaluations);
    let total = u64::from(args.seeds) * u64::from(args.evaluations) + halves;
    args.saying.begin();
    let progress = Progress::counting(total, "simulations", args.quiet);
    let found = identify(train, held_out, &settings, &cancel, &progress);
    progress.finish();
    let found = found.map_err(|error| BadInput(error.to_string()))?;

    let files = [
        ("servo.json", document::render(&found, train, held_out)),
        (
            "report.html",
            report::render_page(&report::linked(
                page::page(&found, train, held_out),
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

fn score(
    args: &IdentifyServoArgs,
    path: &Path,
    servo: &ServoDescription,
    logs: &[NamedServoLog],
    notes: &[String],
) -> anyhow::Result<()> {
    let name = path.display().to_string();
    let text = files::input::text(path).map_err(|error| BadInput(format!("{name}: {error}")))?;
    let given = GivenParameters::read(&name, &text)?;
    let mut notes = notes.to_vec();
    if let Some(actuator) = given.actuator.as_deref().filter(|actuator| !servo.is_called(actuator))
    {
        notes.push(format!(
            "{name} is of `{actuator}`, but the logs are taken for servo {}",
            servo.name()
        ));
    }
    let folder = args.to.reserve("identify-servo")?;
    let found = evaluate::evaluate(logs, &servo.drive(), &given);
    let files = [("evaluation.json", evaluate::document(&found, logs, servo.name(), &notes))];
    folder.write(&files)?;
    let text = evaluate::text(&found, logs, servo.name(), &notes);
    args.saying.result(args.quiet, &files[0].1, &text)
}

/// What is known of the servo: as asked, else by the logs' common `motor`.
fn description(asked: Option<&str>, files: &[ServoFile]) -> anyhow::Result<ServoDescription> {
    if let Some(asked) = asked {
        let is_file = [".yaml", ".yml"].iter().any(|end| asked.ends_with(end));
        if !is_file && !Path::new(asked).is_file() {
            return Ok(ServoDescription::of_motor(asked)?);
        }
        let text = files::input::text(Path::new(asked))
            .map_err(|error| BadInput(format!("{asked}: {error}")))?;
        return Ok(ServoDescription::read(asked, &text)?);
    }
    let mut motors: Vec<&str> = files.iter().filter_map(|file| file.text("motor")).collect();
    motors.sort_unstable();
    motors.dedup();
    let nameless = files.iter().find(|file| file.text("motor").is_none());
    match (motors.as_slice(), nameless) {
        ([motor], None) => Ok(ServoDescription::of_motor(motor)?),
        (_, Some(file)) => Err(BadInput(format!(
            "{}: its header does not name the servo (`motor`); say which it is with --servo NAME, or describe it \
             with --servo FILE.yaml (frictionlab identify-servo --list-servos shows both)",
            file.path.display()
        ))
        .into()),
        (several, None) => Err(BadInput(format!(
            "the logs are of several servos ({}); fit those of one at a time",
            several.join(", ")
        ))
        .into()),
    }
}

/// Notes where the logs name another servo than the one asked for.
fn contradictions(
    files: &[ServoFile],
    servo: &ServoDescription,
    asked: bool,
    notes: &mut Vec<String>,
) {
    let other = files.iter().filter_map(|file| file.text("motor")).find(|m| !servo.is_called(m));
    if let Some(motor) = other.filter(|_| asked) {
        notes.push(format!(
            "a log names servo `{motor}`, but --servo {} was asked for",
            servo.name()
        ));
    }
}

fn list() -> anyhow::Result<String> {
    let mut text = "servos that are described, with other names of them:\n".to_owned();
    for servo in ServoDescription::built_in()? {
        let gain =
            if servo.estimates_gain() { "scale of the gain estimated" } else { "gain known" };
        text += &format!(
            "  {:<14} {} mode, {gain}; {}\n",
            servo.name(),
            servo.control(),
            servo.names.get(1..).unwrap_or_default().join(", ")
        );
    }
    text += "\nan own one, given with --servo FILE.yaml:\n\n";
    text += identification::servo::description::EXAMPLE;
    Ok(text)
}
