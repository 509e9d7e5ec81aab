//! The scan.

use friction_model::{FrictionModel, TwoLine, TwoLineParameters};
use nalgebra::{DMatrix, DVector};

use super::TwoLineFit;
use crate::least_squares;
use crate::steady_point::{Needed, check_points, different_speeds, relative_weights};
use crate::{IdentError, SteadyPoint};

/// Different speeds that each region keeps.
const SPEEDS_A_REGION: usize = 3;
/// Standard errors that the change of slope must be worth. Three rather than two: the scan picks
/// the break where noise looks most like a bend.
const CLEAR_BEND: f64 = 3.0;

/// Fits two lines to steady points of either sign of velocity. Points at rest count for nothing.
///
/// # Errors
/// [`IdentError::TooFewSamples`] below eight points, [`IdentError::TooFewSpeeds`] below six speeds,
/// [`IdentError::NotFinite`], [`IdentError::StandardDeviation`], [`IdentError::MixedDeviations`],
/// [`IdentError::ZeroForce`]; [`IdentError::NotAModel`] for torques that drive instead of braking,
/// and [`IdentError::NoBend`] where one line does as well.
pub fn fit_two_line(points: &[SteadyPoint]) -> Result<TwoLineFit, IdentError> {
    let needed =
        Needed { what: "a two-line curve", points: 8, speeds: 2 * SPEEDS_A_REGION, lower: None };
    let extremes = check_points(points, &needed)?;
    let moving: Vec<_> = points.iter().copied().filter(|point| point.velocity != 0.0).collect();
    let data = Data::new(&moving);
    let rounding = 1e-26 * data.friction.iter().map(|friction| friction * friction).sum::<f64>();
    let straight = data.solve(|_| true, line(false), 0.0).map_or(0.0, |(_, squares)| squares);
    if straight <= rounding {
        return Err(IdentError::NoBend { change: 0.0, standard_error: 0.0 });
    }

    let speeds = different_speeds(&moving);
    let mut best: Option<Candidate> = None;
    let mut refused: Option<(f64, IdentError)> = None;
    for pair in speeds[SPEEDS_A_REGION - 1..=speeds.len() - SPEEDS_A_REGION].windows(2) {
        let &[below, above] = pair else { continue };
        // The slope of the second line free first, then held at zero; on exact data the richer
        // shape must win by more than rounding.
        for level in [false, true] {
            for candidate in
                [data.apart(below, above, level), data.joined(below, level)].into_iter().flatten()
            {
                let squares = candidate.squares + if level { 0.0 } else { rounding };
                match TwoLine::try_from(candidate.lines) {
                    Ok(_) if best.as_ref().is_none_or(|best| squares < best.squares) => {
                        best = Some(Candidate { squares, ..candidate });
                    }
                    Err(error) if refused.as_ref().is_none_or(|(least, _)| squares < *least) => {
                        refused = Some((squares, error.into()));
                    }
                    _ => {}
                }
            }
        }
    }
    match (best, refused) {
        (Some(best), _) => data.summarise(&best, extremes),
        (None, Some((_, error))) => Err(error),
        (None, None) => Err(IdentError::NoConvergence("no break leaves two lines".to_owned())),
    }
}

/// Two lines, and what they leave unexplained.
struct Candidate {
    lines: TwoLineParameters,
    /// Fastest speed of the first region.
    last: f64,
    /// Whether `b2` is held at zero.
    level: bool,
    squares: f64,
}

/// A regressor: of the speed and the break.
type Regressor = fn(f64, f64) -> f64;

/// The points of both directions as one: friction against speed, with the square roots of their
/// weights. Multiplying a row of `[sgn v, v]` by `sgn v` gives `[1, |v|]` and leaves its squares
/// alone.
struct Data {
    speed: Vec<f64>,
    friction: Vec<f64>,
    weight: Vec<f64>,
}

impl Data {
    fn new(points: &[SteadyPoint]) -> Self {
        Self {
            speed: points.iter().map(|point| point.velocity.abs()).collect(),
            friction: points.iter().map(|point| point.torque * point.velocity.signum()).collect(),
            weight: relative_weights(points),
        }
    }

    /// The weighted design of the points that `inside` chooses.
    fn design(
        &self,
        inside: impl Fn(f64) -> bool,
        regressors: &[Regressor],
        bend: f64,
    ) -> (DMatrix<f64>, DVector<f64>) {
        let rows: Vec<_> = (0..self.speed.len()).filter(|&i| inside(self.speed[i])).collect();
        let matrix = DMatrix::from_fn(rows.len(), regressors.len(), |i, j| {
            self.weight[rows[i]] * regressors[j](self.speed[rows[i]], bend)
        });
        let y = DVector::from_fn(rows.len(), |i, _| self.weight[rows[i]] * self.friction[rows[i]]);
        (matrix, y)
    }

