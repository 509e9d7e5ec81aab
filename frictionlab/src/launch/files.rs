//! The nodes' own parameter files, which the program carries with it.

use std::{
    fs,
    path::{Path, PathBuf},
};

use super::LaunchError;

/// Name and content of every file, those of the ROS 2 package `friction_bringup`.
pub const FILES: [(&str, &str); 5] = [
    ("rig_driver.yaml", include_str!("../../../launch_configs/config/rig_driver.yaml")),
    (
        "friction_observer.yaml",
        include_str!("../../../launch_configs/config/friction_observer.yaml"),
    ),
    ("controller.yaml", include_str!("../../../launch_configs/config/controller.yaml")),
    (
        "experiment_runner.yaml",
        include_str!("../../../launch_configs/config/experiment_runner.yaml"),
    ),
    ("axis_2.yaml", include_str!("../../../launch_configs/config/axis_2.yaml")),
];

/// A folder with the files. One that nobody named is removed in the end.
#[derive(Debug)]
pub struct ConfigFolder {
    path: PathBuf,
    temporary: bool,
}

impl ConfigFolder {
    /// The folder `named`, with what is missing in it written and what is there kept; or a
    /// temporary one.
    ///
    /// # Errors
    /// [`LaunchError::Files`] if it cannot be written.
    pub fn make(named: Option<&Path>) -> Result<Self, LaunchError> {
        let path = match named {
            Some(folder) => folder.to_owned(),
            None => Self::temporary_path(),
        };
        let failed = |source| LaunchError::Files { folder: path.clone(), source };
        match named {
            Some(folder) => fs::create_dir_all(folder).map_err(failed)?,
            // It must be new: somebody else's would be somebody else's parameters.
            None => fs::create_dir(&path).map_err(failed)?,
        }
        let made = Self { path: path.clone(), temporary: named.is_none() };
        for (name, content) in FILES {
            let file = path.join(name);
            if !file.exists() {
                fs::write(&file, content).map_err(failed)?;
            }
        }
        Ok(made)
    }

    /// Where a folder that nobody named would be.
    #[must_use]
    pub fn temporary_path() -> PathBuf {
        std::env::temp_dir().join(format!("frictionlab-launch-{}", std::process::id()))
    }

    /// The folder.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }
}

impl Drop for ConfigFolder {
    fn drop(&mut self) {
        if self.temporary {
            // What stays behind is small, and in the folder for such things.
            let _ = fs::remove_dir_all(&self.path);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_that_were_edited_are_kept_and_missing_ones_written() {
        let root = tempfile::tempdir().expect("a folder");
        let folder = root.path().join("mine");
        fs::create_dir(&folder).expect("a folder");
        fs::write(folder.join("controller.yaml"), "mine").expect("a file");
        drop(ConfigFolder::make(Some(&folder)).expect("a folder"));
        assert_eq!(fs::read_to_string(folder.join("controller.yaml")).expect("it is kept"), "mine");
        assert_eq!(
            fs::read_to_string(folder.join("axis_2.yaml")).expect("it is written"),
            FILES[4].1
        );
    }

    #[test]
    fn a_temporary_folder_goes_when_it_is_dropped() {
        let made = ConfigFolder::make(None).expect("a folder");
        let path = made.path().to_owned();
        assert!(path.join("rig_driver.yaml").is_file());
        drop(made);
        assert!(!path.exists());
    }
}
