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

/// A flag that SIGINT, SIGTERM and SIGHUP set. If the program is still there `within` later, or
/// when a second signal comes, it ends at once with the code of that signal. A real rig's motor is
/// at zero volts then by the device's own watch: no commands come any more.
///
/// # Errors
/// If signals cannot be watched.
pub(super) fn watch(within: Duration) -> anyhow::Result<Arc<AtomicBool>> {
    let cannot = "cannot watch for ctrl-C";
    #[cfg(feature = "ros")]
    {
        ros_node::ends_within(within);
        Ok(ros_node::Stop::on_signals().context(cannot)?.flag())
    }
    #[cfg(not(feature = "ros"))]
    {
        alone::watch(within).context(cannot)
    }
}

/// The exit code of a program that a signal ended: 128 plus its number.
pub(super) fn exit_code() -> u8 {
    #[cfg(feature = "ros")]
    {
        ros_node::signal_exit_code()
    }
    #[cfg(not(feature = "ros"))]
    {
        alone::exit_code()
    }
}

/// The same without the nodes' library.
#[cfg(not(feature = "ros"))]
mod alone {
    use std::{
        process::exit,
        sync::{
            Arc,
            atomic::{AtomicBool, AtomicU8, Ordering},
        },
        thread,
        time::Duration,
    };

    /// SIGINT.
    const CTRL_C: u8 = 2;
    /// The first signal that came; 0 for none.
    static FIRST: AtomicU8 = AtomicU8::new(0);

    const fn code_of(signal: u8) -> u8 {
        128_u8.saturating_add(signal)
    }

    pub(super) fn exit_code() -> u8 {
        match FIRST.load(Ordering::Acquire) {
            0 => code_of(CTRL_C),
            signal => code_of(signal),
        }
    }

    pub(super) fn watch(within: Duration) -> anyhow::Result<Arc<AtomicBool>> {
        let stop = Arc::new(AtomicBool::new(false));
        let flag = Arc::clone(&stop);
        listen(move |signal| {
            if flag.swap(true, Ordering::AcqRel) {
                exit(code_of(signal).into());
            }
            FIRST.store(signal, Ordering::Release);
            thread::spawn(move || {
                thread::sleep(within);
                exit(code_of(signal).into());
            });
        })?;
        Ok(stop)
    }

    #[cfg(unix)]
    fn listen(heard: impl Fn(u8) + Send + 'static) -> anyhow::Result<()> {
        use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
        let mut signals = signal_hook::iterator::Signals::new([SIGINT, SIGTERM, SIGHUP])?;
        let pass_on = move || {
            signals.forever().filter_map(|signal| u8::try_from(signal).ok()).for_each(heard)
        };
        thread::Builder::new().name("signals".into()).spawn(pass_on)?;
        Ok(())
    }

    #[cfg(not(unix))]
    fn listen(heard: impl Fn(u8) + Send + Sync + 'static) -> anyhow::Result<()> {
        Ok(ctrlc::set_handler(move || heard(CTRL_C))?)
    }
}