    /// Coefficients and sum of squares of the points that `inside` chooses; none where the
    /// regressors depend on one another.
    fn solve(
        &self,
        inside: impl Fn(f64) -> bool,
        regressors: &[Regressor],
        bend: f64,
    ) -> Option<(DVector<f64>, f64)> {
        let (matrix, y) = self.design(inside, regressors, bend);
        let solution = least_squares::solve(&matrix, &y).ok()?;
        Some((solution.x, solution.residual.norm_squared()))
    }

    /// The regions fitted apart, split between two neighbouring speeds; none unless the lines meet
    /// between them.
    fn apart(&self, below: f64, above: f64, level: bool) -> Option<Candidate> {
        let split = 0.5 * (below + above);
        let (first, left) = self.solve(|v| v < split, line(false), 0.0)?;
        let (second, right) = self.solve(|v| v > split, line(level), 0.0)?;
        let b2 = if level { 0.0 } else { second[1] };
        let lines = TwoLineParameters { a1: first[0], b1: first[1], a2: second[0], b2 };
        let meeting = (lines.a1 - lines.a2) / (lines.b2 - lines.b1);
        let squares = left + right;
        (below..=above).contains(&meeting).then_some(Candidate {
            lines,
            last: below,
            level,
            squares,
        })
    }

    /// The best lines that meet at a measured speed.
    fn joined(&self, bend: f64, level: bool) -> Option<Candidate> {
        let free: [Regressor; 3] = [|_, _| 1.0, |v, _| v, |v, bend| (v - bend).max(0.0)];
        let flat: [Regressor; 2] = [|_, _| 1.0, |v, bend| v.min(bend)];
        let (x, squares) = self.solve(|_| true, if level { &flat } else { &free }, bend)?;
        let (a1, b1) = (x[0], x[1]);
        let b2 = if level { 0.0 } else { b1 + x[2] };
        let lines = TwoLineParameters { a1, b1, a2: a1 + (b1 - b2) * bend, b2 };
        Some(Candidate { lines, last: bend, level, squares })
    }

    fn summarise(&self, best: &Candidate, speeds: (f64, f64)) -> Result<TwoLineFit, IdentError> {
        let Candidate { lines, last, level, .. } = *best;
        let model = TwoLine::try_from(lines)?;
        let points = self.speed.len();
        let degrees_of_freedom = points - if level { 3 } else { 4 };
        let residual = |i: usize| model.steady_state(self.speed[i]) - self.friction[i];
        let squares: f64 = (0..points).map(|i| (self.weight[i] * residual(i)).powi(2)).sum();
        let mse = (0..points).map(|i| residual(i).powi(2)).sum::<f64>() / points as f64;

        // Known breaks make the covariance one block a region.
        let slack = last * (1.0 + 1e-6);
        let block = |first: bool| {
            let (matrix, y) = self.design(|v| (v <= slack) == first, line(level && !first), 0.0);
            least_squares::solve(&matrix, &y)
                .map(|solution| solution.inverse_normal * (squares / degrees_of_freedom as f64))
                .map_err(|_| {
                    IdentError::NoConvergence("the speeds of a region are too close".to_owned())
                })
        };
        let (first, second) = (block(true)?, block(false)?);
        let variance_b2 = if level { 0.0 } else { second[(1, 1)] };
        let change = lines.b2 - lines.b1;
        let standard_error = (first[(1, 1)] + variance_b2).sqrt();
        if change.abs() < CLEAR_BEND * standard_error || standard_error.is_nan() {
            return Err(IdentError::NoBend { change, standard_error });
        }
        // v_sw = (a1 - a2) / (b2 - b1): the error of the difference of the lines there, over the
        // change of slope.
        let at = model.switch_speed();
        let difference = |block: &DMatrix<f64>, slope: f64| {
            let cross = if block.ncols() > 1 { 2.0 * at * block[(0, 1)] } else { 0.0 };
            block[(0, 0)] + cross + at * at * slope
        };
        let variance = difference(&first, first[(1, 1)]) + difference(&second, variance_b2);
        Ok(TwoLineFit {
            model,
            standard_errors: [
                Some(first[(0, 0)].sqrt()),
                Some(first[(1, 1)].sqrt()),
                Some(second[(0, 0)].sqrt()),
                (!level).then(|| variance_b2.sqrt()),
            ],
            switch_speed_error: variance.max(0.0).sqrt() / change.abs(),
            mse,
            points,
            degrees_of_freedom,
            speeds,
        })
    }
}

/// Regressors of one region.
fn line(level: bool) -> &'static [Regressor] {
    if level { &[|_, _| 1.0] } else { &[|_, _| 1.0, |v, _| v] }
}
