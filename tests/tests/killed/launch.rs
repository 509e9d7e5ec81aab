//! `frictionlab launch` on the device: four nodes and their launcher, each a process.

use std::collections::BTreeMap;
use std::io::{BufRead, BufReader, Read};
use std::process::{Child, Stdio};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use rand::RngExt;
use rand_pcg::Pcg64Mcg;

use super::{ATTEMPTS, Counts, Device, PATIENCE, children, moment, runs, signal, still};

/// The driver wakes by itself, and the controller's dither gives the motor volts without anybody's
/// reference.
const PARAMETERS: &str = "\
/**/rig_driver:
  ros__parameters:
    autostart: true
/**/controller:
  ros__parameters:
    dither:
      shape: square
      amplitude: 1.0
      frequency: 20.0
";

/// A group that was launched.
pub struct Launched {
    launcher: Child,
    nodes: BTreeMap<String, u32>,
    said: Arc<Mutex<String>>,
}

/// What is done to some of the processes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Blow {
    Kill,
    Stop,
    StopAndContinue,
}

impl Launched {
    /// Starts the group and waits until the loop of all nodes moves the motor.
    pub fn start(device: &mut Device) -> Self {
        let mut attempt = 1;
        loop {
            let mut group = Self::once(device);
            let launcher = &mut group.launcher;
            if device.drives(Duration::from_secs(20), || matches!(launcher.try_wait(), Ok(None))) {
                let nodes = children(group.launcher.id());
                group.nodes = nodes.into_iter().map(|(pid, program)| (program, pid)).collect();
                return group;
            }
            assert!(attempt < ATTEMPTS, "the group does not drive: {}", group.said());
            attempt += 1;
        }
    }

    fn once(device: &Device) -> Self {
        let parameters = device.folder().join("parameters.yaml");
        std::fs::write(&parameters, PARAMETERS).expect("the folder can be written");
        // All of them are built before the clock runs.
        tests::node_programs();
        let mut launcher = tests::network::namespaced()
            .arg(tests::frictionlab().get_program())
            .args(["launch", &format!("rig:={}", device.name())])
            .arg(format!("params_file:={}", parameters.display()))
            .current_dir(device.folder())
            .env("ROS_DOMAIN_ID", "78")
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("unshare starts");
        let said: Arc<Mutex<String>> = Arc::default();
        hear(launcher.stdout.take().expect("its output is ours"), &said);
        hear(launcher.stderr.take().expect("its errors are ours"), &said);
        Self { launcher, nodes: BTreeMap::new(), said }
    }

    fn said(&self) -> String {
        self.said.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// The nodes by program.
    pub fn nodes(&self) -> BTreeMap<String, u32> {
        self.nodes.clone()
    }

    pub fn kill_the_launcher(&mut self) {
        signal(self.launcher.id(), "-KILL");
        self.launcher.wait().expect("it ends");
    }

    /// Waits until no node is left.
    pub fn wait_until_all_are_gone(&self, at_most: Duration) {
        let until = Instant::now() + at_most;
        while let Some((node, _)) = self.nodes.iter().find(|(_, pid)| runs(**pid)) {
            assert!(Instant::now() < until, "{node} goes on without its launcher: {}", self.said());
            std::thread::sleep(Duration::from_millis(5));
        }
    }

    /// Some of the processes are killed or stopped, then the launcher is killed, and nobody is
    /// left.
    pub fn round(
        &mut self,
        round: u32,
        device: &mut Device,
        random: &mut Pcg64Mcg,
        counts: &mut Counts,
    ) {
        let launcher = ("launcher".to_owned(), self.launcher.id());
        let mut all: Vec<(String, u32)> =
            self.nodes.iter().map(|(name, pid)| (name.clone(), *pid)).chain([launcher]).collect();
        let several = if random.random::<bool>() { 1 } else { random.random_range(2..=all.len()) };
        let victims: Vec<(String, u32)> =
            (0..several).map(|_| all.swap_remove(random.random_range(0..all.len()))).collect();
        let blow = [Blow::Kill, Blow::Stop, Blow::StopAndContinue][random.random_range(0..3)];
        let names: Vec<&str> = victims.iter().map(|(name, _)| name.as_str()).collect();
        let what = format!("launch, round {round}: {blow:?} {names:?}");
        counts.rounds += 1;
        moment(random);
        for (_, pid) in &victims {
            still(*pid, if blow == Blow::Kill { "-KILL" } else { "-STOP" });
        }
        match blow {
            Blow::Kill => counts.kills += several as u32,
            Blow::Stop | Blow::StopAndContinue => counts.stops += several as u32,
        }
        if names.contains(&"rig_driver") {
            let status = device.pass_validity();
            assert_eq!(status["voltage"], 0, "{what}: {status}\n{}", self.said());
        } else if names.contains(&"controller") {
            let status = device.pass_age_and_validity();
            assert_eq!(status["voltage"], 0, "{what}: {status}\n{}", self.said());
        }
        device.assert_safe(&what);
        if blow == Blow::StopAndContinue {
            counts.continued += several as u32;
            victims.iter().for_each(|(_, pid)| _ = signal(*pid, "-CONT"));
            moment(random);
            device.assert_safe(&what);
        }
        // The launcher is gone now in any case; a node that stands still hears of it when it goes
        // on.
        counts.kills += 1;
        self.kill_the_launcher();
        moment(random);
        if blow == Blow::Stop {
            victims.iter().for_each(|(_, pid)| _ = signal(*pid, "-CONT"));
        }
        self.wait_until_all_are_gone(PATIENCE);
        let status = device.pass_validity();
        assert_eq!(status["voltage"], 0, "{what}: all are gone: {status}\n{}", self.said());
        device.assert_safe(&what);
    }
}

impl Drop for Launched {
    /// Whatever a failed test left.
    fn drop(&mut self) {
        let children = children(self.launcher.id()).into_iter().map(|(pid, _)| pid);
        let all: Vec<u32> =
            self.nodes.values().copied().chain(children).chain([self.launcher.id()]).collect();
        for pid in all.into_iter().filter(|pid| runs(*pid)) {
            signal(pid, "-CONT");
            signal(pid, "-KILL");
        }
        let _ = self.launcher.wait();
    }
}

/// Keeps what a process says.
fn hear(from: impl Read + Send + 'static, said: &Arc<Mutex<String>>) {
    let said = Arc::clone(said);
    std::thread::spawn(move || {
        for line in BufReader::new(from).lines().map_while(Result::ok) {
            said.lock().unwrap_or_else(PoisonError::into_inner).push_str(&(line + "\n"));
        }
    });
}
