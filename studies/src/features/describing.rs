//! The describing function of any model, over amplitudes.

use friction_features::describing_function::{Sampling, Scheme, measure};
use friction_model::{AnyModel, FrictionModel, ModelVisitor};
use serde::Serialize;

/// `N(A) = (b1 + j a1) / A` at one frequency.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Describing {
    /// Angular frequency [rad/s].
    pub angular_frequency: f64,
    /// Amplitudes of the displacement \[m\].
    pub amplitude: Vec<f64>,
    /// Real part of N [N/m].
    pub re: Vec<f64>,
    /// Imaginary part of N [N/m]; above zero where the contact dissipates.
    pub im: Vec<f64>,
}

/// Amplitudes from 10 um to 10 cm, five a decade.
const AMPLITUDES: [f64; 2] = [1e-5, 0.1];
const POINTS: u32 = 21;
/// Slow enough for the damping of the bristles not to matter.
const FREQUENCY: f64 = 0.5;

/// Measures the describing function of `model`.
pub(super) fn describe(model: &AnyModel) -> Describing {
    model.visit(Measure)
}

struct Measure;

impl ModelVisitor for Measure {
    type Output = Describing;

    fn visit<M: FrictionModel>(self, model: M) -> Describing {
        let [from, to] = AMPLITUDES;
        let sampling = Sampling { steps: 4000, settling: 2, scheme: Scheme::FixedStep };
        let mut found = Describing {
            angular_frequency: FREQUENCY,
            amplitude: Vec::new(),
            re: Vec::new(),
            im: Vec::new(),
        };
        for k in 0..POINTS {
            let amplitude = from * (to / from).powf(f64::from(k) / f64::from(POINTS - 1));
            // Amplitude and frequency are positive constants: there is nothing to refuse.
            let Ok(harmonic) = measure(&model, amplitude, FREQUENCY, &sampling) else { continue };
            let gain = harmonic.gain();
            found.amplitude.push(amplitude);
            found.re.push(gain.re);
            found.im.push(gain.im);
        }
        found
    }
}
