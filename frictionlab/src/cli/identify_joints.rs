//! `frictionlab identify --joint a,b,c` or `--joint all`: one identification for each joint.

use std::path::Path;
use std::sync::Arc;

use identification::asked::IdentifyArgs;
use serde_json::Value;
use work::{BadInput, Interrupted};

use super::identify;
use crate::interruption;

/// Identifies the joint that was named, or each of several, in a folder of its own. With `--json`
/// several joints give a list. A joint that cannot be identified is told, and the others go on. Files
/// that name no joints are their one joint.
///
/// # Errors
/// As [`identify::execute`]; [`BadInput`] at the end, where a joint could not be identified.
pub fn execute(mut args: IdentifyArgs) -> anyhow::Result<()> {
    let joints = args.joints()?;
    // A process watches for signals once. What is over within a second ends at once.
    let cancel = if args.structure.is_some() || args.is_friction() {
        interruption::watch(interruption::WRITING)?
    } else {
        Arc::default()
    };
    if joints.len() < 2 {
        args.joint = joints.into_iter().next();
        return identify::execute(&args, &cancel);
    }
    let folder = args.to.reserve("identify")?;
    let (saying, quiet) = (args.saying, args.quiet);
    args.saying.json = false;
    args.quiet = quiet || saying.json;
    let mut documents = Vec::new();
    let mut failed = Vec::new();
    for joint in &joints {
        let of_joint = folder.path().join(file_name(joint));
        args.joint = Some(joint.clone());
        args.to.out = Some(of_joint.clone());
        if !args.quiet {
            work::saying::print(&format!("joint {joint}\n"))?;
        }
        match identify::execute(&args, &cancel) {
            Ok(()) => documents.push(document(&of_joint, joint)?),
            Err(error) if error.is::<Interrupted>() => return Err(error),
            Err(error) => {
                eprintln!("joint {joint}: {error:#}{}", super::advice::advice(&error));
                failed.push(joint.as_str());
            }
        }
    }
    if saying.json {
        saying.result(quiet, &format!("{:#}", Value::Array(documents)), "")?;
    }
    if failed.is_empty() {
        return Ok(());
    }
    Err(BadInput(format!(
        "{} of {} joints could not be identified: {}; what was found of the others is in {}",
        failed.len(),
        joints.len(),
        failed.join(", "),
        folder.path().display()
    ))
    .into())
}

/// What was found of a joint, with its name.
fn document(folder: &Path, joint: &str) -> anyhow::Result<Value> {
    let text = std::fs::read_to_string(folder.join("identification.json"))?;
    let mut document: Value = serde_json::from_str(&text)?;
    if let Value::Object(entries) = &mut document {
        entries.insert("joint".to_owned(), Value::String(joint.to_owned()));
    }
    Ok(document)
}

/// A joint's name as that of a folder.
fn file_name(joint: &str) -> String {
    let plain = |c: char| if c.is_alphanumeric() || "-_.".contains(c) { c } else { '_' };
    let name: String = joint.chars().map(plain).collect();
    format!("joint_{name}")
}
