//! Tables as other people write them: decimal commas, irregular times, columns by number.

use std::fmt::Write;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use msgs::sensor_msgs::JointState;
use msgs::std_msgs::Header;
use recording::bag::{BagOptions, BagWriter};
use serde_json::Value;

/// Inertia [kg m^2], viscous friction [N m s/rad] and Coulomb friction [N m] of the axis.
const TRUTH: [f64; 3] = [0.02, 0.3, 0.5];

/// Time, velocity and torque of a driven axis that never rests, at uneven times.
fn rows(step: impl Fn(usize) -> f64) -> Vec<[f64; 3]> {
    let (mut t, mut rows) = (0.0, Vec::new());
    for k in 0..4000 {
        let (mut v, mut a) = (0.0f64, 0.0);
        for (amplitude, omega) in [(3.0f64, 2.0f64), (2.0, 5.3), (1.0, 11.0)] {
            v += amplitude * (omega * t).sin();
            a += amplitude * omega * (omega * t).cos();
        }
        rows.push([t, v, TRUTH[0] * a + TRUTH[1] * v + TRUTH[2] * v.signum()]);
        t += step(k);
    }
    rows
}

fn frictionlab(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_frictionlab"))
        .args(arguments)
        .current_dir(folder)
        .output()
        .unwrap()
}

