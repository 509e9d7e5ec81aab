//! Many logs at once: eight lanes to a block, a log of a candidate to a lane, all blocks in step,
//! so that the processor never waits for one log's step to end.

use super::drive::Drive;
use super::log::ServoLog;

/// Standard gravity \[m/s^2\].
const GRAVITY: f64 = 9.806_65;
/// Lanes of a block.
pub(super) const WIDTH: usize = 8;
/// Lanes that keep a processor busy while the longest chain of one step ends.
const BUSY: usize = 3 * WIDTH;

/// A number for each lane of a block.
pub(super) type Block = [f64; WIDTH];

/// One instant of a block.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sample {
    pub goal: Block,
    pub position: Block,
    /// One where the motor is driven.
    pub enabled: Block,
}

/// What stays the same in a block.
#[derive(Debug, Clone, Copy)]
pub(super) struct Group {
    pub gain: Block,
    pub damping: Block,
    /// Inertia of pendulum and arm \[kg m^2\].
    pub inertia: Block,
    /// Largest moment of their weight \[N m\].
    pub moment: Block,
    pub supply: Block,
    pub position: Block,
    pub speed: Block,
    /// Samples of the log; none for a lane that is left over.
    pub length: Block,
}

/// Logs laid out for simulation.
#[derive(Debug, Clone)]
pub struct Lanes {
    pub(super) drive: Drive,
    pub(super) delay: f64,
    pub(super) groups: Vec<Group>,
    /// Samples of all blocks for the first instant, then for the second, ...
    pub(super) samples: Vec<Sample>,
    copies: usize,
    /// Samples of each log.
    pub(super) lengths: Vec<usize>,
    pub(super) total: f64,
}

impl Lanes {
    /// Lays the logs of one servo out in their order.
    pub fn new(logs: &[&ServoLog], drive: &Drive) -> Self {
        let lengths: Vec<usize> = logs.iter().map(|log| log.samples()).collect();
        let longest = lengths.iter().copied().max().unwrap_or(0);
        let copies = copies(logs.len());
        let blocks = (copies * logs.len()).div_ceil(WIDTH);
        // A lane that is left over repeats the first log and does not count.
        let of = |block: usize, value: &dyn Fn(&ServoLog) -> f64| -> Block {
            std::array::from_fn(|lane| {
                let log = (WIDTH * block + lane) / copies;
                logs.get(log).or(logs.first()).map_or(0.0, |log| value(log))
            })
        };
        let groups = (0..blocks)
            .map(|block| Group {
                gain: of(block, &|log| log.gain * drive.per_gain),
                damping: of(block, &|log| log.damping),
                // A thin rod about its end.
                inertia: of(block, &|log| {
                    (log.mass + log.arm_mass / 3.0) * log.length * log.length
                }),
                moment: of(block, &|log| (log.mass + 0.5 * log.arm_mass) * log.length * GRAVITY),
                supply: of(block, &|log| log.supply),
                position: of(block, &|log| log.position[0]),
                speed: of(block, &|log| log.first_speed),
                length: std::array::from_fn(|lane| {
                    lengths.get((WIDTH * block + lane) / copies).map_or(0.0, |&n| n as f64)
                }),
            })
            .collect();
        let mut samples = Vec::with_capacity(longest * blocks);
        for k in 0..longest {
            let at = |values: &[f64]| values.get(k).or(values.last()).copied().unwrap_or(0.0);
            for block in 0..blocks {
                samples.push(Sample {
                    goal: of(block, &|log| at(&log.goal)),
                    position: of(block, &|log| at(&log.position)),
                    enabled: of(block, &|log| {
                        f64::from(u8::from(log.enabled.get(k).is_some_and(|on| *on)))
                    }),
                });
            }
        }
        let total = lengths.iter().sum::<usize>() as f64;
        Self { drive: *drive, delay: 0.0, groups, samples, copies, lengths, total }
    }

    /// Lets goals take effect after a given delay \[s\], which a delay among the parameters adds to;
    /// none is no delay.
    pub fn set_goal_delay(&mut self, delay: Option<f64>) {
        self.delay = delay.unwrap_or(0.0);
    }

    /// Logs.
    pub fn logs(&self) -> usize {
        self.lengths.len()
    }

    /// Candidates that are simulated side by side: fewer leave lanes empty.
    pub fn at_once(&self) -> usize {
        self.copies
    }
}

/// Candidates with which so many logs fill whole blocks, and enough of them.
fn copies(logs: usize) -> usize {
    let mut copies = 1;
    while copies < WIDTH && (!(copies * logs).is_multiple_of(WIDTH) || copies * logs < BUSY) {
        copies *= 2;
    }
    copies
}

#[cfg(test)]
mod tests {
    use super::copies;

    #[test]
    fn the_logs_of_some_candidates_fill_the_lanes() {
        let of = [1, 3, 4, 6, 8, 12, 16, 20, 24].map(copies);
        assert_eq!(of, [8, 8, 8, 4, 4, 2, 2, 2, 1]);
    }
}
