//! What a column is called: its name, its unit, and the joint that it belongs to.

use crate::column::Channel;
use crate::grid::GridColumn;
use crate::units;

/// A column's name.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Named {
    /// As the file has it.
    pub raw: String,
    /// With its unit, without the joint.
    pub stem: String,
    /// The joint that it belongs to, where a name stands for several.
    pub label: Option<String>,
    /// The unit that stands below the name, or that the file says apart from it.
    unit: Option<String>,
}

impl Named {
    /// The columns of what is no text.
    pub(super) fn of_grid(columns: &[GridColumn]) -> Vec<Self> {
        let plain: Vec<&str> = columns.iter().map(|column| own(&column.stem)).collect();
        let mut named: Vec<Self> =
            columns.iter().map(|column| Self::of_column(column, &plain)).collect();
        told_apart(&mut named);
        named
    }

    fn of_column(column: &GridColumn, plain: &[&str]) -> Self {
        let GridColumn { stem, label, unit, .. } = column;
        let own = own(stem);
        let raw = match label {
            Some(label) => format!("{stem}[{label}]"),
            None => stem.clone(),
        };
        let split = if label.is_none() { numbered(own) } else { None };
        let split = split.filter(|(stem, _)| !plain.contains(&stem.as_str()));
        let (stem, label) = match split {
            Some((stem, number)) => (stem, Some(number)),
            None => (own.to_owned(), label.clone()),
        };
        // What the file says itself is true of its numbers, whatever the name says.
        let unit = unit.clone();
        let stem = match &unit {
            Some(unit) => format!("{} [{unit}]", units::parts(&stem).stem),
            None => stem,
        };
        Self { raw, stem, label, unit }
    }

    /// Names of a text, with the units below them. Where a `joint` is asked for, or several names
    /// differ in a number alone, as `q1` and `q2`, that is the joint.
    pub(super) fn of_text(
        names: &[String],
        units: Option<&[Option<String>]>,
        joint: bool,
    ) -> Vec<Self> {
        let known_plainly = |name: &String| {
            joint
                || !names.iter().any(|other| numbered(name).is_some_and(|(stem, _)| *other == stem))
        };
        let one = |(index, name): (usize, &String)| {
            let below = units.and_then(|units| units.get(index)).and_then(Option::as_ref);
            let unit = below.filter(|_| units::parts(name).unit.is_none()).cloned();
            let split = numbered(name).filter(|_| known_plainly(name));
            let (stem, label) = match split {
                Some((stem, number)) => (stem, Some(number)),
                None => (name.clone(), None),
            };
            let stem = match &unit {
                Some(unit) => format!("{stem} [{unit}]"),
                None => stem,
            };
            Self { raw: name.clone(), stem, label, unit }
        };
        let mut named: Vec<Self> = names.iter().enumerate().map(one).collect();
        told_apart(&mut named);
        named
    }

    /// The name with the unit below it, or apart from it.
    pub(super) fn full(&self) -> String {
        match &self.unit {
            Some(unit) => format!("{} [{unit}]", self.raw),
            None => self.raw.clone(),
        }
    }

    /// The name without the joint and without the unit apart from it.
    pub(super) fn bare(&self) -> &str {
        match &self.unit {
            Some(_) => self.stem.rsplit_once(" [").map_or(self.stem.as_str(), |(bare, _)| bare),
            None => match self
                .label
                .as_ref()
                .and_then(|label| self.raw.strip_suffix(&format!("[{label}]")))
            {
                Some(bare) => bare,
                None => &self.stem,
            },
        }
    }
}

/// Takes the unit from names such as `i_a` beside `i_b`, which are two phases, and `q_m` beside
/// `q_l`, a motor and its load: a letter that tells columns apart is no unit.
fn told_apart(columns: &mut [Named]) {
    /// Letters that are the unit of something else beside it, as `force_V` is beside `force_N`.
    const UNITS: [&str; 5] = ["N", "V", "A", "m", "s"];
    let parts = |name: &Named| {
        let (stem, last) = name.stem.rsplit_once('_')?;
        let letter = last.len() == 1 && last.bytes().all(|byte| byte.is_ascii_alphabetic());
        letter.then(|| (stem.to_owned(), last.to_owned()))
    };
    let all: Vec<_> = columns.iter().map(parts).collect();
    for (column, own) in columns.iter_mut().zip(&all) {
        let Some((stem, last)) = own else { continue };
        let sibling = all.iter().flatten().any(|(other_stem, other)| {
            stem == other_stem && last != other && !UNITS.contains(&other.as_str())
        });
        if sibling && units::unit_of(last).is_some() {
            column.stem = format!("{stem}{last}");
        }
    }
}

/// Of `data.q` it is `q` that says what it is; of `velocity_rad.s^-1` it is all.
fn own(stem: &str) -> &str {
    let own = stem.rsplit_once('.').map_or(stem, |(_, own)| own);
    if units::parts(stem).unit.is_some() && units::parts(own).unit.is_none() { stem } else { own }
}

/// A name that a number ends, as in `q1`, `q_1`, `q[1]`, `q1 [rad]` or `q_1_rad`: the name without
/// the number, and the number. Only of names that are recognised without it.
fn numbered(name: &str) -> Option<(String, String)> {
    let found = units::parts(name);
    let (bare, close) = match found.stem.strip_suffix([']', ')']) {
        Some(bare) => (bare, true),
        None => (found.stem, false),
    };
    let digits = bare.len() - bare.trim_end_matches(|c: char| c.is_ascii_digit()).len();
    let (stem, number) = bare.split_at(bare.len() - digits);
    if digits == 0 || digits > 3 {
        return None;
    }
    let stem = if close { stem.strip_suffix(['[', '('])? } else { stem };
    let stem = stem.trim_end_matches(['_', ' ', '.']);
    let name = match found.unit {
        Some(unit) => format!("{stem} [{unit}]"),
        None => stem.to_owned(),
    };
    Channel::of_joints()
        .iter()
        .any(|channel| channel.recognise(std::slice::from_ref(&name)).is_some())
        .then(|| (name, number.to_owned()))
}
