//! What the choice of a load sees of recordings: columns that stand for friction, those of the
//! loads, and the blocks that are predicted by the fit to the others.

use nalgebra::{DMatrix, DVector};

use super::FrictionData;
use crate::axis_term::AxisTerm;
use crate::place::regressor;
use crate::position_load::LoadShape;
use crate::rest::at_rest;
use crate::stretch::{Before, Stretch};

/// Blocks at most.
pub(super) const BLOCKS: usize = 8;
/// Rows at most: more are thinned.
const ROWS: usize = 20_000;
/// Share of the rows that the rarer direction needs: an axis that goes one way only does not tell an
/// offset from its Coulomb friction.
const BOTH_WAYS: f64 = 0.05;
/// Reaches of hysteresis, as shares of the travel.
const REACHES: [f64; 4] = [0.003, 0.01, 0.03, 0.1];
/// Velocities at which a dip may end, as shares of the fastest.
const DIPS: [f64; 2] = [0.02, 0.1];
/// What keeps columns apart that a recording does not tell apart; of columns of unit length.
const RIDGE: f64 = 1e-7;

/// What the fits see of recordings: samples that move, and steady points.
pub(super) struct Rows {
    /// Columns that stand for friction, a row after the other.
    friction: Vec<f64>,
    /// How many of them.
    pub columns: usize,
    /// What multiplies offset, spring, sine and cosine.
    load: Vec<[f64; 4]>,
    pub force: Vec<f64>,
    /// Weight of each row.
    weight: Vec<f64>,
    /// Which block it belongs to.
    block: Vec<usize>,
    blocks: usize,
    /// Sum of the squares of the force.
    pub power: f64,
    /// Whether the place of every row is known.
    pub has_places: bool,
    /// Whether the axis goes both ways.
    pub both_ways: bool,
}

const TERMS: [AxisTerm; 4] =
    [AxisTerm::Offset, AxisTerm::Spring, AxisTerm::GravitySin, AxisTerm::GravityCos];

impl Rows {
    /// `long` adds hysteresis of one reach more, as a share of the longest travel.
    pub fn new(data: &FrictionData, asymmetric: bool, long: Option<f64>) -> Self {
        let stretches = || data.lag.iter().chain(&data.mixed);
        let fastest = stretches()
            .flat_map(|stretch| &stretch.velocity)
            .copied()
            .chain(data.points.iter().map(|point| point.velocity))
            .fold(0.0f64, |fastest, v| fastest.max(v.abs()))
            .max(f64::MIN_POSITIVE);
        let samples: usize = stretches().map(Stretch::len).sum();
        let every = samples.div_ceil(ROWS).max(1);
        let columns =
            if asymmetric { 2 * (2 + DIPS.len()) } else { 2 + DIPS.len() } + REACHES.len();
        let columns = columns + usize::from(long.is_some());
        let longest = stretches().map(Stretch::range).fold(0.0, f64::max);
        let mut rows = Self {
            friction: Vec::new(),
            columns,
            load: Vec::new(),
            force: Vec::new(),
            weight: Vec::new(),
            block: Vec::new(),
            blocks: 0,
            power: 0.0,
            has_places: true,
            both_ways: false,
        };
        for stretch in stretches() {
            let mut reaches = REACHES.map(|share| share * stretch.range()).to_vec();
            reaches.extend(long.map(|share| share * longest));
            let hysteresis = hysteresis(stretch, &reaches);
            let rest = at_rest(stretch);
            for k in (0..stretch.len()).step_by(every) {
                if !rest.get(k).copied().unwrap_or(false) {
                    let place = stretch.place(k);
                    rows.has_places &= place.is_some();
                    rows.static_columns(stretch.velocity[k], fastest, asymmetric);
                    rows.friction.extend(hysteresis.iter().map(|operator| operator[k]));
                    rows.load.push(TERMS.map(|term| regressor(term, place)));
                    rows.force.push(stretch.friction[k]);
                    rows.weight.push(1.0);
                }
            }
        }
        let moving = rows.force.len();
        // All points together count as much as all samples.
        let heavy = (moving as f64 / data.points.len().max(1) as f64).max(1.0).sqrt();
        for point in &data.points {
            rows.has_places &= point.place.is_some();
            rows.static_columns(point.velocity, fastest, asymmetric);
            let slides = std::iter::repeat_n(point.velocity.signum(), REACHES.len());
            rows.friction.extend(slides.chain(long.map(|_| point.velocity.signum())));
            rows.load.push(TERMS.map(|term| regressor(term, point.place)));
            rows.force.push(point.torque);
            rows.weight.push(heavy);
        }
        // The first column is the direction.
        let mut ways = [0.0; 2];
        for (row, weight) in rows.friction.chunks_exact(columns).zip(&rows.weight) {
            ways[usize::from(row[0] < 0.0)] += weight * weight;
        }
        rows.both_ways = ways[0].min(ways[1]) >= BOTH_WAYS * (ways[0] + ways[1]);
        let size = BLOCKS.min(moving / (4 * columns)).max(if moving == 0 { BLOCKS } else { 0 });
        rows.blocks = size;
        // Samples of one block are neighbours; points have no order in time and are dealt out.
        rows.block = (0..rows.force.len())
            .map(|row| if row < moving { row * size / moving } else { row % size.max(1) })
            .collect();
        rows.power =
            rows.force.iter().zip(&rows.weight).map(|(f, weight)| (weight * f).powi(2)).sum();
        rows
    }

