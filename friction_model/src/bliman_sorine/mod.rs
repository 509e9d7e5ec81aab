//! Bliman and Sorine's second-order model, linear in the distance slid.
//!
//! ```text
//! s = int |v| dt,   dx/ds = A x + B sgn v,   F = x_1 + x_2 + f_v v
//! A = diag(-1/(eta eps_f), -1/eps_f),   B = [f_1/(eta eps_f), -f_2/eps_f]
//! ```
//!
//! P.-A. Bliman and M. Sorine, "Friction modelling by hysteresis operators: application to Dahl,
//! sticktion and Stribeck effects" (Models of Hysteresis, Trento 1991), and "Easy-to-use realistic
//! dry friction models for automatic control" (3rd European Control Conference, Rome 1995,
//! 3788-3794). The viscous term is an addition of this crate, zero if left out.
//!
//! | parameter | unit | range | meaning |
//! |---|---|---|---|
//! | `f_1` | N or N m | > `f_2` | level of the fast part |
//! | `f_2` | N or N m | >= 0 | level of the slow part, which is subtracted |
//! | `eta` | - | (0, 1) | distance of the fast part over that of the slow one |
//! | `eps_f` | m or rad | > 0 | distance constant of the slow part |
//! | `f_v` | N s/m or N m s/rad | >= 0, 0 if left out | viscous coefficient |
//!
//! Two Dahl models in parallel, the slower one with a negative sign. From rest,
//! `F(s) = f_1 (1 - e^(-s/(eta eps_f))) - f_2 (1 - e^(-s/eps_f))`. With `q = eta f_2 / f_1` it
//! follows that
//!
//! * it starts with the stiffness `(f_1/eta - f_2) / eps_f`;
//! * its peak, the stiction, lies at `s_p = eps_f eta/(1 - eta) ln(1/q)` and is `F_s = F_c + D`,
//!   `D = f_2 (1 - eta) q^(eta/(1 - eta))`;
//! * it ends at `F_c = f_1 - f_2`;
//! * after long sliding and a reversal the peak lies as far away and is `F_c + 2 D`, the most it
//!   ever reaches: `F_c + 2 D` is the integral of the magnitude of the impulse response, so no path
//!   from rest exceeds it.
//!
//! With `f_2 = 0` it is Dahl's model with `F_c = f_1` and `sigma0 = f_1/(eta eps_f)`.
//!
//! **Passive**, for every parameter set that is accepted. The work is `int F sgn v ds`, so the
//! model is passive if its transfer function from `sgn v` to `F`,
//! `f_1/(1 + eta eps_f p) - f_2/(1 + eps_f p)`, is positive real. Its real part at `p = i w/eps_f`
//! is `[(f_1 - f_2) + (f_1 - eta^2 f_2) w^2] / [(1 + eta^2 w^2)(1 + w^2)]`: the condition is
//! `f_1 >= f_2` and `f_1 >= eta^2 f_2`, of which `eta < 1` leaves `f_1 >= f_2`. (This derivation is
//! ours; it was not compared with that of the papers.) The energy that
//! [`FrictionModel::stored_energy`] gives is the smallest storage function of the linear system,
//! the lower solution of its Riccati equation. With `f_1 < f_2` sliding would drive the motion;
//! such parameters are refused.
//!
//! It has stiction, the fall after it, pre-sliding displacement and hysteresis, and between
//! reversals it is linear. All of it is rate-independent: the fall depends on distance, so there is
//! no Stribeck curve over speed and no lag, and a slow slide settles at `F_c` as a fast one does.
//! As Dahl's model, it drifts under small oscillating loads and inner loops do not close. Use it
//! for short strokes, where stiction falls over a distance.
//!
//! Fixed-step form: the exact solution for a velocity held over the period,
//! `x_i <- x_i' + (x_i - x_i') exp(-|v| dt/l_i)` with `x' = (f_1, -f_2) sgn v` and
//! `l = (eta eps_f, eps_f)`; stable at any period.

use crate::arithmetic::{bounded, relaxed, saturate, sign};
use crate::finite::finite;
use crate::{
    Evaluation, FrictionModel, Internals, ModelError, ParameterSet, Range, Real, Regime, State,
    TimeStep, built_from, parameters,
};

