//! `frictionlab compare`: do two identifications differ?

use std::path::{Path, PathBuf};

use friction_model::ModelName;
use identification::posterior::{Report, compare};
use work::BadInput;
use work::model_name::model_name;
use work::saying::{Saying, document};

/// Tell whether two identifications differ
///
/// A and B are the identification.json of `identify`, or the folders that hold it: of one joint before
/// and after, of two joints of a kind, of two rigs. The answer takes the errors of both into account:
/// parameter by parameter, and as the friction in steady sliding over the speeds of both. Two reports
/// of the same joint are called different in 5 % of the cases.
///
///   frictionlab compare runs/identify-1 runs/identify-2
///   frictionlab compare new.json old.json --model lugre --speeds 0.05:2 --json
#[derive(Debug, clap::Args)]
#[command(verbatim_doc_comment)]
pub struct CompareArgs {
    /// The first identification.
    #[arg(value_name = "A")]
    first: PathBuf,

    /// The second.
    #[arg(value_name = "B")]
    second: PathBuf,

    /// The model to compare [default: the one that A chooses].
    #[arg(long, value_name = "NAME", value_parser = model_name)]
    model: Option<ModelName>,

    /// Speeds at which the friction is compared [rad/s or m/s] [default: those of both].
    #[arg(long, value_name = "LOW:HIGH", value_parser = speeds, allow_negative_numbers = true)]
    speeds: Option<[f64; 2]>,

    /// Seed of the samples.
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,

    /// Print nothing but errors.
    #[arg(long)]
    quiet: bool,
    #[command(flatten)]
    saying: Saying,
}

/// Compares and prints the answer.
///
/// # Errors
/// [`BadInput`] for files that hold no identifications of friction with something in common.
pub fn execute(args: &CompareArgs) -> anyhow::Result<()> {
    args.saying.begin();
    let [first, second] = [&args.first, &args.second].map(|path| read(path));
    let found = compare([&first?, &second?], args.model, args.speeds, args.seed)?;
    args.saying.result(args.quiet, &document(&found)?, &found.terminal())
}

/// The identification in a file or in a folder.
pub(super) fn read(path: &Path) -> Result<Report, BadInput> {
    let file = if path.is_dir() { path.join("identification.json") } else { path.to_owned() };
    let name = path.display().to_string();
    let text = files::input::text(&file).map_err(|error| BadInput(format!("{name} cannot be read: {error}; name the identification.json that `frictionlab identify` wrote")))?;
    Report::read(&name, &text)
}

fn speeds(text: &str) -> Result<[f64; 2], String> {
    let expected = || "expected two speeds with a colon between them, as in 0.05:2".to_owned();
    let (low, high) = text.split_once(':').ok_or_else(expected)?;
    let number = |text: &str| text.trim().parse().map_err(|_| expected());
    Ok([number(low)?, number(high)?])
}
