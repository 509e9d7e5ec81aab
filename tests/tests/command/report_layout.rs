//! Every kind of report that the programs write: does it fit a window of 1040 pixels and a sheet of
//! A4?

use std::path::Path;

use tests::browser::Browser;
use tests::tab::Tab;

use crate::report_pictures::{barriers, misfits};

const LAYOUT: &str = include_str!("../../browser/layout.js");

/// Pixels of the window: half of a usual screen.
const WINDOW: u32 = 1040;

/// Runs the program in `folder`; its report is in `out` there.
fn make(folder: &Path, out: &str, arguments: &[&str]) {
    let run = tests::frictionlab()
        .args(arguments)
        .args(["--quiet", "--out", out])
        .current_dir(folder)
        .output()
        .expect("frictionlab starts");
    assert!(
        run.status.success(),
        "{arguments:?}: {}: {}",
        run.status,
        String::from_utf8_lossy(&run.stderr)
    );
}

/// The report in `out` draws everything, fits, says nothing that only a program should, and links
/// only what is there.
fn assert_fits(browser: &Browser, folder: &Path, out: &str) {
    let out_folder = folder.join(out);
    let html = std::fs::read_to_string(out_folder.join("report.html")).expect("a report");
    let seen = browser.load_at(WINDOW, &html, LAYOUT);
    let file = out_folder.join("report.html");
    assert_eq!(misfits(&mut Tab::open(), &file), [""; 0], "{out}");
    assert_eq!(seen.complaints, [""; 0], "{out}: the page complains");
    assert_eq!(seen.requests, [""; 0], "{out}: the page reaches out");
    for (number, figure) in seen.figures.iter().enumerate() {
        assert_eq!(figure.drawn, figure.expected, "{out}, figure {}: traces drawn", number + 1);
    }
    let probe = &seen.probe;
    assert_eq!(probe["window"], WINDOW, "{out}: {probe}");
    assert!(
        probe["page"].as_f64() <= probe["window"].as_f64(),
        "{out} is wider than the window: {probe}"
    );
    for what in ["wide", "paper", "narrow", "heads"] {
        assert_eq!(probe[what], serde_json::json!([]), "{out}: {probe}");
    }
    // What a reader sees, without the data of the figures.
    let mut text = String::new();
    for part in html
        .split("<body>")
        .nth(1)
        .unwrap_or_default()
        .split("<script")
        .map(|part| part.split_once("</script>").map_or(part, |(_, behind)| behind))
    {
        text += part;
    }
    for raw in ["`", "± 0e0", "1 seeds", "1 draws", "1 recordings", "99999999", "00000001"] {
        assert!(!text.contains(raw), "{out}: {raw}");
    }
    let odd = text.split(|c: char| c.is_whitespace() || matches!(c, '(' | '>')).find(|word| {
        word.strip_prefix('.').is_some_and(|rest| rest.starts_with(|c: char| c.is_ascii_digit()))
    });
    assert_eq!(odd, None, "{out}: a decimal without its zero");
    for link in text.split("<a href=\"./").skip(1).filter_map(|rest| rest.split('"').next()) {
        assert!(out_folder.join(link).exists(), "{out} links {link}, which is not there");
    }
}

#[tests::needs(chromium)]
#[test]
fn reports_of_runs_fit_window_and_paper() {
    let browser = Browser::installed();
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    make(folder, "all", &["run", "--quick"]);
    assert_fits(&browser, folder, "all");
    make(folder, "compensation", &["run", "compensation", "--quick", "--repetitions", "2"]);
    assert_fits(&browser, folder, "compensation");
    let html = std::fs::read_to_string(folder.join("all/report.html")).expect("a report");
    for link in ["./bag/", "./run.json", "./parameters.yaml"] {
        assert!(html.contains(&format!("<a href=\"{link}\">")), "{link} is not linked");
    }
}

#[tests::needs(chromium)]
#[test]
fn a_sequence_has_its_figures() {
    let browser = Browser::installed();
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    let protocol =
        tests::frictionlab().args(["protocols", "sequence"]).output().expect("frictionlab starts");
    std::fs::write(folder.join("sequence.yaml"), protocol.stdout).expect("writing the protocol");
    make(folder, "sequence", &["run", "--protocol", "sequence.yaml"]);
    assert_fits(&browser, folder, "sequence");
    let html = std::fs::read_to_string(folder.join("sequence/report.html")).expect("a report");
    assert!(html.contains("<b>Figure 2. "), "a sequence without figures");
}

