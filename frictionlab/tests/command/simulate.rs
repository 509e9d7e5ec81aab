//! `frictionlab models` and `frictionlab simulate`, as a person uses them: the built program, files
//! in, files and words out.

use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use friction_model::ModelName;
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

    fn names(&self) -> Vec<String> {
        let entries = fs::read_dir(self.folder.path()).unwrap();
        let mut names: Vec<_> =
            entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    fn run(&self, args: &[&str]) -> Output {
        let program = env!("CARGO_BIN_EXE_frictionlab");
        Command::new(program).current_dir(self.folder.path()).args(args).output().unwrap()
    }

    /// Runs it, expects success, and returns what it printed.
    fn ok(&self, args: &[&str]) -> String {
        let output = self.run(args);
        assert!(output.status.success(), "{args:?}: {}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8(output.stdout).unwrap()
    }

    /// Runs it, expects it to refuse in one paragraph with exit code 2 and to leave the folder as
    /// it was; the paragraph must contain all `parts`.
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

    /// The file `friction.csv`: its header, and its rows.
    fn result(&self) -> (Vec<String>, Vec<Vec<String>>) {
        let text = fs::read_to_string(self.path("friction.csv")).unwrap();
        let mut lines =
            text.lines().map(|line| line.split(',').map(str::to_owned).collect::<Vec<_>>());
        let head = lines.next().unwrap();
        let rows: Vec<_> = lines.collect();
        assert!(rows.iter().all(|row| row.len() == head.len()));
        (head, rows)
    }

    fn column(&self, name: &str) -> Vec<f64> {
        let (head, rows) = self.result();
        let index = head.iter().position(|other| other == name).unwrap();
        rows.iter().map(|row| row[index].parse().unwrap()).collect()
    }
}

/// The motion of `friction_model/tests/reference/ref_testbed.csv`, at steps of .4 and .6 ms in
/// turn.
fn test_bed_motion() -> String {
    let mut text = "t_s,velocity_rad_s\n".to_owned();
    for k in 0..=16_000 {
        let t = 0.5e-3 * f64::from(k) - if k % 2 == 1 { 0.1e-3 } else { 0.0 };
        writeln!(text, "{t},{}", 0.3 * (1.5 * t).sin() + 0.05 * (9.0 * t).sin()).unwrap();
    }
    text
}

#[test]
fn lugre_and_the_proposed_model_follow_the_reference() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../friction_model/tests/reference");
    let reference = fs::read_to_string(folder.join("ref_testbed.csv")).unwrap();
    let mut lines = reference.lines();
    let head: Vec<_> = lines.next().unwrap().split(',').collect();
    let rows: Vec<Vec<f64>> =
        lines.map(|line| line.split(',').map(|cell| cell.parse().unwrap()).collect()).collect();
    assert_eq!(rows.len(), 800);

    let desk = Desk::new();
    desk.file("motion.csv", &test_bed_motion());
    for (model, column) in [("lugre", "LuGre"), ("proposed", "Proposed")] {
        let common =
            ["--force", "--model", model, "--velocity", "motion.csv", "--out", "friction.csv"];
        let printed =
            desk.ok(&[&["simulate", "--scheme", "rk4", "--dt", "1e-5"][..], &common].concat());
        assert!(printed.contains("16001 rows") && printed.contains("friction.csv"), "{printed}");
        let index = head.iter().position(|name| *name == column).unwrap();
        let largest = || {
            let forces = desk.column("torque_Nm");
            let every_10_ms = forces.iter().step_by(20).zip(&rows);
            every_10_ms.map(|(force, row)| (force - row[index]).abs()).fold(0.0, f64::max)
        };
        assert!(largest() < 1e-6, "{model}: {} N m from the reference", largest());
        desk.ok(&[&["simulate", "--quiet"][..], &common].concat());
        assert!(largest() < 1e-6, "{model}, mean: {} N m from the reference", largest());
        // The velocity held over steps of 10 us is half a step late.
        desk.ok(&[&["simulate", "--quiet", "--scheme", "held"][..], &common].concat());
        assert!(largest() < 2e-5, "{model}, held: {} N m from the reference", largest());
    }
}

