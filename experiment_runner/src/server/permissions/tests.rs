//! A stranger asks for what is not his.

use std::os::unix::fs::symlink;
use std::sync::Arc;
use std::sync::mpsc;
use std::time::Duration;

use msgs::friction_msgs::{IdentifyRequest, Setting};

use super::*;
use crate::server::desk::{Desk, UsualRig};
use crate::server::identification;
use crate::server::request::ExperimentRequest;

/// A folder of runs and one of inputs, with all kinds of traps, and a secret beside them.
struct Machine {
    root: tempfile::TempDir,
    permissions: Permissions,
}

const SECRET: &str = "root:x:0:0:the secret of this machine";

fn machine() -> Machine {
    let root = tempfile::tempdir().unwrap();
    let at = |name: &str| root.path().join(name);
    for folder in ["runs", "inputs", "elsewhere/bag"] {
        fs::create_dir_all(at(folder)).unwrap();
    }
    fs::write(at("secret.yaml"), SECRET).unwrap();
    fs::write(at("elsewhere/bag/bag_0.mcap"), SECRET).unwrap();
    fs::write(at("inputs/mine.yaml"), "no: protocol").unwrap();
    symlink(at("secret.yaml"), at("inputs/link.yaml")).unwrap();
    symlink(at("elsewhere"), at("runs/elsewhere")).unwrap();
    symlink(at("nowhere"), at("runs/dangling")).unwrap();
    symlink("/dev/zero", at("inputs/zero")).unwrap();
    fs::create_dir(at("inputs/linked_bag")).unwrap();
    symlink(at("secret.yaml"), at("inputs/linked_bag/bag_0.mcap")).unwrap();
    symlink("mine.yaml", at("inputs/inner_link.yaml")).unwrap();
    let made = std::process::Command::new("mkfifo").arg(at("inputs/fifo")).status().unwrap();
    assert!(made.success());
    let long = fs::File::create(at("inputs/long.yaml")).unwrap();
    long.set_len(LARGEST_TEXT + 1).unwrap();
    let endless = fs::File::create(at("inputs/endless.csv")).unwrap();
    endless.set_len(LARGEST_TABLE + 1).unwrap();
    let bag = fs::File::create(at("inputs/endless.mcap")).unwrap();
    bag.set_len(LARGEST_BAG + 1).unwrap();
    let rigs = vec![RigChoice::Simulated, RigChoice::Nodes { namespace: None }];
    let permissions = Permissions::new("/", rigs, at("runs"), Some(at("inputs")));
    Machine { root, permissions }
}

/// Names that no request may use, whatever for.
const NEVER: [&str; 14] = [
    "/etc/passwd",
    "/dev/zero",
    "../secret.yaml",
    "../../../../../../etc/passwd",
    "a/../../secret.yaml",
    "link.yaml",
    "zero",
    "dangling",
    "elsewhere/bag/bag_0.mcap",
    "fifo",
    "",
    "  ",
    "a\nb",
    "nothing_of_that_name",
];

/// A sentence says what is allowed and how to allow more, in one line, and nothing of what is in a
/// file.
fn assert_sentence(refusal: &str, name: &str) {
    assert!(!refusal.contains("secret of") && !refusal.contains("root:x"), "{name}: {refusal}");
    assert!(!refusal.contains('\n'), "{name}: {refusal}");
    assert!(refusal.contains("--inputs"), "{name}: {refusal}");
}

#[test]
fn no_file_is_read_that_requests_may_not_name() {
    let Machine { root: _root, permissions } = machine();
    for name in NEVER {
        assert_sentence(&permissions.text(name).unwrap_err().to_string(), name);
        assert_sentence(&permissions.recording(name).unwrap_err().to_string(), name);
    }
    for (name, said) in
        [("long.yaml", "at most 1048576"), (".", "no regular file"), ("linked_bag", "regular file")]
    {
        let refusal = permissions.text(name).unwrap_err().to_string();
        assert!(refusal.contains(said), "{refusal}");
        assert_sentence(&refusal, name);
    }
    for (name, said) in [
        ("endless.csv", "at most 1073741824"),
        ("endless.mcap", "at most 4294967296"),
        ("linked_bag", "a link in it"),
        ("elsewhere/bag", "leads outside"),
    ] {
        let refusal = permissions.recording(name).unwrap_err().to_string();
        assert!(refusal.contains(said), "{refusal}");
        assert_sentence(&refusal, name);
    }
    // What lies inside is found, through links that stay inside too.
    let mine = permissions.text("mine.yaml").unwrap();
    assert_eq!(permissions.text("./inner_link.yaml").unwrap(), mine);
}

