//! A live run killed at several moments: what was recorded until a second before the kill opens in
//! other people's tools afterwards, and can be replayed.

use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use msgs::friction_msgs::RigMeasurement;
use msgs::sensor_msgs::JointState;
use recording::bag::BagReader;
use serde_json::Value;
use tests::network::namespaced;
use tests::{frictionlab, python};

/// The topics of every cycle.
const TOPICS: [&str; 6] = [
    "/joint_states",
    "/rig_measurement",
    "/reference",
    "/motor_voltage",
    "/friction_estimate",
    "/controller_state",
];

fn live(out: &Path, domain: &str) -> Child {
    let program = frictionlab();
    let mut command = namespaced();
    command
        .arg(program.get_program())
        .args(["live", "--quiet", "--out"])
        .arg(out)
        .env("ROS_DOMAIN_ID", domain)
        .env("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
        .stdout(Stdio::null())
        .stderr(Stdio::piped());
    command.spawn().expect("unshare starts")
}

/// Waits until the file holds more than its head and the parameters: the first cycles.
fn wait_for_data(file: &Path) {
    let end = Instant::now() + Duration::from_secs(60);
    while std::fs::metadata(file).map_or(0, |about| about.len()) < 40_000 {
        assert!(Instant::now() < end, "nothing is recorded in {}", file.display());
        std::thread::sleep(Duration::from_millis(10));
    }
}

fn bag_command(arguments: &[&str], bag: &Path) -> (Option<i32>, String) {
    let output =
        frictionlab().arg("bag").args(arguments).arg(bag).output().expect("the program starts");
    let text = [output.stdout, output.stderr].concat();
    (output.status.code(), String::from_utf8_lossy(&text).into_owned())
}

#[tests::needs(rclpy, bag_tools, namespace)]
#[test]
fn a_killed_run_loses_its_last_second_and_no_more() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut recovered = Vec::new();
    for (number, moment) in [0.1, 0.7, 1.3].into_iter().enumerate() {
        let out = folder.path().join(format!("runs/live-{number}"));
        let bag = out.join("bag");
        let mut run = live(&out, "75");
        wait_for_data(&bag.join("bag_0.mcap"));
        // A moment after a flush, wherever in the half second to the next.
        std::thread::sleep(Duration::from_secs_f64(moment));
        let (in_use, told) = bag_command(&["recover"], &bag);
        assert_eq!(in_use, Some(2), "{told}");
        assert!(told.contains("is being written"), "{told}");
        run.kill().expect("it runs");
        let killed =
            SystemTime::now().duration_since(UNIX_EPOCH).expect("after 1970").as_nanos() as u64;
        run.wait().expect("it was killed");
        assert!(!bag.join("metadata.yaml").exists());
        let (refused, told) = bag_command(&["info"], &bag);
        assert_eq!(refused, Some(2), "{told}");
        assert!(told.contains("frictionlab bag recover"), "{told}");
        let damaged = std::fs::read(bag.join("bag_0.mcap")).expect("the file");

        let (code, told) = bag_command(&["recover"], &bag);
        assert_eq!(code, Some(0), "{told}");
        assert_eq!(std::fs::read(bag.join("bag_0.mcap.damaged")).expect("the original"), damaged);
        let (code, told) = bag_command(&["info"], &bag);
        assert_eq!(code, Some(0), "{told}");
        assert!(TOPICS.iter().all(|topic| told.contains(topic)), "{told}");

        let reader = BagReader::open(&bag).expect("a bag");
        let states = reader.messages::<RigMeasurement>("/rig_measurement").expect("measurements");
        assert!(
            states.windows(2).all(|pair| pair[1].1.cycle == pair[0].1.cycle + 1),
            "a cycle is missing"
        );
        // Observer and controller say nothing before they are active.
        let counts = TOPICS.map(|topic| {
            reader.topics().iter().find(|info| info.name == topic).map_or(0, |info| info.count)
        });
        assert!(counts.iter().all(|count| *count + 200 > states.len() as u64), "{counts:?}");
        let lost = killed.saturating_sub(states.last().expect("a state").0);
        // A second is promised; another is the machine's, which may keep the recorder from its half
        // second.
        assert!(lost < 2_000_000_000, "{:.3} s were lost", lost as f64 * 1e-9);
        recovered.push((bag, counts));
    }
    let interpreter = python::interpreter("bag_tools");
    for (bag, counts) in &recovered {
        let seen =
            python::json(&interpreter, "read_bag.py", &[bag.to_str().expect("a plain path")]);
        for (topic, count) in TOPICS.into_iter().zip(counts) {
            assert_eq!(seen["topics"][topic]["count"], *count, "{topic} by rosbags");
            let read = seen["topics"][topic]["messages"].as_array().map(|all| all.len() as u64);
            assert_eq!(read, Some(*count), "{topic}");
            assert_eq!(seen["mcap_ros2"][topic], *count, "{topic} by mcap-ros2-support");
        }
    }
    let (bag, _) = recovered.last().expect("a bag");
    replayed(bag);
}

