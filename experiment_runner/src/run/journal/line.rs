//! The lines of the journal.

use std::fs::File;
use std::io::{self, BufRead, BufReader};
use std::path::PathBuf;

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::run::RunError;
use crate::run::results::Reconnection;

/// A line of the journal; `R` is what a job gave.
#[derive(Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Line<R> {
    Header(Header),
    Session(Begun),
    Done(Done<R>),
    Reconnection(Reconnection),
}

/// How the run was begun.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Header {
    pub(super) format: u32,
    pub(super) program: String,
    /// Where the command was given: its files are found from there.
    pub(super) directory: PathBuf,
    /// What stood behind `run`.
    pub(super) words: Vec<String>,
    /// What was asked for.
    pub(super) asked: Value,
    /// What became of it once the rig was open.
    pub(super) opened: Value,
}

/// A sitting: the first one, or one that went on.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Begun {
    pub(super) began_ns: u64,
    /// Where the bag of the sitting before is kept.
    pub(super) moved: Option<String>,
}

/// A job that was delivered.
#[derive(Debug, Serialize, Deserialize)]
pub(in crate::run) struct Done<R> {
    /// Its number, counted over the whole run.
    pub(super) job: u64,
    /// When it was done [ns since the Unix epoch].
    pub(super) finished_ns: u64,
    /// Start of its run on the bag's time axis [ns since the Unix epoch].
    pub start_ns: u64,
    /// What it gave.
    pub result: R,
}

/// A job's line in the file.
#[derive(Debug, Clone, Copy)]
pub(super) struct Place {
    pub(super) offset: u64,
    pub(super) length: usize,
}

pub(super) fn text_of<R: Serialize>(line: &Line<R>) -> Result<String, RunError> {
    let text = serde_json::to_string(line);
    let text = text.map_err(|e| RunError::Describe { what: "JSON", detail: e.to_string() })?;
    Ok(text + "\n")
}

pub(super) fn read<R: DeserializeOwned>(line: &[u8]) -> Option<Line<R>> {
    serde_json::from_slice(line).ok()
}

/// Whole lines of a file, with their places.
pub(super) struct Lines<'a> {
    pub(super) reader: BufReader<&'a File>,
    pub(super) offset: u64,
}

impl Lines<'_> {
    /// The next line that has an end.
    pub(super) fn next_line(&mut self) -> io::Result<Option<(u64, Vec<u8>)>> {
        let mut line = Vec::new();
        self.reader.read_until(b'\n', &mut line)?;
        if line.last() != Some(&b'\n') {
            return Ok(None);
        }
        let offset = self.offset;
        self.offset += line.len() as u64;
        Ok(Some((offset, line)))
    }
}
