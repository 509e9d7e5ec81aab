//! `parameters.yaml`: models, controller and drive as a ROS 2 parameter file. Behind each value
//! stands where it comes from.

use controller::{ControllerOptions, ControllerParameters, PlantInverse, VelocityLaw};
use friction_model::{ModelName, Motor};
use friction_observer::parameters::model_parameters;
use parameters::file::Writer;
use parameters::{Declared, ParameterError, ParameterValue};
use rig_setup::RigChoice;

use super::origin::{Origin, Origins};
use super::{Compensators, Given, Identification, RunError, RunOptions};
use crate::test_bed::TestBed;

/// A parameter file as text, and where each of its values comes from.
#[derive(Debug, Clone, PartialEq)]
pub struct Written {
    /// The file.
    pub text: String,
    /// Each value's origin.
    pub origins: Origins,
}

/// The file of a run: `chosen` is the observer's model, all models stand with their parameters.
/// `found` is what the run identified, if it did; `name` tells the run.
pub(super) fn render(
    options: &RunOptions,
    models: &Compensators,
    chosen: ModelName,
    found: Option<&Identification>,
    name: &str,
) -> Result<Written, RunError> {
    let mut origins = options.origins.clone();
    if options.rig != RigChoice::Simulated {
        for own in ["rig_driver.voltage_limit", "rig_driver.period"] {
            origins.set(own, Origin::Rig);
        }
    }
    render_bed((&options.test_bed, models, chosen), &origins, found, name)
}

/// The same for any run on a test bed; `origins` says where what it was given comes from.
///
/// # Errors
/// As for [`render`].
pub fn render_bed(
    (test_bed, models, chosen): (&TestBed, &Compensators, ModelName),
    origins: &Origins,
    found: Option<&Identification>,
    name: &str,
) -> Result<Written, RunError> {
    let describe =
        |error: ParameterError| RunError::Describe { what: "YAML", detail: error.to_string() };
    let mut observer = vec![("model".to_owned(), ParameterValue::String(chosen.to_string()))];
    for name in ModelName::ALL {
        observer.extend(model_parameters(&models.get(name)).map_err(describe)?);
    }
    let simulation = &test_bed.simulation;
    let controller = controller_values(&ControllerOptions {
        voltage_limit: simulation.voltage_limit,
        ..test_bed.controller
    });
    let Motor { motor_constant, gear_ratio, armature_resistance, inertia } = simulation.drive;
    let rig_driver = [
        ("drive.motor_constant", motor_constant),
        ("drive.gear_ratio", gear_ratio),
        ("drive.armature_resistance", armature_resistance),
        ("drive.inertia", inertia),
        ("voltage_limit", simulation.voltage_limit),
        ("period", simulation.period),
    ];
    let rig_driver =
        rig_driver.map(|(name, value)| (name.to_owned(), ParameterValue::Double(value)));

    let mut known = origins.clone();
    known.set("controller.voltage_limit", origins.of("rig_driver.voltage_limit"));
    known.set("controller.volts_per_newton_metre", Origin::Drive);
    known.set("friction_observer.model", Origin::Option { option: "--model".to_owned() });
    let mut each = Origins::default();
    let mut nodes = Writer::default();
    for (node, values) in [
        ("friction_observer", observer),
        ("controller", controller),
        ("rig_driver", rig_driver.into()),
    ] {
        nodes.node(&format!("/{node}"));
        for (name, value) in values {
            let path = format!("{node}.{name}");
            let origin =
                found.and_then(|found| identified(found, &path)).unwrap_or_else(|| known.of(&path));
            nodes.value(&name, value, &origin.to_string());
            each.set(path, origin);
        }
    }
    let version = env!("CARGO_PKG_VERSION");
    let identified = if each.any_identified() {
        "static parameters of the models were identified by it"
    } else {
        "nothing was identified by it"
    };
    let mut file = Writer::default();
    file.comment(&format!("Parameters of {name}, frictionlab {version}; {identified}."));
    file.comment("Behind each value stands where it comes from.");
    let text = file.text() + &nodes.text();
    Ok(Written { text, origins: each })
}

