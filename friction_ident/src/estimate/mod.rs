//! An estimated parameter: its value, how sure it is, and whether the data say anything about it at
//! all.
//!
//! Every fit of this crate that estimates named parameters ends in [`Estimates`]. A parameter that
//! the data do not determine carries a [`Doubt`] and what to measure instead; its number is then a
//! placeholder that is safe to compute with.

mod linearised;
mod reach;
mod robust;
mod verdict;

use serde::Serialize;

use crate::axis_term::AxisTerm;
use crate::bounded::Minimum;
use crate::parameter_id::ParameterId;
use crate::robust_covariance::ErrorDoubt;
pub(crate) use linearised::NormalEquations;
pub(crate) use robust::robust_errors;
pub(crate) use verdict::of_its_value;
pub use verdict::{Doubt, Interval, IntervalMethod, Verdict};

/// One parameter.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Estimate {
    /// Which parameter; in documents its text, under `name`.
    #[serde(rename = "name")]
    pub id: ParameterId,
    /// Unit.
    pub unit: &'static str,
    /// Best value; where it is not identifiable, one that is safe to compute with.
    pub value: f64,
    /// Standard error; none where a bound holds it or where it was not estimated.
    pub standard_error: Option<f64>,
    /// 95 % interval.
    pub interval: Option<Interval>,
    /// Whether the data determine it.
    #[serde(flatten)]
    pub verdict: Verdict,
}

impl Estimate {
    /// A value that was not estimated here.
    pub fn given(
        id: impl Into<ParameterId>,
        unit: &'static str,
        value: f64,
        source: &'static str,
    ) -> Self {
        let verdict = Verdict::Given { source };
        Self { id: id.into(), unit, value, standard_error: None, interval: None, verdict }
    }

    /// Whether the data determine it.
    pub fn is_identified(&self) -> bool {
        self.verdict == Verdict::Identified
    }
}

/// What an unknown of a fit is called and what helps where it stays unknown.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unknown {
    /// Which parameter.
    pub id: ParameterId,
    /// Unit.
    pub unit: &'static str,
    /// What to measure where this data does not determine it.
    pub remedy: &'static str,
}

/// Parameters estimated together.
#[derive(Debug, Clone, PartialEq, Serialize, Default)]
pub struct Estimates {
    /// One a parameter.
    pub parameters: Vec<Estimate>,
    /// Correlations, in the order of the parameters; zero beside one that was not free.
    pub correlation: Vec<Vec<f64>>,
    /// Covariance, likewise.
    pub covariance: Vec<Vec<f64>>,
    /// Standard deviation of the residuals, degrees of freedom taken into account.
    pub residual_deviation: f64,
    /// Residuals minus free parameters.
    pub degrees_of_freedom: usize,
}

impl Estimates {
    /// From a minimum of least squares, linearised: covariance `s^2 (J^T J)^-1` of the unknowns
    /// that no bound holds. `share` is the share of the residuals that count as independent: 1 for
    /// white ones, else [`effective_share`](crate::residual_whiteness::effective_share).
    pub fn linearised(minimum: &Minimum, unknowns: &[Unknown], share: f64) -> Self {
        let matrix = minimum.jacobian.tr_mul(&minimum.jacobian);
        let normal = NormalEquations {
            x: &minimum.x,
            held: &minimum.held,
            matrix: matrix.as_slice().to_vec(),
            sum: minimum.sum,
            residuals: minimum.residuals.len(),
        };
        normal.estimates(unknowns, share)
    }

    /// The place of a parameter among the rows of correlation and covariance.
    pub fn place(&self, id: impl Into<ParameterId>) -> Option<usize> {
        let id = id.into();
        self.parameters.iter().position(|estimate| estimate.id == id)
    }

    /// The estimate of a parameter.
    pub fn get(&self, id: impl Into<ParameterId>) -> Option<&Estimate> {
        self.parameters.get(self.place(id)?)
    }

    /// The same, to be changed.
    pub fn get_mut(&mut self, id: impl Into<ParameterId>) -> Option<&mut Estimate> {
        let place = self.place(id)?;
        self.parameters.get_mut(place)
    }

    /// Takes the verdict `identified` from all of them: the fit as a whole is not to be trusted.
    pub fn distrust(&mut self) {
        self.distrust_but(|_| false, &ErrorDoubt::WholeFit.to_string(), "what the warnings name");
    }

    /// Says of those that change with speed that the motion has one speed: what goes with the
    /// position, or is constant, stays as it is.
    pub fn distrust_what_changes_with_speed(&mut self) {
        let steady = |id: ParameterId| {
            AxisTerm::SIGNED.iter().any(|term| term.name() == id.name)
                || id.name.starts_with("harmonic")
        };
        let why = ErrorDoubt::OneSpeed.to_string();
        self.distrust_but(steady, &why, "motion at several speeds");
    }

    /// Says of all but friction that other joints move: their weight, their place and their
    /// acceleration act on the inertia and on the load.
    pub fn distrust_what_other_joints_move(&mut self) {
        let friction = |id: ParameterId| {
            let of_load = AxisTerm::SIGNED.iter().any(|term| term.name() == id.name);
            id.name != AxisTerm::Inertia.name() && !of_load
        };
        let why = ErrorDoubt::OtherJoints.to_string();
        self.distrust_but(friction, &why, "motion of this joint alone, the others held");
    }

    /// Says of those that are identified, but for some, that their numbers are not to be trusted.
    pub(crate) fn distrust_but(
        &mut self,
        kept: impl Fn(ParameterId) -> bool,
        why: &str,
        remedy: &'static str,
    ) {
        for estimate in &mut self.parameters {
            if estimate.is_identified() && !kept(estimate.id) {
                let doubt = Doubt::NotToBeTrusted { why: why.to_owned() };
                estimate.verdict = Verdict::NotIdentifiable { doubt, remedy };
            }
        }
    }

    /// The value of a parameter.
    pub fn value(&self, id: impl Into<ParameterId>) -> Option<f64> {
        self.get(id).map(|estimate| estimate.value)
    }
}
