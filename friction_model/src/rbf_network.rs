//! A network of radial basis functions: the friction-speed curve as a sum of bells.
//!
//! ```text
//! F = sgn(v) max(0, w_0 + sum_i w_i exp(-(|v| - c_i)^2 / (2 b_i^2)))    v != 0
//! F = sat(F(0+), F_e)                                                   v = 0
//! ```
//!
//! Thesis section 2.3.1 (neural networks), without an equation. With centres and widths given, the
//! force is linear in the weights, so that training is a linear least squares problem.
//!
//! | parameter | unit | range | meaning |
//! |---|---|---|---|
//! | `w0` | N or N m | >= 0 | level far from all centres |
//! | `weights` | N or N m | any | heights `w_i` of the bells |
//! | `centres` | m/s or rad/s | >= 0 | speeds `c_i` of the bells |
//! | `widths` | m/s or rad/s | > 0 | widths `b_i` of the bells |
//!
//! One to 32 bells. The level at standstill must be above zero. Between the centres a sum of bells
//! may dip below zero, where the friction would push: the model is cut to zero there.
//!
//! It reproduces any smooth curve between the speeds it was trained with, including those that no
//! Stribeck curve fits. **Beyond the last centre it falls back to `w0`**, within three widths or
//! so, whatever the friction does there: a network trained on viscous friction up to 4 rad/s knows
//! nothing of 10 rad/s. Below the slowest training speed it extrapolates too, and the level at
//! which it holds, `F(0+)`, is such an extrapolation unless breakaway was among the training
//! points. Its parameters have no physical meaning. It has no pre-sliding displacement, no lag and
//! no memory.
//!
//! Use it to compensate friction whose curve was measured densely over all the speeds that will
//! occur. Training is in the `friction_ident` crate.
//!
//! Fixed-step form: the formula itself, with 0 at `v = 0`, where the applied force would have to be
//! known (see [`FrictionModel::holding`]).

use crate::arithmetic::sign;
use crate::finite::finite;
use crate::{
    Elements, FrictionModel, Holding, Internals, ModelError, ParameterSet, Range, Real, Regime,
    State, built_from, memoryless, parameters,
};

/// Most bells that a network can have.
const CAPACITY: usize = 32;

parameters! {
    /// Parameters of [`RbfNetwork`] as files carry them: three lists of the same length.
    RbfNetworkParameters<T> {
        /// Level w_0 far from all centres \[N or N m\], zero or more.
        w0: T, Force, Range::NonNegative;
        /// Heights w_i of the bells \[N or N m\], of any sign.
        weights: Elements<32, T>, Force, Range::Any;
        /// Speeds c_i on which the bells are centred \[m/s or rad/s\], zero or more.
        centres: Elements<32, T>, Speed, Range::NonNegative;
        /// Widths b_i of the bells \[m/s or rad/s\], above zero.
        widths: Elements<32, T>, Speed, Range::Positive;
    }
}

/// A network of radial basis functions with valid parameters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RbfNetwork<T: Real = f64> {
    parameters: RbfNetworkParameters<T>,
    /// `1 / b_i`.
    inverse_widths: Elements<32, T>,
}

impl<T: Real> RbfNetwork<T> {
    /// `w_0` and the bells at a speed, before negative levels are cut.
    #[inline]
    fn sum(&self, speed: T) -> T {
        let p = &self.parameters;
        let bells = p.weights.iter().zip(p.centres.iter()).zip(self.inverse_widths.iter());
        bells.fold(p.w0, |sum, ((&weight, &centre), &inverse_width)| {
            let r = (speed - centre) * inverse_width;
            sum + weight * (-T::HALF * r * r).exp()
        })
    }

    /// The friction of a contact that slides at a speed of this magnitude, zero or more; at zero
    /// speed `F(0+)`.
    #[inline]
    fn level(&self, velocity: T) -> T {
        let sum = self.sum(velocity.abs());
        if sum > T::ZERO { sum } else { T::ZERO }
    }
}

impl<T: Real> TryFrom<RbfNetworkParameters<T>> for RbfNetwork<T> {
    type Error = ModelError;