#[test]
fn nothing_is_written_outside_of_the_folder_of_runs() {
    let Machine { root, permissions } = machine();
    let inside = permissions.output("monday/first").unwrap();
    assert_eq!(inside, root.path().canonicalize().unwrap().join("runs/monday/first"));
    for name in [
        "/tmp/elsewhere",
        "../elsewhere",
        "a/../../elsewhere",
        "elsewhere/new",
        "dangling",
        "dangling/new",
        ".",
        "a/b/c/d/e/f/g/h/i",
        "a\0b",
        &"x".repeat(5000),
    ] {
        let refusal = permissions.output(name).unwrap_err().to_string();
        assert!(refusal.contains("folder of runs") && refusal.len() < 1000, "{name}: {refusal}");
    }
    assert!(!root.path().join("runs/monday").exists(), "asking makes nothing");
    let bag = root.path().canonicalize().unwrap().join("inputs/linked_bag");
    assert!(permissions.beside(&bag).ends_with("runs"), "a recording of others is not written to");
}

#[test]
fn only_the_rigs_that_were_given_are_driven() {
    let Machine { root: _root, permissions } = machine();
    for name in [
        "serial:/dev/ttyS0",
        "serial:/etc/passwd",
        "quanser",
        "quanser:0@tcpip://there:1",
        "nodes:/axis_2",
    ] {
        let refusal = permissions.rig(name.parse().unwrap()).unwrap_err().to_string();
        assert!(
            refusal.contains("only simulated, nodes:/") && refusal.contains("--allow-rigs"),
            "{refusal}"
        );
    }
    assert_eq!(permissions.rig(RigChoice::Simulated).unwrap(), RigChoice::Simulated);
    let own = RigChoice::Nodes { namespace: Some("/".into()) };
    assert_eq!(permissions.rig(RigChoice::Nodes { namespace: None }).unwrap(), own);
    assert!(rigs("simulated, serial:/dev/ttyACM0").unwrap().len() == 2);
    assert!(rigs("simulated,usb").unwrap_err().to_string().contains("usb"));
}

/// The whole way that a request goes, for every option that names a file.
#[test]
fn a_strangers_request_is_refused_with_nothing_read_written_or_driven() {
    let Machine { root, permissions } = machine();
    let (tell, told) = mpsc::channel();
    let announce = Box::new(move |status| _ = tell.send(status));
    let desk = Desk::new(permissions.clone(), UsualRig::default(), announce);
    let before = listing(root.path());
    let ask = |name: &str, value: &str, folder: Option<&str>| {
        let asked = ExperimentRequest {
            experiment: "velocity-tracking".into(),
            overrides: vec![Setting { name: name.into(), value: value.into() }],
            folder: folder.map(str::to_owned),
            ..Default::default()
        };
        desk.start(&asked, Arc::default(), ()).unwrap_err().to_string()
    };
    for option in
        ["protocol", "parameters", "calibration", "drive", "plant-parameters", "--plant_parameters"]
    {
        for name in NEVER {
            assert_sentence(&ask(option, name, None), name);
        }
    }
    for rig in ["serial:/dev/ttyS0", "quanser", "nodes:/axis_2"] {
        assert!(ask("rig", rig, None).contains("--allow-rigs"), "{rig}");
    }
    for folder in ["/tmp/there", "../there", "elsewhere/there"] {
        assert!(ask("quick", "true", Some(folder)).contains("folder of runs"), "{folder}");
    }
    for name in NEVER {
        let asked = IdentifyRequest { bag_path: name.into(), ..Default::default() };
        let answer = identification::identify(&asked, &permissions, &Arc::default());
        assert!(!answer.success);
        assert_sentence(&answer.message, name);
        let asked = IdentifyRequest {
            bag_path: "mine.yaml".into(),
            validation_bags: vec![name.into()],
            overrides: vec![Setting { name: "drive".into(), value: "mine.yaml".into() }],
            ..Default::default()
        };
        assert_sentence(
            &identification::identify(&asked, &permissions, &Arc::default()).message,
            name,
        );
    }
    assert_eq!(listing(root.path()), before);
    // "ready", and nothing of an experiment.
    assert_eq!(
        told.recv_timeout(Duration::from_secs(1)).map(|status| status.stage).as_deref(),
        Ok("idle")
    );
    assert!(told.try_recv().is_err());
}

/// A file inside may be quoted: whoever may name it may read it.
#[test]
fn an_error_quotes_only_what_lies_inside() {
    let Machine { root: _root, permissions } = machine();
    let asked = ExperimentRequest {
        experiment: "velocity-tracking".into(),
        overrides: vec![Setting { name: "protocol".into(), value: "mine.yaml".into() }],
        ..Default::default()
    };
    let refusal = asked.options(&RigChoice::Simulated, &permissions).unwrap_err().to_string();
    assert!(refusal.contains("mine.yaml cannot be driven"), "{refusal}");
}

fn listing(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let entry = entry.unwrap();
        if entry.file_type().unwrap().is_dir() {
            found.extend(listing(&entry.path()));
        }
        found.push(entry.path());
    }
    found.sort();
    found
}
