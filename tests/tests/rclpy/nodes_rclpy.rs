//! The executables `rig_driver`, `friction_observer` and `controller` before the real rclpy: on a
//! machine with loopback alone, on a PC with a network card, and on another PC.

use controller::ControlMode;
use experiment_runner::compensation::Means;
use experiment_runner::test_bed::TestBed;
use experiment_runner::waveform::Waveform;
use friction_model::{AnyModel, ModelName};
use ros_node::{Arguments, Named, ParameterValue};
use serde_json::{Value, json};
use tests::network::{ORDINARY_MTU, Place, peer, session, session_at};
use tests::python::Distribution;

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or(f64::NAN)
}

fn text(value: &Value) -> &str {
    value.as_str().unwrap_or_default()
}

/// Every program ended with code 0, in the time that the session gives it after its signal. How
/// long it took is told: it depends on what else the machine does.
fn assert_ended(exits: &Value) {
    let exits = exits.as_array().expect("a list");
    assert!(!exits.is_empty());
    for exit in exits {
        assert_eq!(exit[0], 0, "{exit}");
        println!("ended {:.2} s after its signal", number(&exit[1]));
    }
}

/// Root mean square of the measured error of the same loop in one process, in lock-step.
fn error_of_one_process(amplitude: f64, angular_frequency: f64, seconds: f64) -> f64 {
    let bed = TestBed {
        simulation: Default::default(),
        friction: AnyModel::test_bed(ModelName::Proposed),
        controller: Default::default(),
        estimator: Default::default(),
    };
    let reference = Waveform::SineVelocity { amplitude, angular_frequency };
    let observer = AnyModel::test_bed(ModelName::Proposed);
    let mut control = bed
        .control_loop(ControlMode::Velocity, reference, &observer, Some(Means::Feedback), 1, 0)
        .expect("a loop");
    let mut step = || control.step().expect("the simulated rig obeys").command.error;
    for _ in 0..1000 {
        step();
    }
    let cycles = (seconds * 1000.0) as u32;
    let sum: f64 = (0..cycles).map(|_| step().powi(2)).sum();
    (sum / f64::from(cycles)).sqrt()
}

/// The error over DDS is that of one process but for a reference that comes in steps of a
/// millisecond, late, from an ordinary Python process, and for a cycle or more between measurement
/// and voltage. Measured on two busy cores: .092 to .098 rad/s over DDS, .098 rad/s in one process.
#[tests::needs(rclpy, namespace)]
#[test]
fn three_processes_follow_a_reference_that_rclpy_publishes() {
    let report = session("loop_session.py", &["6"]);
    let one = error_of_one_process(1.5, 3.0, 6.0);
    let many = number(&report["rms_error"]);
    eprintln!(
        "root mean square of the error: {many:.4} rad/s over DDS, {one:.4} rad/s in one process"
    );
    eprintln!(
        "age of the measurement behind each voltage, p50 and p99 of each second [us]: {}",
        report["ages"]
    );
    assert!(number(&report["heard"]) > 1000.0, "{report}");
    let commands = report["commands"].as_array().expect("one a second");
    assert!(
        commands.len() >= 3 && commands.iter().all(|a_second| number(a_second) > 800.0),
        "1 kHz: {report}"
    );
    assert!((number(&report["rms_reference"]) - 1.5 / 2f64.sqrt()).abs() < 0.1, "{report}");
    assert!(many < 1.5 * one + 0.02, "{many} over DDS, {one} in one process");
    // How many voltages hold an estimate hangs on what else the machine does: on a busy one 71 in 100
    // did, on an idle one nearly all.
    let used = number(&report["friction_used"]) / number(&report["heard"]);
    eprintln!("{:.0} in 100 voltages hold an estimate", 100.0 * used);
    assert!(used > 0.25, "the estimate is compensated: {report}");
    assert!(
        number(&report["at_rest"]) < 0.05,
        "without a reference the shaft comes to rest: {report}"
    );
    assert_eq!(report["faults"], 0);
    assert_ended(&report["exit"]);
}