/// Plays the bag with rclpy and compares what a subscriber gets.
fn replayed(bag: &Path) {
    let interpreter = python::interpreter("rclpy");
    let mut command = namespaced();
    let folder = tempfile::tempdir().expect("a folder");
    let output = command
        .arg(&interpreter)
        .arg(python::script("replay_bag.py"))
        .arg(bag)
        .env("ROS_DOMAIN_ID", "76")
        .env("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
        .env("ROS_LOG_DIR", folder.path())
        .output()
        .expect("unshare starts");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let report: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    for topic in TOPICS {
        let played = report[topic]["played"].as_u64().expect("a count");
        assert!(played >= 100, "{topic}: {report}");
        assert_eq!(report[topic]["same"], played, "{topic}");
    }
}

#[test]
fn the_next_start_offers_to_recover_what_was_cut_off() {
    let folder = tempfile::tempdir().expect("a folder");
    let bag = folder.path().join("runs/live-1/bag");
    let mut writer = recording::bag::BagWriter::create(&bag, Default::default()).expect("a bag");
    writer.write("/joint_states", 1, &JointState::default()).expect("a write");
    writer.flush().expect("a flush");
    let bytes = std::fs::read(bag.join("bag_0.mcap")).expect("the file");
    writer.finish().expect("the end");
    std::fs::write(bag.join("bag_0.mcap"), &bytes).expect("cut");
    std::fs::remove_file(bag.join("metadata.yaml")).expect("cut");
    let run = |arguments: &[&str]| -> String {
        let output: std::process::Output = Command::new(frictionlab().get_program())
            .args(arguments)
            .current_dir(folder.path())
            .output()
            .expect("the program starts");
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8_lossy(&output.stderr).into_owned()
    };
    let short = ["run", "velocity-tracking", "--quick", "--model", "lugre", "--out", "next"];
    let told = run(&short);
    assert!(told.contains("frictionlab bag recover runs/live-1/bag"), "{told}");
    run(&["bag", "recover", "runs/live-1/bag"]);
    let told = run(&["run", "velocity-tracking", "--quick", "--model", "lugre", "--out", "last"]);
    assert!(!told.contains("recover"), "{told}");

    let csv = folder.path().join("table.csv");
    run(&["bag", "to-csv", "last/bag", "--out", csv.to_str().expect("a plain path")]);
    let text = std::fs::read_to_string(&csv).expect("the table");
    let mut lines = text.lines();
    assert!(lines.next().is_some_and(|head| {
        head.starts_with("t_s,position_rad,velocity_rad_s,voltage_V,torque_Nm,")
    }));
    let states = BagReader::open(&folder.path().join("last/bag")).expect("a bag");
    let states = states.messages::<JointState>("/joint_states").expect("states");
    for (line, (_, state)) in lines.clone().zip(&states) {
        let value =
            |column: usize| line.split(',').nth(column).and_then(|text| text.parse::<f64>().ok());
        assert_eq!(value(1), Some(state.position[0]), "{line}");
        assert_eq!(value(4), Some(state.effort[0]), "{line}");
    }
    assert_eq!(lines.count(), states.len());
}
