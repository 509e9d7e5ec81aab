//! A channel that is recorded more slowly than the file: each value stands for several samples.
//!
//! Telemetry of a drive often refreshes its torque at a lower rate than its position. A value that
//! is held is late by half of its time on average, and says nothing of what happens between.

use friction_ident::Conditioning;
use recording::Recording;

use super::channels;
use super::terminal::hertz;

/// Changes below which nothing can be said.
const FEWEST: usize = 50;
/// Share of the changes that must come in step.
const IN_STEP: f64 = 0.95;
/// Refreshes that a period of the fastest motion needs.
const PER_PERIOD: f64 = 2.5;

/// What is to be said of the channels that are held; whether it is a warning, beside it.
pub(super) fn said(recording: &Recording, how: &Conditioning) -> Vec<(bool, String)> {
    let rate = 1.0 / recording.time_step;
    let of = |name: &str, held: Option<usize>| {
        let samples = held?;
        let refreshed = rate / samples as f64;
        let slow = refreshed < PER_PERIOD * how.acceleration_cutoff;
        let most = if slow {
            format!(
                " The motion is taken up to {} Hz, which that cannot follow: parameters are not to be trusted, whatever their errors. Record the {name} faster, or move more slowly.",
                hertz(how.acceleration_cutoff)
            )
        } else {
            String::new()
        };
        let text = format!(
            "{}: the {name} changes only once in {samples} samples: it is refreshed at {} Hz and held between, late by half of that on average (--structure auto finds such a delay).{most}",
            recording.path.display(),
            hertz(refreshed)
        );
        Some((slow, text))
    };
    let all = channels(recording);
    let longest = all.iter().map(|(_, signals)| signals).max_by_key(|own| own.force.len());
    let Some(signals) = longest else { return Vec::new() };
    [("force", Some(signals.force)), ("position", signals.position), ("velocity", signals.velocity)]
        .into_iter()
        .filter_map(|(name, column)| of(name, held_for(column?)))
        .collect()
}

/// For how many samples each value of a column is held; none where it changes as it likes.
fn held_for(column: &[f64]) -> Option<usize> {
    let changes: Vec<usize> =
        (1..column.len()).filter(|&k| column.get(k) != column.get(k - 1)).collect();
    if changes.len() < FEWEST {
        return None;
    }
    let gaps: Vec<usize> =
        changes.windows(2).filter_map(|pair| Some(pair.last()? - pair.first()?)).collect();
    let mut ordered = gaps.clone();
    ordered.sort_unstable();
    // The usual gap; where a value happens to stay, it is a multiple of that.
    let usual = *ordered.get(ordered.len() / 4)?;
    let in_step = gaps.iter().filter(|gap| gap.is_multiple_of(usual)).count();
    let held = usual >= 2 && in_step as f64 >= IN_STEP * gaps.len() as f64;
    held.then_some(usual)
}

#[cfg(test)]
mod tests {
    use super::held_for;

    #[test]
    fn held_is_told_from_coarse_and_from_still() {
        let wave = |k: usize| (0.013 * k as f64).sin() + 0.3 * (0.041 * k as f64).sin();
        let held: Vec<f64> = (0..4000).map(|k| wave(k / 5 * 5)).collect();
        assert_eq!(held_for(&held), Some(5));
        let fine: Vec<f64> = (0..4000).map(wave).collect();
        assert_eq!(held_for(&fine), None);
        let coarse: Vec<f64> = fine.iter().map(|x| (x * 40.0).round()).collect();
        assert_eq!(held_for(&coarse), None);
        assert_eq!(held_for(&[1.0; 4000]), None);
        assert_eq!(held_for(&[]), None);
    }
}
