//! `frictionlab truth-matrix`: what a ranking of models is worth.

use std::thread;

use anyhow::Context;
use friction_ident::truth_matrix::MODELS;
use friction_model::ModelName;

use super::in_parts;
use crate::interruption;
use files::Folder;
use report::{linked, render_page};
use studies::truth_matrix::{Matrix, MatrixOptions, compute, page, summary};
use work::BadInput;
use work::Interrupted;
use work::destination::ToFolder;
use work::model_name::model_name;
use work::part::{self, InParts, Part};
use work::progress::Progress;
use work::saying::Saying;

/// Name of the command, of its folders and of its parts.
const WORK: &str = "truth-matrix";

/// See how far a ranking of models can be trusted
///
/// Identifies every model from the friction of every other. The model that made the data wins.
/// Before you trust a ranking of models on your own recordings, see here how far the second best is
/// behind when the truth is known: friction of each model is simulated through the experiments, all
/// models are identified from it, and the held-out errors make a matrix.
///
///   frictionlab truth-matrix
///   frictionlab truth-matrix --model lugre,gms,proposed --noise 0.0029 --seeds 10
#[derive(Debug, clap::Args)]
#[command(verbatim_doc_comment)]
pub struct TruthMatrixArgs {
    /// Models, separated by commas [default: the eight that can be identified].
    #[arg(long, value_delimiter = ',', value_parser = model_name, value_name = "NAMES")]
    model: Vec<ModelName>,

    /// Standard deviation of the friction's noise [N m].
    #[arg(long, value_name = "N_M", default_value_t = 1e-3, allow_negative_numbers = true)]
    noise: f64,

    /// How many noise seeds.
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..=1000))]
    seeds: u32,

    #[command(flatten)]
    to: ToFolder,

    #[command(flatten)]
    parts: InParts,

    /// Threads [default: all cores]; the results do not depend on it.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    jobs: Option<u16>,

    /// Print nothing but errors.
    #[arg(long)]
    quiet: bool,
    #[command(flatten)]
    saying: Saying,
}

/// Runs it.
///
/// # Errors
/// [`BadInput`] for a model that has no identification, an impossible noise, or a folder that
/// cannot be written; [`Interrupted`] after ctrl-C.
pub fn execute(args: &TruthMatrixArgs) -> anyhow::Result<()> {
    let models = if args.model.is_empty() { MODELS.to_vec() } else { args.model.clone() };
    if let Some(other) = models.iter().find(|name| !MODELS.contains(name)) {
        let known: Vec<_> = MODELS.iter().map(|name| name.as_str()).collect();
        return Err(BadInput(format!(
            "`{other}` cannot be identified in stages; expected some of {}",
            known.join(", ")
        ))
        .into());
    }
    if !(args.noise >= 0.0 && args.noise.is_finite()) {
        return Err(BadInput(format!(
            "--noise must be a finite number of N m, zero or more, but is {}",
            args.noise
        ))
        .into());
    }
    let workers = args
        .jobs
        .map_or_else(|| thread::available_parallelism().map_or(1, usize::from), usize::from);
    let options = MatrixOptions { models, noise: args.noise, seeds: args.seeds, workers };
    if let Some(parts) = &args.parts.join {
        let parts = part::read(parts, WORK)?;
        let matrix = options.join(&parts)?;
        wrote(args, &matrix, &args.to.reserve(WORK)?)?;
        return in_parts::joined(parts.lacking());
    }
    let pieces = args.parts.part.unwrap_or(Part::WHOLE).range(options.pieces());
    let folder = args.to.reserve(WORK)?;
    let cancel = interruption::watch(interruption::WRITING)?;
    args.saying.begin();
    let progress = Progress::counting(pieces.len() as u64, "truths and seeds", args.quiet);
    let matrix = compute(&options, pieces, &progress, &cancel);
    progress.finish();
    let matrix = matrix?;
    if let Some(part) = args.parts.part {
        if matrix.stopped {
            return Err(Interrupted(in_parts::STOPPED.to_owned()).into());
        }
        return in_parts::wrote(WORK, part, &matrix, (&folder, args.saying, args.quiet));
    }
    wrote(args, &matrix, &folder)?;
    if matrix.stopped {
        return Err(Interrupted(
            "stopped before the end; what was done by then is in the report".to_owned(),
        )
        .into());
    }
    Ok(())
}

/// Writes and prints a matrix.
fn wrote(args: &TruthMatrixArgs, matrix: &Matrix, folder: &Folder) -> anyhow::Result<()> {
    let json = serde_json::to_string_pretty(matrix).context("cannot describe the results")?;
    folder.write(&[
        ("report.html", render_page(&linked(page(matrix), ["truth-matrix.json"]))),
        ("truth-matrix.json", json.clone()),
    ])?;
    let text = format!("{}\nReport  {}\n", summary(matrix), folder.join("report.html").display());
    args.saying.result(args.quiet, &json, &text)
}
