//! `cargo xtask strangers --real`: do two halves of every real recording at hand tell the same?
//!
//! Each recording is halved twice: in time, and by dealing out its blocks in turn. The program
//! identifies each half by itself, as a newcomer would, with the same options for all. A parameter
//! that both halves call identified is a pair. What the first half finds is tried on the second, and
//! the other way about, beside SciPy on the same rows.

mod pairs;
mod recordings;
mod said;
mod servos;
mod table;

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::Result;
use serde::Serialize;
use serde_json::{Map, Value, json};

use self::pairs::Pair;
use self::recordings::{Axis, Split};
use self::said::Said;
use super::peer;

/// What is asked.
pub struct Asked<'a> {
    pub program: PathBuf,
    /// Options of `frictionlab identify`, the same for every recording.
    pub options: Vec<&'a str>,
    pub data: PathBuf,
    /// Where files are written.
    pub root: PathBuf,
    /// Leave SciPy out.
    pub alone: bool,
}

/// A recording that was halved.
#[derive(Debug, Serialize)]
struct Halved {
    recording: String,
    split: &'static str,
    halves: Vec<Said>,
    pairs: Vec<Pair>,
}

/// What one part of a recording says of another.
#[derive(Debug, Serialize)]
struct HeldOut {
    recording: String,
    fitted: &'static str,
    said: Said,
    /// Error of each of the peer's models on the same rows \[%\].
    peer: Map<String, Value>,
    #[serde(skip)]
    folder: PathBuf,
    #[serde(skip)]
    gravity: bool,
}

impl HeldOut {
    /// Its error over the best of the peer's.
    fn ratio(&self) -> Option<f64> {
        Some(self.said.held_out? / peer::best(&self.peer)?.1)
    }
}

impl Asked<'_> {
    /// Asks of every recording whose name begins with `only`, and prints the tables; everything is
    /// in `target/strangers/real/real.json`.
    ///
    /// # Errors
    /// When a recording cannot be read, or the program or the peer cannot be run.
    pub fn run(&self, only: &str) -> Result<()> {
        let (mut halved, mut held_out) = (Vec::new(), Vec::new());
        let axes = recordings::axes(&self.data)?;
        for axis in axes.iter().filter(|axis| axis.name.starts_with(only)) {
            eprintln!("{} ...", axis.name);
            for split in Split::ALL {
                halved.push(self.halved(axis, split)?);
            }
            let folder = self.folder(axis, Split::Time);
            for (fitted, files) in
                [("first half", ["0.csv", "1.csv"]), ("second half", ["1.csv", "0.csv"])]
            {
                held_out.push(self.tried(axis, fitted, &folder, files)?);
            }
        }
        let servos = servos::halved(&self.program, &self.data, &self.root, only)?;
        halved.extend(servos);
        if halved.is_empty() {
            let data = self.data.display();
            println!("skipped: there is no recording of an axis or servo that is known in {data}");
            return Ok(());
        }
        if !self.alone {
            let jobs: Vec<_> = held_out.iter().filter_map(job).collect();
            let answered = held_out.iter_mut().filter(|held| job(held).is_some());
            for (held, errors) in answered.zip(peer::errors(&jobs)?) {
                held.peer = errors;
            }
        }
        fs::create_dir_all(&self.root)?;
        let all = json!({ "halved": halved, "held_out": held_out });
        fs::write(self.root.join("real.json"), serde_json::to_string_pretty(&all)?)?;
        print!("{}", table::render(&halved, &held_out));
        Ok(())
    }

    fn folder(&self, axis: &Axis, split: Split) -> PathBuf {
        self.root.join(format!("{} {}", axis.name, split.name()).replace(' ', "_"))
    }

    fn ask(&self, axis: &Axis, folder: &Path, files: [Option<&str>; 2]) -> Result<Said> {
        let options = [&["--axis", axis.kind][..], &self.options].concat();
        said::identify(&self.program, folder, files, &options)
    }

    fn halved(&self, axis: &Axis, split: Split) -> Result<Halved> {
        let folder = self.folder(axis, split);
        fs::create_dir_all(&folder)?;
        let mut halves = Vec::new();
        for (file, text) in ["0.csv", "1.csv"].into_iter().zip(axis.halves(split)) {
            fs::write(folder.join(file), text)?;
            halves.push(self.ask(axis, &folder, [Some(file), None])?);
        }
        let pairs = match &halves[..] {
            [first, second] => pairs::pairs(first, second),
            _ => vec![],
        };
        Ok(Halved { recording: axis.name.clone(), split: split.name(), halves, pairs })
    }

    fn tried(
        &self,
        axis: &Axis,
        fitted: &'static str,
        halves: &Path,
        [from, to]: [&str; 2],
    ) -> Result<HeldOut> {
        // The peer reads both under these names.
        let folder = halves.join(fitted.replace(' ', "_"));
        fs::create_dir_all(&folder)?;
        fs::copy(halves.join(from), folder.join("estimation.csv"))?;
        fs::copy(halves.join(to), folder.join("validation.csv"))?;
        let files = [Some("estimation.csv"), Some("validation.csv")];
        let said = self.ask(axis, &folder, files)?;
        let (recording, gravity) = (axis.name.clone(), axis.kind == "rotary");
        Ok(HeldOut { recording, fitted, said, peer: Map::new(), folder, gravity })
    }
}

/// What the peer is asked; nothing where the program refused.
fn job(held: &HeldOut) -> Option<Map<String, Value>> {
    let mut job = held.said.settings.as_object()?.clone();
    job.insert("folder".to_owned(), json!(held.folder));
    job.insert("stretches".to_owned(), held.said.stretches.clone());
    job.insert("gravity".to_owned(), json!(held.gravity));
    Some(job)
}
