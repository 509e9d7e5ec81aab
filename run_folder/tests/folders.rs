//! Folders of every sort: of runs, of nobody, damaged.

use std::fs;
use std::path::Path;

use report::figure::{Block, Figure, LineStyle, Page, Panel, Trace};
use run_folder::{Comparison, Kind, NoRun, Run, State, Verdict, list};
use serde_json::json;

fn write(folder: &Path, name: &str, text: &str) {
    let file = folder.join(name);
    fs::create_dir_all(file.parent().unwrap()).unwrap();
    fs::write(file, text).unwrap();
}

/// A run whose friction is so large.
fn run(folder: &Path, friction: f64, seed: u64) {
    let document = json!({
        "program_version": "0.1.0",
        "status": "complete",
        "options": { "experiment": "all", "seed": seed, "models": ["lugre"] },
        "identification": { "parameters": [
            { "name": "f_c", "unit": "N m", "value": friction, "interval": [friction - 0.01, friction + 0.01] },
        ], "mse_identification": 1e-8 * friction },
        "constant_velocity": [{ "velocity": 0.1, "torque": 0.09 }, { "velocity": 1.0, "torque": 0.1 }],
    });
    write(folder, "run.json", &document.to_string());
}

#[test]
fn each_folder_is_told_and_none_ends_the_list() {
    let root = tempfile::tempdir().unwrap();
    let at = |name: &str| root.path().join(name);
    run(&at("all-1"), 0.1, 1);
    write(
        &at("stopped"),
        "run.json",
        "{\"options\": {\"experiment\": \"tracking\"}, \"status\": \"interrupted\"}",
    );
    write(&at("killed"), "journal.jsonl", "{}\n");
    write(&at("commission-1"), "rig.json", "{}");
    write(&at("live-1"), "bag/metadata.yaml", "");
    write(&at("half"), "run.json", "{\"options\": {");
    write(&at("foreign"), "design.json", "{\"colour\": \"red\"}");
    write(&at("other"), "holiday.txt", "sun");
    write(&at(".hidden"), "run.json", "{}");
    write(root.path(), "notes.txt", "");
    let listing = list(root.path()).unwrap();
    let mut told: Vec<(String, Kind, State)> = listing
        .runs
        .iter()
        .map(|run| {
            (run.folder.file_name().unwrap().to_string_lossy().into_owned(), run.kind, run.state)
        })
        .collect();
    told.sort_by(|a, b| a.0.cmp(&b.0));
    let expected = [
        ("all-1", Kind::Run, State::Complete),
        ("commission-1", Kind::Commission, State::Unfinished),
        ("killed", Kind::Run, State::Unfinished),
        ("live-1", Kind::Recording, State::Recorded),
        ("stopped", Kind::Run, State::Interrupted),
    ];
    assert_eq!(told, expected.map(|(name, kind, state)| (name.to_owned(), kind, state)));
    let others: Vec<&str> = listing.others.iter().map(|other| other.why.as_str()).collect();
    assert_eq!(others.len(), 3, "{others:?}");
    assert!(
        others[0].contains("design.json is damaged: it is no document of `frictionlab design`"),
        "{others:?}"
    );
    assert!(others[1].contains("run.json is damaged: it is no whole JSON"), "{others:?}");
    assert!(others[2].contains("is no folder of a run"), "{others:?}");
    // A folder of a run is a list of one; what is no folder is told.
    assert_eq!(list(&at("all-1")).unwrap().runs.len(), 1);
    assert!(matches!(list(&at("nothing")), Err(NoRun::Missing(_))));
    assert!(matches!(Run::open(&root.path().join("notes.txt")), Err(NoRun::File(_))));
}

