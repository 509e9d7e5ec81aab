//! Recordings that are no text: MATLAB's `.mat`, NumPy's `.npy` and `.npz`, HDF5 and Parquet.
//!
//! What such a file holds becomes columns of one length. Vectors of the usual length are columns; a
//! matrix with that many rows, or columns, is one column for each joint, as in `q[2]`. What does
//! not fit is left out, and can be told. No file takes more memory than [`MOST_VALUES`] numbers,
//! whatever it says of itself.

mod arrays;
mod assemble;
mod float16;
mod foreign;
mod guard;
mod hdf;
mod matlab;
mod numpy;
mod parquet;
mod zip_archive;

use std::path::Path;

use serde::Serialize;

use crate::RecordingError;

pub use arrays::{Array, Arrays, Input};
use assemble::assemble;

/// Numbers that a file may hold: one GiB of them.
pub const MOST_VALUES: usize = 1 << 27;

/// What kind of file a table is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Form {
    /// Text.
    Text,
    /// NumPy, one array.
    Npy,
    /// NumPy, an archive of arrays.
    Npz,
    /// MATLAB up to version 7.
    Matlab,
    /// MATLAB 7.3, or another HDF5 file.
    Hdf5,
    /// Parquet.
    Parquet,
    /// Several tables, column beside column.
    Joined,
    /// Arrays in memory.
    Arrays,
}

impl Form {
    /// In words.
    #[must_use]
    pub const fn describe(self) -> &'static str {
        match self {
            Self::Text => "text",
            Self::Npy => "a NumPy array (.npy)",
            Self::Npz => "a NumPy archive (.npz)",
            Self::Matlab => "a MATLAB file (version 5 to 7)",
            Self::Hdf5 => "a MATLAB 7.3 or HDF5 file",
            Self::Parquet => "a Parquet file",
            Self::Joined => "several tables, joined row by row",
            Self::Arrays => "arrays in memory",
        }
    }

    /// How it becomes a table that can be read.
    const fn convert(self) -> &'static str {
        match self {
            Self::Npy | Self::Npz => {
                "in Python: numpy.savez('recording.npz', t=t, q=q, tau=tau) with arrays of numbers of one length"
            }
            Self::Matlab | Self::Hdf5 => {
                "in MATLAB: save('recording.mat', 't', 'q', 'tau', '-v7') with vectors of one length; a table T by writetable(T, 'recording.csv')"
            }
            Self::Parquet => "in Python: pandas.read_parquet(FILE).to_csv('recording.csv')",
            Self::Text | Self::Joined | Self::Arrays => {
                "as text, with one header line and one line a sample"
            }
        }
    }
}

/// A column.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct GridColumn {
    /// What it is called, without the joint.
    pub stem: String,
    /// Which joint it is, where there are several.
    pub label: Option<String>,
    /// The unit that the file says, apart from the name.
    pub unit: Option<String>,
    /// Its values; NaN where there is none.
    pub values: Vec<f64>,
}

/// Columns of one length.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Grid {
    pub form: Form,
    pub columns: Vec<GridColumn>,
    /// What was left out, with why.
    pub left_out: Vec<String>,
}

/// An array of a file, by columns: its first index runs fastest.
#[derive(Debug, Clone, PartialEq)]
struct Variable {
    name: String,
    /// The unit that the file says, apart from the name.
    unit: Option<String>,
    rows: usize,
    columns: usize,
    values: Vec<f64>,
}

/// What a file holds.
#[derive(Debug, Default)]
struct Contents {
    variables: Vec<Variable>,
    left_out: Vec<String>,
    /// Numbers read by now.
    values: usize,
}

impl Contents {
    /// Counts numbers that are about to be read.
    fn expect(&mut self, rows: usize, columns: usize) -> Result<usize, String> {
        let most = || format!("it says that it holds more than {MOST_VALUES} numbers");
        let count = rows.checked_mul(columns).ok_or_else(most)?;
        self.values =
            self.values.checked_add(count).filter(|n| *n <= MOST_VALUES).ok_or_else(most)?;
        Ok(count)
    }

    fn leave_out(&mut self, name: &str, why: &str) {
        const MOST: usize = 100;
        if self.left_out.len() < MOST {
            self.left_out.push(format!("`{name}` is left out: {why}"));
        }
    }
}

/// Which kind of file these bytes are.
pub(super) fn form_of(bytes: &[u8]) -> Form {
    const HDF5: &[u8] = b"\x89HDF\r\n\x1a\n";
    if bytes.starts_with(b"\x93NUMPY") {
        Form::Npy
    } else if bytes.starts_with(b"PK\x03\x04") || bytes.starts_with(b"PK\x05\x06") {
        Form::Npz
    } else if bytes.starts_with(HDF5) || bytes.get(512..520) == Some(HDF5) {
        Form::Hdf5
    } else if bytes.starts_with(b"MATLAB ") && bytes.len() >= 128 {
        Form::Matlab
    } else if bytes.starts_with(b"PAR1") {
        Form::Parquet
    } else {
        Form::Text
    }
}

/// Refuses a file that is neither text nor of a form that is read.
///
/// # Errors
/// [`RecordingError::Form`].
pub(super) fn refuse_foreign(path: &Path, bytes: &[u8]) -> Result<(), RecordingError> {
    let Some(foreign::Foreign { form, convert }) = foreign::foreign(bytes) else { return Ok(()) };
    let detail = "such files are not read".to_owned();
    Err(RecordingError::Form { path: path.into(), form, detail, convert })
}

/// Refuses a file that neither begins like what its name promises nor is text: MATLAB writes text
/// under its own ending too.
///
/// # Errors
/// [`RecordingError::Form`].
pub(super) fn refuse_misnamed(path: &Path) -> Result<(), RecordingError> {
    let Some(form) = named(path) else { return Ok(()) };
    let detail = "it does not begin as one: it is damaged, or is something else".to_owned();
    let (form, convert) = (form.describe(), form.convert());
    Err(RecordingError::Form { path: path.into(), form, detail, convert })
}

/// The kind of file that the name promises; none for text, and for names that promise nothing.
fn named(path: &Path) -> Option<Form> {
    let ending = path.extension()?.to_str()?;
    Some(match ending.to_ascii_lowercase().as_str() {
        "npy" => Form::Npy,
        "npz" => Form::Npz,
        "mat" => Form::Matlab,
        "h5" | "hdf5" => Form::Hdf5,
        "parquet" => Form::Parquet,
        _ => return None,
    })
}

/// The columns of a file that is no text.
///
/// # Errors
/// [`RecordingError::Form`].
pub(super) fn read(path: &Path, form: Form, bytes: &[u8]) -> Result<Grid, RecordingError> {
    let refuse = |detail: String| RecordingError::Form {
        path: path.into(),
        form: form.describe(),
        detail,
        convert: form.convert(),
    };
    let contents = guard::guarded(|| match form {
        Form::Npy => numpy::array(bytes, stem(path)),
        Form::Npz => zip_archive::read(bytes),
        Form::Matlab => matlab::read(bytes),
        Form::Hdf5 => hdf::read(bytes),
        Form::Parquet => parquet::read(bytes),
        Form::Text | Form::Joined | Form::Arrays => Err("it is text".to_owned()),
    });
    contents.and_then(|contents| assemble(form, contents)).map_err(refuse)
}

/// The name of a file without its ending.
pub(super) fn stem(path: &Path) -> String {
    path.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned())
}

#[cfg(test)]
mod tests;
