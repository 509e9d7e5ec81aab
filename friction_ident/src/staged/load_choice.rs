//! Which forces beside friction recordings show.
//!
//! All of them are linear, so that asking costs next to nothing beside a fit. Friction itself is
//! stood for by columns that bend to any of its shapes: the direction of motion, the velocity, two
//! dips, and hysteresis of four reaches (Dahl's operator, which depends on nothing but the travel).
//! The recordings are cut into contiguous blocks, and each is predicted by the fit to the others.

use nalgebra::{DMatrix, DVector};
use serde::Serialize;

use super::FrictionData;
use crate::axis_term::AxisTerm;
use crate::place::regressor;
use crate::position_load::{LoadShape, PositionLoad};
use crate::rest::at_rest;
use crate::rigid_axis::Load;
use crate::statistics::Sample;
use crate::stretch::Stretch;

/// What the comparison says.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PositionLoadChoice {
    /// What to estimate beside friction.
    pub chosen: LoadShape,
    /// What was compared, each with the share of the force that a fit to the other blocks does not
    /// predict: `100 |error| / |force|` \[%\]. Empty where there is too little to compare anything.
    pub compared: Vec<(LoadShape, f64)>,
}

/// Blocks at most.
const BLOCKS: usize = 8;
/// Rows at most: more are thinned.
const ROWS: usize = 20_000;
/// Share of the mean square error that a force of the position must take away.
const WORTH: f64 = 0.1;
/// The same of a constant force, which nothing else goes with.
const OFFSET_WORTH: f64 = 0.01;
/// Standard errors that a gain must be clear of zero by, or how likely chance may be to give it.
const CLEAR: f64 = 2.0;
const CHANCE: f64 = 1.0 / 32.0;
/// How likely chance may be to give a gain of one load over a simpler one: that of one standard error.
const BETTER: f64 = 0.16;
/// Share of the rows that the rarer direction needs: an axis that goes one way only does not tell an
/// offset from its Coulomb friction.
const BOTH_WAYS: f64 = 0.05;
/// Reaches of hysteresis, as shares of the travel.
const REACHES: [f64; 4] = [0.003, 0.01, 0.03, 0.1];
/// Velocities at which a dip may end, as shares of the fastest.
const DIPS: [f64; 2] = [0.02, 0.1];
/// What keeps columns apart that a recording does not tell apart; of columns of unit length.
const RIDGE: f64 = 1e-7;

/// Chooses what is estimated beside friction. A constant force is used where it takes away a
/// hundredth of the mean square error, a force of the position where it takes away a tenth of what
/// a constant one leaves, each clear of chance by two standard errors over the blocks or by the signs
/// of what they gain; of two that are within one standard error the simpler. `asymmetric` models have no constant force beside
/// them: they have it in their two directions. Nor has an axis that goes one way only. Gravity is
/// offered to an axis that turns.
pub fn choose_position_load(
    data: &FrictionData,
    rotary: bool,
    asymmetric: bool,
) -> PositionLoadChoice {
    let nothing = PositionLoadChoice { chosen: LoadShape::NONE, compared: Vec::new() };
    let rows = Rows::new(data, asymmetric);
    let offset = !asymmetric && rows.both_ways;
    let plain = LoadShape { offset, position: Load::None };
    let mut compared = Vec::new();
    let mut errors = |shape: LoadShape| {
        let errors = rows.errors(shape)?;
        compared.push((shape, 100.0 * (sum(&errors) / rows.power).sqrt()));
        Some(errors)
    };
    let Some(without) = errors(LoadShape::NONE) else { return nothing };
    let with_offset = if offset { errors(plain) } else { Some(without.clone()) };
    let Some(with_offset) = with_offset else { return nothing };
    let mut chosen =
        if clear(&without, &with_offset, OFFSET_WORTH) { plain } else { LoadShape::NONE };
    let mut best: Option<Vec<f64>> = None;
    let positions: &[Load] = match (rows.has_places, rotary) {
        (false, _) => &[],
        (true, true) => &[Load::Spring, Load::Gravity],
        (true, false) => &[Load::Spring],
    };
    for &position in positions {
        let shape = LoadShape { position, ..plain };
        let Some(with) = errors(shape) else { continue };
        let worth = clear(&with_offset, &with, WORTH);
        // Simple ones come first: a later one must be better by more than its standard error.
        let better = best.as_ref().is_none_or(|best| {
            let (gain, error) = gain(best, &with);
            gain > error || chance(best, &with) <= BETTER
        });
        if worth && better {
            (chosen, best) = (shape, Some(with));
        }
    }
    PositionLoadChoice { chosen, compared }
}

