//! `frictionlab models`: which friction models there are, and their parameters.

use friction_model::ModelName;

use experiment_runner::models::{Preset, file, sheet};
use work::BadInput;
use work::model_name::model_name;
use work::saying::print;

/// List the friction models, or one model's parameters
///
/// Without a name: every model. With one: its parameters with their units for a rotary and for a
/// linear axis, their ranges, their values on the thesis's test bed and what they mean. With
/// --yaml: a parameter file for `frictionlab simulate` with these values.
#[derive(Debug, clap::Args)]
pub struct ModelsArgs {
    /// The model
    #[arg(value_name = "NAME", value_parser = model_name)]
    name: Option<ModelName>,
    /// The model, as other commands name it
    #[arg(long, value_name = "NAME", value_parser = model_name, conflicts_with = "name", hide = true)]
    model: Option<ModelName>,
    /// Print a parameter file in YAML
    #[arg(long)]
    yaml: bool,
    /// Print names and parameters as JSON for programs (docs/reference/json.md)
    #[arg(long, conflicts_with = "yaml")]
    json: bool,
    /// Whose values
    #[arg(long, value_enum, default_value_t)]
    set: Preset,
}

/// Prints it.
///
/// # Errors
/// [`BadInput`] for --yaml without a model.
pub fn execute(args: &ModelsArgs) -> anyhow::Result<()> {
    let one = args.name.or(args.model);
    if args.json {
        let names = one.map_or_else(|| ModelName::ALL.to_vec(), |name| vec![name]);
        return print(&format!("{:#}\n", sheet::document(&names, args.set)));
    }
    let text = match one {
        Some(name) if args.yaml => file::example(name, args.set),
        Some(name) => sheet::model(name, args.set),
        None if args.yaml => {
            let expected = "--yaml prints the parameter file of one model: say which, as in `frictionlab models lugre --yaml`";
            return Err(BadInput(expected.to_owned()).into());
        }
        None => sheet::list(),
    };
    print(&text)
}
