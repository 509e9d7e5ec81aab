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

#[test]
fn it_leaves_a_bag_a_report_and_its_figures_and_finds_the_friction_of_the_plant() {
    let folder = std::env::temp_dir().join(format!("both-ways-{}", std::process::id()));
    let experiment = BothWays { speed: 0.5, duration: 1.0, repetitions: 2 };
    let options = asked::usual(Selection::alone(Arc::new(experiment))).unwrap();
    let progress = Progress::new(options.rig_seconds(), true);
    let outcome = execute(&options, &folder, &progress, &Arc::default()).unwrap();
    for name in ["bag/metadata.yaml", "report.html", "run.json"] {
        assert!(folder.join(name).is_file(), "{name}");
    }
    let report = std::fs::read_to_string(folder.join("report.html")).unwrap();
    assert!(report.contains("Friction at 0.5 rad/s"));
    let found = &outcome.results.own["both_ways"];
    let (forward, backward) =
        (found["forward"].as_f64().unwrap(), found["backward"].as_f64().unwrap());
    // The plant is symmetric, and its Coulomb friction is 0.0925 N m (table 4.6 of the thesis).
    assert!((forward + backward).abs() < 0.01, "{found}");
    assert!((0.08..0.15).contains(&forward), "{found}");
    std::fs::remove_dir_all(folder).unwrap();
}
