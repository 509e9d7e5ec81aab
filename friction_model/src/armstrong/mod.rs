//! Armstrong-Helouvry's integrated model with seven parameters.
//!
//! ```text
//! stuck:    F = k_t x                                                                 x' = v
//! sliding:  F = [F_c + f_v |v| + F_s(gamma, t_2) / (1 + (v(t - tau_l)/v_s)^2)] sgn v
//! rising static friction:  F_s(gamma, t_2) = F_sa + (F_sinf - F_sa) t_2 / (t_2 + gamma)
//! ```
//!
//! `F_sa` is the Stribeck friction at the end of the last slip, `t_2` the time that the contact was
//! stuck before this one. B. Armstrong-Helouvry, P. Dupont and C. Canudas de Wit, "A survey of
//! models, analysis tools and compensation methods for the control of machines with friction",
//! Automatica 30 (1994), 1083-1138, section on the integrated model.
//!
//! | parameter | unit | range | meaning |
//! |---|---|---|---|
//! | `f_s` | N or N m | >= `f_c` | static friction after a long rest, `F_c + F_sinf` (the paper lists `F_sinf`) |
//! | `f_c` | N or N m | > 0 | kinetic friction |
//! | `v_s` | m/s or rad/s | > 0 | Stribeck velocity |
//! | `k_t` | N/m or N m/rad | > 0 | tangential stiffness of the stuck contact |
//! | `tau_l` | s | >= 0 | time by which friction lags behind the velocity |
//! | `gamma` | s | > 0 | dwell after which half of the static friction has come back |
//! | `f_v` | N s/m or N m s/rad | >= 0 | viscous coefficient |
//!
//! The paper gives the two branches and leaves open how the contact changes from one to the other
//! (H. Olsson and others, "Friction models and friction compensation", European Journal of Control
//! 4 (1998), remark on that gap). The rules here:
//!
//! * **it breaks away** when `k_t |x|` reaches `F_c + F_s(gamma, t_2)`; that `F_s` then belongs to
//!   the whole slip. The force is continuous there as far as the delayed velocity is still small,
//!   and jumps by the viscous friction of the moment;
//! * **it sticks** when the velocity changes its sign or is zero; `x` starts anew where the spring
//!   carries the force of the moment, `k_t x = +-(F_c + F_sa)`, so that the force is continuous,
//!   and the dwell time starts at zero;
//! * at rest the contact has been stuck for ever.
//!
//! It was made to gather everything known about friction of machines at low speed in one formula:
//! spring-like pre-sliding, the Stribeck curve (a Lorentz curve), lag as a pure delay, and static
//! friction that rises with the dwell. Use it for stick-slip where dwell and lag matter. It does
//! not drift. Its pre-sliding is a spring without damping or hysteresis. **Its sliding friction
//! depends on the last dwell:** after a short one the Stribeck part stays smaller for the whole
//! slip. The steady state given here is that of a slip after a long rest.
//!
//! It is passive. No force within a slip exceeds that of its breakaway, so the spring never gives
//! back more than it took; the stored energy is `k_t x^2 / 2`, in a slip with the deflection of its
//! breakaway. Bound: `|F| <= F_s + f_v |v|`.
//!
//! Fixed-step form: `x` and the dwell time are exact for a held velocity, breakaway takes effect at
//! the next period. The delay is a line with 32 intervals of `tau_l/32`, linear in between, for any
//! period. In the derivative form the changes take effect when a step is accepted: runs converge
//! with the first order of the step.

use crate::arithmetic::{bounded, saturate, sign};
use crate::delay_line::DelayLine;
use crate::{
    Evaluation, FrictionModel, Internals, ModelError, ParameterSet, Range, Regime, State, TimeStep,
    built_from, parameters,
};

