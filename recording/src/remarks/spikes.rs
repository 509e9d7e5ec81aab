//! Single samples far outside their neighbours, as a disturbed line or a lost message makes them.

use friction_ident::statistics::{quantile, sorted, upper_median};
use serde::Serialize;

use super::{Label, Watched, short, spaced};

/// Samples below which nothing is said.
const FEWEST: usize = 100;
/// Robust deviations of the second difference that a spike is above both neighbours at least.
const DEVIATIONS: f64 = 20.0;
/// The same as a part of the range that nine tenths of the samples have.
const HIGH: f64 = 0.5;
/// The same where samples within that range may jump.
const HIGH_OUTSIDE: f64 = 1.0;
/// How far outside that range a spike is, where samples within may jump.
const OUTSIDE: f64 = 0.25;
/// One in so many samples may be a spike; more are how the signal is.
const ISOLATED: usize = 50;

/// Samples far outside their neighbours.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Spikes {
    /// The column.
    pub name: Label,
    /// Its unit; empty where it is not known.
    pub unit: &'static str,
    /// How many.
    pub count: usize,
    /// The one that is farthest from zero.
    pub largest: f64,
    /// When the first is, from the first sample \[s\].
    pub first: f64,
}

impl Spikes {
    /// The spikes of a channel, one or two samples long. Where it may jump, as a force does, only
    /// those `outside` of the others count.
    pub(super) fn of(time: &[f64], channel: Watched<'_>, outside: bool) -> Option<Self> {
        let values = channel.values;
        if values.len() < FEWEST || values.len() != time.len() {
            return None;
        }
        let ordered = sorted(values.iter().copied());
        let (low, high) = (quantile(&ordered, 0.05)?, quantile(&ordered, 0.95)?);
        let part = if outside { HIGH_OUTSIDE } else { HIGH };
        let bend = |three: &[f64]| (three[1] - 0.5 * (three[0] + three[2])).abs();
        let mut bends: Vec<f64> = values.windows(3).map(bend).collect();
        let least = (DEVIATIONS * 1.4826 * upper_median(&mut bends)?).max(part * (high - low));
        let margin = OUTSIDE * (high - low);
        let beyond = |value: f64| !outside || value > high + margin || value < low - margin;
        let mut found: Vec<usize> = Vec::new();
        let mut k = 1;
        while k + 1 < values.len() {
            let length = length(&values[k - 1..], least).filter(|_| beyond(values[k]));
            found.extend(k..k + length.unwrap_or(0));
            k += length.unwrap_or(0) + 1;
        }
        let first = *found.first()?;
        let farthest =
            |most: f64, &k: &usize| if values[k].abs() > most.abs() { values[k] } else { most };
        // Equal levels between which a signal is switched are none.
        (least > 0.0 && found.len() * ISOLATED < values.len()).then(|| Self {
            name: Label::of(channel.name),
            unit: channel.unit,
            count: found.len(),
            largest: found.iter().fold(values[first], farthest),
            first: time[first] - time[0],
        })
    }

    pub(super) fn and(self, other: Self) -> Self {
        let larger = other.largest.abs() > self.largest.abs();
        let largest = if larger { other.largest } else { self.largest };
        Self { count: self.count + other.count, largest, ..self }
    }

    /// In words.
    pub(super) fn describe(self) -> String {
        let Self { name, unit, count, largest, first } = self;
        let (samples, is) = if count == 1 { ("sample", "is") } else { ("samples", "are") };
        format!(
            "{count} {samples} of `{name}` {is} far outside the neighbours, the largest {}{}, the first at {} s: nothing was changed, and a fit is drawn to them. Empty their cells, and their rows are left out",
            short(largest),
            spaced(unit),
            short(first)
        )
    }
}

/// How many samples long the spike behind the first value is; none if there is none.
fn length(values: &[f64], least: f64) -> Option<usize> {
    let height = |at: f64, before: f64, after: f64| {
        let (up, down) = (at - before, at - after);
        if up * down > 0.0 { up.abs().min(down.abs()) } else { 0.0 }
    };
    if let [before, at, after, ..] = *values
        && height(at, before, after) > least
    {
        return Some(1);
    }
    let [before, one, two, after, ..] = *values else { return None };
    let low = height(one, before, after).min(height(two, before, after));
    let back = (after - before).abs() < 0.5 * low;
    (low > least && back).then_some(2)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(values: &[f64], outside: bool) -> Option<Spikes> {
        let time: Vec<f64> = (0..values.len()).map(|k| 10.0 + 0.01 * k as f64).collect();
        Spikes::of(&time, Watched { name: "tau_Nm", scale: 1.0, unit: "N m", values }, outside)
    }

    fn wave(k: usize) -> f64 {
        (0.02 * k as f64).sin() + 0.01 * (k as f64 * 7.3).sin()
    }

    #[test]
    fn single_samples_far_outside_are_counted() {
        let mut values: Vec<f64> = (0..2000).map(wave).collect();
        values[100] = 999.0;
        values[700] = -50.0;
        values[701] = -50.0;
        let spikes = found(&values, true).unwrap();
        assert_eq!((spikes.count, spikes.largest), (3, 999.0));
        assert!((spikes.first - 1.0).abs() < 1e-9);
        let said = spikes.describe();
        assert!(said.contains("3 samples of `tau_Nm`") && said.contains("999 N m"), "{said}");
    }

    #[test]
    fn noise_steps_and_switched_signals_have_no_spikes() {
        let of = |value: &dyn Fn(usize) -> f64| (0..2000).map(value).collect::<Vec<f64>>();
        for outside in [true, false] {
            assert_eq!(found(&of(&wave), outside), None);
            assert_eq!(found(&of(&|k| (k as f64 * k as f64 * 0.37).sin()), outside), None);
            assert_eq!(
                found(&of(&|k| if (k / 50).is_multiple_of(2) { 1.0 } else { -1.0 }), outside),
                None
            );
            assert_eq!(found(&of(&|_| 1.0), outside), None);
        }
        // A force that is switched for one sample stays between its levels.
        let once = of(&|k| if (k / 50).is_multiple_of(2) || k == 75 { 1.0 } else { -1.0 });
        assert_eq!(found(&once, true), None);
    }
}
