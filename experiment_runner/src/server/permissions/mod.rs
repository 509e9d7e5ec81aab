//! What requests may use: which rigs, and which files. Whoever asks over the network is a stranger.

use std::fmt;
use std::fs;
use std::io;
use std::path::{Component, Path, PathBuf};

use super::Refusal;
use files::input::{LARGEST_TABLE, LARGEST_TEXT};
use rig_driver::registry::AddressError;
use rig_setup::RigChoice;

use crate::errand::Errands;
use crate::run::Beside;

/// Largest bag of a request, all its files together \[bytes\].
pub const LARGEST_BAG: u64 = 4 << 30;
/// Most folders below one another in the name of an output folder.
const DEEPEST: usize = 8;
/// Longest name of a file or folder in a request \[bytes\].
const LONGEST_NAME: usize = 1024;

/// What requests may use. It is given when the runner starts, and nobody changes it over the
/// network.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Permissions {
    /// Namespace of the axis.
    axis: String,
    rigs: Vec<RigChoice>,
    /// A rig with its profile.
    profile: Option<(RigChoice, PathBuf)>,
    runs: PathBuf,
    inputs: Option<PathBuf>,
    /// What the program has besides.
    beside: Beside,
    /// Work that it offers beside experiments.
    errands: Errands,
}

/// What a file is to a request.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Text,
    Recording,
}

impl fmt::Display for Kind {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        to.write_str(match self {
            Self::Text => "file",
            Self::Recording => "recording",
        })
    }
}

/// The rigs of a list such as `simulated,nodes,serial:/dev/ttyACM0`.
///
/// # Errors
/// [`AddressError`] says what is no rig, and which there are.
pub fn rigs(list: &str) -> Result<Vec<RigChoice>, AddressError> {
    list.split(',').map(str::trim).filter(|name| !name.is_empty()).map(str::parse).collect()
}

impl Permissions {
    /// Requests to the runner of `axis` may use these `rigs`, write in `runs`, and read there and
    /// in `inputs`.
    #[must_use]
    pub fn new(axis: &str, rigs: Vec<RigChoice>, runs: PathBuf, inputs: Option<PathBuf>) -> Self {
        let mut permissions = Self {
            axis: axis.to_owned(),
            rigs: Vec::new(),
            runs,
            inputs,
            profile: None,
            beside: Beside::default(),
            errands: Errands::default(),
        };
        permissions.rigs = rigs.into_iter().map(|rig| permissions.of_this_axis(rig)).collect();
        permissions
    }

    /// The same for a program that has this besides.
    #[must_use]
    pub fn and(self, beside: Beside) -> Self {
        Self { beside, ..self }
    }

    /// What the program has besides.
    #[must_use]
    pub const fn besides(&self) -> &Beside {
        &self.beside
    }

    /// The same for a program that offers this work beside experiments.
    #[must_use]
    pub fn offering(self, errands: Errands) -> Self {
        Self { errands, ..self }
    }

    /// Work that the program offers beside experiments.
    #[must_use]
    pub const fn errands(&self) -> &Errands {
        &self.errands
    }

    /// The folder of work that is to go on: one of the runs'.
    ///
    /// # Errors
    /// [`Refusal::BadRequest`]; nothing of it was read.
    pub fn begun(&self, name: &str) -> Result<PathBuf, Refusal> {
        let path = self.output(name)?;
        if path.is_dir() {
            return Ok(path);
        }
        Err(Refusal::BadRequest(format!(
            "there is no folder `{}` in the folder of runs, {}: a request that goes on names one that a request before left there",
            shown(name),
            self.runs.display()
        )))
    }

    /// Where runs go that name no folder.
    #[must_use]
    pub fn runs(&self) -> &Path {
        &self.runs
    }

    /// Who asks for the nodes means those of this runner's axis.
    #[must_use]
    pub fn of_this_axis(&self, rig: RigChoice) -> RigChoice {
        match rig {
            RigChoice::Nodes { namespace: None } => {
                RigChoice::Nodes { namespace: Some(self.axis.clone()) }
            }
            other => other,
        }
    }

