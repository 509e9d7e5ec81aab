//! Remarks on channels, as they are made.

use super::{Both, Contradiction, Cut, Marks, Remarks, Spikes, Watched};

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
