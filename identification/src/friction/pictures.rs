//! The pictures: Stribeck curves with bands, loops of pre-sliding and lag, residuals, errors of
//! each kind.

use friction_ident::starting_model::breakaway_reach;
use friction_ident::{FrictionData, Stretch, StretchKind};

use super::{FrictionIdentification, KINDS, ModelResult, band};
use report::figure::{Figure, LineStyle, Mark, Panel, Trace};
use report::smooth::{moving_mean, one_cycle};

/// The series of what was measured.
const MEASURED: &str = "measured";

/// Models drawn over a recording: more hide one another.
const DRAWN: usize = 4;

fn line(name: impl Into<String>, x: Vec<f64>, y: Vec<f64>, style: LineStyle) -> Trace {
    Trace::Line { name: name.into(), x, y, style }
}

/// Steady points with every model's curve and the first one's band.
pub fn steady(found: &FrictionIdentification) -> Option<Figure> {
    let points = &found.data.points;
    let axis = found.settings.axis;
    if points.is_empty() {
        return None;
    }
    // Friction alone: without what the first model has beside it.
    let beside = found.models.first()?.found.load;
    let mut traces = vec![Trace::Points {
        name: "measured".to_owned(),
        x: points.iter().map(|p| p.velocity).collect(),
        y: points.iter().map(|p| beside.taken_from_point(p).torque).collect(),
        error: points.iter().map(|p| p.deviation).collect(),
    }];
    if let Some(held_out) = found.held_out.as_ref().filter(|data| !data.points.is_empty()) {
        traces.push(Trace::Points {
            name: "held out".to_owned(),
            x: held_out.points.iter().map(|p| p.velocity).collect(),
            y: held_out.points.iter().map(|p| beside.taken_from_point(p).torque).collect(),
            error: None,
        });
    }
    let fastest = points.iter().fold(0.0f64, |most, p| most.max(p.velocity));
    let slowest = points.iter().fold(0.0f64, |least, p| least.min(p.velocity));
    let velocities = grid(slowest, fastest);
    let first = found.models.first()?;
    if let Some(halves) = band::half_widths(&first.found, &velocities) {
        let edge = |sign: f64| {
            velocities
                .iter()
                .zip(&halves)
                .map(|(&v, half)| first.found.model.steady_state(v) + sign * half)
                .collect::<Vec<f64>>()
        };
        traces.push(Trace::Band {
            name: format!("{}, 95 % band", first.found.name),
            x: velocities.clone(),
            lower: edge(-1.0),
            upper: edge(1.0),
        });
    }
    for result in &found.models {
        let curve = velocities.iter().map(|&v| result.found.model.steady_state(v)).collect();
        traces.push(line(result.found.name.as_str(), velocities.clone(), curve, LineStyle::Solid));
    }
    Some(Figure {
        title: "Steady sliding".to_owned(),
        caption: "Points: the mean friction at constant velocities. Lines: the models. The band is where the first model's curve lies with 95 % confidence, \
                  single measurements scatter more."
            .to_owned(),
        x_label: format!("velocity [{}]", axis.velocity_unit()),
        log_x: false,
        panels: vec![Panel { y_label: format!("friction [{}]", axis.force_unit()), traces }],
    })
}

/// Velocities, densest near rest, with a break there.
fn grid(slowest: f64, fastest: f64) -> Vec<f64> {
    const HALF: i32 = 120;
    let side = |end: f64| (1..=HALF).map(move |k| end * (f64::from(k) / f64::from(HALF)).powi(2));
    let backward: Vec<f64> = if slowest < 0.0 { side(slowest).collect() } else { Vec::new() };
    let mut grid: Vec<f64> = backward.into_iter().rev().collect();
    if fastest > 0.0 {
        if !grid.is_empty() {
            grid.push(f64::NAN);
        }
        grid.extend(side(fastest));
    }
    grid
}

/// The longest recording of each dynamic kind, fitted and held out.
pub fn dynamic(found: &FrictionIdentification) -> Vec<Figure> {
    let sets = [("fitted", Some(&found.data)), ("held out", found.held_out.as_ref())];
    sets.into_iter()
        .filter_map(|(name, data)| Some((name, data?)))
        .flat_map(|(name, data)| {
            [StretchKind::PreSliding, StretchKind::Lag, StretchKind::Mixed]
                .into_iter()
                .filter_map(move |kind| recording(found, name, data, kind))
        })
        .collect()
}