parameters! {
    /// Parameters of [`BlimanSorine`] as files carry them.
    BlimanSorineParameters<T> {
        /// Level f_1 of the fast part \[N or N m\], above `f_2`.
        f_1: T, Force, Range::Positive;
        /// Level f_2 of the slow part \[N or N m\], zero or more.
        f_2: T, Force, Range::NonNegative;
        /// Ratio eta of the distance constants of the fast and the slow part, between 0 and 1,
        /// neither allowed.
        eta: T, None, Range::Within(0.0, 1.0);
        /// Distance constant eps_f of the slow part \[m or rad\], above zero.
        eps_f: T, Deflection, Range::Positive;
        /// Viscous coefficient f_v \[N s/m or N m s/rad\], zero or more; 0 if left out.
        #[serde(default)]
        f_v: T, Damping, Range::NonNegative;
    }
}

impl<T: Real> BlimanSorineParameters<T> {
    /// With `eta = 1/2`, from the peak `f_s >= f_c` that is reached from rest and the level `f_c`
    /// after it \[N or N m\], and the stiffness at rest \[N/m or N m/rad\].
    ///
    /// There `F_s - F_c = f_2^2 / (4 f_1)`, which determines `f_2`.
    #[must_use]
    pub fn from_levels(f_s: T, f_c: T, stiffness: T, f_v: T) -> Self {
        let excess = f_s - f_c;
        let f_2 = T::TWO * (excess + (excess * f_s).sqrt());
        let f_1 = f_c + f_2;
        Self { f_1, f_2, eta: T::HALF, eps_f: (T::TWO * f_1 - f_2) / stiffness, f_v }
    }
}

/// Bliman and Sorine's model with valid parameters. State: `[x_1, x_2]` \[N or N m\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BlimanSorine<T: Real = f64> {
    parameters: BlimanSorineParameters<T>,
    /// `1/(eta eps_f)` and `1/eps_f`.
    decay: [T; 2],
    /// The storage function `x' P x / 2`: its diagonal and what lies beside it.
    storage: [T; 3],
}

impl<T: Real> BlimanSorine<T> {
    /// Stiffness at rest, `(f_1/eta - f_2)/eps_f` \[N/m or N m/rad\].
    #[must_use]
    pub fn stiffness(&self) -> T {
        let BlimanSorineParameters { f_1, f_2, .. } = self.parameters;
        f_1 * self.decay[0] - f_2 * self.decay[1]
    }

    /// The stiction that is reached from rest: the distance \[m or rad\] and the force \[N or N
    /// m\], without viscous friction. `None` where the force only rises, `f_2 = 0`.
    #[must_use]
    pub fn peak(&self) -> Option<(T, T)> {
        let BlimanSorineParameters { f_1, f_2, eta, eps_f, .. } = self.parameters;
        let q = eta * f_2 / f_1;
        let exponent = eta / (T::ONE - eta);
        let force = f_1 - f_2 + f_2 * (T::ONE - eta) * q.powf(exponent);
        (q > T::ZERO).then(|| (-eps_f * exponent * q.ln(), force))
    }

    /// Where the states come to rest in motion in the direction of `velocity`.
    #[inline]
    fn ends(&self, velocity: T) -> [T; 2] {
        [self.parameters.f_1 * sign(velocity), -self.parameters.f_2 * sign(velocity)]
    }
}

/// The smallest storage function, in closed form. For `P B = C^T` one unknown is left, here `beta`;
/// the dissipation inequality is a quadratic in it with the roots `2 / (u +- w)`.
fn smallest_storage<T: Real>(p: &BlimanSorineParameters<T>) -> [T; 3] {
    let BlimanSorineParameters { f_1, f_2, eta, eps_f, .. } = *p;
    let ratio = f_2 / f_1;
    let u = T::ONE - eta * ratio;
    let w = ((T::ONE - ratio) * (T::ONE - eta * eta * ratio)).sqrt();
    let beta = T::TWO / (u + w);
    // (beta - 1)/ratio without the division by a ratio of zero: 2 - u - w = 1 - w + eta ratio.
    let slow = (T::ONE + eta * eta - eta * eta * ratio) / (T::ONE + w) + eta;
    let scale = eps_f / f_1;
    [scale * eta * (T::ONE + beta * eta * ratio), scale * beta * eta, scale * slow / (u + w)]
}

impl<T: Real> TryFrom<BlimanSorineParameters<T>> for BlimanSorine<T> {
    type Error = ModelError;

