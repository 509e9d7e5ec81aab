//! Joining one after the other.
//!
//! Participants of this middleware that join in the same moment may miss each other, or be missed
//! by others, for good: of six that start at once beside a Fast DDS participant, one to five stayed
//! unseen; 0.15 s apart all were found. So the programs of one machine take turns.

use std::{
    net::{Ipv4Addr, UdpSocket},
    thread,
    time::{Duration, Instant},
};

/// Time that one has for itself.
const TURN: Duration = Duration::from_millis(300);
/// Longest wait for a turn; then it is taken anyway.
const LONGEST: Duration = Duration::from_secs(6);

/// A turn to join a domain. It ends some time after it is dropped.
pub(crate) struct Turn(Option<UdpSocket>);

impl Turn {
    /// Waits for a turn. A port of the loopback, below those of the domain, is the token: the
    /// system takes it back from a program that dies.
    pub(crate) fn wait(domain: u16) -> Self {
        let port = u16::try_from(7399 + 250 * u32::from(domain)).unwrap_or(7399);
        let began = Instant::now();
        loop {
            match UdpSocket::bind((Ipv4Addr::LOCALHOST, port)) {
                Ok(token) => return Self(Some(token)),
                Err(_) if began.elapsed() < LONGEST => thread::sleep(Duration::from_millis(10)),
                Err(_) => return Self(None),
            }
        }
    }
}

impl Drop for Turn {
    fn drop(&mut self) {
        if let Some(token) = self.0.take() {
            // Without a thread the turn ends at once.
            let _ = thread::Builder::new().name("turn".into()).spawn(move || {
                thread::sleep(TURN);
                drop(token);
            });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_second_waits_for_the_first() {
        // A domain that nobody has: its port is free.
        let began = Instant::now();
        drop(Turn::wait(231));
        drop(Turn::wait(231));
        assert!(began.elapsed() >= TURN);
    }
}
