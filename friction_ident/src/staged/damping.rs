//! The micro-damping: computed from the inertia and a damping ratio, or estimated.
//!
//! A damping ratio is chosen, not measured, and what is computed from it takes the stiffness along
//! where it is wrong. So the computed damping counts only until recordings contradict it: where the
//! joint refinement with the damping free determines it, above zero and elsewhere than it was
//! computed, that refinement is the result.

use friction_model::AnyModel;

use super::decided::Damping;
use super::stage::{DAMPING, LAG, PRE_SLIDING, STATIC};
use super::viscosity::with_some_viscosity;
use super::work::{Watch, Work};
use super::{Stage, StageResult};
use crate::IdentError;
use crate::damped_model::with_computed_damping;
use crate::estimate::Estimates;
use crate::free_parameters::FreeParameters;
use crate::output_error::{Measured, OutputErrorFit};

impl Work<'_> {
    /// `sigma = 2 zeta sqrt(J k) - f_v`, of each element its own.
    pub fn micro_damping(&mut self, model: AnyModel) -> Result<AnyModel, IdentError> {
        let Some(inertia) = self.options.inertia else { return Ok(model) };
        let free = FreeParameters::new(&model, |row| DAMPING.contains(&row.name));
        if free.ids().is_empty() {
            return Ok(model);
        }
        let rotary = self.options.output_error.rotary;
        let (model, estimates) =
            with_computed_damping(&model, inertia, self.options.damping_ratio, rotary)?;
        self.stages.push(StageResult {
            stage: Stage::MicroDamping,
            samples: 0,
            rms: 0.0,
            estimates,
            left: None,
        });
        Ok(model)
    }

    /// Where the joint refinement is to have it from.
    pub fn damping(&self) -> Damping {
        if self.computed().is_some() { Damping::Either } else { Damping::Estimated }
    }

    fn computed(&self) -> Option<&Estimates> {
        let stage = self.stages.iter().find(|stage| stage.stage == Stage::MicroDamping)?;
        Some(&stage.estimates)
    }

    /// All parameters together, the micro-damping among them where that is asked for.
    pub(super) fn refine(
        &mut self,
        model: &AnyModel,
        damping: bool,
        measured: &Measured,
        watch: Watch,
    ) -> Result<OutputErrorFit, IdentError> {
        let shown = |name: &str| {
            STATIC.contains(&name)
                || PRE_SLIDING.contains(&name)
                || LAG.contains(&name)
                || (damping && DAMPING.contains(&name))
        };
        let free =
            FreeParameters::new(&with_some_viscosity(model, measured), |row| shown(row.name));
        self.fit(Stage::Joint, &free, measured, watch)
    }

    /// With the computed micro-damping, then with it free from there.
    pub(super) fn refine_either(
        &mut self,
        model: &AnyModel,
        measured: &Measured,
        watch: Watch,
    ) -> Result<OutputErrorFit, IdentError> {
        let by_computed = self.refine(model, false, measured, watch)?;
        if self.stopped {
            return Ok(by_computed);
        }
        let before = (self.load, self.converged);
        // What is too little for one more parameter is no reason to refuse what there is.
        let by_recordings = self.refine(&by_computed.model, true, measured, watch).ok();
        let told = by_recordings.and_then(|fit| Some((contradicts(&fit, self.computed()?)?, fit)));
        let Some((told, by_recordings)) = told.filter(|_| !self.stopped) else {
            (self.load, self.converged) = before;
            return Ok(by_computed);
        };
        self.stages.retain(|stage| stage.stage != Stage::MicroDamping);
        self.notes.push(format!(
            "The micro-damping is estimated: the recordings determine it, and not where the inertia and a damping ratio of {} put it \
             ({told}).",
            self.options.damping_ratio
        ));
        Ok(by_recordings)
    }
}

/// What was computed and what was estimated, where every micro-damping is determined above zero and
/// one of them is another than was computed.
fn contradicts(fit: &OutputErrorFit, computed: &Estimates) -> Option<String> {
    let mut others = Vec::new();
    for expected in &computed.parameters {
        let estimate = fit.estimates.get(expected.id)?;
        let interval = estimate.interval.filter(|_| estimate.is_identified())?;
        if interval.low <= 0.0 {
            return None;
        }
        if !interval.contains(expected.value) {
            others.push(format!(
                "{} is {:.3e}, and {:.3e} was computed",
                expected.id, estimate.value, expected.value
            ));
        }
    }
    (!others.is_empty()).then(|| others.join("; "))
}
