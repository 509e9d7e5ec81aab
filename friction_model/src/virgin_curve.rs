//! The virgin curves of the hysteresis: the thesis's sine, and the straight line.

use core::f64::consts::FRAC_PI_2;

use crate::Real;
use crate::VirginCurve;

/// The virgin curve `f_end sin(pi z / (2 z_b))`, flat at its end: loops have area, and no corner
/// where they saturate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sine<T: Real = f64> {
    end: T,
    z_b: T,
    /// `pi / (2 z_b)`.
    wave_number: T,
}

impl<T: Real> Sine<T> {
    /// Rises to `end` \[N or N m\] at `z_b` \[m or rad\].
    #[must_use]
    pub fn new(end: T, z_b: T) -> Self {
        Self { end, z_b, wave_number: T::of(FRAC_PI_2) / z_b }
    }

    /// Steepest slope, at zero: `end pi / (2 z_b)` \[N/m or N m/rad\].
    #[inline]
    #[must_use]
    pub fn stiffness(&self) -> T {
        self.end * self.wave_number
    }
}

impl<T: Real> VirginCurve<T> for Sine<T> {
    #[inline]
    fn force(&self, z: T) -> T {
        self.end * (self.wave_number * z).sin()
    }

    /// The factors meet first, while `z` is still awaited.
    #[inline(always)]
    fn stretched(&self, stretch: T, shrink: T, z: T) -> T {
        (stretch * self.end) * ((shrink * self.wave_number) * z).sin()
    }

    fn slope(&self, z: T) -> T {
        // The sine ends flat: the cosine's rounding there is not a slope.
        if z.abs() >= self.z_b { T::ZERO } else { self.stiffness() * (self.wave_number * z).cos() }
    }

    fn integral(&self, z: T) -> T {
        self.end * (T::ONE - (self.wave_number * z).cos()) / self.wave_number
    }

    #[inline]
    fn limit(&self) -> T {
        self.z_b
    }
}

/// The virgin curve `end z / z_b`: a spring that saturates. Its doubled branches are the same line,
/// so its loops have no area.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Line<T: Real = f64> {
    slope: T,
    z_b: T,
}

impl<T: Real> Line<T> {
    /// Rises to `end` \[N or N m\] at `z_b` \[m or rad\].
    #[must_use]
    pub fn new(end: T, z_b: T) -> Self {
        Self { slope: end / z_b, z_b }
    }

    /// The slope \[N/m or N m/rad\].
    #[inline]
    #[must_use]
    pub fn stiffness(&self) -> T {
        self.slope
    }
}

impl<T: Real> VirginCurve<T> for Line<T> {
    #[inline]
    fn force(&self, z: T) -> T {
        self.slope * z
    }

    #[inline]
    fn stretched(&self, stretch: T, shrink: T, z: T) -> T {
        (stretch * shrink * self.slope) * z
    }

    fn slope(&self, _: T) -> T {
        self.slope
    }

    fn integral(&self, z: T) -> T {
        T::HALF * self.slope * z * z
    }

    #[inline]
    fn limit(&self) -> T {
        self.z_b
    }
}