parameters! {
    /// Parameters of [`Armstrong`] as files carry them.
    ArmstrongParameters {
        /// Static friction F_s after a long rest [N or N m], at least `f_c`.
        f_s: f64, Force, Range::Positive;
        /// Kinetic friction F_c [N or N m], above zero.
        f_c: f64, Force, Range::Positive;
        /// Stribeck velocity v_s [m/s or rad/s], above zero.
        v_s: f64, Speed, Range::Positive;
        /// Tangential stiffness k_t of the stuck contact [N/m or N m/rad], above zero.
        k_t: f64, Stiffness, Range::Positive;
        /// Time tau_l by which friction lags behind the velocity [s], zero or more.
        tau_l: f64, Time, Range::NonNegative;
        /// Dwell time gamma after which half of the static friction has come back [s], above zero.
        gamma: f64, Time, Range::Positive;
        /// Viscous coefficient f_v [N s/m or N m s/rad], zero or more.
        f_v: f64, Damping, Range::NonNegative;
    }
}

/// What the contact remembers between steps.
#[derive(Debug, Clone, PartialEq)]
pub struct ArmstrongMemory {
    /// The velocity, for its delayed value.
    past: DelayLine,
    /// Direction of the slip; zero while stuck.
    slip: f64,
    /// Stribeck friction: of this slip, or while stuck, that at the end of the last one [N or N m].
    stribeck: f64,
    /// Time stuck [s].
    dwell: f64,
}

/// Armstrong-Helouvry's model with valid parameters. State: `[x, time since the last sample]`, the
/// past velocity, the dwell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Armstrong {
    parameters: ArmstrongParameters,
}

impl Armstrong {
    /// `F_s(gamma, t_2)`, which the stuck contact has `ahead` [s] of the last sample.
    #[inline]
    fn risen(&self, memory: &ArmstrongMemory, ahead: f64) -> f64 {
        let ArmstrongParameters { f_s, f_c, gamma, .. } = self.parameters;
        let dwell = memory.dwell + ahead;
        memory.stribeck + (f_s - f_c - memory.stribeck) * (dwell / (dwell + gamma))
    }

    /// The level that holds now: of breakaway while stuck, of sliding in a slip.
    #[inline]
    fn level(&self, memory: &ArmstrongMemory, velocity: f64, ahead: f64) -> f64 {
        let ArmstrongParameters { f_c, v_s, .. } = self.parameters;
        if memory.slip == 0.0 {
            f_c + self.risen(memory, ahead)
        } else {
            let r = memory.past.delayed(velocity, ahead) / v_s;
            f_c + memory.stribeck / (1.0 + r * r)
        }
    }

    /// Lets `elapsed` [s] go by, to a moment at which the velocity is `velocity`, and changes
    /// between sticking and sliding.
    #[inline]
    fn advance(&self, state: &mut State<[f64; 2], ArmstrongMemory>, velocity: f64, elapsed: f64) {
        let ArmstrongParameters { f_c, k_t, .. } = self.parameters;
        let memory = &mut state.memory;
        let [x, _] = state.continuous;
        let outward = memory.past.now() * x > 0.0 || velocity * x > 0.0;
        memory.past.push(velocity, elapsed);
        let mut x = x;
        if memory.slip == 0.0 {
            memory.dwell += elapsed;
            let level = self.level(memory, velocity, 0.0);
            if outward && k_t * x.abs() >= level {
                memory.stribeck = self.risen(memory, 0.0);
                memory.slip = sign(x);
                x = memory.slip * level / k_t;
            }
        }
        if memory.slip != 0.0 && velocity * memory.slip <= 0.0 {
            let level = self.level(memory, velocity, 0.0);
            x = memory.slip * level / k_t;
            (memory.stribeck, memory.slip, memory.dwell) = (level - f_c, 0.0, 0.0);
        }
        state.continuous = [x, 0.0];
    }
}

impl TryFrom<ArmstrongParameters> for Armstrong {
    type Error = ModelError;

    fn try_from(p: ArmstrongParameters) -> Result<Self, ModelError> {
        let name = Self::NAME;
        p.check(name)?;
        let require = ArmstrongParameters::require;
        let condition = "at most f_s: kinetic friction does not exceed static friction";
        require(name, p.f_c <= p.f_s, "f_c", p.f_c, condition)?;
        require(
            name,
            (p.f_s / p.k_t).is_finite(),
            "k_t",
            p.k_t,
            "large enough for a finite deflection",
        )?;
        Ok(Self { parameters: p })
    }
}

built_from!(Armstrong, ArmstrongParameters);

impl FrictionModel for Armstrong {
    const NAME: &'static str = "armstrong";
    type Parameters = ArmstrongParameters;
    type Continuous = [f64; 2];
    type Memory = ArmstrongMemory;
    /// The period [s].
    type Discrete = f64;

