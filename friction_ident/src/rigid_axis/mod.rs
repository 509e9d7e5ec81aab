//! Inertia and friction of a driven axis: `M a + Fv v + Fc sign(v) + offset = force`, by linear
//! least squares.
//!
//! The model of Janot, Gautier and Brunot, "Data set and reference models of EMPS", 2019, and what
//! is behind most industrial friction identification. [`AxisModel::SYMMETRIC`] has one viscous and
//! one Coulomb coefficient and an offset; [`AxisModel::ASYMMETRIC`] has a pair for each direction
//! of motion, which takes the place of the offset (`Fc sign(v) + offset` is `Fc+` upwards and
//! `-Fc-` downwards).
//!
//! The regressors are built at the full sampling rate, then all of them and the force are decimated
//! with the same filter: a step of `sign(v)` and the step of force it causes stay alike. The
//! standard errors are those of [`robust_covariance`](crate::robust_covariance), which hold where
//! the residual is coloured or the model lacks something, as it always does on real axes; those of
//! ordinary least squares, `s^2 (A^T A)^-1`, which count the residual as white and are what others
//! publish, stand beside them. Where the position is known a [`Load`] may be added: a spring or
//! gravity, which [`choose_load`] decides. What it cannot reproduce: the Stribeck dip, presliding,
//! friction that depends on position or load.

use nalgebra::{DMatrix, DVector};
use serde::Serialize;

use crate::IdentError;
use crate::axis_term::AxisTerm;
use crate::conditioning::{Conditioned, Piece};
use crate::least_squares::{self, Degenerate};
use crate::robust_covariance::{Course, ErrorDoubt, RobustError, robust_covariance};
use crate::statistics::root_mean_square;
use crate::zero_phase::decimate;

/// Which terms the model has.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct AxisModel {
    /// A viscous and a Coulomb coefficient for each direction, in place of one pair and an offset.
    pub asymmetric: bool,
    /// With the inertia: the force is the driving force. Without: it is the friction alone.
    pub inertia: bool,
    /// With a constant force; only a symmetric model has one.
    pub offset: bool,
    /// With a force that the position alone decides.
    pub load: Load,
}

impl AxisModel {
    /// Inertia, viscous and Coulomb friction, offset.
    pub const SYMMETRIC: Self =
        Self { asymmetric: false, inertia: true, offset: true, load: Load::None };
    /// Inertia, and viscous and Coulomb friction for each direction.
    pub const ASYMMETRIC: Self =
        Self { asymmetric: true, inertia: true, offset: false, load: Load::None };

    /// The terms, in the order of the tables.
    pub fn terms(self) -> Vec<AxisTerm> {
        use AxisTerm::*;
        let mut terms = Vec::new();
        if self.inertia {
            terms.push(Inertia);
        }
        if self.asymmetric {
            terms.extend([ViscousPositive, ViscousNegative, CoulombPositive, CoulombNegative]);
        } else {
            terms.extend([Viscous, Coulomb]);
            if self.offset {
                terms.push(Offset);
            }
        }
        match self.load {
            Load::None => {}
            Load::Spring => terms.push(Spring),
            Load::Gravity => terms.extend([GravitySin, GravityCos]),
        }
        terms
    }
}

/// One estimated term, in the recording's units.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct TermEstimate {
    /// Which term.
    pub term: AxisTerm,
    /// Its value.
    pub value: f64,
    /// Its standard error, by [`robust_covariance`](crate::robust_covariance).
    pub standard_error: f64,
    /// Half the width of its 95 % interval.
    pub half_width: f64,
    /// The standard error of ordinary least squares, which counts the residual as white: what is
    /// usually published, and too small where the model lacks something.
    pub white_error: f64,
    /// Why the standard error is not to be trusted.
    pub doubt: Option<ErrorDoubt>,
}

impl TermEstimate {
    /// Whether the data say anything about the term: its standard error is below half its value and
    /// to be trusted, and it is nothing that cannot be.
    pub fn is_identifiable(&self) -> bool {
        !self.is_impossible()
            && self.doubt.is_none()
            && self.standard_error < 0.5 * self.value.abs()
    }

    /// Whether it is a mass below zero, or friction that would drive the axis.
    pub fn is_impossible(&self) -> bool {
        !self.term.is_signed() && self.value < 0.0
    }
}

