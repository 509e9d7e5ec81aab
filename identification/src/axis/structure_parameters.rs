//! `parameters.yaml` of a chosen structure: its friction as a ROS 2 parameter file for the friction
//! observer.
//!
//! Friction of each direction becomes a contact with two sets of parameters. A curve near rest is
//! Stribeck's; with pre-sliding it is LuGre, whose stiffness bends as far as the structure's
//! bristle. What is no friction (inertia, delay, offset, what depends on the position) stands in
//! comments: it belongs to no model of the observer.

use friction_ident::axis_structure::{AxisStructure, StructureFit};
use friction_ident::{Estimate, ParameterId, Side, Verdict};
use friction_model::{AnyModel, AnyParameters, ModelError, ModelName};
use friction_observer::parameters::model_parameters;
use parameters::ParameterValue;
use parameters::file::Writer;
use report::numbers::{significant, value_and_error};

use recording::AxisKind;

use super::along::Along;
use super::parameters::{level_beside, usual_speed};
use super::structure::Structured;
use crate::speeds;
use crate::verdict::why;

/// Stribeck velocity of a curve without a dip: any positive number does.
const NO_DIP_V_S: f64 = 0.1;

/// The structure's friction cannot be written as parameters.
#[derive(Debug, thiserror::Error)]
#[error("the friction of the chosen structure cannot be written as parameters: {0}")]
pub struct StructureParametersError(String);

/// The file as text; `name` is the recording's, `axis` tells its units.
///
/// # Errors
/// [`StructureParametersError`] for a fit that no model accepts, which no finite one is.
pub fn render(
    found: &Structured,
    name: &str,
    axis: AxisKind,
) -> Result<String, StructureParametersError> {
    let fit = &found.fit;
    let refused = |error: &dyn ToString| StructureParametersError(error.to_string());
    let model =
        model(fit, usual_speed(&found.estimation.velocity)).map_err(|error| refused(&error))?;
    let mut file = Writer::default();
    let version = env!("CARGO_PKG_VERSION");
    file.comment(&format!("An axis fitted by frictionlab {version} to {name}."));
    if let Some(line) = speeds::line(found.estimation.velocity.iter().copied(), axis) {
        file.comment(&line);
    }
    file.comment(&format!(
        "The structure chosen by cross-validation: {}. What is no friction belongs to no node and stands here alone.",
        fit.structure
    ));
    for estimate in &fit.estimates.parameters {
        let Estimate { id, unit, .. } = estimate;
        file.comment(&format!("{id}: {} {unit}, {}", short(estimate).0, said(estimate)));
    }
    let along = Along::of(fit, axis).map(|along| along.note());
    for note in along.into_iter().chain(notes(fit)) {
        file.comment(&note);
    }
    file.node("/friction_observer");
    let chosen = ParameterValue::String(model.name().to_string());
    file.value("model", chosen, "the friction of the structure chosen");
    for (path, value) in model_parameters(&model).map_err(|error| refused(&error))? {
        file.value(&path, value, &origin(fit, &path));
    }
    Ok(file.text())
}

/// The model whose steady friction is that of the structure, at the usual `speed` also where viscous
/// friction is below zero.
fn model(fit: &StructureFit, speed: f64) -> Result<AnyModel, ModelError> {
    let sides: Vec<[f64; 3]> = Side::of(fit.structure.asymmetric)
        .iter()
        .map(|&side| {
            let value = |name| fit.estimates.value(ParameterId::new(name).side(side));
            let f_v = value("f_v").unwrap_or(0.0);
            let level = |level| level_beside(level, f_v, speed);
            let f_c = level(value("f_c").unwrap_or(0.0));
            [value("f_s").map_or(f_c, level), f_c, f_v.max(0.0)]
        })
        .collect();
    // What has no Coulomb friction in one direction has no model with any in it.
    let slides = sides.iter().all(|[_, f_c, _]| *f_c > 0.0);
    let one = |[f_s, f_c, f_v]: &[f64; 3]| {
        let name = match (slides, fit.structure.presliding) {
            (false, _) => ModelName::Viscous,
            (true, false) => ModelName::Stribeck,
            (true, true) => ModelName::LuGre,
        };
        let v_s = if fit.structure.stribeck { fit.shape.v_s } else { NO_DIP_V_S };
        let mut parameters = AnyParameters::test_bed(name);
        let f_s = f_s.max(*f_c);
        let values = [
            ("f_s", f_s),
            ("f_c", *f_c),
            ("v_s", v_s),
            ("delta", 2.0),
            ("sigma0", fit.structure.level_of_stiffness(f_s, *f_c) / fit.shape.displacement),
            ("sigma1", fit.estimates.value("sigma1").unwrap_or(0.0).max(0.0)),
            ("f_v", *f_v),
        ];
        for (name, value) in values {
            // One that the model does not have is left out.
            parameters.set(name, value);
        }
        AnyModel::try_from(parameters)
    };
    match &sides[..] {
        [forward, backward] => AnyModel::asymmetric(&one(forward)?, &one(backward)?),
        [both] => one(both),
        _ => one(&[0.0; 3]),
    }
}