#[test]
fn every_model_can_be_listed_and_simulated_from_its_own_file() {
    let desk = Desk::new();
    let mut motion = "t_s,velocity_m_s,load_N\n".to_owned();
    for k in 0..=100 {
        let t = 0.01 * f64::from(k);
        writeln!(motion, "{t},{},{}", 0.3 * (6.0 * t).sin(), k).unwrap();
    }
    desk.file("motion.csv", &motion);
    let list = desk.ok(&["models"]);
    for name in ModelName::ALL {
        let (name, title) = (name.as_str(), name.title());
        let line = list.lines().find(|line| line.starts_with(&format!("{name} "))).unwrap();
        assert!(line.contains(title), "{line}");
        let sheet = desk.ok(&["models", name]);
        assert!(sheet.starts_with(&format!("{title} ({name})\n")), "{sheet}");
        assert_eq!(desk.ok(&["models", "--model", name]), sheet);

        for set in ["test-bed", "chapter-3"] {
            desk.file("params.yaml", &desk.ok(&["models", name, "--yaml", "--set", set]));
            let common = [
                "simulate",
                "--force",
                "--params",
                "params.yaml",
                "--velocity",
                "motion.csv",
                "--out",
                "friction.csv",
            ];
            for scheme in ["mean", "held", "rk4"] {
                assert_eq!(desk.ok(&[&common[..], &["--scheme", scheme, "-q"]].concat()), "");
                let (head, rows) = desk.result();
                let start = ["t_s", "velocity_m_s", "force_N", "deflection_m", "gamma_N", "regime"];
                assert_eq!(head[..6], start, "{name}");
                assert_eq!(rows.len(), 101, "{name}, {set}, {scheme}");
                for row in &rows {
                    for (cell, head) in row.iter().zip(&head) {
                        if head == "regime" {
                            assert!(cell == "stick" || cell == "slip", "{name}: {cell}");
                        } else {
                            assert!(
                                cell.parse::<f64>().unwrap().is_finite(),
                                "{name}, {head}: {cell}"
                            );
                        }
                    }
                }
                // Friction opposes a motion that has gone on for a while.
                let (forces, velocities) = (desk.column("force_N"), desk.column("velocity_m_s"));
                let at = |t: f64| (100.0 * t) as usize;
                for t in [0.26, 0.78] {
                    assert!(
                        forces[at(t)] * velocities[at(t)] > 0.0,
                        "{name}, {set}, {scheme} at {t} s"
                    );
                }
            }
            desk.ok(&[&common[..], &["--load-gain", "0.1"]].concat());
            assert_eq!(desk.result().0[2], "load_N");
        }
    }
}

#[test]
fn asymmetric_files_and_the_file_of_a_run_are_accepted() {
    let desk = Desk::new();
    desk.file("motion.csv", "t_s,velocity_rad_s\n0,1\n5,1\n5.001,-1\n10,-1\n");
    let side = |f_c: f64| {
        format!("{{f_s: {f_c}, f_c: {f_c}, v_s: 0.1, sigma0: 20.0, sigma1: 0.1, f_v: 0.0}}")
    };
    let (forward, backward) = (side(0.2), side(0.3));
    let common =
        ["simulate", "--force", "--velocity", "motion.csv", "--out", "friction.csv", "--params"];
    let ends = |files: &[&str]| {
        desk.ok(&[&common[..], files, &["-q", "--dt", "1e-3"]].concat());
        let forces = desk.column("torque_Nm");
        assert!(
            (forces[1] - 0.2).abs() < 1e-9 && (forces[3] + 0.3).abs() < 1e-9,
            "{files:?}: {forces:?}"
        );
    };
    let both = format!("lugre: {{forward: {forward}, backward: {backward}}}");
    desk.file("both.yaml", &format!("asymmetric: {{{both}}}\n"));
    ends(&["both.yaml"]);
    assert!(desk.result().0.ends_with(&["state_1".to_owned(), "state_2".to_owned()]));
    desk.file("bare.yaml", &format!("forward: {forward}\nbackward: {backward}\n"));
    ends(&["bare.yaml", "--model", "lugre"]);
    desk.file(
        "ros.yaml",
        &format!(
            "/friction_observer:\n  ros__parameters:\n    model: lugre\n    coulomb: {{f_c: 1.0}}\n    asymmetric: {{{both}}}\n"
        ),
    );
    ends(&["ros.yaml"]);
    desk.refused(
        &[&common[..], &["ros.yaml", "--model", "viscous"]].concat(),
        &["ros.yaml", "viscous"],
    );
}

