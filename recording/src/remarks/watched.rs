//! The channels that remarks are made of, as they were read.

use super::{Contradiction, Cut, Marks, Remarks, Spikes, Used};

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

impl Remarks {
    /// With what the position and the velocity say of each other.
    #[must_use]
    pub(crate) fn compared(mut self, time: &[f64], both: Both<'_>) -> Self {
        self.contradiction = Contradiction::of(time, both);
        self
    }

    /// With what is to be said of a position.
    #[must_use]
    pub(crate) fn of_position(mut self, time: &[f64], position: Watched<'_>) -> Self {
        self.position.spikes = Spikes::of(time, position, false);
        self
    }

    /// With what is to be said of a velocity, beside a force.
    #[must_use]
    pub(crate) fn of_velocity(
        mut self,
        time: &[f64],
        velocity: Watched<'_>,
        force: Option<&[f64]>,
    ) -> Self {
        let spikes = Spikes::of(time, velocity, false);
        self.velocity = Marks { cut: Cut::of(velocity, force), spikes, ..self.velocity };
        self
    }

    /// With what is to be said of a force.
    #[must_use]
    pub(crate) fn of_force(mut self, time: &[f64], force: Watched<'_>) -> Self {
        let spikes = Spikes::of(time, force, true);
        self.force = Marks { cut: Cut::of(force, None), spikes, ..self.force };
        self
    }
}