/// What the model cannot say as the structure does.
fn notes(fit: &StructureFit) -> Vec<String> {
    let mut notes = Vec::new();
    for &side in Side::of(fit.structure.asymmetric) {
        let [f_s, f_c, f_v] = ["f_s", "f_c", "f_v"].map(|name| ParameterId::new(name).side(side));
        let value = |id| fit.estimates.value(id);
        if let (Some(low), Some(high)) = (value(f_s), value(f_c))
            && low < high
        {
            notes.push(format!(
                "{f_s} lies below {f_c}, which no model has: it is written as {f_c}."
            ));
        }
        if value(f_c).is_some_and(|value| value <= 0.0) {
            notes.push(format!("{f_c} is not above zero: only viscous friction is written."));
        }
        notes.extend(below_zero(fit, f_v));
    }
    notes.extend(below_zero(fit, "sigma1".into()));
    let AxisStructure { stribeck, presliding, lag, .. } = fit.structure;
    if stribeck && presliding && !lag {
        notes.push(
            "The dip of the structure follows the velocity at once. That of LuGre, as which it is written, lags as far as the bristle bends."
                .to_owned(),
        );
    }
    notes
}

/// What is said of a part of friction that came out as a drive.
fn below_zero(fit: &StructureFit, id: ParameterId) -> Option<String> {
    let below = fit.estimates.value(id).is_some_and(|value| value < 0.0);
    let level = if id.name == "f_v" {
        " f_c is such that friction at the usual speed stays what it is."
    } else {
        ""
    };
    below.then(|| {
        format!("{id} came out below zero, which friction cannot be: 0 is written.{level}")
    })
}

/// Where a value comes from; `path` is its place in the file.
fn origin(fit: &StructureFit, path: &str) -> String {
    let mut parts = path.rsplit('.');
    let (name, side) = (parts.next().unwrap_or_default(), parts.next().unwrap_or_default());
    let estimate = |name: &str| {
        let of = |text: &str| {
            fit.estimates.parameters.iter().find(|estimate| estimate.id.to_string() == text)
        };
        of(&format!("{name}.{side}")).or_else(|| of(name))
    };
    let found = estimate(name);
    let levels = estimate("f_s").zip(estimate("f_c"));
    if let Some((low, high)) = levels.filter(|(low, high)| low.value <= high.value) {
        let (low, high) = (low.id, high.id);
        match name {
            "f_s" => {
                return format!(
                    "a copy of f_c: {low} lies below {high}, a dip is not what this recording shows"
                );
            }
            "v_s" => return format!("without effect: {low} lies below {high}"),
            _ => {}
        }
    }
    match (name, found) {
        ("f_v" | "sigma1", Some(estimate)) if estimate.value < 0.0 => {
            format!("0 in place of {}, which is below zero", significant(estimate.value, 3))
        }
        ("f_s" | "f_c", Some(own)) if estimate("f_v").is_some_and(|f_v| f_v.value < 0.0) => {
            format!("{}; less what f_v below zero takes off at the usual speed", said(own))
        }
        (_, Some(estimate)) => said(estimate),
        ("f_s", None) => "a copy of f_c: no Stribeck dip in this structure".to_owned(),
        ("v_s", None) => "no Stribeck dip in this structure: without effect".to_owned(),
        ("sigma1", None) => "no damping of the bristle in this structure".to_owned(),
        ("sigma0", None) => {
            let level = fit.structure.level_of_stiffness("the level at rest", "the Coulomb level");
            format!("{level} over the displacement of pre-sliding")
        }
        _ => "not identified".to_owned(),
    }
}

/// Value and error with as many digits as they deserve; the error is empty where there is none.
fn short(estimate: &Estimate) -> (String, String) {
    value_and_error(estimate.value, estimate.standard_error.unwrap_or(f64::NAN))
}

