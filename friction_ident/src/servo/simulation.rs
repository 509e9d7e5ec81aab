//! The simulation of all logs for several candidates side by side, with the widest instructions
//! that the processor has, which are chosen when the program runs.

use friction_lanes::elementary::fuses;
use pulp::{Arch, Simd, WithSimd};

use super::drive::Control;
use super::goals::Goals;
use super::lanes::{Block, Lanes, WIDTH};
use super::log::TIME_STEP;
use super::parameter::ServoParameter::*;
use super::physics::Physics;
use super::step::{State, Step};

/// Samples between two looks at whether the candidates are beaten already.
const LOOK: usize = 60;

impl Lanes {
    /// Mean of |simulated - measured| over all samples of all logs \[rad\]; infinite as soon as it
    /// must exceed `limit`.
    pub fn error(&self, physics: &Physics, limit: f64) -> f64 {
        self.errors_of(std::slice::from_ref(physics), limit)[0]
    }

    /// The same for each of several candidates, whose values do not depend on their neighbours.
    /// One is infinite where all that ran beside it exceed the limit as well.
    pub fn errors_of(&self, candidates: &[Physics], limit: f64) -> Vec<f64> {
        let mut errors = Vec::with_capacity(candidates.len());
        for few in candidates.chunks(self.at_once()) {
            let run = Run {
                lanes: self,
                candidates: few,
                watch: |_: usize, _: &Block| {},
                limit: limit * self.total,
            };
            match run.go() {
                Some(sums) => errors.extend((0..few.len()).map(|candidate| {
                    (0..self.logs()).map(|log| self.sum(&sums, log, candidate)).sum::<f64>()
                        / self.total
                })),
                None => errors.extend(few.iter().map(|_| f64::INFINITY)),
            }
        }
        errors
    }

    /// The same for each log \[rad\].
    pub fn errors(&self, physics: &Physics) -> Vec<f64> {
        let run = Run {
            lanes: self,
            candidates: std::slice::from_ref(physics),
            watch: |_: usize, _: &Block| {},
            limit: f64::INFINITY,
        };
        let sums = run.go().unwrap_or_default();
        let lengths = self.lengths.iter().enumerate();
        lengths.map(|(log, &length)| self.sum(&sums, log, 0) / length as f64).collect()
    }

    /// The simulated positions of each log \[rad\].
    pub fn positions(&self, physics: &Physics) -> Vec<Vec<f64>> {
        let mut positions: Vec<Vec<f64>> =
            self.lengths.iter().map(|&n| Vec::with_capacity(n)).collect();
        let watch = |block: usize, q: &Block| {
            for (lane, &value) in q.iter().enumerate() {
                let place = WIDTH * block + lane;
                let log = place / self.at_once();
                let first = place.is_multiple_of(self.at_once());
                if first && self.lengths.get(log).is_some_and(|&n| positions[log].len() < n) {
                    positions[log].push(value);
                }
            }
        };
        let candidates = std::slice::from_ref(physics);
        Run { lanes: self, candidates, watch, limit: f64::INFINITY }.go();
        positions
    }

    /// What a log and a candidate have of the sums of all lanes.
    fn sum(&self, sums: &[Block], log: usize, candidate: usize) -> f64 {
        let place = log * self.at_once() + candidate;
        sums.get(place / WIDTH).map_or(f64::NAN, |block| block[place % WIDTH])
    }
}

/// A simulation of all logs.
struct Run<'a, W> {
    lanes: &'a Lanes,
    /// As many as run side by side, or fewer.
    candidates: &'a [Physics],
    /// Sees every simulated position: block, positions.
    watch: W,
    /// Sum of errors at which the run is given up \[rad\].
    limit: f64,
}

impl<W: FnMut(usize, &Block)> Run<'_, W> {
    /// The sums of |simulated - measured| of each lane; `None` where it was given up.
    fn go(self) -> Option<Vec<Block>> {
        Arch::new().dispatch(self)
    }

    fn any(&self, of: impl Fn(&Physics) -> bool) -> bool {
        self.candidates.iter().any(of)
    }
}

impl<W: FnMut(usize, &Block)> WithSimd for Run<'_, W> {
    type Output = Option<Vec<Block>>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Self::Output {
        if fuses::<S>() { choose::<true, W>(self) } else { choose::<false, W>(self) }
    }
}