#[tests::needs(rclpy, machines)]
#[test]
fn parameters_are_listed_set_described_and_refused_with_reasons() {
    for place in Place::of_tier(Place::TwoPcs(ORDINARY_MTU)) {
        let report = session_at(place, Distribution::Kilted, "parameters_session.py", &[]);
        let names: Vec<&str> =
            report["names"].as_array().expect("names").iter().map(text).collect();
        for name in [
            "model",
            "technique",
            "use_sim_time",
            "proposed.f_s",
            "lugre.sigma0",
            "gms.f_c",
            "drive.gain",
        ] {
            assert!(names.contains(&name), "{name} is not among {names:?}");
        }
        let lugre = ["delta", "f_c", "f_s", "f_v", "sigma0", "sigma1", "v_s"]
            .map(|name| format!("lugre.{name}"));
        assert_eq!(report["lugre"], json!(lugre));
        assert!(
            report["shallow"]
                .as_array()
                .is_some_and(|all| all.iter().all(|name| !text(name).contains('.')))
        );
        assert_eq!(report["given"], json!(["lugre", 1.25]));
        assert_eq!(report["unknown"], json!([null]));
        assert_eq!(report["types"], json!([4, 3, 0, 1]));

        let described = &report["described"];
        assert_eq!(described["sigma0"][0], 3);
        assert!(text(&described["sigma0"][1]).contains("[N/m or N m/rad]"));
        assert_eq!(described["sigma0"][2], json!([]), "no limit is shown as none");
        assert_eq!(described["sigma0"][3], "above 0");
        assert!(text(&described["model"][2]).starts_with("one of coulomb, "));
        assert_eq!(
            (&described["period_read_only"], &described["missing"]),
            (&json!(true), &json!(0))
        );

        assert_eq!(report["good"], json!([[true, ""]]));
        assert_eq!(report["read_back"], true);
        assert_eq!(report["events"], json!([["/friction_observer", "lugre.sigma0", 2.0]]));
        for (case, reason) in [
            ("type", "write 3.0"),
            ("range", "above 0, but is -1"),
            ("nan", "NaN"),
            ("between", "at most f_s"),
            ("choice", "`lugri`"),
            ("deleted", "cannot be deleted"),
            ("undeclared", "was not declared"),
            ("read_only", "read-only"),
            ("controller", "0 to 2, but is 3"),
        ] {
            let answer = &report["refused"][case];
            assert!(answer[0] == false && text(&answer[1]).contains(reason), "{case}: {answer}");
        }
        // One by one the good half counts, atomically none does.
        assert_eq!((&report["half"][0][0], &report["half"][1][0]), (&json!(true), &json!(false)));
        assert_eq!(
            (&report["injection"], &report["injection_after_bad"]),
            (&json!(1.0), &json!(1.0))
        );
        assert_eq!(report["atomic_bad"][0], false);
        assert_eq!(report["atomic_good"][0], true, "two levels that only fit together: {report}");
        assert_eq!(report["levels"], json!([3.0, 2.0]));
        assert!(
            number(&report["loaded"][0]) > 100.0 && report["loaded"][1] == json!([]),
            "{}",
            report["loaded"]
        );

        assert_eq!(report["rosout"], json!(["controller", "friction_observer"]));
        assert!(text(&report["warned"][0]).contains("no_such"));
        let [file, line] = [0, 1].map(|at| &report["written_at"][0][at]);
        assert!(text(file).ends_with("services.rs") && number(line) > 0.0, "{file}, line {line}");
        assert_eq!(report["sim_time_set"][0], true);
        assert_eq!(report["sim_time_seen"], true, "events carry the time of /clock");
        assert_ended(&report["exit"]);
    }
}

