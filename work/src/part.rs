//! Work in parts: options that cut a long work so that several machines do a part of it each, and
//! the documents of parts that become one result again.
//!
//! A piece (a draw, a seed, a machine) depends on nothing but its number. So what is joined is what
//! one process finds, to the last bit.

use std::collections::BTreeMap;
use std::fmt;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use crate::BadInput;

/// The options, the same for every command whose work can be cut.
#[derive(Debug, Clone, Default, clap::Args)]
pub struct InParts {
    /// Do one part of the work, as 3/20 for the third of twenty, and write a document that --join
    /// understands
    #[arg(long, value_name = "I/N")]
    pub part: Option<Part>,
    /// Do nothing but join the documents of all parts in this folder: the result is that of the
    /// same command without --part, bit for bit
    #[arg(long, value_name = "FOLDER", conflicts_with = "part")]
    pub join: Option<PathBuf>,
}

/// One of the parts that a work is cut into.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "Written")]
pub struct Part {
    number: u32,
    of: u32,
}

/// Most parts of a work.
const MOST: u32 = 100_000;

/// A part as a document has it.
#[derive(Deserialize)]
struct Written {
    number: u32,
    of: u32,
}

/// A text that names no part.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "`{0}` is no part; expected I/N with I from 1 to N and N at most {MOST}, as 3/20 for the third of twenty"
)]
pub struct PartError(String);

impl Part {
    /// All of it.
    pub const WHOLE: Self = Self { number: 1, of: 1 };

    /// Which of the pieces are its own: of `pieces` in order, as many as each other part has, give
    /// or take one.
    #[must_use]
    pub fn range(self, pieces: u32) -> Range<u32> {
        let end = |number: u32| {
            let share = u64::from(pieces) * u64::from(number) / u64::from(self.of);
            u32::try_from(share).unwrap_or(pieces)
        };
        end(self.number - 1)..end(self.number)
    }

    /// Name of its document.
    #[must_use]
    pub fn file_name(self) -> String {
        format!("part-{:05}-of-{:05}.json", self.number, self.of)
    }
}

impl TryFrom<Written> for Part {
    type Error = PartError;

    fn try_from(Written { number, of }: Written) -> Result<Self, PartError> {
        let known = (1..=of).contains(&number) && of <= MOST;
        known.then_some(Self { number, of }).ok_or_else(|| PartError(format!("{number}/{of}")))
    }
}

impl FromStr for Part {
    type Err = PartError;

    fn from_str(text: &str) -> Result<Self, PartError> {
        let read = |(number, of): (&str, &str)| {
            Some(Written { number: number.trim().parse().ok()?, of: of.trim().parse().ok()? })
        };
        let written = text.split_once('/').and_then(read);
        let refused = || PartError(text.to_owned());
        written.ok_or_else(refused).and_then(|written| written.try_into().map_err(|_| refused()))
    }
}

impl fmt::Display for Part {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.number, self.of)
    }
}

/// `format` of a part's document.
const FORMAT: &str = "frictionlab-part";
/// `format_version`.
const FORMAT_VERSION: u32 = 1;

/// What one part found.
#[derive(Debug, Serialize, Deserialize)]
struct Document<R> {
    format: String,
    format_version: u32,
    program_version: String,
    /// The command.
    work: String,
    part: Part,
    result: R,
}

/// The document of a part of `work`, a command's name.
///
/// # Errors
/// If the result cannot be said in JSON, a mistake of this program.
pub fn document(work: &str, part: Part, result: &impl Serialize) -> anyhow::Result<String> {
    let version = env!("CARGO_PKG_VERSION").to_owned();
    let document = Document {
        format: FORMAT.to_owned(),
        format_version: FORMAT_VERSION,
        program_version: version,
        work: work.to_owned(),
        part,
        result,
    };
    Ok(serde_json::to_string(&document)? + "\n")
}

/// What a document says.
#[derive(Debug)]
pub struct Found<R> {
    /// Its file.
    pub path: PathBuf,
    /// Which part.
    pub part: Part,
    /// What the part found.
    pub result: R,
}

impl<R> Found<R> {
    /// The error that it cannot be joined.
    #[must_use]
    pub fn refused(&self, why: impl fmt::Display) -> BadInput {
        BadInput(format!("{}: {why}", self.path.display()))
    }
}

/// The parts of a work that are there.
#[derive(Debug)]
pub struct Parts<R> {
    /// What is there, in the order of the parts.
    pub found: Vec<Found<R>>,
    /// Numbers of those that are not there.
    missing: Vec<u32>,
    of: u32,
}

impl<R> Parts<R> {
    /// Whether all are there.
    #[must_use]
    pub fn complete(&self) -> bool {
        self.missing.is_empty()
    }

    /// The sentence that says which parts are not there; none where all are.
    #[must_use]
    pub fn lacking(&self) -> Option<String> {
        let (first, rest) = self.missing.split_first()?;
        let more =
            if rest.is_empty() { String::new() } else { format!(" and {} more", rest.len()) };
        Some(format!(
            "part {first}/{}{more} is not there: the result is of the other {}",
            self.of,
            self.found.len()
        ))
    }
}