/// An axis model fitted to a recording.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AxisFit {
    /// Which terms were fitted.
    pub model: AxisModel,
    /// The terms, in the order of [`AxisModel::terms`].
    pub terms: Vec<TermEstimate>,
    /// How the errors of the terms go together, a row a term; empty where there are none.
    #[serde(skip)]
    pub correlation: Vec<Vec<f64>>,
    /// `100 |residual| / |force|` \[%\].
    pub relative_error: f64,
    /// Root mean square of the residual \[N or N m\].
    pub residual_rms: f64,
    /// Decimated samples that were fitted.
    pub samples: usize,
}

/// What a fitted model says about a recording, on the decimated samples.
#[derive(Debug, Clone, PartialEq)]
pub struct Prediction {
    /// Time since the recording's first sample \[s\].
    pub time: Vec<f64>,
    /// Velocity \[m/s or rad/s\].
    pub velocity: Vec<f64>,
    /// Measured force \[N or N m\].
    pub measured: Vec<f64>,
    /// Predicted force \[N or N m\].
    pub predicted: Vec<f64>,
    /// Measured force less the model's inertia times the acceleration and the force of its load \[N
    /// or N m\]: what is left for friction.
    pub friction: Vec<f64>,
    /// `100 |measured - predicted| / |measured|` \[%\].
    pub relative_error: f64,
}

impl Prediction {
    /// The stretches of time that the rows fill without a gap, first and last row of each \[s\]. What
    /// lies between them was at rest, or was not recorded.
    pub fn stretches(&self) -> Vec<[f64; 2]> {
        let steps = self.time.windows(2).filter_map(|pair| Some(pair.last()? - pair.first()?));
        let step = steps.fold(f64::INFINITY, f64::min);
        let mut stretches: Vec<[f64; 2]> = Vec::new();
        for &time in &self.time {
            match stretches.last_mut() {
                Some([_, last]) if time - *last <= 1.5 * step => *last = time,
                _ => stretches.push([time, time]),
            }
        }
        stretches
    }

    /// Measured minus predicted force \[N or N m\].
    pub fn residual(&self) -> Vec<f64> {
        self.measured
            .iter()
            .zip(&self.predicted)
            .map(|(measured, predicted)| measured - predicted)
            .collect()
    }
}

impl AxisFit {
    /// Says of every term that the fit as a whole is not to be trusted.
    pub fn distrust(&mut self) {
        for term in &mut self.terms {
            term.doubt = term.doubt.or(Some(ErrorDoubt::WholeFit));
        }
    }

    /// Says of the terms that change with speed that the motion has one speed.
    pub fn distrust_what_changes_with_speed(&mut self) {
        for term in self.terms.iter_mut().filter(|estimate| !estimate.term.is_signed()) {
            term.doubt = term.doubt.or(Some(ErrorDoubt::OneSpeed));
        }
    }

    /// Says of the inertia and the load that other joints move, whose weight, place and acceleration
    /// act on them.
    pub fn distrust_what_other_joints_move(&mut self) {
        let loaded = |term: AxisTerm| term == AxisTerm::Inertia || term.is_signed();
        for term in self.terms.iter_mut().filter(|estimate| loaded(estimate.term)) {
            term.doubt = term.doubt.or(Some(ErrorDoubt::OtherJoints));
        }
    }

    /// Whether there can be such an axis.
    ///
    /// # Errors
    /// [`IdentError::NegativeInertia`] where the inertia is clearly below zero: one that the
    /// recording does not determine may come out on either side.
    pub fn possible(&self) -> Result<(), IdentError> {
        match self.term(AxisTerm::Inertia) {
            Some(TermEstimate { value, standard_error, .. }) if value <= -2.0 * standard_error => {
                Err(IdentError::NegativeInertia { value, standard_error })
            }
            _ => Ok(()),
        }
    }

    /// The friction that comes out below zero by more than its error, where any does: none drives the
    /// axis.
    pub fn impossible(&self) -> Option<AxisTerm> {
        let below = |estimate: &&TermEstimate| {
            let friction = estimate.term != AxisTerm::Inertia && !estimate.term.is_signed();
            friction && estimate.value < -2.0 * estimate.standard_error
        };
        self.terms.iter().find(below).map(|estimate| estimate.term)
    }

    /// The estimate of a term, if the model has it.
    pub fn term(&self, term: AxisTerm) -> Option<TermEstimate> {
        self.terms.iter().copied().find(|estimate| estimate.term == term)
    }

