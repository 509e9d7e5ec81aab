//! `frictionlab commission` as a person runs it.

use std::path::Path;
use std::process::{Command, Output, Stdio};

fn commission(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_frictionlab"))
        .arg("commission")
        .args(arguments)
        .current_dir(folder)
        .stdin(Stdio::null())
        .output()
        .expect("it runs")
}

#[test]
fn it_ends_well_goes_on_and_refuses_what_cannot_be_with_a_sentence() {
    let folder = tempfile::tempdir().unwrap();
    let done = commission(folder.path(), &["--out", "done"]);
    let said = String::from_utf8_lossy(&done.stdout).into_owned();
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    assert!(said.contains("proof") && said.contains("parameters.yaml"), "{said}");
    let again = commission(folder.path(), &["--resume", "done", "--from", "proof", "--json"]);
    assert!(again.status.success(), "{}", String::from_utf8_lossy(&again.stderr));
    assert!(String::from_utf8_lossy(&again.stdout).contains("frictionlab-commission"));

    for (arguments, said) in [
        (&["--resume", "done", "--from", "contrl"][..], "did you mean `control`"),
        (&["--from", "drive"], "--resume"),
        (&["--resume", "done", "--rig", "serial:/dev/ttyS99", "--yes"], "it is of the rig"),
        (&["--resume", "done", "--plant", "lugre"], "another friction"),
        (&["--resume", "done", "--voltage-limit", "5"], "limits"),
        (&["--resume", "nowhere"], "no folder of a commission"),
        (&["--out", "done"], "not empty"),
        (&["--minutes", "1"], "from 4 to 120"),
        (&["--voltage-limit", "0"], "voltage_limit"),
        (&["--voltage-limit", "50"], "10 V"),
        (&["--want", "f_q:2%"], "f_c:2%"),
        (&["--travel", "0.5:1"], "-0.5:1.5"),
        (&["--travel", "fnd"], "find"),
        (&["--trial", "x"], "--trial 20"),
    ] {
        let refused = commission(folder.path(), arguments);
        let told = String::from_utf8_lossy(&refused.stderr).into_owned();
        assert_eq!(refused.status.code(), Some(2), "{arguments:?}: {told}");
        assert!(told.contains(said), "{arguments:?}: {told}");
    }
    assert!(!folder.path().join("runs").exists(), "a refused commission leaves no folder");
}