    fn try_from(p: RbfNetworkParameters<T>) -> Result<Self, ModelError> {
        let model = Self::NAME;
        let expected = p.weights.len();
        if !(1..=CAPACITY).contains(&expected) {
            let (given, expected) = (expected, expected.clamp(1, CAPACITY));
            return Err(ModelError::Elements { model, parameter: "weights", given, expected });
        }
        for (parameter, list) in [("centres", &p.centres), ("widths", &p.widths)] {
            if list.len() != expected {
                return Err(ModelError::Elements { model, parameter, given: list.len(), expected });
            }
        }
        p.check(model)?;
        let largest = p.weights.iter().fold(p.w0, |sum, weight| sum + weight.abs());
        let summable = "small enough for a finite sum of all weights";
        p.require(model, largest.is_finite(), "weights", largest, summable)?;
        let inverse_widths = Elements::from_fn(expected, |i| {
            p.widths.get(i).map_or(T::ZERO, |&width| T::ONE / width)
        });
        for (width, inverse) in p.widths.iter().zip(inverse_widths.iter()) {
            let divisor = "large enough to divide by";
            p.require(model, inverse.is_finite(), "widths", *width, divisor)?;
        }
        let network = Self { parameters: p, inverse_widths };
        let still = network.sum(T::ZERO);
        let positive = "such that the level at standstill is above zero";
        p.require(model, still > T::ZERO, "weights", still, positive)?;
        finite(network)
    }
}

built_from!([T: Real] RbfNetwork<T>, RbfNetworkParameters<T>);

impl<T: Real> FrictionModel<T> for RbfNetwork<T> {
    const NAME: &'static str = "rbf_network";
    memoryless!([T] RbfNetworkParameters<T>);

    #[inline]
    fn steady_state(&self, velocity: T) -> T {
        sign(velocity) * self.level(velocity)
    }

    fn internals(&self, _: &State<[T; 0], ()>, velocity: T) -> Internals<T> {
        let regime = if velocity == T::ZERO { Regime::Stick } else { Regime::Slip };
        Internals { deflection: T::ZERO, gamma: self.level(velocity), regime }
    }

