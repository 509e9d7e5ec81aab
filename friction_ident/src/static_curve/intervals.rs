//! Profile intervals of the four parameters.
//!
//! For a given `v_s` the other three are linear, so their profiles are known in closed form: the
//! sum of squares along `p` is `S(v_s) + (p - p(v_s))^2 / c(v_s)`. The interval of `v_s` is where
//! `S(v_s)` stays below the limit; that of a linear parameter is the union of
//! `p(v_s) +- sqrt((limit - S(v_s)) c(v_s))` over that range. Both are global: every dip that the
//! data allow counts.

use super::separable::{Separable, Trial};
use crate::estimate::{Interval, IntervalMethod};
use crate::profile::{Search, profile_interval, sum_limit};

/// Trials over all `v_s`, and again over those within the interval.
const TRIALS: usize = 120;
/// Slowest trial over the slowest speed: a dip that narrow touches no point.
const SLOWER: f64 = 0.1;
/// Fastest trial over the fastest speed.
const FASTER: f64 = 6.0;

/// Intervals of `f_s`, `f_c`, `v_s`, `f_v`: every curve a friction may have that fits about as well
/// as the best one. `best` is the best `v_s`, and `sum` its sum of squares; a dip that was given up
/// may still fit better.
///
/// Where a dip below the slowest or above the fastest measured speed fits as well, `v_s` reaches to
/// zero or to infinity.
pub(super) fn intervals(
    data: &Separable,
    speeds: (f64, f64),
    best: f64,
    sum: f64,
) -> [Interval; 4] {
    let (low, high) = (SLOWER * speeds.0, FASTER * speeds.1);
    let between =
        |from: f64, to: f64, i: usize| from * (to / from).powf(i as f64 / (TRIALS - 1) as f64);
    // Without a dip every `v_s` fits; a trial whose best dip is negative counts as none. So does one
    // that no friction has: where friction grows ever more slowly with speed, a dip as wide as all
    // speeds with a negative `f_c` fits best, and would set the limit for those that are allowed.
    let plain = data.plain();
    let allowed = |v_s: f64| {
        let trial = data.trial(v_s)?;
        Some(if trial.dip < 0.0 || trial.f_c <= 0.0 { plain } else { trial })
    };
    let sum_at = |v_s: f64| Some(allowed(v_s)?.sum);
    let grid: Vec<(f64, f64)> = (0..TRIALS)
        .map(|i| between(low, high, i))
        .filter_map(|v_s| Some((v_s, sum_at(v_s)?)))
        .collect();
    let least = grid.iter().fold(sum, |least, &(_, sum)| least.min(sum));
    // Four parameters whatever the fit was left with: the dip is still asked for.
    let limit = sum_limit(least, data.points(), 4, 1.0);
    let mut inside = grid.iter().filter(|(_, sum)| *sum <= limit).map(|&(v_s, _)| v_s);
    let first = inside.next().unwrap_or(best);
    let last = inside.next_back().unwrap_or(first);
    // A given-up fit has no `v_s` of its own.
    let centre = if sum <= limit { best } else { first };
    let (first, last) = (first.min(centre), last.max(centre));
    let step = 0.5 * ((high / low).powf(1.0 / (TRIALS - 1) as f64) - 1.0);
    let search = |from: f64| Search { best: from, step: step * from, low, high, limit };
    let mut profile = |v_s: f64| sum_at(v_s);
    let mut v_s = Interval {
        low: profile_interval(&Search { high: first, ..search(first) }, &mut profile).low,
        high: profile_interval(&Search { low: last, ..search(last) }, &mut profile).high,
        method: IntervalMethod::Profile,
    };
    let (from, to) = (v_s.low.max(low), v_s.high.min(high));
    let mut linear = [(f64::INFINITY, f64::NEG_INFINITY); 3];
    let mut widen = |trial: Trial| {
        let room = (limit - trial.sum).max(0.0);
        let values = [trial.f_c + trial.dip, trial.f_c, trial.f_v];
        for ((range, value), variance) in linear.iter_mut().zip(values).zip(trial.variances) {
            let half = (room * variance).sqrt();
            *range = (range.0.min(value - half), range.1.max(value + half));
        }
    };
    let trials = (0..TRIALS).map(|i| between(from, to, i)).chain([centre]);
    trials.filter_map(allowed).filter(|trial| trial.sum <= limit).for_each(&mut widen);
    let [mut f_s, f_c, f_v] = linear.map(|(low, high)| Interval {
        // What friction excludes is no part of it.
        low: low.max(0.0),
        high,
        method: IntervalMethod::Profile,
    });
    if v_s.low <= low {
        // A dip below the slowest speed may be as high as it likes.
        (v_s.low, f_s.high) = (0.0, f64::INFINITY);
    }
    if v_s.high >= high {
        v_s.high = f64::INFINITY;
    }
    f_s.low = f_s.low.max(f_c.low);
    [f_s, f_c, v_s, f_v]
}
