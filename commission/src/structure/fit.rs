//! What goes with the place, fitted to the trails of all blocks at once.
//!
//! Each block has a friction of its own, which acts against both ways and is taken out of volts and
//! columns alike (Frisch and Waugh 1933). Blocks count by how little they scatter. What is left at a
//! speed is of one cause, so that the errors are those of clusters: the jackknife that leaves out one
//! speed after the other (MacKinnon, Nielsen and Webb 2023, J. Econometrics 232, CV3). Student's
//! quantile is for as many speeds as effectively tell of a column (Carter, Schnepel and Steigerwald
//! 2017, Rev. Econ. Stat. 99), and no more than are left of the columns.

use friction_ident::statistics::{student_95, upper_median};
use nalgebra::{DMatrix, DVector};

use crate::friction::{Part, Trail};

/// Rounds in which the blocks are weighed.
const ROUNDS: usize = 3;
/// Ratio of speeds up to which blocks are of one cluster.
const ALIKE: f64 = 1.25;
/// The least scatter of a block that is believed, as a share of the usual one: what all parts of a block
/// share does not show in it.
const LEAST: f64 = 0.5;

/// What may go with the place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Column {
    /// The same everywhere.
    One,
    /// The same all over a block, by its speed over the fastest one [rad/s]: viscous friction of a
    /// stickier direction.
    Speed(f64),
    /// The place itself.
    Place,
    /// Sine of so many radians a radian.
    Sine(f64),
    /// Cosine of so many.
    Cosine(f64),
}

impl Column {
    /// Its mean over a part of a trail around a place \[rad\].
    pub(super) fn over(self, place: f64, trail: &Trail) -> f64 {
        let length = trail.length;
        let mean = |waves: f64| {
            let half = 0.5 * waves * length;
            if half.abs() < 1e-9 { 1.0 } else { half.sin() / half }
        };
        match self {
            Self::One => 1.0,
            Self::Speed(fastest) => trail.velocity / fastest,
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
    /// Degrees of freedom of each.
    free: Vec<usize>,
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
        let values = all.iter().map(|(_, (place, _))| column.over(*place, trail));
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
            let mut parts = vec![(DMatrix::<f64>::zeros(n, n), DVector::<f64>::zeros(n)); count];
            for (((x, y), weight), cluster) in blocks.iter().zip(&weights).zip(&clusters) {
                parts[*cluster].0 += x.transpose() * x * *weight;
                parts[*cluster].1 += x.transpose() * y * *weight;
            }
            let normal = parts.iter().fold(DMatrix::zeros(n, n), |sum, part| sum + &part.0);
            let right = parts.iter().fold(DVector::zeros(n), |sum, part| sum + &part.1);
            let inverse = inverted(&normal)?;
            let values = &inverse * &right;
            let left: Vec<DVector<f64>> = blocks.iter().map(|(x, y)| y - x * &values).collect();
            let scatter: Vec<f64> =
                left.iter().map(|r| (r.norm_squared() / r.len() as f64).sqrt()).collect();
            let covariance = jackknife(&normal, &right, &parts)?;
            let free = (0..n).map(|column| effective(&inverse, &parts, column).min(free)).collect();
            let usual = upper_median(&mut scatter.clone()).unwrap_or_default();
            let least = LEAST * usual;
            weights = scatter.iter().map(|s| s.max(least).max(1e-12).powi(-2)).collect();
            found = Some(Self { columns: columns.to_vec(), values, covariance, free, scatter });
        }
        found
    }

    /// A value's standard error and the half width of its 95 % interval.
    pub(super) fn half(&self, column: usize) -> f64 {
        student_95(self.free[column]) * self.covariance[(column, column)].max(0.0).sqrt()
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
        let free = self.free[sine].min(self.free[sine + 1]);
        (size, student_95(free) * variance.max(0.0).sqrt())
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
                .map(|(column, value)| value * column.over(*place, trail))
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

/// The inverse; none where the columns are not told apart.
fn inverted(normal: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let n = normal.nrows();
    // The columns have sizes of their own.
    let sizes = normal.diagonal().map(|size| if size > 0.0 { size.sqrt() } else { 1.0 });
    let even = DMatrix::from_fn(n, n, |i, j| normal[(i, j)] / (sizes[i] * sizes[j]));
    let told = even.clone().symmetric_eigen().eigenvalues.min();
    if n > 0 && told.is_nan() || told < 1e-8 {
        return None;
    }
    let inverse = even.try_inverse()?;
    Some(DMatrix::from_fn(n, n, |i, j| inverse[(i, j)] / (sizes[i] * sizes[j])))
}

/// Covariance by what the values are without each of the clusters; none where one of them alone tells
/// the columns apart.
fn jackknife(
    normal: &DMatrix<f64>,
    right: &DVector<f64>,
    parts: &[(DMatrix<f64>, DVector<f64>)],
) -> Option<DMatrix<f64>> {
    let without = |(own, told): &(DMatrix<f64>, DVector<f64>)| {
        Some(inverted(&(normal - own))? * (right - told))
    };
    let all: Vec<DVector<f64>> = parts.iter().map(without).collect::<Option<_>>()?;
    let count = all.len() as f64;
    let mean = all.iter().fold(DVector::zeros(right.len()), |sum, one| sum + one) / count;
    let n = right.len();
    let spread = all.iter().fold(DMatrix::zeros(n, n), |sum, one| {
        let apart = one - &mean;
        sum + &apart * apart.transpose()
    });
    Some(spread * ((count - 1.0) / count))
}

/// Degrees of freedom by how many clusters effectively tell of a column.
fn effective(
    inverse: &DMatrix<f64>,
    parts: &[(DMatrix<f64>, DVector<f64>)],
    column: usize,
) -> usize {
    let of = inverse.column(column);
    let share = |part: &(DMatrix<f64>, DVector<f64>)| (of.transpose() * &part.0 * of)[0];
    let shares: Vec<f64> = parts.iter().map(share).collect();
    let (sum, squares) =
        shares.iter().fold((0.0, 0.0), |(sum, squares), a| (sum + a, squares + a * a));
    let clusters = sum * sum / squares;
    if clusters.is_finite() { (clusters.round() as usize).saturating_sub(1).max(1) } else { 1 }
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
