//! What goes with the place, fitted to the trails of all blocks at once.
//!
//! Each block has a friction of its own, which acts against both ways and is taken out of volts and
//! columns alike (Frisch and Waugh 1933). Blocks count by how little they scatter. What is left at a
//! speed is of one cause, so that the errors are those of clusters (Liang and Zeger 1986), with
//! Student's quantile for as many speeds as are left of the columns.

use friction_ident::statistics::{student_95, upper_median};
use nalgebra::{DMatrix, DVector};

use crate::friction::{Part, Trail};

/// Rounds in which the blocks are weighed.
const ROUNDS: usize = 3;
/// Ratio of speeds up to which blocks are of one cluster.
const ALIKE: f64 = 1.25;
/// The least scatter of a block that is believed, as a share of the usual one.
const LEAST: f64 = 0.1;

/// What may go with the place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Column {
    /// The same everywhere.
    One,
    /// The place itself.
    Place,
    /// Sine of so many radians a radian.
    Sine(f64),
    /// Cosine of so many.
    Cosine(f64),
}

impl Column {
    /// Its mean over a part of that length \[rad\] around a place.
    pub(super) fn over(self, place: f64, length: f64) -> f64 {
        let mean = |waves: f64| {
            let half = 0.5 * waves * length;
            if half.abs() < 1e-9 { 1.0 } else { half.sin() / half }
        };
        match self {
            Self::One => 1.0,
            Self::Place => place,
            Self::Sine(waves) => (waves * place).sin() * mean(waves),
            Self::Cosine(waves) => (waves * place).cos() * mean(waves),
        }
    }
}

/// What was fitted.
#[derive(Debug, Clone)]
pub(super) struct Fitted {
    columns: Vec<Column>,
    /// A value a column.
    pub(super) values: DVector<f64>,
    /// Their covariance.
    covariance: DMatrix<f64>,
    /// Clusters less columns.
    free: usize,
    /// Scatter of each block \[V\].
    scatter: Vec<f64>,
}

/// The parts of a trail, with what acts against the way told as one or minus one.
pub(super) fn parts(trail: &Trail) -> impl Iterator<Item = (f64, Part)> + '_ {
    let of = |sign: f64| move |part: &Part| (sign, *part);
    trail.forward.iter().map(of(1.0)).chain(trail.backward.iter().map(of(-1.0)))
}

/// Rows and volts of a block without its friction, and without its mean where that is `level` too.
fn rows(trail: &Trail, columns: &[Column], level: bool) -> (DMatrix<f64>, DVector<f64>) {
    let all: Vec<(f64, Part)> = parts(trail).collect();
    let signs = DVector::from_iterator(all.len(), all.iter().map(|(sign, _)| *sign));
    let without = |mut of: DVector<f64>| {
        let share = of.dot(&signs) / signs.norm_squared();
        of -= &signs * share;
        if level {
            let mean = of.mean();
            of.add_scalar_mut(-mean);
        }
        of
    };
    let volts = without(DVector::from_iterator(all.len(), all.iter().map(|(_, (_, u))| *u)));
    let mut matrix = DMatrix::zeros(all.len(), columns.len());
    for (i, column) in columns.iter().enumerate() {
        let values = all.iter().map(|(_, (place, _))| column.over(*place, trail.length));
        matrix.set_column(i, &without(DVector::from_iterator(all.len(), values)));
    }
    (matrix, volts)
}

