//! Which periods of a force along the axis are worth a try.
//!
//! The columns of a wave go through the low-pass of the thinning, and hundreds of periods are
//! hundreds of filterings. A first look does without: a wave that passes more slowly than the
//! low-pass ends is left as it is, a faster one is gone.

use std::f64::consts::TAU;

use nalgebra::{DMatrix, DVector};

/// What a row of the regression shows of the motion.
#[derive(Debug, Clone, Copy)]
pub(super) struct Place {
    /// Position \[m or rad\].
    pub position: f64,
    /// Speed \[m/s or rad/s\].
    pub speed: f64,
}

/// The `count` periods of `grid`, which has waves a length evenly spaced, that leave least of `force` beside the `others`, of neighbours the
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
    let left = force - &q * q.tr_mul(force);
    // Waves a length are evenly spaced: from one to the next each angle turns by the same.
    let waves = |k: usize| grid.get(k).map_or(0.0, |period| 1.0 / period);
    let turned = |by: f64| -> Vec<(f64, f64)> {
        places.iter().map(|place| (TAU * by * place.position).sin_cos()).collect()
    };
    let (mut angles, turns) = (turned(waves(0)), turned(waves(1) - waves(0)));
    let mut wave = DMatrix::zeros(places.len(), 2);
    let mut gain = |period: f64| {
        for (k, place) in places.iter().enumerate() {
            let seen = if place.speed < fastest * period { 1.0 } else { 0.0 };
            let ((s, c), (sin, cos)) = (angles[k], turns[k]);
            (wave[(k, 0)], wave[(k, 1)]) = (seen * c, seen * s);
            angles[k] = (s * cos + c * sin, c * cos - s * sin);
        }
        let followed = q.tr_mul(&wave);
        let own = wave.tr_mul(&wave) - followed.tr_mul(&followed);
        let (cc, cs, ss) = (own[(0, 0)], own[(0, 1)], own[(1, 1)]);
        let (cy, sy) = (wave.column(0).dot(&left), wave.column(1).dot(&left));
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
    fn the_period_that_is_there_is_among_the_first() {
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
        for fastest in [f64::INFINITY, 6.0] {
            let found = promising(&grid, 3, &places, &others, &force, fastest);
            let near = |period: &f64| (20.0 / period - 20.0 / 0.7).abs() < 1.0;
            assert!(found.iter().any(near), "{fastest}: {found:?}");
            assert!(found.len() == 3, "{found:?}");
        }
    }
}
