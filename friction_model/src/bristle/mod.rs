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

#[cfg(not(feature = "std"))]
use num_traits::Float as _;
use rand_pcg::Pcg32;
use rand_pcg::rand_core::{Rng as _, SeedableRng as _};

use crate::arithmetic::{bounded, saturate, sign};
use crate::{
    Evaluation, FrictionModel, Internals, ModelError, ParameterSet, Range, Regime, State, TimeStep,
    built_from, parameters,
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
    BristleParameters {
        /// Number N of bonds, from 1 to 128.
        bonds: u32, None, Range::FromTo(1.0, 128.0);
        /// Stiffness sigma_0 of one bond [N/m or N m/rad], above zero.
        sigma0: f64, Stiffness, Range::Positive;
        /// Extension delta_s at which a bond snaps [m or rad], above zero.
        delta_s: f64, Deflection, Range::Positive;
        /// Seed of the random bonds: the same seed gives the same friction.
        seed: u32, None, Range::NonNegative;
        /// Viscous coefficient f_v [N s/m or N m s/rad], zero or more; 0 if left out.
        #[serde(default)]
        f_v: f64, Damping, Range::NonNegative;
    }
}

impl BristleParameters {
    /// `bonds` bonds with the mean sliding force `f_c` [N or N m] and, from rest, the mean
    /// stiffness `stiffness` [N/m or N m/rad].
    #[must_use]
    pub fn from_levels(bonds: u32, f_c: f64, stiffness: f64, f_v: f64) -> Self {
        let sigma0 = 2.0 * stiffness / f64::from(bonds);
        Self { bonds, sigma0, delta_s: 1.5 * f_c / stiffness, seed: 1, f_v }
    }
}

/// What a bristle contact remembers: every bond's extension and the random numbers to come.
#[derive(Debug, Clone, PartialEq)]
pub struct BristleMemory {
    /// Extensions [m or rad]; those beyond the number of bonds are not used.
    extensions: [f64; MAX_BONDS],
    random: Pcg32,
    /// Travel in the present direction, up to `2 delta_s`, after which every bond has snapped
    /// [m or rad].
    run: f64,
}

/// Haessig and Friedland's bristle model with valid parameters. State: the travel since the last
/// accepted step, and the bonds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bristle {
    parameters: BristleParameters,
    /// Number of bonds.
    count: usize,
}

impl Bristle {
    /// Mean sliding force F_c, without viscous friction [N or N m].
    #[must_use]
    pub fn kinetic(&self) -> f64 {
        self.bound() / 3.0
    }

    /// Largest force, `N sigma0 delta_s`, without viscous friction [N or N m].
    #[must_use]
    pub fn bound(&self) -> f64 {
        f64::from(self.parameters.bonds) * self.parameters.sigma0 * self.parameters.delta_s
    }

    /// Sum of the extensions after a further `travel`.
    #[inline]
    fn sum(&self, bonds: &BristleMemory, travel: f64) -> f64 {
        let end = self.parameters.delta_s;
        bonds.extensions.iter().take(self.count).map(|u| saturate(end, u + travel)).sum()
    }

    /// Lets every bond travel.
    #[inline]
    fn travel(&self, bonds: &mut BristleMemory, travel: f64) {
        if travel == 0.0 || travel.is_nan() {
            return;
        }
        let end = self.parameters.delta_s;
        let before = if bonds.run * travel > 0.0 { bonds.run } else { 0.0 };
        bonds.run = saturate(2.0 * end, before + travel);
        let direction = sign(travel);
        for u in bonds.extensions.iter_mut().take(self.count) {
            *u = direction * travelled(&mut bonds.random, end, direction * *u, travel.abs());
        }
    }
}

/// Extension of a bond that snaps at `end` and had the extension `u`, `travel` forward from there.
#[inline]
fn travelled(random: &mut Pcg32, end: f64, mut u: f64, travel: f64) -> f64 {
    if travel > FORGOTTEN * end {
        return end * (2.0 * uniform(random).sqrt() - 1.0);
    }
    let mut left = travel;
    for _ in 0..MOST_SNAPS {
        if u + left < end {
            return u + left;
        }
        left -= end - u;
        u = end * (2.0 * uniform(random) - 1.0);
    }
    u
}

/// Uniform in (0, 1), neither end included.
#[inline]
fn uniform(random: &mut Pcg32) -> f64 {
    const STEP: f64 = 1.0 / 4_294_967_296.0;
    (f64::from(random.next_u32()) + 0.5) * STEP
}