#[tests::needs(rclpy, machines)]
#[test]
fn the_rig_moves_in_active_only_and_its_states_are_those_of_rcl() {
    for place in Place::of_tier(Place::OnePc) {
        let report = session_at(place, Distribution::Kilted, "lifecycle_session.py", &[]);
        // rclpy's own managed node is the peer.
        assert_eq!(report["same_states"], true);
        assert_eq!(report["graph"][0], report["graph"][1]);
        for state in ["unconfigured", "inactive", "active"] {
            assert_eq!(report["available"][state][0], report["available"][state][1], "{state}");
        }
        assert_eq!(
            report["walk"],
            json!(["unconfigured", [true, "inactive"], [true, "active"], [true, "inactive"]])
        );
        assert_eq!((&report["bad_label"], &report["bad_number"]), (&json!(false), &json!(false)));
        let still = json!([0.0, 0.0, false]);
        let stopped = json!([0.0, 0.0, true]);
        let moves = |what: &str| number(&report[what][0]) > 2.5 && number(&report[what][1]) > 0.5;
        assert_eq!((&report["inactive"], &report["deactivated"]), (&still, &still));
        assert!(moves("active") && moves("before_stop") && moves("moves_again"), "{report}");

        assert!(
            report["zero"][0] == true && report["zero_while_active"][0] == false,
            "{}",
            report["zero"]
        );
        assert_eq!((&report["stop"][0], &report["stopped"]), (&json!(true), &stopped));
        assert_eq!(
            (&report["state_stopped"], &report["activate_stopped"]),
            (&json!("inactive"), &json!(false))
        );
        assert_eq!(
            (&report["clear"][0], &report["state_cleared"]),
            (&json!(true), &json!("unconfigured"))
        );
        assert_eq!(report["cleared"], 0, "unconfigured, it measures nothing");

        // A voltage that is no number latches a fault; garbage does nothing; what is old does
        // nothing; silence stops the motor.
        assert_eq!((&report["nan"], &report["state_nan"]), (&stopped, &json!("inactive")));
        assert_eq!(
            (&report["clear_nan"][0], &report["again"]),
            (&json!(true), &json!([true, "active"]))
        );
        assert_eq!(report["after_garbage"][0], "active", "{}", report["exit"][2]);
        assert!(
            number(&report["after_garbage"][1][0]) > 2.5,
            "the garbage does not disturb the commands"
        );
        assert!(number(&report["old"][0]) == 0.0, "{}", report["old"]);
        assert_eq!((&report["silent"], &report["state_silent"]), (&stopped, &json!(true)));
        let said = text(&report["exit"][2]);
        for line in [
            "command not finite",
            "command lost",
            "emergency stop",
            "were no friction_msgs/msg/MotorVoltage",
        ] {
            assert!(said.contains(line), "`{line}` is not in the log:\n{said}");
        }

        assert_eq!(report["shutdown"], json!([true, "finalized"]));
        let events = report["events"].as_array().expect("events");
        assert_eq!(events.first(), Some(&json!([1, "unconfigured", "configuring"])));
        assert_eq!(events.last(), Some(&json!([50, "shuttingdown", "finalized"])));
        // SIGINT: gone from the graph, and ended, within two seconds.
        assert!(
            report["leaving"][0] == true && report["leaving"][1] == true,
            "{}",
            report["leaving"]
        );
        assert!(
            number(&report["leaving"][2]) < 2.0 && number(&report["exit"][1]) < 2.0,
            "{}",
            report["leaving"]
        );
        assert_eq!(report["exit"][0], 0);
    }
}

#[tests::needs(rclpy, machines)]
#[test]
fn two_rigs_share_a_domain_by_their_namespaces_and_names_can_be_remapped() {
    for place in Place::of_tier(Place::OnePcOnItsNetwork) {
        let report = session_at(place, Distribution::Kilted, "namespace_session.py", &[]);
        assert_eq!(report["moving"], true, "{report}");
        // The lag compensator leaves an error under friction that is only half compensated.
        assert!(
            (number(&report["velocity"]["/axis_1"]) - 1.0).abs() < 0.35,
            "{}",
            report["velocity"]
        );
        assert!(
            (number(&report["velocity"]["/axis_2"]) + 2.0).abs() < 0.35,
            "{}",
            report["velocity"]
        );
        let nodes: Vec<&str> =
            report["nodes"].as_array().expect("nodes").iter().map(text).collect();
        for axis in ["/axis_1", "/axis_2"] {
            for node in ["rig_driver", "friction_observer", "controller"] {
                assert!(nodes.contains(&format!("{axis}/{node}").as_str()), "{nodes:?}");
            }
        }
        assert_eq!(report["absolute"], json!([]), "nothing of a rig in a namespace is outside it");
        assert_eq!(report["scale"], json!([0.5, 0.75]));
        assert_eq!(
            report["services"],
            json!(["/axis_1/rig_driver/emergency_stop", "/axis_2/rig_driver/emergency_stop"])
        );
        assert_ended(&report["exit"]);
        assert_eq!(report["renamed"], json!([1.75, true]));
        for refused in report["refused"].as_array().expect("refusals") {
            let said = text(&refused[2]);
            assert_eq!(refused[1], 2, "{refused}");
            let named = text(&refused[0]).split(":=").next().unwrap_or_default();
            assert!(said.contains(named), "{named} is not named in: {said}");
        }
    }
}

