//! One picture a feature, all models in it.

use friction_features::limit_cycle::LimitCycleStudy;
use friction_model::AnyModel;

use super::ModelFeatures;
use report::figure::{Figure, LineStyle, Panel, Trace};

/// Models without pre-sliding are drawn above, those with bristles below.
fn panels(
    models: &[ModelFeatures],
    y_label: &str,
    trace: impl Fn(&ModelFeatures) -> Option<(Vec<f64>, Vec<f64>)>,
) -> Vec<Panel> {
    let panel = |bristles: bool, title: &str| {
        let traces: Vec<Trace> = models
            .iter()
            .filter(|model| model.has_bristles() == bristles)
            .filter_map(|model| trace(model).map(|(x, y)| of_model(model, x, y)))
            .collect();
        Panel { y_label: format!("{title}: {y_label}"), traces }
    };
    [panel(false, "static"), panel(true, "dynamic")]
        .into_iter()
        .filter(|panel| !panel.traces.is_empty())
        .collect()
}

fn line(name: &str, x: Vec<f64>, y: Vec<f64>) -> Trace {
    Trace::Line { name: name.to_owned(), x, y, style: LineStyle::Solid }
}

/// A line of one of many models.
fn of_model(model: &ModelFeatures, x: Vec<f64>, y: Vec<f64>) -> Trace {
    line(model.features.name.title(), x, y)
}

/// A loop of one of many models.
fn loop_of(model: &ModelFeatures, x: Vec<f64>, y: Vec<f64>) -> Trace {
    Trace::Loop { name: model.features.name.title().to_owned(), x, y }
}

fn scaled(values: &[f64], factor: f64) -> Vec<f64> {
    values.iter().map(|value| value * factor).collect()
}

pub(super) fn stick_slip(models: &[ModelFeatures]) -> Figure {
    Figure {
        title: "Stick-slip: force of the spring that pulls the mass".to_owned(),
        caption: "Rising flanks: the mass sticks and the spring is stretched at 0.1 m/s. Falls: it jumps ahead. A level line: it follows smoothly."
            .to_owned(),
        x_label: "time [s]".to_owned(),
        log_x: false,
        panels: panels(models, "force [N]", |model| {
            let course = &model.features.stick_slip.course;
            Some((course.time.clone(), course.spring.clone()))
        }),
    }
}

pub(super) fn drift(models: &[ModelFeatures]) -> Figure {
    Figure {
        title: "Drift under a load that oscillates below breakaway".to_owned(),
        caption: "Position since the oscillation began, 0.2 to 0.6 N, in units of its own swing in the last cycle. A contact that does not drift comes back every time; damped \
                  bristles creep for the first cycles; one that moves on by a swing with every cycle just slides."
            .to_owned(),
        x_label: "time [s]".to_owned(),
        log_x: false,
        panels: panels(models, "swings [-]", |model| {
            let found = &model.features.non_drift;
            // A rigid contact has no swing: it stays at zero.
            let unit = if found.swing > 0.0 { 1.0 / found.swing } else { 0.0 };
            Some((found.course.time.clone(), scaled(&found.course.position, unit)))
        }),
    }
}

pub(super) fn memory(models: &[ModelFeatures]) -> Figure {
    let panel = |closes: bool, title: &str| Panel {
        y_label: format!("{title}: force [-]"),
        traces: models
            .iter()
            .filter(|model| model.closes() == Some(closes))
            .filter_map(|model| {
                let found = model.features.non_local_memory.as_ref()?;
                let x = scaled(&found.course.displacement, 1.0 / found.amplitude);
                let y = scaled(&found.course.friction, 1.0 / found.tips[0]);
                Some(loop_of(model, x, y))
            })
            .collect(),
    };
    let panels = [panel(true, "closes"), panel(false, "does not close")];
    Figure {
        title: "Hysteresis in pre-sliding, with one inner loop".to_owned(),
        caption: "Displacement and force in units of those at the first turn, which lies within each model's pre-sliding range. Non-local memory: the inner loop closes where \
                  it began, and the outer branch goes on as if it had not been."
            .to_owned(),
        x_label: "displacement over that of the first turn [-]".to_owned(),
        log_x: false,
        panels: panels.into_iter().filter(|panel| !panel.traces.is_empty()).collect(),
    }
}

