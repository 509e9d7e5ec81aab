//! A structure fitted to a recording: parameters, intervals and how well they explain it.

use nalgebra::DVector;
use serde::Serialize;

use super::left_out::Whole;
use super::naming::{AxisUnits, unknowns};
use super::profile;
use super::regressors::Regressors;
use super::search::{Best, Search};
use super::shape::{Late, PositionScale, Shape, ShapeTerm};
use super::{AxisStructure, CrossValidation, alike, at_bound, doubts, stability};
use crate::IdentError;
use crate::adequacy::FitDoubt;
use crate::conditioning::Conditioned;
use crate::estimate::robust_errors;
use crate::estimate::{Doubt, Estimate, Estimates, Verdict};
use crate::parameter_id::{ParameterId, Side};
use crate::residual_whiteness::effective_share;
use crate::rigid_axis::Prediction;
use crate::robust_covariance::Course;

/// Standard errors below zero from which an inertia or friction is clearly negative.
const CLEARLY: f64 = 2.0;

/// Share of a period by which it may differ between parts and still be that of one wave: without
/// noise its interval is narrower than the rounding of the recording.
const SAME_WAVE: f64 = 1e-3;

/// A structure fitted to a recording.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StructureFit {
    /// Which terms it has.
    pub structure: AxisStructure,
    /// The parameters with the errors of [`robust_covariance`](crate::robust_covariance); the
    /// intervals of the nonlinear ones are those of the profile, as wide as these errors ask.
    pub estimates: Estimates,
    /// The nonlinear parameters.
    pub shape: Shape,
    /// How positions are scaled in the polynomials.
    pub position_scale: PositionScale,
    /// `100 |residual| / |force|` \[%\].
    pub relative_error: f64,
    /// Root mean square of the residual \[N or N m\].
    pub residual_rms: f64,
    /// Decimated samples that were fitted.
    pub samples: usize,
    /// Share of the residual's samples that count as independent.
    pub effective_share: f64,
    /// What the sliding alone says of parameters whose own interval does not hold that, and the
    /// `delay` below zero \[s\] by which the force comes late there, also where the structure has
    /// none; nothing before [`heed`](Self::heed).
    pub sliding: Vec<(ParameterId, f64)>,
    /// The same of a fit whose viscous friction need not be a straight line, where the recording
    /// says clearly that it is none.
    pub curved: Vec<(ParameterId, f64)>,
    linear: Vec<f64>,
}

impl StructureFit {
    /// Applies the fit to a recording, the same one or another: the cross-test. Where a bristle was
    /// when a stretch began is taken from that recording.
    ///
    /// # Errors
    /// [`IdentError`] for a recording too short to decimate, without force, or without the position
    /// that the structure needs.
    pub fn predict(&self, recording: &Conditioned) -> Result<Prediction, IdentError> {
        let mut regressors = Regressors::new(recording, self.structure, self.position_scale)?;
        let matrix = regressors.matrix(&self.shape)?;
        let mut predicted = &matrix * DVector::from_column_slice(&self.linear);
        let mut error = &regressors.force - &predicted;
        regressors.starts(&self.shape, None)?.leave_out(error.as_mut_slice());
        predicted.copy_from(&(&regressors.force - &error));
        let friction = &regressors.force - matrix.column(0) * self.linear[0];
        let residual = error.norm();
        Ok(Prediction {
            time: regressors.rows.time(),
            velocity: regressors.velocity(&self.shape),
            measured: regressors.force.as_slice().to_vec(),
            predicted: predicted.as_slice().to_vec(),
            friction: friction.as_slice().to_vec(),
            relative_error: 100.0 * residual / regressors.force.norm(),
        })
    }

    /// The friction that comes out below zero by more than its error, where any does: none drives
    /// the axis.
    pub fn impossible(&self) -> Option<FitDoubt> {
        let below = |estimate: &&Estimate| {
            let error = estimate.standard_error.unwrap_or(f64::INFINITY);
            doubts::STEADY.contains(&estimate.id.name) && estimate.value < -CLEARLY * error
        };
        let estimate = self.estimates.parameters.iter().find(below)?;
        Some(FitDoubt::Impossible { id: estimate.id })
    }