impl TryFrom<BristleParameters> for Bristle {
    type Error = ModelError;

    fn try_from(p: BristleParameters) -> Result<Self, ModelError> {
        let name = Self::NAME;
        p.check(name)?;
        let model = Self { parameters: p, count: (p.bonds as usize).min(MAX_BONDS) };
        let condition = "so that bonds sigma0 delta_s is a finite number above zero";
        let holds = model.bound().is_finite() && model.kinetic() > 0.0;
        BristleParameters::require(name, holds, "delta_s", p.delta_s, condition)?;
        Ok(model)
    }
}

built_from!(Bristle, BristleParameters);

impl FrictionModel for Bristle {
    const NAME: &'static str = "bristle";
    type Parameters = BristleParameters;
    type Continuous = [f64; 1];
    type Memory = BristleMemory;
    /// The period [s].
    type Discrete = f64;

    fn parameters(&self) -> &BristleParameters {
        &self.parameters
    }

    fn rest(&self) -> State<[f64; 1], BristleMemory> {
        let n = f64::from(self.parameters.bonds);
        let mut extensions = [0.0; MAX_BONDS];
        for (i, u) in (0u32..).zip(extensions.iter_mut().take(self.count)) {
            *u = self.parameters.delta_s * ((2.0 * f64::from(i) + 1.0 - n) / n);
        }
        let random = Pcg32::seed_from_u64(u64::from(self.parameters.seed));
        State { continuous: [0.0], memory: BristleMemory { extensions, random, run: 0.0 } }
    }

    #[inline]
    fn evaluate(
        &self,
        &[travel]: &[f64; 1],
        bonds: &BristleMemory,
        velocity: f64,
    ) -> Evaluation<[f64; 1]> {
        let force =
            self.parameters.sigma0 * self.sum(bonds, travel) + self.parameters.f_v * velocity;
        Evaluation { force, rates: [velocity] }
    }

    #[inline]
    fn commit(&self, state: &mut State<[f64; 1], BristleMemory>, _: f64, _: f64) {
        let [travel] = state.continuous;
        self.travel(&mut state.memory, travel);
        state.continuous = [0.0];
    }

    fn discretise(&self, dt: TimeStep) -> f64 {
        dt.seconds()
    }

    #[inline]
    fn step(&self, dt: &f64, state: &mut State<[f64; 1], BristleMemory>, velocity: f64) -> f64 {
        let v = bounded(velocity);
        let force = self.evaluate(&state.continuous, &state.memory, v).force;
        let [travel] = state.continuous;
        state.continuous = [0.0];
        self.travel(&mut state.memory, travel + v * dt);
        force
    }

    #[inline]
    fn inject(
        &self,
        dt: TimeStep,
        state: &mut State<[f64; 1], BristleMemory>,
        _: f64,
        rate: f64,
    ) -> f64 {
        self.travel(&mut state.memory, rate * dt.seconds());
        0.0
    }

    /// The mean: the force itself fluctuates.
    fn steady_state(&self, velocity: f64) -> f64 {
        sign(velocity) * self.kinetic() + self.parameters.f_v * velocity
    }

    /// The mean extension. Slip once the contact has travelled `2 delta_s` in one direction: by
    /// then every bond has snapped.
    fn internals(&self, state: &State<[f64; 1], BristleMemory>, velocity: f64) -> Internals {
        let [travel] = state.continuous;
        let deflection = self.sum(&state.memory, travel) / f64::from(self.parameters.bonds);
        let run = state.memory.run * sign(velocity);
        let regime =
            if run >= 2.0 * self.parameters.delta_s { Regime::Slip } else { Regime::Stick };
        Internals { deflection, gamma: self.kinetic(), regime }
    }

    #[inline]
    fn viscous(&self, velocity: f64) -> f64 {
        self.parameters.f_v * velocity
    }

    /// `sigma0/2 sum_i u_i^2`. At rest it is not zero: the bonds hold each other.
    fn stored_energy(&self, state: &State<[f64; 1], BristleMemory>) -> Option<f64> {
        let [travel] = state.continuous;
        let end = self.parameters.delta_s;
        let extensions = state.memory.extensions.iter().take(self.count);
        let squares: f64 = extensions.map(|u| saturate(end, u + travel)).map(|u| u * u).sum();
        Some(0.5 * self.parameters.sigma0 * squares)
    }
}

#[cfg(test)]
mod tests;
