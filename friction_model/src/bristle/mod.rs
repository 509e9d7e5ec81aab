//! The bristle model of Haessig and Friedland: bonds that stretch, snap and are made anew at
//! random.
//!
//! ```text
//! u_i = x - b_i                             extension of bond i = 1..N, made at b_i
//! F   = sigma0 sum_i u_i + f_v v
//! |u_i| >= delta_s:  the bond snaps and is made anew, with u_i uniform in (-delta_s, delta_s)
//! ```
//!
//! D. A. Haessig and B. Friedland, "On the modeling and simulation of friction", ASME Journal of
//! Dynamic Systems, Measurement, and Control 113 (1991), 354-362, the first of the two models
//! there. The viscous term is an addition of this crate, zero if left out.
//!
//! | parameter | unit | range | meaning |
//! |---|---|---|---|
//! | `bonds` | - | 1 to 128 | number N of bonds, whole |
//! | `sigma0` | N/m or N m/rad | > 0 | stiffness of one bond |
//! | `delta_s` | m or rad | > 0 | extension at which a bond snaps |
//! | `seed` | - | >= 0 | seed of the random numbers, whole |
//! | `f_v` | N s/m or N m s/rad | >= 0, 0 if left out | viscous coefficient |
//!
//! In sliding, a bond lives for a travel uniform in `(0, 2 delta_s)`: a renewal process. It
//! follows, without viscous friction,
//!
//! * in sliding a bond's extension has the density `(delta_s + u) / (2 delta_s^2)`: mean force
//!   `F_c = N sigma0 delta_s / 3`, relative standard deviation `sqrt(2/N)`;
//! * from rest the mean force is `N sigma0 delta_s (1 + x/delta_s - e^(x/(2 delta_s)))` for
//!   `x <= 2 delta_s`. It starts with the stiffness `N sigma0 / 2`, because the bonds near the end
//!   snap at once, and has its peak `3 (2 ln 2 - 1) F_c = 1.159 F_c` at `2 ln 2 delta_s`;
//! * always `|F - f_v v| <= N sigma0 delta_s = 3 F_c`.
//!
//! New bonds may already be loaded, either way. (If they were made unloaded, the mean would be
//! `N sigma0 delta_s / 2`.) At rest the bonds are spread evenly over `(-delta_s, delta_s)`: they
//! hold each other, and store energy.
//!
//! It shows friction as many contacts that give way one by one: stiction, pre-sliding displacement,
//! and noise that falls with the number of bonds. It dissipates: a snapping bond always loses
//! energy. The mean does not depend on speed, so there is no Stribeck curve and no lag; inner loops
//! do not close, since what was made anew is random; the noise makes it unfit for compensation; and
//! each step costs time in proportion to N. Use it to test what friction noise does to a
//! controller. The same seed gives the same numbers, to the last bit; resetting a model starts the
//! sequence again.
//!
//! Only extensions are kept, so nothing grows with the distance. Fixed-step form: every bond
//! travels `v dt`, snapping on the way as often as it must; the force has the right distribution at
//! any period. A bond that travels more than `20 delta_s` in a step has forgotten its past to one
//! part in 10^8, and takes its extension from the density of sliding: a step's time is bounded.
//! Within a step of the derivative form, bonds beyond `delta_s` count with `delta_s`; they snap
//! when the step is accepted.

use rand_pcg::Pcg32;
use rand_pcg::rand_core::{Rng as _, SeedableRng as _};

use crate::arithmetic::{bounded, saturate, sign};
use crate::finite::finite;
use crate::{
    Evaluation, FrictionModel, Internals, ModelError, ParameterSet, Range, Real, Regime, State,
    TimeStep, built_from, parameters,
};

/// Most bonds a model can have.
pub const MAX_BONDS: usize = 128;

/// Travel in one step, in units of `delta_s`, after which a bond's extension no longer depends on
/// what it was: the slowest mode of the renewal process falls as `exp(-1.04 travel / delta_s)`.
const FORGOTTEN: f64 = 20.0;

/// Snaps of one bond in one step beyond which nothing is followed up. The travel above takes 20 in
/// the mean, with a standard deviation of 2.6.
const MOST_SNAPS: u32 = 64;

