//! `frictionlab serve` with an experiment on the device.

use std::env;
use std::io::{BufRead, BufReader, Read};
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::RecvTimeoutError;
use std::time::Duration;

use msgs::friction_msgs::{Setting, StartExperiment, StartExperimentRequest};
use rand_pcg::Pcg64Mcg;
use ros_node::{Discovery, Participant};

use super::{ATTEMPTS, Counts, Device, PATIENCE, round_of_one, signal};

/// Names the rig for the process that asks.
const RIG: &str = "FRICTION_SERVED_RIG";

/// A server, and the process that asked it.
pub struct Served {
    asking: Child,
    server: u32,
}

impl Served {
    /// Starts both and waits until the experiment drives; again where a busy machine starves the
    /// line.
    pub fn start(device: &mut Device) -> Self {
        for _ in 0..ATTEMPTS {
            let mut served = Self::once(device);
            let asking = &mut served.asking;
            if device.drives(2 * PATIENCE, || matches!(asking.try_wait(), Ok(None))) {
                return served;
            }
            served.end();
        }
        panic!("the experiment does not drive");
    }

    fn once(device: &Device) -> Self {
        let this = env::current_exe().expect("a test knows its program");
        let mut asking = tests::network::namespaced()
            .arg(this)
            .args(["--ignored", "--exact", "the_asking_process", "--nocapture"])
            .current_dir(device.folder())
            .env(RIG, device.name())
            .env("ROS_DOMAIN_ID", "78")
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .expect("unshare starts");
        let mut lines = BufReader::new(asking.stdout.take().expect("its output is ours")).lines();
        let server = lines
            .find_map(|line| line.ok()?.rsplit_once("the server is ")?.1.trim().parse().ok())
            .expect("it says which process serves");
        std::thread::spawn(move || lines.for_each(drop));
        Self { asking, server }
    }

    fn end(mut self) {
        signal(self.server, "-KILL");
        drop(self.asking.stdin.take());
        self.asking.wait().expect("it ends");
    }

    /// Kills the server at the latest at the end.
    pub fn round(
        self,
        round: u32,
        device: &mut Device,
        random: &mut Pcg64Mcg,
        counts: &mut Counts,
    ) {
        round_of_one(self.server, &format!("serve, round {round}"), device, random, counts);
        self.end();
    }
}

impl Drop for Served {
    fn drop(&mut self) {
        signal(self.server, "-KILL");
    }
}

/// Starts a server on the rig that [`RIG`] names, and asks it for an experiment, again when that
/// has ended, until its own input ends.
pub fn ask() {
    let rig = env::var(RIG).expect("a rig");
    let mut server = Command::new(tests::frictionlab().get_program())
        .args(["serve", "--quiet", "--rig", &rig])
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .spawn()
        .expect("the server starts");
    println!("the server is {}", server.id());
    let participant =
        Participant::join(&Discovery::from_environment().expect("a domain")).expect("joins");
    let node = participant.node("asking").expect("a node");
    let start =
        node.client::<StartExperiment>("/experiment_runner/start_experiment").expect("a client");
    let setting = |name: &str, value: &str| Setting { name: name.into(), value: value.into() };
    let request = StartExperimentRequest {
        experiment: "position-tracking".into(),
        repetitions: 5,
        overrides: vec![setting("quick", "true"), setting("seed", "7")],
        ..Default::default()
    };
    let (tell, ended) = std::sync::mpsc::channel::<()>();
    std::thread::spawn(move || {
        let mut rest = Vec::new();
        let _ = std::io::stdin().read_to_end(&mut rest);
        drop(tell);
    });
    while ended.recv_timeout(Duration::from_millis(300)) == Err(RecvTimeoutError::Timeout) {
        // Refused while one runs; a server that is stopped or dead says nothing.
        let _ = start.call(request.clone(), Duration::from_secs(1));
    }
    let _ = server.kill();
    server.wait().expect("it ends");
}
