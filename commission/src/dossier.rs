//! The folder of a commission: whose it is, and what each stage found.
//!
//! Each result is a JSON file that appears whole or not at all.

use std::fs;
use std::path::{Path, PathBuf};

use files::{OutputError, input, write_all};
use rig_driver::safety::Travel;
use rig_setup::{RigDescription, RigLimits};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use crate::friction::Underway;
use crate::{CommissionError, Stage, travel};

/// File that says whose folder it is.
const IDENTITY: &str = "rig.json";
/// File that keeps the blocks of a friction stage that goes on.
const UNDERWAY: &str = "friction-blocks.json";

/// File that keeps the travel, by the rig's own count.
const TRAVEL: &str = "travel.json";

/// Whose folder it is.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Identity {
    /// Address of the rig, as on the command line.
    pub rig: String,
    /// What the device says of itself.
    pub description: Option<RigDescription>,
    /// What was set for it.
    pub limits: RigLimits,
    /// What a simulated rig is made of; none of a real one.
    pub simulated: Option<Simulated>,
}

/// What a simulated rig is made of.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Simulated {
    /// Its friction model.
    pub plant: String,
    /// Seed of its noise.
    pub seed: u64,
    /// Mistakes in its wiring, as they were given.
    pub miswired: Option<String>,
}

/// The folder.
#[derive(Debug, Clone)]
pub struct Dossier {
    folder: PathBuf,
}

/// A result in its file.
#[derive(Debug, Serialize, Deserialize)]
struct Kept<T> {
    stage: Stage,
    /// Rig time of the stage \[s\].
    seconds: f64,
    found: T,
}

impl Dossier {
    /// A new folder, which is of that rig from now on.
    ///
    /// # Errors
    /// [`CommissionError::Output`].
    pub fn begin(folder: &Path, identity: &Identity) -> Result<Self, CommissionError> {
        let dossier = Self { folder: folder.to_owned() };
        dossier.write(IDENTITY, identity)?;
        Ok(dossier)
    }

    /// A folder of before, and whose it is.
    ///
    /// # Errors
    /// [`CommissionError::Asked`] for a folder that is none of a commission.
    pub fn open(folder: &Path) -> Result<(Self, Identity), CommissionError> {
        let dossier = Self { folder: folder.to_owned() };
        let identity = dossier.read(IDENTITY)?.ok_or_else(|| {
            CommissionError::Asked(format!(
                "{} is no folder of a commission: {IDENTITY} is missing; `frictionlab commission` without --resume begins one",
                folder.display()
            ))
        })?;
        Ok((dossier, identity))
    }

    /// Where it is.
    #[must_use]
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// What a stage found, and the rig time that it took \[s\]; none where it is still to be done.
    ///
    /// # Errors
    /// [`CommissionError::Asked`] for a file that is not what it should be.
    pub fn found<T: DeserializeOwned>(
        &self,
        stage: Stage,
    ) -> Result<Option<(T, f64)>, CommissionError> {
        let kept: Option<Kept<T>> = self.read(stage.file())?;
        Ok(kept.map(|kept| (kept.found, kept.seconds)))
    }

    /// Keeps what a stage found.
    ///
    /// # Errors
    /// [`CommissionError::Output`].
    pub fn keep<T: Serialize>(
        &self,
        stage: Stage,
        seconds: f64,
        found: &T,
    ) -> Result<(), CommissionError> {
        self.write(stage.file(), &Kept { stage, seconds, found })
    }

    /// The blocks of a friction stage that was stopped, and the rig time they took \[s\].
    ///
    /// # Errors
    /// As for [`found`](Self::found).
    pub fn underway(&self) -> Result<(Underway, f64), CommissionError> {
        let kept: Option<Kept<Underway>> = self.read(UNDERWAY)?;
        Ok(kept.map_or_else(Default::default, |kept| (kept.found, kept.seconds)))
    }

    /// Keeps the blocks of a friction stage that goes on.
    ///
    /// # Errors
    /// [`CommissionError::Output`].
    pub fn keep_underway(&self, blocks: &Underway, seconds: f64) -> Result<(), CommissionError> {
        self.write(UNDERWAY, &Kept { stage: Stage::Friction, seconds, found: blocks })
    }

    /// The travel that is kept.
    ///
    /// # Errors
    /// As for [`found`](Self::found).
    pub fn travel(&self) -> Result<Option<travel::Kept>, CommissionError> {
        self.read(TRAVEL)
    }

    /// Keeps a travel, counted now by a device that was `switched_on` then, in the place of the one
    /// before; none where it has no ends.
    ///
    /// # Errors
    /// [`CommissionError::Output`].
    pub fn keep_travel(
        &self,
        travel: Option<Travel>,
        switched_on: Option<f64>,
    ) -> Result<(), CommissionError> {
        match travel {
            Some(travel) => self.write(TRAVEL, &travel::Kept::now(travel, switched_on)),
            None => self.forget(TRAVEL),
        }
    }

    /// Which stages are done, in order, up to the first that is not.
    #[must_use]
    pub fn done(&self) -> Vec<Stage> {
        let there = |stage: &Stage| self.folder.join(stage.file()).is_file();
        Stage::ALL.iter().copied().take_while(there).collect()
    }

