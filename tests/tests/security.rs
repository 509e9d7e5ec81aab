//! Whoever asks for security gets it, or nothing: a program that cannot be secured does not start,
//! whatever it is.
//!
//! Secured programs and peers of another vendor: `rig_driver/tests/security_peers.rs`.

use std::process::Command;

use tests::network::namespaced;

/// Runs a program in a network of its own with security asked for and no keystore; its code and
/// what it said.
fn run(program: &std::path::Path, arguments: &[&str], enable: &str) -> (Option<i32>, String) {
    let mut command: Command = namespaced();
    let output = command
        .arg(program)
        .args(arguments)
        .env("ROS_DOMAIN_ID", "76")
        .env("ROS_SECURITY_ENABLE", enable)
        .env("ROS_SECURITY_STRATEGY", "Enforce")
        .env_remove("ROS_SECURITY_KEYSTORE")
        .env_remove("ROS_SECURITY_ENCLAVE_OVERRIDE")
        .output()
        .expect("unshare starts");
    (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
}

#[tests::needs(namespace)]
#[test]
fn no_program_runs_in_the_clear_where_security_is_asked_for() {
    let folder = tempfile::tempdir().expect("a folder");
    let runs = folder.path().join("runs").display().to_string();
    let lab = tests::frictionlab();
    let lab = std::path::Path::new(lab.get_program());
    let nodes = tests::node_programs();
    let node = |name: &str| nodes.join(name);
    for (program, arguments) in [
        (node("rig_driver"), &[][..]),
        (node("friction_observer"), &[]),
        (node("controller"), &[]),
        (lab.to_owned(), &["live", "--duration", "5", "--out", &runs]),
        (lab.to_owned(), &["serve", "--runs", &runs]),
    ] {
        let (code, said) = run(&program, arguments, "true");
        assert_eq!(code, Some(2), "{} {arguments:?}: {said}", program.display());
        assert!(said.contains("security is asked for (ROS_SECURITY_ENABLE=true), but"), "{said}");
        // ROS takes this for no.
        let (code, said) = run(&program, arguments, "True");
        assert_eq!(code, Some(2), "{} {arguments:?}: {said}", program.display());
        assert!(said.contains("`true` or `false`"), "{said}");
    }
}

/// The policy and the refusals of the command; keystores themselves are made in the crates' own
/// tests.
#[test]
fn the_command_prints_the_policy_and_says_what_is_wrong() {
    let printed = tests::frictionlab().args(["security", "policy"]).output().expect("it starts");
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let shown = std::fs::read_to_string(root.join("ros_node/policy.xml")).expect("the policy");
    assert_eq!(String::from_utf8_lossy(&printed.stdout), shown);
    for arguments in [
        &["security", "policy", "--namespace", "a b"][..],
        &["security", "check"],
        &["security", "init", "/no/such/folder", "--policy", "/no/such/policy"],
    ] {
        let output = tests::frictionlab()
            .args(arguments)
            .env_remove("ROS_SECURITY_KEYSTORE")
            .output()
            .expect("it starts");
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {said}");
    }
}
