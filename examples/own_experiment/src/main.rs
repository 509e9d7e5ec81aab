//! Runs it on the simulated rig: `cargo run -- FOLDER`.

use std::error::Error;
use std::path::Path;
use std::sync::Arc;

use experiment_runner::asked;
use experiment_runner::run::execute;
use experiment_runner::run::experiment::Selection;
use own_experiment::BothWays;
use work::progress::Progress;

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args().nth(1).unwrap_or_else(|| "both-ways".to_owned());
    let experiment = BothWays { speed: 0.5, duration: 2.0, repetitions: 3 };
    let options = asked::usual(Selection::alone(Arc::new(experiment)))?;
    let progress = Progress::new(options.rig_seconds(), false);
    let outcome = execute(&options, Path::new(&folder), &progress, &Arc::default())?;
    println!("{}", outcome.results.own["both_ways"]);
    println!("report: {}", outcome.folder.join("report.html").display());
    Ok(())
}
