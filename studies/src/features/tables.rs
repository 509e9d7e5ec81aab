//! The figures as tables.

use friction_features::limit_cycle::LimitCycleStudy;
use friction_features::{Breakaway, Evidence, Motion, ZeroCrossing};

use super::ModelFeatures;
use report::figure::Table;

/// Below this share of its swing a contact does not drift with a cycle.
const DRIFT: f64 = 1e-4;
/// Below this share of its height a loop is closed.
const CLOSED: f64 = 1e-6;
/// Below this area \[W\] there is no lag.
const LAG: f64 = 1e-9;

fn number(value: Option<f64>, digits: usize) -> String {
    value.map_or_else(|| "-".to_owned(), |value| format!("{value:.digits$}"))
}

fn micrometres(value: Option<f64>) -> String {
    number(value.map(|value| 1e6 * value), 2)
}

fn scientific(value: Option<f64>) -> String {
    match value {
        None => "-".to_owned(),
        Some(0.0) => "0".to_owned(),
        Some(value) => format!("{value:.2e}"),
    }
}

/// Beyond this change at the last halving a figure scatters: the bristles are drawn at random.
const SETTLED: f64 = 1e-2;
/// A contact that moves on by more than this a cycle slides \[m\].
const SLIDES: f64 = 1e-3;

impl ModelFeatures {
    /// Whether it describes pre-sliding.
    pub(super) fn has_bristles(&self) -> bool {
        self.features.non_local_memory.is_some()
    }

    /// Whether figures with this evidence hold as the step shrinks.
    pub(super) fn settled(&self, evidence: &[Evidence]) -> bool {
        evidence.iter().all(|evidence| evidence.change.is_none_or(|change| change < SETTLED))
    }

    /// Whether the inner loop closes; `None` without pre-sliding.
    pub(super) fn closes(&self) -> Option<bool> {
        self.features.non_local_memory.as_ref().map(|memory| memory.closure_gap.abs() < CLOSED)
    }

    /// The area of its loop of lag at the highest frequency \[W\]; `None` if it has no lag, or one
    /// that scatters.
    pub(super) fn lag(&self) -> Option<f64> {
        let lags = &self.features.test_bed_lag;
        let settled = self.settled(&lags.iter().map(|lag| lag.evidence).collect::<Vec<_>>());
        lags.last().map(|lag| lag.area).filter(|area| settled && area.abs() > LAG)
    }
}

/// One row a model: which features it has.
pub(super) fn overview(models: &[ModelFeatures]) -> Table {
    let rows = models
        .iter()
        .map(|model| {
            let features = &model.features;
            let drift = features.non_drift.drift_per_cycle;
            let memory = match (model.closes(), &features.non_local_memory) {
                (Some(true), _) => "closes".to_owned(),
                (_, Some(memory)) => format!("gap {:.1} %", 100.0 * memory.closure_gap),
                (_, None) => "no pre-sliding".to_owned(),
            };
            let random = !model
                .settled(&features.test_bed_lag.iter().map(|lag| lag.evidence).collect::<Vec<_>>());
            let lag = match model.lag() {
                None if random => "scatters",
                None => "no",
                Some(area) if area < 0.0 => "wrong way round",
                Some(_) => "yes",
            };
            vec![
                features.name.title().to_owned(),
                match features.stick_slip.motion {
                    Motion::StickSlip => "yes",
                    Motion::Vibration => "vibrates",
                    Motion::Smooth => "no",
                }
                .to_owned(),
                if drift.abs() > SLIDES {
                    "slides".to_owned()
                } else if drift.abs() > DRIFT * features.non_drift.swing {
                    format!("{:.1} um a cycle", 1e6 * drift)
                } else {
                    "no".to_owned()
                },
                memory,
                lag.to_owned(),
                number(features.sensitivity.rms_elasticity, 2),
            ]
        })
        .collect();
    Table {
        title: "Which model shows what".to_owned(),
        caption: "Computed, not claimed: each entry stands for an experiment below. Elasticity: root mean square over the model's own parameters of how much \
                  breakaway and lag change with them; 1 is in proportion."
            .to_owned(),
        columns: ["model", "stick-slip", "drift", "inner loop", "frictional lag", "elasticity"].map(str::to_owned).to_vec(),
        rows,
        highlight: None,
    }
}

