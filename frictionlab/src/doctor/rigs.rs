//! Which rigs this machine has, whether their ports may be opened, and room for runs. Nothing is
//! opened.

use std::path::{Path, PathBuf};

use rig_driver::quanser::find_library;
use rustix::fs::{Access, access, statvfs};

use super::Finding;
use rig_setup::{SerialPort, serial_ports};

/// What an hour of `frictionlab live` at 1 kHz takes in its bag [GB], measured: 246 kB a second.
const GIGABYTES_AN_HOUR: f64 = 0.9;

/// Rigs.
pub(super) fn check() -> Vec<Finding> {
    let mut findings = vec![Finding::fine("simulated", "the test bed is always there")];
    findings.push(match find_library() {
        Ok(library) => {
            Finding::fine("quanser", format!("the HIL library {} is there", library.display()))
        }
        Err(_) => Finding::fine("quanser", "no HIL library; only Quanser's own cards need it"),
    });
    let ports = serial_ports();
    if ports.is_empty() {
        findings.push(Finding::fine("serial", "no serial port with a device on it"));
    }
    findings.extend(ports.iter().map(port));
    findings
}

fn port(port: &SerialPort) -> Finding {
    let name = port.by_id.as_ref().unwrap_or(&port.device);
    let subject = format!("serial:{}", name.display());
    let product = port.product.as_deref().unwrap_or("a device that does not tell its name");
    match access(&port.device, Access::READ_OK | Access::WRITE_OK) {
        Ok(()) => Finding::fine(subject, format!("{product}; this user may open it")),
        Err(error) => Finding::look(
            subject,
            format!("{product}; this user may not open it: {error}"),
            "`sudo usermod -aG dialout $USER` (some systems say uucp), then log in again",
        ),
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
        let gone = SerialPort { by_id: None, device: "/nowhere/ttyACM0".into(), product: None };
        let finding = port(&gone);
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