/// What our side makes of a case of `arguments_peer.py`.
fn ours(case: &Value) -> Value {
    let strings = |list: &Value| -> Vec<String> {
        list.as_array().expect("a list").iter().map(|entry| text(entry).to_owned()).collect()
    };
    let given = std::iter::once("--ros-args".to_owned()).chain(strings(&case["arguments"]));
    let Ok(arguments) = Arguments::parse(given) else { return Value::Null };
    let node = arguments.remaps.node(text(&case["node"]), "/").expect("a name");
    let resolve = |named, names: &Value| -> Vec<String> {
        strings(names)
            .iter()
            .map(|name| arguments.remaps.resolve(&node, named, name).expect("a name"))
            .collect()
    };
    let parameters: serde_json::Map<String, Value> = arguments
        .overrides(&node.qualified())
        .into_iter()
        .map(|(name, value)| {
            let told = match value {
                ParameterValue::Boolean(value) => json!(["BOOL", value]),
                ParameterValue::Integer(value) => json!(["INTEGER", value]),
                ParameterValue::Double(value) => json!(["DOUBLE", value]),
                ParameterValue::String(value) => json!(["STRING", value]),
                ParameterValue::BooleanArray(value) => json!(["BOOL_ARRAY", value]),
                ParameterValue::IntegerArray(value) => json!(["INTEGER_ARRAY", value]),
                ParameterValue::DoubleArray(value) => json!(["DOUBLE_ARRAY", value]),
                ParameterValue::StringArray(value) => json!(["STRING_ARRAY", value]),
                other => panic!("{other:?} does not come from a command line"),
            };
            (name, told)
        })
        .collect();
    json!({
        "node": node.qualified(),
        "topics": resolve(Named::Topic, &case["topics"]),
        "services": resolve(Named::Service, &case["services"]),
        "parameters": parameters,
    })
}

#[tests::needs(rclpy, namespace)]
#[test]
fn arguments_mean_what_the_real_rcl_makes_of_them() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("parameters.yaml");
    let yaml = "\
/**:
  ros__parameters: {a: 1, all: true}
left:
  arm:
    ros__parameters:
      a: 2
      nested: {gain: 1.5, list: [1.0, 2.5], deeper: {name: 'x y', on: off}}
/left/*:
  ros__parameters: {b: star, words: [p, q], hex: 0x10}
/other:
  ros__parameters: {a: 9}
";
    std::fs::write(&file, yaml).expect("the folder can be written");
    let file = file.to_str().expect("a plain path");
    let case = |node: &str, arguments: &[&str]| {
        json!({
            "node": node,
            "arguments": arguments,
            "topics": ["foo", "/foo", "~/foo", "joint_states"],
            "services": ["foo", "~/foo"],
        })
    };
    let cases = json!([
        case("n", &[]),
        case(
            "controller",
            &["-r", "__ns:=/left", "-r", "__node:=arm", "-p", "arm:a:=1", "-p", "b:=yes"]
        ),
        case("n", &["-r", "foo:=bar", "-r", "/foo:=/second", "-r", "n:~/foo:=/own"]),
        case("n", &["-r", "rosservice://foo:=/t", "-r", "rostopic:///joint_states:=~/js"]),
        case("n", &["-r", "m:foo:=bar", "-r", "__name:=k", "-r", "k:foo:=baz", "-r", "n:foo:=no"]),
        case(
            "n",
            &[
                "-p", "a:=010", "-p", "b:=0x1F", "-p", "c:=1e3", "-p", "d:=On", "-p", "e:='1'",
                "-p", "f:=08"
            ]
        ),
        case(
            "n",
            &[
                "-p",
                "g:=1.",
                "-p",
                "h:=yEs",
                "-p",
                "i:=99999999999999999999",
                "-p",
                "j:=!!str 1",
                "-p",
                "k:=-7"
            ]
        ),
        case(
            "n",
            &["-p", "a:=[1, 2]", "-p", "b:=[on, no]", "-p", "c:=[x, 'y']", "-p", "d:=[0.5, .25]"]
        ),
        case("n", &["-p", "a:=1", "-p", "n:a:=2", "-p", "a:=3"]),
        case("n", &["-p", "n:a:=1", "-p", "a:=2"]),
        case("arm", &["-r", "__ns:=/left", "--params-file", file]),
        case(
            "arm",
            &["-r", "__ns:=/left", "-p", "a:=5", "--params-file", file, "-p", "all:=false"]
        ),
        case("other", &["--params-file", file, "-p", "other:a:=4"]),
        // Refused by both.
        case("n", &["-p", "a:=[1, 2.0]"]),
        case("n", &["-p", "a:={b: 1}"]),
        case("n", &["-p", "a"]),
        case("n", &["-r", "a/*:=b"]),
        case("n", &["-r", "a:="]),
        case("n", &["-r", "__ns:=left"]),
        case("n", &["--log-level", "loud"]),
        case("n", &["--params-file", "/no/such/file"]),
    ]);
    let theirs = peer("arguments_peer.py", &cases);
    for (case, theirs) in
        cases.as_array().expect("cases").iter().zip(theirs.as_array().expect("answers"))
    {
        assert_eq!(&ours(case), theirs, "{}", case["arguments"]);
    }
}