#[test]
fn bad_input_is_refused_and_nothing_is_written() {
    let desk = Desk::new();
    desk.file("motion.csv", "t_s,velocity_rad_s\n0,0\n1,0.1\n");
    let simulate = |args: &[&str], parts: &[&str]| {
        let given = |option| args.contains(&option);
        let mut all = vec!["simulate"];
        all.extend(args);
        if !given("--velocity") {
            all.extend(["--velocity", "motion.csv"]);
        }
        if !given("--out") {
            all.extend(["--out", "friction.csv"]);
        }
        desk.refused(&all, parts);
    };
    let motions: [(&str, &str, &[&str]); 9] = [
        ("empty.csv", "", &["empty.csv", "empty", "header"]),
        ("bare.csv", "0,1\n1,2\n", &["line 1 of bare.csv", "t_s,velocity_rad_s"]),
        ("no_rows.csv", "t_s,velocity_rad_s\n", &["no_rows.csv", "no samples"]),
        (
            "no_time.csv",
            "when,velocity_rad_s\n0,1\n",
            &["no column with the time", "t_s", "when, velocity_rad_s"],
        ),
        (
            "no_velocity.csv",
            "t_s,v\n0,1\n",
            &["no column with the velocity", "velocity_rad_s or velocity_m_s"],
        ),
        (
            "nan.csv",
            "t_s,velocity_rad_s\n0,1\n1,NaN\n",
            &["line 3 of nan.csv", "velocity_rad_s", "finite number", "NaN"],
        ),
        ("word.csv", "t_s,velocity_rad_s\n0,fast\n", &["line 2", "fast"]),
        ("short.csv", "t_s,velocity_rad_s\n0,1\n1\n", &["line 3", "damaged"]),
        ("back.csv", "t_s,velocity_rad_s\n0,1\n1,1\n1,1\n", &["line 4", "time does not increase"]),
    ];
    for (name, content, parts) in motions {
        desk.file(name, content);
        simulate(&["--model", "lugre", "--velocity", name], parts);
    }
    simulate(&["--model", "lugre", "--velocity", "absent.csv"], &["absent.csv", "cannot be read"]);

    simulate(&[], &["--model"]);
    simulate(&["--model", "lugree"], &["lugree", "expected one of", "lugre"]);
    simulate(&["--params", "absent.yaml"], &["absent.yaml"]);
    let files: [(&str, &str, &[&str]); 5] = [
        ("unknown.yaml", "coulomb: {f_c: 1.0, f_x: 1.0}", &["unknown.yaml", "`coulomb`", "f_x"]),
        (
            "range.yaml",
            "coulomb: {f_c: -1.0}",
            &["range.yaml", "coulomb.f_c", "above zero", "-1 N m"],
        ),
        ("missing.yaml", "viscous: {}", &["missing.yaml", "f_v"]),
        ("nameless.yaml", "f_c: 1.0", &["nameless.yaml", "names no model", "--model"]),
        ("broken.yaml", "lugre: {f_s: [", &["broken.yaml", "cannot be used"]),
    ];
    for (name, content, parts) in files {
        desk.file(name, content);
        simulate(&["--params", name], parts);
    }

    simulate(&["--model", "lugre", "--dt", "0.02"], &["--dt", "0.01 s", "0.02"]);
    simulate(&["--model", "lugre", "--dt", "-1", "--scheme", "rk4"], &["--dt", "above zero", "-1"]);
    simulate(&["--model", "lugre", "--load-gain", "0.5"], &["--load-gain", "load_Nm"]);
    simulate(&["--model", "lugre", "--load-gain", "-1"], &["--load-gain", "zero or more", "-1"]);
    simulate(&["--model", "lugre", "--out", "motion.csv"], &["motion.csv", "is read"]);
    desk.file("taken", "");
    simulate(
        &["--model", "lugre", "--out", "taken/friction.csv"],
        &["taken/friction.csv", "--out"],
    );
    fs::create_dir(desk.path("folder")).unwrap();
    simulate(&["--model", "lugre", "--out", "folder"], &["folder", "--out"]);
    desk.refused(&["models", "--yaml"], &["--yaml", "frictionlab models lugre --yaml"]);
    desk.refused(&["models", "lugri"], &["lugri"]);
}

/// A step that is too long for Runge and Kutta is halved, and that is told.
#[test]
fn a_step_that_is_too_long_is_halved_and_told() {
    let desk = Desk::new();
    desk.file("motion.csv", "t_s,velocity_m_s\n0,0.5\n1,0.5\n2,0.5\n");
    desk.file("stiff.yaml", &desk.ok(&["models", "lugre", "--yaml", "--set", "chapter-3"]));
    let common = [
        "simulate",
        "--force",
        "--params",
        "stiff.yaml",
        "--velocity",
        "motion.csv",
        "--out",
        "friction.csv",
        "--dt",
        "1e-3",
    ];
    let with = |scheme| [&common[..], &["--scheme", scheme]].concat();
    for scheme in ["rk4", "mean", "held"] {
        let said = desk.ok(&with(scheme));
        assert_eq!(said.contains("halved to hold the tolerance of 0.000001"), scheme == "rk4");
        let forces = desk.column("force_N");
        // The tolerance is a part of the largest force.
        let largest = forces[0].max(1.0);
        assert!((forces[2] - 1.0).abs() < 1e-6 * largest, "{scheme}: {forces:?}");
    }
    desk.refused(&[&with("rk4")[..], &["--tolerance", "2"]].concat(), &["--tolerance", "2"]);
    let idle = [&with("mean")[..], &["--tolerance", "1e-9"]].concat();
    desk.refused(&idle, &["--tolerance", "--scheme rk4"]);
}