parameters! {
    /// Parameters of [`Bristle`] as files carry them.
    BristleParameters<T> {
        /// Number N of bonds, from 1 to 128.
        bonds: u32, None, Range::FromTo(1.0, 128.0);
        /// Stiffness sigma_0 of one bond \[N/m or N m/rad\], above zero.
        sigma0: T, Stiffness, Range::Positive;
        /// Extension delta_s at which a bond snaps \[m or rad\], above zero.
        delta_s: T, Deflection, Range::Positive;
        /// Seed of the random bonds: the same seed gives the same friction.
        seed: u32, None, Range::NonNegative;
        /// Viscous coefficient f_v \[N s/m or N m s/rad\], zero or more; 0 if left out.
        #[serde(default)]
        f_v: T, Damping, Range::NonNegative;
    }
}

impl<T: Real> BristleParameters<T> {
    /// `bonds` bonds with the mean sliding force `f_c` \[N or N m\] and, from rest, the mean
    /// stiffness `stiffness` \[N/m or N m/rad\].
    #[must_use]
    pub fn from_levels(bonds: u32, f_c: T, stiffness: T, f_v: T) -> Self {
        let sigma0 = T::TWO * stiffness / T::of(f64::from(bonds));
        Self { bonds, sigma0, delta_s: T::of(1.5) * f_c / stiffness, seed: 1, f_v }
    }
}

/// What a bristle contact remembers: every bond's extension and the random numbers to come.
#[derive(Debug, Clone, PartialEq)]
pub struct BristleMemory<T: Real = f64> {
    /// Extensions \[m or rad\]; those beyond the number of bonds are not used.
    extensions: [T; MAX_BONDS],
    random: Pcg32,
    /// Travel in the present direction, up to `2 delta_s`, after which every bond has snapped
    /// \[m or rad\].
    run: T,
}

/// Haessig and Friedland's bristle model with valid parameters. State: the travel since the last
/// accepted step, and the bonds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bristle<T: Real = f64> {
    parameters: BristleParameters<T>,
    /// Number of bonds.
    count: usize,
}

impl<T: Real> Bristle<T> {
    /// Mean sliding force F_c, without viscous friction \[N or N m\].
    #[must_use]
    pub fn kinetic(&self) -> T {
        self.bound() / T::of(3.0)
    }

    /// Largest force, `N sigma0 delta_s`, without viscous friction \[N or N m\].
    #[must_use]
    pub fn bound(&self) -> T {
        T::of(f64::from(self.parameters.bonds)) * self.parameters.sigma0 * self.parameters.delta_s
    }

    /// Sum of the extensions after a further `travel`.
    #[inline]
    fn sum(&self, bonds: &BristleMemory<T>, travel: T) -> T {
        let end = self.parameters.delta_s;
        bonds.extensions.iter().take(self.count).map(|u| saturate(end, *u + travel)).sum()
    }

    /// Lets every bond travel.
    #[inline]
    fn travel(&self, bonds: &mut BristleMemory<T>, travel: T) {
        if travel == T::ZERO || travel.is_nan() {
            return;
        }
        let end = self.parameters.delta_s;
        let before = if bonds.run * travel > T::ZERO { bonds.run } else { T::ZERO };
        bonds.run = saturate(T::TWO * end, before + travel);
        let direction = sign(travel);
        for u in bonds.extensions.iter_mut().take(self.count) {
            *u = direction * travelled(&mut bonds.random, end, direction * *u, travel.abs());
        }
    }
}

/// Extension of a bond that snaps at `end` and had the extension `u`, `travel` forward from there.
#[inline]
fn travelled<T: Real>(random: &mut Pcg32, end: T, mut u: T, travel: T) -> T {
    if travel > T::of(FORGOTTEN) * end {
        return end * (T::TWO * uniform::<T>(random).sqrt() - T::ONE);
    }
    let mut left = travel;
    for _ in 0..MOST_SNAPS {
        if u + left < end {
            return u + left;
        }
        left -= end - u;
        u = end * (T::TWO * uniform(random) - T::ONE);
    }
    u
}

/// Uniform in (0, 1), neither end included.
#[inline]
fn uniform<T: Real>(random: &mut Pcg32) -> T {
    const STEP: f64 = 1.0 / 4_294_967_296.0;
    T::of((f64::from(random.next_u32()) + 0.5) * STEP)
}

impl<T: Real> TryFrom<BristleParameters<T>> for Bristle<T> {
    type Error = ModelError;

