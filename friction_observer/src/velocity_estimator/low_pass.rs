//! A low-pass filter of first order, `1 / (T s + 1)`.
//!
//! Exact for inputs that are held over the period: `y <- y + (1 - exp(-dt/T)) (x - y)`. White noise
//! leaves with `sqrt((1 - p)/(1 + p))` of its standard deviation, `p = exp(-dt/T)`; a ramp is
//! followed `T` behind.

use friction_model::TimeStep;

/// A low-pass filter running at a fixed period. It starts at its first input.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LowPass {
    share: f64,
    output: Option<f64>,
}

impl LowPass {
    /// A filter with `time_constant` \[s\], zero for none, called once every `dt`.
    #[must_use]
    pub fn new(time_constant: f64, dt: TimeStep) -> Self {
        Self { share: -(-dt.seconds() / time_constant).exp_m1(), output: None }
    }

    /// Takes `input` in; the output now. The input must be finite.
    #[inline]
    pub fn step(&mut self, input: f64) -> f64 {
        let before = self.output.unwrap_or(input);
        let output = before + self.share * (input - before);
        self.output = Some(output);
        output
    }

    /// The same filter with its output at zero.
    #[must_use]
    pub const fn at_zero(self) -> Self {
        Self { output: Some(0.0), ..self }
    }

    /// The output; `None` before the first input.
    #[must_use]
    pub const fn output(&self) -> Option<f64> {
        self.output
    }

    /// Forgets everything.
    pub fn reset(&mut self) {
        self.output = None;
    }
}
