//! A channel that is cut at its largest or smallest value: a sensor, an amplifier or a number at
//! the end of its range.

use std::ops::Range;

use friction_ident::statistics::{quantile, sorted, upper_median};
use serde::Serialize;

use super::{Label, Watched, short, spaced};

/// Samples below which nothing is said.
const FEWEST: usize = 200;
/// Part of the samples that stand at an end, at least.
const SHARE: f64 = 0.01;
/// Samples in a row that make a flat top.
const RUN: usize = 3;
/// Flat tops that are needed.
const RUNS: usize = 3;
/// Different values that a channel has which is no coarse one.
const VALUES: usize = 100;
/// The part of the range below an end that has fewer samples than the end.
const BELOW: f64 = 0.02;

/// A channel that is cut.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Cut {
    /// The column.
    pub name: Label,
    /// Its unit; empty where it is not known.
    pub unit: &'static str,
    /// The smallest value, where it is cut there.
    pub low: Option<f64>,
    /// The largest value, where it is cut there.
    pub high: Option<f64>,
    /// Part of the samples that stand there.
    pub share: f64,
}

impl Cut {
    /// Where a channel is cut. `beside` is what moves on where it is: a channel that stands because
    /// nothing changes is not cut.
    pub(super) fn of(channel: Watched<'_>, beside: Option<&[f64]>) -> Option<Self> {
        let values = channel.values;
        if values.len() < FEWEST {
            return None;
        }
        let ordered = sorted(values.iter().copied());
        let mut different = ordered.clone();
        different.dedup();
        let (&low, &high) = (ordered.first()?, ordered.last()?);
        if different.len() < VALUES {
            return None;
        }
        let band = BELOW * (high - low);
        let flat = |end: f64| -> Option<usize> {
            let runs = runs(values, end);
            let samples: usize = runs.iter().map(Range::len).sum();
            let near = ordered.iter().filter(|&&v| v != end && (v - end).abs() < band).count();
            let known = runs.len() >= RUNS
                && samples > near
                && 2.0 * samples as f64 >= SHARE * values.len() as f64
                && arrives(values, &runs)
                && beside.is_none_or(|beside| moves_on(beside, &runs));
            known.then_some(samples)
        };
        let (below, above) = (flat(low), flat(high));
        let share = (below.unwrap_or(0) + above.unwrap_or(0)) as f64 / values.len() as f64;
        (share >= SHARE).then(|| Self {
            name: Label::of(channel.name),
            unit: channel.unit,
            low: below.map(|_| low),
            high: above.map(|_| high),
            share,
        })
    }

    pub(super) fn and(self, other: Self) -> Self {
        Self {
            low: self.low.or(other.low),
            high: self.high.or(other.high),
            share: self.share.max(other.share),
            ..self
        }
    }

    /// In words.
    pub(super) fn describe(self) -> String {
        let Self { name, unit, low, high, share } = self;
        let ends: Vec<String> =
            low.into_iter().chain(high).map(|end| short(end).to_string()).collect();
        format!(
            "`{name}` is cut at {}{} in {} % of the samples: what lies beyond is not in the recording, and a fit takes the cut for the truth. If the drive itself gave no more, all is well; else record with a wider range",
            ends.join(" and "),
            spaced(unit),
            (1e3 * share).round() / 10.0
        )
    }
}

/// Where several samples in a row have the value `end`.
fn runs(values: &[f64], end: f64) -> Vec<Range<usize>> {
    let mut found = Vec::new();
    let mut from = None;
    for (k, value) in values.iter().chain([&f64::NAN]).enumerate() {
        match (*value == end, from) {
            (true, None) => from = Some(k),
            (false, Some(start)) => {
                if k - start >= RUN {
                    found.push(start..k);
                }
                from = None;
            }
            _ => {}
        }
    }
    found
}

/// Whether the channel comes to the end at its usual pace, and does not settle there by and by.
fn arrives(values: &[f64], runs: &[Range<usize>]) -> bool {
    let steps = values.windows(2).map(|pair| (pair[1] - pair[0]).abs());
    let steps = sorted(steps.filter(|step| *step > 0.0));
    let usual = quantile(&steps, 0.75).unwrap_or(0.0);
    let step = |run: &Range<usize>| {
        let before = run.start.checked_sub(1)?;
        Some((values[run.start] - values[before]).abs())
    };
    let mut last: Vec<f64> = runs.iter().filter_map(step).collect();
    upper_median(&mut last).is_some_and(|step| step >= 0.1 * usual)
}

/// Whether another channel changes while this one stands.
fn moves_on(beside: &[f64], runs: &[Range<usize>]) -> bool {
    let range = |values: &[f64]| {
        let none = (f64::INFINITY, f64::NEG_INFINITY);
        let (low, high) = values.iter().fold(none, |(low, high), v| (low.min(*v), high.max(*v)));
        high - low
    };
    let long = runs.iter().filter(|run| run.len() >= 2 * RUN);
    let mut ranges: Vec<f64> = long.filter_map(|run| beside.get(run.clone())).map(range).collect();
    let ordered = sorted(beside.iter().copied());
    let all = quantile(&ordered, 0.95).unwrap_or(0.0) - quantile(&ordered, 0.05).unwrap_or(0.0);
    upper_median(&mut ranges).is_none_or(|usual| usual > 0.1 * all)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(values: &[f64], beside: Option<&[f64]>) -> Option<Cut> {
        Cut::of(Watched { name: "tau_Nm", scale: 1.0, unit: "N m", values }, beside)
    }

    fn of(value: impl Fn(f64) -> f64) -> Vec<f64> {
        (0..4000).map(|k| value(f64::from(k))).collect()
    }

    /// Two sines, so that few values repeat.
    fn swings(k: f64) -> f64 {
        (0.02 * k).sin() + 0.3 * (0.0711 * k).sin()
    }

    #[test]
    fn flat_tops_are_told_with_their_share() {
        let cut = found(&of(|k| swings(k).clamp(-1.5, 0.8)), None).unwrap();
        assert_eq!((cut.low, cut.high), (None, Some(0.8)));
        assert!((0.1..0.4).contains(&cut.share), "{cut:?}");
        let both = found(&of(|k| swings(k).clamp(-0.8, 0.8)), None).unwrap();
        assert!(both.low.is_some() && both.describe().contains("cut at -0.8 and 0.8 N m in"));
        // A velocity that is cut while the force goes on.
        let velocity = of(|k| swings(k).clamp(-0.8, 0.8));
        assert!(found(&velocity, Some(&of(swings))).is_some());
    }

    #[test]
    fn what_stands_is_coarse_or_switched_is_not_cut() {
        let two = of(|k| if swings(k) > 0.0 { 1.0 } else { -1.0 });
        let coarse = of(|k| (20.0 * swings(k)).round() / 20.0);
        let settles = of(|k| {
            let (half, since) = ((k / 500.0).floor(), k % 500.0);
            if half % 2.0 == 0.0 { 1.0 - (-since / 10.0).exp() } else { (-since / 10.0).exp() }
        });
        let whole = of(swings);
        for (name, values) in
            [("two", two), ("coarse", coarse), ("settles", settles), ("all", whole)]
        {
            assert_eq!(found(&values, None), None, "{name}");
        }
        // A velocity that is held, with a force that is then steady too.
        let held = of(|k| swings(k).clamp(-0.8, 0.8));
        assert_eq!(found(&held, Some(&held)), None);
    }
}