#[test]
fn two_runs_are_held_beside_each_other() {
    let root = tempfile::tempdir().unwrap();
    let [a, b] = ["a", "b"].map(|name| root.path().join(name));
    run(&a, 0.10, 1);
    run(&b, 0.13, 2);
    let found = Comparison::of(&a, &b).unwrap();
    assert_eq!(found.parameters.len(), 1);
    assert_eq!(found.parameters[0].place, "identification.parameters.f_c");
    assert_eq!(found.parameters[0].verdict, Verdict::Differ);
    let settings: Vec<&str> = found.settings.iter().map(|one| one.place.as_str()).collect();
    assert_eq!(settings, ["options.seed"]);
    let figures: Vec<&str> = found.figures.iter().map(|one| one.place.as_str()).collect();
    assert_eq!(figures, ["identification.mse_identification"]);
    let text = found.terminal();
    for said in ["0.1000 [0.09000, 0.1100] N m", "differ", "options.seed", "B over A"] {
        assert!(text.contains(said), "{said}:\n{text}");
    }
    let same = Comparison::of(&a, &a).unwrap();
    assert_eq!(same.parameters[0].verdict, Verdict::Alike);
    assert!(same.settings.is_empty() && same.figures.is_empty());
    assert!(Comparison::of(&a, root.path()).is_err());
}

fn picture(title: &str) -> Page {
    let line = Trace::Line {
        name: "a".to_owned(),
        x: vec![0.0, 1.0],
        y: vec![1.0, 2.0],
        style: LineStyle::Solid,
    };
    let panel = Panel { y_label: "y".to_owned(), traces: vec![line] };
    let figure = Figure { title: title.to_owned(), panels: vec![panel], ..Figure::default() };
    Page { title: "t".to_owned(), subtitle: String::new(), blocks: vec![Block::Figure(figure)] }
}

#[test]
fn pictures_of_both_reports_stand_on_the_page() {
    let root = tempfile::tempdir().unwrap();
    let [a, b] = ["a", "b"].map(|name| root.path().join(name));
    for folder in [&a, &b] {
        run(folder, 0.1, 1);
        write(folder, "report.html", &report::render_page(&picture("Tracking")));
    }
    let page = Comparison::of(&a, &b).unwrap().page(Vec::new());
    let titles: Vec<&str> = page
        .blocks
        .iter()
        .filter_map(|block| {
            if let Block::Figure(figure) = block { Some(figure.title.as_str()) } else { None }
        })
        .collect();
    assert_eq!(titles, ["By how much parameters of B are larger", "A: Tracking", "B: Tracking"]);
}

#[test]
fn a_page_is_made_of_its_report_else_of_its_document_and_says_what_is_missing() {
    let root = tempfile::tempdir().unwrap();
    run(root.path(), 0.1, 1);
    let nothing = |_: &Path| Ok(Vec::new());
    let made = Run::page(root.path(), nothing).unwrap();
    assert!(!made.poorer);
    assert_eq!(made.missing.len(), 2, "{:?}", made.missing);
    assert!(made.missing[0].contains("report.html") && made.missing[1].contains("bag"));
    let html = report::render_page(&made.page);
    for said in
        ["Friction against velocity", "identification.parameters.f_c", "options.seed", "Missing: "]
    {
        assert!(html.contains(said), "{said}");
    }
    // A report that was cut off is not replaced unasked.
    let whole = report::render_page(&picture("Tracking"));
    write(root.path(), "report.html", &whole[..whole.len() / 2]);
    assert!(Run::page(root.path(), nothing).unwrap().poorer);
    write(root.path(), "report.html", &whole);
    let made = Run::page(root.path(), nothing).unwrap();
    assert!(made.missing.is_empty() && !made.poorer);
    assert_eq!(report::render_page(&made.page), whole);
    assert!(Run::page(&root.path().join("no"), nothing).is_err());
}

#[cfg(unix)]
#[test]
fn a_pipe_in_the_place_of_a_report_is_not_waited_for() {
    let root = tempfile::tempdir().unwrap();
    run(root.path(), 0.1, 1);
    let made = std::process::Command::new("mkfifo").arg(root.path().join("report.html")).status();
    assert!(made.unwrap().success());
    let found = Run::open(root.path()).unwrap();
    assert_eq!(found.report, None);
    let remade = Run::page(root.path(), |_| Ok(vec![])).unwrap();
    assert!(!remade.missing.is_empty());
}
