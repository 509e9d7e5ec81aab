//! Processor time of a servo's simulation at every level of friction, for `cargo xtask bench-fits`.
//!
//! `servo_speed FOLDER ROUNDS` writes `servo.json` into the folder: twelve logs of a servo that is
//! made up (three gains, four motions, 6 s each) and a population of candidates a level. It takes
//! the mean position error of every population ROUNDS times, each simulation to its end, and prints
//! one line of JSON a level, as the Numba peer (`tests/peers/servo_fits.py`) does on the same file.

use std::error::Error;
use std::fs;
use std::path::Path;
use std::time::Duration;

use friction_ident::servo::{
    Control, Drive, FrictionLevel, Lanes, Physics, RawServoLog, ServoLog, ServoParameter, TIME_STEP,
};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use rustix::time::{ClockId, clock_gettime};
use strum::IntoEnumIterator;

const DRIVE: Drive = Drive { control: Control::Voltage, per_gain: 0.003, full_scale: 1.0 };
/// Candidates a level: two generations of a search.
const CANDIDATES: usize = 48;
const SAMPLES: usize = 1200;
const ENCODER: f64 = 4096.0 / std::f64::consts::TAU;

/// A servo of half a newton metre.
fn truth(parameter: ServoParameter) -> f64 {
    use ServoParameter as P;
    match parameter {
        P::TorqueConstant => 0.4,
        P::Resistance => 3.5,
        P::Armature => 0.002,
        P::PositionOffset => 0.02,
        P::Coulomb | P::StribeckCoulomb => 0.01,
        P::Viscous => 0.008,
        P::Load | P::ExternalLoad | P::MotorLoad => 0.15,
        P::StribeckLoad | P::StribeckExternal | P::StribeckMotor => 0.1,
        P::QuadraticExternal | P::QuadraticMotor => 0.003,
        P::StribeckVelocity => 1.0,
        P::StribeckExponent => 1.3,
        P::Delay => 0.012,
        P::LoadSquared => 0.2,
        P::RippleSine => 0.1,
        P::RippleCosine => -0.1,
        P::RippleCount => 90.0,
        P::GainScale | P::FullScale => 1.0,
        P::GoalSpeed => f64::INFINITY,
    }
}

fn goal(motion: usize, t: f64) -> f64 {
    match motion {
        0 => 1.2 * (2.0 * t).sin() * (0.7 * t).cos(),
        1 => (1.5 * t * t).sin() * 0.6,
        2 => (0.8 * t).sin().signum() * 0.9,
        _ => 1.5 - (t - 3.0).abs(),
    }
}

fn raw(gain: f64, motion: usize) -> RawServoLog {
    // The grid ends below the last time.
    let time: Vec<f64> = (0..=SAMPLES).map(|k| TIME_STEP * k as f64).collect();
    let goal: Vec<f64> = time.iter().map(|&t| goal(motion, t)).collect();
    RawServoLog {
        mass: 0.5,
        length: 0.1,
        gain,
        supply: 7.4,
        arm_mass: 0.0,
        damping: 0.0,
        position: vec![goal[0]; SAMPLES + 1],
        speed: vec![0.0; SAMPLES + 1],
        enabled: time.iter().map(|&t| t < 5.5).collect(),
        goal,
        time,
    }
}

/// What the peer's loop takes, in its order.
const PEER: [ServoParameter; 20] = {
    use ServoParameter as P;
    [
        P::TorqueConstant,
        P::Resistance,
        P::Armature,
        P::PositionOffset,
        P::Coulomb,
        P::Viscous,
        P::ExternalLoad,
        P::MotorLoad,
        P::StribeckCoulomb,
        P::StribeckExternal,
        P::StribeckMotor,
        P::QuadraticExternal,
        P::QuadraticMotor,
        P::StribeckVelocity,
        P::StribeckExponent,
        P::Delay,
        P::LoadSquared,
        P::RippleSine,
        P::RippleCosine,
        P::RippleCount,
    ]
};

/// Processor time of this thread.
fn clock() -> Duration {
    clock_gettime(ClockId::ThreadCPUTime).try_into().unwrap_or_default()
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let folder = arguments.next().ok_or("expected a folder and a number of rounds")?;
    let rounds: usize = arguments.next().unwrap_or("5".to_owned()).parse()?;
    let folder = Path::new(&folder);
    fs::create_dir_all(folder)?;

    let mut raws: Vec<RawServoLog> = [100.0, 200.0, 800.0]
        .into_iter()
        .flat_map(|gain| (0..4).map(move |motion| raw(gain, motion)))
        .collect();
    // What they measure is the motion of the true servo, in steps of an encoder.
    let parameters = FrictionLevel::Progressive.parameters();
    let values: Vec<f64> = parameters.iter().map(|&parameter| truth(parameter)).collect();
    let logs: Vec<ServoLog> = raws.iter().map(ServoLog::new).collect::<Result<_, _>>()?;
    let true_motion = Lanes::new(&logs.iter().collect::<Vec<_>>(), &DRIVE)
        .positions(&Physics::new(parameters, &values));
    for (raw, motion) in raws.iter_mut().zip(true_motion) {
        for (position, q) in raw.position.iter_mut().zip(motion) {
            *position = (q * ENCODER).round() / ENCODER;
        }
    }
    let logs: Vec<ServoLog> = raws.iter().map(ServoLog::new).collect::<Result<_, _>>()?;
    let lanes = Lanes::new(&logs.iter().collect::<Vec<_>>(), &DRIVE);

    let mut rng = Pcg64Mcg::seed_from_u64(1);
    let mut levels = Vec::new();
    for level in FrictionLevel::iter() {
        let parameters = level.parameters();
        let candidates: Vec<Physics> = (0..CANDIDATES)
            .map(|_| {
                let values: Vec<f64> =
                    parameters.iter().map(|&p| truth(p) * rng.random_range(0.8..1.25)).collect();
                Physics::new(parameters, &values)
            })
            .collect();
        levels.push((level, candidates));
    }
    let json = serde_json::json!({
        "full_scale": DRIVE.full_scale,
        "logs": raws.iter().zip(&logs).map(|(raw, log)| serde_json::json!({
            "goal": log.goal(),
            "position": log.position(),
            "enabled": log.enabled(),
            "head": [
                raw.gain * DRIVE.per_gain, raw.damping, raw.mass * raw.length * raw.length,
                raw.mass * raw.length * 9.80665, raw.supply, log.position()[0], log.first_speed(),
            ],
        })).collect::<Vec<_>>(),
        "levels": levels.iter().map(|(level, candidates)| serde_json::json!({
            "name": level.name(),
            "stribeck": candidates[0].has_stribeck(),
            "ripple": level.parameters().contains(&ServoParameter::RippleSine),
            "candidates": candidates.iter()
                .map(|physics| PEER.map(|parameter| physics.get(parameter)))
                .collect::<Vec<_>>(),
        })).collect::<Vec<_>>(),
    });
    fs::write(folder.join("servo.json"), json.to_string())?;

    for (level, candidates) in &levels {
        let mut times = Vec::new();
        let mut sum = 0.0;
        for _ in 0..=rounds {
            let begin = clock();
            sum = lanes.errors_of(candidates, f64::INFINITY).iter().sum();
            times.push(1e3 * (clock() - begin).as_secs_f64());
        }
        // The first round warms up.
        println!(
            "{{\"what\": \"{}\", \"milliseconds\": {:?}, \"evaluations\": {CANDIDATES}, \"mse\": {}, \"parameters\": {{}}}}",
            level.name(),
            &times[1..],
            sum / CANDIDATES as f64
        );
    }
    Ok(())
}
