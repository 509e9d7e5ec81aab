//! Hysteretic dry friction after Wojewoda, Stefanski, Wiercigroch and Kapitaniak: a characteristic
//! that the sign of the acceleration splits in two, on a spring.
//!
//! ```text
//! stuck:     z' = v,  F = k_t z + f_v v           until k_t |z| reaches F_s
//! sliding:   |k_t z| <= g,  z' = v below that,  F = k_t z + f_v v
//! g = F_c + [(F_s + F_d)/2 - F_c + w (F_s - F_d)/2] exp(-|v|/v_s)
//! w = sat(1, a sgn v / a_0)        without a_0: w = sgn(a sgn v)         a: acceleration
//! ```
//!
//! So a contact that speeds up follows the upper branch `F_c + (F_s - F_c) exp(-|v|/v_s)`, one that
//! slows down the lower branch `F_c + (F_d - F_c) exp(-|v|/v_s)`, and at constant velocity it lies
//! midway: force over velocity is a loop.
//!
//! **What is from the papers and what is not.** J. Wojewoda, A. Stefanski, M. Wiercigroch and T.
//! Kapitaniak, "Hysteretic effects of dry friction: modelling and experimental studies",
//! Philosophical Transactions of the Royal Society A 366 (2008), 747-765; and A. Stefanski, J.
//! Wojewoda, M. Wiercigroch and T. Kapitaniak, "Chaos caused by non-reversible dry friction",
//! Chaos, Solitons and Fractals 16 (2003), 661-664. For this file only the abstract and the opening
//! of the first could be read, of the second the title: **not their equations**. The abstract has
//! that measured friction shows hysteresis, and that a simple model captures it; the title calls
//! the characteristic non-reversible. At second hand, and not checked, is that the sign of the
//! acceleration chooses the branch and that a spring precedes sliding. Reconstructed here are the
//! exponential shape, `F_d`, the level midway at zero acceleration, the width `a_0`, and the rules
//! of sticking. Parameters and figures of the papers cannot be carried over.
//!
//! | parameter | unit | range | meaning |
//! |---|---|---|---|
//! | `f_s` | N or N m | >= `f_c` | static friction, and the upper branch at low speed |
//! | `f_c` | N or N m | > 0 | kinetic friction at high speed |
//! | `f_d` | N or N m | (0, `f_s`], `f_c` if left out | the lower branch at low speed |
//! | `v_s` | m/s or rad/s | > 0 | speed over which the branches approach each other |
//! | `k_t` | N/m or N m/rad | > 0 | stiffness of the contact |
//! | `a_0` | m/s^2 or rad/s^2 | > 0, may be left out | acceleration at which a branch is reached; a jump at zero if left out |
//! | `f_v` | N s/m or N m s/rad | >= 0, 0 if left out | viscous coefficient |
//!
//! It sticks again where the velocity changes its sign or is zero: the spring goes on from where it
//! is, and has to reach `F_s` once more. Steady state:
//! `sgn v [F_c + ((F_s + F_d)/2 - F_c) exp(-|v|/v_s)] + f_v v`.
//!
//! Use it where friction measured over velocity shows a loop and no memory is wanted beyond the
//! last velocity. The loop does not depend on how fast the velocity changes (with `a_0` left out),
//! which tells it from a lag. A measured velocity's noise changes the sign of the acceleration all
//! the time: choose `a_0` above the noise. It does not drift; its pre-sliding is a spring without
//! hysteresis. It is passive with the storage `k_t z^2 / 2`, since a changing level only ever cuts
//! the deflection. Bound: `|F - f_v v| <= F_s`.
//!
//! Fixed-step form: `a` is the change of the velocity since the last step over the period; `z`
//! advances under the held velocity, and is cut to the level at the next step. In the derivative
//! form `a` is that of the last accepted step.

use crate::arithmetic::{bounded, mean, saturate, sign};
use crate::finite::finite;
use crate::{
    Evaluation, FrictionModel, Internals, ModelError, ParameterSet, Range, Real, Regime, State,
    TimeStep, built_from, parameters,
};

parameters! {
    /// Parameters of [`Wojewoda`] as files carry them.
    WojewodaParameters<T> {
        /// Static friction F_s \[N or N m\], at least `f_c`.
        f_s: T, Force, Range::Positive;
        /// Kinetic friction F_c at high speed \[N or N m\], above zero.
        f_c: T, Force, Range::Positive;
        /// Friction F_d at low speed while slowing down \[N or N m\], above zero, at most `f_s`;
        /// `f_c` if left out.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        f_d: Option<T>, Force, Range::Positive;
        /// Speed v_s over which the branches approach each other \[m/s or rad/s\], above zero.
        v_s: T, Speed, Range::Positive;
        /// Stiffness k_t of the contact \[N/m or N m/rad\], above zero.
        k_t: T, Stiffness, Range::Positive;
        /// Acceleration a_0 at which a branch is reached \[m/s^2 or rad/s^2\], above zero; a jump
        /// at zero if left out.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        a_0: Option<T>, Acceleration, Range::Positive;
        /// Viscous coefficient f_v \[N s/m or N m s/rad\], zero or more; 0 if left out.
        #[serde(default)]
        f_v: T, Damping, Range::NonNegative;
    }
}

