//! Which exponent the dip has.
//!
//! It is 2 by custom. How high friction rises towards rest hangs on it, and points that begin above
//! rest hardly show it: an interval at one exponent says less than it should. So the curve is fitted
//! at many. Where the points refuse 2 the best one takes its place, and each interval holds what every
//! exponent gives that the points leave open. Where they do not refuse it, it stays, and so do the
//! intervals: parameters are drawn from them, at that exponent. What other exponents would make of the
//! static friction is told beside them.

use super::{SteadyPoint, StribeckFit, StribeckOptions, StribeckParameter, fit_stribeck};
use crate::IdentError;
use crate::statistics::student_95;

/// A curve at the exponent that the points ask for.
#[derive(Debug, Clone, PartialEq)]
pub struct ExponentFit {
    /// The curve; at another exponent than the usual one its intervals hold for all that the points
    /// leave open.
    pub fit: StribeckFit,
    /// Lowest and highest exponent that the points leave open; none where there is no dip, or too
    /// few points to ask.
    pub exponents: Option<(f64, f64)>,
    /// Whether the points refuse the usual exponent.
    pub refuses_usual: bool,
    /// Ends of what all exponents that the points leave open say of the static friction \[N m or N\].
    pub static_friction: Option<(f64, f64)>,
}

/// Exponents that are tried.
const LOWEST: f64 = 0.4;
const HIGHEST: f64 = 4.0;
/// Steps between them on the grid, by factors.
const STEPS: usize = 10;
/// Halvings, each by the golden ratio, around the best of the grid.
const SECTIONS: usize = 16;
/// How much worse than the best the usual exponent may be before it is refused, in variances of a
/// point: three standard errors.
const REFUSED: f64 = 9.0;
/// The same where the usual exponent shows no dip: height, width and exponent then pay together.
const REFUSED_WITHOUT_DIP: f64 = 16.0;
/// Points beyond the five parameters from which there is something to ask.
const FEWEST_OVER: usize = 4;

/// Fits the curve at the usual exponent, or at another where the points refuse that one.
///
/// # Errors
/// Those of [`fit_stribeck`] at the usual exponent.
pub fn fit_exponent(points: &[SteadyPoint]) -> Result<ExponentFit, IdentError> {
    let usual = fit_stribeck(points, &StribeckOptions::default())?;
    let as_usual =
        |fit| Ok(ExponentFit { fit, exponents: None, refuses_usual: false, static_friction: None });
    let freedom = usual.points.saturating_sub(5);
    if freedom < FEWEST_OVER {
        return as_usual(usual);
    }
    let dip_at = |delta: f64| fit_stribeck(points, &StribeckOptions { delta }).ok().filter(has_dip);
    let grid: Vec<(f64, StribeckFit)> = (0..=STEPS)
        .map(|step| LOWEST * (HIGHEST / LOWEST).powf(step as f64 / STEPS as f64))
        .filter_map(|delta| Some((delta, dip_at(delta)?)))
        .chain(has_dip(&usual).then(|| (usual.parameters.delta, usual.clone())))
        .collect();
    let Some((near, _)) = grid.iter().min_by(|(_, a), (_, b)| sum(a).total_cmp(&sum(b))) else {
        return as_usual(usual);
    };
    let step = (HIGHEST / LOWEST).powf(1.0 / STEPS as f64);
    let refined = golden((near / step).max(LOWEST), (near * step).min(HIGHEST), |delta| {
        dip_at(delta).map_or(f64::INFINITY, |fit| sum(&fit))
    });
    let mut all = grid;
    all.extend(dip_at(refined).map(|fit| (refined, fit)));
    let sums = all.iter().map(|(delta, fit)| (*delta, sum(fit)));
    let Some((best, least)) = sums.min_by(|a, b| a.1.total_cmp(&b.1)) else {
        return as_usual(usual);
    };
    // Rounding alone is no reason.
    let power = points.iter().map(|point| point.torque.powi(2)).sum::<f64>();
    let variance = (least / freedom as f64).max(1e-24 * power);
    let worse = |fit: &StribeckFit| (sum(fit) - least) / variance;
    let limit = if has_dip(&usual) { REFUSED } else { REFUSED_WITHOUT_DIP };
    let refuses_usual = worse(&usual) > limit;
    if !refuses_usual && !has_dip(&usual) {
        return as_usual(usual);
    }
    let open_to = student_95(freedom).powi(2);
    let excess = |delta: f64| dip_at(delta).map_or(f64::INFINITY, |fit| worse(&fit) - open_to);
    let (low, high) = (crossing(best, LOWEST, &excess), crossing(best, HIGHEST, &excess));
    all.extend([low, high].into_iter().filter_map(|delta| Some((delta, dip_at(delta)?))));
    let open = || all.iter().filter(|(delta, _)| (low..=high).contains(delta));
    let other = all.iter().find(|(delta, _)| refuses_usual && *delta == best);
    let mut fit = other.map_or(usual, |(_, fit)| fit.clone());
    let mut intervals = fit.intervals;
    for (which, interval) in intervals.iter_mut().enumerate() {
        let Some(interval) = interval else { continue };
        for other in open().filter_map(|(_, fit)| fit.intervals[which]) {
            interval.low = interval.low.min(other.low);
            interval.high = interval.high.max(other.high);
        }
    }
    let static_friction =
        intervals[StribeckParameter::StaticFriction as usize].map(|all| (all.low, all.high));
    if refuses_usual {
        fit.intervals = intervals;
    }
    Ok(ExponentFit { fit, exponents: Some((low, high)), refuses_usual, static_friction })
}

