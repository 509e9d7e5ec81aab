//! Parameters of the node `experiment_runner`.

use ::parameters::parameters;

parameters! {
    /// Parameters of the node `experiment_runner`.
    #[derive(Debug, Clone, PartialEq)]
    pub struct RunnerParameters {
        runs: String = "runs".to_owned(), "Folder in which each run gets a folder of its own",
            more("files that requests name are read there"), read_only();
        inputs: String = String::new(),
            "One more folder whose files requests may name: protocols, parameters, recordings",
            more("none if empty"), read_only();
        allow_rigs: String = "simulated,nodes".to_owned(),
            "Rigs that requests may use, separated by commas, beside the one that `rig` names at the start",
            more("`nodes` are those of this axis"), read_only();
        rig: String = "simulated".to_owned(),
            "Rig of experiments whose request names none: `nodes` for the one that this axis's nodes drive, `simulated` for one of their own, or what `frictionlab run --rig` takes";
        autostart: bool = true, "Configure and activate when the program starts", read_only();
    }
}
