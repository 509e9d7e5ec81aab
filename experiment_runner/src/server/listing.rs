//! Which experiments there are.

use std::path::PathBuf;

use clap::{Arg, Command};
use msgs::friction_msgs::{ExperimentDescription, ExperimentParameter};

use super::permissions::Permissions;
use super::request::{ExperimentRequest, NOT_OF_RUN, run_command};
use crate::errand::Errands;
use crate::experiments;
use crate::run::experiment::Selection;
use rig_setup::RigChoice;

/// Every experiment and what is offered beside them, with what each can be told and how long it
/// takes.
#[must_use]
pub fn descriptions(errands: &Errands) -> Vec<ExperimentDescription> {
    let parameters = parameters(&run_command(), &NOT_OF_RUN);
    let experiments = experiments::selections();
    let errands = errands.0.iter().map(|errand| ExperimentDescription {
        name: errand.name().to_owned(),
        description: errand.about().to_owned(),
        duration: errand.rig_seconds(),
        quick_duration: errand.rig_seconds(),
        parameters: self::parameters(&errand.command(), errand.reserved()),
    });
    experiments
        .iter()
        .map(|experiment| ExperimentDescription {
            name: experiment.as_str().to_owned(),
            description: experiment.about().to_owned(),
            duration: duration(experiment, false),
            quick_duration: duration(experiment, true),
            parameters: parameters.clone(),
        })
        .chain(errands)
        .collect()
}

/// Time the experiment takes in real time \[s\]; not a number where it needs a file that says so.
fn duration(experiment: &Selection, quick: bool) -> f64 {
    let quick =
        quick.then(|| msgs::friction_msgs::Setting { name: "quick".into(), value: String::new() });
    let request = ExperimentRequest {
        experiment: experiment.as_str().to_owned(),
        overrides: quick.into_iter().collect(),
        ..Default::default()
    };
    let permissions = Permissions::new("/", vec![RigChoice::Simulated], PathBuf::new(), None);
    request
        .options(&RigChoice::Simulated, &permissions)
        .map_or(f64::NAN, |options| options.rig_seconds())
}

fn parameters(command: &Command, reserved: &[&str]) -> Vec<ExperimentParameter> {
    let told = |arg: &&Arg| {
        !arg.is_hide_set() && arg.get_long().is_some_and(|long| !reserved.contains(&long))
    };
    command.get_arguments().filter(told).map(parameter).collect()
}

fn parameter(arg: &Arg) -> ExperimentParameter {
    let switch = !arg.get_action().takes_values();
    let default: Vec<_> =
        arg.get_default_values().iter().map(|value| value.to_string_lossy()).collect();
    ExperimentParameter {
        name: arg.get_long().unwrap_or_default().to_owned(),
        description: arg.get_help().map(ToString::to_string).unwrap_or_default(),
        default_value: if switch { "false".to_owned() } else { default.join(",") },
        choices: if switch {
            vec!["false".to_owned(), "true".to_owned()]
        } else if arg.is_hide_possible_values_set() {
            // How values begin is told to completions; they are not all that there are.
            Vec::new()
        } else {
            arg.get_possible_values().iter().map(|value| value.get_name().to_owned()).collect()
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_experiment_says_what_it_does_and_how_long_it_takes() {
        let listed = descriptions(&Errands::default());
        assert_eq!(listed.len(), experiments::selections().len());
        for experiment in &listed {
            assert!(!experiment.description.is_empty(), "{experiment:?}");
            if experiment.name != "sequence" {
                assert!(experiment.quick_duration > 0.0, "{}", experiment.name);
                assert!(experiment.duration >= experiment.quick_duration, "{}", experiment.name);
            }
        }
        let all = listed.iter().find(|experiment| experiment.name == "all").unwrap();
        // Seven hours of rig time: 24000 s at constant velocity, 15 runs of 58.7 s and 15 of 20 s.
        assert_eq!(all.duration, 24_000.0 + 15.0 * 58.7 + 15.0 * 20.0);
        let named =
            |name: &str| all.parameters.iter().find(|parameter| parameter.name == name).unwrap();
        assert_eq!(named("seed").default_value, "1");
        assert_eq!(named("quick").choices, ["false", "true"]);
        assert_eq!(named("record").choices, ["thinned", "full"]);
        assert!(all.parameters.iter().all(|parameter| !parameter.description.is_empty()));
        assert!(all.parameters.iter().all(|parameter| parameter.name != "out"));
    }
}