    fn parameters(&self) -> &ArmstrongParameters {
        &self.parameters
    }

    fn rest(&self) -> State<[f64; 2], ArmstrongMemory> {
        let p = &self.parameters;
        let past = DelayLine::new(p.tau_l, 0.0);
        let memory = ArmstrongMemory { past, slip: 0.0, stribeck: p.f_s - p.f_c, dwell: 0.0 };
        State { continuous: [0.0, 0.0], memory }
    }

    #[inline]
    fn evaluate(
        &self,
        &[x, ahead]: &[f64; 2],
        memory: &ArmstrongMemory,
        velocity: f64,
    ) -> Evaluation<[f64; 2]> {
        let level = self.level(memory, velocity, ahead);
        if memory.slip == 0.0 {
            return Evaluation {
                force: saturate(level, self.parameters.k_t * x),
                rates: [velocity, 1.0],
            };
        }
        // A stage beyond the end of the slip: the force stays what it is, the viscous part is gone.
        let forward = if velocity * memory.slip > 0.0 { velocity } else { 0.0 };
        Evaluation { force: memory.slip * level + self.parameters.f_v * forward, rates: [0.0, 1.0] }
    }

    #[inline]
    fn commit(&self, state: &mut State<[f64; 2], ArmstrongMemory>, velocity: f64, dt: f64) {
        self.advance(state, velocity, dt);
    }

    fn discretise(&self, dt: TimeStep) -> f64 {
        dt.seconds()
    }

    /// The period goes by at the beginning of the next step, when it is known where the velocity
    /// went.
    #[inline]
    fn step(&self, dt: &f64, state: &mut State<[f64; 2], ArmstrongMemory>, velocity: f64) -> f64 {
        let v = bounded(velocity);
        let [_, elapsed] = state.continuous;
        self.advance(state, v, elapsed);
        let Evaluation { force, rates: [x_rate, _] } =
            self.evaluate(&state.continuous, &state.memory, v);
        state.continuous = [state.continuous[0] + x_rate * dt, *dt];
        force
    }

    /// The spring alone; in a slip nothing is left to deflect.
    #[inline]
    fn inject(
        &self,
        dt: TimeStep,
        state: &mut State<[f64; 2], ArmstrongMemory>,
        _: f64,
        rate: f64,
    ) -> f64 {
        let ArmstrongParameters { f_s, k_t, .. } = self.parameters;
        let [x, elapsed] = state.continuous;
        if state.memory.slip == 0.0 {
            state.continuous = [saturate(f_s / k_t, x + rate * dt.seconds()), elapsed];
        }
        0.0
    }

    /// Of a slip after a long rest; after a short one the Stribeck part is smaller.
    fn steady_state(&self, velocity: f64) -> f64 {
        let ArmstrongParameters { f_s, f_c, v_s, f_v, .. } = self.parameters;
        let r = velocity / v_s;
        sign(velocity) * (f_c + (f_s - f_c) / (1.0 + r * r)) + f_v * velocity
    }

    fn internals(&self, state: &State<[f64; 2], ArmstrongMemory>, velocity: f64) -> Internals {
        let [x, ahead] = state.continuous;
        let gamma = self.level(&state.memory, velocity, ahead);
        let regime = if state.memory.slip == 0.0 { Regime::Stick } else { Regime::Slip };
        let deflection = saturate(self.parameters.f_s / self.parameters.k_t, x);
        Internals { deflection, gamma, regime }
    }

    #[inline]
    fn viscous(&self, velocity: f64) -> f64 {
        self.parameters.f_v * velocity
    }

    /// Of the spring; in a slip, as much as at its breakaway.
    fn stored_energy(&self, state: &State<[f64; 2], ArmstrongMemory>) -> Option<f64> {
        let [x, ahead] = state.continuous;
        let k_t = self.parameters.k_t;
        let most = if state.memory.slip == 0.0 {
            self.level(&state.memory, 0.0, ahead) / k_t
        } else {
            x.abs()
        };
        let x = saturate(most, x);
        Some(0.5 * k_t * x * x)
    }
}

#[cfg(test)]
mod tests;
