//! `frictionlab commission --protocols`: the simulated test bed by blocks that are chosen one by one,
//! beside the thesis's constant velocities.

use commission::Asked;
use commission::protocols::test_bed::{PART, beside};
use experiment_runner::protocol::ConstantVelocityProtocol;
use files::write_all;
use serde_json::json;
use work::destination::ToFolder;
use work::progress::Progress;
use work::saying::Saying;

use super::commission_words::worded;
use crate::interruption;

/// Name of the document.
const DOCUMENT: &str = "protocols.json";

/// Runs it.
///
/// # Errors
/// As for a commission.
pub fn execute(asked: &Asked, to: &ToFolder, quiet: bool, saying: Saying) -> anyhow::Result<()> {
    let stop = interruption::watch(interruption::DRIVING)?;
    let folder = to.reserve("protocols")?;
    saying.begin();
    let protocol = ConstantVelocityProtocol::default();
    let progress = Progress::new(PART * protocol.rig_seconds(), quiet);
    let found = beside(asked, &protocol, &stop, &progress);
    progress.finish();
    let found = found.map_err(worded)?;
    let document = json!({
        "format": "frictionlab-commission-protocols",
        "format_version": 1,
        "program_version": env!("CARGO_PKG_VERSION"),
        "beside": found,
    });
    let document = format!("{document:#}\n");
    write_all(folder.path(), &[(DOCUMENT, document.clone())])?;
    let folder = folder.into_path();
    let text = format!("{found}figures         {}\n", folder.join(DOCUMENT).display());
    saying.result(quiet, &document, &text)
}
