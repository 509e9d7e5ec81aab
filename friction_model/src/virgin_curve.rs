//! The virgin curves of the hysteresis: the thesis's sine, and the straight line.

use core::f64::consts::FRAC_PI_2;

use crate::VirginCurve;
#[cfg(not(feature = "std"))]
use num_traits::Float as _;

/// The virgin curve `f_end sin(pi z / (2 z_b))`, flat at its end: loops have area, and no corner
/// where they saturate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sine {
    end: f64,
    z_b: f64,
    /// `pi / (2 z_b)`.
    wave_number: f64,
}

impl Sine {
    /// Rises to `end` [N or N m] at `z_b` [m or rad].
    #[must_use]
    pub const fn new(end: f64, z_b: f64) -> Self {
        Self { end, z_b, wave_number: FRAC_PI_2 / z_b }
    }

    /// Steepest slope, at zero: `end pi / (2 z_b)` [N/m or N m/rad].
    #[inline]
    #[must_use]
    pub const fn stiffness(&self) -> f64 {
        self.end * self.wave_number
    }
}

impl VirginCurve for Sine {
    #[inline]
    fn force(&self, z: f64) -> f64 {
        self.end * (self.wave_number * z).sin()
    }

    /// The factors meet first, while `z` is still awaited.
    #[inline]
    fn stretched(&self, stretch: f64, shrink: f64, z: f64) -> f64 {
        (stretch * self.end) * ((shrink * self.wave_number) * z).sin()
    }

    fn slope(&self, z: f64) -> f64 {
        // The sine ends flat: the cosine's rounding there is not a slope.
        if z.abs() >= self.z_b { 0.0 } else { self.stiffness() * (self.wave_number * z).cos() }
    }

    fn integral(&self, z: f64) -> f64 {
        self.end * (1.0 - (self.wave_number * z).cos()) / self.wave_number
    }

    #[inline]
    fn limit(&self) -> f64 {
        self.z_b
    }
}

/// The virgin curve `end z / z_b`: a spring that saturates. Its doubled branches are the same line,
/// so its loops have no area.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Line {
    slope: f64,
    z_b: f64,
}

impl Line {
    /// Rises to `end` [N or N m] at `z_b` [m or rad].
    #[must_use]
    pub const fn new(end: f64, z_b: f64) -> Self {
        Self { slope: end / z_b, z_b }
    }

    /// The slope [N/m or N m/rad].
    #[inline]
    #[must_use]
    pub const fn stiffness(&self) -> f64 {
        self.slope
    }
}

impl VirginCurve for Line {
    #[inline]
    fn force(&self, z: f64) -> f64 {
        self.slope * z
    }

    #[inline]
    fn stretched(&self, stretch: f64, shrink: f64, z: f64) -> f64 {
        (stretch * shrink * self.slope) * z
    }

    fn slope(&self, _: f64) -> f64 {
        self.slope
    }

    fn integral(&self, z: f64) -> f64 {
        0.5 * self.slope * z * z
    }

    #[inline]
    fn limit(&self) -> f64 {
        self.z_b
    }
}
