//! A commission asked for by the real rclpy: feedback, result, cancelled, gone on with; on the
//! simulated rig, and on nodes that run.

use std::path::Path;

use msgs::friction_msgs::RunExperimentResult;
use serde_json::Value;
use tests::network::namespaced;
use tests::python;

fn text<'a>(report: &'a Value, field: &str) -> &'a str {
    report[field].as_str().unwrap_or_else(|| panic!("{field} is no text in {report}"))
}

fn session(folder: &Path) -> Value {
    let _turn = tests::network::turn();
    let result = folder.join("report.json");
    let output = namespaced()
        .arg(python::interpreter("rclpy"))
        .arg(python::script("commission_session.py"))
        .arg(&result)
        .arg(tests::node_programs())
        .arg(folder.join("runs"))
        .arg(tests::frictionlab().get_program())
        .env("PYTHONPATH", tests::checkout().join("python"))
        .env("ROS_DOMAIN_ID", "83")
        .env("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
        .env("ROS_LOG_DIR", folder.join("log"))
        .output()
        .expect("unshare starts");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_str(&std::fs::read_to_string(&result).expect("a report")).expect("JSON")
}

#[tests::needs(rclpy, namespace)]
#[test]
fn a_commission_is_asked_for_cancelled_and_gone_on_with() {
    let folder = tempfile::tempdir().expect("a folder");
    let report = session(folder.path());
    let simulated = &report["simulated"];
    complete(&simulated["complete"]);
    let feedback = simulated["feedback"].as_array().expect("feedback");
    let of = |message: &Value| message["progress"].as_f64().expect("a number");
    assert!(!feedback.is_empty());
    assert!(feedback.iter().all(|message| (0.0..=1.0).contains(&of(message))), "{feedback:?}");
    cancelled_and_gone_on(simulated);
    for (which, said) in [
        ("rig", "--allow-rigs"),
        ("models", "no models"),
        ("option", "minutes"),
        ("minutes", "from 4 to 120"),
        ("folder", "nowhere"),
        ("wish", "f_c:2%"),
    ] {
        let answer = &simulated["bad"][which];
        assert_eq!(answer["outcome"], RunExperimentResult::BAD_REQUEST, "{which}: {answer}");
        assert!(text(answer, "message").contains(said), "{which}: {answer}");
    }
    let listed = &simulated["listed"][0];
    let parameters = listed["parameters"].as_array().expect("parameters");
    let has = |name: &str| parameters.iter().any(|parameter| parameter["name"] == name);
    assert!(has("want") && has("travel") && !has("yes") && !has("trial"), "{listed}");

    let nodes = &report["nodes"];
    let cancelled = &nodes["cancelled"];
    assert_eq!(cancelled["outcome"], RunExperimentResult::CANCELED, "{cancelled}");
    assert!(text(cancelled, "message").contains("--resume"), "{cancelled}");
    assert_eq!(nodes["volts"], 0.0, "{nodes}");
    let stages = nodes["stages"].as_array().expect("stages");
    let met = stages.iter().filter_map(Value::as_str).any(|stage| stage.starts_with("meet"));
    assert!(met, "{stages:?}");
    if !nodes["complete"].is_null() {
        complete(&nodes["complete"]);
        let feedback = nodes["feedback"].as_array().expect("feedback");
        let learnt = |message: &Value| text(message, "stage").contains("f_c ±");
        assert!(feedback.iter().any(learnt), "nothing is said of what is learnt");
    }
    assert_eq!(report["exit_code"], 0);
}

/// To its end, with what it handed over.
fn complete(result: &Value) {
    assert_eq!(result["outcome"], RunExperimentResult::SUCCEEDED, "{result}");
    for file in ["report", "parameters_file"] {
        assert!(Path::new(text(result, file)).is_file(), "{file}: {result}");
    }
    // The test bed's Coulomb level is 0.448 V.
    let parameters = result["parameters"].as_array().expect("parameters");
    let f_c = parameters.iter().find(|parameter| parameter["name"] == "f_c").expect("f_c");
    let value = f_c["value"].as_f64().expect("a number");
    assert!((value - 0.448).abs() < 0.02, "{f_c}");
}

/// One that was over before the wish came is no failure.
fn cancelled_and_gone_on(simulated: &Value) {
    let cancelled = &simulated["cancelled"];
    if cancelled["outcome"] == RunExperimentResult::SUCCEEDED {
        return;
    }
    assert_eq!(cancelled["outcome"], RunExperimentResult::CANCELED, "{cancelled}");
    assert_eq!(text(cancelled, "parameters_file"), "", "{cancelled}");
    if !simulated["resumed"].is_null() {
        complete(&simulated["resumed"]);
        assert_eq!(simulated["resumed"]["run_id"], cancelled["run_id"]);
    }
}
