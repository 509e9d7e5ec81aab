//! The experiment runner asked by the real rclpy on another PC: action, services, status, refusals,
//! cancelling, SIGINT.

use std::path::Path;

use msgs::friction_msgs::RunExperimentResult;
use msgs::sensor_msgs::JointState;
use recording::bag::BagReader;
use serde_json::{Value, json};
use tests::network::{ORDINARY_MTU, Place};
use tests::python;

fn text<'a>(report: &'a Value, field: &str) -> &'a str {
    report[field].as_str().unwrap_or_else(|| panic!("{field} is no text in {report}"))
}

/// The bag of a result, which must be whole.
fn bag(result: &Value) -> BagReader {
    BagReader::open(Path::new(text(result, "bag_path"))).expect("a whole bag")
}

fn session(place: Place) -> (tempfile::TempDir, Value) {
    let python = python::interpreter("rclpy");
    let _turn = tests::network::turn();
    let mut command = place.command();
    let folder = tempfile::tempdir().expect("a folder");
    let (result, runs) = (folder.path().join("report.json"), folder.path().join("runs"));
    let program = tests::frictionlab();
    let output = command
        .arg(&python)
        .arg(python::script("runner_session.py"))
        .arg(&result)
        .arg(&runs)
        .arg(program.get_program())
        .arg("serve")
        .arg("--runs")
        .arg(&runs)
        .env("PYTHONPATH", tests::checkout().join("python"))
        .env("ROS_DOMAIN_ID", "74")
        .env("ROS_LOG_DIR", folder.path().join("log"))
        .output()
        .expect("unshare starts");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let report = std::fs::read_to_string(&result).expect("the session's report");
    (folder, serde_json::from_str(&report).expect("JSON"))
}

#[tests::needs(rclpy, machines)]
#[test]
fn rclpy_runs_cancels_and_is_refused() {
    for place in Place::of_tier(Place::TwoPcs(ORDINARY_MTU)) {
        let (_folder, report) = session(place);
        ready_and_listed(&report);
        bad_requests_are_answered(&report);
        one_runs_to_its_end(&report);
        a_bag_is_identified(&report);
        the_python_package_runs_one_too(&report);
        one_at_a_time(&report);
        it_leaves_when_it_is_told(&report);
    }
}

fn ready_and_listed(report: &Value) {
    assert_eq!(text(&report["first_status"], "stage"), "idle");
    let listed = report["list"]["experiments"].as_array().expect("a list");
    let all = listed.iter().find(|experiment| experiment["name"] == "all").expect("the whole job");
    assert!(all["duration"].as_f64().expect("a duration") > 24_000.0);
    let parameters = all["parameters"].as_array().expect("parameters");
    assert!(
        parameters
            .iter()
            .any(|parameter| parameter["name"] == "seed" && parameter["default_value"] == "1")
    );
    assert_eq!(report["nothing_to_abort"]["success"], false);
}

fn bad_requests_are_answered(report: &Value) {
    for (which, said) in [
        ("unknown", "velocity-tracking"),
        ("model", "newton"),
        ("folder", "a_file"),
        ("outside", "an absolute path is not taken"),
        ("above", "`..` is not taken"),
        ("file", "an absolute path is not taken"),
        ("endless", "--inputs"),
        ("rig", "--allow-rigs"),
        ("card", "--allow-rigs"),
        ("range", "voltage_limit"),
        ("option", "voltage-limit"),
    ] {
        let answer = &report["bad"][which];
        assert_eq!(answer["outcome"], RunExperimentResult::BAD_REQUEST, "{which}: {answer}");
        assert_eq!(answer["success"], false, "{which}");
        assert_eq!(answer["status"], report["codes"]["ABORTED"], "{which}");
        assert!(text(answer, "message").contains(said), "{which}: {answer}");
    }
    for (which, said) in [("start", "jump"), ("identify", "nowhere/bag")] {
        assert_eq!(report["bad"][which]["success"], false);
        assert!(text(&report["bad"][which], "message").contains(said), "{which}");
    }
    assert_eq!(report["after_bad"], json!(["a_file"]), "nothing was written");
}

