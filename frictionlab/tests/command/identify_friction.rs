//! `frictionlab identify` for friction models, as a person uses it: the built program, files in,
//! files and words out.
//!
//! The recordings are computed from a known friction with fine Runge-Kutta steps, so that nothing
//! of the program's own fixed step is in them.

use std::fmt::Write;
use std::fs;
use std::io::{BufRead, BufReader, Read};
use std::path::PathBuf;
use std::process::{Command, Output, Stdio};

use experiment_runner::run::read_parameter_file;
use friction_model::{AnyModel, FrictionModel, ModelName, ModelVisitor, State, TimeStep, rk4};
use friction_observer::FrictionObserver;
use rand::{RngExt, SeedableRng};
use rand_distr::StandardNormal;
use rand_pcg::Pcg64Mcg;
use serde_json::Value;
use tempfile::TempDir;

/// A place to work in.
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

    fn file(&self, name: &str, content: &str) {
        fs::write(self.path(name), content).unwrap();
    }

    fn run(&self, args: &[&str]) -> Output {
        let program = env!("CARGO_BIN_EXE_frictionlab");
        Command::new(program)
            .current_dir(self.folder.path())
            .arg("identify")
            .args(args)
            .output()
            .unwrap()
    }

    /// Runs it, expects success, and returns what it printed.
    fn ok(&self, args: &[&str]) -> String {
        let output = self.run(args);
        assert!(output.status.success(), "{args:?}: {}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8(output.stdout).unwrap()
    }

    /// Runs it, expects exit code 2, a message with all `parts`, and the folder as it was.
    fn refused(&self, args: &[&str], parts: &[&str]) {
        let before = self.names();
        let output = self.run(args);
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{args:?}: {message}");
        assert!(!message.contains("panicked"), "{message}");
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

    fn text(&self, name: &str) -> String {
        fs::read_to_string(self.path(name)).unwrap()
    }

    fn json(&self, folder: &str) -> Value {
        serde_json::from_str(&self.text(&format!("{folder}/identification.json"))).unwrap()
    }
}

fn number(document: &Value, pointer: &str) -> f64 {
    document
        .pointer(pointer)
        .and_then(Value::as_f64)
        .unwrap_or_else(|| panic!("no number at {pointer} in {document:#}"))
}

const DT: f64 = 1e-3;
/// Steps of the truth for one sample.
const FINE: u32 = 20;

/// Friction at the samples of a motion, by RK4.
struct Truth<'a> {
    velocity: &'a dyn Fn(f64) -> f64,
    samples: u32,
}

impl ModelVisitor for Truth<'_> {
    type Output = Vec<f64>;

    fn visit<M: FrictionModel>(self, model: M) -> Vec<f64> {
        let Self { velocity, samples } = self;
        let mut state: State<_, _> = model.rest();
        let h = DT / f64::from(FINE);
        // A motion one way has slid before, another starts from rest.
        if (0..samples).all(|k| velocity(f64::from(k) * DT) > 0.0) {
            for _ in 0..40_000 {
                rk4::step(&model, &mut state, [velocity(0.0); 3], 1e-4);
            }
        }
        (0..samples)
            .map(|k| {
                let t = f64::from(k) * DT;
                let force = model.evaluate(&state.continuous, &state.memory, velocity(t)).force;
                for j in 0..FINE {
                    let t = t + f64::from(j) * h;
                    rk4::step(
                        &model,
                        &mut state,
                        [velocity(t), velocity(t + 0.5 * h), velocity(t + h)],
                        h,
                    );
                }
                force
            })
            .collect()
    }
}

struct Noise(Pcg64Mcg, f64);

impl Noise {
    fn new(seed: u64, deviation: f64) -> Self {
        Self(Pcg64Mcg::seed_from_u64(seed), deviation)
    }

    fn next(&mut self) -> f64 {
        self.1 * self.0.sample::<f64, _>(StandardNormal)
    }
}

