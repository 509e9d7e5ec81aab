//! `frictionlab live` on the device.

use std::process::{Child, Stdio};

use rand_pcg::Pcg64Mcg;

use super::{ATTEMPTS, Counts, Device, PATIENCE, round_of_one};

/// A run that drives.
pub struct Live(Child);

impl Live {
    /// Starts it and waits until it drives.
    pub fn start(device: &mut Device) -> Self {
        for _ in 0..ATTEMPTS {
            let mut run = Self::once(device);
            if device.drives(PATIENCE, || matches!(run.0.try_wait(), Ok(None))) {
                return run;
            }
            let _ = run.0.kill();
            run.0.wait().expect("it ends");
        }
        panic!("the run does not drive");
    }

    fn once(device: &Device) -> Self {
        let out = device.new_folder("live");
        let child = tests::network::namespaced()
            .arg(tests::frictionlab().get_program())
            .args([
                "live",
                "--quiet",
                "--mode",
                "position",
                "--frequency",
                "2",
                "--rig",
                &device.name(),
                "--out",
            ])
            .arg(out)
            .current_dir(device.folder())
            .env("ROS_DOMAIN_ID", "78")
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .spawn()
            .expect("unshare starts");
        Self(child)
    }

    /// Kills it at the latest at the end.
    pub fn round(
        mut self,
        round: u32,
        device: &mut Device,
        random: &mut Pcg64Mcg,
        counts: &mut Counts,
    ) {
        round_of_one(self.0.id(), &format!("live, round {round}"), device, random, counts);
        self.0.wait().expect("it ends");
    }
}