/// Where a value comes from that the fit of the Stribeck curve touched.
fn identified(found: &Identification, path: &str) -> Option<Origin> {
    let within = path.strip_prefix("friction_observer.")?;
    let name = within.rsplit('.').next()?;
    let level = |name: &str| found.parameters.iter().find(|parameter| parameter.name == name);
    if let Some(parameter) = level(name) {
        let doubtful = parameter.estimate.unidentifiable.is_some();
        return Some(if doubtful { Origin::NotIdentifiable } else { Origin::Identified });
    }
    match name {
        "f_h" => Some(Origin::InProportion { to: "f_s".to_owned() }),
        "z_ba" => Some(Origin::InProportion { to: "f_c".to_owned() }),
        "delta" => Some(Origin::Fixed),
        _ => None,
    }
}

/// The controller's parameters that a run decides on, and what else differs from the default. What
/// each experiment sets itself is left out.
fn controller_values(options: &ControllerOptions) -> Vec<(String, ParameterValue)> {
    let said = ControllerParameters::of(options);
    let (declared, values) = (said.declarations(), said.values());
    let usual = ControllerParameters::default().values();
    let law = match options.velocity {
        VelocityLaw::Lag(_) => "lag",
        VelocityLaw::Pi(_) => "pi",
    };
    let always = |name: &str| {
        let (group, _) = name.split_once('.').unwrap_or((name, ""));
        match group {
            "lag" | "pi" => group == law,
            "pid" | "derivative_on" | "derivative_filter" | "compensation_scale" => true,
            "volts_per_newton_metre" | "voltage_limit" => true,
            "drive" => options.inverse != PlantInverse::Off,
            "acceleration" => options.acceleration.is_some(),
            "dither" => options.dither.is_some(),
            "impulse" => options.impulse.is_some(),
            _ => false,
        }
    };
    let changed = |name: &str| {
        let elsewhere = Given::SET_BY_THE_RUN.contains(&name)
            || ["velocity_law", "pi", "lag"].contains(&name)
            || ["lag.", "pi."].iter().any(|start| name.starts_with(start));
        !elsewhere && values.get(name) != usual.get(name)
    };
    declared
        .iter()
        .map(|one| one.name())
        .filter(|name| always(name) || changed(name))
        .filter_map(|name| Some((name.to_owned(), values.get(name)?.clone())))
        .collect()
}

#[cfg(test)]
mod tests {
    use friction_ident::StribeckValues;
    use friction_model::AnyModel;

    use super::super::given::read;
    use super::*;
    use crate::run::options::tests::options;

    #[test]
    fn what_is_written_reads_back() {
        let found = StribeckValues { f_s: 0.2, f_c: 0.1, v_s: 0.3, f_v: 0.05, delta: 2.0 };
        let models = Compensators::default().with_static(&found).unwrap();
        let text = render(&options(), &models, ModelName::Proposed, None, "this run").unwrap().text;
        assert!(text.contains("/friction_observer:\n  ros__parameters:\n"), "{text}");
        assert!(text.contains("model: proposed"), "{text}");
        assert_eq!(read(&text).unwrap(), models);
    }

    #[test]
    fn asymmetric_models_are_written_and_read_back() {
        let mut models = Compensators::default();
        for name in [ModelName::LuGre, ModelName::Gms] {
            let weaker = AnyModel::test_bed(name).scaled("f_v", 0.5).unwrap();
            models.set(AnyModel::asymmetric(&AnyModel::test_bed(name), &weaker).unwrap());
        }
        let text = render(&options(), &models, ModelName::LuGre, None, "this run").unwrap().text;
        assert!(text.contains("    asymmetric:\n      lugre:\n        forward:\n"), "{text}");
        assert_eq!(read(&text).unwrap(), models);
    }

    #[test]
    fn every_value_of_the_file_says_where_it_comes_from() {
        let mut options = options();
        options.origins.set("controller.pid", Origin::File { file: "controller.yaml".to_owned() });
        let written =
            render(&options, &Compensators::default(), ModelName::Proposed, None, "runs/all-1")
                .unwrap();
        let mut values = 0;
        for line in written.text.lines().filter(|line| !line.starts_with('#')) {
            let (_, value) = line.split_once(':').unwrap();
            if !value.trim().is_empty() {
                values += 1;
                let (_, said) = value.split_once("  # ").unwrap_or_else(|| panic!("{line}"));
                assert!(!said.contains("identified"), "{line}");
            }
        }
        assert_eq!(values, written.origins.iter().count());
        assert!(written.text.contains("k_p: 5.7517  # from controller.yaml"), "{}", written.text);
        assert!(written.text.contains("nothing was identified by it"));
    }
}