/// What the contact remembers between steps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WojewodaMemory<T: Real = f64> {
    /// At the last sample \[m/s or rad/s\].
    velocity: T,
    /// Since the sample before \[m/s^2 or rad/s^2\].
    acceleration: T,
    /// Direction of the slip; zero while stuck.
    slip: T,
}

/// The hysteretic model with valid parameters. State: `[z]`, the last velocity and acceleration,
/// and whether it slides.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wojewoda<T: Real = f64> {
    parameters: WojewodaParameters<T>,
    /// `(F_s + F_d)/2 - F_c` and `(F_s - F_d)/2`.
    midway: T,
    half_width: T,
}

impl<T: Real> Wojewoda<T> {
    /// `exp(-|v|/v_s)`: how far the branches still are from `F_c`.
    #[inline]
    fn falling(&self, velocity: T) -> T {
        (-velocity.abs() / self.parameters.v_s).exp()
    }

    /// Level of sliding; `weight` is 1 on the upper branch, -1 on the lower one.
    #[inline]
    fn sliding(&self, falling: T, weight: T) -> T {
        self.parameters.f_c + (self.midway + weight * self.half_width) * falling
    }

    /// The most that the contact carries now.
    #[inline]
    fn level(&self, motion: &WojewodaMemory<T>, velocity: T, falling: T) -> T {
        if motion.slip == T::ZERO {
            return self.parameters.f_s;
        }
        let faster = if velocity < T::ZERO { -motion.acceleration } else { motion.acceleration };
        self.sliding(
            falling,
            self.parameters.a_0.map_or(sign(faster), |a_0| saturate(T::ONE, faster / a_0)),
        )
    }

    /// Force and rate at deflection `z`.
    #[inline]
    fn contact(
        &self,
        z: T,
        motion: &WojewodaMemory<T>,
        velocity: T,
        falling: T,
    ) -> Evaluation<[T; 1], T> {
        let p = &self.parameters;
        let (level, spring) = (self.level(motion, velocity, falling), p.k_t * z);
        let at_the_end =
            motion.slip != T::ZERO && spring.abs() >= level && spring * velocity > T::ZERO;
        let rate = if at_the_end { T::ZERO } else { velocity };
        Evaluation { force: saturate(level, spring) + p.f_v * velocity, rates: [rate] }
    }

    /// Breaks away if the spring carries `F_s`.
    #[inline]
    fn break_away(&self, motion: &mut WojewodaMemory<T>, z: T) {
        if motion.slip == T::ZERO && self.parameters.k_t * z.abs() >= self.parameters.f_s {
            motion.slip = sign(z);
        }
    }

    /// Takes in a sample of the velocity, `elapsed` \[s\] after the last one.
    #[inline]
    fn sample(
        &self,
        state: &mut State<[T; 1], WojewodaMemory<T>>,
        velocity: T,
        falling: T,
        elapsed: T,
    ) {
        let motion = &mut state.memory;
        let [z] = state.continuous;
        motion.acceleration = (velocity - motion.velocity) / elapsed;
        motion.velocity = velocity;
        self.break_away(motion, z);
        if velocity * motion.slip <= T::ZERO {
            motion.slip = T::ZERO;
        }
        state.continuous =
            [saturate(self.level(motion, velocity, falling) / self.parameters.k_t, z)];
    }
}

impl<T: Real> TryFrom<WojewodaParameters<T>> for Wojewoda<T> {
    type Error = ModelError;

    fn try_from(p: WojewodaParameters<T>) -> Result<Self, ModelError> {
        let name = Self::NAME;
        p.check(name)?;
        let condition = "at most f_s: kinetic friction does not exceed static friction";
        p.require(name, p.f_c <= p.f_s, "f_c", p.f_c, condition)?;
        let f_d = p.f_d.unwrap_or(p.f_c);
        p.require(
            name,
            f_d <= p.f_s,
            "f_d",
            f_d,
            "at most f_s: the lower branch lies below the upper one",
        )?;
        p.require(
            name,
            (p.f_s / p.k_t).is_finite(),
            "k_t",
            p.k_t,
            "large enough for a finite deflection",
        )?;
        let (midway, half_width) =
            (T::HALF * p.f_s + T::HALF * f_d - p.f_c, T::HALF * p.f_s - T::HALF * f_d);
        finite(Self { parameters: p, midway, half_width })
    }
}