fn ok(folder: &Path, arguments: &[&str]) -> String {
    let output = frictionlab(folder, arguments);
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

fn refused(folder: &Path, arguments: &[&str]) -> String {
    let output = frictionlab(folder, arguments);
    assert!(!output.status.success(), "{arguments:?} was accepted");
    String::from_utf8(output.stderr).unwrap()
}

/// The estimates of inertia, viscous and Coulomb friction.
fn assert_found(folder: &Path, within: f64) {
    let text = fs::read_to_string(folder.join("found/identification.json")).unwrap();
    let document: Value = serde_json::from_str(&text).unwrap();
    let found = &document["symmetric"]["parameters"];
    for (name, truth) in ["inertia", "viscous", "coulomb"].into_iter().zip(TRUTH) {
        let value = found[name]["value"].as_f64().unwrap_or_else(|| panic!("no {name} in {found}"));
        assert!((value / truth - 1.0).abs() < within, "{name}: {value} and not {truth}");
    }
}

/// A bag of an arm whose elbow is the axis, and whose other joint swings by `swing`.
fn arm(folder: &Path, swing: f64) {
    let mut bag = BagWriter::create(&folder.join("bag"), BagOptions::default()).unwrap();
    let mut position = 0.0;
    for [t, v, torque] in rows(|_| 2e-3) {
        let stamp = 1_700_000_000_000_000_000 + (t * 1e9).round() as u64;
        position += 2e-3 * v;
        let state = JointState {
            header: Header::at(stamp),
            name: vec!["shoulder".into(), "elbow".into()],
            position: vec![0.5 + 0.5 * swing * t.sin(), position],
            velocity: vec![0.5 * swing * t.cos(), v],
            effort: vec![9.0, torque],
        };
        bag.write("/joint_states", stamp, &state).unwrap();
    }
    bag.finish().unwrap();
}

#[test]
fn a_joint_of_a_bag_is_identified_from_the_torque_that_drives_it() {
    let folder = tempfile::tempdir().unwrap();
    arm(folder.path(), 0.0);
    let look = ok(folder.path(), &["look", "bag"]);
    assert!(look.contains("shoulder, elbow") && look.contains("name one of them"), "{look}");
    let look = ok(folder.path(), &["look", "bag", "--joint", "elbow"]);
    assert!(look.contains("500 Hz") && look.contains("effort"), "{look}");
    let said = refused(folder.path(), &["identify", "bag", "--effort", "driving"]);
    assert!(said.contains("shoulder, elbow") && said.contains("--joint NAME"), "{said}");
    let said = refused(folder.path(), &["identify", "bag", "--joint", "elbow"]);
    assert!(said.contains("--effort driving"), "{said}");
    let elbow = ["identify", "bag", "--joint", "elbow", "--effort", "driving", "--out", "found"];
    ok(folder.path(), &elbow);
    assert_found(folder.path(), 0.02);
}

/// What the others do to it is in no model of one axis: its friction is found, its inertia is that of
/// one motion.
#[test]
fn a_joint_that_others_move_has_friction_and_no_inertia_of_its_own() {
    let verdicts = |swing: f64| {
        let folder = tempfile::tempdir().unwrap();
        arm(folder.path(), swing);
        let elbow = ["identify", "bag", "--joint", "elbow", "--effort", "driving"];
        let said = ok(folder.path(), &[&elbow[..], &["--structure", "auto"]].concat());
        let document = ok(
            folder.path(),
            &[&elbow[..], &["--json", "--structure", "auto", "--force"]].concat(),
        );
        let document: Value = serde_json::from_str(&document).unwrap();
        let of_structure = &document["structure"]["parameters"]["parameters"];
        let verdict = |name: &str| {
            let own = of_structure.as_array().unwrap().iter().find(|one| one["name"] == name);
            own.unwrap()["verdict"] == "identified"
        };
        let plain = &document["symmetric"]["parameters"]["inertia"]["identifiable"];
        (said.contains("shoulder by 0.8"), *plain == true, verdict("inertia"), verdict("f_c"))
    };
    assert_eq!(verdicts(0.0), (false, true, true, true));
    assert_eq!(verdicts(0.8), (true, false, false, true));
}

/// Two recordings of one axis are one recording with a gap, not recordings of friction.
#[test]
fn two_recordings_of_a_driving_force_are_fitted_together() {
    let folder = tempfile::tempdir().unwrap();
    let all = rows(|_| 2e-3);
    for (name, part, every) in [
        ("a.csv", 0..600, 1),
        ("b.csv", 700..1400, 1),
        ("c.csv", 1500..4000, 1),
        ("slow.csv", 0..4000, 2),
    ] {
        let mut text = "t_s,velocity_rad_s,torque_Nm\n".to_owned();
        for [t, v, torque] in all[part].iter().step_by(every) {
            writeln!(text, "{t:.4},{v:.6},{torque:.6}").unwrap();
        }
        fs::write(folder.path().join(name), text).unwrap();
    }
    let together =
        ["identify", "a.csv", "b.csv", "--validate", "c.csv", "--out", "found", "--force"];
    let said = ok(folder.path(), &together);
    assert!(said.contains("a.csv, b.csv: 1300 samples"), "{said}");
    assert_found(folder.path(), 0.02);
    ok(folder.path(), &[&together[..], &["--structure", "auto"]].concat());
    let said = refused(folder.path(), &["identify", "a.csv", "slow.csv"]);
    assert!(said.contains("slow.csv") && said.contains("--resample"), "{said}");
}

#[test]
fn options_without_effect_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    arm(folder.path(), 0.0);
    let mut text = "t_s,velocity_rad_s,torque_Nm\n".to_owned();
    for [t, v, torque] in rows(|_| 2e-3) {
        writeln!(text, "{t:.4},{v:.6},{torque:.6}").unwrap();
    }
    fs::write(folder.path().join("a.csv"), text).unwrap();
    for (arguments, part) in [
        (&["identify", "a.csv", "--effort", "driving"][..], "--effort"),
        (&["identify", "a.csv", "--torque-from-voltage"], "--torque-from-voltage"),
        (&["identify", "a.csv", "--asymmetric"], "--asymmetric"),
        (&["identify", "a.csv", "--elements", "3"], "--elements"),
        (&["identify", "a.csv", "--damping-ratio", "0.5"], "--damping-ratio"),
        (&["identify", "a.csv", "--drive-errors", "1,1,1"], "--drive-errors"),
        (&["identify", "a.csv", "--smooth", "none"], "--smooth"),
        (&["identify", "a.csv", "--gear-ratio", "3"], "--gear-ratio"),
        (&["identify", "a.csv", "--resistance", "3"], "--resistance"),
        (&["identify", "a.csv", "--drive", "drive.yaml"], "--drive"),
        (&["identify", "a.csv", "--model", "lugre", "--trim", "9"], "--trim"),
        (&["identify", "a.csv", "--model", "lugre", "--cutoff", "9"], "--cutoff"),
        (&["identify", "a.csv", "--model", "lugre", "--order", "2"], "--order"),
        (&["identify", "a.csv", "--model", "lugre", "--elements", "2"], "--elements"),
        (&["identify", "a.csv", "--model", "lugre", "--damping-ratio", "1"], "--damping-ratio"),
        (&["identify", "a.csv", "--model", "lugre", "--drive-errors", "1,1,1"], "--drive-errors"),
        (&["identify", "a.csv", "--model", "lugre", "--motor-constant", "1"], "--motor-constant"),
        (&["identify", "a.csv", "--model", "lugre", "--structure", "auto"], "--structure"),
        (&["identify", "a.csv", "--model", "lugre", "--without-offset"], "--without-offset"),
        (&["identify", "bag", "--joint", "elbow", "--effort", "driving", "--time", "t"], "--time"),
        (&["look", "bag", "--time", "t"], "--time"),
    ] {
        let said = refused(folder.path(), arguments);
        assert!(said.contains(part) && said.contains("leave"), "{arguments:?}: {said}");
    }
    for command in ["identify", "look"] {
        let said = refused(folder.path(), &[command, "a.csv", "--joint", "elbow"]);
        assert!(said.contains("holds no joint `elbow`") && said.contains("--joint"), "{said}");
    }
}

