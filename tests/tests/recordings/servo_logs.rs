//! The servo logs of Better Actuator Models (arXiv 2410.08650): the peer's own figures, reached
//! with the peer's own parameters.
//!
//! The recordings are not part of the project: where they are not at hand, the tests are ignored.

use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use friction_ident::servo::ServoParameter::{self, *};
use friction_ident::servo::space::usual;
use friction_ident::servo::{
    Control, Drive, Effort, FrictionLevel, Lanes, Physics, RawServoLog, ServoLog, TIME_STEP, search,
};
use tests::shared_data;

/// 4096 steps a turn, 885 units of duty cycle, a gain of 256 units.
const XL330: Drive = Drive {
    control: Control::Voltage,
    per_gain: 4096.0 / std::f64::consts::TAU / (256.0 * 885.0),
    full_scale: 1.0,
};

fn logs() -> Vec<ServoLog> {
    let folder = shared_data().join("xl330");
    let mut files: Vec<PathBuf> =
        std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    files.iter().map(|file| load(file)).collect()
}

fn load(file: &Path) -> ServoLog {
    let log: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(file).unwrap()).unwrap();
    let entries = log["entries"].as_array().unwrap();
    let column =
        |name: &str| entries.iter().map(|entry| entry[name].as_f64().unwrap()).collect::<Vec<_>>();
    ServoLog::new(&RawServoLog {
        mass: log["mass"].as_f64().unwrap(),
        length: log["length"].as_f64().unwrap(),
        gain: log["kp"].as_f64().unwrap(),
        supply: log["vin"].as_f64().unwrap(),
        arm_mass: 0.0,
        damping: 0.0,
        time: column("timestamp"),
        position: column("position"),
        speed: column("speed"),
        goal: column("goal_position"),
        enabled: entries.iter().map(|entry| entry["torque_enable"].as_bool().unwrap()).collect(),
    })
    .unwrap()
}

fn split(logs: &[ServoLog]) -> (Lanes, Lanes) {
    let (held, train): (Vec<_>, Vec<_>) = logs.iter().partition(|log| log.gain() == 400.0);
    (Lanes::new(&train, &XL330), Lanes::new(&held, &XL330))
}

/// What the peer's search found at its highest level.
const PEER_M6: [(ServoParameter, f64); 15] = [
    (TorqueConstant, 0.36858),
    (Resistance, 3.76496),
    (Armature, 0.00180671),
    (PositionOffset, 0.0237721),
    (Coulomb, 4.8784e-5),
    (StribeckCoulomb, 0.00108580),
    (MotorLoad, 0.227145),
    (ExternalLoad, 0.0225331),
    (StribeckMotor, 0.0670802),
    (StribeckExternal, 0.326168),
    (QuadraticMotor, 7.45283e-4),
    (QuadraticExternal, 0.00214682),
    (StribeckVelocity, 0.963611),
    (StribeckExponent, 1.25324),
    (Viscous, 0.00795022),
];

fn peer_m6() -> Physics {
    let (names, values): (Vec<_>, Vec<_>) = PEER_M6.into_iter().unzip();
    Physics::new(&names, &values)
}

#[tests::needs(xl330)]
#[test]
fn the_peers_parameters_have_the_peers_errors() {
    let logs = logs();
    let (train, held) = split(&logs);
    assert_eq!((train.logs(), held.logs()), (12, 4));
    let [fitted, other] = [&train, &held].map(|lanes| 1e3 * lanes.error(&peer_m6(), f64::INFINITY));
    assert!((fitted - 35.13).abs() < 0.02, "{fitted}");
    assert!((other - 35.12).abs() < 0.02, "{other}");
}

/// One log, one step after the other, written out as in the paper, without lanes.
#[tests::needs(xl330)]
#[test]
fn lanes_agree_with_a_plain_simulation() {
    let logs = logs();
    // Five logs: one full group and one with three empty lanes.
    let few: Vec<&ServoLog> = logs.iter().take(5).collect();
    let found = Lanes::new(&few, &XL330).positions(&peer_m6());
    let errors = Lanes::new(&few, &XL330).errors(&peer_m6());
    let of = |wanted| PEER_M6.iter().find(|(name, _)| *name == wanted).unwrap().1;
    for ((log, positions), error) in few.iter().zip(&found).zip(&errors) {
        let plain = plain(log, &of);
        assert_eq!(positions.len(), log.samples());
        let off = positions.iter().zip(&plain).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(off < 1e-6, "{off}");
        let mean = plain.iter().zip(log.position()).map(|(a, b)| (a - b).abs()).sum::<f64>()
            / plain.len() as f64;
        assert!((mean - error).abs() < 1e-7);
    }
}