    /// Forgets a stage and all behind it, which stand on it: they are measured anew.
    ///
    /// # Errors
    /// [`CommissionError::Asked`] where a stage before it is not done;
    /// [`CommissionError::Output`].
    pub fn forget_from(&self, stage: Stage) -> Result<(), CommissionError> {
        let done = self.done();
        if let Some(missing) =
            Stage::ALL.iter().find(|before| **before < stage && !done.contains(before))
        {
            return Err(CommissionError::Asked(format!(
                "--from {stage} needs what the stage {missing} found, and {} does not have it; --from {missing}, or no --from, begins there",
                self.folder.display()
            )));
        }
        // The last first: what is left is a commission at any moment.
        let files = Stage::ALL.iter().rev().filter(|later| **later >= stage).map(|s| s.file());
        let blocks = (stage <= Stage::Friction).then_some(UNDERWAY);
        files.chain(blocks).try_for_each(|file| self.forget(file))
    }

    fn forget(&self, name: &str) -> Result<(), CommissionError> {
        let path = self.folder.join(name);
        match fs::remove_file(&path) {
            Err(source) if source.kind() != std::io::ErrorKind::NotFound => {
                Err(OutputError::Write { path, source }.into())
            }
            _ => Ok(()),
        }
    }

    fn write(&self, name: &str, content: &impl Serialize) -> Result<(), CommissionError> {
        let text = serde_json::to_string_pretty(content).map_err(|error| {
            CommissionError::Asked(format!("{name} cannot be written as JSON: {error}"))
        })?;
        Ok(write_all(&self.folder, &[(name, text + "\n")])?)
    }

    fn read<T: DeserializeOwned>(&self, name: &str) -> Result<Option<T>, CommissionError> {
        let path = self.folder.join(name);
        let bad = |why: String| {
            CommissionError::Asked(format!(
                "{} cannot be used: {why}; `--from` a stage before it measures it anew",
                path.display()
            ))
        };
        match input::text(&path) {
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(None),
            Err(error) => Err(bad(error.to_string())),
            Ok(text) => {
                serde_json::from_str(&text).map(Some).map_err(|error| bad(error.to_string()))
            }
        }
    }
}

impl Identity {
    /// Refuses a rig that is another one than the folder's.
    ///
    /// # Errors
    /// [`CommissionError::Asked`] says in what it differs.
    pub fn require(&self, asked: &Self, folder: &Path) -> Result<(), CommissionError> {
        let described = self.description.as_ref().zip(asked.description.as_ref());
        let other = described.and_then(|(before, now)| before.differs_from(now));
        let what = if self.rig != asked.rig {
            Some(format!("it is of the rig {}, not of {}", self.rig, asked.rig))
        } else if self.simulated != asked.simulated {
            Some("the simulated rig has another friction, seed or wiring".to_owned())
        } else if self.limits != asked.limits {
            Some("the limits that are set for the rig are others".to_owned())
        } else {
            other.map(|what| format!("another device answers: {what}"))
        };
        what.map_or(Ok(()), |what| {
            Err(CommissionError::Asked(format!(
                "the commission in {} cannot go on with this rig: {what}. Nothing has moved. Name the rig it is of, or begin a new commission with --out",
                folder.display()
            )))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn identity() -> Identity {
        let simulated = Simulated { plant: "proposed".to_owned(), seed: 1, miswired: None };
        Identity {
            rig: "simulated".to_owned(),
            description: None,
            limits: RigLimits::default(),
            simulated: Some(simulated),
        }
    }

    #[test]
    fn results_are_kept_in_order_and_forgotten_from_a_stage_on() {
        let folder = tempfile::tempdir().unwrap();
        let dossier = Dossier::begin(folder.path(), &identity()).unwrap();
        for stage in [Stage::Meet, Stage::Drive, Stage::Friction] {
            dossier.keep(stage, 2.0, &stage.to_string()).unwrap();
        }
        assert_eq!(dossier.done(), [Stage::Meet, Stage::Drive, Stage::Friction]);
        assert_eq!(dossier.found(Stage::Drive).unwrap(), Some(("drive".to_owned(), 2.0)));
        let said = dossier.forget_from(Stage::Control).unwrap_err().to_string();
        assert!(said.contains("--from model"), "{said}");
        dossier.forget_from(Stage::Drive).unwrap();
        assert_eq!(dossier.done(), [Stage::Meet]);
        assert_eq!(Dossier::open(folder.path()).unwrap().1, identity());
    }

    #[test]
    fn another_rig_a_broken_file_and_a_folder_of_something_else_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        assert!(Dossier::open(folder.path()).unwrap_err().is_bad_input());
        let dossier = Dossier::begin(folder.path(), &identity()).unwrap();
        let other = Identity { rig: "serial:/dev/a".to_owned(), ..identity() };
        let said = identity().require(&other, folder.path()).unwrap_err().to_string();
        assert!(said.contains("serial:/dev/a") && said.contains("--out"), "{said}");
        assert!(identity().require(&identity(), folder.path()).is_ok());
        fs::write(folder.path().join("meet.json"), "{").unwrap();
        assert!(dossier.found::<String>(Stage::Meet).unwrap_err().is_bad_input());
    }
}
