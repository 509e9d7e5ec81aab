//! Starts processes, passes on what they say, and ends all of them together.

use std::{
    io::{BufRead, BufReader, Read, Write},
    os::unix::process::{CommandExt, ExitStatusExt},
    process::{Child, Command, ExitStatus, Stdio},
    thread::{self, JoinHandle},
    time::{Duration, Instant},
};

use ros_node::{
    Stop,
    launched::{LAUNCHED, WITH_INPUT},
};
use rustix::process::{Pid, Signal, kill_process};

use super::{
    LaunchError,
    plan::{Part, Process},
};

/// How often the processes are looked at.
const WATCH: Duration = Duration::from_millis(20);
/// From SIGINT to SIGTERM.
const TERMINATE: Duration = Duration::from_millis(1200);
/// From SIGINT to SIGKILL.
const KILL: Duration = Duration::from_millis(1900);
/// From SIGINT to SIGTERM for those who write files: a second signal ends them at once.
const TERMINATE_WRITER: Duration = Duration::from_secs(8);
/// From SIGINT to SIGKILL for those who write files: a bag that is cut would have to be recovered.
const KILL_WRITER: Duration = Duration::from_secs(10);

/// A process that runs.
struct Running {
    label: String,
    part: Part,
    child: Child,
    ended: Option<ExitStatus>,
    voices: Vec<JoinHandle<()>>,
    /// Signals sent so far.
    told: usize,
}

/// Processes that run. Dropped, they are ended.
pub struct Processes(Vec<Running>);

/// Runs all processes until `stop`, or until one without which there is no loop ends, and then ends
/// the others.
///
/// Each line of theirs is passed on with the process's label before it. `say` gets what this
/// function itself has to say.
///
/// # Errors
/// [`LaunchError::NoProgram`] or [`LaunchError::Start`] before anything, or with everything ended
/// again; [`LaunchError::Died`].
pub fn supervise(
    processes: &[Process],
    stop: &Stop,
    mut say: impl FnMut(&str),
) -> Result<(), LaunchError> {
    let programs =
        processes.iter().map(|process| process.program.find()).collect::<Result<Vec<_>, _>>()?;
    let width = processes.iter().map(|process| process.label.len()).max().unwrap_or(0);
    let mut running = Processes(Vec::with_capacity(processes.len()));
    for (process, program) in processes.iter().zip(&programs) {
        running.0.push(start(process, program, width)?);
    }
    let died = loop {
        if stop.wait(WATCH) {
            break None;
        }
        if let Some(died) = running.look(&mut say) {
            break Some(died);
        }
        if running.all_ended() {
            say("all have ended");
            break None;
        }
    };
    if died.is_none() && stop.is_set() {
        say("ending all");
    }
    running.end(&mut say);
    died.map_or(Ok(()), Err)
}

fn start(
    process: &Process,
    program: &std::path::Path,
    width: usize,
) -> Result<Running, LaunchError> {
    let mut child = Command::new(program)
        .args(&process.arguments)
        // This program keeps the other end: when it is gone, whatever way it went, they end.
        .stdin(Stdio::piped())
        .env(LAUNCHED, WITH_INPUT)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        // Out of the terminal's group: ctrl-C comes to this program, which ends the others in
        // order.
        .process_group(0)
        .spawn()
        .map_err(|source| LaunchError::Start { program: program.to_owned(), source })?;
    let mut voices = Vec::new();
    let label = format!("[{}]{}", process.label, " ".repeat(width - process.label.len()));
    if let Some(out) = child.stdout.take() {
        voices.extend(pass_on(out, std::io::stdout(), label.clone()));
    }
    if let Some(err) = child.stderr.take() {
        voices.extend(pass_on(err, std::io::stderr(), label));
    }
    Ok(Running {
        label: process.label.clone(),
        part: process.part,
        child,
        ended: None,
        voices,
        told: 0,
    })
}

/// Passes lines on until the process closes its end.
fn pass_on(
    from: impl Read + Send + 'static,
    mut to: impl Write + Send + 'static,
    label: String,
) -> Option<JoinHandle<()>> {
    let pass = move || {
        let mut lines = BufReader::new(from);
        let mut line = Vec::new();
        while lines.read_until(b'\n', &mut line).is_ok_and(|length| length > 0) {
            let text = format!("{label} {}\n", String::from_utf8_lossy(&line).trim_end());
            // One write a line, so that lines stay whole. A terminal that is gone must not block
            // the nodes: go on reading.
            let _ = to.write_all(text.as_bytes());
            line.clear();
        }
    };
    thread::Builder::new().name("voice".into()).spawn(pass).ok()
}

/// How a process ended, in words.
fn how(status: ExitStatus) -> String {
    match (status.code(), status.signal()) {
        (Some(code), _) => format!("exit code {code}"),
        (None, Some(signal)) => format!("signal {signal}"),
        (None, None) => "for no reason that the system tells".to_owned(),
    }
}

impl Processes {
    /// Notes who has ended, and tells it. Returns the first whose end ends the others.
    fn look(&mut self, say: &mut impl FnMut(&str)) -> Option<LaunchError> {
        let mut died = None;
        for process in self.0.iter_mut().filter(|process| process.ended.is_none()) {
            let Ok(Some(status)) = process.child.try_wait() else { continue };
            process.ended = Some(status);
            let how = how(status);
            match process.part {
                Part::Loop if died.is_none() => {
                    say(&format!(
                        "{} has ended by itself ({how}); ending the others",
                        process.label
                    ));
                    died = Some(LaunchError::Died { name: process.label.clone(), how });
                }
                Part::Loop => say(&format!("{} has ended by itself ({how})", process.label)),
                Part::Writer => {
                    say(&format!("{} has ended by itself ({how}); the others go on", process.label))
                }
            }
        }
        died
    }

    fn all_ended(&self) -> bool {
        self.0.iter().all(|process| process.ended.is_some())
    }

    /// Ends all: SIGINT, then SIGTERM, then SIGKILL.
    fn end(&mut self, say: &mut impl FnMut(&str)) {
        let began = Instant::now();
        while !self.all_ended() {
            let elapsed = began.elapsed();
            for process in self.0.iter_mut().filter(|process| process.ended.is_none()) {
                if let Ok(Some(status)) = process.child.try_wait() {
                    process.ended = Some(status);
                    continue;
                }
                let (terminate, kill) = match process.part {
                    Part::Loop => (TERMINATE, KILL),
                    Part::Writer => (TERMINATE_WRITER, KILL_WRITER),
                };
                let steps = [
                    (Duration::ZERO, Signal::INT),
                    (terminate, Signal::TERM),
                    (kill, Signal::KILL),
                ];
                if let Some((_, signal)) =
                    steps.get(process.told).filter(|(after, _)| elapsed >= *after)
                {
                    if *signal == Signal::KILL {
                        say(&format!("{} does not end; killing it", process.label));
                    }
                    // It may have ended just now.
                    let _ = kill_process(Pid::from_child(&process.child), *signal);
                    process.told += 1;
                }
            }
            thread::sleep(WATCH);
        }
        for voice in self.0.iter_mut().flat_map(|process| process.voices.drain(..)) {
            // It ends with the pipe, unless a child of the process still holds that.
            let patience = Instant::now();
            while !voice.is_finished() && patience.elapsed() < Duration::from_millis(200) {
                thread::sleep(Duration::from_millis(2));
            }
        }
    }
}

impl Drop for Processes {
    fn drop(&mut self) {
        self.end(&mut |_: &str| {});
    }
}
