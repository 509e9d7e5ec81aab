//! Documents made up, so that what is true is known.

use friction_ident::posterior::{Marginal, draw};
use friction_model::ModelName;
use serde_json::{Value, json};

use super::{Report, Table, compare, samples, table};

const NAMES: [&str; 3] = ["f_c", "f_s", "f_v"];
const TRUTH: [f64; 3] = [0.10, 0.12, 0.04];
const ERRORS: [f64; 3] = [0.002, 0.003, 0.001];
const CORRELATION: [[f64; 3]; 3] = [[1.0, 0.4, -0.8], [0.4, 1.0, -0.3], [-0.8, -0.3, 1.0]];

/// The document of a fit that found these values.
fn document(values: [f64; 3]) -> String {
    let row = |at: usize| {
        json!({
            "value": values[at], "unit": "N m", "standard_error": ERRORS[at], "identified": true,
            "interval_95": [values[at] - 1.96 * ERRORS[at], values[at] + 1.96 * ERRORS[at]],
        })
    };
    let held = json!({
        "value": 0.05, "unit": "rad/s", "standard_error": null, "identified": false,
        "interval_95": null,
    });
    json!({
        "format": "frictionlab-friction-identification",
        "speeds": [0.02, 2.0],
        "ranking": { "chosen": "stribeck" },
        "models": { "stribeck": {
            "parameters": { "f_c": row(0), "f_s": row(1), "f_v": row(2), "v_s": held },
            "correlation": { "names": NAMES, "matrix": CORRELATION },
        } },
    })
    .to_string()
}

fn report(values: [f64; 3]) -> Report {
    Report::read("made-up", &document(values)).unwrap()
}

/// What a fit of other recordings of the same joint would have found.
fn found(seed: u64) -> [f64; 3] {
    let marginals = [0, 1, 2].map(|at| Marginal {
        value: TRUTH[at],
        standard_error: ERRORS[at],
        interval: None,
    });
    let correlation = CORRELATION.map(|row| row.to_vec());
    let drawn = draw(&marginals, &correlation, 1, seed, |_| true).unwrap();
    [0, 1, 2].map(|at| drawn.rows[0][at])
}

#[test]
fn samples_have_the_errors_and_the_correlations_of_the_report() {
    let drawn = samples(report(TRUTH).model(None).unwrap(), 20_000, 3).unwrap();
    assert_eq!(drawn.names, ["f_c", "f_s", "f_v", "v_s"]);
    let mean = |of: &dyn Fn(&[f64]) -> f64| {
        drawn.rows.iter().map(|row| of(row)).sum::<f64>() / drawn.rows.len() as f64
    };
    for at in 0..3 {
        let deviation = mean(&|row| (row[at] - TRUTH[at]).powi(2)).sqrt();
        assert!((deviation / ERRORS[at] - 1.0).abs() < 0.03, "{at}: {deviation}");
    }
    let both = mean(&|row| (row[0] - TRUTH[0]) * (row[2] - TRUTH[2])) / (ERRORS[0] * ERRORS[2]);
    assert!((both + 0.8).abs() < 0.03, "{both}");
    assert!(drawn.rows.iter().all(|row| row[3] == 0.05) && drawn.models.len() == 20_000);
    assert!(drawn.notes[0].contains("v_s"), "{:?}", drawn.notes);
    let again = samples(report(TRUTH).model(None).unwrap(), 20_000, 3).unwrap();
    assert_eq!(again.rows, drawn.rows);
}

/// The document of a driven axis with this Coulomb friction.
fn axis(coulomb: f64) -> Report {
    let row = |value: f64, error: f64, unit: &str| {
        json!({
            "value": value, "standard_error": error, "half_width_95": 2.1 * error, "unit": unit,
            "white_error": error, "identifiable": true, "not_to_be_trusted": null,
        })
    };
    let document = json!({
        "format": "frictionlab-identification",
        "speeds": [0.02, 2.0],
        "symmetric": {
            "parameters": {
                "inertia": row(0.01, 1e-4, "kg m^2"), "viscous": row(0.04, 1e-3, "N m s/rad"),
                "coulomb": row(coulomb, 2e-3, "N m"), "offset": row(-0.01, 1e-3, "N m"),
            },
            "correlation": {
                "names": ["inertia", "viscous", "coulomb", "offset"],
                "matrix": [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, -0.7, 0.0], [0.0, -0.7, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]],
            },
        },
    });
    Report::read("axis", &document.to_string()).unwrap()
}

#[test]
fn axes_are_drawn_and_compared_as_friction_models_are() {
    let report = axis(0.1);
    let drawn = samples(report.model(None).unwrap(), 5000, 3).unwrap();
    assert_eq!(drawn.names, ["inertia", "viscous", "coulomb", "offset"]);
    let mean = |of: &dyn Fn(&[f64]) -> f64| {
        drawn.rows.iter().map(|row| of(row)).sum::<f64>() / drawn.rows.len() as f64
    };
    let both = mean(&|row| (row[2] - 0.1) * (row[1] - 0.04)) / (2e-3 * 1e-3);
    assert!((both + 0.7).abs() < 0.1, "{both}");
    // The friction of each sample is that of its row, without load and inertia.
    for (row, model) in drawn.rows.iter().zip(&drawn.models) {
        assert!((model.steady_state(1.0) - row[2] - row[1]).abs() < 1e-12);
    }
    assert!(!compare([&report, &axis(0.101)], None, None, 1).unwrap().differ);
    let found = compare([&report, &axis(0.12)], None, None, 1).unwrap();
    assert!(found.differ && found.answer().contains("coulomb"), "{}", found.answer());
    assert!(found.parameters.iter().all(|of| (of.differs == Some(true)) == (of.name == "coulomb")));
    assert!(table(&drawn, Table::IsaacLab, "axis", "elbow").unwrap().contains("ELBOW_FRICTION"));
    // A model of friction is none of an axis.
    assert!(report.model(Some(ModelName::LuGre)).is_err());
}

