//! Which periods of a force along the axis are worth a try.
//!
//! The columns of a wave go through the low-pass of the thinning, and hundreds of periods are
//! hundreds of filterings. A first look does without: a wave that passes more slowly than the
//! low-pass ends is left as it is, a faster one is gone.

use nalgebra::{DMatrix, DVector};

/// What a row of the regression shows of the motion.
#[derive(Debug, Clone, Copy)]
pub(super) struct Place {
    /// Position \[m or rad\].
    pub position: f64,
    /// Speed \[m/s or rad/s\].
    pub speed: f64,
}

/// The `count` periods of `grid` that leave least of `force` beside the `others`, of neighbours the
/// best. `fastest` is how many waves a second the low-pass lets through.
pub(super) fn promising(
    grid: &[f64],
    count: usize,
    places: &[Place],
    others: &DMatrix<f64>,
    force: &DVector<f64>,
    fastest: f64,
) -> Vec<f64> {
    // What the other columns do not follow; a wave counts by what it adds to them.
    let q = others.clone().qr().q();
    let rest = |column: &DVector<f64>| column - &q * q.tr_mul(column);
    let left = rest(force);
    let gain = |period: f64| {
        let seen = |place: &Place| place.speed < fastest * period;
        let wave = |of: fn(f64) -> f64| {
            let value = |place: &Place| {
                if seen(place) { of(std::f64::consts::TAU * place.position / period) } else { 0.0 }
            };
            rest(&DVector::from_iterator(places.len(), places.iter().map(value)))
        };
        let (cos, sin) = (wave(f64::cos), wave(f64::sin));
        let (cc, cs, ss) = (cos.norm_squared(), cos.dot(&sin), sin.norm_squared());
        let (cy, sy) = (cos.dot(&left), sin.dot(&left));
        let determinant = cc * ss - cs * cs;
        if determinant <= 1e-9 * cc * ss {
            return 0.0;
        }
        (ss * cy * cy - 2.0 * cs * cy * sy + cc * sy * sy) / determinant
    };
    let gains: Vec<f64> = grid.iter().map(|&period| gain(period)).collect();
    let peak = |k: &usize| {
        let beside = |other: Option<&f64>| other.is_none_or(|other| *other <= gains[*k]);
        gains[*k] > 0.0 && beside(gains.get(k + 1)) && (*k == 0 || beside(gains.get(k - 1)))
    };
    let mut peaks: Vec<usize> = (0..grid.len()).filter(peak).collect();
    peaks.sort_by(|&a, &b| gains[b].total_cmp(&gains[a]));
    peaks.into_iter().take(count).map(|k| grid[k]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A wave of 0.7 rad under a ramp and an offset, on an axis that sweeps 10 rad and back: found
    /// to one step of the grid, with a low-pass or without.
    #[test]
    fn the_period_that_is_there_comes_first() {
        let places: Vec<Place> = (0..1000)
            .map(|k| f64::from(k) * 0.01)
            .map(|t| Place { position: 5.0 * t.sin(), speed: (5.0 * t.cos()).abs() })
            .collect();
        let others =
            DMatrix::from_fn(1000, 2, |i, j| if j == 0 { 1.0 } else { places[i].position });
        let force = DVector::from_fn(1000, |i, _| {
            let q = places[i].position;
            2.0 + 0.3 * q + 0.1 * (std::f64::consts::TAU * q / 0.7 + 1.0).sin()
        });
        let grid: Vec<f64> = (1..=400).map(|k| 20.0 / f64::from(k)).collect();
        for fastest in [f64::INFINITY, 3.0] {
            let found = promising(&grid, 3, &places, &others, &force, fastest);
            assert!((20.0 / found[0] - 20.0 / 0.7).abs() < 1.0, "{fastest}: {found:?}");
            assert!(found.len() == 3, "{found:?}");
        }
    }
}
