//! Processes that drive, or that help to, are killed, stopped and continued at random moments: the
//! motor stands in time, by the device's own count.

mod killed;

use std::time::Duration;

use killed::{Device, launch::Launched, live::Live, serve::Served};
use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;

/// Rounds: `full` in the long tier.
fn rounds(short: u32, full: u32) -> u32 {
    if std::env::var_os("FRICTION_FULL").is_some() { full } else { short }
}

#[tests::needs(namespace)]
#[test]
fn a_launcher_that_is_killed_leaves_no_node_and_a_motor_at_zero_volts() {
    let mut device = Device::start();
    let mut group = Launched::start(&mut device);
    let nodes = group.nodes();
    assert_eq!(nodes.len(), 4, "{nodes:?}");
    group.kill_the_launcher();
    group.wait_until_all_are_gone(Duration::from_secs(20));
    let status = device.pass_validity();
    assert_eq!((&status["voltage"], &status["state"]), (&0.into(), &"inactive".into()), "{status}");
    device.finish();
}

#[tests::needs(namespace)]
#[test]
fn whichever_of_a_launched_group_is_killed_or_stopped_the_motor_stands_in_time() {
    let mut random = Pcg64Mcg::seed_from_u64(16);
    let mut device = Device::start();
    let mut counts = killed::Counts::default();
    for round in 0..rounds(2, 100) {
        let mut group = Launched::start(&mut device);
        group.round(round, &mut device, &mut random, &mut counts);
    }
    println!("launch: {counts}");
    device.finish();
}

#[tests::needs(namespace)]
#[test]
fn a_live_run_that_is_killed_or_stopped_leaves_the_motor_at_zero_volts() {
    let mut random = Pcg64Mcg::seed_from_u64(17);
    let mut device = Device::start();
    let mut counts = killed::Counts::default();
    for round in 0..rounds(2, 60) {
        let run = Live::start(&mut device);
        run.round(round, &mut device, &mut random, &mut counts);
    }
    println!("live: {counts}");
    device.finish();
}

#[tests::needs(namespace)]
#[test]
fn a_server_that_is_killed_or_stopped_during_an_experiment_leaves_the_motor_at_zero_volts() {
    let mut random = Pcg64Mcg::seed_from_u64(18);
    let mut device = Device::start();
    let mut counts = killed::Counts::default();
    for round in 0..rounds(1, 40) {
        let server = Served::start(&mut device);
        server.round(round, &mut device, &mut random, &mut counts);
    }
    println!("serve: {counts}");
    device.finish();
}

/// Not a test by itself: what the one above starts in a namespace. It serves, and asks for an
/// experiment.
#[test]
#[ignore = "killed: run by the test above"]
fn the_asking_process() {
    killed::serve::ask();
}
