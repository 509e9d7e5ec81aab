//! The Monte Carlo of position tracking on one thread, for `cargo xtask bench-monte-carlo`: draws
//! and seed in, one line of JSON out.

use std::sync::atomic::AtomicBool;
use std::time::Instant;

use anyhow::Context;
use experiment_runner::compensation::Arm;
use friction_model::ModelName;
use studies::monte_carlo::{BeliefErrors, Setting, Sharing, StudyOptions, Task, Trial};
use work::progress::Progress;

fn main() -> anyhow::Result<()> {
    let mut arguments = std::env::args().skip(1);
    let mut number = || -> anyhow::Result<u32> {
        arguments
            .next()
            .context("expected two numbers: draws and seed")?
            .parse()
            .context("not a whole number")
    };
    let (draws, seed) = (number()?, number()?);
    let options = StudyOptions {
        tasks: vec![Task::PositionTracking],
        plants: vec![ModelName::Proposed],
        arms: vec![Arm::None, Arm::observer(ModelName::Proposed)],
        draws,
        errors: BeliefErrors { fraction: 0.2, sharing: Sharing::Common, seed: u64::from(seed) },
        setting: Setting::Physical,
        workers: 1,
    };
    let started = Instant::now();
    let study = options.make(
        0..options.draws,
        &Progress::counting(options.length(options.draws as usize), "draws", true),
        &AtomicBool::new(false),
    )?;
    let seconds = started.elapsed().as_secs_f64();
    let trials: Vec<&Vec<Trial>> = study.cells.iter().flat_map(|cell| &cell.draws).collect();
    let mse = |arm: usize| -> Vec<f64> {
        trials.iter().filter_map(|trials| trials.get(arm)).map(|trial| trial.mse).collect()
    };
    println!(
        "{}",
        serde_json::json!({ "draws": draws, "seconds": seconds, "alone": mse(0), "compensated": mse(1) })
    );
    Ok(())
}
