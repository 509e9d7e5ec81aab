//! Exported friction, run in real simulators beside our own model: a body on one joint, driven by a
//! torque that nothing was fitted to.

use std::io::Write;
use std::path::Path;
use std::process::{Command, Stdio};

use friction_model::{AnyModel, Body, Drive, FrictionModel, ModelName, ModelVisitor};
use serde::Deserialize;
use serde_json::json;
use simulator_export::{Exported, Given, Options, Speeds, SpeedsFrom, Target, Version, export};

/// Inertia of the body \[kg m^2\]: that of the thesis's test bed.
pub const INERTIA: f64 = 0.002_647_6;
/// Step of both \[s\].
pub const STEP: f64 = 1e-4;
/// Steps between two rows that are compared.
const EVERY: usize = 10;
/// Seconds of the torque.
const DURATION: f64 = 8.0;
/// The joint's name.
pub const JOINT: &str = "elbow";

/// Where a body went.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Motion {
    /// Who computed it.
    pub version: String,
    /// Control inputs of the model.
    pub inputs: usize,
    /// Position \[rad\] at every tenth step.
    pub position: Vec<f64>,
    /// Velocity \[rad/s\] there.
    pub velocity: Vec<f64>,
}

/// How far two motions are apart.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Apart {
    /// Root mean square of the difference of the positions \[rad\].
    pub rms: f64,
    /// The largest \[rad\].
    pub worst: f64,
    /// Root mean square of the first one's position about its mean \[rad\].
    pub motion: f64,
}

impl Apart {
    /// How far `other` is from `own`.
    #[must_use]
    pub fn of(own: &Motion, other: &Motion) -> Self {
        let count = own.position.len() as f64;
        let mean = own.position.iter().sum::<f64>() / count;
        let rms = |values: &mut dyn Iterator<Item = f64>| {
            (values.map(|x| x * x).sum::<f64>() / count).sqrt()
        };
        let difference = || own.position.iter().zip(&other.position).map(|(a, b)| a - b);
        Self {
            rms: rms(&mut difference()),
            worst: difference().fold(0.0, |most, x| f64::max(most, x.abs())),
            motion: rms(&mut own.position.iter().map(|x| x - mean)),
        }
    }

    /// The difference as a share of the motion \[%\].
    #[must_use]
    pub fn percent(&self) -> f64 {
        100.0 * self.rms / self.motion
    }
}

/// Frictions that are run: a name, the model, and the rms difference of the motion that is allowed
/// where the simulator holds all of it, in per cent.
///
/// # Panics
/// Never: the numbers are constants within range.
#[must_use]
pub fn frictions() -> Vec<(&'static str, AnyModel)> {
    let lugre = AnyModel::test_bed(ModelName::LuGre);
    let mut sticky = lugre.parameters();
    for (name, value) in [
        ("f_s", 0.15),
        ("f_c", 0.08),
        ("v_s", 0.05),
        ("sigma0", 60.0),
        ("sigma1", 0.3),
        ("f_v", 0.02),
    ] {
        sticky.set(name, value);
    }
    vec![
        ("lugre", lugre),
        ("lugre, stiff and sticky", AnyModel::try_from(sticky).expect("constants within range")),
        ("dahl", AnyModel::test_bed(ModelName::Dahl)),
        ("gms", AnyModel::test_bed(ModelName::Gms)),
        ("coulomb_viscous", AnyModel::test_bed(ModelName::CoulombViscous)),
        ("stribeck", AnyModel::test_bed(ModelName::Stribeck)),
    ]
}

/// A torque that makes the body stick, bend, slip and turn \[N m\]; `kind` chooses among several,
/// so that what was recorded under one is tried under another.
#[must_use]
pub fn torque(level: f64, kind: u32) -> Vec<f64> {
    let shift = f64::from(kind);
    let steps = (DURATION / STEP).round() as u32;
    (0..steps)
        .map(|k| {
            let t = STEP * f64::from(k);
            let slow = 1.2 * ((3.1 + 0.7 * shift) * t).sin();
            let fast = 0.7 * ((11.0 - 1.3 * shift) * t + 0.4 * shift).sin();
            // Below breakaway for a while: the contact bends and comes back.
            let share = if (4.0..5.0).contains(&t) { 0.4 } else { 1.0 };
            level * share * (slow + fast)
        })
        .collect()
}

/// The friction for a version of a simulator, whatever it costs.
///
/// # Panics
/// Where it cannot be exported.
#[must_use]
pub fn exported(
    model: AnyModel,
    target: Target,
    version: Version,
    armature: Option<f64>,
) -> Exported {
    let speeds = Speeds::new(0.01, 10.0, SpeedsFrom::Asked).expect("a range");
    let given = Given::new(model, "parameters.yaml", "", Some(speeds), None).expect("a friction");
    let options = Options {
        joint: JOINT.to_owned(),
        armature,
        accept_error: true,
        accept_unidentified: true,
        ..Options::default()
    };
    export(&given, target, Some(version), &options).expect("a file")
}

/// The motion that MuJoCo computes with an exported file.
///
/// # Panics
/// Where it does not load or run; the message carries what it said.
#[must_use]
pub fn in_mujoco(python: &Path, include: &str, torque: &[f64]) -> Motion {
    let class = include.contains("<default>").then(|| format!("{JOINT}_friction"));
    moved(python, "simulators_session.py", include, class, torque)
}

/// The motion that Newton computes with an exported file, by MuJoCo's solver on the processor.
///
/// # Panics
/// As [`in_mujoco`].
#[must_use]
pub fn in_newton(python: &Path, file: &str, torque: &[f64]) -> Motion {
    moved(python, "newton_session.py", file, None, torque)
}

/// The motion of an entity of mjlab with an exported file, in the MuJoCo that mjlab stands on.
///
/// # Panics
/// As [`in_mujoco`].
#[must_use]
pub fn in_mjlab(python: &Path, file: &str, torque: &[f64]) -> Motion {
    moved(python, "mjlab_session.py", file, None, torque)
}

fn moved(
    python: &Path,
    script: &str,
    include: &str,
    class: Option<String>,
    torque: &[f64],
) -> Motion {
    let asked = json!({
        "include": include, "class": class, "joint": JOINT, "inertia": INERTIA, "dt": STEP,
        "torque": torque, "every": EVERY,
    });
    let mut run = Command::new(python)
        .arg(crate::python::script(script))
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("Python starts");
    let mut input = run.stdin.take().expect("its input is ours");
    let text = asked.to_string();
    let writer = std::thread::spawn(move || input.write_all(text.as_bytes()));
    let output = run.wait_with_output().expect("it ends");
    let _ = writer.join();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("a motion")
}

/// The motion of the same body under our own model, by Runge and Kutta.
#[must_use]
pub fn of_model(model: AnyModel, inertia: f64, torque: &[f64]) -> Motion {
    model.visit(Driven { inertia, torque })
}

struct Driven<'a> {
    inertia: f64,
    torque: &'a [f64],
}

impl ModelVisitor for Driven<'_> {
    type Output = Motion;

    fn visit<M: FrictionModel>(self, model: M) -> Motion {
        let mut body = Body::<M, 0>::new(model, self.inertia);
        let (mut position, mut velocity) = (Vec::new(), Vec::new());
        for (k, torque) in self.torque.iter().enumerate() {
            if k % EVERY == 0 {
                position.push(body.moment().position);
                velocity.push(body.moment().velocity);
            }
            body.advance(STEP, |_| Drive::from(*torque));
        }
        Motion { version: String::new(), inputs: 0, position, velocity }
    }
}
