//! A stretch of motion in one direction, simulated and compared with the encoder.
//!
//! `T w' + w = K (u(t - d) - c(t))` with the voltage held over each cycle and `c` slow. For a given
//! `T` and `d` the position is linear in `K`, `K c` and what the stretch began with, so that the
//! search has two dimensions only.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};

/// What a stretch says.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Fit {
    /// Gain [rad/(V s)].
    pub gain: f64,
    /// Time constant \[s\].
    pub time_constant: f64,
    /// Delay \[s\]; a little below zero where there is none.
    pub delay: f64,
    /// Voltage of friction and whatever else is slow, mean \[V\].
    pub slow: f64,
    /// Root mean square of what is missed \[rad\].
    pub missed: f64,
}

/// Longest time constant and delay that are looked for \[s\].
const SLOWEST: f64 = 2.0;
const LATEST: f64 = 0.03;
/// Cycles that a delay may seem to be below zero.
const EARLY: f64 = 3.0;
/// Time constants of the first look.
const TRIALS: i32 = 25;
/// Time between two knots of what is slow \[s\].
const KNOT: f64 = 0.8;
/// Weight of the guess that there is none.
const FAINT: f64 = 1e-6;
/// Of so many cycles one is compared: the tones are slow beside a cycle.
const THINNED: usize = 4;
/// Steps of the search that may be halved so often.
const HALVINGS: u32 = 24;

/// Fits the stretch `of` a recording; none where it is no drive.
pub(super) fn fit(voltage: &[f64], position: &[f64], of: Range<usize>, period: f64) -> Option<Fit> {
    let tried = |time_constant: f64, delay: f64| {
        let early = -EARLY * period;
        let within =
            (0.5 * period..=SLOWEST).contains(&time_constant) && (early..=LATEST).contains(&delay);
        within.then(|| linear(voltage, position, of.clone(), (time_constant, delay), period))?
    };
    let ratio = (2.0 * SLOWEST / period).ln() / f64::from(TRIALS - 1);
    let first = (0..TRIALS)
        .filter_map(|i| tried(0.5 * period * (ratio * f64::from(i)).exp(), 0.0))
        .min_by(|a, b| a.missed.total_cmp(&b.missed))?;
    // Steps of time constant and delay together too: their sum is known far better than each.
    let (mut best, mut step) = (first, 0.2);
    for _ in 0..HALVINGS {
        loop {
            let size = step * best.time_constant;
            let near = [(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0), (1.0, -1.0), (-1.0, 1.0)];
            let better = near
                .iter()
                .filter_map(|(t, d)| tried(best.time_constant + t * size, best.delay + d * size))
                .min_by(|a, b| a.missed.total_cmp(&b.missed))
                .filter(|next| next.missed < best.missed);
            match better {
                Some(next) => best = next,
                None => break,
            }
        }
        step *= 0.6;
    }
    (best.gain > 0.0 && best.missed.is_finite()).then_some(best)
}

