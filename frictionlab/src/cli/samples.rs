//! `frictionlab samples`: parameters drawn together, for domain randomisation.

use std::path::PathBuf;

use friction_model::ModelName;
use identification::posterior::{Table, samples, table};
use work::BadInput;
use work::destination::Force;
use work::model_name::model_name;

use super::compare::read;

/// Draw parameters as likely as the recordings leave them
///
/// FILE is the identification.json of `identify`, or the folder that holds it. Each sample is a set of
/// parameters that belong together: with the correlations of the fit, and with 95 % of each parameter
/// within the interval of the report. mjlab and isaac-lab are event terms in Python that give every
/// environment one of the sets.
///
///   frictionlab samples runs/identify-1 --count 1000 --out samples.csv
///   frictionlab samples runs/identify-1 --to isaac-lab --joint elbow --out elbow_friction.py
#[derive(Debug, clap::Args)]
#[command(verbatim_doc_comment)]
pub struct SamplesArgs {
    /// The identification.
    #[arg(value_name = "FILE")]
    file: PathBuf,

    /// The model [default: the one that the identification chooses].
    #[arg(long, value_name = "NAME", value_parser = model_name)]
    model: Option<ModelName>,

    /// Samples.
    #[arg(long, value_name = "N", default_value_t = 1000, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    count: u32,

    /// The same seed gives the same samples.
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,

    /// What is written.
    #[arg(long, value_enum, value_name = "TABLE", default_value = "csv")]
    to: Table,

    /// The joint's name in the simulator.
    #[arg(long, value_name = "NAME", default_value = "joint")]
    joint: String,

    /// Where the table goes; - is standard output.
    #[arg(long, value_name = "FILE", default_value = "-")]
    out: PathBuf,

    #[command(flatten)]
    force: Force,

    /// Print nothing but the table and errors.
    #[arg(long)]
    quiet: bool,
}

/// Draws and writes.
///
/// # Errors
/// [`BadInput`] for what is no identification of friction, or leaves nothing to draw.
pub fn execute(args: &SamplesArgs) -> anyhow::Result<()> {
    let report = read(&args.file)?;
    let drawn = samples(report.model(args.model)?, args.count as usize, args.seed)?;
    let text = table(&drawn, args.to, &report.name, &args.joint)?;
    let same =
        matches!((args.out.canonicalize(), args.file.canonicalize()), (Ok(a), Ok(b)) if a == b);
    if same {
        let why =
            format!("--out {} is the file that is read; the result needs another", report.name);
        return Err(BadInput(why).into());
    }
    let out = args.force.file(&args.out)?;
    out.write(text.as_bytes())?;
    if !args.quiet {
        let (count, title, to) = (args.count, drawn.model.title(), out.name());
        eprintln!("{count} samples of {title} written to {to}");
        drawn.notes.iter().for_each(|note| eprintln!("{note}"));
    }
    Ok(())
}
