//! `frictionlab features`: what tells friction models apart.

use std::thread;

use anyhow::Context;
use friction_model::ModelName;

use crate::interruption;
use report::{linked, render_page};
use studies::features::{FeaturesOptions, compute, page, summary};
use work::Interrupted;
use work::destination::ToFolder;
use work::model_name::model_name;
use work::progress::Progress;
use work::saying::Saying;

/// Draw what tells friction models apart, in one report
///
/// For each model: stick-slip, drift, hysteresis and its memory, breakaway against force rate,
/// frictional lag, steady sliding, reversal, sensitivity to each parameter, and the describing
/// function. Then the thesis's position loop that hunts, simulated and predicted. Parameters are
/// those of the thesis's chapter 3; steps are halved until the figures hold to 1e-4, or no longer
/// settle: the report shows the last change.
///
///   frictionlab features
///   frictionlab features --model lugre,gms,proposed --out runs/three
#[derive(Debug, clap::Args)]
#[command(verbatim_doc_comment)]
pub struct FeaturesArgs {
    /// Models, separated by commas [default: all]; `frictionlab models` lists them.
    #[arg(long, value_delimiter = ',', value_parser = model_name, value_name = "NAMES")]
    model: Vec<ModelName>,

    #[command(flatten)]
    to: ToFolder,

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
/// [`OutputError`](files::OutputError) if the folder cannot be written, [`Interrupted`]
/// after ctrl-C.
pub fn execute(args: &FeaturesArgs) -> anyhow::Result<()> {
    let chosen = |name: &ModelName| args.model.is_empty() || args.model.contains(name);
    let models: Vec<ModelName> = ModelName::ALL.into_iter().filter(chosen).collect();
    let workers = args
        .jobs
        .map_or_else(|| thread::available_parallelism().map_or(1, usize::from), usize::from);
    let folder = args.to.reserve("features")?;
    let cancel = interruption::watch(interruption::WRITING)?;

    args.saying.begin();
    let progress = Progress::counting(models.len() as u64 + 1, "models", args.quiet);
    let outcome = compute(&FeaturesOptions { models, workers }, &progress, &cancel);
    progress.finish();
    let Some(results) = outcome? else {
        return Err(Interrupted("stopped before the end; nothing was written".to_owned()).into());
    };
    let json = serde_json::to_string(&results).context("cannot describe the results")?;
    folder.write(&[
        ("report.html", render_page(&linked(page(&results), ["features.json"]))),
        ("features.json", json.clone()),
    ])?;
    let text = format!("{}\nReport  {}\n", summary(&results), folder.join("report.html").display());
    args.saying.result(args.quiet, &json, &text)
}