/// The best gain for a time constant and a delay.
///
/// Friction and whatever else is slow is a broken line of time with a knot each [`KNOT`] seconds, and
/// a load that hangs goes with sine and cosine of the position: the tones tell the drive, and no load
/// is mistaken for inertia.
fn linear(
    voltage: &[f64],
    position: &[f64],
    of: Range<usize>,
    (time_constant, delay): (f64, f64),
    period: f64,
) -> Option<Fit> {
    let late = (delay / period).floor();
    let share = delay / period - late;
    let at = |k: usize| {
        let index = |more: f64| usize::try_from(k as i64 - late as i64 - more as i64).ok();
        Some((1.0 - share) * voltage.get(index(0.0)?)? + share * voltage.get(index(1.0)?)?)
    };
    let decay = (-period / time_constant).exp();
    let coast = time_constant * (1.0 - decay);
    let spacing = of.len() as f64 / (of.len() as f64 * period / KNOT).round().max(1.0);
    let knots = (of.len() as f64 / spacing).round() as usize + 1;
    // The last two before what the stretch began with are of a load that hangs.
    let inputs = knots + 3;
    let columns = inputs + 2;
    let mut normal = DMatrix::<f64>::zeros(columns, columns);
    let mut right = DVector::<f64>::zeros(columns);
    let mut power = 0.0;
    // Position and velocity by one volt's worth of gain, and by a unit of each knot.
    let mut driven = vec![(0.0, 0.0); inputs];
    let mut row = vec![0.0; columns];
    let origin = *position.get(of.start)?;
    let (mut fade, mut rows) = (1.0, 0.0);
    for (i, k) in of.enumerate() {
        if i % THINNED == 0 {
            for (column, (x, _)) in row.iter_mut().zip(&driven) {
                *column = *x;
            }
            row[inputs] = 1.0;
            row[inputs + 1] = time_constant * (1.0 - fade);
            let seen = position.get(k)? - origin;
            for a in 0..columns {
                for b in 0..=a {
                    normal[(a, b)] += row[a] * row[b];
                }
                right[a] += row[a] * seen;
            }
            power += seen * seen;
            rows += 1.0;
        }
        let along = i as f64 / spacing;
        let (sin, cos) = position.get(k)?.sin_cos();
        for (column, (x, v)) in driven.iter_mut().enumerate() {
            let u = match column.checked_sub(1) {
                None => at(k)?,
                Some(knot) if knot == knots => sin,
                Some(knot) if knot == knots + 1 => cos,
                Some(knot) => (1.0 - (along - knot as f64).abs()).max(0.0),
            };
            // What no input has reached yet stands still.
            if u != 0.0 || *v != 0.0 {
                (*x, *v) = (*x + coast * *v + (period - coast) * u, decay * *v + (1.0 - decay) * u);
            }
        }
        fade *= decay;
    }
    // A shaft that hardly turns shows no hanging load: then it is taken to be none.
    for load in [knots + 1, knots + 2] {
        normal[(load, load)] *= 1.0 + FAINT;
    }
    let solved = normal.cholesky()?.solve(&right);
    let missed = ((power - solved.dot(&right)).max(0.0) / rows).sqrt();
    let slow = solved.rows(1, knots).mean().abs() / solved[0];
    Some(Fit { gain: solved[0], time_constant, delay, slow, missed })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The exact drive, by a fine Euler step, seen through an encoder of 4096 counts.
    fn recording(delay: usize, gravity: f64) -> (Vec<f64>, Vec<f64>) {
        let (gain, time_constant, friction) = (1.4, 0.02, 0.4);
        let voltage: Vec<f64> = (0..2500)
            .map(|k| 2.0 + (0.0197 * f64::from(k)).sin() + 0.5 * (0.083 * f64::from(k)).sin())
            .collect();
        let (mut x, mut v) = (0.0, 2.0);
        let mut position = Vec::new();
        let count: f64 = std::f64::consts::TAU / 4096.0;
        for k in 0..voltage.len() {
            position.push((x / count).floor() * count);
            for _ in 0..50 {
                x += 2e-5 * v;
                let u = voltage[k.saturating_sub(delay)];
                let load = friction + gravity * x.sin();
                v += 2e-5 * (gain * (u - load) - v) / time_constant;
            }
        }
        (voltage, position)
    }

    #[test]
    fn gain_time_constant_and_delay_are_found_through_a_coarse_encoder() {
        for delay in [0, 3] {
            let (voltage, position) = recording(delay, 0.0);
            let found = fit(&voltage, &position, 100..2400, 1e-3).unwrap();
            assert!((found.gain / 1.4 - 1.0).abs() < 0.01, "{found:?}");
            assert!((found.time_constant / 0.02 - 1.0).abs() < 0.03, "{found:?}");
            assert!((found.delay - 1e-3 * delay as f64).abs() < 5e-4, "{found:?}");
            assert!(found.missed < 1e-3, "{found:?}");
        }
    }

    #[test]
    fn a_load_under_gravity_is_not_taken_for_inertia() {
        let (voltage, position) = recording(1, 0.3);
        let found = fit(&voltage, &position, 100..2400, 1e-3).unwrap();
        assert!((found.time_constant / found.gain / (0.02 / 1.4) - 1.0).abs() < 0.15, "{found:?}");
        assert!((found.delay - 1e-3).abs() < 2e-3, "{found:?}");
    }

    #[test]
    fn what_stands_still_is_no_drive() {
        assert_eq!(fit(&[2.0; 500], &[0.0; 500], 10..400, 1e-3).filter(|f| f.gain > 1e-6), None);
    }
}