fn has_dip(fit: &StribeckFit) -> bool {
    fit.parameters.f_s > fit.parameters.f_c
}

/// Weighted sum of the squares of what the curve leaves.
fn sum(fit: &StribeckFit) -> f64 {
    fit.variance * fit.degrees_of_freedom as f64
}

/// The exponent between two at which `f` is least, by golden sections of its logarithm.
fn golden(low: f64, high: f64, f: impl Fn(f64) -> f64) -> f64 {
    let ratio = 0.5 * (5f64.sqrt() - 1.0);
    let (mut a, mut b) = (low.ln(), high.ln());
    let (mut c, mut d) = (b - ratio * (b - a), a + ratio * (b - a));
    let (mut at_c, mut at_d) = (f(c.exp()), f(d.exp()));
    for _ in 0..SECTIONS {
        if at_c < at_d {
            (b, d, at_d) = (d, c, at_c);
            c = b - ratio * (b - a);
            at_c = f(c.exp());
        } else {
            (a, c, at_c) = (c, d, at_d);
            d = a + ratio * (b - a);
            at_d = f(d.exp());
        }
    }
    (0.5 * (a + b)).exp()
}

/// The last exponent from `from` towards `to` up to which `excess` is not above zero, by steps and
/// then by halving.
fn crossing(from: f64, to: f64, excess: &impl Fn(f64) -> f64) -> f64 {
    let step = (to / from).powf(1.0 / STEPS as f64);
    let mut inside = from;
    for k in 1..=STEPS {
        let next = if k == STEPS { to } else { from * step.powi(k as i32) };
        if excess(next) > 0.0 {
            let mut outside = next;
            for _ in 0..SECTIONS / 2 {
                let middle = (inside * outside).sqrt();
                if excess(middle) > 0.0 { outside = middle } else { inside = middle }
            }
            return inside;
        }
        inside = next;
    }
    to
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_distr::StandardNormal;

    use super::*;
    use crate::static_curve::StribeckValues;

    fn truth(delta: f64) -> StribeckValues {
        StribeckValues { f_s: 1.5, f_c: 1.0, v_s: 0.1, f_v: 0.1, delta }
    }

    /// 40 points of both directions from a sixth of the Stribeck velocity on.
    fn points(truth: &StribeckValues, noise: f64, seed: u64) -> Vec<SteadyPoint> {
        let mut rng = rand_pcg::Pcg64Mcg::seed_from_u64(seed);
        (0..40)
            .map(|k| {
                let v = 0.016 * 250f64.powf(f64::from(k / 2) / 19.0);
                let v = if k % 2 == 0 { v } else { -v };
                SteadyPoint::new(v, truth.torque(v) + noise * rng.sample::<f64, _>(StandardNormal))
            })
            .collect()
    }

    #[test]
    fn exact_points_tell_the_exponent() {
        for delta in [0.6, 1.0, 1.5, 3.0] {
            let found = fit_exponent(&points(&truth(delta), 0.0, 1)).unwrap();
            assert!(found.refuses_usual, "{delta}");
            assert!((found.fit.parameters.delta / delta - 1.0).abs() < 1e-2, "{found:?}");
            assert!((found.fit.parameters.f_s / 1.5 - 1.0).abs() < 2e-2, "{found:?}");
        }
        let found = fit_exponent(&points(&truth(2.0), 0.0, 1)).unwrap();
        assert!(!found.refuses_usual);
        assert_eq!(
            found.fit.parameters,
            fit_stribeck(&points(&truth(2.0), 0.0, 1), &StribeckOptions::default())
                .unwrap()
                .parameters
        );
    }

    /// At the usual exponent alone the static friction of a dip of exponent 1 lay inside its interval
    /// in hardly any of these.
    #[test]
    fn what_is_told_holds_the_truth_at_any_exponent() {
        for delta in [0.7, 1.0, 1.5, 2.0, 3.0] {
            for noise in [0.003, 0.01, 0.03] {
                let count = 40;
                let inside = (0..count).filter(|&seed| {
                    let found = fit_exponent(&points(&truth(delta), noise, seed)).unwrap();
                    let held = |ends: Option<(f64, f64)>, value: f64| {
                        ends.is_some_and(|(low, high)| (low..=high).contains(&value))
                    };
                    let f_c = found.fit.estimate(StribeckParameter::CoulombFriction).interval;
                    held(found.static_friction, 1.5) && (!found.refuses_usual || held(f_c, 1.0))
                });
                let inside = inside.count();
                assert!(inside >= 34, "{delta} {noise}: {inside} of {count}");
            }
        }
    }

    #[test]
    fn the_usual_exponent_is_refused_by_chance_seldom() {
        let refused = (0..100)
            .filter(|&seed| fit_exponent(&points(&truth(2.0), 0.01, seed)).unwrap().refuses_usual)
            .count();
        assert!(refused <= 2, "{refused}");
    }
}
