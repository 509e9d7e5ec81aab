//! `frictionlab identify-stiction`: friction in volts from stiction limit cycles.

use std::path::PathBuf;

use identification::stiction::{Settings, document, identify, page, terminal};
use recording::Column;
use recording::stiction_table::{self, StictionColumns};
use work::BadInput;
use work::destination::ToFolder;
use work::saying::Saying;

/// Find friction in volts where an axis sticks and slips
///
/// Each recording is a CSV file with a header: time, angle of the axis and motor voltage, evenly
/// sampled. It begins with a limit cycle at a fixed reference; what follows until its end is driven
/// motion. From the first part come the voltages at which the axis lets go, in each direction; from
/// the second the friction while it slides. A pendulum hinged to the axis is taken into account.
///
///   frictionlab identify-stiction episode_1.csv episode_2.csv --until 4
#[derive(Debug, clap::Args)]
#[command(verbatim_doc_comment)]
pub struct IdentifyStictionArgs {
    /// Recordings of one axis.
    #[arg(value_name = "FILE.csv", required = true)]
    files: Vec<PathBuf>,

    /// Column of the time [s].
    #[arg(long, value_name = "NAME[:SCALE]", default_value = "t", help_heading = "Columns")]
    time: Column,

    /// Column of the axis' angle [rad].
    #[arg(long, value_name = "NAME[:SCALE]", default_value = "theta", help_heading = "Columns")]
    angle: Column,

    /// Column of the voltage on the motor [V].
    #[arg(
        long,
        value_name = "NAME[:SCALE]",
        default_value = "plant_input",
        help_heading = "Columns"
    )]
    voltage: Column,

    /// Column of the angle of a pendulum on the axis [rad].
    #[arg(long, value_name = "NAME[:SCALE]", default_value = "alpha", help_heading = "Columns")]
    pendulum: Column,

    /// The axis carries no pendulum.
    #[arg(long, help_heading = "Columns", conflicts_with = "pendulum")]
    without_pendulum: bool,

    /// Counts of the encoder a turn.
    #[arg(long, value_name = "N", default_value_t = 2048.0)]
    counts: f64,

    /// The limit cycle begins here [s].
    #[arg(long, value_name = "SECONDS", default_value_t = 0.5)]
    from: f64,

    /// The limit cycle ends here [s].
    #[arg(long, value_name = "SECONDS", default_value_t = 4.0)]
    until: f64,

    #[command(flatten)]
    to: ToFolder,

    /// Print nothing but errors.
    #[arg(long)]
    quiet: bool,
    #[command(flatten)]
    saying: Saying,
}

/// Reads, identifies, writes `stiction.json` and `report.html`, and prints a table.
///
/// # Errors
/// [`BadInput`] for whatever is wrong with the files, the options or the output folder.
pub fn execute(args: &IdentifyStictionArgs) -> anyhow::Result<()> {
    if !(args.counts >= 4.0 && args.counts.is_finite()) {
        return Err(BadInput(format!(
            "--counts must be a number of counts a turn, as in 2048, but is {}",
            args.counts
        ))
        .into());
    }
    if !(args.from >= 0.0 && args.until > args.from && args.until.is_finite()) {
        let (from, until) = (args.from, args.until);
        return Err(BadInput(format!(
            "--from and --until must be times with 0 <= from < until, but are {from} and {until}"
        ))
        .into());
    }
    let columns = StictionColumns {
        time: args.time.clone(),
        angle: args.angle.clone(),
        voltage: args.voltage.clone(),
        pendulum: (!args.without_pendulum).then(|| args.pendulum.clone()),
    };
    let tables = args
        .files
        .iter()
        .map(|path| stiction_table::read(path, &columns))
        .collect::<Result<Vec<_>, _>>()?;
    let settings = Settings::new(args.counts, args.from, args.until);
    let found = identify(&tables, &settings).map_err(|error| BadInput(error.to_string()))?;
    let files = [
        ("stiction.json", document::render(&found, &tables)),
        (
            "report.html",
            report::render_page(&report::linked(page::page(&found, &tables), ["stiction.json"])),
        ),
    ];
    let folder = args.to.reserve("identify-stiction")?;
    folder.write(&files)?;
    let report = folder.join("report.html");
    let text = format!("{}\nReport  {}\n", terminal::render(&found, &tables), report.display());
    args.saying.result(args.quiet, &files[0].1, &text)
}
