//! Types of the ROS package `builtin_interfaces`.

use serde::{Deserialize, Serialize};

use crate::message::ros_message;

const NANOSECONDS: u64 = 1_000_000_000;

/// A point in time, counted from the Unix epoch for system time.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default, Serialize, Deserialize)]
pub struct Time {
    /// Whole seconds.
    pub sec: i32,
    /// Nanoseconds within the second, 0 to 999 999 999.
    pub nanosec: u32,
}

impl Time {
    /// Time of so many nanoseconds since the epoch. Beyond January 2038, where the field of ROS
    /// ends, the last second it can hold.
    pub fn from_nanos(nanoseconds: u64) -> Self {
        Self {
            sec: i32::try_from(nanoseconds / NANOSECONDS).unwrap_or(i32::MAX),
            nanosec: (nanoseconds % NANOSECONDS) as u32,
        }
    }

    /// Nanoseconds since the epoch; zero for a time before it.
    pub fn to_nanos(self) -> u64 {
        u64::try_from(self.sec).map_or(0, |sec| sec * NANOSECONDS + u64::from(self.nanosec))
    }
}

ros_message!(
    Time,
    "builtin_interfaces",
    "../standard/builtin_interfaces/Time.msg",
    "RIHS01_b106235e25a4c5ed35098aa0a61a3ee9c9b18d197f398b0e4206cea9acf9c197",
    []
);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nanoseconds_survive_both_ways() {
        for nanos in [0, 1, 999_999_999, 1_000_000_000, 1_600_000_000_123_456_789] {
            assert_eq!(Time::from_nanos(nanos).to_nanos(), nanos);
        }
        assert_eq!(
            Time::from_nanos(1_600_000_000_123_456_789),
            Time { sec: 1_600_000_000, nanosec: 123_456_789 }
        );
    }

    #[test]
    fn times_out_of_range_stop_at_the_ends() {
        assert_eq!(Time::from_nanos(u64::MAX).sec, i32::MAX);
        assert_eq!(Time { sec: -1, nanosec: 5 }.to_nanos(), 0);
    }
}