impl Fitted {
    /// Fits the columns; none where the blocks are too few, or do not tell the columns apart.
    pub(super) fn of(trails: &[&Trail], columns: &[Column], level: bool) -> Option<Self> {
        // A wave shows at a few speeds only: of each block its own phase is what scatters.
        let clusters = if level { (0..trails.len()).collect() } else { clusters(trails) };
        let count = clusters.iter().max()? + 1;
        let free = count.checked_sub(columns.len() + 1).filter(|free| *free > 0)?;
        let blocks: Vec<_> = trails.iter().map(|trail| rows(trail, columns, level)).collect();
        let n = columns.len();
        let mut weights = vec![1.0; blocks.len()];
        let mut found = None;
        for _ in 0..ROUNDS {
            let mut normal = DMatrix::<f64>::zeros(n, n);
            let mut right = DVector::<f64>::zeros(n);
            for ((x, y), weight) in blocks.iter().zip(&weights) {
                normal += x.transpose() * x * *weight;
                right += x.transpose() * y * *weight;
            }
            // The columns have sizes of their own.
            let sizes = normal.diagonal().map(|size| if size > 0.0 { size.sqrt() } else { 1.0 });
            let even = DMatrix::from_fn(n, n, |i, j| normal[(i, j)] / (sizes[i] * sizes[j]));
            let told = even.clone().symmetric_eigen().eigenvalues.min();
            if n > 0 && told.is_nan() || told < 1e-8 {
                return None;
            }
            let inverse = even.try_inverse()?;
            let inverse = DMatrix::from_fn(n, n, |i, j| inverse[(i, j)] / (sizes[i] * sizes[j]));
            let values = &inverse * right;
            let left: Vec<DVector<f64>> = blocks.iter().map(|(x, y)| y - x * &values).collect();
            let scatter: Vec<f64> =
                left.iter().map(|r| (r.norm_squared() / r.len() as f64).sqrt()).collect();
            let mut middle = DMatrix::<f64>::zeros(n, n);
            let mut scores = vec![DVector::<f64>::zeros(n); count];
            for ((((x, _), r), weight), cluster) in
                blocks.iter().zip(&left).zip(&weights).zip(&clusters)
            {
                scores[*cluster] += x.transpose() * r * *weight;
            }
            for score in &scores {
                middle += score * score.transpose();
            }
            let covariance = &inverse * middle * &inverse * (count as f64 / free as f64);
            let usual = upper_median(&mut scatter.clone()).unwrap_or_default();
            let least = LEAST * usual;
            weights = scatter.iter().map(|s| s.max(least).max(1e-12).powi(-2)).collect();
            found = Some(Self { columns: columns.to_vec(), values, covariance, free, scatter });
        }
        found
    }

    /// A value's standard error and the half width of its 95 % interval.
    pub(super) fn half(&self, column: usize) -> f64 {
        student_95(self.free) * self.covariance[(column, column)].max(0.0).sqrt()
    }

    /// Size of the wave of two columns, and the half width of its 95 % interval.
    pub(super) fn wave(&self, sine: usize) -> (f64, f64) {
        let (a, b) = (self.values[sine], self.values[sine + 1]);
        let size = a.hypot(b);
        if size == 0.0 {
            return (0.0, 0.0);
        }
        let (a, b) = (a / size, b / size);
        let c = |i: usize, j: usize| self.covariance[(sine + i, sine + j)];
        let variance = a * a * c(0, 0) + 2.0 * a * b * c(0, 1) + b * b * c(1, 1);
        (size, student_95(self.free) * variance.max(0.0).sqrt())
    }

    /// Mean square of what it misses of other trails \[V^2\].
    pub(super) fn missed(&self, trails: &[&Trail], level: bool) -> f64 {
        let one = |trail: &&Trail| {
            let (x, y) = rows(trail, &self.columns, level);
            let left = y - x * &self.values;
            left.norm_squared() / left.len() as f64
        };
        trails.iter().map(one).sum::<f64>() / trails.len() as f64
    }

    /// Scatter of each block \[V\].
    pub(super) fn scatter(&self) -> &[f64] {
        &self.scatter
    }

    /// The trail less what was fitted.
    pub(super) fn less(&self, trail: &Trail) -> Trail {
        let less = |(place, volts): &Part| {
            let fitted: f64 = self
                .columns
                .iter()
                .zip(self.values.iter())
                .map(|(column, value)| value * column.over(*place, trail.length))
                .sum();
            (*place, volts - fitted)
        };
        Trail {
            forward: trail.forward.iter().map(less).collect(),
            backward: trail.backward.iter().map(less).collect(),
            ..trail.clone()
        }
    }
}

/// The cluster of each trail.
fn clusters(trails: &[&Trail]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..trails.len()).collect();
    order.sort_by(|a, b| trails[*a].velocity.total_cmp(&trails[*b].velocity));
    let (mut clusters, mut now, mut begins) = (vec![0; trails.len()], 0, None);
    for index in order {
        let velocity = trails[index].velocity;
        match begins {
            Some(first) if velocity > ALIKE * first => (now, begins) = (now + 1, Some(velocity)),
            None => begins = Some(velocity),
            Some(_) => {}
        }
        clusters[index] = now;
    }
    clusters
}

/// Mean square of what is there of trails, less friction and mean \[V^2\].
pub(super) fn there(trails: &[&Trail]) -> f64 {
    let one = |trail: &&Trail| {
        let (_, volts) = rows(trail, &[], true);
        volts.norm_squared() / volts.len() as f64
    };
    trails.iter().map(one).sum::<f64>() / trails.len() as f64
}
