//! A recording that is brought to one rate, stretch by stretch.

use std::ops::Range;
use std::path::Path;

use super::stretch::{EvenStretch, Places};
use super::uneven::Uneven;
use super::{BRIDGED, NEEDED, PAUSE, Timing, median, rounded};
use crate::RecordingError;
use crate::irregularities::{Irregularities, Resampled};

/// How many new rates fit between the samples' mean rate and the new one at most.
const LARGEST_FACTOR: f64 = 500.0;
/// How much denser than the samples the new ones may be.
const DENSEST: f64 = 10.0;

/// All stretches between gaps, at one rate.
pub(super) fn resampled(
    path: &Path,
    kept: &[usize],
    times: &[f64],
    rate: f64,
    mut found: Irregularities,
) -> Result<Timing, RecordingError> {
    let steps: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let usual = median(&steps);
    let mut parts: Vec<(Range<usize>, bool)> = Vec::new();
    let (mut first, mut after_gap) = (0, false);
    for (k, &step) in steps.iter().enumerate().filter(|(_, step)| **step > BRIDGED * usual) {
        parts.push((first..k + 1, after_gap));
        after_gap = step <= PAUSE.max(BRIDGED * usual);
        first = k + 1;
        if after_gap {
            found.gaps += 1;
            found.missing += (step / usual).round() as usize - 1;
        } else {
            found.pauses += 1;
        }
    }
    parts.push((first..times.len(), after_gap));
    let mut stretches: Vec<EvenStretch> = Vec::new();
    let mut longest = 0;
    for (samples, after_gap) in parts {
        let nodes: Vec<(usize, f64)> = samples.clone().map(|k| (kept[k], times[k])).collect();
        let uneven = if nodes.len() < NEEDED {
            None
        } else {
            let seconds = times[samples.end - 1] - times[samples.start];
            let mean_rate = (nodes.len() - 1) as f64 / seconds;
            if !(rate <= DENSEST * mean_rate && rate * LARGEST_FACTOR >= mean_rate) {
                let mean_rate = rounded(mean_rate);
                return Err(RecordingError::ResampleRate { path: path.into(), rate, mean_rate });
            }
            Uneven::new(nodes, rate).map(|uneven| (uneven, mean_rate))
        };
        let Some((uneven, mean_rate)) = uneven.filter(|(uneven, _)| uneven.len() >= NEEDED) else {
            found.leave_out(samples.len());
            continue;
        };
        if samples.len() > longest {
            longest = samples.len();
            found.resampled = Some(Resampled {
                rate,
                mean_rate: rounded(mean_rate),
                low_pass: uneven.low_pass(rate).map(rounded),
                noise: uneven.noise(),
            });
        }
        stretches.push(EvenStretch {
            start: times[samples.start],
            time_step: 1.0 / rate,
            after_gap,
            places: Places::Resampled(uneven),
        });
    }
    if stretches.is_empty() {
        let (path, found, needed) = (path.into(), times.len(), NEEDED);
        return Err(RecordingError::TooShort { path, found, needed });
    }
    found.stretches = stretches.len();
    Ok(Timing { stretches, irregularities: found })
}
