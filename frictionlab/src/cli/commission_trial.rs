//! `frictionlab commission --trial N`: machines that nobody has seen.

use std::path::Path;

use commission::trial::{Table, Trial, table, trial};
use files::write_all;
use serde_json::json;
use work::destination::ToFolder;
use work::progress::Progress;
use work::saying::Saying;

use super::commission_words::worded;
use crate::interruption;

/// Name of the document.
const DOCUMENT: &str = "trial.json";

/// Runs it.
///
/// # Errors
/// As for a commission.
pub fn execute(asked: &Trial, to: &ToFolder, quiet: bool, saying: Saying) -> anyhow::Result<()> {
    let stop = interruption::watch(interruption::DRIVING)?;
    let folder = to.reserve("trial")?;
    saying.begin();
    let progress = Progress::counting(u64::from(asked.machines), "machines", quiet);
    let cases = trial(asked, folder.path(), &stop, &progress);
    progress.finish();
    let cases = cases.map_err(worded)?;
    let found: Table = table(&cases);
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
    saying.result(quiet, &document, &text)
}