#[test]
fn a_look_tells_what_was_understood_and_what_can_be_identified() {
    let folder = tempfile::tempdir().unwrap();
    let mut text = "t [ms];dq [deg/s];tau (mNm)\n".to_owned();
    for [t, v, torque] in rows(|_| 2e-3) {
        let row = format!("{:.3};{:.6};{:.5}", t * 1e3, v.to_degrees(), torque * 1e3);
        writeln!(text, "{}", row.replace('.', ",")).unwrap();
    }
    fs::write(folder.path().join("a.csv"), text).unwrap();
    let said = ok(folder.path(), &["look", "a.csv", "--out", "seen"]);
    for part in ["semicolons", "decimals with a comma", "deg/s", "500 Hz", "frictionlab identify"] {
        assert!(said.contains(part), "no {part} in {said}");
    }
    let printed = ok(folder.path(), &["look", "a.csv", "--json"]);
    let document: Value = serde_json::from_str(&printed).unwrap();
    assert_eq!(document["dialect"]["separator"], "semicolon");
    assert_eq!(document["channels"][1]["channel"], "velocity");
    let page = fs::read_to_string(folder.path().join("seen/report.html")).unwrap();
    assert!(page.contains("The recording over time"));
}

#[test]
fn a_table_of_a_german_spreadsheet_is_the_same_recording() {
    let folder = tempfile::tempdir().unwrap();
    let mut text = "# drive 3\nZeit;t [ms];dq [deg/s];tau (mNm)\n".to_owned();
    for [t, v, torque] in rows(|_| 2e-3) {
        let row = format!("x;{:.3};{:.6};{:.5}", t * 1e3, v.to_degrees(), torque * 1e3);
        writeln!(text, "{}", row.replace('.', ",")).unwrap();
    }
    fs::write(folder.path().join("a.csv"), text).unwrap();
    let said = ok(folder.path(), &["identify", "a.csv", "--out", "found"]);
    assert!(said.contains("decimals are read with a comma"), "{said}");
    assert_found(folder.path(), 0.02);
}

#[test]
fn columns_without_names_are_given_by_number() {
    let folder = tempfile::tempdir().unwrap();
    let mut text = String::new();
    for [t, v, torque] in rows(|_| 2e-3) {
        writeln!(text, "{torque:.6} {t:.4}  {v:.6}").unwrap();
    }
    fs::write(folder.path().join("a.txt"), text).unwrap();
    let said = refused(folder.path(), &["identify", "a.txt"]);
    assert!(said.contains("numbers of its 3 columns"), "{said}");
    let named = ["--time-column", "2", "--velocity", "3", "--force-column", "1"];
    ok(folder.path(), &[&["identify", "a.txt", "--out", "found"][..], &named].concat());
    assert_found(folder.path(), 0.02);
}

