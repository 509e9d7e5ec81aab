//! The long tier for servo logs: ten seeds of our own friction level, with bars, and the speed of
//! the simulation.
//!
//! ```text
//! cargo run --release -p friction_ident --example servo_seeds -- [FOLDER with xl330] [SEEDS] [EVALUATIONS]
//! ```
//! Ends with an error where the median over the seeds misses 34.2 mrad fitted or 28.7 mrad held out,
//! or where fewer than a thousand whole simulations a second are done on one core, a hundred times
//! the peer's ten.

use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

use friction_ident::servo::space::usual;
use friction_ident::servo::{
    Control, Drive, Effort, FrictionLevel, Lanes, Physics, RawServoLog, ServoLog, search,
};
use friction_ident::statistics::Quartiles;

/// 4096 steps a turn, 885 units of duty cycle, a gain of 256 units.
const XL330: Drive = Drive {
    control: Control::Voltage,
    per_gain: 4096.0 / std::f64::consts::TAU / (256.0 * 885.0),
    full_scale: 1.0,
};

fn load(file: &Path) -> Option<ServoLog> {
    let log: serde_json::Value = serde_json::from_str(&std::fs::read_to_string(file).ok()?).ok()?;
    let entries = log["entries"].as_array()?;
    let column =
        |name: &str| entries.iter().map(|entry| entry[name].as_f64()).collect::<Option<Vec<_>>>();
    ServoLog::new(&RawServoLog {
        mass: log["mass"].as_f64()?,
        length: log["length"].as_f64()?,
        gain: log["kp"].as_f64()?,
        supply: log["vin"].as_f64()?,
        arm_mass: 0.0,
        damping: 0.0,
        time: column("timestamp")?,
        position: column("position")?,
        speed: column("speed")?,
        goal: column("goal_position")?,
        enabled: entries
            .iter()
            .map(|entry| entry["torque_enable"].as_bool())
            .collect::<Option<_>>()?,
    })
    .ok()
}

fn main() -> ExitCode {
    let mut arguments = std::env::args().skip(1);
    let data = std::env::var("FRICTION_DATA").unwrap_or_else(|_| "../shared/data".to_owned());
    let folder = arguments.next().map_or_else(|| Path::new(&data).join("xl330"), PathBuf::from);
    let seeds: u64 = arguments.next().and_then(|text| text.parse().ok()).unwrap_or(10);
    let evaluations = arguments.next().and_then(|text| text.parse().ok()).unwrap_or(60_000);
    let mut files: Vec<PathBuf> = std::fs::read_dir(&folder)
        .into_iter()
        .flatten()
        .flatten()
        .map(|entry| entry.path())
        .collect();
    files.sort();
    let logs: Vec<ServoLog> = files.iter().filter_map(|file| load(file)).collect();
    let (held, train): (Vec<_>, Vec<_>) = logs.iter().partition(|log| log.gain() == 400.0);
    if train.is_empty() || held.is_empty() {
        println!("SKIPPED servo_seeds: no servo logs in {}", folder.display());
        return ExitCode::SUCCESS;
    }
    let (train, held) = (Lanes::new(&train, &XL330), Lanes::new(&held, &XL330));
    let parameters = FrictionLevel::Progressive.parameters();
    let free = usual(parameters);
    let (mut fitted, mut other) = (Vec::new(), Vec::new());
    let mut whole: f64 = 0.0;
    for seed in 0..seeds {
        let started = Instant::now();
        let effort = Effort { evaluations, abandon: true, friction_varies: 0.1 };
        let found = search(&train, &free, seed, &effort, &mut |_, _| ControlFlow::Continue(()));
        let physics = Physics::new(parameters, &found.values);
        let rate = found.evaluations as f64 / started.elapsed().as_secs_f64();
        let many = vec![physics; 24];
        let again = Instant::now();
        for _ in 0..20 {
            std::hint::black_box(train.errors_of(std::hint::black_box(&many), f64::INFINITY));
        }
        whole = whole.max(20.0 * many.len() as f64 / again.elapsed().as_secs_f64());
        fitted.push(1e3 * found.error);
        other.push(1e3 * held.error(&physics, f64::INFINITY));
        println!(
            "seed {seed}: fitted {:.2}, held out {:.2} mrad; {rate:.0} evaluations a second in the search",
            fitted[fitted.len() - 1],
            other[other.len() - 1]
        );
    }
    let (Some(fitted), Some(other)) = (Quartiles::of(&fitted), Quartiles::of(&other)) else {
        return ExitCode::FAILURE;
    };
    println!("fitted   {:.2} ({:.2} to {:.2}) mrad", fitted.median, fitted.lower, fitted.upper);
    println!("held out {:.2} ({:.2} to {:.2}) mrad", other.median, other.lower, other.upper);
    println!(
        "{whole:.0} whole simulations of twelve logs a second, {:.0} times the peer's ten",
        whole / 10.0
    );
    if fitted.median <= 34.2 && other.median <= 28.7 && whole >= 1000.0 {
        ExitCode::SUCCESS
    } else {
        println!("MISSED: the bars are 34.2 and 28.7 mrad and 1000 simulations a second");
        ExitCode::FAILURE
    }
}
