//! All features of one model, and its figures in one list.

use friction_model::{AnyModel, ModelName};
use serde::{Deserialize, Serialize};

use crate::{
    Breakaway, BreakawaySettings, Contact, Evidence, FrictionalLag, FrictionalLagSettings,
    NonDrift, NonDriftSettings, NonLocalMemory, NonLocalMemorySettings, Sensitivity,
    SensitivitySettings, SteadyState, SteadyStateSettings, StickSlip, StickSlipSettings,
    ZeroCrossing, ZeroCrossingSettings, breakaway, frictional_lag, non_drift, non_local_memory,
    sensitivity, steady_state, stick_slip, zero_crossing,
};

/// The experiments of a whole set.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct FeatureSettings {
    /// Stick-slip.
    pub stick_slip: StickSlipSettings,
    /// Drift.
    pub non_drift: NonDriftSettings,
    /// Memory; the amplitudes of [`NonLocalMemorySettings::chapter_3`] if left out and the model
    /// has the parameters of chapter 3.
    pub non_local_memory: Option<NonLocalMemorySettings>,
    /// Breakaway.
    pub breakaway: BreakawaySettings,
    /// Frictional lag with the parameters of chapter 3; [`FrictionalLagSettings::chapter_3`] if
    /// left out.
    pub frictional_lag: Option<FrictionalLagSettings>,
    /// Frictional lag with the parameters of the test bed.
    pub test_bed_lag: FrictionalLagSettings,
    /// Steady sliding.
    pub steady_state: SteadyStateSettings,
    /// Reversal.
    pub zero_crossing: ZeroCrossingSettings,
    /// Sensitivity.
    pub sensitivity: SensitivitySettings,
}

/// Everything that tells one model from the others. All with one set of parameters, for the
/// thesis's comparison those of chapter 3, but for the frictional lag, which is also measured with
/// a second one, those of the test bed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Features {
    /// The model.
    pub name: ModelName,
    /// Stick-slip.
    pub stick_slip: StickSlip,
    /// Drift.
    pub non_drift: NonDrift,
    /// Memory; `None` for models without pre-sliding.
    pub non_local_memory: Option<NonLocalMemory>,
    /// Breakaway at each force rate.
    pub breakaway: Vec<Breakaway>,
    /// Frictional lag at each frequency.
    pub frictional_lag: Vec<FrictionalLag>,
    /// Frictional lag at each frequency with the second set of parameters.
    pub test_bed_lag: Vec<FrictionalLag>,
    /// Steady sliding.
    pub steady_state: SteadyState,
    /// Reversal at each acceleration.
    pub zero_crossing: Vec<ZeroCrossing>,
    /// Sensitivity.
    pub sensitivity: Sensitivity,
}

/// All features of the model `chapter_3`, with those of the test bed from `test_bed`. Takes up to
/// some seconds for stiff models; to show progress, call the experiments one by one.
#[must_use]
pub fn features(chapter_3: &AnyModel, test_bed: &AnyModel, settings: &FeatureSettings) -> Features {
    let contact = Contact::new(chapter_3);
    let name = chapter_3.name();
    let memory = settings.non_local_memory.unwrap_or_else(|| {
        let preset = *chapter_3 == AnyModel::chapter_3(name);
        if preset {
            NonLocalMemorySettings::chapter_3(name)
        } else {
            NonLocalMemorySettings::default()
        }
    });
    let lag = settings.frictional_lag.clone().unwrap_or_else(FrictionalLagSettings::chapter_3);
    Features {
        name,
        stick_slip: stick_slip(&contact, &settings.stick_slip),
        non_drift: non_drift(&contact, &settings.non_drift),
        non_local_memory: non_local_memory(&contact, &memory),
        breakaway: breakaway(&contact, &settings.breakaway),
        frictional_lag: frictional_lag(&contact, &lag),
        test_bed_lag: frictional_lag(&Contact::new(test_bed), &settings.test_bed_lag),
        steady_state: steady_state(&contact, &settings.steady_state),
        zero_crossing: zero_crossing(&contact, &settings.zero_crossing),
        sensitivity: sensitivity(chapter_3, &settings.sensitivity),
    }
}

/// One number of a model's features.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FeatureFigure {
    /// What it is, for instance `breakaway[0.1].displacement`.
    pub figure: String,
    /// The number in SI units; `None` where the model has none.
    pub value: Option<f64>,
    /// How well it is known; `None` for figures that are not integrated with a single step.
    pub evidence: Option<Evidence>,
}