/// Values to begin with, beside the columns that stand for friction.
pub(super) fn first_values(
    data: &FrictionData,
    shape: LoadShape,
    asymmetric: bool,
) -> PositionLoad {
    let terms = shape.terms();
    let rows = Rows::new(data, asymmetric);
    if terms.is_empty() || rows.force.is_empty() {
        return PositionLoad::default();
    }
    let normal = rows.normal(&terms, |_| true);
    let values = normal.solve().unwrap_or_default();
    PositionLoad::of(&terms, values.get(rows.columns..).unwrap_or_default())
}

fn sum(blocks: &[f64]) -> f64 {
    blocks.iter().sum()
}

/// What `with` errs less than `without` over all blocks, and the standard error of that.
fn gain(without: &[f64], with: &[f64]) -> (f64, f64) {
    let sample = Sample::of(without.iter().zip(with).map(|(a, b)| a - b));
    let blocks = sample.count as f64;
    (blocks * sample.mean, (blocks * sample.variance()).sqrt())
}

fn clear(without: &[f64], with: &[f64], worth: f64) -> bool {
    let (gain, error) = gain(without, with);
    let clear = gain > CLEAR * error || chance(without, with) <= CHANCE;
    clear && gain > worth * sum(without)
}

/// How likely so much gain is where each block might as well have lost what it gains: Fisher's test
/// of all signs. A load that pulls where the axis goes far gains most of all in few blocks, which a
/// standard error takes for chance.
fn chance(without: &[f64], with: &[f64]) -> f64 {
    let gains: Vec<f64> = without.iter().zip(with).map(|(a, b)| a - b).collect();
    let found = sum(&gains) * (1.0 - 1e-9);
    let signed = |signs: u32| {
        let gain = |(k, gain): (usize, &f64)| if signs >> k & 1 == 0 { *gain } else { -gain };
        gains.iter().enumerate().map(gain).sum::<f64>()
    };
    let all = 1u32 << gains.len().min(BLOCKS);
    let many = (0..all).filter(|&signs| signed(signs) >= found).count();
    many as f64 / f64::from(all)
}

/// What the fits see of recordings: samples that move, and steady points.
struct Rows {
    /// Columns that stand for friction, a row after the other.
    friction: Vec<f64>,
    /// How many of them.
    columns: usize,
    /// What multiplies offset, spring, sine and cosine.
    load: Vec<[f64; 4]>,
    force: Vec<f64>,
    /// Weight of each row.
    weight: Vec<f64>,
    /// Which block it belongs to.
    block: Vec<usize>,
    blocks: usize,
    /// Sum of the squares of the force.
    power: f64,
    /// Whether the place of every row is known.
    has_places: bool,
    /// Whether the axis goes both ways.
    both_ways: bool,
}

const TERMS: [AxisTerm; 4] =
    [AxisTerm::Offset, AxisTerm::Spring, AxisTerm::GravitySin, AxisTerm::GravityCos];

impl Rows {
    fn new(data: &FrictionData, asymmetric: bool) -> Self {
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
            let hysteresis = hysteresis(stretch);
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
            rows.friction.extend([point.velocity.signum(); REACHES.len()]);
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
    fn errors(&self, shape: LoadShape) -> Option<Vec<f64>> {
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

    fn normal(&self, terms: &[AxisTerm], wanted: impl Fn(usize) -> bool) -> Normal {
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

struct Normal {
    matrix: DMatrix<f64>,
    right: DVector<f64>,
}

impl Normal {
    /// By Cholesky, of columns of unit length with a ridge. None where something is not finite.
    fn solve(mut self) -> Option<Vec<f64>> {
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

/// Dahl's operator of each reach along a stretch: exact for a travel in steps,
/// `z = s - (s - z) exp(-|dx| / reach)` with `s` the direction of the step.
fn hysteresis(stretch: &Stretch) -> [Vec<f64>; REACHES.len()] {
    let travel = stretch.travel();
    let (low, high) = travel
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &x| (low.min(x), high.max(x)));
    let range = (high - low).max(f64::MIN_POSITIVE);
    let begins = match stretch.before {
        crate::stretch::Before::Slid => stretch.velocity.first().map_or(0.0, |v| v.signum()),
        crate::stretch::Before::Rested => 0.0,
    };
    REACHES.map(|share| {
        let reach = share * range;
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
    })
}