    /// Value of a term, zero where the model does not have it.
    pub fn value(&self, term: AxisTerm) -> f64 {
        self.term(term).map_or(0.0, |estimate| estimate.value)
    }

    /// Applies the fitted model to a recording, the same one or another: the cross-test.
    ///
    /// # Errors
    /// [`IdentError::TooFewSamples`] for a recording too short to decimate,
    /// [`IdentError::ZeroForce`].
    pub fn predict(&self, recording: &Conditioned) -> Result<Prediction, IdentError> {
        let regression = Regression::new(recording, self.model)?;
        let values =
            DVector::from_iterator(self.terms.len(), self.terms.iter().map(|term| term.value));
        let predicted = &regression.matrix * values;
        let mut friction = regression.force.clone();
        for (column, estimate) in self.terms.iter().enumerate() {
            if estimate.term == AxisTerm::Inertia || estimate.term.is_load() {
                friction -= regression.matrix.column(column) * estimate.value;
            }
        }
        let step = recording.decimate as f64 * recording.time_step;
        let start = recording.first as f64 * recording.time_step;
        let residual = (&regression.force - &predicted).norm();
        let rows = |piece: &Piece| 0..piece.kept.len().div_ceil(recording.decimate);
        let time = |piece: &Piece| {
            let begins = piece.start;
            rows(piece).map(move |k| begins + (start + step * k as f64))
        };
        Ok(Prediction {
            time: recording.pieces.iter().flat_map(time).collect(),
            velocity: recording.by_piece(&recording.velocity, |v| {
                Ok(v.iter().copied().step_by(recording.decimate).collect())
            })?,
            relative_error: 100.0 * residual / regression.force.norm(),
            measured: regression.force.as_slice().to_vec(),
            predicted: predicted.as_slice().to_vec(),
            friction: friction.as_slice().to_vec(),
        })
    }
}

/// Fits an axis model to a conditioned recording.
///
/// ```
/// use friction_ident::{AxisModel, AxisTerm, Conditioning, Signals, condition, fit_axis};
///
/// // 3 kg on a rail with 5 N of Coulomb friction, shaken at 1 Hz.
/// let time = (0..3000).map(|i| i as f64 * 1e-3);
/// let (position, force): (Vec<_>, Vec<_>) = time
///     .map(|t| (6.28 * t).sin_cos())
///     .map(|(sin, cos)| (sin, 3.0 * -6.28 * 6.28 * sin + 5.0 * cos.signum()))
///     .unzip();
/// let signals = Signals { time_step: 1e-3, position: Some(&position), readings: None, velocity: None, force: &force };
/// let conditioned = condition(&signals, &Conditioning::for_time_step(1e-3))?;
/// let fit = fit_axis(&conditioned, AxisModel::SYMMETRIC)?;
/// assert!((fit.value(AxisTerm::Inertia) - 3.0).abs() < 0.01);
/// assert!((fit.value(AxisTerm::Coulomb) - 5.0).abs() < 0.05);
/// # Ok::<(), friction_ident::IdentError>(())
/// ```
///
/// # Errors
/// [`IdentError::NotExcited`] with the terms the motion does not show,
/// [`IdentError::NegativeInertia`] where it is clearly below zero, [`IdentError::ZeroForce`],
/// [`IdentError::ConstantForce`], [`IdentError::TooFewSamples`].
pub fn fit_axis(recording: &Conditioned, model: AxisModel) -> Result<AxisFit, IdentError> {
    let fit = fit_axis_freely(recording, model)?;
    fit.possible()?;
    Ok(fit)
}

