//! `frictionlab runs`: what there is, and how two differ.

use std::path::{Path, PathBuf};

use identification::posterior::compare;
use report::figure::Block;
use report::render_page;
use run_folder::{Comparison, Kind, Listing, Run, list};
use serde_json::{Value, json};
use work::BadInput;
use work::destination::ToFolder;
use work::saying::{Saying, document};

/// List the runs in a folder, or hold two beside each other
///
/// A run is a folder that a command left: its kind, when it was made (UTC), how it ended, its size, and
/// whether it has a report. Folders that are none, or are damaged, are named below with the reason.
///
///   frictionlab runs
///   frictionlab runs elsewhere --json
///   frictionlab runs compare runs/all-1 runs/all-2
#[derive(Debug, clap::Args)]
#[command(verbatim_doc_comment, args_conflicts_with_subcommands = true)]
pub struct RunsArgs {
    #[command(subcommand)]
    what: Option<What>,

    /// Folder with the folders of runs.
    #[arg(value_name = "ROOT", default_value = "runs")]
    root: PathBuf,
    /// Print nothing but errors.
    #[arg(long)]
    quiet: bool,
    #[command(flatten)]
    saying: Saying,
}

#[derive(Debug, clap::Subcommand)]
enum What {
    Compare(CompareArgs),
}

/// Hold two runs beside each other: parameters, figures, settings
///
/// Parameters differ where the difference is larger than both 95 % intervals explain together: of two
/// that are equal, 5 % are called different. Two identifications of friction are compared as by
/// `frictionlab compare` besides. With --out a page with the pictures of both reports is written too.
///
///   frictionlab runs compare runs/all-1 runs/all-2
///   frictionlab runs compare runs/all-1 runs/all-2 --out both
#[derive(Debug, clap::Args)]
#[command(verbatim_doc_comment)]
struct CompareArgs {
    /// Folder of a run.
    #[arg(value_name = "A")]
    first: PathBuf,

    /// Folder of the other.
    #[arg(value_name = "B")]
    second: PathBuf,

    /// Folder for report.html and runs.json, new or empty.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,

    /// Write into a folder that is not empty, and replace files of the same names.
    #[arg(long, requires = "out")]
    force: bool,
    /// Print nothing but errors.
    #[arg(long)]
    quiet: bool,
    #[command(flatten)]
    saying: Saying,
}

/// Prints the list, or the comparison.
///
/// # Errors
/// [`BadInput`] for a folder that is not there, and for one that is none of a run where two are
/// compared; [`OutputError`](files::OutputError) where the page cannot be written.
pub fn execute(args: &RunsArgs) -> anyhow::Result<()> {
    if let Some(What::Compare(args)) = &args.what {
        return beside(args);
    }
    args.saying.begin();
    let found = list(&args.root).map_err(|error| BadInput(error.to_string()))?;
    let told = json!({
        "format": "frictionlab-runs",
        "format_version": 1,
        "root": found.root,
        "runs": found.runs,
        "others": found.others,
    });
    args.saying.result(args.quiet, &document(&told)?, &listed(&found))
}

fn beside(args: &CompareArgs) -> anyhow::Result<()> {
    args.saying.begin();
    let found =
        Comparison::of(&args.first, &args.second).map_err(|error| BadInput(error.to_string()))?;
    let friction = of_friction(&found.runs);
    let told = json!({
        "format": "frictionlab-runs-compared",
        "format_version": 1,
        "runs": found.runs,
        "parameters": found.parameters,
        "figures": found.figures,
        "settings": found.settings,
        "friction": friction.as_ref().map(|(document, _)| document),
    });
    let told = document(&told)?;
    let mut text = found.terminal();
    let mut blocks = Vec::new();
    if let Some((_, said)) = &friction {
        text += &format!("\nFriction\n{said}");
        blocks.push(Block::Heading("Friction".to_owned()));
        blocks.push(Block::Text(said.clone()));
    }
    if let Some(out) = &args.out {
        let to = ToFolder { out: Some(out.clone()), force: args.force, runs: None };
        let folder = to.reserve("runs")?;
        let page = report::linked(found.page(blocks), ["runs.json"]);
        folder.write(&[("report.html", render_page(&page)), ("runs.json", told.clone())])?;
        text += &format!("\nReport  {}\n", folder.join("report.html").display());
    }
    args.saying.result(args.quiet, &told, &text)
}

/// What `frictionlab compare` says of two identifications of friction; nothing of other runs.
fn of_friction(runs: &[Run; 2]) -> Option<(Value, String)> {
    if runs.iter().any(|run| run.kind != Kind::Identify) {
        return None;
    }
    let [a, b] = runs.each_ref().map(|run| super::compare::read(&run.folder));
    let found = compare([&a.ok()?, &b.ok()?], None, None, 1).ok()?;
    Some((serde_json::to_value(&found).ok()?, found.terminal()))
}

/// The list for the terminal.
fn listed(found: &Listing) -> String {
    let heads = ["run", "kind", "made (UTC)", "report", "size", "how it ended"];
    let name = |folder: &Path| {
        let beneath = folder.strip_prefix(&found.root).ok();
        let beneath = beneath.filter(|path| !path.as_os_str().is_empty());
        beneath.unwrap_or(folder).display().to_string()
    };
    let row = |run: &Run| {
        [
            name(&run.folder),
            run.title(),
            run.made.as_deref().map_or("-".to_owned(), |made| made.replace(['T', 'Z'], " ")),
            if run.report.is_some() { "yes" } else { "no" }.to_owned(),
            size(run.bytes),
            run.said.clone(),
        ]
    };
    let mut rows: Vec<[String; 6]> = vec![heads.map(str::to_owned)];
    rows.extend(found.runs.iter().map(row));
    let width = |at: usize| rows.iter().map(|row| row[at].trim_end().chars().count()).max();
    let widths: Vec<usize> = (0..heads.len()).map(|at| width(at).unwrap_or(0)).collect();
    let line = |row: &[String; 6]| {
        let cells: Vec<String> = row
            .iter()
            .zip(&widths)
            .map(|(cell, width)| format!("{:<width$}", cell.trim_end()))
            .collect();
        format!("{}\n", cells.join("  ").trim_end())
    };
    let mut text: String = match found.runs.is_empty() {
        true => format!("no runs in {}\n", found.root.display()),
        false => rows.iter().map(line).collect(),
    };
    if !found.others.is_empty() {
        text += "\nNo runs:\n";
        text.extend(found.others.iter().map(|other| format!("  {}\n", other.why)));
    }
    text
}

/// `58.5 MB`.
fn size(bytes: u64) -> String {
    match bytes {
        0..1_000 => format!("{bytes} B"),
        1_000..1_000_000 => format!("{:.1} kB", bytes as f64 / 1e3),
        1_000_000..1_000_000_000 => format!("{:.1} MB", bytes as f64 / 1e6),
        _ => format!("{:.1} GB", bytes as f64 / 1e9),
    }
}
