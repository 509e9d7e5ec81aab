//! The card of the stand-in library, in a process of its own: an output and a watchdog that go on
//! when the driver is gone.
//!
//! Reads lines from its input, answers each with a number, and writes into the log what the output
//! is.

use std::fs::{File, OpenOptions};
use std::io::{BufRead, Write};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::{Duration, Instant};

struct Card {
    log: File,
    volts: f64,
    expiration: f64,
    termination: f64,
    timeout: Duration,
    deadline: Option<Instant>,
    expired: bool,
}

impl Card {
    fn put_out(&mut self, volts: f64, why: &str) {
        self.volts = volts;
        self.log.write_all(format!("card {volts:?} {why}\n").as_bytes()).expect("the log takes it");
    }

    fn look_at_the_clock(&mut self) {
        if self.deadline.is_some_and(|deadline| Instant::now() >= deadline) {
            (self.deadline, self.expired) = (None, true);
            self.put_out(self.expiration, "watchdog");
        }
    }

    fn obey(&mut self, line: &str) -> i32 {
        let (word, value) = line.split_once(' ').unwrap_or((line, "0"));
        let value: f64 = value.parse().expect("a number");
        match word {
            // After its watchdog a card takes nothing until it is cleared.
            "write" if self.expired => {}
            "write" => self.put_out(value, "written"),
            "expiration" => self.expiration = value,
            "termination" => self.termination = value,
            "start" => {
                self.timeout = Duration::from_secs_f64(value);
                self.deadline = Some(Instant::now() + self.timeout);
            }
            "reload" if self.expired => return 0,
            "reload" => self.deadline = Some(Instant::now() + self.timeout),
            "clear" => self.expired = false,
            "stop" => self.deadline = None,
            "terminate" => self.put_out(self.termination, "terminated"),
            other => panic!("{other}?"),
        }
        1
    }
}

fn main() {
    let log = std::env::args().nth(1).expect("the log's name");
    let log = OpenOptions::new().append(true).open(log).expect("the log opens");
    // Without the driver's help the output would stay as it is: only the watchdog and the states it
    // was given zero it.
    let mut card = Card {
        log,
        volts: 9.0,
        expiration: 9.0,
        termination: 9.0,
        timeout: Duration::ZERO,
        deadline: None,
        expired: false,
    };
    let (lines, received) = channel();
    std::thread::spawn(move || {
        std::io::stdin().lock().lines().map_while(Result::ok).try_for_each(|line| lines.send(line))
    });
    loop {
        let wait = card.deadline.map_or(Duration::from_secs(3600), |deadline| deadline - Instant::now());
        match received.recv_timeout(wait) {
            Ok(line) => {
                card.look_at_the_clock();
                let answer = card.obey(&line);
                // The driver may have been killed while it waited for the answer: a card goes on.
                let _ = writeln!(std::io::stdout(), "{answer}");
            }
            Err(RecvTimeoutError::Timeout) => card.look_at_the_clock(),
            // The driver is gone. A card goes on until its watchdog expires.
            Err(RecvTimeoutError::Disconnected) => match card.deadline {
                Some(deadline) => {
                    std::thread::sleep(deadline - Instant::now());
                    card.look_at_the_clock();
                }
                None => return,
            },
        }
    }
}
