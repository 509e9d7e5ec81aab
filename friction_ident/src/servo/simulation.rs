//! The step of all logs: written for one log without a branch, run for four at once by whatever
//! the processor has. The width is chosen when the program runs.

use pulp::{Arch, Simd, WithSimd};

use super::drive::Control;
use super::elementary::{exp, larger, ln, sin, smaller, within};
use super::lanes::{Four, Group, Lanes, Sample, WIDTH};
use super::log::TIME_STEP;
use super::parameter::ServoParameter::*;
use super::physics::Physics;

/// No axis of this size turns faster \[rad/s\].
const FASTEST: f64 = 100.0;
/// Samples between two looks at whether a candidate is beaten already.
const LOOK: usize = 60;

#[derive(Debug, Clone, Copy)]
struct State {
    position: Four,
    speed: Four,
    goal: Four,
    sum: Four,
}

/// Coefficients of one candidate, ready for the step.
#[derive(Debug, Clone, Copy)]
struct Step {
    k_t: f64,
    per_r: f64,
    offset: f64,
    armature: f64,
    gain_scale: f64,
    full_scale: f64,
    goal_step: f64,
    k_c: f64,
    k_v: f64,
    k_e: f64,
    k_m: f64,
    k_2: f64,
    k_cs: f64,
    k_es: f64,
    k_ms: f64,
    k_eq: f64,
    k_mq: f64,
    per_w_s: f64,
    alpha: f64,
    ripple_sine: f64,
    ripple_cosine: f64,
    ripples: f64,
    /// Share of the goal before the last one.
    fraction: f64,
}

impl Lanes {
    /// Mean of |simulated - measured| over all samples of all logs \[rad\]; infinite as soon as it
    /// must exceed `limit`.
    pub fn error(&self, physics: &Physics, limit: f64) -> f64 {
        let run =
            Run { lanes: self, physics, watch: |_: usize, _: &Four| {}, limit: limit * self.total };
        run.go().map_or(f64::INFINITY, |sums| sums.iter().flatten().sum::<f64>() / self.total)
    }

    /// The same for each log \[rad\].
    pub fn errors(&self, physics: &Physics) -> Vec<f64> {
        let run =
            Run { lanes: self, physics, watch: |_: usize, _: &Four| {}, limit: f64::INFINITY };
        let sums = run.go().unwrap_or_default();
        let sums = sums.iter().flatten();
        sums.zip(&self.lengths).map(|(sum, &length)| sum / length as f64).collect()
    }

    /// The simulated positions of each log \[rad\].
    pub fn positions(&self, physics: &Physics) -> Vec<Vec<f64>> {
        let mut positions: Vec<Vec<f64>> =
            self.lengths.iter().map(|&n| Vec::with_capacity(n)).collect();
        let watch = |group: usize, q: &Four| {
            for (lane, &value) in q.iter().enumerate() {
                let log = WIDTH * group + lane;
                if self.lengths.get(log).is_some_and(|&n| positions[log].len() < n) {
                    positions[log].push(value);
                }
            }
        };
        Run { lanes: self, physics, watch, limit: f64::INFINITY }.go();
        positions
    }
}

/// A simulation of all logs.
struct Run<'a, W> {
    lanes: &'a Lanes,
    physics: &'a Physics,
    /// Sees every simulated position: group, positions.
    watch: W,
    /// Sum of errors at which the run is given up \[rad\].
    limit: f64,
}

impl<W: FnMut(usize, &Four)> Run<'_, W> {
    /// The sums of |simulated - measured| of each group; `None` where it was given up.
    pub(super) fn go(self) -> Option<Vec<Four>> {
        Arch::new().dispatch(self)
    }
}

impl<W: FnMut(usize, &Four)> WithSimd for Run<'_, W> {
    type Output = Option<Vec<Four>>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Self::Output {
        let current = self.lanes.drive.control == Control::Current;
        let ripple = self.physics.get(RippleSine) != 0.0 || self.physics.get(RippleCosine) != 0.0;
        match (current, self.physics.has_stribeck(), ripple) {
            (false, false, false) => advance::<false, false, false, W>(self),
            (false, true, false) => advance::<false, true, false, W>(self),
            (false, _, true) => advance::<false, true, true, W>(self),
            (true, false, false) => advance::<true, false, false, W>(self),
            (true, true, false) => advance::<true, true, false, W>(self),
            (true, _, true) => advance::<true, true, true, W>(self),
        }
    }
}

#[inline(always)]
fn advance<
    const CURRENT: bool,
    const STRIBECK: bool,
    const RIPPLE: bool,
    W: FnMut(usize, &Four),
