//! The time of a bag's cycles by the rig's own clock.
//!
//! A message is stamped when the machine took it, late by whatever else it had to do; the rig says
//! when it measured. So the rig's time counts within a run, and the stamp says when the run was.

use std::collections::HashMap;

use msgs::RosMessage;
use msgs::friction_msgs::RigMeasurement;

use super::RecordingError;
use crate::bag::BagReader;

/// The topic that has both.
pub(super) const RIG_MEASUREMENT: &str = "/rig_measurement";

/// Time between two runs at least \[s\]: the second is told from the first by it.
const BETWEEN_RUNS: f64 = 1.0;

/// Time of each cycle \[s\] by the rig's clock, from its stamp \[ns\] and the rig's time \[s\],
/// both in the order of the stamps. A rig's time that falls back begins another run.
///
/// None where the rig's time says nothing: it is no number, stands still, or runs at another pace
/// than the stamps.
pub(super) fn times(cycles: &[(u64, f64)]) -> Option<Vec<f64>> {
    let &(origin, _) = cycles.first()?;
    let since = |stamp: u64| stamp.saturating_sub(origin) as f64 * 1e-9;
    let mut times: Vec<f64> = Vec::with_capacity(cycles.len());
    // Stamp and rig's time of the first cycle of the run, and where it stands.
    let mut run: Option<(u64, f64, f64)> = None;
    let (mut by_stamps, mut by_rig) = (0.0, 0.0);
    let mut before: Option<(u64, f64)> = None;
    for &(stamp, rig) in cycles {
        if !rig.is_finite() {
            return None;
        }
        let goes_on = before.is_some_and(|(_, last)| rig >= last);
        if let Some((last_stamp, last)) = before
            && goes_on
        {
            if rig == last && stamp != last_stamp {
                return None;
            }
            by_stamps += stamp.saturating_sub(last_stamp) as f64 * 1e-9;
            by_rig += rig - last;
        }
        let begun = match run {
            Some(begun) if goes_on => begun,
            _ => {
                let earliest = times.last().map_or(0.0, |last| last + BETWEEN_RUNS);
                (stamp, rig, since(stamp).max(earliest))
            }
        };
        run = Some(begun);
        times.push(begun.2 + (rig - begun.1));
        before = Some((stamp, rig));
    }
    let pace = by_rig / by_stamps;
    // A simulated rig on a busy machine is slow, but not by so much.
    (by_stamps == 0.0 || (0.5..2.0).contains(&pace)).then_some(times)
}

/// The time of every stamp of the rig's measurements \[s\]; none where the bag has none of these,
/// or the rig's time says nothing.
pub(super) fn of_bag(bag: &BagReader) -> Result<Option<HashMap<u64, f64>>, RecordingError> {
    let known = |name: &str| {
        bag.topics()
            .iter()
            .any(|info| info.name == name && info.type_name == RigMeasurement::type_name())
    };
    if !known(RIG_MEASUREMENT) {
        return Ok(None);
    }
    let messages = bag.messages::<RigMeasurement>(RIG_MEASUREMENT)?;
    let mut cycles: Vec<(u64, f64)> =
        messages.iter().map(|(_, rig)| (rig.header.stamp.to_nanos(), rig.rig_time)).collect();
    cycles.sort_by_key(|cycle| cycle.0);
    Ok(times(&cycles).map(|times| cycles.iter().map(|cycle| cycle.0).zip(times).collect()))
}

#[cfg(test)]
mod tests {
    use super::*;

    const MS: u64 = 1_000_000;

    #[test]
    fn late_stamps_do_not_move_what_the_rig_measured() {
        let cycles: Vec<(u64, f64)> =
            (0..100).map(|k| (k * MS + (k * 7919) % 400_000, k as f64 * 1e-3)).collect();
        for (k, t) in times(&cycles).unwrap().into_iter().enumerate() {
            assert!((t - k as f64 * 1e-3).abs() < 1e-12, "{k}: {t}");
        }
    }

    #[test]
    fn a_clock_that_starts_again_is_another_run() {
        let mut cycles: Vec<(u64, f64)> = (0..50).map(|k| (k * MS, k as f64 * 1e-3)).collect();
        cycles.extend((0..50).map(|k| (3000 * MS + k * MS, k as f64 * 1e-3)));
        cycles.extend((0..50).map(|k| (3060 * MS + k * MS, k as f64 * 1e-3)));
        let found = times(&cycles).unwrap();
        assert!((found[50] - 3.0).abs() < 1e-9 && (found[99] - 3.049).abs() < 1e-9);
        assert!((found[100] - found[99] - BETWEEN_RUNS).abs() < 1e-9, "told apart");
    }

    #[test]
    fn a_clock_that_says_nothing_is_left_alone() {
        let cycles = |time: fn(u64) -> f64| (0..50).map(|k| (k * MS, time(k))).collect::<Vec<_>>();
        assert_eq!(times(&cycles(|_| 0.0)), None);
        assert_eq!(times(&cycles(|k| k as f64)), None);
        assert_eq!(times(&cycles(|k| if k == 7 { f64::NAN } else { k as f64 * 1e-3 })), None);
        assert_eq!(times(&[]), None);
        assert_eq!(times(&[(5, 0.0)]), Some(vec![0.0]));
    }
}
