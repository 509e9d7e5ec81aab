//! The channels that remarks are made of, as they were read.

use serde::Serialize;

/// A channel as it was read.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Watched<'a> {
    /// What it is called.
    pub name: &'a str,
    /// What its values were multiplied with.
    pub scale: f64,
    /// Its unit; empty where it is not known.
    pub unit: &'static str,
    /// Its values. What is no number was not there.
    pub values: &'a [f64],
}

/// A position and a velocity of one axis.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Both<'a> {
    pub position: Watched<'a>,
    pub velocity: Watched<'a>,
    /// Which of them is used.
    pub used: Used,
}

/// Which of a position and a velocity is used.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Used {
    /// The position.
    Position,
    /// The velocity, as it was named.
    Velocity,
    /// The velocity, with the position beside it.
    Both,
    /// The velocity of a message, which has no options.
    Message,
}
