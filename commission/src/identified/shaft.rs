//! The shaft: `T w' + w = K (u - F(w))` with the curve that was fitted, in volts, and a delay.

use crate::loop_design::Plant;

/// Parts of a cycle that are computed one by one.
const PARTS: u32 = 4;
/// Longest delay, in cycles.
const LONGEST: usize = 64;

/// A friction curve in volts, without its viscous part.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Levels {
    /// Static level \[V\].
    pub f_s: f64,
    /// Kinetic level \[V\].
    pub f_c: f64,
    /// Stribeck velocity [rad/s].
    pub v_s: f64,
    /// Shape of the dip.
    pub delta: f64,
}

impl Levels {
    /// The level at a speed [rad/s] \[V\].
    #[must_use]
    pub fn at(&self, speed: f64) -> f64 {
        self.f_c + (self.f_s - self.f_c) * (-(speed.abs() / self.v_s).powf(self.delta)).exp()
    }
}

/// What was identified of a drive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Identified {
    /// The drive.
    pub plant: Plant,
    /// Its friction.
    pub levels: Levels,
}

impl Identified {
    /// The same with friction times `friction`, and gain times `gain`; its inertia stays.
    #[must_use]
    pub fn scaled(self, friction: f64, gain: f64) -> Self {
        let Levels { f_s, f_c, .. } = self.levels;
        let levels = Levels { f_s: friction * f_s, f_c: friction * f_c, ..self.levels };
        let mut plant = self.plant;
        plant.drive.gain *= gain;
        Self { plant, levels }
    }
}

/// A shaft that moves.
#[derive(Debug, Clone)]
pub struct Shaft {
    identified: Identified,
    decay: f64,
    /// Whole cycles of the delay, and the share of one more.
    late: (usize, f64),
    given: [f64; LONGEST + 2],
    position: f64,
    velocity: f64,
}

impl Shaft {
    /// A shaft that moves at `velocity` [rad/s] from zero, under the voltage that holds it there.
    #[must_use]
    pub fn new(identified: Identified, velocity: f64) -> Self {
        let Plant { drive, delay, period, .. } = identified.plant;
        let cycles = (delay / period).clamp(0.0, LONGEST as f64);
        let holding = if velocity == 0.0 {
            0.0
        } else {
            velocity / drive.gain + velocity.signum() * identified.levels.at(velocity)
        };
        Self {
            identified,
            decay: (-period / f64::from(PARTS) / drive.time_constant).exp(),
            late: (cycles.floor() as usize, cycles.fract()),
            given: [holding; LONGEST + 2],
            position: 0.0,
            velocity,
        }
    }

    /// Where it is \[rad\].
    #[must_use]
    pub const fn position(&self) -> f64 {
        self.position
    }

    /// How fast it is [rad/s].
    #[must_use]
    pub const fn velocity(&self) -> f64 {
        self.velocity
    }

    /// One cycle under `volts`, told now.
    pub fn step(&mut self, volts: f64) {
        self.given.copy_within(0..=LONGEST, 1);
        self.given[0] = volts;
        let (whole, share) = self.late;
        let at = |cycles: usize| self.given.get(cycles).copied().unwrap_or(volts);
        let volts = (1.0 - share) * at(whole) + share * at(whole + 1);
        let Identified { plant, levels } = self.identified;
        let part = plant.period / f64::from(PARTS);
        for _ in 0..PARTS {
            let gain = (1.0 - self.decay) * plant.drive.gain;
            let free = self.decay * self.velocity + gain * volts;
            // Friction takes the shaft to rest at most: the sign at the end of the step.
            let taken = gain * levels.at(self.velocity);
            let after = free.signum() * (free.abs() - taken).max(0.0);
            self.position += 0.5 * (self.velocity + after) * part;
            self.velocity = after;
        }
    }
}

#[cfg(test)]
mod tests {
    use controller::design::LinearDrive;

    use super::*;

    pub(crate) fn identified() -> Identified {
        let plant = Plant {
            drive: LinearDrive::THESIS,
            delay: 0.0015,
            period: 1e-3,
            encoder_step: std::f64::consts::TAU / 4096.0,
            voltage_limit: 6.0,
        };
        Identified { plant, levels: Levels { f_s: 0.5, f_c: 0.4, v_s: 0.1, delta: 2.0 } }
    }

    #[test]
    fn it_sticks_below_the_static_level_and_turns_as_the_curve_says() {
        let mut shaft = Shaft::new(identified(), 0.0);
        (0..1000).for_each(|_| shaft.step(0.49));
        assert_eq!(shaft.position(), 0.0);
        (0..3000).for_each(|_| shaft.step(2.4));
        let before = shaft.position();
        shaft.step(2.4);
        let speed = (shaft.position() - before) / 1e-3;
        assert!((speed / (LinearDrive::THESIS.gain * 2.0) - 1.0).abs() < 1e-6, "{speed}");
    }

    #[test]
    fn what_is_told_acts_after_the_delay() {
        let mut shaft = Shaft::new(identified(), 1.0);
        let quiet = shaft.clone();
        let mut quiet = quiet;
        let holding = quiet.given[0];
        let mut moved = Vec::new();
        for k in 0..4 {
            shaft.step(if k == 0 { holding + 1.0 } else { holding });
            quiet.step(holding);
            moved.push(shaft.position() - quiet.position());
        }
        assert_eq!(moved[0], 0.0);
        assert!(moved[1] > 0.0 && moved[2] > moved[1], "{moved:?}");
    }
}