pub(super) fn breakaway(models: &[ModelFeatures]) -> Figure {
    Figure {
        title: "Breakaway: friction against displacement under a force that rises by 0.1 N/s".to_owned(),
        caption: "A model without pre-sliding holds still up to its static level. The others give way first; where the curve bends over, the contact \
                  breaks away. Cut off at -0.5 N, which only the damping of the Leuven model passes, at -4 N."
            .to_owned(),
        x_label: "displacement [mm]".to_owned(),
        log_x: false,
        panels: panels(models, "friction [N]", |model| {
            let found = model.features.breakaway.iter().min_by(|a, b| {
                (a.rate - 0.1).abs().total_cmp(&(b.rate - 0.1).abs())
            })?;
            let shown = |&force: &f64| if force < -0.5 { f64::NAN } else { force };
            Some((scaled(&found.course.displacement, 1e3), found.course.friction.iter().map(shown).collect()))
        }),
    }
}

/// The two measures of breakaway against the force rate.
pub(super) fn breakaway_rates(models: &[ModelFeatures]) -> Figure {
    let panel = |y_label: &str, of: fn(&friction_features::Breakaway) -> Option<f64>| Panel {
        y_label: y_label.to_owned(),
        traces: models
            .iter()
            .filter(|model| {
                model.settled(
                    &model.features.breakaway.iter().map(|b| b.evidence).collect::<Vec<_>>(),
                )
            })
            .map(|model| {
                let found = &model.features.breakaway;
                let x = found.iter().map(|b| b.rate).collect();
                let lowest = found.first().and_then(of).unwrap_or(f64::NAN);
                let y = found
                    .iter()
                    .map(|b| 100.0 * (of(b).unwrap_or(f64::NAN) / lowest - 1.0))
                    .collect();
                of_model(model, x, y)
            })
            .collect(),
    };
    Figure {
        title: "Breakaway against the rate of the force: two measures that disagree".to_owned(),
        caption: "Change against the lowest rate. The largest friction falls with the rate, since the body gains speed while it breaks away. The force applied when the body \
                  reaches 1 mm/s holds its inertia as well, and can rise or fall. The thesis quotes both as one effect."
            .to_owned(),
        x_label: "force rate [N/s]".to_owned(),
        log_x: true,
        panels: vec![
            panel("largest friction [%]", |b| Some(b.friction_max)),
            panel("applied at 1 mm/s [%]", |b| b.applied_at_threshold),
        ],
    }
}

pub(super) fn lag(models: &[ModelFeatures]) -> Figure {
    let traces = models
        .iter()
        .filter(|model| model.lag().is_some())
        .filter_map(|model| {
            let course = &model.features.test_bed_lag.last()?.course;
            let steady = AnyModel::test_bed(model.features.name);
            let above = |branch: &[f64]| -> Vec<f64> {
                let pairs = course.velocity.iter().zip(branch);
                pairs.map(|(&v, force)| 1e3 * (force - steady.steady_state(v))).collect()
            };
            // There and back again, as one closed line.
            let there = course.velocity.iter().copied();
            let x = there.clone().chain(there.rev()).collect();
            let y = above(&course.growing)
                .into_iter()
                .chain(above(&course.falling).into_iter().rev())
                .collect();
            Some(loop_of(model, x, y))
        })
        .collect();
    Figure {
        title: "Frictional lag: friction beyond its steady value, over velocity, at 10 rad/s".to_owned(),
        caption: "Test bed; the velocity swings between 0.05 and 1.95 rad/s. A model with lag has more friction while the velocity grows than while it falls. Models without \
                  lag stay at zero and are left out."
            .to_owned(),
        x_label: "velocity [rad/s]".to_owned(),
        log_x: false,
        panels: vec![Panel { y_label: "beyond steady [mN m]".to_owned(), traces }],
    }
}

/// Area of the loop against frequency.
pub(super) fn lag_areas(models: &[ModelFeatures]) -> Figure {
    let traces = models
        .iter()
        .filter(|model| model.lag().is_some())
        .map(|model| {
            let found = &model.features.test_bed_lag;
            let (x, y) = found.iter().map(|lag| (lag.frequency, 1e6 * lag.area)).unzip();
            of_model(model, x, y)
        })
        .collect();
    Figure {
        title: "Frictional lag: area of the loop against frequency".to_owned(),
        caption: "A first-order lag grows in proportion to the frequency as long as it is short. A negative area is a loop that runs the wrong way round: the \
                  damping term of the Leuven model does that here, that of GMS with the set of chapter 3."
            .to_owned(),
        x_label: "angular frequency [rad/s]".to_owned(),
        log_x: true,
        panels: vec![Panel { y_label: "area [uW]".to_owned(), traces }],
    }
}

pub(super) fn steady_state(models: &[ModelFeatures]) -> Figure {
    Figure {
        title: "Steady sliding".to_owned(),
        caption: "What is left after a long time at constant velocity: the Stribeck curve for every model that has one.".to_owned(),
        x_label: "velocity [m/s]".to_owned(),
        log_x: false,
        panels: panels(models, "friction [N]", |model| {
            let curve = &model.features.steady_state.curve;
            Some((curve.velocity.clone(), curve.friction.clone()))
        }),
    }
}

