//! A file that grows as it is computed: whole under its name at the end, or not there.
#![cfg(unix)]

use std::fs::{self, File};
use std::io::Write;
use std::path::Path;

use files::{OutputError, OutputFile};

fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap();
    entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect()
}

#[test]
fn a_file_appears_when_it_is_finished_and_not_before() {
    let root = tempfile::tempdir().unwrap();
    let path = root.path().join("deep/friction.csv");
    let mut growing = OutputFile::new(&path, false).unwrap().grow().unwrap();
    growing.write_all(b"one").unwrap();
    assert!(!path.exists());
    growing.finish().unwrap();
    assert_eq!(fs::read(&path).unwrap(), b"one");
    assert_eq!(names(path.parent().unwrap()), ["friction.csv"]);
}

#[test]
fn one_that_is_given_up_leaves_nothing_and_what_was_there() {
    let root = tempfile::tempdir().unwrap();
    let path = root.path().join("deep/friction.csv");
    let mut growing = OutputFile::new(&path, false).unwrap().grow().unwrap();
    growing.write_all(b"one").unwrap();
    drop(growing);
    assert_eq!(names(root.path()), [""; 0]);
    let path = root.path().join("friction.csv");
    fs::write(&path, "mine").unwrap();
    let mut growing = OutputFile::new(&path, true).unwrap().grow().unwrap();
    growing.write_all(b"other").unwrap();
    drop(growing);
    assert_eq!(fs::read(&path).unwrap(), b"mine");
    assert_eq!(names(root.path()), ["friction.csv"]);
}

#[test]
fn a_file_that_came_meanwhile_is_not_replaced() {
    let root = tempfile::tempdir().unwrap();
    let path = root.path().join("friction.csv");
    let mut growing = OutputFile::new(&path, false).unwrap().grow().unwrap();
    growing.write_all(b"other").unwrap();
    fs::write(&path, "mine").unwrap();
    assert!(matches!(growing.finish(), Err(OutputError::Exists(_))));
    assert_eq!(fs::read(&path).unwrap(), b"mine");
    assert_eq!(names(root.path()), ["friction.csv"]);
}

#[test]
fn a_reader_that_has_seen_enough_is_no_error() {
    let root = tempfile::tempdir().unwrap();
    let pipe = root.path().join("pipe");
    assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    let end = pipe.clone();
    let reader = std::thread::spawn(move || drop(File::open(end).unwrap()));
    let mut growing = OutputFile::new(&pipe, false).unwrap().grow().unwrap();
    reader.join().unwrap();
    for _ in 0..100 {
        growing.write_all(&[b'x'; 10_000]).unwrap();
    }
    growing.finish().unwrap();
}
