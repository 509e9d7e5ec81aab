//! A program that does not outlive whoever launched it.
//!
//! The launcher keeps the writing end of the program's standard input and says so in the
//! environment. The kernel closes that end when the launcher is gone, however it went: by
//! `kill -9`, too, and between starting the program and the program's first line. A signal on the
//! parent's death (`PR_SET_PDEATHSIG`) would come when the thread that started the program ends,
//! and would miss a launcher that died before it was asked for.

use std::{
    env,
    fs::File,
    io::{self, ErrorKind, Read},
    os::{
        fd::{AsFd, BorrowedFd},
        unix::fs::FileTypeExt,
    },
    thread,
};

use rustix::process::{Signal, getpid, kill_process};

/// Environment variable of a program that ends when its standard input does; its value is
/// [`WITH_INPUT`].
pub const LAUNCHED: &str = "FRICTION_LAUNCHED";
/// The value of [`LAUNCHED`] that counts.
pub const WITH_INPUT: &str = "until-stdin-ends";

/// Sends this process SIGTERM when its standard input ends, if [`LAUNCHED`] wishes it and the input
/// is a pipe or a socket: a terminal or `/dev/null` is nobody's promise. Call it when signals are
/// handled: the launcher may be gone already.
///
/// # Errors
/// What the system says if there is no standard input or no thread.
pub fn end_with_launcher() -> io::Result<()> {
    if env::var_os(LAUNCHED).is_none_or(|value| value != WITH_INPUT) {
        return Ok(());
    }
    let Some(input) = line_to_launcher(io::stdin().as_fd())? else { return Ok(()) };
    let watch = move || {
        wait_for_end(input);
        // Whatever a wish to end does, and how long it may take, is the same as for a person who
        // types it.
        let _ = kill_process(getpid(), Signal::TERM);
    };
    thread::Builder::new().name("launcher".into()).spawn(watch).map(drop)
}

/// The input, if it is something that a launcher holds the other end of.
fn line_to_launcher(input: BorrowedFd<'_>) -> io::Result<Option<File>> {
    let input = File::from(input.try_clone_to_owned()?);
    let kind = input.metadata()?.file_type();
    Ok((kind.is_fifo() || kind.is_socket()).then_some(input))
}

/// Reads until there is nothing more to come; what comes means nothing.
fn wait_for_end(mut input: impl Read) {
    let mut ignored = [0; 256];
    loop {
        match input.read(&mut ignored) {
            Ok(0) => return,
            Ok(_) => {}
            Err(error) if error.kind() == ErrorKind::Interrupted => {}
            Err(_) => return,
        }
    }
}

#[cfg(test)]
mod tests {
    use std::{
        os::unix::net::UnixStream,
        process::{Command, Stdio},
    };

    use super::*;

    #[test]
    fn only_a_pipe_or_a_socket_leads_to_a_launcher() {
        let null = File::open("/dev/null").expect("a device");
        assert!(line_to_launcher(null.as_fd()).expect("it can be looked at").is_none());
        let (near, _far) = UnixStream::pair().expect("two ends");
        assert!(line_to_launcher(near.as_fd()).expect("it can be looked at").is_some());
        let (reader, _writer) = io::pipe().expect("a pipe");
        assert!(line_to_launcher(reader.as_fd()).expect("it can be looked at").is_some());
    }

    #[test]
    fn the_end_is_the_end_of_the_last_writer_and_not_what_was_written() {
        let (reader, writer) = io::pipe().expect("a pipe");
        let mut child = Command::new("sh")
            .args(["-c", "echo a; echo b"])
            .stdout(writer)
            .spawn()
            .expect("sh starts");
        wait_for_end(reader);
        assert!(child.wait().expect("it ends").success());
    }

    /// Not a test by itself: what the next one starts. It waits for its own end.
    #[test]
    #[ignore = "waits for its launcher's end: run by the test below"]
    fn the_launched_process() {
        end_with_launcher().expect("a thread");
        loop {
            thread::park();
        }
    }

    #[test]
    fn a_process_gets_sigterm_when_its_launcher_is_gone() {
        use std::os::unix::process::ExitStatusExt;
        let mut child = Command::new(env::current_exe().expect("the test's own file"))
            .args(["--ignored", "--exact", "launched::tests::the_launched_process"])
            .env(LAUNCHED, WITH_INPUT)
            .stdin(Stdio::piped())
            .stdout(Stdio::null())
            .spawn()
            .expect("it starts");
        // Gone before the process reads its first word.
        drop(child.stdin.take());
        assert_eq!(child.wait().expect("it ends").signal(), Some(Signal::TERM.as_raw()));
    }
}
