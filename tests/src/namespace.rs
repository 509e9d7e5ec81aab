//! A network namespace with loopback only: what speaks DDS in it is heard by nobody else, and hears nobody.

use std::process::{Command, Stdio};

/// Brings loopback up with multicast, then becomes the command.
const LOOPBACK_ONLY: &str =
    "ip link set lo up && ip link set lo multicast on && ip route add 224.0.0.0/4 dev lo && exec \"$@\"";

/// A command in a network namespace of its own: append the program and its arguments. `None` where the system grants none; that is
/// told.
pub fn loopback_only() -> Option<Command> {
    for flags in [&["-n"][..], &["-r", "-n"]] {
        let mut command = Command::new("unshare");
        command.args(flags).args(["bash", "-c", LOOPBACK_ONLY, "--"]);
        let probe = Command::new("unshare")
            .args(flags)
            .args(["bash", "-c", LOOPBACK_ONLY, "--", "true"])
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .status();
        if probe.is_ok_and(|status| status.success()) {
            return Some(command);
        }
    }
    crate::skip("no network namespace (`unshare -n` with `ip`); run as root or allow user namespaces");
    None
}
