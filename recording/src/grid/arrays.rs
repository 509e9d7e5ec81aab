//! Columns of numbers that are in memory already, read as a file that holds them is.

use std::path::{Path, PathBuf};

use super::assemble::assemble;
use super::{Contents, Form, Grid, MOST_VALUES, Variable};
use crate::RecordingError;

/// Columns of numbers in memory. They are recognised, converted and checked as those of a file.
#[derive(Debug, Clone, PartialEq)]
pub struct Arrays {
    name: PathBuf,
    grid: Grid,
}

/// One of them: a vector, or a matrix with a column for each joint.
#[derive(Debug, Clone, PartialEq)]
pub struct Array {
    /// What it is called, with its unit, as in `velocity_rad_s`.
    pub name: String,
    /// Its rows, one a sample.
    pub rows: usize,
    /// Its values by columns, NaN where there is none.
    pub values: Vec<f64>,
}

impl Array {
    /// A vector.
    #[must_use]
    pub fn vector(name: impl Into<String>, values: Vec<f64>) -> Self {
        Self { name: name.into(), rows: values.len(), values }
    }
}

impl Arrays {
    /// Columns of one length; `name` is what the results and complaints call them.
    ///
    /// # Errors
    /// [`RecordingError::Form`] for arrays of different lengths, for none, and for more numbers
    /// than a file may hold.
    pub fn new(name: impl Into<PathBuf>, arrays: Vec<Array>) -> Result<Self, RecordingError> {
        let name = name.into();
        let refuse = |detail: String| RecordingError::Arrays { path: name.clone(), detail };
        let Some(first) = arrays.first() else {
            return Err(refuse("there is no array".to_owned()));
        };
        if let Some(other) = arrays.iter().find(|array| array.rows != first.rows) {
            return Err(refuse(format!(
                "`{}` has {} values, but `{}` has {}",
                first.name, first.rows, other.name, other.rows
            )));
        }
        if first.rows == 0 {
            return Err(refuse(format!("`{}` is empty", first.name)));
        }
        if arrays.iter().map(|array| array.values.len()).sum::<usize>() > MOST_VALUES {
            return Err(refuse(format!("they hold more than {MOST_VALUES} numbers")));
        }
        let variable = |Array { name, rows, values }: Array| {
            let columns = values.len() / rows;
            Variable { name, unit: None, rows, columns, values }
        };
        let contents = Contents {
            variables: arrays.into_iter().map(variable).collect(),
            ..Contents::default()
        };
        let grid = assemble(Form::Arrays, contents).map_err(refuse)?;
        Ok(Self { name, grid })
    }

    /// What they are called.
    #[must_use]
    pub fn name(&self) -> &Path {
        &self.name
    }

    pub(in super::super) const fn grid(&self) -> &Grid {
        &self.grid
    }
}

/// What a recording is read from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Input<'a> {
    /// A file or a folder.
    Path(&'a Path),
    /// Columns in memory.
    Arrays(&'a Arrays),
}

impl<'a> Input<'a> {
    /// The file, or what the columns are called.
    #[must_use]
    pub fn path(self) -> &'a Path {
        match self {
            Self::Path(path) => path,
            Self::Arrays(arrays) => arrays.name(),
        }
    }

    /// Whether it is a bag: columns in memory are none.
    #[must_use]
    pub fn is_bag(self) -> bool {
        matches!(self, Self::Path(path) if crate::is_bag(path))
    }
}

impl<'a, P: AsRef<Path> + ?Sized> From<&'a P> for Input<'a> {
    fn from(path: &'a P) -> Self {
        Self::Path(path.as_ref())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stretches;
    use crate::table::{self, Columns};

    fn arrays(columns: &[(&str, &[f64])]) -> Result<Arrays, RecordingError> {
        let array = |(name, values): &(&str, &[f64])| Array::vector(*name, values.to_vec());
        Arrays::new("arrays", columns.iter().map(array).collect())
    }

    #[test]
    fn columns_in_memory_are_read_as_a_file_with_them_is() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("x.csv");
        std::fs::write(&path, "t_ms,position_deg,torque_Nm\n0,180,1\n10,90,2\n20,0,3\n30,9,\n")
            .unwrap();
        let columns = [
            ("t_ms", &[0.0, 10.0, 20.0, 30.0][..]),
            ("position_deg", &[180.0, 90.0, 0.0, 9.0]),
            ("torque_Nm", &[1.0, 2.0, 3.0, f64::NAN]),
        ];
        let given = arrays(&columns).unwrap();
        let read = |input: Input<'_>| table::read(input, &Columns::default(), 0.05).unwrap();
        let (here, there) = (read(Input::Arrays(&given)), read(Input::from(&path)));
        assert_eq!((here.position, here.force), (there.position, there.force));
        assert_eq!((here.time_step, here.axis), (there.time_step, there.axis));
        assert_eq!(here.irregularities.blank, 1);
        assert_eq!(here.path, Path::new("arrays"));
    }

    #[test]
    fn steady_points_in_memory_are_steady_points() {
        let given =
            arrays(&[("velocity_rad_s", &[1.0, 2.0, 3.0]), ("torque_Nm", &[0.1, 0.2, 0.3])]);
        let given = given.unwrap();
        assert!(stretches::holds_points(Input::Arrays(&given), &Columns::default()));
        let how = stretches::Preparation::default();
        let read = stretches::read(Input::Arrays(&given), &Columns::default(), &how).unwrap();
        assert_eq!(read.points.len(), 3);
    }

    #[test]
    fn a_matrix_has_a_column_for_each_joint() {
        let matrix = Array { name: "q".to_owned(), rows: 2, values: vec![1.0, 2.0, 3.0, 4.0] };
        let time = Array::vector("t", vec![0.0, 1.0]);
        let given = Arrays::new("arrays", vec![time, matrix]).unwrap();
        assert_eq!(given.grid().columns.len(), 3);
        assert_eq!(given.grid().columns[2].values, [3.0, 4.0]);
    }

    #[test]
    fn arrays_that_are_no_table_are_refused_with_the_reason() {
        let said = |columns: &[(&str, &[f64])]| arrays(columns).unwrap_err().to_string();
        let uneven = said(&[("t", &[1.0, 2.0]), ("q", &[1.0])]);
        assert!(uneven.contains("`t` has 2 values, but `q` has 1"), "{uneven}");
        assert!(said(&[]).contains("no array"));
        assert!(said(&[("t", &[])]).contains("`t` is empty"));
    }
}