    /// The periods \[m or rad\] that parts of the recording ask for, where they are not one and the
    /// same wave.
    pub fn other_waves(&self) -> Option<(f64, f64)> {
        match self.estimates.get("period")?.verdict {
            Verdict::NotIdentifiable { doubt: Doubt::Unsteady { low, high }, .. }
                if high > (1.0 + SAME_WAVE) * low =>
            {
                Some((low, high))
            }
            _ => None,
        }
    }

    /// What must be known to read the parameters right.
    pub fn notes(&self) -> Vec<String> {
        let mut notes = Vec::new();
        for side in [Side::Both, Side::Forward, Side::Backward] {
            let [f_s, f_c] = ["f_s", "f_c"].map(|name| ParameterId::new(name).side(side));
            let Some((effect, error)) = doubts::difference(&self.estimates, f_s, f_c) else {
                continue;
            };
            if effect < -2.0 * error {
                notes.push(format!(
                    "{f_s} lies below {f_c}: friction rises over the first speeds instead of falling. That is no Stribeck dip; it describes how \
                     friction builds up around a reversal. Pre-sliding and a rising curve cannot be told apart without slow steady motion."
                ));
            }
        }
        let unsteady = |estimate: &&Estimate| {
            matches!(
                estimate.verdict,
                Verdict::NotIdentifiable { doubt: Doubt::Unsteady { .. }, .. }
            )
        };
        let unsteady = self.estimates.parameters.iter().filter(unsteady);
        let names: Vec<String> = unsteady.map(|estimate| estimate.id.to_string()).collect();
        if !names.is_empty() {
            notes.push(format!(
                "Not the same in all parts of the recording, and so not identified: {}. The structure describes this recording there, not the axis.",
                names.join(", ")
            ));
        }
        if self.structure.delay {
            notes.push(
                "The delay is that of the force against the motion: an input that is held over a sample contributes half a sample, and a \
                 delay of the force cannot be told from a lead of the position. Below zero, the force was recorded late."
                    .to_owned(),
            );
        }
        if self.structure.delay && self.shape.delay < 0.0 && self.shape.late == Late::LowPassed {
            notes.push(format!(
                "The force was recorded behind a low-pass of the first order, as drives have for their current or torque: {:.3} ms is its time \
                 constant (`delay`, below zero), {:.3} Hz its cutoff. Friction is that before the low-pass.",
                -1e3 * self.shape.delay,
                -0.5 * std::f64::consts::FRAC_1_PI / self.shape.delay
            ));
        }
        notes
    }

    /// Steady friction at a velocity \[N or N m\], the offset included; at the middle of the axis,
    /// without the harmonic.
    pub fn steady_friction(&self, velocity: f64) -> f64 {
        let side = Side::of_velocity(velocity);
        let value = |name: &'static str| {
            let estimates = &self.estimates;
            estimates
                .value(ParameterId::new(name).side(side))
                .or_else(|| estimates.value(name))
                .unwrap_or(0.0)
        };
        let near = if self.structure.stribeck {
            (-(velocity / self.shape.v_s).powi(2)).exp()
        } else {
            0.0
        };
        let level = value("f_c") * (1.0 - near) + value("f_s") * near;
        let direction = if velocity.is_sign_negative() { -1.0 } else { 1.0 };
        direction * level + value("f_v") * velocity + value("offset")
    }
}

/// Fits `structure` to the whole recording.
///
/// The delay, the Stribeck velocity, the bristle's displacement and the period are searched within
/// bounds that the recording sets (delay up to ten samples, either way where that explains clearly
/// more; Stribeck velocity up to half of the largest speed, beyond which the curve cannot be
/// told from viscous friction; displacement up to a tenth of the travel; period from a 200th to twice
/// the travel).
///
/// # Errors
/// [`IdentError::Columns`] where the recording cannot tell terms apart,
/// [`IdentError::NegativeInertia`], [`IdentError::ZeroForce`], [`IdentError::TooFewSamples`],
/// [`IdentError::NoPosition`].
pub fn fit_structure(
    recording: &Conditioned,
    structure: AxisStructure,
    units: &AxisUnits,
) -> Result<StructureFit, IdentError> {
    let scale = PositionScale::of(recording);
    let mut search = Search::new(recording, structure, scale)?;
    let best = search.least(scale)?;
    fitted(search, best, scale, units)
}

