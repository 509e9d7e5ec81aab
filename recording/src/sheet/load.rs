//! What a table is read from: the bytes of a text, or the columns of what is none.

use std::borrow::Cow;
use std::path::{Path, PathBuf};

use super::encoding::{Encoding, decoded};
use super::{Missing, Named, Sheet};
use crate::RecordingError;
use crate::column::Channel;
use crate::grid::{self, Form, Grid, GridColumn, Input, MOST_VALUES};
use crate::layout::Layout;

/// What a table is read from.
#[derive(Debug)]
pub(in super::super) enum Loaded<'a> {
    /// A text, and how its characters were written.
    Text(Cow<'a, [u8]>, Encoding),
    /// Columns of numbers.
    Grid(Grid),
}

impl<'a> From<&'a [u8]> for Loaded<'a> {
    fn from(bytes: &'a [u8]) -> Self {
        let (bytes, encoding) = decoded(Cow::Borrowed(bytes));
        Self::Text(bytes, encoding)
    }
}

impl<'a, const N: usize> From<&'a [u8; N]> for Loaded<'a> {
    fn from(bytes: &'a [u8; N]) -> Self {
        bytes.as_slice().into()
    }
}

/// One of the tables that are joined.
enum Table<'a> {
    File(PathBuf),
    Arrays(&'a Grid),
}

/// Loads a table, of whatever form; a folder, or a table with others beside it, is joined row by
/// row.
///
/// # Errors
/// [`RecordingError`], naming the file.
pub(in super::super) fn load<'a>(
    input: impl Into<Input<'a>>,
    layout: &Layout,
) -> Result<Loaded<'static>, RecordingError> {
    let input = input.into();
    let path = input.path();
    let mut tables = match input {
        Input::Arrays(arrays) => vec![Table::Arrays(arrays.grid())],
        Input::Path(folder) if folder.is_dir() => {
            tables_of(folder)?.into_iter().map(Table::File).collect()
        }
        Input::Path(file) if layout.beside.is_empty() => return one(file),
        Input::Path(file) => vec![Table::File(file.to_owned())],
    };
    if let ([Table::Arrays(grid)], []) = (&tables[..], &layout.beside[..]) {
        return Ok(Loaded::Grid(Grid::clone(grid)));
    }
    tables.extend(layout.beside.iter().cloned().map(Table::File));
    let mut joined = Grid { form: Form::Joined, columns: Vec::new(), left_out: Vec::new() };
    let mut first: Option<(PathBuf, usize)> = None;
    for table in tables {
        let (file, grid) = match table {
            Table::Arrays(grid) => (path.to_owned(), grid.clone()),
            Table::File(file) => {
                let grid = match one(&file)? {
                    Loaded::Grid(grid) => grid,
                    text @ Loaded::Text(..) => of_text(&file, &text)?,
                };
                (file, grid)
            }
        };
        let rows = grid.columns.first().map_or(0, |column| column.values.len());
        match &first {
            Some((before, expected)) if rows != *expected => {
                return Err(RecordingError::Joined {
                    path: file,
                    rows,
                    beside: before.clone(),
                    expected: *expected,
                });
            }
            Some(_) => {}
            None => first = Some((file, rows)),
        }
        joined.columns.extend(grid.columns);
        if joined.columns.len().saturating_mul(rows) > MOST_VALUES {
            return Err(RecordingError::Form {
                path: path.into(),
                form: Form::Joined.describe(),
                detail: format!("they hold more than {MOST_VALUES} numbers"),
                convert: "leave out the columns that are not needed",
            });
        }
        joined.left_out.extend(grid.left_out);
    }
    Ok(Loaded::Grid(joined))
}

fn one(path: &Path) -> Result<Loaded<'static>, RecordingError> {
    let bytes = files::input::table(path)
        .map_err(|source| RecordingError::Read { path: path.into(), source })?;
    grid::refuse_foreign(path, &bytes)?;
    match grid::form_of(&bytes) {
        Form::Text => {
            let (bytes, encoding) = decoded(Cow::Owned(bytes));
            if std::str::from_utf8(&bytes).is_err() {
                grid::refuse_misnamed(path)?;
            }
            Ok(Loaded::Text(bytes, encoding))
        }
        form => grid::read(path, form, &bytes).map(Loaded::Grid),
    }
}

/// Endings of tables in a folder.
const ENDINGS: [&str; 10] =
    ["csv", "tsv", "txt", "dat", "npy", "npz", "mat", "parquet", "h5", "hdf5"];

/// Whether a folder holds tables.
pub(in super::super) fn has_tables(folder: &Path) -> bool {
    tables_of(folder).is_ok_and(|files| !files.is_empty())
}

fn tables_of(folder: &Path) -> Result<Vec<PathBuf>, RecordingError> {
    let refuse = |source| RecordingError::Read { path: folder.into(), source };
    let mut files = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(refuse)? {
        let file = entry.map_err(refuse)?.path();
        let ending = file.extension().map(|ending| ending.to_string_lossy().to_lowercase());
        if file.is_file() && ending.is_some_and(|ending| ENDINGS.contains(&ending.as_str())) {
            files.push(file);
        }
    }
    files.sort();
    Ok(files)
}

/// The columns of a text of numbers. Where none of them says what it is, the file's name does: they
/// are its joints.
fn of_text(path: &Path, text: &Loaded<'_>) -> Result<Grid, RecordingError> {
    let mut sheet = Sheet::open(path, text, &Layout::default(), "t_s,position_m,force_N")?;
    let recognised = Channel::all().iter().any(|channel| sheet.knows(*channel));
    let stem = grid::stem(path);
    let named = !sheet.dialect.headerless && recognised;
    let found = (0..sheet.names.len()).map(|index| sheet.raw(index)).collect::<Vec<_>>();
    let cells = sheet.columns(&found.iter().collect::<Vec<_>>(), Missing::AsNan)?;
    let columns = sheet.columns.iter().zip(cells.values);
    let several = sheet.columns.len() > 1;
    let column = |(name, values): (&Named, Vec<f64>)| {
        if named {
            GridColumn { stem: name.full(), label: None, unit: None, values }
        } else {
            let label = several.then(|| name.raw.clone());
            GridColumn { stem: stem.clone(), label, unit: None, values }
        }
    };
    Ok(Grid { form: Form::Joined, columns: columns.map(column).collect(), left_out: Vec::new() })
}
