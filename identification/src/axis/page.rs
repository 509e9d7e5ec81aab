//! `identification.html` as data: tables and pictures for [`report::render_page`].

use friction_ident::axis_structure::AxisStructure;
use friction_ident::robust_covariance::METHOD;
use friction_ident::{AxisTerm, Differences, Prediction};

use super::errors::errors;
use super::structure::Structured;
use super::structure_page;
use super::terminal::{equation, hertz, low_pass};
use super::{Identification, ModelResult, unit};
use recording::Recording;
use report::figure::{Block, Figure, LineStyle, Page, Panel, Table, Trace};
use report::numbers::value_and_error as with_error;

/// Markers a cloud of points is thinned to: more only cost time and hide one another.
const CLOUD: usize = 1500;

/// The page; a structure that was chosen stands before the plain models.
pub fn page(
    found: &Identification,
    structured: Option<&Structured>,
    recording: &Recording,
    validation: Option<&Recording>,
) -> Page {
    // The folder says nothing to whoever the page is sent to; the document has the whole path.
    let name = |recording: &Recording| {
        recording
            .path
            .file_name()
            .map_or_else(String::new, |name| name.to_string_lossy().into_owned())
    };
    let how = found.settings.conditioning;
    let mut blocks = vec![Block::Heading("What was found".to_owned())];
    blocks.extend(found.warnings.iter().map(|said| Block::Note(format!("WARNING: {said}"))));
    blocks.extend(found.notes.iter().cloned().map(Block::Note));
    if let Some(structured) = structured {
        let warned = warned(found);
        blocks.extend(structure_page::blocks(structured, found.settings.axis, &warned));
        blocks.push(Block::Heading("The plain models beside it".to_owned()));
        let of_plain = found.plain().flat_map(|model| found.beside(model));
        blocks.extend(of_plain.map(|said| Block::Note(format!("WARNING: {said}"))));
        blocks.push(Block::Table(errors(found, Some(structured), validation)));
    }
    blocks.push(Block::Table(parameters(
        found,
        &found.symmetric,
        "One friction for both directions",
    )));
    if let Some(asymmetric) = &found.asymmetric {
        blocks.push(Block::Table(parameters(found, asymmetric, "Friction of each direction")));
    }
    if structured.is_none() {
        blocks.push(Block::Table(errors(found, None, validation)));
    }
    blocks.push(Block::Heading(format!("On the recording it was fitted to: {}", name(recording))));
    let predictions = |of: fn(&ModelResult) -> Option<&Prediction>| {
        let asymmetric = found
            .asymmetric
            .as_ref()
            .and_then(of)
            .map(|prediction| ("asymmetric model", prediction));
        let symmetric = of(&found.symmetric).map(|prediction| ("symmetric model", prediction));
        symmetric.into_iter().chain(asymmetric).collect::<Vec<_>>()
    };
    let estimation = predictions(|result| Some(&result.estimation));
    blocks.push(Block::Figure(over_time(found, &estimation)));
    blocks.push(Block::Figure(over_velocity(found)));
    if let Some(other) = validation {
        blocks.push(Block::Heading(format!("The cross-test: {}", name(other))));
        blocks.push(Block::Text(
            "The models are those fitted above; nothing was adjusted to this recording.".to_owned(),
        ));
        blocks.push(Block::Figure(over_time(
            found,
            &predictions(|result| result.validation.as_ref()),
        )));
    }
    blocks.push(Block::Heading("How it was done".to_owned()));
    blocks.push(Block::Text(format!(
        "Motion through a low-pass of order {} at {}, forwards and backwards; central differences of the {} order; {} samples \
         dropped at each end; every regressor and the {} thinned to 1 sample in {} after one and the same low-pass; \
         ordinary least squares. Standard errors: {METHOD}.",
        how.order,
        low_pass(&how),
        match how.differences {
            Differences::SecondOrder => "second",
            Differences::SixthOrder => "sixth",
        },
        how.trim,
        found.settings.axis.force_word(),
        how.decimate,
    )));
    Page {
        title: "Identified axis".to_owned(),
        subtitle: format!(
            "{}, {} samples, {:.2} s at {} Hz; frictionlab {}",
            name(recording),
            recording.samples(),
            recording.duration(),
            hertz(1.0 / recording.time_step),
            env!("CARGO_PKG_VERSION")
        ),
        blocks,
    }
}

fn parameters(found: &Identification, result: &ModelResult, title: &str) -> Table {
    let axis = found.settings.axis;
    let rows = result
        .fit
        .terms
        .iter()
        .map(|estimate| {
            let (value, error) = with_error(estimate.value, estimate.standard_error);
            let name = estimate.term.describe().trim_start_matches("the ").to_owned();
            let half = with_error(estimate.value, estimate.half_width).1;
            let trusted = estimate.doubt.map_or_else(|| half, |_| "not to be trusted".to_owned());
            vec![name, value, error, trusted, unit(estimate.term, axis).to_owned()]
        })
        .collect();
    Table {
        title: title.to_owned(),
        caption: equation(result, axis.force_word()),
        columns: ["parameter", "value", "standard error", "95 % interval ±", "unit"]
            .map(str::to_owned)
            .to_vec(),
        rows,
        highlight: None,
    }
}

