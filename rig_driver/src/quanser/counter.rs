//! Counters that wrap.

/// Makes one count without end of a counter of few bits.
///
/// The Q2-USB counts in 16 bits: at 4096 counts a turn it wraps after eight turns to either side.
/// Between two readings the shaft must turn by less than half the range.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct UnwrappedCounter {
    bits: u32,
    last: Option<i32>,
    total: i64,
}

impl UnwrappedCounter {
    /// A counter of `bits` bits, brought to between 1 and 32.
    #[must_use]
    pub const fn new(bits: u32) -> Self {
        let bits = if bits < 1 {
            1
        } else if bits > 32 {
            32
        } else {
            bits
        };
        Self { bits, last: None, total: 0 }
    }

    /// Takes in a reading; what lies above the counter's bits does not count. Returns the count
    /// since the first reading, which is itself taken with its sign.
    pub fn read(&mut self, raw: i32) -> i64 {
        let step = match self.last {
            None => self.signed(raw),
            Some(last) => self.signed(raw.wrapping_sub(last)),
        };
        self.last = Some(raw);
        self.total = self.total.wrapping_add(i64::from(step));
        self.total
    }

    /// The lowest bits as a number with a sign.
    const fn signed(&self, value: i32) -> i32 {
        let unused = 32 - self.bits;
        (value << unused) >> unused
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn nine_turns_forwards_and_twenty_back_go_through_the_wrap() {
        let mut counter = UnwrappedCounter::new(16);
        let positions = (0..=9 * 4096).chain((-11 * 4096..9 * 4096).rev()).step_by(97);
        for position in positions {
            // What the card shows: the lowest 16 bits, with or without a sign.
            let wrapped = i32::from(position as i16);
            assert_eq!(counter.read(wrapped), i64::from(position));
        }
    }

    proptest! {
        /// Whatever the counter's width and however it walks, so long as it stays below half the
        /// range between readings, and whether the card shows it with a sign or without.
        #[test]
        fn any_walk_is_followed(
            bits in 8u32..=32,
            steps in prop::collection::vec(-127i64..=127, 1..2000),
            stretch in 1i64..1_000_000,
            with_sign: bool,
        ) {
            let half = 1i64 << (bits - 1);
            let stretch = stretch.min((half - 1) / 127).max(1);
            let (mut counter, mut position) = (UnwrappedCounter::new(bits), 0i64);
            counter.read(0);
            for step in steps {
                position += step * stretch;
                let low = position.rem_euclid(2 * half);
                let shown = if with_sign && low >= half { low - 2 * half } else { low };
                prop_assert_eq!(counter.read(shown as i32), position);
            }
        }
    }
}