/// A recording of `model` along a motion, with noise on the torque.
fn recording(
    model: &AnyModel,
    samples: u32,
    velocity: &dyn Fn(f64) -> f64,
    noise: &mut Noise,
) -> String {
    let friction = model.visit(Truth { velocity, samples });
    let mut text = "t_s,velocity_rad_s,torque_Nm\n".to_owned();
    for (k, friction) in friction.iter().enumerate() {
        let t = k as f64 * DT;
        writeln!(text, "{t:.4},{:.12},{:.12}", velocity(t), friction + noise.next()).unwrap();
    }
    text
}

/// Steady points over .03 to 4 rad/s in both directions.
fn points(model: &AnyModel, noise: &mut Noise) -> String {
    let mut text = "velocity_rad_s,torque_Nm\n".to_owned();
    for i in 0..40 {
        let v = if i < 20 {
            0.03 + 0.47 * f64::from(i) / 19.0
        } else {
            0.55 + 3.45 * f64::from(i - 20) / 19.0
        };
        for v in [v, -v] {
            writeln!(text, "{v:.12},{:.12}", model.steady_state(v) + noise.next()).unwrap();
        }
    }
    text
}

fn chirp(t: f64) -> f64 {
    1.0 - 0.95 * (0.53 * t * t).cos()
}

/// Displacement within 5 mrad, two frequencies beating: nested loops.
fn nested(t: f64) -> f64 {
    0.005 * (3.0 * (3.0 * t).cos() * (0.5 * t).cos() - 0.5 * (3.0 * t).sin() * (0.5 * t).sin())
}

fn reversing(t: f64) -> f64 {
    0.4 * (1.3 * t).sin() * (0.37 * t).cos() + 0.03 * (11.0 * t).sin()
}

/// The truth with a lag that can be seen at 1 ms (errata of the thesis: table 4.8).
fn truth(name: ModelName) -> AnyModel {
    let mut parameters = AnyModel::test_bed(name).parameters();
    parameters.set("tau", 0.0111);
    parameters.try_into().unwrap()
}

/// Four files that show everything, and one that is held out.
fn write_experiments(desk: &Desk, model: &AnyModel, deviation: f64) {
    let noise = &mut Noise::new(7, deviation);
    // A point is the mean of many samples.
    desk.file("points.csv", &points(model, &mut Noise::new(8, 0.03 * deviation)));
    desk.file("nested.csv", &recording(model, 4000, &|t| nested(t), noise));
    desk.file("chirp.csv", &recording(model, 6000, &|t| chirp(t), noise));
    desk.file("mixed.csv", &recording(model, 5000, &|t| reversing(t), noise));
    desk.file("other.csv", &recording(model, 5000, &|t| 0.8 * reversing(1.2 * t), noise));
}

const EXPERIMENTS: [&str; 4] = ["points.csv", "nested.csv", "chirp.csv", "mixed.csv"];

