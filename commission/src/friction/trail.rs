//! What a block says of the places it went over: the voltage in short parts of both ways, less what
//! the speed's own changes take.

use rig_driver::Measurement;
use serde::{Deserialize, Serialize};

/// Parts of each way.
pub(crate) const PARTS: usize = 64;

/// A part of a way: where it was by the rig's own count \[rad\], and the voltage \[V\].
pub(crate) type Part = (f64, f64);

/// What a block says of its places. The same friction acts against both ways, and the same load in
/// one direction whichever way the shaft goes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Trail {
    /// Speed [rad/s].
    pub velocity: f64,
    /// Length of a part \[rad\].
    pub length: f64,
    /// Forwards: place \[rad\] and voltage \[V\].
    pub forward: Vec<Part>,
    /// Backwards.
    pub backward: Vec<Part>,
}

/// What turns a voltage into motion.
#[derive(Debug, Clone, Copy)]
pub(super) struct Driven {
    /// Gain [rad/(V s)].
    pub(super) gain: f64,
    /// Voltage that an acceleration takes \[V s^2/rad\].
    pub(super) inertia: f64,
    /// Delay \[s\].
    pub(super) delay: f64,
}

impl Driven {
    /// The trail of a block of which `seen` is told from `origin` \[rad\] on; its windows forwards
    /// and backwards begin at `begins` \[s\] and last for `seconds`.
    pub(super) fn trail(
        self,
        seen: &[Measurement],
        (velocity, origin, period): (f64, f64, f64),
        (begins, seconds): ((f64, f64), f64),
    ) -> Option<Trail> {
        let way = |begins: f64| self.way(seen, origin, period, (begins, seconds));
        Some(Trail {
            velocity,
            length: velocity * seconds / PARTS as f64,
            forward: way(begins.0)?,
            backward: way(begins.1)?,
        })
    }

    fn way(
        self,
        seen: &[Measurement],
        origin: f64,
        period: f64,
        (begins, seconds): (f64, f64),
    ) -> Option<Vec<Part>> {
        let cycle = |part: usize| {
            ((begins + seconds * part as f64 / PARTS as f64) / period).round() as usize
        };
        // What moves the shaft was told so many cycles before, and a reading tells the cycle before
        // it.
        let late = (self.delay / period).round() as usize;
        let mean = |cycles: &[Measurement], of: fn(&Measurement) -> f64| {
            cycles.iter().map(of).sum::<f64>() / cycles.len() as f64
        };
        let mut places = Vec::with_capacity(PARTS);
        let mut volts = Vec::with_capacity(PARTS);
        for part in 0..PARTS {
            let (from, to) = (cycle(part), cycle(part + 1));
            let told = (from + 1).saturating_sub(late)..(to + 1).saturating_sub(late);
            let (moved, told) = (seen.get(from..to)?, seen.get(told)?);
            if moved.is_empty() {
                return None;
            }
            places.push(mean(moved, |seen| seen.encoder_position));
            volts.push(mean(told, |seen| seen.voltage_applied));
        }
        let h = seconds / PARTS as f64;
        let part = |i: usize| {
            let (before, now, after) = (places[i - 1], places[i], places[i + 1]);
            let speed = (after - before) / (2.0 * h);
            let acceleration = (after - 2.0 * now + before) / (h * h);
            (origin + now, volts[i] - self.inertia * acceleration - speed / self.gain)
        };
        Some((1..PARTS - 1).map(part).collect())
    }
}
