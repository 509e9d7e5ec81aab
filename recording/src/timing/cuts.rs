//! Where a recording is cut in two.

use std::ops::Range;

use super::{BRIDGED, LASTING, OTHER_RATE, PAUSE, WINDOW, median};
use crate::irregularities::Irregularities;

/// Where the recording is cut: ranges of samples, and whether each begins behind a gap.
pub(super) fn cut(
    steps: &[f64],
    tolerance: f64,
    found: &mut Irregularities,
) -> Vec<(Range<usize>, bool)> {
    let ahead = |from: usize| median(&steps[from..(from + WINDOW).min(steps.len())]);
    let mut parts = Vec::new();
    let (mut first, mut after_gap) = (0, false);
    let mut usual = if steps.is_empty() { f64::INFINITY } else { ahead(0) };
    for (k, &step) in steps.iter().enumerate() {
        if (step - usual).abs() <= tolerance * usual {
            continue;
        }
        let gap = step > (BRIDGED + tolerance) * usual;
        let other_rate =
            || steps.len() - k >= LASTING && (ahead(k) - usual).abs() > OTHER_RATE * usual;
        if !(gap || other_rate()) {
            continue;
        }
        parts.push((first..k + 1, after_gap));
        first = k + 1;
        after_gap = false;
        if step > PAUSE.max(BRIDGED * usual) {
            found.pauses += 1;
        } else if gap {
            found.gaps += 1;
            found.missing += (step / usual).round() as usize - 1;
            after_gap = true;
        } else {
            found.rate_changes += 1;
            after_gap = true;
        }
        if first < steps.len() {
            usual = ahead(first);
        }
    }
    parts.push((first..steps.len() + 1, after_gap));
    parts
}
