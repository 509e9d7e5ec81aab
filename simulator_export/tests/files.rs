//! The files as simulators read them: versions, numbers, units, and what is refused.

use friction_model::{AnyModel, AnyParameters, ModelName};
use simulator_export::{
    Axis, Cogging, Contact, Given, Motor, Options, Reference, Refusal, Speeds, SpeedsFrom, Target,
    Version, Volts, export,
};
use strum::VariantArray;

fn given(model: AnyModel) -> Given {
    let speeds = Speeds::new(0.05, 3.0, SpeedsFrom::Asked).unwrap();
    Given::new(model, "parameters.yaml", "# fitted to a.csv\n", Some(speeds), None).unwrap()
}

/// Everything that some target asks for is there, and nobody asks who identified it.
fn options(target: Target) -> Options {
    Options {
        joint: "left/elbow".to_owned(),
        armature: target.has_armature().then_some(0.001),
        reference: (target == Target::Ur).then_some(Reference { f_c: 0.2, f_v: 0.1 }),
        motor: (target == Target::Bam).then_some(Motor { kt: 1.2, resistance: 2.7 }),
        actuator: (target == Target::Bam).then(|| "sts3215".to_owned()),
        accept_unidentified: true,
        ..Options::default()
    }
}

fn text(name: ModelName, target: Target, version: &str) -> String {
    let version = Some(version.parse().unwrap());
    export(&given(AnyModel::test_bed(name)), target, version, &options(target)).unwrap().text
}

#[test]
fn every_target_takes_every_model_or_says_why_not() {
    for &target in Target::VARIANTS {
        for name in ModelName::ALL {
            let found = export(&given(AnyModel::test_bed(name)), target, None, &options(target));
            match found {
                Ok(found) => {
                    for part in
                        ["frictionlab", "parameters.yaml", "SHA-256", "fitted to a.csv", "rms"]
                    {
                        assert!(
                            found.text.contains(part),
                            "{target} {name}: {part}: {}",
                            found.text
                        );
                    }
                    assert!(
                        found.text.contains("ACCEPTED ALTHOUGH nobody identified"),
                        "{}",
                        found.text
                    );
                    assert!(
                        !found.text.contains("NaN") && !found.text.contains(" inf"),
                        "{}",
                        found.text
                    );
                }
                Err(error) => {
                    let said = error.to_string();
                    assert!(
                        said.len() > 30 && said.lines().count() == 1,
                        "{target} {name}: {said}"
                    );
                }
            }
        }
    }
}

#[test]
fn mujoco_gets_what_each_version_takes() {
    let of = |version| text(ModelName::LuGre, Target::Mjcf, version);
    let old = of("3.6");
    assert!(old.contains("frictionloss=") && !old.contains("<dcmotor"), "{old}");
    assert!(old.contains("class=\"left/elbow_friction\""), "{old}");
    let first = of("3.7");
    assert!(first.contains("motorconst=\"1e-9\"") && !first.contains("input="), "{first}");
    assert_eq!(of("3.11").replace("3.11", "3.7"), first);
    let middle = of("3.12");
    assert!(middle.contains("input=\"none\" motorconst=\"1e-9\""), "{middle}");
    let new = of("4.0");
    assert!(new.contains("input=\"none\" motorconst=\"0\" resistance=\"1\""), "{new}");
    assert!(
        new.contains("lugre=\"16.469 0.249 0.0925 0.0994 0.1407\"") || new.contains("lugre=\""),
        "{new}"
    );
    assert!(new.contains("armature=\"0.001\"") && !new.contains("frictionloss="), "{new}");
    assert!(new.contains("It holds all of the identified friction."), "{new}");
    let cogged = Options {
        cogging: Some(Cogging { amplitude: 0.01, periods: 12.0, phase: 0.5 }),
        ..options(Target::Mjcf)
    };
    let model = AnyModel::test_bed(ModelName::LuGre);
    let file = export(&given(model), Target::Mjcf, None, &cogged).unwrap().text;
    assert!(file.contains("cogging=\"0.01 12.0 0.5\""), "{file}");
    // No pre-sliding is invented.
    let flat = text(ModelName::Stribeck, Target::Mjcf, "4.0");
    assert!(flat.contains("frictionloss=") && !flat.contains("<dcmotor"), "{flat}");
}

