//! `frictionlab export`: identified friction for simulators, robots and firmware.

use std::path::PathBuf;

use studies::export::asked::ExportOptions;
use studies::export::list;
use work::BadInput;
use work::destination::Force;
use work::saying::print;

/// Write identified friction for simulators and firmware
///
/// PARAMETERS is a parameters.yaml of `identify` or `run`. The file that is written names its
/// source, the target's version, what the target cannot hold, and the torque error that this costs
/// over the speeds of the recordings: the identified model and the target's are played along the
/// same motion.
///
///   frictionlab export runs/identify-1/parameters.yaml --to mjcf --joint elbow --out elbow.xml
///   frictionlab export runs/identify-1/parameters.yaml --to mjcf --target-version 3.8
///   frictionlab export --list
///
/// What would mislead is refused: an rms error of more than 10 % of the Coulomb level in steady
/// sliding or 50 % along swings, parameters that were never identified, friction that drives, and
/// friction in volts where a torque is needed.
#[derive(Debug, clap::Args)]
#[command(verbatim_doc_comment)]
pub struct ExportArgs {
    /// The parameters that were identified.
    #[arg(value_name = "PARAMETERS", required_unless_present = "list")]
    parameters: Option<PathBuf>,

    #[command(flatten)]
    options: ExportOptions,

    /// Where the file goes; - is standard output.
    #[arg(long, value_name = "FILE", default_value = "-")]
    out: PathBuf,

    #[command(flatten)]
    force: Force,

    /// Print nothing but the file and errors.
    #[arg(long)]
    quiet: bool,
}

/// Writes it.
///
/// # Errors
/// [`BadInput`] for a file that cannot be read or exported; nothing is written then.
pub fn execute(args: &ExportArgs) -> anyhow::Result<()> {
    if args.options.list {
        return print(&list());
    }
    let Some(path) = &args.parameters else {
        // The command line asks for it.
        return Err(BadInput("PARAMETERS is missing".to_owned()).into());
    };
    let name = path.display().to_string();
    let text = files::input::text(path).map_err(|error| BadInput(format!("{name}: {error}")))?;
    let exported = args.options.export(&name, &text)?;
    let same = matches!((args.out.canonicalize(), path.canonicalize()), (Ok(a), Ok(b)) if a == b);
    if same {
        let why = format!("--out {name} is the file that is read; the result needs another");
        return Err(BadInput(why).into());
    }
    let out = args.force.file(&args.out)?;
    out.write(exported.text.as_bytes())?;
    if args.quiet {
        return Ok(());
    }
    let cost = &exported.cost;
    let said = format!(
        "{} written to {}: rms error {:.2} % of the Coulomb level in steady sliding, {:.2} % along swings\n",
        exported.target.facts().title,
        out.name(),
        cost.percent(cost.sliding.rms),
        cost.percent(cost.swings.rms),
    );
    // Standard output has the file and nothing else.
    if out.is_stdout() {
        eprint!("{said}");
        return Ok(());
    }
    print(&said)
}
