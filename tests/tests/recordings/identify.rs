//! `frictionlab identify`, as a person uses it: the built program, files in, files and words out.

use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Output;

use serde_json::Value;
use tempfile::TempDir;

/// A place to work in, with the program started there.
struct Desk {
    folder: TempDir,
}

impl Desk {
    fn new() -> Self {
        Self { folder: tempfile::tempdir().unwrap() }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn file(&self, name: &str, content: &str) -> PathBuf {
        let path = self.path(name);
        fs::write(&path, content).unwrap();
        path
    }

    fn identify(&self, args: &[&str]) -> Output {
        tests::frictionlab()
            .current_dir(self.folder.path())
            .arg("identify")
            .args(args)
            .output()
            .unwrap()
    }

    /// Runs it, expects success, and returns what it printed.
    fn ok(&self, args: &[&str]) -> String {
        let output = self.identify(args);
        assert!(output.status.success(), "{args:?}: {}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8(output.stdout).unwrap()
    }

    /// Runs it, expects it to refuse in one paragraph with exit code 2 and to leave the folder as
    /// it was; the paragraph must contain all `parts`.
    fn refused(&self, args: &[&str], parts: &[&str]) {
        let before = self.names();
        let output = self.identify(args);
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{args:?}: {message}");
        assert!(!message.contains("panicked"), "{message}");
        assert_eq!(message.trim_end().lines().count(), 1, "not one paragraph: {message}");
        for part in parts {
            assert!(message.contains(part), "{args:?} gave {message:?}, without {part:?}");
        }
        assert!(output.stdout.is_empty(), "{args:?} printed results");
        assert_eq!(self.names(), before, "{args:?} left something behind");
    }

    fn names(&self) -> Vec<String> {
        let entries = fs::read_dir(self.folder.path()).unwrap();
        let mut names: Vec<_> =
            entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    fn json(&self, folder: &str) -> Value {
        serde_json::from_str(
            &fs::read_to_string(self.path(folder).join("identification.json")).unwrap(),
        )
        .unwrap()
    }
}

fn number(document: &Value, pointer: &str) -> f64 {
    document
        .pointer(pointer)
        .and_then(Value::as_f64)
        .unwrap_or_else(|| panic!("no number at {pointer} in {document:#}"))
}

fn parameter(document: &Value, model: &str, name: &str) -> f64 {
    number(document, &format!("/{model}/parameters/{name}/value"))
}

fn assert_near(got: f64, expected: f64, tolerance: f64) {
    assert!((got / expected - 1.0).abs() < tolerance, "{got} instead of {expected}");
}

/// A turning axis whose friction is known.
const INERTIA: f64 = 0.02;
const VISCOUS: f64 = 0.05;
const COULOMB: f64 = 0.3;
const OFFSET: f64 = -0.07;

/// Rows (time, angle, torque) at 500 Hz: two sines, both directions, no noise.
fn motion(samples: usize) -> impl Iterator<Item = (f64, f64, f64)> {
    (0..samples).map(|i| i as f64 * 0.002).map(|t| {
        let sine = |amplitude: f64, w: f64| {
            let (sin, cos) = (w * t).sin_cos();
            (amplitude * sin, amplitude * w * cos, -amplitude * w * w * sin)
        };
        let ((x1, v1, a1), (x2, v2, a2)) = (sine(2.0, 1.5), sine(0.4, 7.0));
        let (v, a) = (v1 + v2, a1 + a2);
        (t, x1 + x2, INERTIA * a + VISCOUS * v + COULOMB * v.signum() + OFFSET)
    })
}

fn table(header: &str, rows: impl Iterator<Item = (f64, f64, f64)>) -> String {
    let mut text = format!("{header}\n");
    for (t, x, force) in rows {
        writeln!(text, "{t:.6},{x:.9},{force:.9}").unwrap();
    }
    text
}

/// The well-formed table that bad input is made from.
fn good() -> String {
    table("t_s,position_rad,torque_Nm", motion(4000))
}

fn assert_is_the_known_axis(document: &Value) {
    assert_near(parameter(document, "symmetric", "inertia"), INERTIA, 2e-3);
    assert_near(parameter(document, "symmetric", "viscous"), VISCOUS, 5e-3);
    assert_near(parameter(document, "symmetric", "coulomb"), COULOMB, 5e-3);
    assert_near(parameter(document, "symmetric", "offset"), OFFSET, 5e-3);
    // Without an offset of its own the asymmetric model puts it into the two Coulomb levels.
    assert_near(parameter(document, "asymmetric", "coulomb_positive"), COULOMB + OFFSET, 1e-2);
    assert_near(parameter(document, "asymmetric", "coulomb_negative"), COULOMB - OFFSET, 1e-2);
}

#[test]
fn finds_a_known_axis() {
    let desk = Desk::new();
    desk.file("shaft.csv", &good());
    let printed = desk.ok(&["shaft.csv"]);
    let document = desk.json("runs/identify-1");
    assert_is_the_known_axis(&document);
    assert_eq!(document["axis"], "rotary");
    assert_eq!(document.pointer("/symmetric/parameters/inertia/unit").unwrap(), "kg m^2");
    assert_eq!(document["asymmetric"]["cross_test"], Value::Null);
    assert_near(number(&document, "/recording/time_step_s"), 0.002, 1e-6);
    assert!(number(&document, "/symmetric/relative_error_percent") < 2.0);
    for part in ["inertia", "kg m^2", "±", "coulomb_negative", "relative error", "runs/identify-1"]
    {
        assert!(printed.contains(part), "{printed}");
    }
    let files = ["identification.json", "parameters.yaml", "report.html"];
    let mut names: Vec<_> = fs::read_dir(desk.path("runs/identify-1"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    assert_eq!(names, files);
    let page = fs::read_to_string(desk.path("runs/identify-1/report.html")).unwrap();
    assert!(page.contains("Measured and predicted torque") && page.contains("kg m^2"));
    let yaml = fs::read_to_string(desk.path("runs/identify-1/parameters.yaml")).unwrap();
    let value = |name: &str| {
        let line =
            yaml.lines().find(|line| line.trim_start().starts_with(&format!("{name}:"))).unwrap();
        let text = line.split(':').nth(1).unwrap().split('#').next().unwrap().trim();
        assert!(text.contains('.'), "ROS takes {text} for an integer");
        text.parse::<f64>().unwrap()
    };
    assert_near(value("f_c"), COULOMB, 5e-3);
    assert_eq!(value("f_s"), value("f_c"));
    assert_near(value("f_v"), VISCOUS, 5e-3);
    assert!(yaml.contains("ros__parameters") && yaml.contains("/friction_observer"));
}

#[test]
fn columns_can_be_mapped_scaled_and_in_any_order() {
    let desk = Desk::new();
    let mut text = "\u{feff}motor current; Winkel ;Zeit\r\n".to_owned();
    for (t, x, torque) in motion(4000) {
        // Current of a drive with -.25 N m/A, angle in turns, time in milliseconds that do not
        // start at zero.
        write!(
            text,
            "{:.9};{:.10};{:.4}\r\n",
            torque / -0.25,
            x / std::f64::consts::TAU,
            5e4 + 1e3 * t
        )
        .unwrap();
    }
    desk.file("fremd.csv", &text);
    let args = [
        "fremd.csv",
        "--time",
        "Zeit:0.001",
        "--position",
        "Winkel:6.283185307179586",
        "--force-column",
        "motor current:-0.25",
        "--axis",
        "rotary",
        "--out",
        "here/and/there",
        "--quiet",
    ];
    assert_eq!(desk.ok(&args), "", "--quiet prints nothing");
    let document = desk.json("here/and/there");
    assert_is_the_known_axis(&document);
    assert_eq!(document.pointer("/recording/sources/force/scale").unwrap(), -0.25);
}

#[test]
fn the_cross_test_uses_the_other_file() {
    let desk = Desk::new();
    desk.file("one.csv", &good());
    // The same axis with twice the Coulomb friction: the cross-test must notice.
    let other = motion(4000).map(|(t, x, torque)| (t, 0.8 * x, torque + 0.5));
    desk.file("other.csv", &table("t_s,position_rad,torque_Nm", other));
    let printed = desk.ok(&["one.csv", "--validate", "one.csv", "--out", "same"]);
    assert!(printed.contains("cross-test"), "{printed}");
    desk.ok(&["one.csv", "--validate", "other.csv", "--out", "differs"]);
    let pointer = "/symmetric/cross_test/relative_error_percent";
    let same = desk.json("same");
    assert_near(number(&same, pointer), number(&same, "/symmetric/relative_error_percent"), 1e-9);
    assert!(number(&desk.json("differs"), pointer) > 50.0);
}

#[test]
fn a_second_run_replaces_the_first_only_if_told_to() {
    let desk = Desk::new();
    desk.file("a.csv", &good());
    desk.ok(&[
        "a.csv",
        "--out",
        "out",
        "--cutoff",
        "20",
        "--order",
        "2",
        "--decimate",
        "5",
        "--trim",
        "100",
    ]);
    let settings = &desk.json("out")["settings"];
    assert_eq!((settings["order"].as_u64(), settings["trim"].as_u64()), (Some(2), Some(100)));
    desk.refused(&["a.csv", "--out", "out"], &["out", "not empty", "--force"]);
    desk.ok(&["a.csv", "--out", "out", "--force"]);
    assert_near(number(&desk.json("out"), "/settings/cutoff_hz"), 50.0, 1e-4);
}

#[test]
fn one_direction_is_told_in_a_note() {
    let desk = Desk::new();
    let rows = (0..4000).map(|i| f64::from(i) * 0.002).map(|t| {
        let (sin, cos) = (4.0 * t).sin_cos();
        let (x, v, a) = (3.0 * t + 0.5 * sin, 3.0 + 2.0 * cos, -8.0 * sin);
        (t, x, INERTIA * a + VISCOUS * v + COULOMB)
    });
    desk.file("forwards.csv", &table("t_s,position_rad,torque_Nm", rows));
    let printed = desk.ok(&["forwards.csv", "--out", "out"]);
    assert!(
        printed.contains("one direction only") && printed.contains("both directions"),
        "{printed}"
    );
    let document = desk.json("out");
    assert_eq!(document["asymmetric"], Value::Null);
    assert_eq!(document["notes"].as_array().unwrap().len(), 2);
    assert_near(parameter(&document, "symmetric", "coulomb"), COULOMB, 5e-3);
}

/// A triangle of position with rounded corners: a constant friction and one that grows with speed
/// cannot be told apart, but gravity can.
#[test]
fn a_motion_of_one_speed_says_so_once_and_keeps_what_goes_with_the_position() {
    let desk = Desk::new();
    let mut x = 0.0;
    let rows = (0..20_000).map(|i| f64::from(i) * 0.002).map(|t| {
        let turn = (25.0 * (0.8 * t).cos()).tanh();
        let (v, a) = (0.7 * turn, -0.7 * 20.0 * (0.8 * t).sin() * (1.0 - turn * turn));
        x += 0.002 * v;
        (t, x, INERTIA * a + VISCOUS * v + COULOMB * v.signum() + 0.5 * x.sin())
    });
    desk.file("triangle.csv", &table("t_s,position_rad,torque_Nm", rows));
    let printed = desk.ok(&["triangle.csv", "--structure", "symmetric+gravity", "--out", "out"]);
    assert_eq!(printed.matches("The motion has one speed, 0.7").count(), 1, "{printed}");
    // What friction is at that speed, 0.3 + 0.05 * 0.7 N m.
    assert!(printed.contains("0.335 N m by the symmetric model"), "{printed}");
    let document = desk.json("out");
    let found = document["structure"]["parameters"]["parameters"].as_array().unwrap();
    let verdict = |name: &str| {
        let one = found.iter().find(|one| one["name"] == name);
        one.unwrap_or_else(|| panic!("no {name}: {found:?}"))["verdict"].clone()
    };
    assert_eq!(verdict("gravity_sin"), "identified");
    for name in ["f_c", "f_v", "inertia"] {
        assert_ne!(verdict(name), "identified", "{name}");
    }
    let model =
        ["--model", "coulomb_viscous", "--torque-source", "driving", "--inertia", "0.02:0.0001"];
    let printed = desk.ok(&[&["triangle.csv", "--out", "models"][..], &model].concat());
    assert!(printed.contains("The sliding has one speed, 0.7"), "{printed}");
}

/// Friction that falls while the motion grows faster: each of three fits finds it, and it is said
/// once.
#[test]
fn friction_that_changes_is_told_once() {
    let desk = Desk::new();
    let mut x = 0.0;
    let rows = (0..20_000).map(|i| f64::from(i) * 0.002).map(|t| {
        let (sin, cos) = ((0.8 + 0.02 * t) * t).sin_cos();
        let rate = 0.8 + 0.04 * t;
        let (v, a) = (2.0 * cos, -2.0 * rate * sin);
        x += 0.002 * v;
        let warm = 1.0 - 0.5 * t / 40.0;
        (t, x, INERTIA * a + warm * (VISCOUS * v + COULOMB * v.signum()))
    });
    desk.file("warming.csv", &table("t_s,position_rad,torque_Nm", rows));
    for more in [&["--structure", "symmetric,symmetric+stribeck"][..], &[]] {
        let printed = desk.ok(&[&["warming.csv", "--out", "out", "--force"][..], more].concat());
        let told = printed.matches("from the beginning to the end").count();
        assert_eq!(told, 1, "{more:?}: {printed}");
    }
}

/// A position in degrees that says it is in rad, beside a right velocity: the inertia was a
/// fiftieth of the truth, to a percent, and what told so was the last of the notes.
#[test]
fn columns_that_contradict_each_other_are_told_before_any_number() {
    let desk = Desk::new();
    let mut text = "t_s,position_rad,velocity_rad_s,torque_Nm\n".to_owned();
    let mut before = None;
    for (t, x, torque) in motion(4000) {
        let v = before.map_or(0.0, |before: f64| (x - before) / 0.002);
        before = Some(x);
        writeln!(text, "{t:.6},{:.9},{v:.9},{torque:.9}", x.to_degrees()).unwrap();
    }
    desk.file("degrees.csv", &text);
    let warned = "WARNING: degrees.csv: `velocity_rad_s` is 0.0174";
    for (out, options) in [
        ("axis", &[][..]),
        ("structure", &["--structure", "symmetric,asymmetric"]),
        (
            "model",
            &["--model", "coulomb_viscous", "--torque-source", "driving", "--inertia", "0.02:1e-4"],
        ),
    ] {
        let printed = desk.ok(&[&["degrees.csv", "--out", out][..], options].concat());
        let place = printed.find(warned).unwrap_or_else(|| panic!("{out}: {printed}"));
        let number =
            ["inertia a", "inertia  ", "model  "].iter().filter_map(|part| printed.find(part));
        assert!(number.min().is_none_or(|number| place < number), "{out}: {printed}");
        let warnings = desk.json(out)["warnings"].to_string();
        assert!(warnings.contains("(as degrees are to rad)"), "{out}: {warnings}");
    }
}

/// In the recording to fit, the axis has play of its own kind around most of its reversals; on the
/// other it has none. The simplest structure predicts the other best, and is chosen.
#[test]
fn what_holds_on_the_other_recording_too_is_chosen() {
    let desk = Desk::new();
    let made = |bristle: &dyn Fn(f64) -> bool| {
        let (mut x, mut z) = (0.0, 0.0f64);
        let rows = (0..20_000).map(move |i| f64::from(i) * 0.002);
        let rows: Vec<(f64, f64, f64)> = rows
            .map(|t| {
                let (sin, cos) = (1.9 * t).sin_cos();
                let (v, a) =
                    (2.0 * cos + 0.6 * (5.3 * t).cos(), -3.8 * sin - 3.18 * (5.3 * t).sin());
                x += 0.002 * v;
                let stiff = if bristle(t) { 0.3 } else { 1e-4 };
                z += 0.002 * (v - v.abs() * z / stiff);
                z = z.clamp(-stiff, stiff);
                (t, x, INERTIA * a + VISCOUS * v + COULOMB * z / stiff)
            })
            .collect();
        table("t_s,position_rad,torque_Nm", rows.into_iter())
    };
    desk.file("here.csv", &made(&|t| t > 8.0));
    desk.file("there.csv", &made(&|_| false));
    let structures = ["here.csv", "--structure", "symmetric,symmetric+presliding", "--force"];
    desk.ok(&[&structures[..], &["--out", "alone"]].concat());
    assert_eq!(desk.json("alone")["structure"]["chosen"], "symmetric+presliding");
    let both = ["--validate", "there.csv", "--out", "both"];
    let printed = desk.ok(&[&structures[..], &both].concat());
    let found = desk.json("both");
    assert_eq!(found["structure"]["chosen"], "symmetric", "{printed}");
    let there = &found["structure"]["scores"][0]["elsewhere"]["relative_error"];
    assert_near(
        there.as_f64().expect("an error there"),
        found["structure"]["cross_test_relative_error_percent"].as_f64().expect("an error"),
        1e-3,
    );
    let page = std::fs::read_to_string(desk.path("both/report.html")).expect("a report");
    assert!(page.contains("took part in the choice") && page.contains("other recording [%]"));
}

#[test]
fn bad_files_are_refused() {
    let desk = Desk::new();
    desk.refused(&["absent.csv"], &["absent.csv", "cannot be read"]);
    desk.refused(&["absent.mcap"], &["absent.mcap"]);
    desk.file("empty.csv", "");
    desk.refused(&["empty.csv"], &["empty.csv", "empty", "header"]);
    desk.file("empty.mcap", "");
    desk.refused(&["empty.mcap"], &["empty.mcap", "empty"]);
    desk.file("text.mcap", "this is no bag");
    desk.refused(&["text.mcap"], &["text.mcap"]);
    desk.file("header.csv", "t_s,position_rad,torque_Nm\n");
    desk.refused(&["header.csv"], &["header.csv", "no samples"]);
    desk.file("short.csv", &table("t_s,position_rad,torque_Nm", motion(40)));
    desk.refused(&["short.csv"], &["short.csv", "40", "at least", "--trim"]);
    desk.file("bare.csv", good().split_once('\n').unwrap().1);
    desk.refused(&["bare.csv"], &["bare.csv", "line 1", "header"]);
    // A bad validation file is as bad as the other one.
    desk.file("good.csv", &good());
    desk.refused(&["good.csv", "--validate", "short.csv"], &["short.csv"]);
    desk.refused(&["good.csv", "--validate", "absent.csv"], &["absent.csv"]);
}

#[test]
fn bad_columns_are_refused() {
    let desk = Desk::new();
    desk.file("a.csv", &good().replacen("torque_Nm", "u_V", 1));
    desk.refused(
        &["a.csv"],
        &["a.csv", "force", "t_s, position_rad, u_V", "--force-column NAME:SCALE"],
    );
    desk.refused(
        &["a.csv", "--force-column", "voltage_V:2"],
        &["`voltage_V`", "t_s, position_rad, u_V", "--force-column"],
    );
    desk.refused(&["a.csv", "--force-column", "u_V", "--time", "when"], &["`when`", "--time"]);
    desk.refused(&["a.csv", "--force", "u_V:2"], &["no file u_V:2", "--force-column u_V:2"]);
}

#[test]
fn bad_samples_are_refused_with_their_line() {
    let desk = Desk::new();
    let lines: Vec<String> = good().lines().map(str::to_owned).collect();
    let with = |name: &str, change: &dyn Fn(&mut Vec<String>)| {
        let mut changed = lines.clone();
        change(&mut changed);
        desk.file(name, &(changed.join("\n") + "\n"));
    };
    // Line numbers count from 1, the header being line 1: index 1000 is line 1001.
    let cell = |column: usize, text: &'static str| {
        move |lines: &mut Vec<String>| {
            let mut cells: Vec<_> = lines[1000].split(',').map(str::to_owned).collect();
            cells[column] = text.to_owned();
            lines[1000] = cells.join(",");
        }
    };
    with("inf.csv", &cell(2, "inf"));
    desk.refused(&["inf.csv"], &["line 1001", "inf.csv", "torque_Nm", "inf", "finite number"]);
    with("word.csv", &cell(1, "off"));
    desk.refused(&["word.csv"], &["line 1001", "position_rad", "off"]);
    with("ragged.csv", &|lines| lines[1000] = "1.998".to_owned());
    desk.refused(&["ragged.csv"], &["line 1001", "1 field"]);
    with("back.csv", &|lines| lines.swap(1000, 1001));
    desk.refused(&["back.csv"], &["back.csv", "line 100"]);
}

#[test]
fn bad_options_are_refused() {
    let desk = Desk::new();
    desk.file("a.csv", &good());
    desk.refused(&["a.csv", "--cutoff", "300"], &["250 Hz", "300 Hz", "--cutoff"]);
    desk.refused(&["a.csv", "--cutoff", "0"], &["--cutoff"]);
    desk.refused(&["a.csv", "--cutoff", "-5"], &["--cutoff"]);
    desk.refused(&["a.csv", "--cutoff", "NaN"], &["--cutoff"]);
    desk.refused(&["a.csv", "--order", "0"], &["--order"]);
    desk.refused(&["a.csv", "--decimate", "0"], &["--decimate"]);
    desk.refused(&["a.csv", "--trim", "2000"], &["--trim"]);
    desk.refused(&["a.csv", "--trim", "18446744073709551615"], &["--trim"]);
    // The option's own check speaks before a file is read, and clap puts the way to the help under
    // it.
    let output = desk.identify(&["a.csv", "--time-tolerance", "2"]);
    let message = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(message.contains("--time-tolerance") && message.contains("from 0 to 0.5"), "{message}");
}

#[test]
fn impossible_outcomes_are_refused() {
    let desk = Desk::new();
    desk.file("a.csv", &good());
    desk.refused(
        &["a.csv", "--force-column", "torque_Nm:-1"],
        &["a.csv", "inertia", "negative", "--without-inertia"],
    );
    desk.refused(
        &["a.csv", "--force-column", "torque_Nm:-1", "--structure", "auto"],
        &["a.csv", "inertia", "negative", "--without-inertia"],
    );
    let still = motion(2000).map(|(t, _, torque)| (t, 1.0, torque));
    desk.file("still.csv", &table("t_s,position_rad,torque_Nm", still));
    desk.refused(&["still.csv"], &["still.csv", "inertia", "accelerates"]);
    let idle = motion(2000).map(|(t, x, _)| (t, x, 0.0));
    desk.file("idle.csv", &table("t_s,position_rad,torque_Nm", idle));
    desk.refused(&["idle.csv"], &["force is zero"]);
}

#[test]
fn an_unwritable_folder_leaves_nothing_behind() {
    let desk = Desk::new();
    desk.file("a.csv", &good());
    desk.file("taken", "");
    desk.refused(&["a.csv", "--out", "taken"], &["taken", "--out"]);
    desk.refused(&["a.csv", "--out", "taken/below"], &["taken", "--out"]);
    // One of the files cannot be put in place: the others must not appear either.
    fs::create_dir_all(desk.path("half/parameters.yaml")).unwrap();
    desk.refused(&["a.csv", "--out", "half", "--force"], &["parameters.yaml"]);
    assert_eq!(fs::read_dir(desk.path("half")).unwrap().count(), 1);
    #[cfg(target_os = "linux")]
    desk.refused(&["a.csv", "--out", "/proc/nowhere"], &["/proc/nowhere"]);
}

#[tests::needs(emps)]
#[test]
fn agrees_with_the_published_table_of_emps() {
    let data = tests::shared_data().join("emps");
    let desk = Desk::new();
    let file = |name: &str| -> String { Path::new(&data).join(name).to_str().unwrap().to_owned() };
    let (estimation, validation) = (file("estimation.csv"), file("validation.csv"));
    let force = ["--force-column", "control_V:35.150651882485472"];
    // The columns named one by one, and recognised, must come to the same.
    desk.ok(&[
        &[
            estimation.as_str(),
            "--validate",
            &validation,
            "--time",
            "t_s",
            "--position",
            "position_m",
            "--out",
            "named",
        ][..],
        &force,
    ]
    .concat());
    desk.ok(&[&[estimation.as_str(), "--validate", &validation][..], &force].concat());
    let document = desk.json("runs/identify-1");
    assert_eq!(document["symmetric"], desk.json("named")["symmetric"]);
    assert_eq!(document["axis"], "linear");

    for (model, name, published) in [
        ("symmetric", "inertia", 95.1089),
        ("symmetric", "viscous", 203.5034),
        ("symmetric", "coulomb", 20.3935),
        ("symmetric", "offset", -3.1648),
        ("asymmetric", "inertia", 95.154),
        ("asymmetric", "viscous_positive", 166.706),
        ("asymmetric", "viscous_negative", 240.424),
        ("asymmetric", "coulomb_positive", 20.144),
        ("asymmetric", "coulomb_negative", 20.628),
    ] {
        assert_near(parameter(&document, model, name), published, 2e-3);
    }
    for (name, published) in
        [("inertia", 0.1085), ("viscous", 1.146), ("coulomb", 0.1012), ("offset", 0.0444)]
    {
        assert_near(
            number(&document, &format!("/symmetric/parameters/{name}/white_error")),
            published,
            0.02,
        );
    }
    for (pointer, percent) in [
        ("/symmetric/relative_error_percent", 4.083),
        ("/symmetric/cross_test/relative_error_percent", 5.982),
        ("/asymmetric/relative_error_percent", 3.112),
        // Not published; an independent implementation's.
        ("/asymmetric/cross_test/relative_error_percent", 5.34),
    ] {
        let got = number(&document, pointer);
        assert!((got - percent).abs() < 0.1, "{pointer}: {got} instead of {percent}");
    }
}