pub(super) fn stick_slip(models: &[ModelFeatures]) -> Table {
    let rows = models
        .iter()
        .map(|model| {
            let found = &model.features.stick_slip;
            vec![
                model.features.name.title().to_owned(),
                number(found.period, 4),
                number(Some(found.spring_max), 5),
                number(Some(found.spring_min), 5),
                number(Some(found.velocity_max), 5),
                number(Some(found.friction_max), 4),
                evidence(found.evidence.step, found.evidence.change),
            ]
        })
        .collect();
    Table {
        title: "Stick-slip".to_owned(),
        caption: "1 kg on a spring of 2 N/m pulled at 0.1 m/s; after 18 s. Coulomb friction with stiction alone has 7.611259 s in closed form.".to_owned(),
        columns: ["model", "period [s]", "spring max [N]", "spring min [N]", "v max [m/s]", "F max [N]", "step [s], last change"]
            .map(str::to_owned)
            .to_vec(),
        rows,
        highlight: None,
    }
}

fn evidence(step: f64, change: Option<f64>) -> String {
    change.map_or_else(|| format!("{step:.1e}"), |change| format!("{step:.1e}, {change:.0e}"))
}

pub(super) fn memory(models: &[ModelFeatures]) -> Table {
    let rows = models
        .iter()
        .filter_map(|model| {
            let found = model.features.non_local_memory.as_ref()?;
            Some(vec![
                model.features.name.title().to_owned(),
                scientific(Some(found.amplitude)),
                scientific(Some(found.closure_gap)),
                scientific(Some(found.wiping_out_error)),
                scientific(Some(found.congruency_error)),
                scientific(Some(model.features.non_drift.drift_per_cycle)),
                scientific(Some(model.features.non_drift.swing)),
            ])
        })
        .collect();
    Table {
        title: "Memory and drift".to_owned(),
        caption: "Closure gap and congruency over the loop's height; wiping-out error: force after the path with the inner loop minus force after the path \
                  without it."
            .to_owned(),
        columns: [
            "model",
            "first turn [m]",
            "closure gap [-]",
            "wiping-out error [N]",
            "congruency error [-]",
            "drift a cycle [m]",
            "swing [m]",
        ]
        .map(str::to_owned)
        .to_vec(),
        rows,
        highlight: None,
    }
}

pub(super) fn breakaway(models: &[ModelFeatures]) -> Table {
    let each = |found: &[Breakaway], of: fn(&Breakaway) -> Option<f64>| {
        found.iter().map(|b| number(of(b), 5)).collect::<Vec<_>>().join(" / ")
    };
    let rates = models.first().map_or_else(String::new, |model| {
        model.features.breakaway.iter().map(|b| b.rate.to_string()).collect::<Vec<_>>().join(" / ")
    });
    let rows = models
        .iter()
        .map(|model| {
            let found = &model.features.breakaway;
            let middle = found.get(found.len() / 2).and_then(|b| b.displacement);
            vec![
                model.features.name.title().to_owned(),
                each(found, |b| Some(b.friction_max)),
                each(found, |b| b.applied_at_threshold),
                scientific(middle),
            ]
        })
        .collect();
    Table {
        title: "Breakaway against force rate".to_owned(),
        caption: format!(
            "At {rates} N/s. The displacement is that of the largest friction at the middle rate."
        ),
        columns: [
            "model",
            "largest friction [N]",
            "applied force at 1 mm/s [N]",
            "displacement [m]",
        ]
        .map(str::to_owned)
        .to_vec(),
        rows,
        highlight: None,
    }
}

pub(super) fn lag(models: &[ModelFeatures]) -> Table {
    let frequencies: Vec<String> = models.first().map_or_else(Vec::new, |model| {
        model
            .features
            .test_bed_lag
            .iter()
            .map(|lag| format!("{} rad/s [W]", lag.frequency))
            .collect()
    });
    let rows = models
        .iter()
        .filter(|model| model.lag().is_some())
        .map(|model| {
            let mut row = vec![model.features.name.title().to_owned()];
            row.extend(model.features.test_bed_lag.iter().map(|lag| format!("{:.4e}", lag.area)));
            row
        })
        .collect();
    Table {
        title: "Frictional lag: area of the loop".to_owned(),
        caption:
            "Test-bed parameters, velocity 1 - 0.95 cos(wt) rad/s. Models that are not listed have no lag."
                .to_owned(),
        columns: std::iter::once("model".to_owned()).chain(frequencies).collect(),
        rows,
        highlight: None,
    }
}