#[tests::needs(chromium)]
#[test]
fn reports_of_experiments_and_identification_fit_window_and_paper() {
    let browser = Browser::installed();
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    make(folder, "characterise", &["run", "characterise", "--quick"]);
    assert_fits(&browser, folder, "characterise");
    let table = |name: &str| format!("characterise/{name}.csv");
    let [points, path, chirp, lag] =
        ["steady_points", "presliding", "lag_chirp", "lag_5_rad_s"].map(table);
    let models = "coulomb_viscous,stribeck,lugre,gms,proposed";
    make(
        folder,
        "identify",
        &[
            "identify",
            &points,
            &path,
            &chirp,
            "--model",
            models,
            "--inertia",
            "0.00265:5e-5",
            "--validate",
            &lag,
        ],
    );
    assert_fits(&browser, folder, "identify");
}

#[tests::needs(chromium)]
#[test]
fn reports_of_studies_fit_window_and_paper() {
    let browser = Browser::installed();
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    make(folder, "features", &["features", "--model", "coulomb,dahl,lugre,gms,proposed"]);
    assert_fits(&browser, folder, "features");
    make(
        folder,
        "monte-carlo",
        &["monte-carlo", "--draws", "3", "--means", "feedback,adaptive,retuned-pid"],
    );
    assert_fits(&browser, folder, "monte-carlo");
    make(folder, "truth", &["truth-matrix", "--seeds", "1", "--model", "stribeck,lugre,proposed"]);
    assert_fits(&browser, folder, "truth");
    make(
        folder,
        "design",
        &["design", "position", "--overshoot", "15", "--rise", "0.2", "--settling", "1"],
    );
    assert_fits(&browser, folder, "design");
}

#[tests::needs(chromium, axe)]
#[test]
fn nothing_keeps_people_from_the_reports() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    make(folder, "all", &["run", "--quick"]);
    make(folder, "features", &["features", "--model", "coulomb,lugre,proposed"]);
    make(folder, "design", &["design", "position", "--retuned"]);
    make(folder, "other", &["run", "--quick", "--seed", "2"]);
    make(folder, "characterise", &["run", "characterise", "--quick"]);
    let points = "characterise/steady_points.csv";
    make(folder, "identify", &["identify", points, "--model", "stribeck,proposed"]);
    let compare = ["runs", "compare", "all", "other", "--out", "both"];
    let run = tests::frictionlab().args(compare).current_dir(folder).output().expect("it starts");
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    // A page that is made of the documents alone.
    std::fs::remove_file(folder.join("other/report.html")).expect("a report");
    let run = tests::frictionlab().args(["report", "other"]).current_dir(folder).output();
    assert!(run.expect("it starts").status.success());
    let mut tab = Tab::open();
    for out in ["all", "features", "design", "characterise", "identify", "both", "other"] {
        let file = folder.join(out).join("report.html");
        assert_eq!(barriers(&mut tab, &file), [""; 0], "{out}");
        // Whether the other kinds fit is seen above.
        if ["both", "other"].contains(&out) {
            assert_eq!(misfits(&mut tab, &file), [""; 0], "{out}");
        }
    }
}

#[tests::needs(chromium, emps, qube_servo)]
#[test]
fn reports_of_public_recordings_fit_window_and_paper() {
    let browser = Browser::installed();
    let data = tests::shared_data();
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    let file = |name: &str| data.join(name).display().to_string();
    let emps = [file("emps/estimation.csv"), file("emps/validation.csv")];
    let columns = ["--time", "t_s", "--position", "position_m"];
    if emps.iter().all(|file| Path::new(file).is_file()) {
        let force = [
            "--force-column",
            "control_V:35.150651882485472",
            "--validate",
            &emps[1],
            "--structure",
            "auto",
        ];
        make(folder, "axis", &[&["identify", &emps[0]], &columns[..], &force].concat());
        assert_fits(&browser, folder, "axis");
        let drive = ["--voltage", "control_V", "--force-per-volt", "35.15"];
        make(folder, "drive", &[&["identify-drive", &emps[0]], &columns[..], &drive].concat());
        assert_fits(&browser, folder, "drive");
    }
    let episodes = [file("qube_servo/episode_1.csv"), file("qube_servo/episode_2.csv")];
    if episodes.iter().all(|file| Path::new(file).is_file()) {
        make(folder, "stiction", &["identify-stiction", &episodes[0], &episodes[1]]);
        assert_fits(&browser, folder, "stiction");
    }
    let mut logs: Vec<String> = std::fs::read_dir(data.join("xl330"))
        .into_iter()
        .flatten()
        .filter_map(|entry| Some(entry.ok()?.path().display().to_string()))
        .filter(|path| path.ends_with(".json"))
        .collect();
    logs.sort();
    if !logs.is_empty() {
        let mut arguments = vec!["identify-servo"];
        arguments.extend(logs.iter().map(String::as_str));
        arguments.extend([
            "--hold-out",
            "kp=400",
            "--level",
            "m4",
            "--seeds",
            "1",
            "--evaluations",
            "100",
        ]);
        make(folder, "servo", &arguments);
        assert_fits(&browser, folder, "servo");
    }
}
