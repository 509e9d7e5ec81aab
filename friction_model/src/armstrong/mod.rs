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
//! period. In the derivative form the changes take effect when a step is accepted: an integrator
//! that does not search for them converges with the first order of the step.

use crate::arithmetic::{bounded, mean, saturate, sign};
use crate::delay_line::DelayLine;
use crate::finite::finite;
use crate::{
    Evaluation, FrictionModel, Internals, ModelError, ParameterSet, Range, Real, Regime, State,
    TimeStep, built_from, parameters,
};

parameters! {
    /// Parameters of [`Armstrong`] as files carry them.
    ArmstrongParameters<T> {
        /// Static friction F_s after a long rest \[N or N m\], at least `f_c`.
        f_s: T, Force, Range::Positive;
        /// Kinetic friction F_c \[N or N m\], above zero.
        f_c: T, Force, Range::Positive;
        /// Stribeck velocity v_s \[m/s or rad/s\], above zero.
        v_s: T, Speed, Range::Positive;
        /// Tangential stiffness k_t of the stuck contact \[N/m or N m/rad\], above zero.
        k_t: T, Stiffness, Range::Positive;
        /// Time tau_l by which friction lags behind the velocity \[s\], zero or more.
        tau_l: T, Time, Range::NonNegative;
        /// Dwell time gamma after which half of the static friction has come back \[s\], above
        /// zero.
        gamma: T, Time, Range::Positive;
        /// Viscous coefficient f_v \[N s/m or N m s/rad\], zero or more.
        f_v: T, Damping, Range::NonNegative;
    }
}

/// What the contact remembers between steps.
#[derive(Debug, Clone, PartialEq)]
pub struct ArmstrongMemory<T: Real = f64> {
    /// The velocity, for its delayed value.
    past: DelayLine<T>,
    /// Direction of the slip; zero while stuck.
    slip: T,
    /// Stribeck friction: of this slip, or while stuck, that at the end of the last one \[N or N
    /// m\].
    stribeck: T,
    /// Time stuck \[s\].
    dwell: T,
}

/// Armstrong-Helouvry's model with valid parameters. State: `[x, time since the last sample]`, the
/// past velocity, the dwell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Armstrong<T: Real = f64> {
    parameters: ArmstrongParameters<T>,
}

impl<T: Real> Armstrong<T> {
    /// `F_s(gamma, t_2)`, which the stuck contact has `ahead` \[s\] of the last sample.
    #[inline]
    fn risen(&self, memory: &ArmstrongMemory<T>, ahead: T) -> T {
        let ArmstrongParameters { f_s, f_c, gamma, .. } = self.parameters;
        let dwell = memory.dwell + ahead;
        memory.stribeck + (f_s - f_c - memory.stribeck) * (dwell / (dwell + gamma))
    }

    /// The level that holds now: of breakaway while stuck, of sliding in a slip.
    #[inline]
    fn level(&self, memory: &ArmstrongMemory<T>, velocity: T, ahead: T) -> T {
        let ArmstrongParameters { f_c, v_s, .. } = self.parameters;
        if memory.slip == T::ZERO {
            f_c + self.risen(memory, ahead)
        } else {
            let r = memory.past.delayed(velocity, ahead) / v_s;
            f_c + memory.stribeck / (T::ONE + r * r)
        }
    }

    /// Lets `elapsed` \[s\] go by, to a moment at which the velocity is `velocity`, and changes
    /// between sticking and sliding.
    #[inline]
    fn elapse(&self, state: &mut State<[T; 2], ArmstrongMemory<T>>, velocity: T, elapsed: T) {
        let ArmstrongParameters { f_c, k_t, .. } = self.parameters;
        let memory = &mut state.memory;
        let [x, _] = state.continuous;
        let outward = memory.past.now() * x > T::ZERO || velocity * x > T::ZERO;
        memory.past.push(velocity, elapsed);
        let mut x = x;
        if memory.slip == T::ZERO {
            memory.dwell += elapsed;
            let level = self.level(memory, velocity, T::ZERO);
            if outward && k_t * x.abs() >= level {
                memory.stribeck = self.risen(memory, T::ZERO);
                memory.slip = sign(x);
                x = memory.slip * level / k_t;
            }
        }
        if memory.slip != T::ZERO && velocity * memory.slip <= T::ZERO {
            let level = self.level(memory, velocity, T::ZERO);
            x = memory.slip * level / k_t;
            (memory.stribeck, memory.slip, memory.dwell) = (level - f_c, T::ZERO, T::ZERO);
        }
        state.continuous = [x, T::ZERO];
    }
}

impl<T: Real> TryFrom<ArmstrongParameters<T>> for Armstrong<T> {
    type Error = ModelError;

    fn try_from(p: ArmstrongParameters<T>) -> Result<Self, ModelError> {
        let name = Self::NAME;
        p.check(name)?;
        let condition = "at most f_s: kinetic friction does not exceed static friction";
        p.require(name, p.f_c <= p.f_s, "f_c", p.f_c, condition)?;
        p.require(
            name,
            (p.f_s / p.k_t).is_finite(),
            "k_t",
            p.k_t,
            "large enough for a finite deflection",
        )?;
        finite(Self { parameters: p })
    }
}

