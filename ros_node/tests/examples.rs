//! The examples run, each in a network namespace of its own.

use std::path::PathBuf;

use tests::network::namespaced;

/// Where cargo puts the examples, which it builds with the tests.
fn example(name: &str) -> PathBuf {
    let here = std::env::current_exe().expect("this program");
    let built = here.parent().and_then(|deps| deps.parent()).expect("cargo's folder");
    built.join("examples").join(name)
}

fn says(name: &str, arguments: &[&str], expected: &str) {
    let mut command = namespaced();
    let output = command.arg(example(name)).args(arguments).output().expect("it starts");
    let said = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success() && said.contains(expected), "{output:?}");
}

#[tests::needs(namespace)]
#[test]
fn a_listener_hears_a_talker() {
    says("talker_listener", &[], "heard 10");
}

#[tests::needs(namespace)]
#[test]
fn a_service_answers() {
    says("service", &[], "asked 1 times");
}

#[tests::needs(namespace)]
#[test]
fn a_managed_node_takes_its_parameters_from_the_command_line() {
    let arguments = ["--once", "--ros-args", "-p", "rate:=5.0", "-p", "word:=hello"];
    says("managed", &arguments, "says hello at 5 Hz");
}
