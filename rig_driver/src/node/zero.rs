//! Zeros found by `~/zero_sensors`, taken off every measurement.

use crate::Measurement;

/// Cycles over which zeros are averaged.
const CYCLES: u32 = 200;

/// What counts as zero.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Zero {
    pub(super) position: f64,
    counts: i64,
    pub(super) velocity: f64,
    pub(super) torque: f64,
    /// Cycles still to be averaged, with the sums so far.
    left: u32,
    sums: [f64; 2],
    /// How many times zeros were found.
    pub(super) found: u32,
}

impl Zero {
    /// Finds zeros anew, from the next cycles; meanwhile nothing is taken off.
    pub(super) fn find(&mut self) {
        *self = Self { left: CYCLES, found: self.found, ..Self::default() };
    }

    pub(super) fn apply(&mut self, raw: &Measurement) -> Measurement {
        if self.left > 0 {
            self.left -= 1;
            self.sums[0] += raw.tachometer_velocity;
            self.sums[1] += raw.torque;
            if self.left == 0 {
                self.velocity = self.sums[0] / f64::from(CYCLES);
                self.torque = self.sums[1] / f64::from(CYCLES);
                (self.position, self.counts) = (raw.encoder_position, raw.encoder_counts);
                self.found = self.found.wrapping_add(1);
            }
        }
        Measurement {
            encoder_position: raw.encoder_position - self.position,
            encoder_counts: raw.encoder_counts - self.counts,
            tachometer_velocity: raw.tachometer_velocity - self.velocity,
            torque: raw.torque - self.torque,
            ..*raw
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn after_the_average_the_resting_shaft_reads_zero() {
        let mut zero = Zero::default();
        let raw = Measurement {
            encoder_counts: 40,
            encoder_position: 0.06,
            tachometer_velocity: 0.02,
            torque: -0.003,
            ..Measurement::default()
        };
        assert_eq!(zero.apply(&raw), raw, "nothing is taken off before");
        zero.find();
        for _ in 0..CYCLES - 1 {
            assert_eq!(zero.apply(&raw), raw);
        }
        let seen = zero.apply(&raw);
        assert_eq!((seen.encoder_counts, seen.encoder_position, zero.found), (0, 0.0, 1));
        assert!(seen.tachometer_velocity.abs() < 1e-15 && seen.torque.abs() < 1e-15, "{seen:?}");
    }
}
