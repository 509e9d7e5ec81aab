//! One stretch on its own grid: samples that came late or are missing are bridged.

use std::ops::Range;

use super::stretch::{EvenStretch, Place, Places};
use super::{UNEVEN, median};
use crate::irregularities::Irregularities;

/// One stretch on its grid.
pub(super) fn even(
    kept: &[usize],
    times: &[f64],
    samples: Range<usize>,
    tolerance: f64,
    after_gap: bool,
    found: &mut Irregularities,
) -> EvenStretch {
    let (first, last) = (samples.start, samples.end - 1);
    let steps: Vec<f64> = times[samples.clone()].windows(2).map(|pair| pair[1] - pair[0]).collect();
    let usual = median(&steps);
    let mean = (times[last] - times[first]) / (last - first) as f64;
    // Where much is tolerated, steps may be off as long as the samples keep to one grid.
    let off = |k: usize| (times[k] - times[first] - mean * (k - first) as f64).abs();
    let near = tolerance * usual;
    let keeps = tolerance <= UNEVEN || samples.clone().all(|k| off(k) <= near);
    let near = if keeps { near } else { UNEVEN * usual };
    let whole = |k: usize| Place { index: kept[k], next: kept[k], part: 0.0 };
    if keeps && steps.iter().all(|step| (step - usual).abs() <= near) {
        // The mean does not suffer from the rounding of the single times.
        let time_step = mean;
        let places = samples.map(whole).collect();
        let places = Places::Grid(places);
        return EvenStretch { start: times[first], time_step, after_gap, places };
    }
    let mut places = vec![whole(first)];
    let (mut now, mut k, mut read_between) = (times[first], first, 0);
    while now + usual <= times[last] + near {
        let next = now + usual;
        while k < last && times[k + 1] <= next {
            k += 1;
        }
        if next - times[k] <= near && times[k] > now {
            places.push(whole(k));
            now = times[k];
        } else if k < last && times[k + 1] - next <= near {
            k += 1;
            places.push(whole(k));
            now = times[k];
        } else if k < last {
            let part = (next - times[k]) / (times[k + 1] - times[k]);
            places.push(Place { index: kept[k], next: kept[k + 1], part });
            read_between += 1;
            now = next;
        } else {
            break;
        }
    }
    let unused = samples.len() - (places.len() - read_between);
    let moved = unused.min(read_between);
    found.moved += moved;
    found.filled += read_between - moved;
    found.dropped += unused - moved;
    let time_step = (now - times[first]) / (places.len() - 1).max(1) as f64;
    EvenStretch { start: times[first], time_step, after_gap, places: Places::Grid(places) }
}
