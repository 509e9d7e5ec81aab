//! Recordings that have no one step.

use std::path::Path;

use super::{BRIDGED, IRREGULAR, UNEVEN, WINDOW, median, rounded};
use crate::RecordingError;

/// Share by which a rate may be off and still be that of the clock: 1999.9 Hz are 2000 Hz.
const SAME: f64 = 5e-4;

/// The rate to which irregular samples would be brought \[Hz\]; none where their steps are even.
pub(crate) fn rate_for(time: &[f64]) -> Option<f64> {
    let steps: Vec<f64> =
        time.windows(2).map(|pair| pair[1] - pair[0]).filter(|step| *step > 0.0).collect();
    is_irregular(&steps).then(|| even_rate(&steps))
}

/// Whether so many steps are off their neighbours' median that there is no even grid.
pub(super) fn is_irregular(steps: &[f64]) -> bool {
    let uneven: usize = steps
        .chunks(WINDOW)
        .map(|window| {
            let usual = median(window);
            // Longer ones are gaps.
            let off = |step: &&f64| {
                (**step - usual).abs() > UNEVEN * usual && **step <= (BRIDGED + UNEVEN) * usual
            };
            window.iter().filter(off).count()
        })
        .sum();
    uneven as f64 > IRREGULAR * steps.len() as f64
}

/// The error that says how irregular it is.
pub(super) fn irregular(path: &Path, steps: &[f64]) -> RecordingError {
    let mut sorted = steps.to_vec();
    sorted.sort_by(f64::total_cmp);
    let at = |part: f64| rounded(sorted[((sorted.len() - 1) as f64 * part) as usize]);
    RecordingError::Irregular {
        path: path.into(),
        shortest: at(0.05),
        usual: at(0.5),
        longest: at(0.95),
        rate: even_rate(steps),
    }
}

/// The mean rate between gaps \[Hz\], to two digits and not above it by more than [`SAME`].
fn even_rate(steps: &[f64]) -> f64 {
    let usual = median(steps);
    let without_gaps: Vec<f64> =
        steps.iter().copied().filter(|step| *step <= BRIDGED * usual).collect();
    let mean_rate = without_gaps.len() as f64 / without_gaps.iter().sum::<f64>();
    let digits = 10f64.powi(mean_rate.log10().floor() as i32 - 1);
    rounded(((1.0 + SAME) * mean_rate / digits).floor() * digits)
}
