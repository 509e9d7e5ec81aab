//! What a declaration says of a field beside its name, type and default.

use crate::{Declaration, ParameterValue, ValueRange};

/// Meaning, unit and range of a field, as the macro [`parameters!`](crate::parameters) takes them.
#[derive(Debug, Clone, Copy, Default)]
pub struct Spec {
    meaning: &'static str,
    unit: &'static str,
    more: &'static str,
    constraint: &'static str,
    range: ValueRange,
    among: Option<fn() -> String>,
    choices: Option<fn() -> Vec<&'static str>>,
    read_only: bool,
}

impl Spec {
    /// What it is, without its unit.
    #[must_use]
    pub const fn new(meaning: &'static str) -> Self {
        Self {
            meaning,
            unit: "",
            more: "",
            constraint: "",
            range: ValueRange::Any,
            among: None,
            choices: None,
            read_only: false,
        }
    }

    /// Its unit; a pure number has none.
    #[must_use]
    pub const fn unit(self, unit: &'static str) -> Self {
        Self { unit, ..self }
    }

    /// What is said behind the unit.
    #[must_use]
    pub const fn more(self, more: &'static str) -> Self {
        Self { more, ..self }
    }

    /// What it may be, in words that are only known while the program runs; they stand behind a
    /// colon.
    #[must_use]
    pub const fn among(self, among: fn() -> String) -> Self {
        Self { among: Some(among), ..self }
    }

    /// What else it must satisfy, in words.
    #[must_use]
    pub const fn constraint(self, constraint: &'static str) -> Self {
        Self { constraint, ..self }
    }

    /// The values that a number may take.
    #[must_use]
    pub const fn range(self, range: ValueRange) -> Self {
        Self { range, ..self }
    }

    /// The texts that it may be.
    #[must_use]
    pub const fn choices(self, choices: fn() -> Vec<&'static str>) -> Self {
        Self { choices: Some(choices), ..self }
    }

    /// Set when the program starts only.
    #[must_use]
    pub const fn read_only(self) -> Self {
        Self { read_only: true, ..self }
    }

    /// The values that a number may take.
    #[must_use]
    pub const fn allowed(&self) -> ValueRange {
        self.range
    }

    /// The declaration of a parameter of that name and default.
    #[must_use]
    pub fn declaration(&self, name: &str, default: ParameterValue) -> Declaration {
        let mut text = self.meaning.to_owned();
        if !self.unit.is_empty() {
            text += &format!(" [{}]", self.unit);
        }
        if !self.more.is_empty() {
            text += &format!("; {}", self.more);
        }
        if let Some(among) = self.among {
            text += &format!(": {}", among());
        }
        let mut declaration = Declaration::new(name, default, text).range(self.range);
        if let Some(choices) = self.choices {
            declaration = declaration.choices(choices());
        }
        if !self.constraint.is_empty() {
            declaration = declaration.constraint(self.constraint);
        }
        if self.read_only { declaration.read_only() } else { declaration }
    }
}