    fn holding(&self, _: T) -> Option<Holding<T>> {
        Some(Holding::up_to(self.level(T::ZERO)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{MAX_SPEED, Stribeck};

    fn network(
        w0: f64,
        weights: &[f64],
        centres: &[f64],
        widths: &[f64],
    ) -> Result<RbfNetwork, ModelError> {
        let list = |numbers| Elements::from_slice(numbers).unwrap();
        let (weights, centres, widths) = (list(weights), list(centres), list(widths));
        RbfNetworkParameters { w0, weights, centres, widths }.try_into()
    }

    #[test]
    fn is_a_sum_of_bells() {
        let model = network(0.3, &[0.5, -0.1], &[0.0, 2.0], &[1.0, 0.5]).unwrap();
        for v in [0.01, 0.7, 1.9, 2.0, 5.0] {
            let expected =
                0.3 + 0.5 * f64::exp(-v * v / 2.0) - 0.1 * f64::exp(-(v - 2.0) * (v - 2.0) / 0.5);
            assert!((model.steady_state(v) - expected).abs() < 1e-15, "{v}");
            assert_eq!(model.steady_state(-v), -model.steady_state(v));
        }
        let still = 0.8 - 0.1 * f64::exp(-8.0);
        assert!((model.holding(0.0).unwrap().forward - still).abs() < 1e-15);
        assert_eq!(model.steady_state(0.0), 0.0);
    }

    /// Root mean square of the difference between two curves at the speeds.
    fn rms(a: &RbfNetwork, b: &Stribeck, speeds: impl Iterator<Item = f64>) -> f64 {
        let (mut sum, mut count) = (0.0, 0.0);
        for v in speeds {
            sum += (a.steady_state(v) - b.steady_state(v)).powi(2);
            count += 1.0;
        }
        f64::sqrt(sum / count)
    }

    #[test]
    fn the_presets_lie_on_the_stribeck_curves_and_fall_back_beyond_their_speeds() {
        let model = RbfNetwork::test_bed();
        let slow = (0..30).map(|i| 0.03 + 0.47 * f64::from(i) / 29.0);
        let fast = (0..50).map(|i| 0.55 + 3.45 * f64::from(i) / 49.0);
        let error =
            rms(&model, &Stribeck::test_bed(), core::iter::once(1e-9).chain(slow).chain(fast));
        assert!((error - 7.32e-4).abs() < 1e-6, "{error}");
        assert!((model.holding(0.0).unwrap().forward - 0.1016).abs() < 1e-5);
        // At 12 rad/s the friction is 0.576 N m; the network says what it says at infinity.
        assert!((model.steady_state(12.0) - model.parameters().w0).abs() < 1e-6);

        let model = RbfNetwork::chapter_3();
        let speeds = (0..=100).map(|i| f64::max(1e-9, 1e-3 * f64::from(i)));
        let error = rms(&model, &Stribeck::chapter_3(), speeds);
        assert!((error - 6.77e-4).abs() < 1e-6, "{error}");
        let between = (0..4000).map(|i| 2.5e-5 * (f64::from(i) + 0.5));
        assert!(rms(&model, &Stribeck::chapter_3(), between) < 1.5e-3);
        assert!((model.holding(0.0).unwrap().forward - 1.49824).abs() < 1e-5);
        assert!((model.steady_state(1.0) - 1.0).abs() < 1e-5);
    }

    #[test]
    fn never_pushes_and_stays_finite() {
        let model = network(0.1, &[-0.5, 0.2], &[2.0, 0.0], &[0.5, 0.3]).unwrap();
        assert!(model.sum(2.0) < -0.3);
        assert_eq!((model.steady_state(2.0), model.steady_state(-2.0)), (0.0, 0.0));
        for v in [f64::MIN_POSITIVE, 1e-3, 1.0, 3.0, MAX_SPEED, f64::INFINITY] {
            assert!(model.steady_state(v) >= 0.0 && model.steady_state(v).is_finite(), "{v}");
        }
    }

    #[test]
    fn lists_of_different_lengths_and_impossible_numbers_are_refused() {
        let elements = |outcome: Result<RbfNetwork, ModelError>| match outcome {
            Err(ModelError::Elements { parameter, given, expected, .. }) => {
                (parameter, given, expected)
            }
            other => panic!("{other:?}"),
        };
        assert_eq!(elements(network(1.0, &[1.0, 1.0], &[0.0], &[1.0, 1.0])), ("centres", 1, 2));
        assert_eq!(elements(network(1.0, &[1.0], &[0.0], &[1.0, 1.0])), ("widths", 2, 1));
        assert_eq!(elements(network(1.0, &[], &[], &[])), ("weights", 0, 1));
        for (w0, weight, centre, width, parameter) in [
            (-0.1, 1.0, 0.0, 1.0, "w0"),
            (1.0, f64::NAN, 0.0, 1.0, "weights"),
            (1.0, -1.0, 0.0, 1.0, "weights"),
            (1e308, 1.0, 0.0, 1.0, "w0"),
            (1.0, 1.0, -1.0, 1.0, "centres"),
            (1.0, 1.0, 0.0, 0.0, "widths"),
            (1.0, 1.0, 0.0, 1e-310, "widths"),
        ] {
            let message = network(w0, &[weight], &[centre], &[width]).unwrap_err().to_string();
            assert!(message.starts_with(&format!("rbf_network.{parameter} must be")), "{message}");
        }
        assert!(network(1.0, &[0.01; 32], &[1.0; 32], &[1.0; 32]).is_ok());
        let text = format!(
            r#"{{"w0":1,"weights":{list},"centres":{list},"widths":{list}}}"#,
            list = format!("[{}1]", "1,".repeat(32))
        );
        let message = serde_json::from_str::<RbfNetwork>(&text).unwrap_err().to_string();
        assert!(message.contains("at most 32 numbers"), "{message}");
    }
}