fn one_runs_to_its_end(report: &Value) {
    let complete = &report["complete"];
    assert_eq!(complete["status"], report["codes"]["SUCCEEDED"], "{complete}");
    assert_eq!(complete["outcome"], RunExperimentResult::SUCCEEDED);
    assert_eq!(complete, &report["asked_again"], "a result stays");
    for file in ["report", "parameters_file"] {
        assert!(Path::new(text(complete, file)).is_file(), "{file}");
    }
    assert!(
        !bag(complete).messages::<JointState>("/joint_states").expect("joint states").is_empty()
    );
    // The plant's Coulomb level is .0925 N m.
    let parameters = complete["parameters"].as_array().expect("parameters");
    let f_c = parameters.iter().find(|parameter| parameter["name"] == "f_c").expect("f_c");
    assert!((f_c["value"].as_f64().expect("a number") - 0.0925).abs() < 0.002, "{f_c}");
    assert!(f_c["standard_error"].as_f64().expect("a number") < 0.002, "{f_c}");
    let feedback = report["feedback"].as_array().expect("a list");
    let progress: Vec<f64> =
        feedback.iter().filter_map(|message| message["progress"].as_f64()).collect();
    assert!(progress.len() >= 2, "{} feedbacks", progress.len());
    assert!(progress.windows(2).all(|pair| pair[0] <= pair[1]), "{progress:?}");
    assert!(progress.iter().all(|done| (0.0..=1.0).contains(done)));
    let after = &report["after_complete"];
    assert_eq!((text(after, "experiment"), &after["progress"]), ("", &json!(1.0)), "{after}");
    assert!(text(after, "message").contains("constant-velocity-1 is complete"), "{after}");
}

fn a_bag_is_identified(report: &Value) {
    let found = &report["identify"];
    assert_eq!(found["success"], true, "{found}");
    let fits = found["fits"].as_array().expect("fits");
    assert_eq!(fits.len(), 2);
    // The simplest of those that cannot be told from the best.
    let chosen =
        fits.iter().position(|fit| fit["model"] == found["model"]).expect("one of the two");
    assert!(chosen == 0 || fits[chosen]["tie"] == true, "{fits:?}");
    let f_c = found["parameters"]
        .as_array()
        .and_then(|all| all.iter().find(|p| p["model"] == "stribeck" && p["name"] == "f_c"))
        .expect("the Coulomb level");
    assert!((f_c["value"].as_f64().expect("a number") - 0.0925).abs() < 0.003, "{f_c}");
    assert!(Path::new(text(found, "parameters_file")).is_file());
    assert!(Path::new(text(found, "report")).is_file());
}

fn the_python_package_runs_one_too(report: &Value) {
    let client = &report["client"];
    assert_eq!(client["code"], 0, "{client}");
    assert!(text(client, "out").contains("velocity-tracking-1 is complete"), "{client}");
    assert!(text(client, "out").contains("mse_improvement"), "{client}");
    assert_eq!(report["bad_client"]["code"], 2);
    assert!(
        text(&report["bad_client"], "err").contains("there is no option `velocity`"),
        "{report}"
    );
}

fn one_at_a_time(report: &Value) {
    let late = &report["while_running"];
    assert_eq!(text(late, "experiment"), "position-tracking", "{late}");
    assert!(!text(late, "bag_path").is_empty());
    assert_eq!(report["second"]["outcome"], RunExperimentResult::BUSY);
    assert!(text(&report["second"], "message").contains("position-tracking-1 runs"));
    assert_eq!(report["second_start"]["success"], false);
    assert!(text(&report["second_start"], "message").contains("position-tracking-1 runs"));

    assert_eq!(report["cancel_answer"]["return_code"], 0);
    assert_eq!(report["cancel_answer"]["goals"], 1);
    let cancelled = &report["cancelled"];
    assert_eq!(cancelled["status"], report["codes"]["CANCELED"]);
    assert_eq!(cancelled["outcome"], RunExperimentResult::CANCELED);
    bag(cancelled);
    assert_eq!(report["cancel_again"], 3, "the goal has ended");

    // Not even its first run came to its end.
    let slow = &report["cancelled_in_real_time"];
    assert_eq!(slow["outcome"], RunExperimentResult::CANCELED, "{slow}");
    assert!(text(slow, "message").contains("after 0 s of rig time"), "{slow}");
    bag(slow);

    assert_eq!(report["started"]["success"], true);
    assert_eq!(report["abort"]["success"], true);
    assert!(text(&report["after_abort"], "message").contains("was stopped before its end"));

    assert_eq!(report["preempted"]["status"], report["codes"]["ABORTED"]);
    assert_eq!(report["preempted"]["outcome"], RunExperimentResult::CANCELED);
    assert_eq!(report["preempting"]["status"], report["codes"]["SUCCEEDED"]);
    let seen: Vec<i64> = report["goal_statuses"]
        .as_array()
        .expect("a list")
        .iter()
        .filter_map(Value::as_i64)
        .collect();
    for code in ["SUCCEEDED", "CANCELED", "ABORTED"] {
        assert!(
            seen.contains(&report["codes"][code].as_i64().expect("a code")),
            "{code} in {seen:?}"
        );
    }
}

fn it_leaves_when_it_is_told(report: &Value) {
    let interrupted = &report["interrupted"];
    assert_eq!(interrupted["outcome"], RunExperimentResult::CANCELED, "{interrupted}");
    bag(interrupted);
    assert_eq!(report["exit_code"], 0);
    assert_eq!(report["gone"], true, "the node is still in the graph");
}