    fn try_from(p: BlimanSorineParameters<T>) -> Result<Self, ModelError> {
        let name = Self::NAME;
        p.check(name)?;
        p.require(
            name,
            p.f_1 > p.f_2,
            "f_1",
            p.f_1,
            "above f_2: their difference is the kinetic friction",
        )?;
        p.require(name, p.eta < T::ONE, "eta", p.eta, "below 1: the slow part is the slower one")?;
        let decay = [T::ONE / (p.eta * p.eps_f), T::ONE / p.eps_f];
        let steep = "large enough for a finite stiffness";
        p.require(name, (p.f_1 * decay[0]).is_finite(), "eps_f", p.eps_f, steep)?;
        finite(Self { parameters: p, decay, storage: smallest_storage(&p) })
    }
}

built_from!([T: Real] BlimanSorine<T>, BlimanSorineParameters<T>);

impl<T: Real> FrictionModel<T> for BlimanSorine<T> {
    const NAME: &'static str = "bliman_sorine";
    type Parameters = BlimanSorineParameters<T>;
    type Continuous = [T; 2];
    type Memory = ();
    /// The period \[s\].
    type Discrete = T;

    fn parameters(&self) -> &BlimanSorineParameters<T> {
        &self.parameters
    }

    fn rest(&self) -> State<[T; 2], ()> {
        State { continuous: [T::ZERO, T::ZERO], memory: () }
    }

    #[inline]
    fn evaluate(&self, &[x_1, x_2]: &[T; 2], (): &(), velocity: T) -> Evaluation<[T; 2], T> {
        let ([end_1, end_2], [decay_1, decay_2]) = (self.ends(velocity), self.decay);
        let speed = velocity.abs();
        Evaluation {
            force: x_1 + x_2 + self.parameters.f_v * velocity,
            rates: [speed * decay_1 * (end_1 - x_1), speed * decay_2 * (end_2 - x_2)],
        }
    }

    #[inline]
    fn commit(&self, state: &mut State<[T; 2], ()>, _: T, _: T) {
        let [x_1, x_2] = state.continuous;
        state.continuous = [saturate(self.parameters.f_1, x_1), saturate(self.parameters.f_2, x_2)];
    }

    fn discretise(&self, dt: TimeStep) -> T {
        T::of(dt.seconds())
    }

    #[inline]
    fn step(&self, &dt: &T, state: &mut State<[T; 2], ()>, velocity: T) -> T {
        let v = bounded(velocity);
        let ([end_1, end_2], [decay_1, decay_2]) = (self.ends(v), self.decay);
        let [x_1, x_2] = state.continuous;
        let distance = v.abs() * dt;
        if distance > T::ZERO {
            state.continuous = [
                end_1 + (x_1 - end_1) * (-distance * decay_1).exp(),
                end_2 + (x_2 - end_2) * (-distance * decay_2).exp(),
            ];
        }
        x_1 + x_2 + self.parameters.f_v * v
    }

    #[inline]
    fn inject(&self, dt: TimeStep, state: &mut State<[T; 2], ()>, velocity: T, rate: T) -> T {
        let [x_1, x_2] = state.continuous;
        let [decay_1, decay_2] =
            self.decay.map(|decay| relaxed(velocity.abs() * decay, T::of(dt.seconds())));
        let (f_1, f_2) = (self.parameters.f_1, self.parameters.f_2);
        state.continuous =
            [saturate(f_1, x_1 + rate * decay_1), saturate(f_2, x_2 + rate * decay_2)];
        T::ZERO
    }

    fn steady_state(&self, velocity: T) -> T {
        let [end_1, end_2] = self.ends(velocity);
        end_1 + end_2 + self.parameters.f_v * velocity
    }

    /// The deflection that carries the force at the stiffness of rest. Slip once the force has come
    /// within 5 % of the kinetic level.
    fn internals(&self, state: &State<[T; 2], ()>, velocity: T) -> Internals<T> {
        let [x_1, x_2] = state.continuous;
        let force = x_1 + x_2;
        let gamma = self.parameters.f_1 - self.parameters.f_2;
        let regime = if force * sign(velocity) >= T::of(0.95) * gamma {
            Regime::Slip
        } else {
            Regime::Stick
        };
        Internals { deflection: force / self.stiffness(), gamma, regime }
    }

    #[inline]
    fn viscous(&self, velocity: T) -> T {
        self.parameters.f_v * velocity
    }

    fn stored_energy(&self, state: &State<[T; 2], ()>) -> Option<T> {
        let ([x_1, x_2], [fast, beside, slow]) = (state.continuous, self.storage);
        Some(T::HALF * (fast * x_1 * x_1 + T::TWO * beside * x_1 * x_2 + slow * x_2 * x_2))
    }
}

#[cfg(test)]
mod tests;