pub(super) fn reversal(models: &[ModelFeatures]) -> Table {
    let each = |found: &[ZeroCrossing], of: fn(&ZeroCrossing) -> String| {
        found.iter().map(of).collect::<Vec<_>>().join(" / ")
    };
    let accelerations = models.first().map_or_else(String::new, |model| {
        model
            .features
            .zero_crossing
            .iter()
            .map(|z| z.acceleration.to_string())
            .collect::<Vec<_>>()
            .join(" / ")
    });
    let rows = models
        .iter()
        .map(|model| {
            let found = &model.features.zero_crossing;
            let steady = &model.features.steady_state;
            vec![
                model.features.name.title().to_owned(),
                each(found, |z| micrometres(z.displacement_to_zero)),
                each(found, |z| micrometres(z.displacement_to_sliding)),
                each(found, |z| {
                    z.steepest.map_or_else(|| "jump".to_owned(), |rate| format!("{rate:.1}"))
                }),
                scientific(Some(steady.error)),
                scientific(Some(steady.fixed_step_error)),
            ]
        })
        .collect();
    Table {
        title: "Reversal and steady sliding".to_owned(),
        caption: format!(
            "Reversal at {accelerations} m/s^2: displacement from the turn to zero force and to forward sliding, and the steepest change of the force. Steady \
             sliding: largest distance from the model's own curve, derivative form and fixed-step form."
        ),
        columns: [
            "model",
            "to zero force [um]",
            "to sliding [um]",
            "steepest [N/s]",
            "steady error [N]",
            "with fixed steps [N]",
        ]
        .map(str::to_owned)
        .to_vec(),
        rows,
        highlight: None,
    }
}

pub(super) fn sensitivity(models: &[ModelFeatures]) -> Table {
    let mut rows = Vec::new();
    for model in models {
        for parameter in &model.features.sensitivity.parameters {
            let Some(found) = parameter.elasticities else { continue };
            let lag = if parameter.lag_reverses {
                "changes sense".to_owned()
            } else {
                number(found.lag_area, 3)
            };
            rows.push(vec![
                model.features.name.title().to_owned(),
                parameter.parameter.clone(),
                number(found.breakaway_force, 4),
                number(found.breakaway_displacement, 3),
                lag,
            ]);
        }
    }
    Table {
        title: "Sensitivity: elasticities".to_owned(),
        caption: "d ln y / d ln p between half and twice each parameter, chapter 3 set. The shares alpha and lambda are scaled through the levels, since they sum to \
                  one. A parameter whose double or half is not valid (F_c above F_s) is left out."
            .to_owned(),
        columns: ["model", "parameter", "breakaway force", "breakaway displacement", "lag area"].map(str::to_owned).to_vec(),
        rows,
        highlight: None,
    }
}

pub(super) fn limit_cycle(study: &LimitCycleStudy) -> Table {
    let cycles = |cycles: &[friction_features::limit_cycle::Intersection]| match cycles {
        [] => "none".to_owned(),
        some => some
            .iter()
            .map(|c| {
                let kind = if c.stable { "stable" } else { "unstable" };
                format!(
                    "A {:.4} m, w {:.4} rad/s, period {:.2} s ({kind})",
                    c.amplitude,
                    c.angular_frequency,
                    std::f64::consts::TAU / c.angular_frequency
                )
            })
            .collect::<Vec<_>>()
            .join("; "),
    };
    let simulated = study.simulated.cycle.map_or_else(
        || "rests".to_owned(),
        |c| {
            format!(
                "A {:.5} m, w {:.5} rad/s, period {:.3} s",
                c.amplitude, c.angular_frequency, c.period
            )
        },
    );
    let row = |a: &str, b: String| vec![a.to_owned(), b];
    Table {
        title: "Limit cycle of the position loop".to_owned(),
        caption: "m x'' = -6 x' - 3 x - 4 int(x - 1) - F, F_s = 1 N, F_c = 0.6 N. Hunting is not a cycle that a describing function can predict: the mass rests for most of the \
                  period, and no sine does."
            .to_owned(),
        columns: vec!["how".to_owned(), "limit cycle".to_owned()],
        rows: vec![
            row("simulated", simulated),
            row("describing function of the model", cycles(&study.predicted.cycles)),
            row("describing function as printed (3.63), wrong", cycles(&study.predicted_as_printed.cycles)),
            row("printed in the thesis, not reproducible", "A 0.0787 m, w 2.35 rad/s; simulated A 0.0930 m, w 0.3927 rad/s".to_owned()),
        ],
        highlight: Some(0),
    }
}
