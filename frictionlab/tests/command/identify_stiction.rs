//! `frictionlab identify-stiction` on two recordings of one rotary pendulum: what one says the
//! other must confirm.
//!
//! The recordings are not part of the project. They are looked for in `$FRICTION_DATA` and
//! beside the checkout. No friction of this axis is published: the
//! test holds the two recordings against each other.

use std::process::Command;

use serde_json::Value;

/// Value and half the interval.
fn estimate(of: &Value, name: &str) -> (f64, f64) {
    let found = of.as_array().unwrap().iter().find(|estimate| estimate["name"] == name).unwrap();
    assert_eq!(found["verdict"], "identified", "{found}");
    let end = |end: &str| found["interval"][end].as_f64().unwrap();
    let (low, high) = (end("low"), end("high"));
    let value = found["value"].as_f64().unwrap();
    assert!(low < value && value < high, "{found}");
    (value, (high - low) / 2.0)
}

#[tests::needs(qube_servo)]
#[test]
fn two_recordings_of_one_axis_agree_within_their_intervals() {
    let data = tests::shared_data().join("qube_servo");
    let folder = tempfile::tempdir().unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_frictionlab"))
        .current_dir(folder.path())
        .arg("identify-stiction")
        .args(["episode_1.csv", "episode_2.csv"].map(|name| data.join(name)))
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let shown = String::from_utf8(output.stdout).unwrap();
    let text =
        std::fs::read_to_string(folder.path().join("runs/identify-stiction-1/stiction.json"))
            .unwrap();
    let document: Value = serde_json::from_str(&text).unwrap();
    let [first, second] = document["episodes"].as_array().unwrap().as_slice() else {
        panic!("{document}")
    };

    // The axis sticks most of the time, and lets go often enough to repeat itself.
    for episode in [first, second] {
        assert!((0.4..0.8).contains(&episode["rest_share"].as_f64().unwrap()), "{episode}");
        assert!(episode["breakaways"].as_array().unwrap().len() >= 10, "{episode}");
    }
    // Breakaway: the median of each recording lies in the interval of all, and within the other's
    // quartiles widened by half their range.
    for direction in ["forward", "backward"] {
        let (all, half) = estimate(&document["breakaway"], &format!("breakaway.{direction}"));
        assert!(half < 0.25 * all, "{direction}: {all} +- {half}");
        let quartile = |of: &Value, name: &str| of["quartiles"][direction][name].as_f64().unwrap();
        for (one, other) in [(first, second), (second, first)] {
            let median = quartile(one, "median");
            let (low, high) = (quartile(other, "lower"), quartile(other, "upper"));
            let margin = 0.5 * (high - low);
            assert!(
                (low - margin..=high + margin).contains(&median),
                "{direction}: {median}, {low} to {high}"
            );
            assert!((median - all).abs() < 2.0 * half, "{direction}: {median}, {all} +- {half}");
        }
    }
    // Sliding: differences are no larger than what both intervals allow.
    let mut coulomb = 0.0f64;
    for name in ["inertia", "speed", "coulomb", "offset", "pendulum"] {
        let [(a, wide), (b, narrow)] = [first, second]
            .map(|episode| estimate(&episode["slip"]["estimates"]["parameters"], name));
        assert!((a - b).abs() <= wide.hypot(narrow), "{name}: {a} +- {wide}, {b} +- {narrow}");
        if name == "coulomb" {
            coulomb = a.max(b);
        }
        if name == "inertia" {
            assert!(
                wide < 0.1 * a && narrow < 0.1 * b,
                "the inertia is what such motion tells best"
            );
        }
    }
    // The voltage at breakaway is an upper value of static friction, which is not below the Coulomb
    // level.
    assert!(estimate(&document["breakaway"], "breakaway.forward").0 > coulomb);
    for episode in [first, second] {
        let delay = &episode["slip"]["delay"];
        assert_eq!(delay["interval"]["method"], "profile", "{delay}");
        let value = delay["value"].as_f64().unwrap();
        assert!(value > 0.0 && value < 0.01, "{delay}");
        assert!(episode["slip"]["unexplained"].as_f64().unwrap() < 0.05);
    }

    // What cannot be known is said wherever the numbers are.
    let page = std::fs::read_to_string(folder.path().join("runs/identify-stiction-1/report.html"))
        .unwrap();
    let unknown: Vec<&str> =
        document["unknown"].as_array().unwrap().iter().map(|s| s.as_str().unwrap()).collect();
    for said in ["newton metres", "inertia times resistance", "back-EMF", "upper value"] {
        assert!(unknown.iter().any(|sentence| sentence.contains(said)), "{said}: {unknown:?}");
        assert!(shown.contains(said) && page.contains(said), "{said}");
    }
}