/// The same without asking whether the inertia can be: for a fit beside others that have more
/// terms, and are what is asked for. [`AxisFit::possible`] asks.
///
/// # Errors
/// As of [`fit_axis`], but for [`IdentError::NegativeInertia`].
pub fn fit_axis_freely(recording: &Conditioned, model: AxisModel) -> Result<AxisFit, IdentError> {
    let terms = model.terms();
    if model.inertia && !accelerates(recording) {
        return Err(IdentError::NotExcited { terms: vec![AxisTerm::Inertia] });
    }
    if let (true, Some(&value)) = (model.inertia, recording.force.first())
        && value != 0.0
        && recording.force.iter().all(|force| *force == value)
    {
        return Err(IdentError::ConstantForce(value));
    }
    let regression = Regression::new(recording, model)?;
    let samples = regression.force.len();
    let needed = 4 * terms.len();
    if samples < needed {
        return Err(IdentError::TooFewSamples {
            what: "the regression, after trimming and decimation,",
            needed,
            found: samples,
            lower: Some("the trim or the decimation"),
        });
    }
    let solution = least_squares::solve(&regression.matrix, &regression.force).map_err(
        |Degenerate { columns }| IdentError::NotExcited {
            terms: columns.into_iter().filter_map(|column| terms.get(column).copied()).collect(),
        },
    )?;
    let squares = solution.residual.norm_squared();
    let variance = squares / (samples - terms.len()) as f64;
    let course = Course { points: 0, pieces: &regression.pieces, motion: &regression.motion };
    let errors = robust_covariance(&regression.matrix, solution.residual.as_slice(), &course);
    let estimate = |(i, term)| {
        let error: Option<&RobustError> =
            errors.as_ref().and_then(|errors| errors.parameters.get(i));
        TermEstimate {
            term,
            value: solution.x[i],
            standard_error: error.map_or(f64::INFINITY, |error| error.standard_error),
            half_width: error.map_or(f64::INFINITY, |error| error.half_width()),
            white_error: (variance * solution.inverse_normal[(i, i)]).sqrt(),
            doubt: error.and_then(|error| error.doubt),
        }
    };
    let terms: Vec<_> = terms.into_iter().enumerate().map(estimate).collect();
    Ok(AxisFit {
        model,
        terms,
        correlation: errors.map_or_else(Vec::new, |errors| errors.correlation()),
        relative_error: 100.0 * squares.sqrt() / regression.force.norm(),
        residual_rms: (squares / samples as f64).sqrt(),
        samples,
    })
}

/// Decimated regressors and force.
struct Regression {
    matrix: DMatrix<f64>,
    force: DVector<f64>,
    /// Rows of each stretch.
    pieces: Vec<usize>,
    /// What the axis does at each row.
    motion: Vec<Vec<f64>>,
}

impl Regression {
    fn new(recording: &Conditioned, model: AxisModel) -> Result<Self, IdentError> {
        if recording.force.iter().all(|&force| force == 0.0) {
            return Err(IdentError::ZeroForce);
        }
        let positions = match (model.load, &recording.position) {
            (Load::None, _) => &[][..],
            (_, Some(position)) => position.as_slice(),
            (_, None) => return Err(IdentError::NoPositionForLoad),
        };
        let sign = |velocity: f64| {
            if velocity.abs() <= recording.velocity_floor { 0.0 } else { velocity.signum() }
        };
        let terms = model.terms();
        let thinned = |column: &[f64]| {
            recording.by_piece(column, |piece| decimate(piece, recording.decimate))
        };
        let force = DVector::from_vec(thinned(&recording.force)?);
        let mut matrix = DMatrix::zeros(force.len(), terms.len());
        for (j, term) in terms.iter().enumerate() {
            let column: Vec<_> = recording
                .acceleration
                .iter()
                .zip(&recording.velocity)
                .enumerate()
                .map(|(k, (&a, &v))| {
                    let position = positions.get(k).copied().unwrap_or(0.0);
                    term.regressor(position, a, v, sign(v))
                })
                .collect();
            matrix.set_column(j, &DVector::from_vec(thinned(&column)?));
        }
        let rows = |piece: &Piece| piece.kept.len().div_ceil(recording.decimate);
        let motion = recording.motion();
        let motion = motion.iter().map(|column| {
            recording.by_piece(column, |piece| {
                Ok(piece.iter().copied().step_by(recording.decimate).collect())
            })
        });
        let motion = motion.collect::<Result<_, _>>()?;
        Ok(Self { matrix, force, pieces: recording.pieces.iter().map(rows).collect(), motion })
    }
}

/// Whether the velocity changes by more than rounding and the low-pass's settling can make of a
/// constant one.
fn accelerates(recording: &Conditioned) -> bool {
    let (slowest, fastest) = recording
        .velocity
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &v| (low.min(v), high.max(v)));
    let changes = fastest - slowest > 1e-4 * fastest.abs().max(slowest.abs());
    changes && root_mean_square(&recording.acceleration) > recording.acceleration_floor
}

mod force_band;
pub mod free_run;
mod load;

pub use force_band::low_pass_of_the_force_helps;
pub use load::{Load, LoadChoice, choose_load};

#[cfg(test)]
mod tests;
