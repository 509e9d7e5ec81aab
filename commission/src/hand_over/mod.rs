//! Hand-over: `parameters.yaml` for the nodes, `commission.json` and `report.html`, all or none.

mod first_page;
mod page;
mod parameters;
mod structure;
mod summary;
mod worth;

use files::write_all;
use serde::Serialize;
use serde_json::json;

use crate::axis::Known;
use crate::bed::Bed;
use crate::control::Control;
use crate::drive::Drive;
use crate::friction::Friction;
use crate::friction::wanted::Wanted;
use crate::meet::Met;
use crate::model::Chosen;
use crate::proof::Proof;
use crate::{CommissionError, Dossier, Stage};

pub(crate) use first_page::worth;
pub(crate) use summary::{arm, fed_back};
pub use summary::{believed, proved, summary};

/// Name of the parameter file.
pub const PARAMETERS: &str = "parameters.yaml";
/// Name of the report.
pub const REPORT: &str = "report.html";

/// Everything that was found.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Found {
    /// The rig.
    pub rig: String,
    /// Rig time of all stages \[s\].
    pub seconds: f64,
    /// Stage meet.
    pub met: Met,
    /// Stage drive.
    pub drive: Drive,
    /// Stage friction.
    pub friction: Friction,
    /// Stage model.
    pub chosen: Chosen,
    /// Stage control.
    pub control: Control,
    /// Stage proof.
    pub proof: Proof,
}

/// Writes the three files and returns `commission.json`.
///
/// # Errors
/// [`CommissionError`] if something cannot be said or written.
pub fn write(
    dossier: &Dossier,
    known: &Known,
    found: &Found,
    bed: &Bed,
    wanted: &Wanted,
) -> Result<String, CommissionError> {
    let document = json!({
        "format": "frictionlab-commission",
        "format_version": 1,
        "program_version": env!("CARGO_PKG_VERSION"),
        "wanted": wanted.to_string(),
        "found": found,
    });
    let document = format!("{document:#}\n");
    let folder = dossier.folder().display().to_string();
    let page = report::linked(
        page::page(found, known, wanted, &folder),
        [PARAMETERS, Stage::HandOver.file()],
    );
    let files = [
        (PARAMETERS, parameters::render(known, found, bed)?),
        (REPORT, report::render_page(&page)),
        (Stage::HandOver.file(), document.clone()),
    ];
    write_all(dossier.folder(), &files)?;
    Ok(document)
}
