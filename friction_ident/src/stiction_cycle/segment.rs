//! Rest and sliding in a quantised angle.

use serde::Serialize;

use super::StictionRecording;

/// What the axis does.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum PhaseKind {
    /// It rests; a count may toggle.
    Stick,
    /// It moves.
    Slip {
        /// 1 or -1.
        direction: f64,
    },
}

/// A stretch of samples.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Phase {
    /// First sample.
    pub start: usize,
    /// One past the last sample.
    pub end: usize,
    /// What the axis does in it.
    #[serde(flatten)]
    pub kind: PhaseKind,
}

/// Least travel of a slip \[counts\]: one count may be the toggling of an edge.
const LEAST_TRAVEL: i64 = 2;

/// Splits the recording, with alternating sliding and rest.
///
/// A slip is a run of counts in one direction, no two further apart in time than `gap` \[s\], of
/// two counts or more. It begins and ends with the samples where the count changes; everything else
/// is rest.
pub fn segment(recording: &StictionRecording, gap: f64) -> Vec<Phase> {
    let n = recording.samples();
    let gap = (gap / recording.time_step).round().clamp(1.0, 1e9) as usize;
    let counts: Vec<i64> =
        recording.angle.iter().map(|angle| (angle / recording.resolution).round() as i64).collect();
    let steps: Vec<(usize, i64)> = counts
        .windows(2)
        .enumerate()
        .filter(|(_, pair)| pair[1] != pair[0])
        .map(|(i, pair)| (i + 1, pair[1] - pair[0]))
        .collect();
    let mut phases = Vec::new();
    let mut free = 0;
    let mut i = 0;
    while i < steps.len() {
        let sign = steps[i].1.signum();
        let mut last = i;
        let mut travel = steps[i].1;
        while let Some(&(at, step)) = steps.get(last + 1) {
            if step.signum() != sign || at - steps[last].0 > gap {
                break;
            }
            travel += step;
            last += 1;
        }
        if travel.abs() >= LEAST_TRAVEL {
            let (start, end) = (steps[i].0, steps[last].0 + 1);
            if start > free {
                phases.push(Phase { start: free, end: start, kind: PhaseKind::Stick });
            }
            phases.push(Phase { start, end, kind: PhaseKind::Slip { direction: sign as f64 } });
            free = end;
        }
        i = last + 1;
    }
    if n > free {
        phases.push(Phase { start: free, end: n, kind: PhaseKind::Stick });
    }
    phases
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn phases(counts: &[f64]) -> Vec<Phase> {
        let voltage = vec![0.0; counts.len()];
        let recording = StictionRecording {
            time_step: 0.002,
            angle: counts,
            resolution: 1.0,
            voltage: &voltage,
            pendulum: None,
        };
        segment(&recording, 0.006)
    }

    #[test]
    fn a_toggling_count_is_rest_and_a_run_is_a_slip() {
        let found = phases(&[0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 2.0, 2.0, 3.0, 3.0, 3.0, 3.0, 3.0, 2.0]);
        assert_eq!(
            found,
            [
                Phase { start: 0, end: 5, kind: PhaseKind::Stick },
                Phase { start: 5, end: 9, kind: PhaseKind::Slip { direction: 1.0 } },
                Phase { start: 9, end: 14, kind: PhaseKind::Stick },
            ]
        );
    }

    #[test]
    fn a_run_that_pauses_for_long_ends() {
        let found = phases(&[0.0, -1.0, -2.0, -2.0, -2.0, -2.0, -3.0, -4.0]);
        let slips = found.iter().filter(|phase| phase.kind != PhaseKind::Stick).count();
        assert_eq!(slips, 2, "{found:?}");
    }

    proptest! {
        #[test]
        fn phases_cover_every_sample_once(counts in proptest::collection::vec(-3i8..4, 0..100)) {
            let angle: Vec<f64> = counts.iter().map(|&count| f64::from(count)).collect();
            let found = phases(&angle);
            let mut at = 0;
            for phase in &found {
                prop_assert!(phase.start == at && phase.end > phase.start);
                at = phase.end;
            }
            prop_assert_eq!(at, angle.len());
        }
    }
}
