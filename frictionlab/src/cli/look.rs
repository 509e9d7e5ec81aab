//! `frictionlab look`: what a recording holds, before any fit.

use std::path::PathBuf;

use identification::look::{document, page, terminal};
use recording::Column;
use recording::joints::JointChoice;
use recording::overview;
use recording::table::Columns;
use work::BadInput;
use work::destination::ToFolder;
use work::saying::Saying;

/// Show what a recording holds before any fit
///
/// Shows what was understood of a table or a bag: columns, units, rate, gaps, rest, ranges, and
/// what can be identified from it. The page has a picture of every channel.
///
///   frictionlab look run.csv
///   frictionlab look bag/ --joint elbow
#[derive(Debug, clap::Args)]
#[command(verbatim_doc_comment)]
pub struct LookArgs {
    /// CSV file, .mcap file or bag folder.
    #[arg(value_name = "FILE")]
    file: PathBuf,

    #[command(flatten)]
    to: ToFolder,

    /// Print nothing but errors.
    #[arg(long)]
    quiet: bool,
    #[command(flatten)]
    saying: Saying,

    /// Column of the time [s], by name or by number.
    #[arg(
        long,
        alias = "time-column",
        value_name = "NAME[:SCALE]",
        help_heading = "Columns of a CSV file"
    )]
    time: Option<Column>,

    /// Column of the position [m or rad].
    #[arg(
        long,
        alias = "position-column",
        value_name = "NAME[:SCALE]",
        help_heading = "Columns of a CSV file"
    )]
    position: Option<Column>,

    /// Column of the velocity [m/s or rad/s].
    #[arg(
        long,
        alias = "velocity-column",
        value_name = "NAME[:SCALE]",
        help_heading = "Columns of a CSV file"
    )]
    velocity: Option<Column>,

    /// Column of the force [N] or torque [N m].
    #[arg(
        id = "force_column",
        long = "force-column",
        value_name = "NAME[:SCALE]",
        help_heading = "Columns of a CSV file"
    )]
    force: Option<Column>,

    /// Bag: the joint of /joint_states.
    #[arg(long, value_name = "NAME", help_heading = "Bag")]
    joint: Option<String>,
}

/// Looks, writes `look.json` and `report.html`, and prints what was understood.
///
/// # Errors
/// [`BadInput`] for whatever is wrong with the file, the options or the output folder; nothing is
/// written then.
pub fn execute(args: &LookArgs) -> anyhow::Result<()> {
    args.saying.begin();
    let file = &args.file;
    let is_bag = file.is_dir() || file.extension().is_some_and(|extension| extension == "mcap");
    let columns = Columns {
        time: args.time.clone(),
        position: args.position.clone(),
        velocity: args.velocity.clone(),
        force: args.force.clone(),
        ..Columns::default()
    };
    if is_bag && columns != Columns::default() {
        let file = file.display();
        return Err(BadInput(format!(
            "{file} is a bag and has no columns: leave out --time, --position, --velocity and --force-column"
        ))
        .into());
    }
    if !is_bag && args.joint.is_some() {
        let file = file.display();
        return Err(
            BadInput(format!("--joint speaks of a bag, but {file} is none: leave it out")).into()
        );
    }
    let choice = JointChoice { name: args.joint.clone(), effort: None };
    let seen = overview::look(file, &columns, &choice)?;
    let files = [
        ("look.json", document(&seen)?),
        ("report.html", report::render_page(&report::linked(page(&seen), ["look.json"]))),
    ];
    let folder = args.to.reserve("look")?;
    folder.write(&files)?;
    let names = files.each_ref().map(|(name, _)| *name).join(", ");
    let text = format!("{}\nwritten to {}: {names}\n", terminal(&seen), folder.path().display());
    args.saying.result(args.quiet, &files[0].1, &text)
}