    /// The same with a profile for one of the rigs.
    #[must_use]
    pub fn with_profile(self, profile: Option<(RigChoice, PathBuf)>) -> Self {
        Self { profile, ..self }
    }

    /// The profile that counts for `rig`.
    #[must_use]
    pub fn profile_of(&self, rig: &RigChoice) -> Option<&Path> {
        self.profile.as_ref().filter(|(of, _)| of == rig).map(|(_, file)| file.as_path())
    }

    /// The rig, with the axis named, if requests may use it.
    ///
    /// # Errors
    /// [`Refusal::BadRequest`] says which they may use, and how to allow more.
    pub fn rig(&self, rig: RigChoice) -> Result<RigChoice, Refusal> {
        let rig = self.of_this_axis(rig);
        if self.rigs.contains(&rig) {
            return Ok(rig);
        }
        let allowed: Vec<String> = self.rigs.iter().map(ToString::to_string).collect();
        Err(Refusal::BadRequest(format!(
            "requests may not use the rig `{rig}`, only {}; whoever starts the runner allows more, by its parameter allow_rigs or the option --allow-rigs",
            allowed.join(", ")
        )))
    }

    /// A protocol, calibration, drive or parameter file of that name: its path without links.
    ///
    /// # Errors
    /// [`Refusal::BadRequest`]; nothing of it was read.
    pub fn text(&self, name: &str) -> Result<PathBuf, Refusal> {
        let path = self.find(Kind::Text, name)?;
        let most = |length| self.at_most(Kind::Text, name, length, LARGEST_TEXT);
        regular(&path).map_err(|why| self.refused(Kind::Text, name, &why)).and_then(most)?;
        Ok(path)
    }

    /// A bag or CSV file of that name: its path without links.
    ///
    /// # Errors
    /// [`Refusal::BadRequest`]; nothing of it was read.
    pub fn recording(&self, name: &str) -> Result<PathBuf, Refusal> {
        let kind = Kind::Recording;
        let path = self.find(kind, name)?;
        let refused = |why: String| self.refused(kind, name, &why);
        if !path.is_dir() {
            let most = if path.extension().is_some_and(|of| of == "mcap") {
                LARGEST_BAG
            } else {
                LARGEST_TABLE
            };
            self.at_most(kind, name, regular(&path).map_err(refused)?, most)?;
            return Ok(path);
        }
        let mut length: u64 = 0;
        for entry in fs::read_dir(&path).map_err(|error| refused(error.to_string()))? {
            let entry = entry.map_err(|error| refused(error.to_string()))?;
            if entry.path().extension().is_some_and(|of| of == "mcap") {
                if entry.file_type().is_ok_and(|kind| kind.is_symlink()) {
                    return Err(refused(format!(
                        "it has a link in it, {}",
                        entry.file_name().display()
                    )));
                }
                length = length.saturating_add(regular(&entry.path()).map_err(refused)?);
            }
        }
        self.at_most(kind, name, length, LARGEST_BAG)?;
        Ok(path)
    }

    /// The folder of that name in the folder of runs, which need not be there yet.
    ///
    /// # Errors
    /// [`Refusal::BadRequest`]; nothing was made.
    pub fn output(&self, name: &str) -> Result<PathBuf, Refusal> {
        let refused = |why: &str| {
            Refusal::BadRequest(format!(
                "the results cannot be written to `{}`: {why}; name an output_folder in the folder of runs, {}, as in monday, or leave it out and one is made",
                shown(name),
                self.runs.display()
            ))
        };
        let relative = plain(name).map_err(|why| refused(&why))?;
        if relative.as_os_str().is_empty() {
            return Err(refused("it is the folder of runs itself"));
        }
        if relative.components().count() > DEEPEST {
            return Err(refused(&format!("it is more than {DEEPEST} folders deep")));
        }
        let path =
            settled(&self.runs.join(&relative)).map_err(|error| refused(&error.to_string()))?;
        if self.is_in_runs(&path) { Ok(path) } else { Err(refused("a link leads outside")) }
    }