/// The loop that has no more in it than these candidates need.
#[inline(always)]
fn choose<const FUSED: bool, W: FnMut(usize, &Block)>(run: Run<'_, W>) -> Option<Vec<Block>> {
    let current = run.lanes.drive.control == Control::Current;
    let limited = run.any(|physics| physics.get(GoalSpeed).is_finite());
    match (current, limited) {
        (false, false) => choose_friction::<FUSED, false, false, W>(run),
        (false, true) => choose_friction::<FUSED, false, true, W>(run),
        (true, _) => choose_friction::<FUSED, true, true, W>(run),
    }
}

#[inline(always)]
fn choose_friction<
    const FUSED: bool,
    const CURRENT: bool,
    const LIMITED: bool,
    W: FnMut(usize, &Block),
>(
    run: Run<'_, W>,
) -> Option<Vec<Block>> {
    let stribeck = run.any(Physics::has_stribeck);
    let quadratic = run.any(|p| p.get(QuadraticExternal) != 0.0 || p.get(QuadraticMotor) != 0.0);
    let ripple = run.any(|p| p.get(RippleSine) != 0.0 || p.get(RippleCosine) != 0.0);
    match (stribeck, quadratic, ripple) {
        (false, _, false) => advance::<FUSED, CURRENT, LIMITED, false, false, false, W>(run),
        (true, false, false) => advance::<FUSED, CURRENT, LIMITED, true, false, false, W>(run),
        (true, true, false) => advance::<FUSED, CURRENT, LIMITED, true, true, false, W>(run),
        (_, false, true) => advance::<FUSED, CURRENT, LIMITED, true, false, true, W>(run),
        (_, true, true) => advance::<FUSED, CURRENT, LIMITED, true, true, true, W>(run),
    }
}

#[inline(always)]
fn advance<
    const FUSED: bool,
    const CURRENT: bool,
    const LIMITED: bool,
    const STRIBECK: bool,
    const QUADRATIC: bool,
    const RIPPLE: bool,
    W: FnMut(usize, &Block),
>(
    run: Run<'_, W>,
) -> Option<Vec<Block>> {
    let Run { lanes, candidates, mut watch, limit } = run;
    let n = lanes.groups.len();
    let copies = lanes.at_once();
    let last_candidate = candidates.len().checked_sub(1)?;
    // Lanes that are left over repeat the last candidate.
    let of_lane: [&Physics; WIDTH] =
        std::array::from_fn(|lane| &candidates[(lane % copies).min(last_candidate)]);
    let shift = of_lane.map(|physics| (physics.get(Delay) + lanes.delay) / TIME_STEP);
    let goals = Goals::new(lanes, shift);
    let fraction = shift.map(|shift| shift - shift.floor());
    let mut blocks: Vec<(Step, State)> = (lanes.groups.iter().zip(&lanes.samples))
        .map(|(group, first)| {
            let state = State {
                position: group.position,
                speed: group.speed,
                goal: first.goal,
                sum: [0.0; WIDTH],
            };
            (Step::new(group, of_lane, &lanes.drive, fraction), state)
        })
        .collect();
    for (k, samples) in lanes.samples.chunks_exact(n.max(1)).enumerate() {
        if k % LOOK == 0 && limit.is_finite() && all_beyond(&blocks, copies, limit) {
            return None;
        }
        let (late, earlier) = (goals.at(k, 0), goals.at(k, 1));
        for (block, ((step, state), sample)) in blocks.iter_mut().zip(samples).enumerate() {
            watch(block, &state.position);
            step.move_on::<FUSED, CURRENT, LIMITED, STRIBECK, QUADRATIC, RIPPLE>(
                k as f64,
                sample,
                &late.of(block),
                &earlier.of(block),
                state,
            );
        }
    }
    Some(blocks.iter().map(|(_, state)| state.sum).collect())
}

/// Whether the sums of every candidate exceed the limit, or are no numbers.
#[inline(always)]
fn all_beyond(blocks: &[(Step, State)], copies: usize, limit: f64) -> bool {
    let mut so_far = [0.0; WIDTH];
    for (_, state) in blocks {
        for (lane, sum) in state.sum.iter().enumerate() {
            so_far[lane % copies] += sum;
        }
    }
    so_far[..copies].iter().all(|sum| sum.is_nan() || *sum > limit)
}
