//! Orders on standard input.

use std::{
    io::BufRead,
    sync::mpsc::{Receiver, channel},
    thread,
};

use crate::line::Fault;

/// Which frames.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Direction {
    /// Both directions.
    Both,
    /// From the host to the device.
    FromHost,
    /// From the device to the host.
    FromDevice,
}

/// An order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Order {
    /// The next frames meet a fault.
    Frames(Fault, u64, Direction),
    /// Random bytes, both ways.
    Garbage(usize),
    /// The device restarts, silent for so many cycles.
    Reboot(u32),
    /// The port is gone for so many cycles.
    Unplug(u32),
    /// The device sends nothing for so many cycles.
    Hang(u32),
    /// The driver stage reports a fault.
    Fault,
    /// The emergency stop's switch.
    Switch(bool),
    /// The device speaks this version of the protocol.
    Version(u8),
    /// Print the summary so far.
    Status,
    /// End.
    Quit,
    /// Standard input has ended.
    EndOfInput,
}

impl Order {
    /// Reads a line.
    pub(crate) fn parse(line: &str) -> Result<Self, String> {
        let mut words = line.split_whitespace();
        let what = words.next().unwrap_or_default();
        let mut words: Vec<&str> = words.collect();
        let direction = match words.last() {
            Some(&"from-host") => Direction::FromHost,
            Some(&"from-device") => Direction::FromDevice,
            _ => Direction::Both,
        };
        if direction != Direction::Both {
            words.pop();
        }
        let number = |place: usize, name: &str| -> Result<u32, String> {
            let word = words.get(place).ok_or_else(|| format!("{what} wants {name}"))?;
            word.parse().map_err(|_| format!("{what} wants a whole number as {name}, not {word:?}"))
        };
        let frames = |fault| Ok(Self::Frames(fault, number(0, "N")?.into(), direction));
        match what {
            "lose" => frames(Fault::Lose),
            "duplicate" => frames(Fault::Duplicate),
            "corrupt" => frames(Fault::Corrupt),
            "split" => frames(Fault::Split),
            "delay" => frames(Fault::Delay(number(1, "CYCLES")?)),
            "garbage" => Ok(Self::Garbage(number(0, "BYTES")?.min(100_000) as usize)),
            "reboot" => Ok(Self::Reboot(if words.is_empty() { 200 } else { number(0, "CYCLES")? })),
            "unplug" => Ok(Self::Unplug(number(0, "CYCLES")?)),
            "hang" => Ok(Self::Hang(number(0, "CYCLES")?)),
            "fault" => Ok(Self::Fault),
            "stop" => Ok(Self::Switch(true)),
            "release" => Ok(Self::Switch(false)),
            "version" => {
                let version = number(0, "V")?;
                version.try_into().map(Self::Version).map_err(|_| "V is at most 255".into())
            }
            "status" => Ok(Self::Status),
            "quit" => Ok(Self::Quit),
            other => Err(format!("{other:?} is no order; --help lists them")),
        }
    }
}

/// A thread that reads orders. What it cannot read it says on standard error.
pub(crate) fn listen() -> Receiver<Order> {
    let (orders, received) = channel();
    thread::spawn(move || {
        for line in std::io::stdin().lock().lines() {
            let Ok(line) = line else { break };
            if line.trim().is_empty() {
                continue;
            }
            match Order::parse(&line) {
                Ok(order) => {
                    if orders.send(order).is_err() {
                        return;
                    }
                }
                Err(error) => eprintln!("{error}"),
            }
        }
        let _ = orders.send(Order::EndOfInput);
    });
    received
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn orders_are_read_and_what_is_none_is_told() {
        for (line, order) in [
            ("lose 3", Order::Frames(Fault::Lose, 3, Direction::Both)),
            ("delay 2 7 from-host", Order::Frames(Fault::Delay(7), 2, Direction::FromHost)),
            ("corrupt 1 from-device", Order::Frames(Fault::Corrupt, 1, Direction::FromDevice)),
            ("reboot", Order::Reboot(200)),
            ("unplug 500", Order::Unplug(500)),
            ("release", Order::Switch(false)),
            ("version 9", Order::Version(9)),
        ] {
            assert_eq!(Order::parse(line), Ok(order), "{line}");
        }
        for (line, said) in [
            ("lose", "wants N"),
            ("delay 1", "wants CYCLES"),
            ("lose many", "\"many\""),
            ("version 256", "at most 255"),
            ("dance", "no order"),
        ] {
            let error = Order::parse(line).unwrap_err();
            assert!(error.contains(said), "{line}: {error}");
        }
    }
}