/// The plain models that a warning is of.
fn warned(found: &Identification) -> Vec<AxisStructure> {
    let warned = found.plain().filter(|result| result.warned);
    let structure = |result: &ModelResult| {
        let asymmetric = result.fit.model.asymmetric;
        AxisStructure { asymmetric, ..AxisStructure::SYMMETRIC }
    };
    warned.map(structure).collect()
}

fn over_time(found: &Identification, predictions: &[(&str, &Prediction)]) -> Figure {
    let axis = found.settings.axis;
    let (word, unit) = (axis.force_word(), axis.force_unit());
    let line =
        |name: String, x: &[f64], y: Vec<f64>, style| Trace::Line { name, x: x.to_vec(), y, style };
    let mut force = Vec::new();
    let mut residual = Vec::new();
    if let Some((_, first)) = predictions.first() {
        force.push(line(
            "measured".to_owned(),
            &first.time,
            first.measured.clone(),
            LineStyle::Solid,
        ));
    }
    for (name, prediction) in predictions {
        force.push(line(
            (*name).to_owned(),
            &prediction.time,
            prediction.predicted.clone(),
            LineStyle::Dashed,
        ));
        residual.push(line(
            (*name).to_owned(),
            &prediction.time,
            prediction.residual(),
            LineStyle::Solid,
        ));
    }
    Figure {
        title: format!("Measured and predicted {word}"),
        caption: format!(
            "Above, the {word} as recorded and as the models predict it from the motion; below, the difference."
        ),
        x_label: "time [s]".to_owned(),
        log_x: false,
        panels: vec![
            Panel { y_label: format!("{word} [{unit}]"), traces: force },
            Panel { y_label: format!("measured - predicted [{unit}]"), traces: residual },
        ],
    }
}

fn over_velocity(found: &Identification) -> Figure {
    let axis = found.settings.axis;
    let (word, unit) = (axis.force_word(), axis.force_unit());
    let best = found.asymmetric.as_ref().unwrap_or(&found.symmetric);
    let prediction = &best.estimation;
    let every = prediction.velocity.len().div_ceil(CLOUD).max(1);
    let thin = |values: &[f64]| values.iter().copied().step_by(every).collect::<Vec<_>>();
    let mut traces = vec![Trace::Points {
        name: if best.fit.model.inertia { "measured, less inertia" } else { "measured" }.to_owned(),
        x: thin(&prediction.velocity),
        y: thin(&prediction.friction),
        error: None,
    }];
    let fastest = prediction.velocity.iter().fold(0.0f64, |most, v| most.max(*v));
    let slowest = prediction.velocity.iter().fold(0.0f64, |least, v| least.min(*v));
    // The break at rest keeps the two branches apart.
    let speeds = [slowest, -0.0, f64::NAN, 0.0, fastest];
    let sides = [-1.0, -1.0, 0.0, 1.0, 1.0];
    let models = [
        ("symmetric model", Some(&found.symmetric)),
        ("asymmetric model", found.asymmetric.as_ref()),
    ];
    for (name, result) in models.into_iter().filter_map(|(name, result)| Some((name, result?))) {
        let y = speeds.iter().zip(sides).map(|(&v, side)| friction(result, v, side)).collect();
        traces.push(Trace::Line {
            name: name.to_owned(),
            x: speeds.to_vec(),
            y,
            style: LineStyle::Solid,
        });
    }
    Figure {
        title: format!("Friction {word} against velocity"),
        caption: format!(
            "Points: the measured {word} less inertia times acceleration, and less what the position alone decides. Lines: the models. What the points show and \
             the lines do not, this kind of model cannot have."
        ),
        x_label: format!("velocity [{}]", axis.velocity_unit()),
        log_x: false,
        panels: vec![Panel { y_label: format!("friction {word} [{unit}]"), traces }],
    }
}

/// The model's friction on one side of rest.
fn friction(result: &ModelResult, velocity: f64, side: f64) -> f64 {
    let value = |term| result.fit.value(term);
    if !result.fit.model.asymmetric {
        value(AxisTerm::Viscous) * velocity
            + value(AxisTerm::Coulomb) * side
            + value(AxisTerm::Offset)
    } else if side > 0.0 {
        value(AxisTerm::ViscousPositive) * velocity + value(AxisTerm::CoulombPositive)
    } else {
        value(AxisTerm::ViscousNegative) * velocity - value(AxisTerm::CoulombNegative)
    }
}