/// Fits the structure that was cross-validated on `recording`: the search begins where that of the
/// cross-validation ended, so that what was found to predict is what is fitted, and not another
/// minimum.
///
/// # Errors
/// Those of [`fit_structure`].
pub fn fit_validated(
    recording: &Conditioned,
    score: &CrossValidation,
    units: &AxisUnits,
) -> Result<StructureFit, IdentError> {
    let scale = PositionScale::of(recording);
    let mut search = Search::resumed(recording, score.structure, scale, &score.shape)?;
    let best = search.from(score.shape, &[])?;
    fitted(search, best, scale, units)
}

/// The parameters with their errors, as far as the problem is straight.
pub(super) struct Errors {
    pub estimates: Estimates,
    /// How far the sum of squares may rise within the interval of each parameter.
    rises: Vec<f64>,
    /// Share of the residual's samples that count as independent.
    share: f64,
}

/// What the least sum of squares and the slopes there say of the parameters.
pub(super) fn errors(
    search: &mut Search,
    best: &Best,
    units: &AxisUnits,
) -> Result<Errors, IdentError> {
    let structure = search.structure;
    let names = unknowns(&structure, units);
    let share = effective_share(best.solution.residual.as_slice());
    let minimum = search.linearise(best, &ShapeTerm::of(&structure))?;
    let mut estimates = Estimates::linearised(&minimum, &names, share);
    let motion = search.regressors.motion(&best.shape);
    let course = Course { points: 0, pieces: &search.regressors.rows.pieces(), motion: &motion };
    let rises = robust_errors(&minimum, &course, &mut estimates);
    Ok(Errors { estimates, rises, share })
}

/// The fit at the least sum of squares, judged.
fn fitted(
    mut search: Search,
    best: Best,
    scale: PositionScale,
    units: &AxisUnits,
) -> Result<StructureFit, IdentError> {
    search.settled(&best)?;
    search.possible(&best)?;
    let structure = search.structure;
    let Best { solution, .. } = &best;
    let terms = ShapeTerm::of(&structure);
    let samples = solution.residual.len();
    let Errors { mut estimates, rises, share } = errors(&mut search, &best, units)?;
    let whole = Whole::of(&mut search, &best)?;
    profile::intervals(&mut search, &best, &whole, &rises, &mut estimates);
    doubts::judge(&structure, &mut estimates);
    stability::judge(&mut search, &best, &whole, &mut estimates);
    let left = (solution.residual.norm_squared() / samples as f64).sqrt();
    doubts::sampled(search.regressors.recording, &mut estimates);
    alike::judge(search.regressors.recording, &structure, units, scale, left, &mut estimates);
    at_bound::distrust(&terms, &search.limits, &best.shape, &mut estimates);
    doubts::of_a_wave(&mut estimates);
    if let Some(inertia) = estimates.parameters.first() {
        // One that the recording does not determine may come out on either side.
        let standard_error = inertia.standard_error.unwrap_or(0.0);
        if inertia.value <= -CLEARLY * standard_error {
            return Err(IdentError::NegativeInertia { value: inertia.value, standard_error });
        }
    }
    let squares = solution.residual.norm_squared();
    Ok(StructureFit {
        structure,
        estimates,
        shape: best.shape,
        position_scale: scale,
        relative_error: 100.0 * squares.sqrt() / search.regressors.force.norm(),
        residual_rms: left,
        samples,
        effective_share: share,
        sliding: Vec::new(),
        curved: Vec::new(),
        linear: solution.x.as_slice().to_vec(),
    })
}