built_from!([T: Real] Wojewoda<T>, WojewodaParameters<T>);

impl<T: Real> FrictionModel<T> for Wojewoda<T> {
    const NAME: &'static str = "wojewoda";
    type Parameters = WojewodaParameters<T>;
    type Continuous = [T; 1];
    type Memory = WojewodaMemory<T>;
    /// The period \[s\].
    type Discrete = T;

    fn parameters(&self) -> &WojewodaParameters<T> {
        &self.parameters
    }

    fn rest(&self) -> State<[T; 1], WojewodaMemory<T>> {
        State {
            continuous: [T::ZERO],
            memory: WojewodaMemory { velocity: T::ZERO, acceleration: T::ZERO, slip: T::ZERO },
        }
    }

    #[inline]
    fn evaluate(
        &self,
        state: &[T; 1],
        motion: &WojewodaMemory<T>,
        velocity: T,
    ) -> Evaluation<[T; 1], T> {
        self.at(velocity)(state, motion)
    }

    #[inline]
    fn at(&self, velocity: T) -> impl Fn(&[T; 1], &WojewodaMemory<T>) -> Evaluation<[T; 1], T> {
        let falling = self.falling(velocity);
        move |&[z], motion| self.contact(z, motion, velocity, falling)
    }

    #[inline]
    fn commit(&self, state: &mut State<[T; 1], WojewodaMemory<T>>, velocity: T, dt: T) {
        self.sample(state, velocity, self.falling(velocity), dt);
    }

    fn discretise(&self, dt: TimeStep) -> T {
        T::of(dt.seconds())
    }

    #[inline]
    fn step(&self, &dt: &T, state: &mut State<[T; 1], WojewodaMemory<T>>, velocity: T) -> T {
        let v = bounded(velocity);
        let falling = self.falling(v);
        self.sample(state, v, falling, dt);
        let [z] = state.continuous;
        let force = self.contact(z, &state.memory, v, falling).force;
        self.break_away(&mut state.memory, z + v * dt);
        state.continuous = [saturate(self.parameters.f_s / self.parameters.k_t, z + v * dt)];
        force
    }

    /// The spring goes by the mean; then the velocity is sampled.
    #[inline]
    fn advance(&self, &dt: &T, state: &mut State<[T; 1], WojewodaMemory<T>>, from: T, to: T) {
        let v = bounded(to);
        let z = state.continuous[0] + mean(from, to) * dt;
        self.break_away(&mut state.memory, z);
        state.continuous = [saturate(self.parameters.f_s / self.parameters.k_t, z)];
        self.sample(state, v, self.falling(v), dt);
    }

    #[inline]
    fn inject(
        &self,
        dt: TimeStep,
        state: &mut State<[T; 1], WojewodaMemory<T>>,
        _: T,
        rate: T,
    ) -> T {
        let [z] = state.continuous;
        let z = z + rate * T::of(dt.seconds());
        self.break_away(&mut state.memory, z);
        state.continuous = [saturate(self.parameters.f_s / self.parameters.k_t, z)];
        T::ZERO
    }

    fn steady_state(&self, velocity: T) -> T {
        sign(velocity) * self.sliding(self.falling(velocity), T::ZERO)
            + self.parameters.f_v * velocity
    }

    fn internals(&self, state: &State<[T; 1], WojewodaMemory<T>>, velocity: T) -> Internals<T> {
        let [z] = state.continuous;
        let gamma = self.level(&state.memory, velocity, self.falling(velocity));
        let regime = if state.memory.slip == T::ZERO { Regime::Stick } else { Regime::Slip };
        Internals { deflection: saturate(gamma / self.parameters.k_t, z), gamma, regime }
    }

    /// The direction of the slip.
    fn switches(&self, motion: &WojewodaMemory<T>, f: &mut dyn FnMut(T)) {
        f(motion.slip);
    }

    #[inline]
    fn viscous(&self, velocity: T) -> T {
        self.parameters.f_v * velocity
    }

    fn stored_energy(&self, state: &State<[T; 1], WojewodaMemory<T>>) -> Option<T> {
        let [z] = state.continuous;
        let velocity = state.memory.velocity;
        let level = self.level(&state.memory, velocity, self.falling(velocity));
        let z = saturate(level / self.parameters.k_t, z);
        Some(T::HALF * self.parameters.k_t * z * z)
    }
}

#[cfg(test)]
mod tests;