    /// Direction, velocity and dips; of asymmetric friction each direction's own.
    fn static_columns(&mut self, velocity: f64, fastest: f64, asymmetric: bool) {
        let sign = if velocity == 0.0 { 0.0 } else { velocity.signum() };
        let dip = |share: &f64| sign * (-velocity.abs() / (share * fastest)).exp();
        let columns = [sign, velocity / fastest].into_iter().chain(DIPS.iter().map(dip));
        for column in columns {
            if asymmetric {
                self.friction.extend([column.max(0.0), column.min(0.0)]);
            } else {
                self.friction.push(column);
            }
        }
    }

    /// Squared errors of each block, predicted by the fit to the others.
    pub fn errors(&self, shape: LoadShape) -> Option<Vec<f64>> {
        let terms = shape.terms();
        if self.blocks < 3 || self.force.len() < 3 * (self.columns + terms.len()) {
            return None;
        }
        (0..self.blocks)
            .map(|block| {
                let values = self.normal(&terms, |row| self.block[row] != block).solve()?;
                let off = |row: usize| {
                    let predicted: f64 = self
                        .row(row, &terms)
                        .zip(&values)
                        .map(|(column, value)| column * value)
                        .sum();
                    (self.weight[row] * (predicted - self.force[row])).powi(2)
                };
                let rows = (0..self.force.len()).filter(|&row| self.block[row] == block);
                Some(rows.map(off).sum())
            })
            .collect()
    }

    fn row<'a>(&'a self, row: usize, terms: &'a [AxisTerm]) -> impl Iterator<Item = f64> + 'a {
        let friction = &self.friction[row * self.columns..(row + 1) * self.columns];
        let load = &self.load[row];
        let of = move |term: &AxisTerm| {
            TERMS
                .iter()
                .zip(load)
                .find(|(other, _)| *other == term)
                .map_or(0.0, |(_, value)| *value)
        };
        friction.iter().copied().chain(terms.iter().map(of))
    }

    pub fn normal(&self, terms: &[AxisTerm], wanted: impl Fn(usize) -> bool) -> Normal {
        let n = self.columns + terms.len();
        let mut normal = Normal { matrix: DMatrix::zeros(n, n), right: DVector::zeros(n) };
        let mut values = vec![0.0; n];
        for row in (0..self.force.len()).filter(|&row| wanted(row)) {
            let square = self.weight[row].powi(2);
            values.iter_mut().zip(self.row(row, terms)).for_each(|(value, column)| *value = column);
            for j in 0..n {
                let weighted = square * values[j];
                for (i, value) in values.iter().enumerate().take(j + 1) {
                    normal.matrix[(i, j)] += weighted * value;
                }
                normal.right[j] += weighted * self.force[row];
            }
        }
        normal.matrix.fill_lower_triangle_with_upper_triangle();
        normal
    }
}

pub(super) struct Normal {
    matrix: DMatrix<f64>,
    right: DVector<f64>,
}

impl Normal {
    /// By Cholesky, of columns of unit length with a ridge. None where something is not finite.
    pub fn solve(mut self) -> Option<Vec<f64>> {
        let n = self.right.len();
        let scale: Vec<f64> = (0..n)
            .map(|j| self.matrix[(j, j)].sqrt())
            .map(|norm| if norm > 0.0 { norm } else { 1.0 })
            .collect();
        for j in 0..n {
            for i in 0..n {
                self.matrix[(i, j)] /= scale[i] * scale[j];
            }
            self.matrix[(j, j)] += RIDGE;
            self.right[j] /= scale[j];
        }
        let solution = crate::finite::finite(self.matrix)?.cholesky()?.solve(&self.right);
        let values: Vec<f64> = solution.iter().zip(&scale).map(|(x, scale)| x / scale).collect();
        values.iter().all(|value| value.is_finite()).then_some(values)
    }
}

/// Dahl's operator of each reach \[m or rad\] along a stretch: exact for a travel in steps,
/// `z = s - (s - z) exp(-|dx| / reach)` with `s` the direction of the step.
fn hysteresis(stretch: &Stretch, reaches: &[f64]) -> Vec<Vec<f64>> {
    let travel = stretch.travel();
    let begins = match stretch.before {
        Before::Slid => stretch.velocity.first().map_or(0.0, |v| v.signum()),
        Before::Rested => 0.0,
    };
    let along = |reach: &f64| {
        let reach = reach.max(f64::MIN_POSITIVE);
        let mut z = begins;
        let mut operator = Vec::with_capacity(travel.len());
        operator.push(z);
        for pair in travel.windows(2) {
            let dx = pair[1] - pair[0];
            if dx != 0.0 {
                let s = dx.signum();
                z = s - (s - z) * (-dx.abs() / reach).exp();
            }
            operator.push(z);
        }
        operator
    };
    reaches.iter().map(along).collect()
}