fn plain(log: &ServoLog, of: &dyn Fn(ServoParameter) -> f64) -> Vec<f64> {
    // The header and the switch of these logs: .49 kg, .1 m, 7.4 V; positions from the log itself.
    let (k_t, r) = (of(TorqueConstant), of(Resistance));
    let inertia = 0.49 * 0.1 * 0.1 + of(Armature);
    let (mut q, mut w) = (log.position()[0], log.first_speed());
    let mut out = Vec::new();
    for (k, goal) in log.goal().iter().enumerate() {
        out.push(q);
        let duty = ((goal - q) * log.gain() * (4096.0 / std::f64::consts::TAU) / (256.0 * 885.0))
            .clamp(-1.0, 1.0);
        let on = if log.enabled()[k] { 1.0 } else { 0.0 };
        let m = on * (k_t * 7.4 * duty / r - k_t * k_t * w / r);
        let e = -0.49 * 9.80665 * 0.1 * (q + of(PositionOffset)).sin();
        let s = (-(w.abs() / of(StribeckVelocity)).powf(of(StribeckExponent))).exp();
        let quadratic = match (m * e < 0.0, m.abs() > e.abs()) {
            (false, _) => 0.0,
            (true, true) => of(QuadraticExternal) * e * e,
            (true, false) => of(QuadraticMotor) * m * m,
        };
        let level = of(Coulomb)
            + (of(ExternalLoad) * e - of(MotorLoad) * m).abs()
            + s * (of(StribeckCoulomb)
                + (of(StribeckExternal) * e - of(StribeckMotor) * m).abs()
                + quadratic);
        let stop = inertia * w / TIME_STEP + m + e;
        let friction = -stop.signum() * stop.abs().min(level + of(Viscous) * w.abs());
        let a = (m + e + friction) / inertia;
        w = (w + a * TIME_STEP).clamp(-100.0, 100.0);
        q += w * TIME_STEP + 0.5 * a * TIME_STEP * TIME_STEP;
    }
    out
}

/// The peer's simplest level has one minimum: 56.05 mrad fitted, 62.82 held out.
#[tests::needs(xl330)]
#[test]
fn the_simplest_level_has_the_peers_minimum_from_any_seed() {
    let logs = logs();
    let (train, held) = split(&logs);
    let effort = Effort { evaluations: 2500, abandon: true, friction_varies: 0.0 };
    for seed in [0, 1] {
        let parameters = FrictionLevel::M1.parameters();
        let found =
            search(
                &train,
                &usual(parameters),
                seed,
                &effort,
                &mut |_, _| ControlFlow::Continue(()),
            );
        let held = held.error(&Physics::new(parameters, &found.values), f64::INFINITY);
        assert!((1e3 * found.error - 56.05).abs() < 0.03, "{}", 1e3 * found.error);
        assert!((1e3 * held - 62.82).abs() < 0.1, "{}", 1e3 * held);
    }
}

#[tests::needs(xl330)]
#[test]
fn a_search_is_reproducible_and_stops_when_told() {
    let logs = logs();
    let lanes = Lanes::new(&logs.iter().take(1).collect::<Vec<_>>(), &XL330);
    let effort = Effort { evaluations: 600, abandon: true, friction_varies: 0.1 };
    let parameters = FrictionLevel::M4.parameters();
    let run = |seed| {
        search(&lanes, &usual(parameters), seed, &effort, &mut |_, _| ControlFlow::Continue(()))
    };
    assert_eq!(run(3), run(3));
    assert_ne!(run(3).values, run(4).values);
    let stopped =
        search(&lanes, &usual(parameters), 3, &effort, &mut |_, _| ControlFlow::Break(()));
    assert!(stopped.evaluations < 100 && stopped.error.is_finite());
}
