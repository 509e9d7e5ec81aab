//! `frictionlab look`: what a recording holds, before any fit.

use std::path::PathBuf;

use identification::look::{document, page, servo, terminal};
use recording::column_options::ColumnArgs;
use recording::joints::JointChoice;
use recording::table::Measured;
use recording::{is_bag, overview, servo_log};
use work::BadInput;
use work::destination::ToFolder;
use work::saying::Saying;

/// Show what a recording holds before any fit
///
/// Shows what was understood of a table or a bag: columns, units, rate, gaps, rest, ranges, and
/// what can be identified from it. The page has a picture of every channel. Of the log of a servo
/// (.json) it shows the motor, the entries, their rate and range.
///
///   frictionlab look run.csv
///   frictionlab look bag/ --joint elbow
///   frictionlab look q.csv --beside tau.csv --period 0.001 --joint 3
#[derive(Debug, clap::Args)]
#[command(verbatim_doc_comment)]
pub struct LookArgs {
    /// Table (CSV, .mat, .npz, .npy, .parquet), folder of tables, .mcap or .db3 file, bag folder, or
    /// servo log (.json).
    #[arg(value_name = "FILE")]
    file: PathBuf,

    #[command(flatten)]
    to: ToFolder,

    /// Print nothing but errors.
    #[arg(long)]
    quiet: bool,
    #[command(flatten)]
    saying: Saying,

    #[command(flatten)]
    columns: ColumnArgs,

    /// The joint of a bag's /joint_states, or of a table's columns as q[2] and q2.
    #[arg(long, value_name = "NAME")]
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
    if file.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("json")) {
        return of_servo(args);
    }
    if let (true, Some(option)) = (is_bag(file), args.columns.given().first()) {
        let file = file.display();
        return Err(
            BadInput(format!("{file} is a bag and has no columns: leave out {option}")).into()
        );
    }
    let columns = args.columns.columns(Measured::Force, args.joint.as_deref());
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

/// The same for the log of a servo.
fn of_servo(args: &LookArgs) -> anyhow::Result<()> {
    let name = args.file.display();
    let joint = args.joint.as_ref().map(|_| "--joint");
    if let Some(option) = args.columns.given().first().copied().or(joint) {
        let why = format!("{name} is the log of a servo and has no columns: leave out {option}");
        return Err(BadInput(why).into());
    }
    let file = servo_log::read(&args.file)?;
    let seen = servo(&file);
    let files = [
        ("look.json", work::saying::document(&seen)?),
        ("report.html", report::render_page(&report::linked(seen.page(&file), ["look.json"]))),
    ];
    let folder = args.to.reserve("look")?;
    folder.write(&files)?;
    let names = files.each_ref().map(|(name, _)| *name).join(", ");
    let text = format!("{}\nwritten to {}: {names}\n", seen.terminal(), folder.path().display());
    args.saying.result(args.quiet, &files[0].1, &text)
}
