//! `frictionlab protocols`: the experiments as files.

use experiment_runner::protocol::Kind;
use work::BadInput;
use work::saying::print;
use work::suggestion::did_you_mean;

/// List the experiments' protocols, or print one to edit
///
/// A protocol is a YAML file that says what an experiment drives, in quantities with units. Print
/// one, change it, drive it: `frictionlab protocols pre-sliding > mine.yaml`, then
/// `frictionlab run --protocol mine.yaml`. What is printed is what runs without a file. `sequence`
/// is an example of an experiment of your own.
#[derive(Debug, clap::Args)]
pub struct ProtocolsArgs {
    /// The protocol to print
    #[arg(value_name = "NAME")]
    name: Option<String>,
    /// Print the list as JSON for programs (docs/reference/json.md)
    #[arg(long, conflicts_with = "name")]
    json: bool,
}

/// Prints it.
///
/// # Errors
/// [`BadInput`] for a name that there is not.
pub fn execute(args: &ProtocolsArgs) -> anyhow::Result<()> {
    let Some(name) = &args.name else {
        if args.json {
            let one =
                |kind: Kind| serde_json::json!({"name": kind.name(), "what": kind.describe()});
            let protocols = Kind::ALL.map(one);
            let list = serde_json::json!({"format": "frictionlab-protocols", "format_version": 1, "protocols": protocols});
            return print(&format!("{list:#}\n"));
        }
        let line = |kind: Kind| format!("{:<18} {}\n", kind.name(), kind.describe());
        return print(&Kind::ALL.map(line).concat());
    };
    match Kind::ALL.into_iter().find(|kind| kind.name() == name) {
        Some(kind) => print(kind.text()),
        None => {
            let names = Kind::ALL.map(Kind::name).join(", ");
            let meant = did_you_mean(name, Kind::ALL.map(Kind::name));
            Err(BadInput(format!("there is no protocol `{name}`; expected one of {names}{meant}"))
                .into())
        }
    }
}
