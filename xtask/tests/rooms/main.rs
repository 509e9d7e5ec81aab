//! The rooms of the house: arrows between the rooms of one folder point one way, no folder holds
//! too much of the code, and a room keeps its table of contents in `mod.rs`.

mod arrows;
mod cycles;
mod source;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use source::{Crate, rust_files};

/// Files that are one concept, tied both ways on purpose; nothing else may be.
///
/// What is asked for ([`RunOptions`]) names its experiments, an experiment is asked with the options
/// and driven on the bench, and the bench is opened as the options say. The only other way would be
/// to hand the experiments through beside the options everywhere.
const ONE_CONCEPT: [(&str, &[&str]); 1] = [(
    "experiment_runner::run",
    &["bench", "experiment", "journal", "made", "options", "recorder", "results", "sorted"],
)];

/// The share of the code that one folder may hold.
const LARGEST_SHARE: f64 = 0.15;

fn checkout() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap()
}

/// The folders of the workspace's crates.
fn folders() -> Vec<PathBuf> {
    let text = std::fs::read_to_string(checkout().join("Cargo.toml")).unwrap();
    let manifest: toml::Table = toml::from_str(&text).unwrap();
    let members = manifest["workspace"]["members"].as_array().unwrap();
    members.iter().map(|member| checkout().join(member.as_str().unwrap())).collect()
}

#[test]
fn arrows_between_the_rooms_of_one_folder_point_one_way() {
    let mut complaints = Vec::new();
    for folder in folders() {
        let name = folder.file_name().unwrap().to_string_lossy().into_owned();
        for root in ["lib.rs", "main.rs"].map(|root| folder.join("src").join(root)) {
            if !root.is_file() {
                continue;
            }
            let rooms = arrows::between_siblings(&Crate::read(&root));
            for (parent, graph) in rooms {
                let here = format!("{name}{parent}");
                let on_purpose = |ring: &Vec<String>| {
                    ONE_CONCEPT.iter().any(|(room, files)| *room == here && ring == files)
                };
                for ring in cycles::rings(&graph).into_iter().filter(|ring| !on_purpose(ring)) {
                    complaints.push(format!("{here}: {}", cycles::told(&ring, &graph)));
                }
            }
        }
    }
    assert!(complaints.is_empty(), "rooms tied both ways:\n{}", complaints.join("\n"));
}

#[test]
fn no_folder_holds_too_much_of_the_code() {
    let lines: BTreeMap<_, _> =
        folders().iter().map(|folder| (folder.clone(), source::lines_of_code(folder))).collect();
    let all: usize = lines.values().sum();
    for (folder, lines) in &lines {
        let share = *lines as f64 / all as f64;
        assert!(
            share <= LARGEST_SHARE,
            "{} holds {lines} of {all} lines, {:.1} %",
            folder.display(),
            100.0 * share
        );
    }
}

#[test]
fn a_room_keeps_its_table_of_contents_in_mod_rs() {
    let beside: Vec<PathBuf> = folders()
        .iter()
        .flat_map(|folder| rust_files(&folder.join("src")))
        .filter(|file| file.with_extension("").is_dir())
        .collect();
    assert!(beside.is_empty(), "these belong into their folders, as mod.rs: {beside:#?}");
}

/// Where `unsafe` is allowed: foreign code is called, or calls.
const UNSAFE: [&str; 4] = [
    "friction_c/src/boundary.rs",
    "friction_c/src/calls/mod.rs",
    "friction_c/tests/no_allocation.rs",
    "rig_driver/src/quanser/hil.rs",
];

#[test]
fn nothing_is_unsafe_but_where_foreign_code_is() {
    let mut found: Vec<String> = folders()
        .iter()
        .flat_map(|folder| ["src", "tests", "benches"].map(|inner| folder.join(inner)))
        .filter(|folder| folder.is_dir())
        .flat_map(|folder| rust_files(&folder))
        .filter(|file| {
            let text = std::fs::read_to_string(file).unwrap();
            text.lines().any(|line| line == "#![allow(unsafe_code)]")
        })
        .map(|file| file.strip_prefix(checkout()).unwrap().to_string_lossy().into_owned())
        .collect();
    found.sort();
    assert_eq!(found, UNSAFE);
}

#[test]
fn an_arrow_is_seen_through_what_a_room_passes_on() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    write("lib.rs", "mod upper; mod lower; pub use upper::High;");
    write("upper.rs", "pub struct High; fn f() { crate::lower::g(); }");
    // The test of a room may look at the rooms above.
    write("lower.rs", "pub fn g() {} #[cfg(test)] mod tests { use crate::upper::High; }");
    let rings = || {
        let graphs = arrows::between_siblings(&Crate::read(&folder.path().join("lib.rs")));
        cycles::rings(&graphs[""])
    };
    assert_eq!(rings(), Vec::<Vec<String>>::new());
    for tied in [
        "use crate::High;",
        "fn h() -> crate::High { todo!() }",
        "fn h() { print!(\"{}\", super::High) }",
    ] {
        write("lower.rs", &format!("pub fn g() {{}} {tied}"));
        assert_eq!(rings(), [["lower", "upper"]], "{tied}");
    }
}