>(
    run: Run<'_, W>,
) -> Option<Vec<Four>> {
    let Run { lanes, physics, mut watch, limit } = run;
    let n = lanes.groups.len().max(1);
    // The goal, moved by a fraction of the grid.
    let shift = (physics.get(Delay) + lanes.delay) / TIME_STEP;
    let whole = shift.floor();
    let behind = whole as isize;
    let last = (lanes.samples.len() / n) as isize - 1;
    let step = coefficients(physics, lanes.drive.full_scale, shift - whole);
    let mut states: Vec<State> = lanes
        .groups
        .iter()
        .zip(&lanes.samples)
        .map(|(group, first)| State {
            position: group.position,
            speed: group.speed,
            goal: first.goal,
            sum: [0.0; WIDTH],
        })
        .collect();
    for (k, samples) in lanes.samples.chunks_exact(n).enumerate() {
        if k % LOOK == 0 && limit.is_finite() {
            let so_far: f64 = states.iter().flat_map(|state| state.sum).sum();
            if so_far.is_nan() || so_far > limit {
                return None;
            }
        }
        let from = (k as isize - behind).clamp(0, last) as usize * n;
        let before = (k as isize - behind - 1).clamp(0, last) as usize * n;
        let late = &lanes.samples[from..from + n];
        let earlier = &lanes.samples[before..before + n];
        for (index, state) in states.iter_mut().enumerate() {
            watch(index, &state.position);
            *state = moved::<CURRENT, STRIBECK, RIPPLE>(
                &step,
                &lanes.groups[index],
                &samples[index],
                &late[index].goal,
                &earlier[index].goal,
                *state,
            );
        }
    }
    Some(states.iter().map(|state| state.sum).collect())
}

fn coefficients(physics: &Physics, full_scale: f64, fraction: f64) -> Step {
    let of = |parameter| physics.get(parameter);
    Step {
        k_t: of(TorqueConstant),
        per_r: of(TorqueConstant) / of(Resistance),
        offset: of(PositionOffset),
        armature: of(Armature),
        gain_scale: of(GainScale),
        full_scale: of(FullScale) * full_scale,
        goal_step: of(GoalSpeed) * TIME_STEP,
        k_c: of(Coulomb),
        k_v: of(Viscous),
        k_e: of(ExternalLoad),
        k_m: of(MotorLoad),
        k_2: of(LoadSquared),
        k_cs: of(StribeckCoulomb),
        k_es: of(StribeckExternal),
        k_ms: of(StribeckMotor),
        k_eq: of(QuadraticExternal),
        k_mq: of(QuadraticMotor),
        per_w_s: 1.0 / of(StribeckVelocity),
        alpha: of(StribeckExponent),
        ripple_sine: of(RippleSine),
        ripple_cosine: of(RippleCosine),
        ripples: of(RippleCount),
        fraction,
    }
}

/// One step of four logs. The loop has no branch and no call, so that the compiler takes all four
/// at once.
#[inline(always)]
fn moved<const CURRENT: bool, const STRIBECK: bool, const RIPPLE: bool>(
    step: &Step,
    group: &Group,
    sample: &Sample,
    late: &Four,
    earlier: &Four,
    state: State,
) -> State {
    let mut next = state;
    for i in 0..WIDTH {
        let (q, w) = (state.position[i], state.speed[i]);
        let asked = late[i] + (earlier[i] - late[i]) * step.fraction;
        let goal = within(asked, state.goal[i] - step.goal_step, state.goal[i] + step.goal_step);
        let inertia = group.inertia[i] + step.armature;

        let command = (goal - q) * (group.gain[i] * step.gain_scale) - group.damping[i] * w;
        let command = within(command, -step.full_scale, step.full_scale);
        let motor = if CURRENT {
            // What the supply can give at this speed.
            let most = step.per_r * group.supply[i];
            let back = step.per_r * step.k_t * w;
            within(step.k_t * command, -most - back, most - back)
        } else {
            step.per_r * (group.supply[i] * command - step.k_t * w)
        } * sample.enabled[i];
        let external = -group.moment[i] * sin(q + step.offset);
        let stop = inertia * w * (1.0 / TIME_STEP) + motor + external;
        let speed = w.abs();
        let mut level =
            step.k_c + (step.k_e * external - step.k_m * motor).abs() + step.k_2 * motor * motor;
        if STRIBECK {
            let x = larger(speed * step.per_w_s, 1e-100);
            let grown = exp(within(ln(x) * step.alpha, -700.0, 6.5));
            let fall = exp(-grown);
            let (e, m) = (external.abs(), motor.abs());
            let quadratic = if m > e { step.k_eq * e * e } else { step.k_mq * m * m };
            let opposed = if external * motor < 0.0 { quadratic } else { 0.0 };
            level +=
                fall * (step.k_cs + (step.k_es * external - step.k_ms * motor).abs() + opposed);
        }
        if RIPPLE {
            let angle = q * step.ripples;
            let ripple = step.ripple_sine * sin(angle)
                + step.ripple_cosine * sin(angle + std::f64::consts::FRAC_PI_2);
            level *= larger(1.0 + ripple, 0.0);
        }
        level += speed * step.k_v;
        let friction = -within(stop, -level, level);
        let acceleration = (motor + external + friction) / inertia;
        let faster = within(w + acceleration * TIME_STEP, -FASTEST, FASTEST);
        next.speed[i] = faster;
        next.goal[i] = goal;
        next.sum[i] = state.sum[i] + (q - sample.position[i]).abs() * sample.counts[i];
        next.position[i] =
            smaller(q + faster * TIME_STEP + acceleration * (0.5 * TIME_STEP * TIME_STEP), 1e6);
    }
    next
}
