//! Which rig profile a command uses, and what of it.
//!
//! A profile never chooses a real rig by lying there: only `--rig-file` or `--rig` do. The one in
//! the current folder is used where `--rig` names the rig that it is of.

use std::ffi::OsStr;
use std::io;
use std::path::{Path, PathBuf};

use clap::builder::{PossibleValue, TypedValueParser};
use clap::{Arg, Command};
use friction_model::{Motor, TorqueSource};
use rig_driver::RigRegistry;

use crate::run::{Origin, Origins};
use rig_setup::{PROFILE, RigChoice, RigLimits, RigProfile};
use work::BadInput;

/// The rig of a command and the profile that counts for it.
#[derive(Debug, Clone, PartialEq)]
pub struct Chosen {
    /// The rig.
    pub rig: RigChoice,
    /// The profile and its file, where one counts.
    pub profile: Option<(PathBuf, RigProfile)>,
    /// What to say about it, in a line.
    pub note: Option<String>,
}

/// The rig of `--rig` and `--rig-file`: what is given counts over the profile's own address, and
/// without either the rig is the simulated one.
///
/// # Errors
/// [`BadInput`] for a profile that cannot be read; none of it counts then.
pub fn choose(rig: Option<&RigChoice>, file: Option<&Path>) -> Result<Chosen, BadInput> {
    choose_beside(rig, file, Path::new(PROFILE))
}

/// The same, with the profile that is found by default.
fn choose_beside(
    rig: Option<&RigChoice>,
    file: Option<&Path>,
    default: &Path,
) -> Result<Chosen, BadInput> {
    let here = || default.is_file().then(|| default.display());
    let Some(file) = file else {
        return match rig {
            Some(rig) if rig.is_opened() && default.is_file() => {
                let profile = read(default)?;
                let used = profile.rig == *rig;
                let note = if used {
                    format!("rig profile {}: {}", default.display(), profile.parts())
                } else {
                    format!(
                        "the rig profile {} is of {} and is not used for {rig}",
                        default.display(),
                        profile.rig
                    )
                };
                let profile = used.then(|| (default.to_owned(), profile));
                Ok(Chosen { rig: rig.clone(), profile, note: Some(note) })
            }
            Some(rig) => Ok(Chosen { rig: rig.clone(), profile: None, note: None }),
            None => Ok(Chosen {
                rig: RigChoice::Simulated,
                profile: None,
                note: here().map(|file| {
                    format!("the rig is the simulated one; --rig-file {file} drives the rig of that profile")
                }),
            }),
        };
    };
    let profile = read(file)?;
    let rig = rig.cloned().unwrap_or_else(|| profile.rig.clone());
    let note = match (rig == profile.rig, rig.is_opened()) {
        (true, true) => format!("rig profile {}: {rig}, {}", file.display(), profile.parts()),
        (false, true) => format!(
            "rig profile {}: {}, though it is of {} and --rig says {rig}",
            file.display(),
            profile.parts(),
            profile.rig
        ),
        (_, false) => format!(
            "rig profile {}: {rig} takes {} from it",
            file.display(),
            if profile.drive.is_some() { "its drive" } else { "nothing" }
        ),
    };
    Ok(Chosen { rig, profile: Some((file.to_owned(), profile)), note: Some(note) })
}

/// Reads a rig of the command line; for completions it tells how addresses begin.
#[derive(Debug, Clone, Copy)]
pub struct RigParser;

impl TypedValueParser for RigParser {
    type Value = RigChoice;

    fn parse_ref(
        &self,
        command: &Command,
        option: Option<&Arg>,
        value: &OsStr,
    ) -> Result<RigChoice, clap::Error> {
        TypedValueParser::parse_ref(&str::parse::<RigChoice>, command, option, value)
    }

    fn possible_values(&self) -> Option<Box<dyn Iterator<Item = PossibleValue> + '_>> {
        let kinds = RigRegistry::installed()
            .factories()
            .map(|factory| PossibleValue::new(factory.name()).help(factory.about()));
        let nodes = PossibleValue::new("nodes").help("the rig of running ROS 2 nodes");
        Some(Box::new(kinds.chain([nodes])))
    }
}

/// Reads a profile.
///
/// # Errors
/// [`BadInput`] with the file and what is wrong in it.
pub fn read(file: &Path) -> Result<RigProfile, BadInput> {
    let say = |what: String| {
        BadInput(format!(
            "the rig profile {} cannot be used, and nothing of it is: {what}",
            file.display()
        ))
    };
    let text = files::input::text(file).map_err(|error| match error.kind() {
        io::ErrorKind::NotFound => {
            say("there is no such file; `frictionlab rig check --rig serial:PORT --rig-file FILE` writes one"
                .to_owned())
        }
        _ => say(error.to_string()),
    })?;
    RigProfile::read(&text).map_err(|error| say(error.to_string()))
}

