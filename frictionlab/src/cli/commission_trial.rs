//! `frictionlab commission --trial N`: machines that nobody has seen.

use std::path::Path;

use commission::trial::{Case, Table, Trial, TrialPart, join, table, trial};
use files::{Folder, write_all};
use serde_json::json;
use work::part::{self, Part};
use work::progress::Progress;

use super::commission_args::CommissionArgs;
use super::commission_words::worded;
use super::in_parts;
use crate::interruption;

/// Name of the folders and of the parts.
const WORK: &str = "commission --trial";
/// Name of the document.
const DOCUMENT: &str = "trial.json";

/// Runs it.
///
/// # Errors
/// As for a commission.
pub fn execute(asked: &Trial, args: &CommissionArgs) -> anyhow::Result<()> {
    if let Some(parts) = &args.parts.join {
        let parts = part::read(parts, WORK)?;
        let lacking = parts.lacking();
        let cases = join(asked, parts)?;
        wrote(asked, &cases, args, args.to.reserve("trial")?)?;
        return in_parts::joined(lacking);
    }
    let machines = args.parts.part.unwrap_or(Part::WHOLE).range(asked.machines);
    let stop = interruption::watch(interruption::DRIVING)?;
    let folder = args.to.reserve("trial")?;
    args.saying.begin();
    let progress = Progress::counting(machines.len() as u64, "machines", args.quiet);
    let cases = trial(asked, machines, folder.path(), &stop, &progress);
    progress.finish();
    let cases = cases.map_err(worded)?;
    if let Some(part) = args.parts.part {
        let found = TrialPart::new(asked, cases);
        return in_parts::wrote(WORK, part, &found, (&folder, args.saying, args.quiet));
    }
    wrote(asked, &cases, args, folder)
}

/// Writes and prints what came of machines.
fn wrote(
    asked: &Trial,
    cases: &[Case],
    args: &CommissionArgs,
    folder: Folder,
) -> anyhow::Result<()> {
    let found: Table = table(cases);
    let document = json!({
        "format": "frictionlab-commission-trial",
        "format_version": 1,
        "program_version": env!("CARGO_PKG_VERSION"),
        "seed": asked.seed,
        "table": found,
        "cases": cases,
    });
    let document = format!("{document:#}\n");
    write_all(folder.path(), &[(DOCUMENT, document.clone())])?;
    let folder = folder.into_path();
    let text = format!("{found}machines    {}\n", Path::new(&folder).join(DOCUMENT).display());
    args.saying.result(args.quiet, &document, &text)
}
