//! What is to be said of the values of a recording: what was done to them, and what looks wrong.
//!
//! A remark is small and has no text of its own, so that it travels with
//! [`Irregularities`](crate::Irregularities). It never changes a sample, but for
//! [an angle that wraps](Wrapped).

mod contradiction;
mod cut;
mod label;
mod made;
mod read;
mod scaled;
mod spikes;
mod taken;
mod watched;
mod wrapped;

use serde::Serialize;

pub use contradiction::Contradiction;
pub use cut::Cut;
pub use label::Label;
pub(crate) use read::Read;
pub use scaled::Scaled;
pub(crate) use scaled::scale_of;
pub use spikes::Spikes;
pub use taken::Taken;
pub use watched::Used;
pub(crate) use watched::{Both, Watched};
pub use wrapped::Wrapped;
pub(crate) use wrapped::{Angle, unwrap};

/// What is to be said of the values of a recording.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Remarks {
    /// The position wrapped, and was made to go on.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub wrapped: Option<Wrapped>,
    /// Position and velocity do not say the same.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub contradiction: Option<Contradiction>,
    /// Of the time.
    #[serde(skip_serializing_if = "Marks::is_empty")]
    pub time: Marks,
    /// Of the position.
    #[serde(skip_serializing_if = "Marks::is_empty")]
    pub position: Marks,
    /// Of the velocity.
    #[serde(skip_serializing_if = "Marks::is_empty")]
    pub velocity: Marks,
    /// Of the force, or what stands in its place.
    #[serde(skip_serializing_if = "Marks::is_empty")]
    pub force: Marks,
}

/// What is to be said of one channel.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Marks {
    /// Its name does not say plainly what it is.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub taken: Option<Taken>,
    /// A scale was given in place of the unit in its name.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scaled: Option<Scaled>,
    /// It is cut at its largest or smallest value.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cut: Option<Cut>,
    /// Single samples are far outside their neighbours.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub spikes: Option<Spikes>,
}

impl Marks {
    /// Whether there is nothing to say.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    fn and(self, other: Self) -> Self {
        Self {
            taken: self.taken.or(other.taken),
            scaled: self.scaled.or(other.scaled),
            cut: both(self.cut, other.cut, Cut::and),
            spikes: both(self.spikes, other.spikes, Spikes::and),
        }
    }

    fn sentences(self) -> impl Iterator<Item = String> {
        let taken = self.taken.map(Taken::describe);
        let scaled = self.scaled.map(Scaled::describe);
        taken.into_iter().chain(scaled).chain(self.spikes.map(Spikes::describe))
    }
}

impl Remarks {
    /// Whether there is nothing to say.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// Those of two recordings that are taken for one.
    #[must_use]
    pub(crate) fn and(self, other: Self) -> Self {
        Self {
            wrapped: both(self.wrapped, other.wrapped, Wrapped::and),
            contradiction: self.contradiction.or(other.contradiction),
            time: self.time.and(other.time),
            position: self.position.and(other.position),
            velocity: self.velocity.and(other.velocity),
            force: self.force.and(other.force),
        }
    }

    /// What puts every number in doubt that comes from the recording, in sentences without their
    /// full stops.
    #[must_use]
    pub fn doubts(&self) -> Vec<String> {
        let contradiction = self.contradiction.map(Contradiction::describe);
        let cuts = self.marks().into_iter().filter_map(|marks| marks.cut).map(Cut::describe);
        contradiction.into_iter().chain(cuts).collect()
    }

    /// All else, in sentences without their full stops.
    #[must_use]
    pub fn sentences(&self) -> Vec<String> {
        let wrapped = self.wrapped.map(Wrapped::describe);
        let marks = self.marks().into_iter().flat_map(Marks::sentences);
        wrapped.into_iter().chain(marks).collect()
    }

    const fn marks(&self) -> [Marks; 4] {
        [self.time, self.position, self.velocity, self.force]
    }
}

/// One of the two, or what both make together.
fn both<T>(one: Option<T>, other: Option<T>, and: impl Fn(T, T) -> T) -> Option<T> {
    match (one, other) {
        (Some(one), Some(other)) => Some(and(one, other)),
        (one, other) => one.or(other),
    }
}

/// A number in few digits.
fn short(value: f64) -> f64 {
    format!("{value:.3e}").parse().unwrap_or(value)
}

/// A number in so many digits that it can be given as a scale.
fn exact(value: f64) -> f64 {
    format!("{value:.5e}").parse().unwrap_or(value)
}

/// ` N m`, or nothing where the unit is not known.
fn spaced(unit: &str) -> String {
    if unit.is_empty() { String::new() } else { format!(" {unit}") }
}
