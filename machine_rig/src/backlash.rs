//! A load behind backlash.
//!
//! Motor and load are two bodies. Within the play nothing passes between them; at either end the
//! teeth meet as a stiff, damped spring that pushes and never pulls.

use serde::{Deserialize, Serialize};

/// The play, and what is behind it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Backlash {
    /// Whole width of the play \[rad\], zero or more.
    pub width: f64,
    /// Inertia behind it [kg m^2], above zero.
    pub inertia: f64,
    /// Stiffness of the teeth [N m/rad], above zero.
    pub stiffness: f64,
}

/// Damping of the teeth's contact, as a share of the critical one.
const DAMPING: f64 = 0.3;

/// The load where it is.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Load {
    position: f64,
    velocity: f64,
}

impl Load {
    /// The torque that the motor's side gives it at that position and velocity [N m].
    pub(crate) fn taken(&self, play: &Backlash, position: f64, velocity: f64) -> f64 {
        let apart = position - self.position;
        let pressed = apart - apart.clamp(-0.5 * play.width, 0.5 * play.width);
        let damping = DAMPING * 2.0 * (play.stiffness * play.inertia).sqrt();
        let force = play.stiffness * pressed + damping * (velocity - self.velocity);
        // Teeth do not pull.
        if pressed > 0.0 {
            force.max(0.0)
        } else if pressed < 0.0 {
            force.min(0.0)
        } else {
            0.0
        }
    }

    /// Goes on for `h` \[s\] under `torque`.
    pub(crate) fn advance(&mut self, play: &Backlash, torque: f64, h: f64) {
        self.velocity += h * torque / play.inertia;
        self.position += h * self.velocity;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_passes_within_the_play_and_the_load_follows_at_its_end() {
        let play = Backlash { width: 0.02, inertia: 1e-3, stiffness: 100.0 };
        let mut load = Load::default();
        assert_eq!(load.taken(&play, 0.0099, 5.0), 0.0);
        assert!(load.taken(&play, 0.011, 0.0) > 0.0 && load.taken(&play, -0.011, 0.0) < 0.0);
        // A motor that goes on steadily takes the load along within the play: it may bounce there.
        let (mut position, mut farthest) = (0.0, 0.0_f64);
        for _ in 0..200_000 {
            position += 1e-5;
            let torque = load.taken(&play, position, 1.0);
            load.advance(&play, torque, 1e-5);
            farthest = farthest.max((position - load.position).abs());
        }
        assert!(load.velocity > 0.5 && farthest < 0.5 * play.width + 4e-3, "{load:?} {farthest}");
    }
}
