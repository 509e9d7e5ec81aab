//! What this machine has, for the attribute.

use std::env;
use std::path::{Path, PathBuf};

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-env-changed=FRICTION_DATA");
    println!("cargo::rerun-if-env-changed=FRICTION_FULL");
    // TARGET/debug/build/needs-0123456789abcdef/out
    let out = PathBuf::from(env::var_os("OUT_DIR").expect("cargo says where"));
    let target: &Path = out.ancestors().nth(4).expect("it lies in the target folder");
    println!("cargo::rerun-if-changed={}", machine::file(target).display());
    let found = machine::written_down(target).expect("the target folder can be written");
    let names: Vec<String> = found.iter().map(ToString::to_string).collect();
    println!("cargo::rustc-env=MACHINE_HAS={}", names.join(","));
}
