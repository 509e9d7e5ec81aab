//! `runs`, `runs compare` and `report` from outside.

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};

use serde_json::Value;

/// Exit code, standard output and standard error.
fn frictionlab(folder: &Path, args: &[&str]) -> (i32, String, String) {
    let output = Command::new(env!("CARGO_BIN_EXE_frictionlab"))
        .current_dir(folder)
        .args(args)
        .stdin(Stdio::null())
        .output()
        .unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8_lossy(&bytes).into_owned();
    (output.status.code().unwrap(), text(output.stdout), text(output.stderr))
}

fn done(folder: &Path, args: &[&str]) -> String {
    let (code, out, err) = frictionlab(folder, args);
    assert_eq!(code, 0, "{args:?}: {err}");
    out
}

#[test]
fn runs_are_listed_compared_and_their_pages_made_anew() {
    let root = tempfile::tempdir().unwrap();
    let at = root.path();
    let design = ["design", "position", "--retuned", "--quiet", "--out", "runs/retuned"];
    done(at, &design);
    let asked =
        ["design", "position", "--overshoot", "15", "--rise", "0.2", "--settling", "1", "--quiet"];
    done(at, &[&asked[..], &["--out", "runs/asked"]].concat());
    fs::create_dir_all(at.join("runs/holiday")).unwrap();
    fs::create_dir_all(at.join("runs/half")).unwrap();
    fs::write(at.join("runs/half/run.json"), "{\"options\":").unwrap();

    let listed = done(at, &["runs"]);
    for said in ["retuned", "asked", "design", "complete", "No runs:", "holiday", "half"] {
        assert!(listed.contains(said), "{said}:\n{listed}");
    }
    let json: Value = serde_json::from_str(&done(at, &["runs", "--json"])).unwrap();
    assert_eq!(json["runs"].as_array().unwrap().len(), 2);
    assert_eq!(json["others"].as_array().unwrap().len(), 2);
    assert_eq!(json["runs"][0]["kind"], "design");
    let (code, _, err) = frictionlab(at, &["runs", "nowhere"]);
    assert!(code == 2 && err.contains("nowhere is not there"), "{code}: {err}");

    let compare = ["runs", "compare", "runs/retuned", "runs/asked"];
    let said = done(at, &compare);
    assert!(said.contains("Settings that differ") && said.contains("asked"), "{said}");
    done(at, &[&compare[..], &["--quiet", "--out", "both"]].concat());
    let page = fs::read_to_string(at.join("both/report.html")).unwrap();
    assert!(page.contains("A: ") && page.contains("Pictures of both reports"));
    let (code, _, err) = frictionlab(at, &["runs", "compare", "runs/retuned", "runs/holiday"]);
    assert!(code == 2 && err.contains("no folder of a run"), "{code}: {err}");

    // What a report draws is drawn again.
    let report = at.join("runs/retuned/report.html");
    let before = fs::read_to_string(&report).unwrap();
    done(at, &["report", "runs/retuned"]);
    assert_eq!(before, fs::read_to_string(&report).unwrap());
    // One that was cut off is not replaced unasked, and stays as it is.
    let half = &before[..before.len() / 2];
    fs::write(&report, half).unwrap();
    let (code, _, err) = frictionlab(at, &["report", "runs/retuned"]);
    assert!(code == 2 && err.contains("--force"), "{code}: {err}");
    assert_eq!(half, fs::read_to_string(&report).unwrap());
    let said = done(at, &["report", "runs/retuned", "--force"]);
    assert!(said.contains("Missing: report.html"), "{said}");
    let json = done(at, &["report", "runs/asked", "--json", "--out", "elsewhere.html"]);
    let json: Value = serde_json::from_str(&json).unwrap();
    assert_eq!(json["missing"], Value::Array(Vec::new()));
    assert!(at.join("elsewhere.html").is_file());
    let (code, _, err) = frictionlab(at, &["report", "runs/holiday"]);
    assert!(code == 2 && err.contains("no folder of a run"), "{code}: {err}");
    let left: Vec<_> = fs::read_dir(at.join("runs/holiday")).unwrap().collect();
    assert!(left.is_empty(), "{left:?}");
}