    fn try_from(p: BristleParameters<T>) -> Result<Self, ModelError> {
        let name = Self::NAME;
        p.check(name)?;
        let model = Self { parameters: p, count: (p.bonds as usize).min(MAX_BONDS) };
        let condition = "so that bonds sigma0 delta_s is a finite number above zero";
        let holds = model.bound().is_finite() && model.kinetic() > T::ZERO;
        p.require(name, holds, "delta_s", p.delta_s, condition)?;
        finite(model)
    }
}

built_from!([T: Real] Bristle<T>, BristleParameters<T>);

impl<T: Real> FrictionModel<T> for Bristle<T> {
    const NAME: &'static str = "bristle";
    type Parameters = BristleParameters<T>;
    type Continuous = [T; 1];
    type Memory = BristleMemory<T>;
    /// The period \[s\].
    type Discrete = T;

    fn parameters(&self) -> &BristleParameters<T> {
        &self.parameters
    }

    fn rest(&self) -> State<[T; 1], BristleMemory<T>> {
        let n = T::of(f64::from(self.parameters.bonds));
        let mut extensions = [T::ZERO; MAX_BONDS];
        for (i, u) in (0u32..).zip(extensions.iter_mut().take(self.count)) {
            *u = self.parameters.delta_s * ((T::TWO * T::of(f64::from(i)) + T::ONE - n) / n);
        }
        let random = Pcg32::seed_from_u64(u64::from(self.parameters.seed));
        State { continuous: [T::ZERO], memory: BristleMemory { extensions, random, run: T::ZERO } }
    }

    #[inline]
    fn evaluate(
        &self,
        &[travel]: &[T; 1],
        bonds: &BristleMemory<T>,
        velocity: T,
    ) -> Evaluation<[T; 1], T> {
        let force =
            self.parameters.sigma0 * self.sum(bonds, travel) + self.parameters.f_v * velocity;
        Evaluation { force, rates: [velocity] }
    }

    #[inline]
    fn commit(&self, state: &mut State<[T; 1], BristleMemory<T>>, _: T, _: T) {
        let [travel] = state.continuous;
        self.travel(&mut state.memory, travel);
        state.continuous = [T::ZERO];
    }

    fn discretise(&self, dt: TimeStep) -> T {
        T::of(dt.seconds())
    }

    #[inline]
    fn step(&self, &dt: &T, state: &mut State<[T; 1], BristleMemory<T>>, velocity: T) -> T {
        let v = bounded(velocity);
        let force = self.evaluate(&state.continuous, &state.memory, v).force;
        let [travel] = state.continuous;
        state.continuous = [T::ZERO];
        self.travel(&mut state.memory, travel + v * dt);
        force
    }

    #[inline]
    fn inject(
        &self,
        dt: TimeStep,
        state: &mut State<[T; 1], BristleMemory<T>>,
        _: T,
        rate: T,
    ) -> T {
        self.travel(&mut state.memory, rate * T::of(dt.seconds()));
        T::ZERO
    }

    /// The mean: the force itself fluctuates.
    fn steady_state(&self, velocity: T) -> T {
        sign(velocity) * self.kinetic() + self.parameters.f_v * velocity
    }

    /// The mean extension. Slip once the contact has travelled `2 delta_s` in one direction: by
    /// then every bond has snapped.
    fn internals(&self, state: &State<[T; 1], BristleMemory<T>>, velocity: T) -> Internals<T> {
        let [travel] = state.continuous;
        let deflection = self.sum(&state.memory, travel) / T::of(f64::from(self.parameters.bonds));
        let run = state.memory.run * sign(velocity);
        let regime =
            if run >= T::TWO * self.parameters.delta_s { Regime::Slip } else { Regime::Stick };
        Internals { deflection, gamma: self.kinetic(), regime }
    }

    #[inline]
    fn viscous(&self, velocity: T) -> T {
        self.parameters.f_v * velocity
    }

    /// `sigma0/2 sum_i u_i^2`. At rest it is not zero: the bonds hold each other.
    fn stored_energy(&self, state: &State<[T; 1], BristleMemory<T>>) -> Option<T> {
        let [travel] = state.continuous;
        let end = self.parameters.delta_s;
        let extensions = state.memory.extensions.iter().take(self.count);
        let squares: T = extensions.map(|u| saturate(end, *u + travel)).map(|u| u * u).sum();
        Some(T::HALF * self.parameters.sigma0 * squares)
    }
}

#[cfg(test)]
mod tests;
