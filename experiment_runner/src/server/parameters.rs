//! Parameters of the node `experiment_runner`, which are the options of `frictionlab serve` too.

use std::path::PathBuf;

use ::parameters::parameters;
use rig_driver::registry::AddressError;
use rig_setup::RigChoice;

use super::permissions::{self, Permissions};

parameters! {
    /// Parameters of the node `experiment_runner`.
    #[derive(Debug, Clone, PartialEq)]
    pub struct RunnerParameters {
        runs: String = "runs".to_owned(),
            "Folder in which each run gets a folder of its own, unless its request names one",
            more("files that requests name are read there"), read_only();
        inputs: String = String::new(),
            "One more folder whose files requests may name: protocols, parameters, recordings",
            more("none if empty"), read_only();
        allow_rigs: String = "simulated,nodes".to_owned(),
            "Rigs that requests may use, separated by commas, beside the one that `rig` names at the start",
            more("`nodes` are those of this axis"), read_only();
        rig: String = "simulated".to_owned(),
            "Rig of experiments whose request names none", among(RigChoice::grammar);
        autostart: bool = true, "Configure and activate when the program starts", read_only();
    }
}

impl RunnerParameters {
    /// The rig of experiments whose request names none.
    ///
    /// # Errors
    /// [`AddressError`] says what is no rig, and which there are.
    pub fn rig(&self) -> Result<RigChoice, AddressError> {
        self.rig.parse()
    }

    /// What requests to the runner of `axis` may use.
    ///
    /// # Errors
    /// [`AddressError`] says what is no rig, and which there are.
    pub fn permissions(&self, axis: &str) -> Result<Permissions, AddressError> {
        let mut rigs = permissions::rigs(&self.allow_rigs)?;
        rigs.push(self.rig()?);
        let inputs = Some(&self.inputs).filter(|folder| !folder.is_empty()).map(PathBuf::from);
        Ok(Permissions::new(axis, rigs, PathBuf::from(&self.runs), inputs))
    }
}