pub(super) fn zero_crossing(models: &[ModelFeatures]) -> Figure {
    Figure {
        title: "Reversal: friction against displacement while the velocity passes through zero".to_owned(),
        caption: "A static model changes sign at once. Bristles unload first, and the force follows the displacement.".to_owned(),
        x_label: "displacement since the turn [mm]".to_owned(),
        log_x: false,
        panels: panels(models, "friction [N]", |model| {
            let course = &model.features.zero_crossing.first()?.course;
            // The neighbourhood of the turn.
            let near = |x: &f64| x.abs() < 4e-3;
            let (x, y) = course
                .displacement
                .iter()
                .zip(&course.friction)
                .filter(|(x, _)| near(x))
                .map(|(x, y)| (1e3 * x, *y))
                .unzip();
            Some((x, y))
        }),
    }
}

pub(super) fn describing(models: &[ModelFeatures]) -> Figure {
    let panel = |y_label: &str, of: fn(&ModelFeatures) -> &Vec<f64>| Panel {
        y_label: y_label.to_owned(),
        traces: models
            .iter()
            .map(|model| {
                let scale = |k: usize| model.describing.amplitude[k];
                // Times the amplitude: forces, which stay on one scale over the decades.
                let y = of(model).iter().enumerate().map(|(k, n)| n * scale(k)).collect();
                of_model(model, model.describing.amplitude.clone(), y)
            })
            .collect(),
    };
    Figure {
        title: "Describing function N(A) times the amplitude A, at 0.5 rad/s".to_owned(),
        caption: "Upper: the part in phase with the displacement, a spring. Lower: the part in phase with the velocity, which dissipates; the imaginary part of N is \
                  above zero for every contact that takes energy."
            .to_owned(),
        x_label: "amplitude A [m]".to_owned(),
        log_x: true,
        panels: vec![
            panel("in phase, A Re N [N]", |model| &model.describing.re),
            panel("out of phase, A Im N [N]", |model| &model.describing.im),
        ],
    }
}

pub(super) fn nyquist(study: &LimitCycleStudy) -> Figure {
    // The part of both curves in which they could meet.
    let near = |re: &[f64], im: &[f64]| {
        re.iter()
            .zip(im)
            .map(|(&re, &im)| if re.hypot(im) < 0.5 { (re, im) } else { (f64::NAN, f64::NAN) })
            .unzip()
    };
    let curve = |name: &str, re: &[f64], im: &[f64], style| {
        let (x, y) = near(re, im);
        Trace::Line { name: name.to_owned(), x, y, style }
    };
    let (printed, right) = (&study.predicted_as_printed, &study.predicted);
    let (x, y): (Vec<f64>, Vec<f64>) = printed
        .cycles
        .iter()
        .filter_map(|cycle| {
            let nearest =
                study.nyquist.parameter.iter().position(|&w| w >= cycle.angular_frequency)?;
            Some((study.nyquist.re[nearest], study.nyquist.im[nearest]))
        })
        .unzip();
    Figure {
        title: "Nyquist curve of the position loop, and -1/N(A)".to_owned(),
        caption: "Where the curves meet a limit cycle is predicted. The describing function of the model never meets the loop's curve. The thesis's eq. 3.63, \
                  whose imaginary part has the wrong sign, does."
            .to_owned(),
        x_label: "real part [m/N]".to_owned(),
        log_x: false,
        panels: vec![Panel {
            y_label: "imaginary part [m/N]".to_owned(),
            traces: vec![
                curve("loop G(jw)", &study.nyquist.re, &study.nyquist.im, LineStyle::Solid),
                curve("-1/N(A) of the model", &right.locus.re, &right.locus.im, LineStyle::Solid),
                curve("-1/N(A) as printed (3.63)", &printed.locus.re, &printed.locus.im, LineStyle::Dashed),
                Trace::Points { name: "predicted by 3.63".to_owned(), x, y, error: None },
            ],
        }],
    }
}

pub(super) fn hunting(study: &LimitCycleStudy) -> Figure {
    Figure {
        title: "The same loop, simulated: it hunts".to_owned(),
        caption: "Position under the proposed model. After the transient the integral winds up while the mass sticks and pushes it over, for ever.".to_owned(),
        x_label: "time [s]".to_owned(),
        log_x: false,
        panels: vec![Panel {
            y_label: "position [m]".to_owned(),
            traces: vec![line("position", study.simulated.time.clone(), study.simulated.position.clone())],
        }],
    }
}
