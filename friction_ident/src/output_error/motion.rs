//! What moves at each residual: velocity, acceleration, way since the last reversal, and position
//! where it is known everywhere.

use super::Measured;
use crate::stretch::Stretch;

/// One column a quantity, one value a point or sample, those at rest left out.
pub(super) fn motion(data: &Measured, rest: &[Vec<bool>]) -> Vec<Vec<f64>> {
    let points = data.points;
    // A steady point has slid for long, at no acceleration.
    let mut velocity: Vec<f64> = points.iter().map(|point| point.velocity).collect();
    let mut acceleration = vec![0.0; points.len()];
    let mut way = vec![f64::INFINITY; points.len()];
    let mut position: Option<Vec<f64>> =
        points.iter().map(|point| point.place.map(|place| place.position)).collect();
    for (stretch, rest) in data.stretches.iter().zip(rest) {
        let moves = |k: &usize| !rest.get(*k).copied().unwrap_or(false);
        let kept = || (0..stretch.len()).filter(moves);
        let since = ways(stretch);
        velocity.extend(kept().map(|k| stretch.velocity[k]));
        acceleration.extend(kept().map(|k| slope(stretch, k)));
        way.extend(kept().map(|k| since[k]));
        position = position.zip(stretch.position.as_ref()).map(|(mut all, own)| {
            all.extend(kept().map(|k| own[k]));
            all
        });
    }
    [velocity, acceleration, way].into_iter().chain(position).collect()
}

/// The acceleration by central differences, at both ends by half of one.
fn slope(stretch: &Stretch, k: usize) -> f64 {
    let (before, after) = (k.saturating_sub(1), (k + 1).min(stretch.len() - 1));
    let time = after.saturating_sub(before).max(1) as f64 * stretch.time_step;
    (stretch.velocity[after] - stretch.velocity[before]) / time
}

/// The way since the last reversal at each sample.
fn ways(stretch: &Stretch) -> Vec<f64> {
    let (mut since, mut before) = (0.0, 0.0f64);
    let of = |&v: &f64| {
        since = if v * before < 0.0 { 0.0 } else { since + v.abs() * stretch.time_step };
        before = v;
        since
    };
    stretch.velocity.iter().map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::steady_point::SteadyPoint;

    #[test]
    fn every_residual_has_its_motion() {
        let velocity = vec![0.0, 1.0, 1.0, -1.0, -1.0];
        let position = vec![0.0, 0.05, 0.15, 0.15, 0.05];
        let stretch = Stretch::new(0.1, velocity, Some(position), vec![1.0; 5]).unwrap();
        let point = SteadyPoint::new(3.0, 2.0);
        let rest = [vec![true, false, false, false, false]];
        let data = Measured {
            points: &[],
            stretches: std::slice::from_ref(&stretch),
            ..Measured::default()
        };
        let found = motion(&data, &rest);
        let expected = [
            vec![1.0, 1.0, -1.0, -1.0],
            vec![5.0, -10.0, -10.0, 0.0],
            vec![0.1, 0.2, 0.0, 0.1],
            vec![0.05, 0.15, 0.15, 0.05],
        ];
        for (found, expected) in found.iter().zip(&expected) {
            let near = |(a, b): (&f64, &f64)| (a - b).abs() < 1e-12;
            assert!(found.iter().zip(expected).all(near), "{found:?}, not {expected:?}");
        }
        // A point without a place leaves the position out.
        let found = motion(&Measured { points: &[point], ..data }, &rest);
        assert_eq!((found.len(), found[0].len(), found[0][0]), (3, 5, 3.0));
    }
}
