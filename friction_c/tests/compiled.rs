//! C and C++ against the header and the libraries, under the sanitizers, held against Rust to the
//! last bit.

use std::ffi::OsString;
use std::fmt::Write as _;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use friction_model::{AnyModel, AnyParameters, ModelName, Regime, Scheme, TimeStep};
use friction_observer::{EstimatorOptions, FrictionEstimator, Seen};
use tempfile::TempDir;

/// Which library a program is linked with.
#[derive(Debug, Clone, Copy)]
enum Library {
    Static,
    Shared,
}

/// The folder with `libfriction.a` and `libfriction.so`: cargo builds them beside the test.
fn libraries() -> PathBuf {
    std::env::current_exe().unwrap().parent().unwrap().to_owned()
}

fn here() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

const MEMORY: &str = "address,undefined";

/// Compiles a source of this folder with all warnings and both sanitizers of memory.
fn compiled(source: &str, library: Library, into: &TempDir) -> Command {
    built(&[here().join(source)], &[], &[], MEMORY, library, into)
}

/// Compiles sources with all warnings and some sanitizers. Headers are looked for in `include`, then
/// in the folders that `flags` name.
fn built(
    sources: &[PathBuf],
    include: &[PathBuf],
    flags: &[OsString],
    sanitizers: &str,
    library: Library,
    into: &TempDir,
) -> Command {
    let (compiler, standard) = match sources[0].extension().unwrap().to_str().unwrap() {
        "c" => ("cc", "-std=c11"),
        _ => ("c++", "-std=c++17"),
    };
    let program = into.path().join("program");
    let libraries = libraries();
    let mut compile = Command::new(compiler);
    compile
        .args([standard, "-g", "-Wall", "-Wextra", "-Wpedantic", "-Werror"])
        .args([&format!("-fsanitize={sanitizers}"), "-fno-sanitize-recover=all"])
        .args(
            include
                .iter()
                .chain([&here().join("include")])
                .flat_map(|folder| [OsString::from("-I"), folder.into()]),
        )
        .args(flags)
        .args(sources)
        .arg("-o")
        .arg(&program);
    match library {
        Library::Static => compile.arg(libraries.join("libfriction.a")),
        Library::Shared => compile
            .arg(libraries.join("libfriction.so"))
            .arg(format!("-Wl,-rpath,{}", libraries.display())),
    };
    compile.args(["-lpthread", "-ldl", "-lm"]);
    let said = compile.output().expect("a C compiler, as cargo itself needs one");
    assert!(said.status.success(), "{}", String::from_utf8_lossy(&said.stderr));
    Command::new(program)
}

/// What a program says, given `input`.
fn said(mut program: Command, input: &str) -> String {
    program.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut running = program.spawn().unwrap();
    let mut stdin = running.stdin.take().unwrap();
    let input = input.to_owned();
    let writing = std::thread::spawn(move || stdin.write_all(input.as_bytes()));
    let output = running.wait_with_output().unwrap();
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{}: {errors}", output.status);
    writing.join().unwrap().unwrap();
    String::from_utf8(output.stdout).unwrap()
}

/// Stick, creep, slide, and back: with numbers that no decimal text would carry whole.
fn velocities() -> impl Iterator<Item = f64> {
    (0..400).map(|k| {
        let t = f64::from(k) * 1e-3;
        0.4 * (19.0 * t).sin() * (3.0 * t).cos() + 0.001 * (301.0 * t).sin()
    })
}

/// Every model, twice where directions differ, and both schemes.
fn cases() -> Vec<(ModelName, AnyModel, Scheme, String)> {
    let mut cases = Vec::new();
    for name in ModelName::ALL {
        let parameters = AnyParameters::test_bed(name);
        let weaker = AnyParameters::chapter_3(name);
        for scheme in [Scheme::Held, Scheme::Mean] {
            for two in [false, true] {
                let mut text = format!("model {name} {}\n", i32::from(scheme == Scheme::Mean));
                let mut say = |prefix: &str, of: &AnyParameters| {
                    for row in of.table() {
                        for value in of.values(row.name) {
                            let bits = value.to_bits();
                            writeln!(text, "value {prefix}{} {bits:016x}", row.name).unwrap();
                        }
                    }
                };
                let model = if two {
                    say("forward.", &parameters);
                    say("backward.", &weaker);
                    AnyParameters::asymmetric(parameters, weaker).unwrap().try_into().unwrap()
                } else {
                    say("", &parameters);
                    AnyModel::test_bed(name)
                };
                cases.push((name, model, scheme, text));
            }
        }
    }
    cases
}

#[test]
fn every_model_computes_in_c_what_it_computes_in_rust() {
    let dt = TimeStep::new(1e-3).unwrap();
    let (mut input, mut expected) = (String::new(), String::new());
    for (name, model, scheme, text) in cases() {
        input += &text;
        input += "run\n";
        writeln!(expected, "{name}").unwrap();
        let mut stepper = model.start_by(scheme, dt);
        let options = EstimatorOptions { scheme, ..EstimatorOptions::default() };
        let mut estimator = FrictionEstimator::new(&model, options, dt).unwrap();
        for velocity in velocities() {
            writeln!(input, "{:016x}", velocity.to_bits()).unwrap();
            let friction = stepper.step(velocity);
            let inner = stepper.internals(velocity);
            let estimate = estimator.estimate(&Seen { velocity, ..Seen::default() });
            for (torque, deflection, gamma, regime) in [
                (friction, inner.deflection, inner.gamma, inner.regime),
                (estimate.torque, estimate.deflection, estimate.gamma, estimate.regime),
            ] {
                let bits = [torque, deflection, gamma].map(f64::to_bits);
                let slip = u8::from(regime == Regime::Slip);
                let [torque, deflection, gamma] = bits;
                write!(expected, "{torque:016x} {deflection:016x} {gamma:016x} {slip} ").unwrap();
            }
            expected.pop();
            expected.push('\n');
        }
        input += "end\n";
    }
    let folder = tempfile::tempdir().unwrap();
    for library in [Library::Static, Library::Shared] {
        let said = said(compiled("tests/c/bits.c", library, &folder), &input);
        assert_eq!(said.lines().count(), expected.lines().count(), "{library:?}");
        for (line, (theirs, ours)) in said.lines().zip(expected.lines()).enumerate() {
            assert_eq!(theirs, ours, "{library:?}, line {line}");
        }
    }
}

