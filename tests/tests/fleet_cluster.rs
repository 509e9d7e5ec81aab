//! A fleet on a real Ray cluster of three nodes with an object store beside it, in a network namespace
//! of its own: a worker and a node are killed meanwhile, and the results are those of one machine.

use tests::{network, python};

/// Identifies so many recordings.
fn fleet(recordings: u32) {
    let folder = tempfile::tempdir().expect("a folder");
    let root = folder.path().join("package");
    python::assembled(&root);
    let mut command = network::namespaced();
    command.arg("env").arg(format!("FLEET_RECORDINGS={recordings}"));
    command.arg(format!("PYTHONPATH={}", root.display()));
    command.env("FRICTIONLAB_BIN", tests::frictionlab().get_program());
    let tests = ["tests/laboratory/test_fleet_cluster.py"];
    python::pytest(command, &python::ray(), &root, &tests);
}

#[tests::needs(ray_cluster, namespace)]
#[test]
fn a_cluster_that_loses_a_worker_and_a_node_finds_what_one_machine_finds() {
    fleet(60);
}

#[tests::needs(ray_cluster, namespace, long_tier)]
#[test]
fn two_thousand_recordings_are_each_there_once() {
    fleet(2000);
}
