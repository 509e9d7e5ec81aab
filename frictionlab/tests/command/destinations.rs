//! Where results go, as a person meets it: folders that are numbered, files that are kept, pipes
//! that stay pipes.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};

fn command(folder: &Path, args: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_frictionlab"));
    command.current_dir(folder).args(args).stdin(Stdio::null());
    command
}

fn run(folder: &Path, args: &[&str]) -> Output {
    command(folder, args).output().unwrap()
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

const DESIGN: [&str; 4] = ["design", "position", "--gains", "20,100,.3"];

#[test]
fn eleven_programs_that_start_at_once_get_a_folder_each() {
    let root = tempfile::tempdir().unwrap();
    let all: Vec<_> = (0..11)
        .map(|_| {
            command(root.path(), &DESIGN)
                .stdout(Stdio::piped())
                .stderr(Stdio::piped())
                .spawn()
                .unwrap()
        })
        .collect();
    for program in all {
        let output = program.wait_with_output().unwrap();
        assert!(output.status.success(), "{}", said(&output));
    }
    let made: BTreeSet<String> = fs::read_dir(root.path().join("runs"))
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|folder| {
            folder.join("controller.yaml").is_file() && folder.join("report.html").is_file()
        })
        .map(|folder| folder.file_name().unwrap().to_string_lossy().into_owned())
        .collect();
    assert_eq!(made, (1..=11).map(|n| format!("design-{n}")).collect());
}

#[test]
fn what_exists_is_refused_and_forced() {
    let root = tempfile::tempdir().unwrap();
    let out = [&DESIGN[..], &["--out", "mine", "--quiet"]].concat();
    assert!(run(root.path(), &out).status.success());
    let gains = || fs::read_to_string(root.path().join("mine/controller.yaml")).unwrap();
    let before = gains();
    let other = ["design", "position", "--gains", "10,50,.1", "--out", "mine", "--quiet"];
    let refused = run(root.path(), &other);
    assert_eq!(refused.status.code(), Some(2));
    assert!(
        said(&refused).contains("not empty") && said(&refused).contains("--force"),
        "{}",
        said(&refused)
    );
    assert_eq!(gains(), before);
    assert!(run(root.path(), &[&other[..], &["--force"]].concat()).status.success());
    assert_ne!(gains(), before);
}

fn simulate<'a>(out: &'a str, more: &[&'a str]) -> Vec<&'a str> {
    [
        &["simulate", "--model", "lugre", "--velocity", "motion.csv", "--dt", "1e-3", "--out", out],
        more,
    ]
    .concat()
}

#[cfg(unix)]
#[test]
fn a_pipe_a_link_and_standard_output_are_written_through() {
    use std::os::unix::fs::{FileTypeExt, symlink};
    let root = tempfile::tempdir().unwrap();
    fs::write(root.path().join("motion.csv"), "t_s,velocity_rad_s\n0,0\n1,0.1\n").unwrap();

    let printed = run(root.path(), &simulate("-", &[]));
    assert!(printed.status.success(), "{}", said(&printed));
    let table = String::from_utf8(printed.stdout).unwrap();
    assert!(
        table.starts_with("t_s,") && table.lines().count() == 3,
        "the table and nothing else: {table}"
    );

    let pipe = root.path().join("pipe");
    assert!(Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    let end = pipe.clone();
    let reader = std::thread::spawn(move || fs::read_to_string(end).unwrap());
    assert!(run(root.path(), &simulate("pipe", &[])).status.success());
    assert_eq!(reader.join().unwrap(), table);
    assert!(pipe.symlink_metadata().unwrap().file_type().is_fifo());

    fs::write(root.path().join("real.csv"), "mine").unwrap();
    symlink("real.csv", root.path().join("link.csv")).unwrap();
    let refused = run(root.path(), &simulate("link.csv", &[]));
    assert_eq!(refused.status.code(), Some(2), "{}", said(&refused));
    assert!(run(root.path(), &simulate("link.csv", &["--force"])).status.success());
    assert!(root.path().join("link.csv").symlink_metadata().unwrap().is_symlink());
    assert_eq!(fs::read_to_string(root.path().join("real.csv")).unwrap(), table);
}