#[test]
fn irregular_times_are_refused_until_a_rate_is_said() {
    let folder = tempfile::tempdir().unwrap();
    for (name, step) in [
        (
            "turns.csv",
            &(|k: usize| if k.is_multiple_of(2) { 0.010 } else { 0.012 }) as &dyn Fn(usize) -> f64,
        ),
        ("jitter.csv", &|k: usize| 1e-3 * (1.0 + 7.0 * ((k * 7919) % 1000) as f64 / 999.0)),
    ] {
        let mut text = "t_s,velocity_rad_s,torque_Nm\n".to_owned();
        for [t, v, torque] in rows(step) {
            writeln!(text, "{t:.6},{v:.6},{torque:.6}").unwrap();
        }
        fs::write(folder.path().join(name), text).unwrap();
        let said = refused(folder.path(), &["identify", name]);
        assert!(said.contains("irregular times") && said.contains("--resample"), "{said}");
        let arguments = ["identify", name, "--resample", "90", "--out", "found", "--force"];
        let said = ok(folder.path(), &arguments);
        assert!(said.contains("brought to 90 Hz") && said.contains("noise"), "{said}");
        assert_found(folder.path(), 0.05);
    }
}

/// A joint at 100 Hz: tones \[rad, Hz\] of the angle, its Coulomb friction, and where it begins.
fn quick_joint(tones: &[[f64; 2]], coulomb: f64, start: f64) -> String {
    let mut text = String::from("time,q,tau\n");
    for k in 0..2000 {
        let t = start + f64::from(k) * 0.01;
        let (mut q, mut v, mut a) = (0.0, 0.0, 0.0);
        for [amplitude, hertz] in tones {
            let w = std::f64::consts::TAU * hertz;
            let (sin, cos) = (w * t).sin_cos();
            q += amplitude * sin;
            v += amplitude * w * cos;
            a -= amplitude * w * w * sin;
        }
        let torque = 1e-4 * a + 0.01 * v + coulomb * v.signum();
        let _ = writeln!(text, "{:.2},{q:.5},{torque:.6}", t - start);
    }
    text
}

/// Neither plain nor with a structure: what is faster than the sampling shows nothing. A cutoff takes
/// what there is, and calls none of it identified.
#[test]
fn a_motion_that_cannot_be_followed_is_a_clear_no() {
    let folder = tempfile::tempdir().unwrap();
    let joint = quick_joint(&[[0.1, 31.7], [0.1, 38.3], [0.03, 0.7]], 1.0, 0.0);
    fs::write(folder.path().join("joint.csv"), joint).unwrap();
    let identify = ["identify", "joint.csv", "--axis", "rotary", "--quiet", "--out", "found"];
    for more in [&[][..], &["--structure", "auto"]] {
        let said = refused(folder.path(), &[&identify, more].concat());
        assert!(said.contains("sample faster or move more slowly"), "{said}");
        assert!(said.contains("100 Hz") && said.contains("--cutoff"), "{said}");
        assert!(!folder.path().join("found").exists());
    }
    ok(folder.path(), &[&identify[..], &["--structure", "auto", "--cutoff", "20"]].concat());
    assert_eq!(identified(folder.path()), 0);
}

/// A servo that holds its place goes to and fro between readings of its encoder. Its user was told to
/// move more slowly.
#[test]
fn a_servo_that_holds_its_place_does_not_move() {
    let folder = tempfile::tempdir().unwrap();
    let mut text = "time [s],position [rad],torque [Nm]\n".to_owned();
    for k in 0..4000u32 {
        // Some reading of four, and a torque that has nothing to do with it.
        let any = |by: u32| k.wrapping_mul(by).wrapping_mul(2_654_435_761) >> 16;
        let (count, noise) = (any(7) % 4, f64::from(any(11) % 1000) / 1000.0 - 0.5);
        let q = 0.3 + 0.001 * f64::from(count);
        let _ = writeln!(text, "{:.3},{q:.4},{noise:.4}", f64::from(k) * 1e-3);
    }
    fs::write(folder.path().join("held.csv"), text).unwrap();
    let said = refused(folder.path(), &["identify", "held.csv", "--out", "found"]);
    assert!(said.contains("does not move") && said.contains("3 steps of its encoder"), "{said}");
}

