//! Ctrl-C: the wish to end, and the end that comes whatever is stuck.

use std::{
    sync::{Arc, atomic::AtomicBool},
    time::Duration,
};

use anyhow::Context;

/// Time for a run to end after ctrl-C: it evaluates what it has.
pub(super) const WRITING: Duration = Duration::from_secs(60);
/// Time for a command that only drives the rig.
pub(super) const DRIVING: Duration = Duration::from_secs(5);

/// A flag that SIGINT, SIGTERM and SIGHUP set. If the program is still there `within` later, or when a second signal comes, it ends at once with
/// code 130. A real rig's motor is at zero volts then by the device's own watch: no commands come any more.
///
/// # Errors
/// If signals cannot be watched.
pub(super) fn watch(within: Duration) -> anyhow::Result<Arc<AtomicBool>> {
    #[cfg(feature = "ros")]
    {
        ros_node::ends_within(within);
        Ok(ros_node::Stop::on_signals().context("cannot watch for ctrl-C")?.flag())
    }
    #[cfg(not(feature = "ros"))]
    {
        use std::sync::atomic::Ordering;
        let stop = Arc::new(AtomicBool::new(false));
        let handler = Arc::clone(&stop);
        let handle = move || {
            if handler.swap(true, Ordering::Relaxed) {
                std::process::exit(130);
            }
            std::thread::spawn(move || {
                std::thread::sleep(within);
                std::process::exit(130);
            });
        };
        ctrlc::set_handler(handle).context("cannot watch for ctrl-C")?;
        Ok(stop)
    }
}
