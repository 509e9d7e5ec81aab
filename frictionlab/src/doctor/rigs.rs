//! Which rigs this machine has, whether their ports may be opened, and room for runs. Nothing is
//! opened.

use std::path::{Path, PathBuf};

use rig_driver::RigRegistry;
use rig_driver::registry::{Listed, Standing};
use rustix::fs::{Access, access, statvfs};

use super::Finding;

/// What an hour of `frictionlab live` at 1 kHz takes in its bag \[GB\], measured: 246 kB a second.
const GIGABYTES_AN_HOUR: f64 = 0.9;

/// Rigs.
pub(super) fn check() -> Vec<Finding> {
    RigRegistry::installed().listed().into_iter().map(finding).collect()
}

/// What is listed, judged: that a kind of rig is absent is no fault.
fn finding(Listed { address, about, standing }: Listed) -> Finding {
    match standing {
        Standing::Ready | Standing::Absent => Finding::fine(address, about),
        Standing::Refused { why, mend } => {
            Finding::look(address, format!("{about}; this user may not open it: {why}"), mend)
        }
    }
}

/// Room on the disk for the folder of runs.
pub(super) fn disk(runs: &Path) -> Vec<Finding> {
    let folder = nearest(runs);
    let writable = access(&folder, Access::WRITE_OK | Access::EXEC_OK);
    let shown = std::fs::canonicalize(&folder).unwrap_or_else(|_| folder.clone());
    let mut findings = vec![match writable {
        Ok(()) => Finding::fine("folder of runs", format!("{} can be written", shown.display())),
        Err(error) => Finding::look(
            "folder of runs",
            format!("{} cannot be written: {error}", shown.display()),
            "start the programs in a folder of your own, or name one with --out or `-p runs:=DIR`",
        ),
    }];
    match statvfs(&folder) {
        Err(error) => findings.push(Finding::look(
            "disk",
            format!("{} cannot be asked for its free space: {error}", shown.display()),
            "name another folder with --runs",
        )),
        Ok(disk) => findings.push(room(disk.f_bavail as f64 * disk.f_frsize as f64 * 1e-9)),
    }
    findings
}

fn room(free: f64) -> Finding {
    let mend = "remove old runs, or name a folder on another disk with --out or `-p runs:=DIR`";
    let finding = if free < 0.1 {
        Finding::broken("disk", "it is full: bags cannot be written", mend)
    } else if free < GIGABYTES_AN_HOUR {
        Finding::look("disk", "room for less than an hour of bags", mend)
    } else {
        Finding::fine("disk", "there is room for bags")
    };
    finding.with("free", free, "GB").with("hours of a loop at 1 kHz", free / GIGABYTES_AN_HOUR, "h")
}

/// The folder itself, or the nearest one above it that exists.
fn nearest(folder: &Path) -> PathBuf {
    folder
        .ancestors()
        .find(|above| above.is_dir())
        .map_or_else(|| PathBuf::from("."), Path::to_owned)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::doctor::Verdict;

    #[test]
    fn a_full_disk_is_broken_and_a_port_that_is_not_there_may_not_be_opened() {
        assert_eq!(
            [room(0.05), room(0.5), room(100.0)].map(|finding| finding.verdict),
            [Verdict::Broken, Verdict::LookAtThis, Verdict::Fine]
        );
        let refused = Standing::Refused { why: "no such file".into(), mend: "plug it in" };
        let finding = finding(Listed {
            address: "serial:/nowhere/ttyACM0".into(),
            about: "a board".into(),
            standing: refused,
        });
        assert_eq!(
            (finding.verdict, finding.subject.as_str()),
            (Verdict::LookAtThis, "serial:/nowhere/ttyACM0")
        );
    }

    #[test]
    fn a_folder_that_is_not_there_yet_is_judged_by_the_one_above() {
        let root = tempfile::tempdir().expect("a folder");
        assert_eq!(nearest(&root.path().join("runs/all-1")), root.path());
        let findings = disk(&root.path().join("runs"));
        assert_eq!(findings[0].verdict, Verdict::Fine);
        assert!(findings[1].figures[0].value > 0.0);
    }
}
