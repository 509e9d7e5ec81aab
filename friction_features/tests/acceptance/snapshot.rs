//! Every figure of every model as it was when it was last looked at, for what the independent
//! implementation says nothing about.
//!
//! Regenerate with `UPDATE_SNAPSHOTS=1 cargo test -p friction_features --test acceptance snapshot`,
//! and read the difference before keeping it.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use friction_features::{FeatureFigure, FeatureSettings, features};
use friction_model::{AnyModel, ModelName};
use serde::Deserialize;

/// One line of the file.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Entry {
    /// The figure; null where the model has none.
    value: Option<f64>,
    /// The step it was found with, and what the last halving changed; null for figures that are not
    /// integrated with one step.
    step: Option<f64>,
    change: Option<f64>,
}

/// The bristle model's figures are one draw of random numbers each.
fn models() -> impl Iterator<Item = ModelName> {
    ModelName::ALL.into_iter().filter(|&name| name != ModelName::Bristle)
}

fn compute() -> Vec<(ModelName, Vec<FeatureFigure>)> {
    let names: Vec<ModelName> = models().collect();
    let next = AtomicUsize::new(0);
    let done = Mutex::new(Vec::new());
    std::thread::scope(|scope| {
        for _ in 0..2 {
            scope.spawn(|| {
                while let Some(&name) = names.get(next.fetch_add(1, Ordering::Relaxed)) {
                    let presets = (AnyModel::chapter_3(name), AnyModel::test_bed(name));
                    let figures =
                        features(&presets.0, &presets.1, &FeatureSettings::default()).figures();
                    done.lock().unwrap().push((name, figures));
                }
            });
        }
    });
    let mut done = done.into_inner().unwrap();
    done.sort_by_key(|(name, _)| names.iter().position(|other| other == name));
    done
}

fn as_file(models: &[(ModelName, Vec<FeatureFigure>)]) -> String {
    let json = |value: Option<f64>| serde_json::to_string(&value).unwrap();
    let mut text = String::from("{\n");
    for (i, (name, figures)) in models.iter().enumerate() {
        writeln!(text, "  \"{name}\": {{").unwrap();
        for (j, figure) in figures.iter().enumerate() {
            let (step, change) = figure.evidence.map_or((None, None), |e| (Some(e.step), e.change));
            let comma = if j + 1 < figures.len() { "," } else { "" };
            let (name, value) = (&figure.figure, json(figure.value));
            writeln!(
                text,
                "    \"{name}\": {{\"value\": {value}, \"step\": {}, \"change\": {}}}{comma}",
                json(step),
                json(change)
            )
            .unwrap();
        }
        writeln!(text, "  }}{}", if i + 1 < models.len() { "," } else { "" }).unwrap();
    }
    text + "}\n"
}

/// To 1e-4, or to what the last halving of the step still changed; and to what rounding leaves of a
/// figure that is zero.
#[test]
fn every_figure_is_that_of_the_snapshot() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/snapshots/features.json");
    let computed = compute();
    if std::env::var_os("UPDATE_SNAPSHOTS").is_some() {
        std::fs::write(&path, as_file(&computed)).unwrap();
        return;
    }
    let text = std::fs::read_to_string(&path).unwrap();
    let file: BTreeMap<String, BTreeMap<String, Entry>> = serde_json::from_str(&text).unwrap();
    let mut differences = String::new();
    for (name, figures) in &computed {
        let Some(entries) = file.get(name.as_str()) else {
            writeln!(differences, "{name} is not in the file").unwrap();
            continue;
        };
        assert_eq!(entries.len(), figures.len(), "{name} has other figures than the file");
        for FeatureFigure { figure, value, evidence } in figures {
            let same = entries.get(figure).is_some_and(|entry| {
                let change = entry.change.unwrap_or(0.0);
                let close = |a: f64, b: f64| (a - b).abs() <= 1e-4f64.max(change) * b.abs() + 1e-11;
                entry.step.is_some() == evidence.is_some()
                    && match (value, entry.value) {
                        (Some(a), Some(b)) => close(*a, b),
                        (a, b) => a.is_none() && b.is_none(),
                    }
            });
            if !same {
                writeln!(
                    differences,
                    "{name}.{figure}: {value:?} is not {:?}",
                    entries.get(figure)
                )
                .unwrap();
            }
        }
    }
    assert_eq!(file.len(), computed.len(), "the file has other models");
    assert!(differences.is_empty(), "{differences}");
}
