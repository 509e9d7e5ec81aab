//! The rooms of the house: arrows between the rooms of one folder point one way, no folder holds
//! too much of the code, and a room keeps its table of contents in `mod.rs`.

mod arrows;
mod cycles;
mod source;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use source::{Crate, rust_files};

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
                for ring in cycles::rings(&graph) {
                    let ring = cycles::told(&ring, &graph);
                    complaints.push(format!("{name}{parent}: {ring}"));
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