built_from!([T: Real] Armstrong<T>, ArmstrongParameters<T>);

impl<T: Real> FrictionModel<T> for Armstrong<T> {
    const NAME: &'static str = "armstrong";
    type Parameters = ArmstrongParameters<T>;
    type Continuous = [T; 2];
    type Memory = ArmstrongMemory<T>;
    /// The period \[s\].
    type Discrete = T;

    fn parameters(&self) -> &ArmstrongParameters<T> {
        &self.parameters
    }

    fn rest(&self) -> State<[T; 2], ArmstrongMemory<T>> {
        let p = &self.parameters;
        let past = DelayLine::new(p.tau_l, T::ZERO);
        let memory =
            ArmstrongMemory { past, slip: T::ZERO, stribeck: p.f_s - p.f_c, dwell: T::ZERO };
        State { continuous: [T::ZERO, T::ZERO], memory }
    }

    #[inline]
    fn evaluate(
        &self,
        &[x, ahead]: &[T; 2],
        memory: &ArmstrongMemory<T>,
        velocity: T,
    ) -> Evaluation<[T; 2], T> {
        let level = self.level(memory, velocity, ahead);
        if memory.slip == T::ZERO {
            return Evaluation {
                force: saturate(level, self.parameters.k_t * x),
                rates: [velocity, T::ONE],
            };
        }
        // A stage beyond the end of the slip: the force stays what it is, the viscous part is gone.
        let forward = if velocity * memory.slip > T::ZERO { velocity } else { T::ZERO };
        Evaluation {
            force: memory.slip * level + self.parameters.f_v * forward,
            rates: [T::ZERO, T::ONE],
        }
    }

    #[inline]
    fn commit(&self, state: &mut State<[T; 2], ArmstrongMemory<T>>, velocity: T, dt: T) {
        self.elapse(state, velocity, dt);
    }

    fn discretise(&self, dt: TimeStep) -> T {
        T::of(dt.seconds())
    }

    /// The period goes by at the beginning of the next step, when it is known where the velocity
    /// went.
    #[inline]
    fn step(&self, &dt: &T, state: &mut State<[T; 2], ArmstrongMemory<T>>, velocity: T) -> T {
        let v = bounded(velocity);
        let [_, elapsed] = state.continuous;
        self.elapse(state, v, elapsed);
        let Evaluation { force, rates: [x_rate, _] } =
            self.evaluate(&state.continuous, &state.memory, v);
        state.continuous = [state.continuous[0] + x_rate * dt, dt];
        force
    }

    /// The velocity goes straight through the delay, and the spring by its mean.
    #[inline]
    fn advance(&self, &dt: &T, state: &mut State<[T; 2], ArmstrongMemory<T>>, from: T, to: T) {
        if state.memory.slip == T::ZERO {
            state.continuous[0] += mean(from, to) * dt;
        }
        self.elapse(state, bounded(to), dt);
    }

    /// The spring alone; in a slip nothing is left to deflect.
    #[inline]
    fn inject(
        &self,
        dt: TimeStep,
        state: &mut State<[T; 2], ArmstrongMemory<T>>,
        _: T,
        rate: T,
    ) -> T {
        let ArmstrongParameters { f_s, k_t, .. } = self.parameters;
        let [x, elapsed] = state.continuous;
        if state.memory.slip == T::ZERO {
            state.continuous = [saturate(f_s / k_t, x + rate * T::of(dt.seconds())), elapsed];
        }
        T::ZERO
    }

    /// Of a slip after a long rest; after a short one the Stribeck part is smaller.
    fn steady_state(&self, velocity: T) -> T {
        let ArmstrongParameters { f_s, f_c, v_s, f_v, .. } = self.parameters;
        let r = velocity / v_s;
        sign(velocity) * (f_c + (f_s - f_c) / (T::ONE + r * r)) + f_v * velocity
    }

    fn internals(&self, state: &State<[T; 2], ArmstrongMemory<T>>, velocity: T) -> Internals<T> {
        let [x, ahead] = state.continuous;
        let gamma = self.level(&state.memory, velocity, ahead);
        let regime = if state.memory.slip == T::ZERO { Regime::Stick } else { Regime::Slip };
        let deflection = saturate(self.parameters.f_s / self.parameters.k_t, x);
        Internals { deflection, gamma, regime }
    }

    /// The direction of the slip.
    fn switches(&self, memory: &ArmstrongMemory<T>, f: &mut dyn FnMut(T)) {
        f(memory.slip);
    }

    #[inline]
    fn viscous(&self, velocity: T) -> T {
        self.parameters.f_v * velocity
    }

    /// Of the spring; in a slip, as much as at its breakaway.
    fn stored_energy(&self, state: &State<[T; 2], ArmstrongMemory<T>>) -> Option<T> {
        let [x, ahead] = state.continuous;
        let k_t = self.parameters.k_t;
        let most = if state.memory.slip == T::ZERO {
            self.level(&state.memory, T::ZERO, ahead) / k_t
        } else {
            x.abs()
        };
        let x = saturate(most, x);
        Some(T::HALF * k_t * x * x)
    }
}

#[cfg(test)]
mod tests;