    /// Where a folder is made for what is found in the recording at that path: beside it, if it is
    /// one of the runs'.
    #[must_use]
    pub fn beside<'a>(&'a self, recording: &'a Path) -> &'a Path {
        let beside = recording.parent().unwrap_or(&self.runs);
        if self.is_in_runs(&beside.join("it")) { beside } else { &self.runs }
    }

    /// Whether a path without links lies in the folder of runs.
    #[must_use]
    pub fn is_in_runs(&self, path: &Path) -> bool {
        settled(&self.runs).is_ok_and(|runs| path.starts_with(&runs) && path != runs)
    }

    /// Where something of that name is.
    fn find(&self, kind: Kind, name: &str) -> Result<PathBuf, Refusal> {
        let relative = plain(name).map_err(|why| self.refused(kind, name, &why))?;
        for root in self.inputs.iter().chain([&self.runs]) {
            let path = root.join(&relative);
            if path.symlink_metadata().is_err() {
                continue;
            }
            // Where a link leads is nobody's business: outside and nowhere are told in the same
            // words.
            let inside =
                fs::canonicalize(root).and_then(|root| Ok((fs::canonicalize(&path)?, root)));
            return match inside {
                Ok((path, root)) if path.starts_with(&root) => Ok(path),
                _ => Err(self.refused(kind, name, "a link in it leads outside or nowhere")),
            };
        }
        Err(self.refused(kind, name, "there is none of that name"))
    }

    fn at_most(&self, kind: Kind, name: &str, length: u64, most: u64) -> Result<(), Refusal> {
        if length <= most {
            return Ok(());
        }
        Err(self.refused(
            kind,
            name,
            &format!("it has {length} bytes, at most {most} were expected"),
        ))
    }

    fn refused(&self, kind: Kind, name: &str, why: &str) -> Refusal {
        let folders: Vec<String> = self
            .inputs
            .iter()
            .chain([&self.runs])
            .map(|folder| folder.display().to_string())
            .collect();
        Refusal::BadRequest(format!(
            "the {kind} `{}` is not used: {why}; a request names it relative to {}, as in all-1/parameters.yaml, and whoever starts the runner names \
             another folder by its parameter inputs or the option --inputs",
            shown(name),
            folders.join(" or ")
        ))
    }
}

/// A name as it may stand in a message.
fn shown(name: &str) -> String {
    let plain = name.chars().map(|c| if c.is_control() { '?' } else { c });
    plain.take(200).collect()
}

/// A name without anything that leads away from where it begins.
fn plain(name: &str) -> Result<PathBuf, String> {
    if name.trim().is_empty() {
        return Err("it has no name".to_owned());
    }
    if name.len() > LONGEST_NAME {
        return Err(format!("its name is longer than {LONGEST_NAME} bytes"));
    }
    if name.chars().any(char::is_control) {
        return Err("its name has control characters".to_owned());
    }
    let mut relative = PathBuf::new();
    for component in Path::new(name).components() {
        match component {
            Component::Normal(part) => relative.push(part),
            Component::CurDir => {}
            Component::ParentDir => return Err("`..` is not taken".to_owned()),
            Component::RootDir | Component::Prefix(_) => {
                return Err("an absolute path is not taken".to_owned());
            }
        }
    }
    Ok(relative)
}

/// Length of a regular file; what else it is, it is refused before it is opened.
fn regular(path: &Path) -> Result<u64, String> {
    let found = path.symlink_metadata().map_err(|error| error.to_string())?;
    if found.is_file() { Ok(found.len()) } else { Err("it is no regular file".to_owned()) }
}

/// The path without links, as far as it exists; the rest as it stands.
fn settled(path: &Path) -> io::Result<PathBuf> {
    let path = std::path::absolute(path)?;
    let there =
        path.ancestors().find(|path| path.symlink_metadata().is_ok()).unwrap_or(Path::new("/"));
    let rest = path.strip_prefix(there).map_err(io::Error::other)?;
    let settled = fs::canonicalize(there)?;
    Ok(if rest.as_os_str().is_empty() { settled } else { settled.join(rest) })
}

#[cfg(test)]
mod tests;
