//! The goals of a simulation, as late as its candidates' delays make them.

use super::lanes::{Block, Lanes, Sample, WIDTH};

/// Where the goals of each lane are found.
#[derive(Debug)]
pub(super) struct Goals<'a> {
    samples: &'a [Sample],
    /// Blocks.
    n: usize,
    /// Whole samples that each lane is behind.
    behind: [isize; WIDTH],
    /// Whether all are behind by as much.
    together: bool,
    last: isize,
}

/// The goals of one instant.
#[derive(Debug)]
pub(super) struct Instant<'a> {
    samples: &'a [Sample],
    together: bool,
    /// First sample of the instant that takes effect, a lane.
    from: [usize; WIDTH],
}

impl<'a> Goals<'a> {
    /// Of lanes that are behind by so many samples.
    pub fn new(lanes: &'a Lanes, shift: Block) -> Self {
        let n = lanes.groups.len().max(1);
        let behind = shift.map(|shift| shift.floor() as isize);
        Self {
            samples: &lanes.samples,
            n,
            behind,
            together: behind.iter().all(|&other| other == behind[0]),
            last: (lanes.samples.len() / n) as isize - 1,
        }
    }

    /// Those of the `k`-th sample, or of some samples earlier. Before the first and after the last
    /// the goal stays what it is.
    #[inline(always)]
    pub fn at(&self, k: usize, earlier: usize) -> Instant<'a> {
        let k = k as isize - earlier as isize;
        let last = self.last.max(0);
        let mut from = [0; WIDTH];
        for (from, behind) in from.iter_mut().zip(&self.behind) {
            *from = (k - behind).clamp(0, last) as usize * self.n;
        }
        Instant { samples: self.samples, together: self.together, from }
    }
}

impl Instant<'_> {
    /// Those of a block.
    #[inline(always)]
    pub fn of(&self, block: usize) -> Block {
        if self.together {
            self.samples[self.from[0] + block].goal
        } else {
            let mut goals = [0.0; WIDTH];
            for (lane, goal) in goals.iter_mut().enumerate() {
                *goal = self.samples[self.from[lane] + block].goal[lane];
            }
            goals
        }
    }
}