#[test]
fn what_is_wrong_is_refused_in_c() {
    let folder = tempfile::tempdir().unwrap();
    for library in [Library::Static, Library::Shared] {
        said(compiled("tests/c/refusals.c", library, &folder), "");
    }
}

#[test]
fn the_example_in_c_tells_the_friction() {
    let folder = tempfile::tempdir().unwrap();
    let said = said(compiled("examples/step.c", Library::Static, &folder), "");
    let last = said.lines().last().unwrap();
    assert_eq!(said.lines().count(), 11, "{said}");
    assert!(last.starts_with("1.0 s") && last.contains("0.500 rad/s"), "{last}");
    let torque: f64 = last.split_whitespace().rev().nth(2).unwrap().parse().unwrap();
    assert!((torque - (0.09 + 0.04 * 0.5)).abs() < 2e-3, "{last}");
}

#[test]
fn the_example_in_cplusplus_reads_the_files_of_the_programs() {
    let folder = tempfile::tempdir().unwrap();
    let file = here().join("../launch_configs/config/friction_observer.yaml");
    let mut program = compiled("examples/observer.cpp", Library::Shared, &folder);
    program.arg(&file);
    let said = said(program, "");
    let mut lines = said.lines();
    assert_eq!(lines.next(), Some("proposed"));
    let model = AnyModel::test_bed(ModelName::Proposed);
    let dt = TimeStep::new(1e-3).unwrap();
    let mut estimator = FrictionEstimator::new(&model, EstimatorOptions::default(), dt).unwrap();
    for k in 0..1000 {
        let velocity = f64::from(k) / 1024.0 - 0.5;
        let torque = estimator.estimate(&Seen { velocity, ..Seen::default() }).torque;
        let theirs = from_hexadecimal(lines.next().unwrap());
        assert_eq!(theirs.to_bits(), torque.to_bits(), "cycle {k}: {theirs} and {torque}");
    }
}

/// The package of the controller for ros2_control.
fn controller() -> PathBuf {
    here().join("../ros/friction_compensation_controller")
}

/// Declarations of our own, where no other header of the name is found.
fn declared() -> [OsString; 2] {
    ["-idirafter".into(), controller().join("test/declared").into()]
}

/// Programs of the controller.
fn of_the_controller(sources: &[&str], flags: &[OsString], sanitizers: &str) -> String {
    let sources: Vec<_> = sources.iter().map(|name| controller().join(name)).collect();
    let include = [controller().join("include")];
    let folder = tempfile::tempdir().unwrap();
    let mut program = built(&sources, &include, flags, sanitizers, Library::Static, &folder);
    program.arg(here().join("../launch_configs/config/friction_observer.yaml"));
    said(program, "")
}

#[test]
fn the_core_of_the_controller_adds_friction_and_never_more_than_it_may() {
    for sanitizers in [MEMORY, "thread"] {
        let sources = ["test/compensation_test.cpp", "src/compensation.cpp"];
        assert_eq!(of_the_controller(&sources, &[], sanitizers), "passed\n");
    }
}

/// Not that it builds with ros2_control: see `test/declared/README.md` there.
#[test]
fn the_code_of_the_plugin_does_what_it_says_against_declarations_of_our_own() {
    assert_eq!(of_the_controller(&PLUGIN, &declared(), MEMORY), "passed\n");
}

const PLUGIN: [&str; 3] =
    ["test/controller_test.cpp", "src/controller.cpp", "src/compensation.cpp"];

/// The messages are those that the generators of ROS make; the rest is declared by us.
#[tests::needs(rclpy)]
#[test]
fn the_code_of_the_plugin_takes_the_messages_that_ros_generates() {
    let python = tests::python::interpreter("rclpy");
    let generated = python.parent().unwrap().parent().unwrap().join("include");
    let folders = generated.read_dir().unwrap().map(|folder| folder.unwrap().path());
    let mut flags = vec![OsString::from("-DGENERATED_MESSAGES")];
    flags.extend(folders.flat_map(|folder| [OsString::from("-isystem"), folder.into()]));
    flags.extend(declared());
    assert_eq!(of_the_controller(&PLUGIN, &flags, MEMORY), "passed\n");
}

/// A number as `%a` prints it.
fn from_hexadecimal(text: &str) -> f64 {
    let (sign, text) = text.strip_prefix('-').map_or((1.0, text), |text| (-1.0, text));
    let (digits, exponent) = text.strip_prefix("0x").unwrap().split_once('p').unwrap();
    let (whole, fraction) = digits.split_once('.').unwrap_or((digits, ""));
    let mantissa = u64::from_str_radix(&format!("{whole}{fraction}"), 16).unwrap();
    let exponent = exponent.parse::<i32>().unwrap() - 4 * i32::try_from(fraction.len()).unwrap();
    sign * mantissa as f64 * 2f64.powi(exponent)
}
