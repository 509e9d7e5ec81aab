//! One step of a block: written for one lane without a branch or a call, so that the compiler takes
//! all lanes at once.

use std::f64::consts::LOG2_E;

use friction_lanes::elementary::{exp2, larger, log2, mul_add, sin, smaller, within};

use super::drive::Drive;
use super::lanes::{Block, Group, Sample, WIDTH};
use super::log::TIME_STEP;
use super::parameter::ServoParameter::*;
use super::physics::Physics;

/// No axis of this size turns faster \[rad/s\].
const FASTEST: f64 = 100.0;

/// How a block moves.
#[derive(Debug, Clone, Copy)]
pub(super) struct State {
    pub position: Block,
    pub speed: Block,
    pub goal: Block,
    /// Sum of |simulated - measured| \[rad\].
    pub sum: Block,
}

/// Coefficients of the candidates in the lanes of a block, ready for the step.
#[derive(Debug, Clone, Copy)]
pub(super) struct Step {
    k_t: Block,
    offset: Block,
    full_scale: Block,
    goal_step: Block,
    k_c: Block,
    k_v: Block,
    k_e: Block,
    k_m: Block,
    k_2: Block,
    k_cs: Block,
    k_es: Block,
    k_ms: Block,
    k_eq: Block,
    k_mq: Block,
    alpha: Block,
    /// What the logarithm of the speed is raised by: |w/w_s|^alpha to base 2, over ln 2.
    raised: Block,
    ripple: Block,
    ripple_phase: Block,
    ripples: Block,
    /// Share of the goal before the last one.
    fraction: Block,
    /// Command per error \[1/rad or A/rad\].
    gain: Block,
    damping: Block,
    /// Torque at standstill and the whole supply \[N m\].
    stall: Block,
    /// Torque that a turning motor loses \[N m s/rad\].
    back: Block,
    moment: Block,
    /// Torque that stops the axis within a step, per speed \[N m s/rad\].
    stop: Block,
    per_inertia: Block,
    length: Block,
}

impl Step {
    /// Of the block with these logs; a candidate for each lane. `fraction` is that of a delay.
    pub fn new(
        group: &Group,
        candidates: [&Physics; WIDTH],
        drive: &Drive,
        fraction: Block,
    ) -> Self {
        let lane = |of: &dyn Fn(usize, &Physics) -> f64| -> Block {
            std::array::from_fn(|lane| of(lane, candidates[lane]))
        };
        let every = |parameter| lane(&|_, physics| physics.get(parameter));
        let inertia = |lane: usize, physics: &Physics| group.inertia[lane] + physics.get(Armature);
        let per_r = |physics: &Physics| physics.get(TorqueConstant) / physics.get(Resistance);
        Self {
            k_t: every(TorqueConstant),
            offset: every(PositionOffset),
            full_scale: lane(&|_, physics| physics.get(FullScale) * drive.full_scale),
            goal_step: lane(&|_, physics| physics.get(GoalSpeed) * TIME_STEP),
            k_c: every(Coulomb),
            k_v: every(Viscous),
            k_e: every(ExternalLoad),
            k_m: every(MotorLoad),
            k_2: every(LoadSquared),
            k_cs: every(StribeckCoulomb),
            k_es: every(StribeckExternal),
            k_ms: every(StribeckMotor),
            k_eq: every(QuadraticExternal),
            k_mq: every(QuadraticMotor),
            alpha: every(StribeckExponent),
            raised: lane(&|_, physics| {
                LOG2_E.log2() - physics.get(StribeckExponent) * physics.get(StribeckVelocity).log2()
            }),
            ripple: lane(&|_, physics| physics.get(RippleSine).hypot(physics.get(RippleCosine))),
            ripple_phase: lane(&|_, physics| {
                physics.get(RippleCosine).atan2(physics.get(RippleSine))
            }),
            ripples: every(RippleCount),
            fraction,
            gain: lane(&|lane, physics| group.gain[lane] * physics.get(GainScale)),
            damping: group.damping,
            stall: lane(&|lane, physics| per_r(physics) * group.supply[lane]),
            back: lane(&|_, physics| per_r(physics) * physics.get(TorqueConstant)),
            moment: group.moment,
            stop: lane(&|lane, physics| inertia(lane, physics) / TIME_STEP),
            per_inertia: lane(&|lane, physics| inertia(lane, physics).recip()),
            length: group.length,
        }
    }

    /// Moves a state beyond the `instant`-th sample, with the goals that take effect then and those
    /// of one sample before.
    #[inline(always)]
    pub fn move_on<
        const FUSED: bool,
        const CURRENT: bool,
        const LIMITED: bool,
        const STRIBECK: bool,
        const QUADRATIC: bool,
        const RIPPLE: bool,
    >(
        &self,
        instant: f64,
        sample: &Sample,
        late: &Block,
        earlier: &Block,
        state: &mut State,
    ) {
        let fma = mul_add::<FUSED>;
        let before = *state;
        for i in 0..WIDTH {
            let (q, w) = (before.position[i], before.speed[i]);
            let asked = fma(earlier[i] - late[i], self.fraction[i], late[i]);
            let goal = if LIMITED {
                let (goal, most) = (before.goal[i], self.goal_step[i]);
                within(asked, goal - most, goal + most)
            } else {
                asked
            };

            let command = fma(goal - q, self.gain[i], -(self.damping[i] * w));
            let command = within(command, -self.full_scale[i], self.full_scale[i]);
            let back = self.back[i] * w;
            let motor = if CURRENT {
                // What the supply can give at this speed.
                within(self.k_t[i] * command, -self.stall[i] - back, self.stall[i] - back)
            } else {
                fma(self.stall[i], command, -back)
            } * sample.enabled[i];
            let external = -self.moment[i] * sin::<FUSED>(q + self.offset[i]);
            let driving = motor + external;
            let stop = fma(self.stop[i], w, driving);
            let speed = w.abs();
            let load = fma(self.k_e[i], external, -(self.k_m[i] * motor)).abs();
            let mut level = fma(self.k_2[i] * motor, motor, self.k_c[i] + load);
            if STRIBECK {
                let grown = fma(log2::<FUSED>(speed), self.alpha[i], self.raised[i]);
                let fall = exp2::<FUSED>(-exp2::<FUSED>(within(grown, -1000.0, 9.5)));
                let mut part =
                    self.k_cs[i] + fma(self.k_es[i], external, -(self.k_ms[i] * motor)).abs();
                if QUADRATIC {
                    let (e, m) = (external.abs(), motor.abs());
                    let quadratic = if m > e { self.k_eq[i] * e * e } else { self.k_mq[i] * m * m };
                    part += if external * motor < 0.0 { quadratic } else { 0.0 };
                }
                level = fma(fall, part, level);
            }
            if RIPPLE {
                let angle = fma(q, self.ripples[i], self.ripple_phase[i]);
                level *= larger(fma(self.ripple[i], sin::<FUSED>(angle), 1.0), 0.0);
            }
            level = fma(speed, self.k_v[i], level);
            let acceleration = (driving - within(stop, -level, level)) * self.per_inertia[i];
            let faster = within(fma(acceleration, TIME_STEP, w), -FASTEST, FASTEST);
            let counts = if instant < self.length[i] { 1.0 } else { 0.0 };
            state.speed[i] = faster;
            state.goal[i] = goal;
            state.sum[i] = fma((q - sample.position[i]).abs(), counts, before.sum[i]);
            let moved = fma(acceleration, 0.5 * TIME_STEP * TIME_STEP, q);
            state.position[i] = smaller(fma(faster, TIME_STEP, moved), 1e6);
        }
    }
}
