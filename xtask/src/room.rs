//! Room on the disk: tests that find none fail in many places, and none of them is at fault.

use std::path::{Path, PathBuf};
use std::{env, fs};

use rustix::fs::statvfs;

/// What a first run of all tests writes into the target folder, beside 3 GB of Python \[GB\].
const NEEDED: f64 = 12.0;
/// Bags and environments that tests make in the folder for temporary files \[GB\].
const TEMPORARY: f64 = 2.0;

/// What is free where the tests write, in a sentence each; `built` says that the target folder was
/// filled before.
pub fn said(target: &Path, built: bool) -> Vec<String> {
    let needed = if built { TEMPORARY } else { NEEDED };
    let places = [(target.to_path_buf(), needed), (env::temp_dir(), TEMPORARY)];
    places
        .into_iter()
        .filter_map(|(folder, needed)| line(&folder, free(&folder)?, needed))
        .collect()
}

/// Free room on the disk of a folder \[GB\].
fn free(folder: &Path) -> Option<f64> {
    let folder: PathBuf = fs::canonicalize(folder).ok()?;
    let disk = statvfs(&folder).ok()?;
    Some(disk.f_bavail as f64 * disk.f_frsize as f64 * 1e-9)
}

/// Nothing where there is enough.
fn line(folder: &Path, free: f64, needed: f64) -> Option<String> {
    (free < needed).then(|| {
        format!(
            "WARNING: {free:.1} GB are free for {}, and the tests write up to {needed:.0} GB there: without room they fail wherever \
             they write. Make room, or name a folder on another disk (CARGO_TARGET_DIR, TMPDIR).",
            folder.display()
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_disk_that_is_nearly_full_is_told() {
        let folder = Path::new("/somewhere");
        let told = line(folder, 1.46, 12.0).unwrap();
        assert!(told.contains("1.5 GB") && told.contains("/somewhere"), "{told}");
        assert_eq!(line(folder, 12.1, 12.0), None);
        assert!(free(&env::temp_dir()).is_some_and(|free| free > 0.0));
    }
}
