//! One direction of a line on which frames can go wrong.

use rand::{Rng, RngExt};
use rand_pcg::Pcg64Mcg;
use serde::Serialize;

/// What can become of a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Fault {
    /// It never comes.
    Lose,
    /// It comes twice.
    Duplicate,
    /// One of its bytes is another.
    Corrupt,
    /// It comes so many cycles late, in its order or not.
    Delay(u32),
    /// Its second half comes a cycle later.
    Split,
}

/// How often frames go wrong by themselves: parts of all frames, tried in this order.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Odds {
    pub(crate) lose: f64,
    pub(crate) duplicate: f64,
    pub(crate) corrupt: f64,
    pub(crate) delay: f64,
    pub(crate) split: f64,
    pub(crate) delay_cycles: u32,
}

/// How many frames met what.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub(crate) struct Fates {
    pub(crate) frames: u64,
    pub(crate) lost: u64,
    pub(crate) duplicated: u64,
    pub(crate) corrupted: u64,
    pub(crate) late: u64,
    pub(crate) split: u64,
    pub(crate) garbage_bytes: u64,
}

/// One direction: bytes go in, frames are told apart by their zero bytes, and come out as they may.
#[derive(Debug)]
pub(crate) struct Line {
    odds: Odds,
    random: Pcg64Mcg,
    /// What is to happen to the next frames.
    ordered: Vec<(Fault, u64)>,
    /// The frame that is not whole yet.
    partial: Vec<u8>,
    /// What is on its way, with the cycle in which it comes.
    on_the_way: Vec<(u64, Vec<u8>)>,
    fates: Fates,
}

impl Line {
    pub(crate) const fn new(odds: Odds, random: Pcg64Mcg) -> Self {
        Self {
            odds,
            random,
            ordered: Vec::new(),
            partial: Vec::new(),
            on_the_way: Vec::new(),
            fates: Fates {
                frames: 0,
                lost: 0,
                duplicated: 0,
                corrupted: 0,
                late: 0,
                split: 0,
                garbage_bytes: 0,
            },
        }
    }

    pub(crate) const fn fates(&self) -> Fates {
        self.fates
    }

    /// The next `frames` frames meet `fault`.
    pub(crate) fn order(&mut self, fault: Fault, frames: u64) {
        self.ordered.push((fault, frames));
    }

    /// Random bytes on the line.
    pub(crate) fn garbage(&mut self, bytes: usize, cycle: u64) {
        let mut noise = vec![0; bytes];
        self.random.fill_bytes(&mut noise);
        self.fates.garbage_bytes += bytes as u64;
        self.on_the_way.push((cycle, noise));
    }

    /// Nothing is on its way any more: the plug was pulled.
    pub(crate) fn clear(&mut self) {
        self.partial.clear();
        self.on_the_way.clear();
    }

    /// Bytes go in, in `cycle`.
    pub(crate) fn put(&mut self, bytes: &[u8], cycle: u64) {
        for byte in bytes {
            self.partial.push(*byte);
            if *byte == 0 {
                let frame = std::mem::take(&mut self.partial);
                self.carry(frame, cycle);
            }
        }
    }

    /// What comes out in `cycle`.
    pub(crate) fn take(&mut self, cycle: u64) -> Vec<u8> {
        let mut out = Vec::new();
        self.on_the_way.retain_mut(|(due, bytes)| {
            let waits = *due > cycle;
            if !waits {
                out.append(bytes);
            }
            waits
        });
        out
    }

    fn carry(&mut self, mut frame: Vec<u8>, cycle: u64) {
        self.fates.frames += 1;
        match self.fate() {
            None => self.on_the_way.push((cycle, frame)),
            Some(Fault::Lose) => self.fates.lost += 1,
            Some(Fault::Duplicate) => {
                self.fates.duplicated += 1;
                self.on_the_way.push((cycle, frame.clone()));
                self.on_the_way.push((cycle, frame));
            }
            Some(Fault::Corrupt) => {
                self.fates.corrupted += 1;
                let place = self.random.random_range(0..frame.len());
                let change = self.random.random_range(1..=u8::MAX);
                if let Some(byte) = frame.get_mut(place) {
                    *byte ^= change;
                }
                self.on_the_way.push((cycle, frame));
            }
            Some(Fault::Delay(cycles)) => {
                self.fates.late += 1;
                self.on_the_way.push((cycle + u64::from(cycles), frame));
            }
            Some(Fault::Split) => {
                self.fates.split += 1;
                let rest = frame.split_off(frame.len() / 2);
                self.on_the_way.push((cycle, frame));
                self.on_the_way.push((cycle + 1, rest));
            }
        }
    }

    /// What becomes of the next frame.
    fn fate(&mut self) -> Option<Fault> {
        if let Some((fault, frames)) = self.ordered.first_mut() {
            let fault = *fault;
            *frames = frames.saturating_sub(1);
            if *frames == 0 {
                self.ordered.remove(0);
            }
            return Some(fault);
        }
        let Odds { lose, duplicate, corrupt, delay, split, delay_cycles } = self.odds;
        if lose + duplicate + corrupt + delay + split == 0.0 {
            return None;
        }
        let mut draw = self.random.random::<f64>();
        for (part, fault) in [
            (lose, Fault::Lose),
            (duplicate, Fault::Duplicate),
            (corrupt, Fault::Corrupt),
            (delay, Fault::Delay(delay_cycles)),
            (split, Fault::Split),
        ] {
            if draw < part {
                return Some(fault);
            }
            draw -= part;
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;

    use super::*;

    fn line(odds: Odds) -> Line {
        Line::new(odds, Pcg64Mcg::seed_from_u64(1))
    }

    #[test]
    fn frames_meet_what_was_ordered_in_order() {
        let mut line = line(Odds::default());
        for fault in [Fault::Lose, Fault::Duplicate, Fault::Delay(3), Fault::Split, Fault::Corrupt]
        {
            line.order(fault, 1);
        }
        for frame in 1..=6 {
            line.put(&[frame, frame, frame, 0], 10);
        }
        let now = line.take(10);
        assert_eq!(now[..10], [2, 2, 2, 0, 2, 2, 2, 0, 4, 4]);
        assert_ne!(now[10..14], [5, 5, 5, 0], "one byte of it is another");
        assert_eq!(now[14..], [6, 6, 6, 0]);
        assert_eq!(line.take(11), [4, 0]);
        assert!(line.take(12).is_empty());
        assert_eq!(line.take(13), [3, 3, 3, 0]);
        let fates = Fates {
            frames: 6,
            lost: 1,
            duplicated: 1,
            corrupted: 1,
            late: 1,
            split: 1,
            garbage_bytes: 0,
        };
        assert_eq!(line.fates(), fates);
    }

    #[test]
    fn odds_are_parts_of_all_frames() {
        let mut line = line(Odds { lose: 0.1, corrupt: 0.2, ..Odds::default() });
        for cycle in 0..10_000 {
            line.put(&[1, 2, 3, 0], cycle);
        }
        let fates = line.fates();
        // Five standard deviations of a binomial draw.
        assert!(
            fates.lost.abs_diff(1000) < 150 && fates.corrupted.abs_diff(2000) < 200,
            "{fates:?}"
        );
    }
}