/// Reads the documents of `work` in `folder`: every file there whose name ends with `.json`.
///
/// # Errors
/// [`BadInput`] where a file is no such document, or is of another work, cut or version.
pub fn read<R: DeserializeOwned>(folder: &Path, work: &str) -> Result<Parts<R>, BadInput> {
    let listed = || -> std::io::Result<Vec<PathBuf>> {
        folder.read_dir()?.map(|entry| entry.map(|entry| entry.path())).collect()
    };
    let bad = |path: &Path, why: &dyn fmt::Display| BadInput(format!("{}: {why}", path.display()));
    let mut files = listed().map_err(|error| bad(folder, &error))?;
    files.retain(|path| path.extension().is_some_and(|ending| ending == "json"));
    files.sort();
    let mut found: BTreeMap<u32, Found<R>> = BTreeMap::new();
    let mut of = None;
    for path in files {
        let text = files::input::table(&path).map_err(|error| bad(&path, &error))?;
        let document: Document<R> = serde_json::from_slice(&text)
            .map_err(|error| bad(&path, &format!("it is no document of --part: {error}")))?;
        let part = document.part;
        checked(&document, work, *of.get_or_insert(part.of)).map_err(|why| bad(&path, &why))?;
        if let Some(other) = found.get(&part.number) {
            let why = format!("it is part {part} as {} is; delete one", other.path.display());
            return Err(bad(&path, &why));
        }
        found.insert(part.number, Found { path, part, result: document.result });
    }
    let Some(of) = of else {
        let why = format!("there is no part; `frictionlab {work} --part 1/2 --json` prints one");
        return Err(bad(folder, &why));
    };
    let missing = (1..=of).filter(|number| !found.contains_key(number)).collect();
    Ok(Parts { found: found.into_values().collect(), missing, of })
}

/// Whether a document can be joined with the others.
fn checked<R>(document: &Document<R>, work: &str, of: u32) -> Result<(), String> {
    let version = env!("CARGO_PKG_VERSION");
    if (document.format.as_str(), document.format_version) != (FORMAT, FORMAT_VERSION) {
        return Err(format!("expected a document of {FORMAT} {FORMAT_VERSION}"));
    }
    if document.work != work {
        return Err(format!("expected a part of `{work}`, but it is one of `{}`", document.work));
    }
    if document.program_version != version {
        return Err(format!(
            "it was made by version {}, and this is {version}; delete it and make it anew",
            document.program_version
        ));
    }
    if document.part.of != of {
        return Err(format!("it is part {}, where others are of {of}", document.part));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_cover_the_work_without_a_gap_and_are_of_one_size() {
        for (pieces, of) in [(0, 3), (7, 3), (1000, 7), (3, 10), (u32::MAX, 100_000)] {
            let ranges: Vec<_> = (1..=of).map(|number| Part { number, of }.range(pieces)).collect();
            assert_eq!((ranges[0].start, ranges[ranges.len() - 1].end), (0, pieces));
            assert!(ranges.windows(2).all(|pair| pair[0].end == pair[1].start));
            let sizes = || ranges.iter().map(ExactSizeIterator::len);
            assert!(sizes().max().unwrap() - sizes().min().unwrap() <= 1, "{ranges:?}");
        }
        assert_eq!(Part::WHOLE.range(5), 0..5);
    }

    #[test]
    fn a_part_is_named_and_nothing_else_is() {
        assert_eq!("3/20".parse(), Ok(Part { number: 3, of: 20 }));
        for wrong in ["", "3", "0/4", "5/4", "1/0", "-1/4", "1/100001", "1/4/2", "a/b"] {
            let said = wrong.parse::<Part>().unwrap_err().to_string();
            assert!(said.contains("as 3/20"), "{said}");
        }
    }

    fn put(folder: &Path, name: &str, text: &str) {
        std::fs::write(folder.join(name), text).unwrap();
    }

    #[test]
    fn parts_come_back_in_their_order_and_what_lacks_is_said() {
        let folder = tempfile::tempdir().unwrap();
        for (name, number) in [("a.json", 3), ("b.json", 1)] {
            let part = Part { number, of: 4 };
            put(folder.path(), name, &document("study", part, &(0.1 * f64::from(number))).unwrap());
        }
        put(folder.path(), "notes.txt", "nothing of ours");
        let parts: Parts<f64> = read(folder.path(), "study").unwrap();
        let values: Vec<f64> = parts.found.iter().map(|found| found.result).collect();
        assert_eq!(values, [0.1, 0.1 * 3.0]);
        assert!(!parts.complete());
        let said = parts.lacking().unwrap();
        assert_eq!(said, "part 2/4 and 1 more is not there: the result is of the other 2");
    }

    #[test]
    fn what_cannot_be_joined_is_said_with_its_file() {
        let one = document("study", Part::WHOLE, &1.0).unwrap();
        for (second, expected) in [
            (one.clone(), "is part 1/1 as"),
            (document("design", Part::WHOLE, &1.0).unwrap(), "a part of `study`"),
            (document("study", Part { number: 1, of: 2 }, &1.0).unwrap(), "others are of 1"),
            (one.replace(env!("CARGO_PKG_VERSION"), "0.0.0"), "made by version 0.0.0"),
            (one.replace("\"number\":1", "\"number\":9"), "`9/1` is no part"),
            (one.replace("\"format_version\":1", "\"format_version\":7"), "frictionlab-part 1"),
            (one[..20].to_owned(), "no document of --part"),
            (String::new(), "no document of --part"),
        ] {
            let folder = tempfile::tempdir().unwrap();
            put(folder.path(), "1.json", &one);
            put(folder.path(), "2.json", &second);
            let said = read::<f64>(folder.path(), "study").unwrap_err().to_string();
            assert!(said.contains(expected) && said.contains("2.json"), "{said}");
        }
        let empty = tempfile::tempdir().unwrap();
        let said = read::<f64>(empty.path(), "study").unwrap_err().to_string();
        assert!(said.contains("there is no part"), "{said}");
        assert!(read::<f64>(&empty.path().join("none"), "study").is_err());
    }
}
