//! `frictionlab protocols`: the experiments as files.

use experiment_runner::experiments;
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
    let known = experiments::all();
    let protocols: Vec<_> =
        known.iter().filter_map(|one| Some((one.name(), one.about(), one.protocol()?))).collect();
    let Some(name) = &args.name else {
        if args.json {
            let one = |(name, what, _): &_| serde_json::json!({"name": name, "what": what});
            let protocols: Vec<_> = protocols.iter().map(one).collect();
            let list = serde_json::json!({"format": "frictionlab-protocols", "format_version": 1, "protocols": protocols});
            return print(&format!("{list:#}\n"));
        }
        let line = |(name, what, _): &_| format!("{name:<18} {what}\n");
        return print(&protocols.iter().map(line).collect::<String>());
    };
    match protocols.iter().find(|protocol| protocol.0 == name) {
        Some((_, _, text)) => print(text),
        None => {
            let names: Vec<_> = protocols.iter().map(|protocol| protocol.0).collect();
            let meant = did_you_mean(name, names.iter().copied());
            let names = names.join(", ");
            Err(BadInput(format!("there is no protocol `{name}`; expected one of {names}{meant}"))
                .into())
        }
    }
}