#[test]
fn reports_of_one_joint_are_called_different_as_often_as_is_said() {
    let pairs = 200;
    let wrongly = (0..pairs)
        .filter(|pair| {
            let [a, b] = [2 * pair, 2 * pair + 1].map(|seed| report(found(seed)));
            compare([&a, &b], None, None, 9).unwrap().differ
        })
        .count();
    // Five in a hundred; more than 20 of 200 happen once in 500 times.
    assert!((2..=20).contains(&wrongly), "{wrongly} of {pairs}");
}

#[test]
fn a_joint_that_changed_is_told_apart_and_by_what() {
    let (before, worn) = (report(TRUTH), report([0.10, 0.12, 0.048]));
    let found = compare([&before, &worn], None, None, 1).unwrap();
    assert!(found.differ && found.probability_of_chance < 0.001);
    let of = |name: &str| found.parameters.iter().find(|row| row.name == name).unwrap();
    assert_eq!((of("f_v").differs, of("f_c").differs), (Some(true), Some(false)));
    assert_eq!(of("f_v").difference, 0.048 - 0.04);
    let fastest = found.torque.last().unwrap();
    assert!(fastest.differs && (fastest.difference - 0.016).abs() < 1e-12);
    assert!(found.answer().starts_with("They differ (Stribeck)"), "{}", found.answer());
    let same = compare([&before, &before], None, None, 1).unwrap();
    assert!(!same.differ && same.answer().starts_with("They cannot be told apart"));
    assert!(same.terminal().lines().count() > 15);
}

#[test]
fn tables_hold_what_the_simulators_take() {
    let drawn = samples(report(TRUTH).model(None).unwrap(), 5, 3).unwrap();
    let csv = table(&drawn, Table::Csv, "x", "joint").unwrap();
    assert!(csv.starts_with("f_c,f_s,f_v,v_s\n") && csv.lines().count() == 6);
    let isaac = table(&drawn, Table::IsaacLab, "x", "left elbow").unwrap();
    let row = &drawn.rows[0];
    assert!(isaac.contains(&format!("({:?}, {:?}, {:?})", row[1], row[0], row[2])), "{isaac}");
    assert!(isaac.contains("LEFT_ELBOW_FRICTION = (") && isaac.contains("\"left elbow\""));
    let mjlab = table(&drawn, Table::Mjlab, "x", "elbow").unwrap();
    assert!(mjlab.contains("dof_frictionloss") && !mjlab.contains('{'), "{mjlab}");
}

#[test]
fn every_model_takes_back_what_its_document_tells() {
    for name in ModelName::ALL {
        let parameters = friction_model::AnyParameters::test_bed(name);
        let mut rows = serde_json::Map::new();
        for row in parameters.table() {
            let values = parameters.values(row.name);
            for (at, value) in values.iter().enumerate() {
                let list = values.len() > 1;
                let named = if list { format!("{}[{at}]", row.name) } else { row.name.to_owned() };
                let of = json!({ "value": value, "unit": "", "standard_error": null,
                    "interval_95": null, "identified": false });
                rows.insert(named, of);
            }
        }
        let document = json!({
            "format": "frictionlab-friction-identification", "speeds": null,
            "models": { name.as_str(): { "parameters": rows, "correlation": null } },
        });
        let report = Report::read("made-up", &document.to_string()).unwrap();
        let reported = report.model(Some(name)).unwrap();
        let values: Vec<f64> = reported.rows.iter().map(|row| row.value).collect();
        let model = reported.with(&values).unwrap();
        assert_eq!(model, friction_model::AnyModel::test_bed(name), "{name}");
    }
}

#[test]
fn what_cannot_be_used_is_named() {
    let said = |text: &str| Report::read("a.json", text).unwrap_err().to_string();
    assert!(said("{").contains("a.json: expected the identification.json"));
    assert!(said(r#"{"format": "frictionlab-drive"}"#).contains("frictionlab-drive"));
    let report = report(TRUTH);
    let none = report.model(Some(ModelName::Dahl)).unwrap_err().to_string();
    assert!(none.contains("`dahl` was not identified; there is stribeck"), "{none}");
    let mut tree: Value = serde_json::from_str(&document(TRUTH)).unwrap();
    let mut without = tree.clone();
    without["models"]["stribeck"]["parameters"]["f_v"]["value"] = Value::Null;
    let without = Report::read("c.json", &without.to_string()).unwrap();
    let error = samples(without.model(None).unwrap(), 5, 1).unwrap_err().to_string();
    assert!(error.contains("f_v of stribeck has no value"), "{error}");
    tree["speeds"] = Value::Null;
    let silent = Report::read("b.json", &tree.to_string()).unwrap();
    let error = compare([&report, &silent], None, None, 1).unwrap_err().to_string();
    assert!(error.contains("--speeds"), "{error}");
    assert!(compare([&report, &silent], None, Some([0.1, 1.0]), 1).is_ok());
    assert!(compare([&report, &silent], None, Some([1.0, 0.1]), 1).is_err());
}