fn with(args: &[&'static str]) -> Vec<&'static str> {
    [&EXPERIMENTS[..], args].concat()
}

#[test]
fn a_known_friction_is_found_with_its_uncertainty_and_ranked_first() {
    const NOISE: f64 = 3e-4;
    let desk = Desk::new();
    let truth = truth(ModelName::Proposed);
    write_experiments(&desk, &truth, NOISE);
    let printed = desk.ok(&with(&[
        "--validate",
        "other.csv",
        "--model",
        "stribeck,lugre,proposed",
        "--out",
        "out",
    ]));
    let document = desk.json("out");
    assert_eq!(document["ranking"]["by"], "held_out");
    assert_eq!(document["ranking"]["order"][0]["model"], "proposed", "{printed}");
    assert_eq!(document["ranking"]["order"][1]["tie"], false);
    for name in ["f_s", "f_c", "v_s", "f_v", "z_b", "tau"] {
        let at =
            |what: &str| number(&document, &format!("/models/proposed/parameters/{name}/{what}"));
        let (value, error, expected) =
            (at("value"), at("standard_error"), truth.parameter(name).unwrap());
        // The fixed step at 1 ms is another integrator than the truth's: .2 % beside the noise.
        assert!(
            (value - expected).abs() < 4.0 * error + 2e-3 * expected,
            "{name}: {value} ± {error}, not {expected}"
        );
        let parameter = &document["models"]["proposed"]["parameters"][name];
        assert_eq!(parameter["identified"], true, "{name}: {parameter}");
        let interval = &document["models"]["proposed"]["parameters"][name]["interval_95"];
        assert!(interval[0].as_f64().unwrap() < value && interval[1].as_f64().unwrap() > value);
    }
    // The noise is what is left, on data that were not seen too.
    let held_out = number(&document, "/models/proposed/held_out/rms");
    assert!((held_out / NOISE - 1.0).abs() < 0.05, "{held_out}");
    assert!(number(&document, "/models/stribeck/held_out/rms") > 5.0 * held_out);
    assert_eq!(document["recordings"]["fitted"]["steady"], 80);
    for (kind, samples) in [("pre_sliding", 4000), ("lag", 6000), ("mixed", 5000)] {
        assert_eq!(document["recordings"]["fitted"][kind], samples, "{kind}");
    }
    for part in ["proposed", "±", "held out", "worse: ", "written to out"] {
        assert!(printed.contains(part), "{printed}");
    }
    let page = desk.text("out/report.html");
    for part in [
        "The models in order",
        "95 % band",
        "Pre-sliding loops, fitted",
        "Lag loops, fitted",
        "Mixed motion, held out",
        "proposed: correlation",
    ] {
        assert!(page.contains(part), "{part}");
    }
    assert!(!page.contains("Thesis table"), "only where asked for");
}

#[test]
fn the_parameter_file_drives_the_observer_unchanged() {
    let desk = Desk::new();
    let truth = truth(ModelName::LuGre);
    write_experiments(&desk, &truth, 0.0);
    desk.ok(&with(&[
        "--model",
        "lugre,gms",
        "--no-joint",
        "--elements",
        "3",
        "--out",
        "out",
        "--quiet",
    ]));
    let text = desk.text("out/parameters.yaml");
    assert!(text.contains("model: lugre"), "{text}");
    for line in text.lines().filter(|line| !line.starts_with('#')) {
        for number in
            line.split([':', ' ', '[', ']', ',']).filter(|word| word.parse::<f64>().is_ok())
        {
            assert!(number.contains('.'), "ROS takes {number} for an integer in {line}");
        }
    }
    let models = read_parameter_file(&text).unwrap();
    let found = models.get(ModelName::LuGre);
    assert_eq!(models.get(ModelName::Gms).parameters().values("alpha").len(), 3);
    for name in ["f_s", "f_c", "v_s", "f_v", "sigma0"] {
        let (value, expected) = (found.parameter(name).unwrap(), truth.parameter(name).unwrap());
        assert!((value / expected - 1.0).abs() < 0.02, "{name}: {value}, not {expected}");
    }
    let mut observer = FrictionObserver::new(&found, TimeStep::new(DT).unwrap());
    let estimate = (0..2000).map(|_| observer.observe(0.5, None)).last().unwrap();
    assert!((estimate.torque / truth.steady_state(0.5) - 1.0).abs() < 2e-3, "{estimate:?}");
}

#[test]
fn each_direction_gets_its_own_parameters_and_its_own_entry() {
    let desk = Desk::new();
    let forward = AnyModel::test_bed(ModelName::Stribeck);
    let backward = forward.scaled("f_c", 0.8).unwrap().scaled("f_s", 0.8).unwrap();
    let truth = AnyModel::asymmetric(&forward, &backward).unwrap();
    desk.file("points.csv", &points(&truth, &mut Noise::new(3, 1e-5)));
    desk.ok(&["points.csv", "--model", "stribeck", "--asymmetric", "--out", "out"]);
    let document = desk.json("out");
    let f_c = forward.parameter("f_c").unwrap();
    for (name, expected) in [("f_c.forward", f_c), ("f_c.backward", 0.8 * f_c)] {
        let value = number(&document, &format!("/models/stribeck/parameters/{name}/value"));
        assert!((value / expected - 1.0).abs() < 2e-3, "{name}: {value}");
    }
    // A sensor's zero would be in both, of either sign.
    assert!(document["notes"].to_string().contains("half the difference"), "{}", document["notes"]);
    let models = read_parameter_file(&desk.text("out/parameters.yaml")).unwrap();
    assert!(
        (models.get(ModelName::Stribeck).steady_state(-1.0) / truth.steady_state(-1.0) - 1.0).abs()
            < 1e-3
    );
}

/// Fast sliding alone shows neither the dip nor the stiffness.
#[test]
fn what_the_recordings_do_not_show_is_said_with_a_remedy() {
    let desk = Desk::new();
    let truth = truth(ModelName::LuGre);
    let noise = &mut Noise::new(5, 1e-4);
    let mut text = "velocity_rad_s,torque_Nm\n".to_owned();
    for i in 0..30 {
        let v = 1.0 + 0.1 * f64::from(i);
        writeln!(text, "{v},{:.9}", truth.steady_state(v) + noise.next()).unwrap();
    }
    desk.file("fast.csv", &text);
    let printed = desk.ok(&["fast.csv", "--model", "lugre,coulomb_viscous", "--out", "out"]);
    let document = desk.json("out");
    let parameter = |name: &str| &document["models"]["lugre"]["parameters"][name];
    for (name, said) in [("v_s", "slower constant velocities"), ("sigma0", "not estimated")] {
        assert_eq!(parameter(name)["identified"], false, "{name}");
        assert!(
            parameter(name)["explanation"].as_str().unwrap().contains(said),
            "{name}: {}",
            parameter(name)
        );
    }
    assert_eq!(document["models"]["coulomb_viscous"]["parameters"]["f_v"]["identified"], true);
    // Two parameters say as much as all of LuGre's here.
    assert_eq!(document["ranking"]["by"], "bic");
    assert_eq!(document["ranking"]["order"][0]["model"], "coulomb_viscous", "{printed}");
    assert!(printed.contains("no recording was held out"), "{printed}");
}

#[test]
fn the_result_does_not_depend_on_the_number_of_threads() {
    let desk = Desk::new();
    write_experiments(&desk, &truth(ModelName::LuGre), 1e-3);
    for (jobs, folder) in [("1", "one"), ("4", "four")] {
        desk.ok(&with(&["--no-joint", "--quiet", "--jobs", jobs, "--out", folder]));
    }
    for file in ["identification.json", "report.html", "parameters.yaml"] {
        assert!(desk.text(&format!("one/{file}")) == desk.text(&format!("four/{file}")), "{file}");
    }
}

#[test]
fn the_inertia_computes_the_damping_and_takes_the_drive_away() {
    let desk = Desk::new();
    let truth = truth(ModelName::Proposed);
    write_experiments(&desk, &truth, 0.0);
    desk.ok(&with(&[
        "--model",
        "proposed",
        "--inertia",
        "0.0026:0.00026",
        "--no-joint",
        "--out",
        "computed",
    ]));
    let document = desk.json("computed");
    let at = |what: &str| number(&document, &format!("/models/proposed/parameters/sigma/{what}"));
    // sigma = 2 zeta sqrt(J F_s pi / (2 Z_b)) - f_v; a tenth of the inertia is a twentieth of the
    // root.
    let critical = 1.4 * (0.0026 * 0.0994 * std::f64::consts::PI / 0.012).sqrt();
    assert!((at("value") / (critical - 0.0403) - 1.0).abs() < 0.01, "{}", at("value"));
    assert!((at("standard_error") / (0.05 * critical) - 1.0).abs() < 0.01);

    // The same friction behind an inertia: a driving torque.
    let mut text = "t_s,velocity_rad_s,torque_Nm\n".to_owned();
    for line in desk.text("mixed.csv").lines().skip(1) {
        let cells: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
        let (t, h) = (cells[0], 1e-6);
        let acceleration = (reversing(t + h) - reversing(t - h)) / (2.0 * h);
        writeln!(text, "{t:.4},{:.12},{:.12}", cells[1], cells[2] + 0.0026 * acceleration).unwrap();
    }
    desk.file("driven.csv", &text);
    let driving = ["driven.csv", "points.csv", "--model", "coulomb_viscous", "--out", "driven"];
    let printed =
        desk.ok(&[&driving[..], &["--torque-source", "driving", "--inertia", "0.0026:0.00026"]]
            .concat());
    assert!(printed.contains("standard errors of the drive's constants add"), "{printed}");
    let document = desk.json("driven");
    let f_c = number(&document, "/models/coulomb_viscous/parameters/f_c/value");
    assert!((f_c / 0.0929 - 1.0).abs() < 0.05, "{f_c}");
    // The joint stage listens to the driven recording: what the inertia adds there reaches the
    // parameters.
    let moved =
        number(&document, "/models/coulomb_viscous/parameters/f_c/from_drive/standard_error");
    assert!(moved > 1e-9 && moved < 1e-3, "{moved}");
    let added = number(&document, "/files/0/added_uncertainty/largest");
    assert!(added > 1e-5 && added < 1e-3, "{added}");
    desk.refused(&[&driving[..], &["--torque-source", "driving"]].concat(), &["--inertia J:SE"]);
}

#[test]
fn the_tables_of_the_thesis_stand_beside_what_is_found() {
    let desk = Desk::new();
    write_experiments(&desk, &truth(ModelName::Proposed), 1e-3);
    desk.ok(&with(&["--model", "lugre,proposed", "--no-joint", "--thesis-tables", "--out", "out"]));
    let page = desk.text("out/report.html");
    for part in [
        "Thesis table 4.2",
        "Thesis table 4.4",
        "Thesis table 4.9",
        "Thesis table 4.14",
        "3.7316e-5",
        "no recording was held out",
    ] {
        assert!(page.contains(part), "{part}");
    }
    assert!(!page.contains("Thesis table 4.3"), "GMS was not identified");
}

/// Ctrl-C while sixteen elements are refined: exit code 130, and the best found by then is there.
#[test]
#[cfg(unix)]
fn a_change_of_mind_keeps_the_best_so_far() {
    let desk = Desk::new();
    write_experiments(&desk, &truth(ModelName::Gms), 1e-3);
    let mut child = Command::new(env!("CARGO_BIN_EXE_frictionlab"))
        .current_dir(desk.folder.path())
        .arg("identify")
        .args(with(&[
            "--model",
            "coulomb_viscous,gms,xiong",
            "--elements",
            "16",
            "--jobs",
            "1",
            "--verbose",
            "--out",
            "out",
        ]))
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    // Once it works: wherever it is by then, it ends with what there is; the first model takes a
    // moment, the others minutes.
    let mut told = BufReader::new(child.stderr.take().unwrap());
    let mut said = String::new();
    assert!(told.read_line(&mut said).unwrap() > 0);
    assert!(child.try_wait().unwrap().is_none(), "it was done before it could be stopped");
    assert!(
        Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success()
    );
    told.read_to_string(&mut said).unwrap();
    let status = child.wait().unwrap();
    assert_eq!(status.code(), Some(130), "{said}");
    if said.contains("nothing is written") {
        assert!(!desk.path("out").exists());
        return;
    }
    assert!(said.contains("best found by then is in out"), "{said}");
    assert_eq!(desk.json("out")["interrupted"], true);
    read_parameter_file(&desk.text("out/parameters.yaml")).unwrap();
}

#[test]
fn bad_input_is_refused_with_a_sentence_and_nothing_is_written() {
    let desk = Desk::new();
    let model = truth(ModelName::LuGre);
    desk.file("points.csv", &points(&model, &mut Noise::new(1, 1e-4)));
    let chirp = recording(&model, 500, &|t| chirp(t), &mut Noise::new(1, 1e-4));
    desk.file("chirp.csv", &chirp);
    let lines: Vec<&str> = chirp.lines().collect();
    desk.file("inf.csv", &chirp.replacen(lines[17], "0.0160,inf,0.1", 1));
    desk.file("ragged.csv", &chirp.replacen(lines[17], "0.0160,0.1", 1));
    desk.file("one.csv", &lines[..2].join("\n"));
    desk.file("empty.csv", "");
    desk.file("header.csv", "velocity_rad_s,torque_Nm\n");
    desk.file("torqueless.csv", &chirp.replacen("torque_Nm", "u", 1));
    desk.file("few.csv", "velocity_rad_s,torque_Nm\n0.1,0.1\n0.2,0.1\n");
    desk.file(
        "deviation.csv",
        &format!("{}0.1,0.1,-1\n", "velocity_rad_s,torque_Nm,torque_deviation_Nm\n"),
    );
    let turned = |line: &str| {
        line.split_once(',').map(|(v, f)| format!("{v},{}", -f.parse::<f64>().unwrap()))
    };
    let turned: Vec<String> = desk.text("points.csv").lines().skip(1).filter_map(turned).collect();
    desk.file("turned.csv", &format!("velocity_rad_s,torque_Nm\n{}\n", turned.join("\n")));
    for (file, parts) in [
        ("absent.csv", &["absent.csv", "cannot be read"][..]),
        ("inf.csv", &["inf.csv", "line 18", "velocity_rad_s", "finite number"]),
        ("ragged.csv", &["line 18", "2 fields"]),
        ("one.csv", &["1 samples"]),
        ("empty.csv", &["empty"]),
        ("header.csv", &["no samples"]),
        ("torqueless.csv", &["force", "--force-column"]),
    ] {
        desk.refused(&["points.csv", file], parts);
        desk.refused(&["points.csv", "chirp.csv", "--validate", file], parts);
    }
    desk.refused(&["few.csv"], &["few.csv", "2", "steady points"]);
    desk.refused(&["deviation.csv"], &["deviation.csv"]);
    desk.refused(&["turned.csv"], &["turned.csv", "sign", "--force-column NAME:-SCALE"]);
    for (option, value, part) in [
        ("--model", "lugri", "lugri"),
        ("--model", "karnopp", "stage by stage"),
        ("--inertia", "-1", "inertia above zero"),
        ("--inertia", "0.1:-2", "standard error"),
        ("--inertia", "heavy", "0.0026"),
        ("--damping-ratio", "0", "--damping-ratio"),
        ("--elements", "17", "--elements"),
        ("--elements", "0", "--elements"),
        ("--reach", "-1", "--reach"),
        ("--smooth", "hard", "sg"),
        ("--torque-source", "guess", "voltage"),
        ("--torque-source", "voltage", "--inertia"),
        ("--decimate", "0", "decimation"),
    ] {
        desk.refused(&["points.csv", "chirp.csv", option, value], &[part]);
    }
}

/// Its weight was infinite, and the singular value decomposition behind it panicked.
#[test]
fn a_standard_deviation_of_nearly_nothing_is_refused_and_named() {
    let desk = Desk::new();
    let mut text = "velocity_rad_s,torque_Nm,torque_deviation_Nm\n".to_owned();
    for k in 1..=24 {
        let v = 0.05 * f64::from(k);
        let torque = 0.0925 + 0.0069 * (-(v / 0.1407_f64).powi(2)).exp() + 0.0403 * v;
        writeln!(text, "{v},{torque},{}", if k == 7 { "1e-320" } else { "1e-3" }).unwrap();
    }
    desk.file("steady.csv", &text);
    desk.refused(&["steady.csv"], &["steady point 6", "1e-320", "leave the deviations out"]);
}