impl Chosen {
    /// The profile.
    pub fn profile(&self) -> Option<&RigProfile> {
        self.profile.as_ref().map(|(_, profile)| profile)
    }

    /// The profile of a real rig that is opened here: calibration, limits and sensors count there
    /// only.
    pub fn of_real(&self) -> Option<&RigProfile> {
        self.profile().filter(|_| self.rig.is_opened())
    }

    /// The limits: the profile's, with the voltage limit that was `asked` for.
    pub fn limits(&self, asked: Option<f64>) -> RigLimits {
        let limits = self.of_real().map(|profile| profile.limits).unwrap_or_default();
        RigLimits { voltage: asked.or(limits.voltage), ..limits }
    }

    /// The motor's constants of the profile's drive.
    pub fn motor(&self) -> Option<Motor> {
        self.profile()?.drive?.motor()
    }

    /// The profile as the origin of what is taken from it.
    fn origin(&self) -> Option<Origin> {
        self.profile.as_ref().map(|(file, _)| Origin::File { file: file.display().to_string() })
    }

    /// Says that the drive is the profile's, where it is.
    pub fn drive_origin(&self, origins: &mut Origins) {
        if let Some(origin) = self.origin().filter(|_| self.motor().is_some()) {
            origins.set("rig_driver.drive", origin);
        }
    }

    /// Says that the voltage limit is the profile's, where it is.
    pub fn limit_origin(&self, origins: &mut Origins) {
        if let Some(origin) = self.origin().filter(|_| self.limits(None).voltage.is_some()) {
            origins.set("rig_driver.voltage_limit", origin);
        }
    }

    /// Where the friction torque comes from on a rig without a torque sensor.
    pub fn torque_source(&self) -> Option<TorqueSource> {
        let sensors = self.of_real()?.sensors.filter(|sensors| !sensors.torque)?;
        Some(if sensors.current { TorqueSource::Current } else { TorqueSource::Voltage })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rig(text: &str) -> RigChoice {
        text.parse().unwrap()
    }

    #[test]
    fn a_profile_that_lies_there_never_chooses_a_rig() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("rig.yaml");
        let choose =
            |rig: Option<&RigChoice>, given: Option<&Path>| choose_beside(rig, given, &file);
        assert_eq!(choose(None, None).unwrap().note, None);
        std::fs::write(&file, RigProfile::new(rig("serial:/dev/a")).text()).unwrap();

        let bare = choose(None, None).unwrap();
        assert_eq!((bare.rig.clone(), bare.profile()), (RigChoice::Simulated, None));
        assert!(bare.note.unwrap().contains("simulated"));
        let same = choose(Some(&rig("serial:/dev/a")), None).unwrap();
        assert!(same.of_real().is_some());
        let other = choose(Some(&rig("serial:/dev/b")), None).unwrap();
        assert_eq!((other.rig.clone(), other.profile()), (rig("serial:/dev/b"), None));
        assert!(other.note.unwrap().contains("not used"));
        let told = choose(None, Some(&file)).unwrap();
        assert_eq!(told.rig, rig("serial:/dev/a"));
        let both = choose(Some(&rig("serial:/dev/b")), Some(&file)).unwrap();
        assert!(both.rig == rig("serial:/dev/b") && both.of_real().is_some());
        let simulated = choose(Some(&RigChoice::Simulated), Some(&file)).unwrap();
        assert!(simulated.rig == RigChoice::Simulated && simulated.of_real().is_none());
    }

    #[test]
    fn a_profile_that_cannot_be_read_stops_who_would_use_it_and_nobody_else() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("rig.yaml");
        std::fs::write(&file, "rig: serial:/dev/a\ncolour: red\n").unwrap();
        let said = choose_beside(Some(&rig("serial:/dev/a")), None, &file).unwrap_err().to_string();
        assert!(said.contains("colour") && said.contains("rig.yaml"), "{said}");
        assert!(choose_beside(None, Some(&file), &file).is_err());
        assert!(choose_beside(None, None, &file).is_ok());
        let said =
            choose_beside(None, Some(Path::new("nowhere.yaml")), &file).unwrap_err().to_string();
        assert!(said.contains("rig check"), "{said}");
    }
}
