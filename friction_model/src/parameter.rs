//! Parameters: their names, units and ranges in one table per model, and the checks that every set
//! passes before a model exists.

use core::fmt;

use crate::{ModelError, Range, Real, Unit};

/// Magnitudes that a parameter other than zero may have: far beyond any machine, and near enough to
/// one that products and quotients of some of them are numbers.
const MAGNITUDES: core::ops::RangeInclusive<f64> = 1e-50..=1e50;

/// One row of a model's parameter table.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parameter {
    /// Name in files.
    pub name: &'static str,
    /// What it is, in a sentence; with its unit in brackets.
    pub meaning: &'static str,
    /// Its unit.
    pub unit: Unit,
    /// What each of its values must satisfy; conditions between parameters are checked when the
    /// model is built.
    pub range: Range,
    /// Whether a file may leave it out.
    pub optional: bool,
}

/// The parameters of a model as files carry them: plain numbers, not yet checked against each
/// other.
pub trait ParameterSet: Clone + fmt::Debug + PartialEq {
    /// One row a field, in the order of the fields.
    const TABLE: &'static [Parameter];

    /// Calls `f` with every number of the parameter `name`; not at all if there is none of that
    /// name.
    fn each(&self, name: &str, f: &mut dyn FnMut(f64));

    /// Multiplies the parameter `name` by `factor`; false if there is none of that name.
    fn scale(&mut self, name: &str, factor: f64) -> bool;

    /// Sets the parameter `name` to `value`; false if there is none of that name, or if it is a
    /// list.
    fn set(&mut self, name: &str, value: f64) -> bool;

    /// Sets the number at `index` of the parameter `name` to `value`; false if there is none.
    fn set_at(&mut self, name: &str, index: usize, value: f64) -> bool;

    /// Checks every number against its range, and that no magnitude is beyond all machines.
    ///
    /// # Errors
    /// [`ModelError::OutOfRange`] for the first that lies outside.
    fn check(&self, model: &'static str) -> Result<(), ModelError> {
        let mut outcome = Ok(());
        for row in Self::TABLE {
            self.each(row.name, &mut |value| {
                if outcome.is_ok() && !row.range.holds(value) {
                    outcome = Err(row.refusal(model, value, row.range));
                } else if outcome.is_ok() && value != 0.0 && !MAGNITUDES.contains(&value.abs()) {
                    let expected = Range::Such("zero or of a magnitude from 1e-50 to 1e50");
                    outcome = Err(row.refusal(model, value, expected));
                }
            });
        }
        outcome
    }

    /// Checks a condition between parameters: an error naming `parameter` unless `holds`.
    ///
    /// # Errors
    /// [`ModelError::OutOfRange`].
    fn require<T: Real>(
        &self,
        model: &'static str,
        holds: bool,
        parameter: &'static str,
        value: T,
        condition: &'static str,
    ) -> Result<(), ModelError> {
        if holds {
            return Ok(());
        }
        let unit =
            Self::TABLE.iter().find(|row| row.name == parameter).map_or(Unit::None, |row| row.unit);
        Err(ModelError::OutOfRange {
            model,
            parameter,
            value: value.double(),
            unit,
            expected: Range::Such(condition),
        })
    }
}

impl Parameter {
    fn refusal(&self, model: &'static str, value: f64, expected: Range) -> ModelError {
        ModelError::OutOfRange { model, parameter: self.name, value, unit: self.unit, expected }
    }
}
