//! Which recordings are at hand. Tests that need others are reported as ignored:
//! `#[cfg_attr(not(recordings = "emps"), ignore = "...")]`.

use std::env;
use std::path::PathBuf;

/// Folders of recordings that are not part of the project.
const RECORDINGS: [&str; 3] = ["emps", "qube_servo", "xl330"];

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-env-changed=FRICTION_DATA");
    println!("cargo::rustc-check-cfg=cfg(recordings, values({}))", names());
    let beside = || PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../shared/data");
    let folder = env::var_os("FRICTION_DATA").map_or_else(beside, PathBuf::from);
    for name in RECORDINGS.into_iter().filter(|name| folder.join(name).is_dir()) {
        println!("cargo::rustc-cfg=recordings=\"{name}\"");
    }
}

fn names() -> String {
    RECORDINGS.map(|name| format!("\"{name}\"")).join(", ")
}