/// The friction is twice as large on the recording kept back: nothing that was found holds there.
#[test]
fn what_fails_on_the_recording_kept_back_is_not_identified() {
    let folder = tempfile::tempdir().unwrap();
    let tones = [[0.8, 0.31], [0.3, 0.83], [0.1, 1.7]];
    for (name, coulomb, start) in [("a", 1.0, 0.0), ("same", 1.0, 20.0), ("other", 3.0, 20.0)] {
        let joint = quick_joint(&tones, coulomb, start);
        fs::write(folder.path().join(name).with_extension("csv"), joint).unwrap();
    }
    let against = |other: &str| {
        let identify =
            ["identify", "a.csv", "--axis", "rotary", "--quiet", "--force", "--out", "found"];
        let more = ["--structure", "auto", "--validate", other];
        ok(folder.path(), &[&identify[..], &more].concat());
        identified(folder.path())
    };
    assert!(against("same.csv") >= 6, "{}", against("same.csv"));
    assert_eq!(against("other.csv"), 0);
}

/// A ripple is there on the recording and not on the other one. Where the other is as long, the
/// simpler structure is chosen; where it is short, the page says which does better there.
#[test]
fn a_structure_that_a_simpler_one_outdoes_elsewhere_is_not_chosen_or_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let tones = [[0.8, 0.31], [0.3, 0.83], [0.1, 1.7]];
    let plain = quick_joint(&tones, 1.0, 0.0);
    let mut lines = plain.lines();
    let mut rippled = format!("{}\n", lines.next().unwrap());
    for line in lines {
        let cells: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
        let [time, q, tau] = cells[..] else { panic!("{line}") };
        rippled += &format!("{time},{q},{}\n", tau + 0.3 * (12.0 * q).sin());
    }
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    write("rippled.csv", &rippled);
    write("same.csv", &rippled);
    let plain = quick_joint(&tones, 1.0, 20.0);
    write("plain.csv", &plain);
    let third = plain.lines().count() / 3;
    write(
        "short.csv",
        &plain.lines().take(third).map(|line| format!("{line}\n")).collect::<String>(),
    );
    let said = |other: &str| {
        let identify =
            ["identify", "rippled.csv", "--axis", "rotary", "--quiet", "--force", "--out", "found"];
        let more = ["--structure", "auto", "--validate", other];
        ok(folder.path(), &[&identify[..], &more].concat());
        let text = fs::read_to_string(folder.path().join("found/identification.json")).unwrap();
        let document: Value = serde_json::from_str(&text).unwrap();
        let told = |key: &str| document["structure"][key].to_string();
        (told("chosen"), told("warnings"))
    };
    let (chosen, warned) = said("plain.csv");
    assert!(
        !chosen.contains("harmonic") && !warned.contains("take --structure"),
        "{chosen} {warned}"
    );
    let (chosen, warned) = said("short.csv");
    assert!(chosen.contains("harmonic"), "{chosen}");
    assert!(warned.contains("take --structure symmetric"), "{warned}");
    // More friction there: the ripple promised an error of next to nothing, and no structure keeps that.
    write("other.csv", &quick_joint(&tones, 1.3, 20.0));
    let (chosen, warned) = said("other.csv");
    assert!(
        !chosen.contains("harmonic") && warned.contains("was to be expected"),
        "{chosen} {warned}"
    );
    let (chosen, warned) = said("same.csv");
    assert!(
        chosen.contains("harmonic") && !warned.contains("take --structure"),
        "{chosen} {warned}"
    );
}

/// How many parameters of the plain models and of the structure are called identified.
fn identified(folder: &Path) -> usize {
    let text = fs::read_to_string(folder.join("found/identification.json")).unwrap();
    let document: Value = serde_json::from_str(&text).unwrap();
    let plain = ["symmetric", "asymmetric"].map(|model| &document[model]["parameters"]);
    let plain = plain.into_iter().filter_map(Value::as_object).flat_map(|all| all.values());
    let structure = document["structure"]["parameters"]["parameters"].as_array();
    let structure = structure.into_iter().flatten();
    plain.filter(|one| one["identifiable"] == true).count()
        + structure.filter(|one| one["verdict"] == "identified").count()
}
