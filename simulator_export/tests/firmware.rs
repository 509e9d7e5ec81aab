//! The C header, compiled by the machine's compiler and stepped beside our own models.

use std::fmt::Write as _;
use std::io::Write as _;
use std::path::Path;
use std::process::{Command, Stdio};

use friction_model::{AnyModel, ModelName, TimeStep};
use simulator_export::{Given, Options, Target, export};

/// The period of the steps \[s\].
const PERIOD: f64 = 1e-3;

/// Models that the header has itself.
fn models() -> Vec<AnyModel> {
    let mut models: Vec<AnyModel> = [
        ModelName::Coulomb,
        ModelName::Viscous,
        ModelName::CoulombViscous,
        ModelName::Stribeck,
        ModelName::Dahl,
        ModelName::LuGre,
    ]
    .map(AnyModel::test_bed)
    .to_vec();
    // Another exponent, micro-damping that falls, and a contact of each direction.
    let lugre = AnyModel::test_bed(ModelName::LuGre);
    let mut parameters = lugre.parameters();
    parameters.set("delta", 1.3);
    models.push(parameters.try_into().unwrap());
    let text = r#"{"lugre":{"f_s":0.12,"f_c":0.09,"v_s":0.1,"sigma0":30.0,"sigma1":0.2,"v_d":0.3,"f_v":0.02}}"#;
    let falling: AnyModel = serde_json::from_str(text).unwrap();
    models.push(falling);
    models.push(AnyModel::asymmetric(&lugre, &falling).unwrap());
    let stribeck = AnyModel::test_bed(ModelName::Stribeck);
    models.push(AnyModel::asymmetric(&stribeck, &stribeck.scaled("f_v", 0.5).unwrap()).unwrap());
    models
}

/// Slow and fast, to and fro, at rest, and what no sensor should say.
fn velocities() -> Vec<f64> {
    let moving = (0..4000).map(|k| {
        let t = PERIOD * f64::from(k);
        2.0 * (3.0 * t).sin() * (0.7 * t).cos() + 0.05 * (40.0 * t).sin()
    });
    moving.chain([0.0, -0.0, f64::NAN, 1e9, -1e9, 0.3]).collect()
}

fn header(model: AnyModel, joint: &str) -> String {
    let given = Given::new(model, "parameters.yaml", "", None, None).unwrap();
    let options =
        Options { joint: joint.to_owned(), accept_unidentified: true, ..Options::default() };
    let exported = export(&given, Target::CHeader, None, &options).unwrap();
    assert_eq!(exported.cost.swings.worst, 0.0, "{joint}");
    exported.text
}

/// The program that steps every header, compiled with these options.
fn compiled(folder: &Path, count: usize, options: &[&str]) -> std::path::PathBuf {
    let mut main = String::from("#include <stdio.h>\n");
    for k in 0..count {
        writeln!(main, "#include \"joint_{k}.h\"").unwrap();
    }
    writeln!(main, "int main(void) {{\n    double v;").unwrap();
    for k in 0..count {
        writeln!(main, "    friction_state s{k} = {{{{0}}}};").unwrap();
    }
    writeln!(main, "    while (scanf(\"%lf\", &v) == 1) {{").unwrap();
    for k in 0..count {
        writeln!(
            main,
            "        printf(\"%.17g \", (double)joint_{k}_friction_step(&s{k}, (FRICTION_REAL)v, (FRICTION_REAL){PERIOD:?}));"
        )
        .unwrap();
    }
    writeln!(main, "        printf(\"\\n\");\n    }}\n    return 0;\n}}").unwrap();
    std::fs::write(folder.join("main.c"), main).unwrap();
    let program = folder.join("step");
    let output = Command::new("cc")
        .current_dir(folder)
        .args(["-std=c99", "-O1", "-Wall", "-Wextra", "-Wconversion", "-Werror"])
        .args(options)
        .args(["main.c", "-o", "step", "-lm"])
        .output()
        .expect("a C compiler, which building the laboratory needs too");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    program
}

#[test]
fn the_header_steps_as_our_own_models_do() {
    let folder = tempfile::tempdir().unwrap();
    let models = models();
    for (k, model) in models.iter().enumerate() {
        let name = format!("joint_{k}");
        std::fs::write(folder.path().join(format!("{name}.h")), header(*model, &name)).unwrap();
    }
    let double = [
        "-DFRICTION_REAL=double",
        "-DFRICTION_EXP=exp",
        "-DFRICTION_POW=pow",
        "-DFRICTION_ABS=fabs",
    ];
    for (options, tolerance) in [(&double[..], 1e-12), (&[][..], 2e-5)] {
        let program = compiled(folder.path(), models.len(), options);
        let mut run =
            Command::new(program).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
        let velocities = velocities();
        let text: String = velocities.iter().map(|v| format!("{v:?}\n")).collect();
        let mut input = run.stdin.take().unwrap();
        let writer = std::thread::spawn(move || input.write_all(text.as_bytes()));
        let output = run.wait_with_output().unwrap();
        writer.join().unwrap().unwrap();
        let said = String::from_utf8(output.stdout).unwrap();
        let dt = TimeStep::new(PERIOD).unwrap();
        let mut ours: Vec<_> = models.iter().map(|model| model.start(dt)).collect();
        assert_eq!(said.lines().count(), velocities.len());
        for (line, v) in said.lines().zip(&velocities) {
            for (k, (own, theirs)) in ours.iter_mut().zip(line.split_whitespace()).enumerate() {
                let (own, theirs) = (own.step(*v), theirs.parse::<f64>().unwrap());
                assert!(
                    (own - theirs).abs() <= tolerance * own.abs().max(0.1),
                    "{:?} at {v}: {own}, {theirs} in C",
                    models[k]
                );
            }
        }
    }
}

/// What the header does not have itself is the nearest that it has, and says so.
#[test]
fn other_models_are_fitted() {
    for name in [ModelName::Gms, ModelName::ElastoPlastic, ModelName::Proposed] {
        let model = AnyModel::test_bed(name);
        let given = Given::new(model, "parameters.yaml", "", None, None).unwrap();
        let options =
            Options { accept_unidentified: true, accept_error: true, ..Options::default() };
        let exported = export(&given, Target::CHeader, None, &options).unwrap();
        assert!(exported.cost.swings.rms > 0.0 && !exported.lost.is_empty(), "{name}");
        assert!(exported.text.contains("beyond LuGre"), "{}", exported.text);
    }
}
