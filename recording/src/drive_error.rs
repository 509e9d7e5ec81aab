//! What the errors of a drive's constants do to the friction of a recording.
//!
//! An error of a constant is the same throughout a recording and does not average out. It is kept
//! as the friction error that one standard error of the constant makes at each steady point and
//! each sample, with its sign.

use friction_ident::{DriveConstant, SteadyPoint, Stretch};
use serde::Serialize;

/// The friction error that one standard error of a constant makes.
#[derive(Debug, Clone, PartialEq)]
pub struct DriveError {
    /// Which constant.
    pub constant: DriveConstant,
    /// At each steady point \[N or N m\].
    pub points: Vec<f64>,
    /// At each sample of each stretch \[N or N m\].
    pub stretches: Vec<Vec<f64>>,
}

impl DriveError {
    /// None yet.
    pub(super) const fn new(constant: DriveConstant) -> Self {
        Self { constant, points: Vec::new(), stretches: Vec::new() }
    }

    /// `points` and `stretches` as they were if the constant were higher by one standard error.
    #[must_use]
    pub fn moved(
        &self,
        points: &[SteadyPoint],
        stretches: &[Stretch],
    ) -> (Vec<SteadyPoint>, Vec<Stretch>) {
        let mut points = points.to_vec();
        for (point, error) in points.iter_mut().zip(&self.points) {
            point.torque += error;
        }
        let mut stretches = stretches.to_vec();
        for (stretch, errors) in stretches.iter_mut().zip(&self.stretches) {
            stretch
                .friction
                .iter_mut()
                .zip(errors)
                .for_each(|(friction, error)| *friction += error);
        }
        (points, stretches)
    }

    fn all(&self) -> impl Iterator<Item = f64> {
        self.points.iter().chain(self.stretches.iter().flatten()).copied()
    }
}

/// What the constants together add to the uncertainty of the friction: standard deviations.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct AddedUncertainty {
    /// Root mean square over the points and samples \[N or N m\].
    pub rms: f64,
    /// The largest \[N or N m\].
    pub largest: f64,
}

impl AddedUncertainty {
    /// Of all constants that enter; none with a torque sensor.
    #[must_use]
    pub fn of(errors: &[DriveError]) -> Option<Self> {
        let mut variances: Vec<f64> = Vec::new();
        for error in errors {
            let squares = error.all().map(|value| value * value);
            if variances.is_empty() {
                variances = squares.collect();
            } else {
                variances.iter_mut().zip(squares).for_each(|(sum, square)| *sum += square);
            }
        }
        let mean = variances.iter().sum::<f64>() / variances.len() as f64;
        let largest = variances.iter().copied().fold(0.0, f64::max);
        (!variances.is_empty()).then(|| Self { rms: mean.sqrt(), largest: largest.sqrt() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn constants_add_in_quadrature_at_each_sample() {
        let error = |constant, point, sample| DriveError {
            constant,
            points: vec![point],
            stretches: vec![vec![0.0, sample]],
        };
        let both = [
            error(DriveConstant::Inertia, 3.0, -1.0),
            error(DriveConstant::TorqueConstant, -4.0, 0.0),
        ];
        let added = AddedUncertainty::of(&both).unwrap();
        assert!(
            (added.largest - 5.0).abs() < 1e-12
                && (added.rms - (26.0f64 / 3.0).sqrt()).abs() < 1e-12
        );
        assert_eq!(AddedUncertainty::of(&[]), None);
        let stretch = Stretch::new(1e-3, vec![1.0; 2], None, vec![0.5; 2]).unwrap();
        let (points, stretches) = both[0].moved(&[SteadyPoint::new(1.0, 0.5)], &[stretch]);
        assert_eq!((points[0].torque, &stretches[0].friction[..]), (3.5, &[0.5, -0.5][..]));
    }
}