#[test]
fn units_are_those_of_the_target() {
    let model = AnyModel::test_bed(ModelName::CoulombViscous);
    let f_v = model.parameter("f_v").unwrap();
    let value = |text: &str, name: &str| -> f64 {
        let line = text.lines().find(|line| line.contains(name)).unwrap();
        line.rsplit(' ').next().unwrap().trim_end_matches(',').parse().unwrap()
    };
    let usd = text(ModelName::CoulombViscous, Target::UsdPhysx, "5.6");
    let coefficient = value(&usd, "physxJointAxis:angular:viscousFrictionCoefficient = ");
    assert!((coefficient / f_v.to_radians() - 1.0).abs() < 1e-6, "{usd}");
    assert!(usd.starts_with("#usda 1.0\n") && usd.contains("over \"left_elbow\""), "{usd}");
    let mut linear = given(model);
    linear.axis = Axis::Linear;
    let usd = export(&linear, Target::UsdNewton, None, &options(Target::UsdNewton)).unwrap().text;
    assert!((value(&usd, "newton:damping = ") / f_v - 1.0).abs() < 1e-6, "{usd}");
    let gains = Options {
        volts: Some(Volts { per_effort: 2.0, back_emf: 0.5 }),
        inertia: Some(0.01),
        accept_unidentified: true,
        ..Options::default()
    };
    let file = export(&given(model), Target::KsKvKa, None, &gains).unwrap().text;
    let tree: serde_json::Value = serde_json::from_str(&file).unwrap();
    assert!((tree["kV"].as_f64().unwrap() - (2.0 * f_v + 0.5)).abs() < 1e-6, "{file}");
    assert_eq!((tree["kA"].as_f64(), tree["kA_unit"].as_str()), (Some(0.02), Some("V s^2/rad")));
}

#[test]
fn a_file_of_bam_has_what_bam_reads() {
    let file = text(ModelName::Stribeck, Target::Bam, "1.0");
    let tree: serde_json::Value = serde_json::from_str(&file).unwrap();
    let model = AnyModel::test_bed(ModelName::Stribeck);
    let own = |name: &str| model.parameter(name).unwrap();
    assert_eq!((tree["model"].as_str(), tree["actuator"].as_str()), (Some("m2"), Some("sts3215")));
    assert_eq!(tree["friction_base"].as_f64(), Some(own("f_c")));
    assert_eq!(tree["friction_stribeck"].as_f64(), Some(own("f_s") - own("f_c")));
    assert_eq!((tree["kt"].as_f64(), tree["armature"].as_f64()), (Some(1.2), Some(0.001)));
}

#[test]
fn what_would_mislead_is_refused_until_it_is_accepted() {
    let lugre = AnyModel::test_bed(ModelName::LuGre);
    // One direction three times the other: a symmetric target is far off.
    let both = AnyModel::asymmetric(
        &lugre,
        &lugre.scaled("f_s", 3.0).unwrap().scaled("f_c", 3.0).unwrap(),
    );
    let both = given(both.unwrap());
    let asked = options(Target::Mjcf);
    let refused = export(&both, Target::Mjcf, None, &asked).unwrap_err();
    assert!(matches!(refused, Refusal::Misleading { .. }), "{refused}");
    assert!(refused.to_string().contains("each direction"), "{refused}");
    let accepted = Options { accept_error: true, ..asked };
    let found = export(&both, Target::Mjcf, None, &accepted).unwrap();
    assert!(found.text.contains("ACCEPTED ALTHOUGH the error in steady sliding"), "{}", found.text);
    // Firmware holds both directions.
    let header = export(&both, Target::CHeader, None, &options(Target::CHeader)).unwrap();
    assert_eq!((header.cost.swings.worst, header.lost.len()), (0.0, 0));

    let mut volts = given(lugre);
    volts.volts = true;
    let refused = export(&volts, Target::Urdf, None, &options(Target::Urdf));
    assert!(matches!(refused, Err(Refusal::Volts { .. })));
    assert!(export(&volts, Target::KsKvKa, None, &options(Target::KsKvKa)).is_ok());

    let refused = export(&given(lugre), Target::Urdf, None, &Options::default()).unwrap_err();
    assert!(refused.to_string().contains("--accept-unidentified"), "{refused}");
}

#[test]
fn friction_that_drives_is_refused_whatever_is_accepted() {
    let mut parameters = AnyParameters::test_bed(ModelName::TwoLine);
    let names: Vec<&str> = parameters.table().iter().map(|row| row.name).collect();
    // A line that falls below zero within the range.
    let falls = names.iter().any(|name| {
        parameters.set(name, -1.0) && {
            AnyModel::try_from(parameters).is_ok_and(|model| model.steady_state(2.9) < 0.0)
        }
    });
    let Ok(model) = AnyModel::try_from(parameters) else { return };
    if !falls {
        return;
    }
    let accepted = Options { accept_error: true, ..options(Target::Urdf) };
    let refused = export(&given(model), Target::Urdf, None, &accepted).unwrap_err();
    assert!(matches!(refused, Refusal::Negative { .. }), "{refused}");
}

#[test]
fn the_nearest_contact_is_the_models_own_where_it_can_be() {
    let found = |name, target| {
        export(&given(AnyModel::test_bed(name)), target, None, &options(target)).unwrap()
    };
    let exact = found(ModelName::LuGre, Target::Mjcf);
    assert_eq!((exact.cost.swings.worst, exact.version), (0.0, Version::new(4, 0)));
    assert!(
        matches!(exact.contact, Contact::LuGre(p) if p.sigma0 == AnyModel::test_bed(ModelName::LuGre).parameter("sigma0").unwrap())
    );
    let dahl = found(ModelName::Dahl, Target::Mjcf);
    assert!(dahl.cost.percent(dahl.cost.swings.rms) < 2.0, "{:?}", dahl.cost);
}
