//! The consent to a commission: somebody at the terminal or at the page says that the shaft may
//! turn. Nothing moves until somebody has said yes.

use std::io::{BufRead, IsTerminal};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::thread;
use std::time::Duration;

use anyhow::Context;
use work::{BadInput, Interrupted};

use crate::viewing::CommissionView;

/// How often it is looked whether somebody wants it to end.
const LOOKED: Duration = Duration::from_millis(50);

/// Asks whoever sits there, and whoever looks at the page; the first answer counts.
///
/// # Errors
/// [`BadInput`] where the answer is not yes, or nobody can be asked; [`Interrupted`] once `stop` is
/// set.
pub(super) fn consent(view: Option<&CommissionView>, stop: &AtomicBool) -> anyhow::Result<()> {
    let terminal = std::io::stdin().is_terminal();
    if !terminal && view.is_none() {
        let said = "nobody is there to say that the shaft may turn: --yes says it";
        return Err(BadInput(said.to_owned()).into());
    }
    let (answer, answers) = channel();
    if let Some(view) = view {
        view.ask(answer.clone()).context("the page cannot be asked")?;
    }
    match (terminal, view.is_some()) {
        (true, true) => eprint!("May the shaft turn? Type yes, or say it on the page: "),
        (true, false) => eprint!("May the shaft turn? Type yes: "),
        (false, _) => eprintln!("May the shaft turn? The page asks."),
    }
    if terminal {
        let read = move || typed(&answer);
        thread::Builder::new().name("consent".into()).spawn(read)?;
    }
    loop {
        match answers.recv_timeout(LOOKED) {
            Ok(true) => return Ok(()),
            Ok(false) | Err(RecvTimeoutError::Disconnected) => {
                let said = "nothing has moved: the answer was not yes";
                return Err(BadInput(said.to_owned()).into());
            }
            Err(RecvTimeoutError::Timeout) if stop.load(Ordering::SeqCst) => {
                return Err(Interrupted("stopped; nothing has moved".to_owned()).into());
            }
            Err(RecvTimeoutError::Timeout) => {}
        }
    }
}

/// Reads the answer of whoever sits there.
fn typed(answer: &Sender<bool>) {
    let mut line = String::new();
    let read = std::io::stdin().lock().read_line(&mut line);
    // Somebody at the page was quicker where nobody takes it.
    let _ = answer.send(read.is_ok() && line.trim() == "yes");
}