fn recording(
    found: &FrictionIdentification,
    name: &str,
    data: &FrictionData,
    kind: StretchKind,
) -> Option<Figure> {
    let stretch = data.stretches(kind).iter().max_by_key(|stretch| stretch.len())?;
    let axis = found.settings.axis;
    let position_unit = axis.velocity_unit().trim_end_matches("/s");
    let time = || (0..stretch.len()).map(|k| k as f64 * stretch.time_step).collect::<Vec<f64>>();
    let (x, x_label, title): (Vec<f64>, String, &str) = match kind {
        StretchKind::PreSliding => {
            (stretch.travel(), format!("displacement [{position_unit}]"), "Pre-sliding loops")
        }
        StretchKind::Lag => {
            (stretch.velocity.clone(), format!("velocity [{}]", axis.velocity_unit()), "Lag loops")
        }
        _ => (time(), "time [s]".to_owned(), "Mixed motion"),
    };
    let path = matches!(kind, StretchKind::PreSliding | StretchKind::Lag);
    // Of a motion that repeats one cycle is shown, and of what is measured the mean over some
    // neighbours.
    let cycle = if path { one_cycle(&x) } else { 0..stretch.len() };
    let half = if path { cycle.len() / 200 } else { 0 };
    let course = |values: &[f64]| moving_mean(&values[cycle.clone()], half);
    let drawn_as = |name: &str, values: &[f64]| {
        if path {
            Trace::Loop { name: name.to_owned(), x: course(&x), y: course(values) }
        } else {
            line(
                name,
                x.clone(),
                values.to_vec(),
                if name == MEASURED { LineStyle::Faint } else { LineStyle::Solid },
            )
        }
    };
    let mut traces = vec![drawn_as(MEASURED, &stretch.friction)];
    // A model without bristles only jumps from level to level here and would hide the others.
    let shows = |result: &&ModelResult| {
        kind != StretchKind::PreSliding || breakaway_reach(&result.found.model).is_some()
    };
    for result in drawn(found).filter(shows) {
        traces.push(drawn_as(result.found.name.as_str(), &result.found.predictor().along(stretch)));
    }
    let part = match (path, cycle.len() < stretch.len()) {
        (true, true) => {
            format!(" Shown is one cycle of it, each point the mean of {} samples.", 2 * half + 1)
        }
        (true, false) if half > 0 => {
            format!(" Each point is the mean of {} samples.", 2 * half + 1)
        }
        _ => String::new(),
    };
    Some(Figure {
        title: format!("{title}, {name}"),
        caption: format!(
            "The longest recording of this kind, {} samples, and the first models in order.{part}",
            stretch.len()
        ),
        x_label,
        log_x: false,
        panels: vec![Panel { y_label: format!("friction [{}]", axis.force_unit()), traces }],
    })
}

fn drawn(found: &FrictionIdentification) -> impl Iterator<Item = &ModelResult> {
    found.models.iter().take(DRAWN)
}

/// Predicted minus measured along the longest dynamic recording, else at the steady points.
pub fn residuals(found: &FrictionIdentification) -> Option<Figure> {
    let (data, name) = match &found.held_out {
        Some(data) => (data, "held out"),
        None => (&found.data, "fitted"),
    };
    let axis = found.settings.axis;
    let longest: Option<&Stretch> = [StretchKind::Mixed, StretchKind::Lag, StretchKind::PreSliding]
        .into_iter()
        .flat_map(|kind| data.stretches(kind))
        .max_by_key(|stretch| stretch.len());
    let mut traces = Vec::new();
    for result in drawn(found) {
        let by = result.found.predictor();
        let name = result.found.name.as_str();
        traces.push(match longest {
            Some(stretch) => {
                let time = (0..stretch.len()).map(|k| k as f64 * stretch.time_step).collect();
                let off =
                    by.along(stretch).iter().zip(&stretch.friction).map(|(p, f)| p - f).collect();
                line(name, time, off, LineStyle::Solid)
            }
            None => Trace::Points {
                name: name.to_owned(),
                x: data.points.iter().map(|p| p.velocity).collect(),
                y: data.points.iter().map(|p| by.steady(p) - p.torque).collect(),
                error: None,
            },
        });
    }
    (!traces.is_empty()).then(|| Figure {
        title: format!("What is left, {name}"),
        caption: "Predicted minus measured friction. A pattern is something that the model does not have; noise is not.".to_owned(),
        x_label: match longest {
            Some(_) => "time [s]".to_owned(),
            None => format!("velocity [{}]", axis.velocity_unit()),
        },
        log_x: false,
        panels: vec![Panel { y_label: format!("predicted - measured [{}]", axis.force_unit()), traces }],
    })
}

/// Bars: error of each model on each kind of recording, held out where there is any.
pub fn errors(found: &FrictionIdentification) -> Option<Figure> {
    let of = |result: &ModelResult| result.held_out.unwrap_or(result.fit);
    let present: Vec<usize> = (0..KINDS.len())
        .filter(|&k| found.models.iter().any(|r| of(r).kinds[k].is_some()))
        .collect();
    let bars = |result: &ModelResult| Trace::Categories {
        name: result.found.name.as_str().to_owned(),
        x: present.iter().map(|&k| KINDS[k].describe().to_owned()).collect(),
        y: present.iter().map(|&k| of(result).kinds[k].unwrap_or(f64::NAN)).collect(),
        mark: Mark::Bar,
    };
    let set = if found.held_out.is_some() { "held out" } else { "fitted" };
    (!present.is_empty()).then(|| Figure {
        title: format!("Error of each model on each kind of recording, {set}"),
        caption: "Root mean square of predicted minus measured friction.".to_owned(),
        x_label: "kind of recording".to_owned(),
        log_x: false,
        panels: vec![Panel {
            y_label: format!("rms [{}]", found.settings.axis.force_unit()),
            traces: found.models.iter().map(bars).collect(),
        }],
    })
}
