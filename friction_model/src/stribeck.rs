//! The static Stribeck model: Coulomb, viscous and static friction with the falling characteristic between.
//!
//! ```text
//! F = [F_c + (F_s - F_c) exp(-|v/v_s|^delta)] sgn v + f_v v      v != 0      (thesis eq. 2.11, sgn and |.| restored)
//! F = sat(F_s, F_e)                                              v = 0
//! ```
//!
//! | parameter | unit | range | meaning |
//! |---|---|---|---|
//! | `f_s` | N or N m | >= `f_c` | static friction |
//! | `f_c` | N or N m | > 0 | kinetic friction |
//! | `v_s` | m/s or rad/s | > 0 | Stribeck velocity |
//! | `delta` | - | (0, 10], 2 if left out | shape exponent |
//! | `f_v` | N s/m or N m s/rad | >= 0 | viscous coefficient |
//!
//! It gives the steady sliding characteristic of every dynamic model here and stick-slip where sticking is handled as an
//! event. It has no pre-sliding displacement, no lag and no memory.

use serde::{Deserialize, Serialize};

use crate::model::bounded;
use crate::parameter::Check;
use crate::stribeck_curve::gaussian;
use crate::{
    Evaluation, FrictionModel, Internals, ModelError, ModelName, Regime, State, StribeckCurve, TimeStep,
};

/// Parameters of [`Stribeck`] as files carry them.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StribeckParameters {
    /// Static friction F_s [N or N m], at least `f_c`.
    pub f_s: f64,
    /// Kinetic friction F_c [N or N m], above zero.
    pub f_c: f64,
    /// Stribeck velocity v_s [m/s or rad/s], above zero.
    pub v_s: f64,
    /// Shape exponent, above 0 and at most 10; 2 if left out.
    #[serde(default = "gaussian")]
    pub delta: f64,
    /// Viscous coefficient f_v [N s/m or N m s/rad], zero or more.
    pub f_v: f64,
}

/// The static Stribeck model with valid parameters.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "StribeckParameters", into = "StribeckParameters")]
pub struct Stribeck {
    parameters: StribeckParameters,
    curve: StribeckCurve,
}

impl Stribeck {
    /// The test bed (thesis Table 4.13).
    ///
    /// # Panics
    /// Never: a test builds it.
    #[must_use]
    pub fn test_bed() -> Self {
        StribeckParameters { f_s: 0.0994, f_c: 0.0925, v_s: 0.1407, delta: 2.0, f_v: 0.0403 }
            .try_into()
            .expect("constants within range")
    }

    /// The parameters.
    #[must_use]
    pub const fn parameters(&self) -> &StribeckParameters {
        &self.parameters
    }
}

impl TryFrom<StribeckParameters> for Stribeck {
    type Error = ModelError;

    fn try_from(p: StribeckParameters) -> Result<Self, ModelError> {
        let curve = StribeckCurve::new(ModelName::Stribeck, p.f_s, p.f_c, p.v_s, p.delta)?;
        Check(ModelName::Stribeck).non_negative("f_v", p.f_v, "N m s/rad")?;
        Ok(Self { parameters: p, curve })
    }
}

impl From<Stribeck> for StribeckParameters {
    fn from(model: Stribeck) -> Self {
        model.parameters
    }
}

impl FrictionModel for Stribeck {
    const NAME: ModelName = ModelName::Stribeck;
    type Continuous = [f64; 0];
    type Memory = ();
    type Discrete = ();

    fn rest(&self) -> State<[f64; 0], ()> {
        State { continuous: [], memory: () }
    }

    fn evaluate(&self, _: &[f64; 0], (): &(), velocity: f64) -> Evaluation<[f64; 0]> {
        Evaluation { force: self.steady_state(velocity), rates: [] }
    }

    fn commit(&self, _: &mut State<[f64; 0], ()>) {}

    fn discretise(&self, _: TimeStep) {}

    #[inline]
    fn step(&self, (): &(), _: &mut State<[f64; 0], ()>, velocity: f64) -> f64 {
        self.steady_state(bounded(velocity))
    }

    #[inline]
    fn steady_state(&self, velocity: f64) -> f64 {
        self.curve.signed_level(velocity) + self.parameters.f_v * velocity
    }

    fn internals(&self, _: &State<[f64; 0], ()>, velocity: f64) -> Internals {
        let regime = if velocity == 0.0 { Regime::Stick } else { Regime::Slip };
        Internals { deflection: 0.0, gamma: self.curve.level(velocity), regime }
    }

    fn breakaway(&self) -> Option<f64> {
        Some(self.parameters.f_s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn falls_from_the_static_to_the_kinetic_level_then_rises() {
        let model = Stribeck::test_bed();
        assert!((model.steady_state(1e-12) - 0.0994).abs() < 1e-12);
        let at_v_s = 0.0925 + 0.0069 * (-1.0f64).exp() + 0.0403 * 0.1407;
        assert!((model.steady_state(0.1407) - at_v_s).abs() < 1e-15);
        assert!((model.steady_state(4.0) - (0.0925 + 0.0403 * 4.0)).abs() < 1e-15);
        assert_eq!(model.steady_state(-4.0), -model.steady_state(4.0));
    }
}