fn said(estimate: &Estimate) -> String {
    match &estimate.verdict {
        Verdict::Identified => match short(estimate).1 {
            error if error.is_empty() => "identified".to_owned(),
            error => format!("identified, +- {error}"),
        },
        Verdict::NotIdentifiable { doubt, .. } => {
            format!("not identified: {}", why(estimate, doubt))
        }
        Verdict::Given { source } => format!("not estimated: {source}"),
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::AtomicBool;

    use friction_ident::{Conditioned, Conditioning, Signals, condition};
    use work::progress::Progress;

    use super::*;
    use crate::axis::structure::{StructureChoice, structured};

    /// 12 s at 1 kHz of 5 kg with friction that differs by direction.
    fn axis() -> Conditioned {
        let time = || (0..12_000).map(|k| f64::from(k) * 1e-3);
        let place: Vec<f64> =
            time().map(|t| 0.15 * (1.1 * t).sin() + 0.05 * (3.7 * t).sin()).collect();
        let force = |t: f64| {
            let v = 0.165 * (1.1 * t).cos() + 0.185 * (3.7 * t).cos();
            let a = -0.1815 * (1.1 * t).sin() - 0.6845 * (3.7 * t).sin();
            5.0 * a + if v > 0.0 { 6.0 + 9.0 * v } else { -8.0 + 12.0 * v }
        };
        let force: Vec<f64> = time().map(force).collect();
        let signals = Signals {
            time_step: 1e-3,
            position: Some(&place),
            readings: None,
            velocity: None,
            force: &force,
        };
        condition(&signals, &Conditioning::for_time_step(1e-3)).unwrap()
    }

    fn found(names: &str) -> Structured {
        let wanted: StructureChoice = names.parse().unwrap();
        let (progress, cancel) =
            (Progress::counting(1, "structures", true), AtomicBool::new(false));
        let found = structured(&axis(), None, &wanted, AxisKind::Linear, &progress, &cancel);
        found.unwrap().unwrap()
    }

    fn file(names: &str) -> String {
        render(&found(names), "axis.csv", AxisKind::Linear).unwrap()
    }

    fn value(file: &str, name: &str) -> f64 {
        let line = file.lines().find(|line| line.trim().starts_with(&format!("{name}:"))).unwrap();
        let (_, rest) = line.split_once(':').unwrap();
        rest.split('#').next().unwrap().trim().parse().unwrap()
    }

    /// The symmetric model was written, whatever was chosen.
    #[test]
    fn the_file_holds_the_structure_that_was_chosen() {
        let text = file("symmetric,asymmetric");
        assert!(text.contains("asymmetric") && text.contains("model: stribeck"), "{text}");
        let (_, sides) = text.split_once("/friction_observer").unwrap();
        let (_, forward) = sides.split_once("forward:").unwrap();
        let (_, backward) = sides.split_once("backward:").unwrap();
        // One of the two stands first; each has its own level.
        let levels = [value(forward, "f_c"), value(backward, "f_c")];
        assert!((levels[0] - 6.0).abs() < 0.2 && (levels[1] - 8.0).abs() < 0.2, "{text}");
        let text = file("symmetric");
        assert!(!text.contains("backward"), "{text}");
        assert!((value(&text, "f_c") - 7.0).abs() < 0.3, "{text}");
    }

    /// A bristle's stiffness was a third too low under a dip that follows at once; and zero, which no
    /// file may hold, where the level at rest is held at zero.
    #[test]
    fn the_stiffness_is_that_of_the_level_where_the_axis_turns() {
        let mut found = found("symmetric+stribeck+presliding");
        let f_c = found.fit.estimates.value("f_c").unwrap();
        for (lag, f_s, level) in
            [(false, 1.5 * f_c, 1.5 * f_c), (false, 0.0, f_c), (true, 1.5 * f_c, f_c)]
        {
            found.fit.structure.lag = lag;
            found.fit.estimates.get_mut("f_s").unwrap().value = f_s;
            let text = render(&found, "axis.csv", AxisKind::Linear).unwrap();
            let stiffness = level / found.fit.shape.displacement;
            assert!((value(&text, "sigma0") / stiffness - 1.0).abs() < 1e-3, "{text}");
        }
    }

    /// The copied f_c was called `identified`, with the error of the f_s that was not written.
    #[test]
    fn a_copied_value_says_so() {
        let mut found = found("symmetric+stribeck");
        let f_c = found.fit.estimates.value("f_c").unwrap();
        found.fit.estimates.get_mut("f_s").unwrap().value = 0.9 * f_c;
        let text = render(&found, "axis.csv", AxisKind::Linear).unwrap();
        assert_eq!(value(&text, "f_s"), f_c);
        let line = text.lines().find(|line| line.trim().starts_with("f_s:")).unwrap();
        assert!(
            line.contains("# a copy of f_c: f_s lies below f_c") && !line.contains("identified")
        );
        let notes = found.notes().concat();
        assert!(notes.contains("f_s lies below f_c"), "{notes}");
        // Numbers in the comments have as many digits as their errors.
        let inertia = text.lines().find(|line| line.starts_with("# inertia:")).unwrap();
        assert!(inertia.len() < 60, "{inertia}");
        found.fit.estimates.get_mut("f_v").unwrap().value = -0.012345678;
        let text = render(&found, "axis.csv", AxisKind::Linear).unwrap();
        let line = text.lines().find(|line| line.trim().starts_with("f_v:")).unwrap();
        assert!(line.contains("0 in place of -0.0123") && line.contains("below zero"), "{line}");
        assert!(file("symmetric").contains("# a copy of f_c: no Stribeck dip"));
    }
}