impl Features {
    /// The numbers without the curves.
    #[must_use]
    pub fn figures(&self) -> Vec<FeatureFigure> {
        let mut list = List(Vec::new());
        let StickSlip { evidence, .. } = self.stick_slip;
        list.some(
            "stick_slip",
            evidence,
            &[
                ("period", self.stick_slip.period),
                ("share_of_rest", self.stick_slip.share_of_rest),
                ("spring_max", Some(self.stick_slip.spring_max)),
                ("spring_min", Some(self.stick_slip.spring_min)),
                ("velocity_max", Some(self.stick_slip.velocity_max)),
                ("friction_max", Some(self.stick_slip.friction_max)),
            ],
        );
        let NonDrift { drift, drift_per_cycle, swing, evidence, .. } = self.non_drift;
        list.some(
            "non_drift",
            evidence,
            &[
                ("drift", Some(drift)),
                ("drift_per_cycle", Some(drift_per_cycle)),
                ("swing", Some(swing)),
            ],
        );
        if let Some(memory) = &self.non_local_memory {
            list.some(
                "non_local_memory",
                memory.evidence,
                &[
                    ("amplitude", Some(memory.amplitude)),
                    ("loop_height", Some(memory.loop_height)),
                    ("loop_work", Some(memory.loop_work)),
                    ("loop_opening", Some(memory.loop_opening)),
                    ("closure_gap", Some(memory.closure_gap)),
                    ("wiping_out_error", Some(memory.wiping_out_error)),
                    ("congruency_error", Some(memory.congruency_error)),
                ],
            );
        }
        for Breakaway {
            rate, friction_max, displacement, applied_at_threshold, evidence, ..
        } in &self.breakaway
        {
            list.some(
                &format!("breakaway[{rate}]"),
                *evidence,
                &[
                    ("friction_max", Some(*friction_max)),
                    ("displacement", *displacement),
                    ("applied_at_threshold", *applied_at_threshold),
                ],
            );
        }
        for (kind, lags) in
            [("frictional_lag", &self.frictional_lag), ("test_bed_lag", &self.test_bed_lag)]
        {
            for FrictionalLag { frequency, area, widest, narrowest, evidence, .. } in lags {
                list.some(
                    &format!("{kind}[{frequency}]"),
                    *evidence,
                    &[
                        ("area", Some(*area)),
                        ("widest", Some(*widest)),
                        ("narrowest", Some(*narrowest)),
                    ],
                );
            }
        }
        list.add("steady_state.error".into(), Some(self.steady_state.error), None);
        list.add(
            "steady_state.fixed_step_error".into(),
            Some(self.steady_state.fixed_step_error),
            None,
        );
        for zero in &self.zero_crossing {
            list.some(
                &format!("zero_crossing[{}]", zero.acceleration),
                zero.evidence,
                &[
                    ("friction_at_turn", Some(zero.friction_at_turn)),
                    ("displacement_to_zero", zero.displacement_to_zero),
                    ("displacement_to_sliding", zero.displacement_to_sliding),
                    ("time_to_sliding", zero.time_to_sliding),
                    ("friction_max", Some(zero.friction_max)),
                    ("steepest", zero.steepest),
                ],
            );
        }
        list.add("sensitivity.rms_elasticity".into(), self.sensitivity.rms_elasticity, None);
        for parameter in &self.sensitivity.parameters {
            let Some(elasticities) = parameter.elasticities else { continue };
            for (answer, value) in [
                ("breakaway_force", elasticities.breakaway_force),
                ("breakaway_displacement", elasticities.breakaway_displacement),
                ("lag_area", elasticities.lag_area),
            ] {
                list.add(format!("sensitivity[{}].{answer}", parameter.parameter), value, None);
            }
        }
        list.0
    }
}

struct List(Vec<FeatureFigure>);

impl List {
    fn add(&mut self, figure: String, value: Option<f64>, evidence: Option<Evidence>) {
        self.0.push(FeatureFigure { figure, value, evidence });
    }

    fn some(&mut self, feature: &str, evidence: Evidence, figures: &[(&str, Option<f64>)]) {
        for (name, value) in figures {
            self.add(format!("{feature}.{name}"), *value, Some(evidence));
        }
    }
}
