//! No false alarms: every experiment runs under the driver's safety layer, and its figures are the
//! same.

use std::sync::Arc;

use crate::experiments;
use crate::run::experiment::Selection;
use crate::run::options::tests::options;
use crate::run::*;
use work::progress::Progress;

fn figures(options: &RunOptions) -> serde_json::Value {
    let root = tempfile::tempdir().unwrap();
    let progress = Progress::new(options.rig_seconds(), true);
    let outcome = execute(options, &root.path().join("run"), &progress, &Arc::default()).unwrap();
    let mut figures = serde_json::to_value(&outcome.results).unwrap();
    for differs in ["timing", "options", "bag"] {
        figures.as_object_mut().unwrap().remove(differs).unwrap();
    }
    figures
}

/// Numbers are the same but for the slew of the first few cycles, everything else is equal. Returns
/// how many numbers were compared.
fn same(plain: &serde_json::Value, supervised: &serde_json::Value, size: f64, path: &str) -> usize {
    use serde_json::Value::{Array, Number, Object};
    match (plain, supervised) {
        (Number(a), Number(b)) => {
            let (a, b) = (a.as_f64().unwrap(), b.as_f64().unwrap());
            assert!((a - b).abs() <= 2e-3 * size.abs() + 1e-9, "{path}: {a} alone, {b} supervised");
            1
        }
        (Array(a), Array(b)) => {
            assert_eq!(a.len(), b.len(), "{path}");
            let each = a.iter().zip(b);
            each.map(|(a, b)| same(a, b, a.as_f64().unwrap_or(0.0), &format!("{path}[]"))).sum()
        }
        (Object(a), Object(b)) => {
            assert!(a.keys().eq(b.keys()), "{path}");
            let one = |(key, value): (&String, &serde_json::Value)| {
                // A scatter is the small difference of numbers of a size of their own.
                let of = key.strip_suffix("_deviation").and_then(|of| a.get(of)?.as_f64());
                let size = of.or(value.as_f64()).unwrap_or(0.0);
                same(value, &b[key], size, &format!("{path}.{key}"))
            };
            a.iter().map(one).sum()
        }
        (a, b) => {
            assert_eq!(a, b, "{path}");
            0
        }
    }
}

fn runs_the_same_under_supervision(experiment: Selection) {
    let plain = RunOptions { experiment, ..options() };
    let mut supervised = plain.clone();
    supervised.test_bed.simulation = supervised.test_bed.simulation.supervised();
    let compared = same(&figures(&plain), &figures(&supervised), 0.0, "results");
    assert!(compared > 50, "{compared} numbers");
}

#[test]
fn characterisation_identification_and_tracking_run_the_same_under_the_safety_layer() {
    runs_the_same_under_supervision(experiments::whole_job());
}

#[test]
fn experiments_1_to_4_run_the_same_under_the_safety_layer() {
    runs_the_same_under_supervision(experiments::characterise());
}
