//! A number that carries its derivatives along.
//!
//! A model that computes with such numbers gives, beside its force, the derivatives of the force
//! with respect to up to `N` quantities, exactly and in one run:
//!
//! ```text
//! a + b -> (a + b, a' + b')      a b -> (a b, a' b + a b')      f(a) -> (f(a), f'(a) a')
//! ```
//!
//! (Wengert 1964; dual numbers, Clifford 1873.) Comparisons are by value, so a model takes the same
//! branches as with plain numbers, and the value is the same to the last bit. Where a model has a
//! kink, the derivative is that of the branch taken.

mod functions;
mod operators;
#[cfg(test)]
mod tests;

use core::cmp::Ordering;
use core::fmt;

use crate::real::Sealed;
use crate::{Real, Value};

/// A number with its derivatives with respect to `N` quantities.
///
/// ```
/// use friction_model::{Coulomb, CoulombParameters, Dual, FrictionModel, Real};
///
/// // How does the friction hang on the level?
/// let f_c = Dual::<1>::variable(0.8, 0);
/// let contact = Coulomb::try_from(CoulombParameters { f_c })?;
/// let friction = contact.steady_state(Real::of(-0.1));
/// assert_eq!((friction.value(), friction.slopes()), (-0.8, &[-1.0]));
/// # Ok::<(), friction_model::ModelError>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Dual<const N: usize> {
    value: f64,
    slopes: [f64; N],
}

impl<const N: usize> Dual<N> {
    /// A number that hangs on nothing.
    #[inline(always)]
    #[must_use]
    pub const fn constant(value: f64) -> Self {
        Self { value, slopes: [0.0; N] }
    }

    /// The quantity number `index` itself. With an index of `N` or more it is a constant.
    #[must_use]
    pub fn variable(value: f64, index: usize) -> Self {
        let mut variable = Self::constant(value);
        if let Some(slope) = variable.slopes.get_mut(index) {
            *slope = 1.0;
        }
        variable
    }

    /// The number.
    #[inline]
    #[must_use]
    pub const fn value(&self) -> f64 {
        self.value
    }

    /// Its derivatives.
    #[inline]
    #[must_use]
    pub const fn slopes(&self) -> &[f64; N] {
        &self.slopes
    }

    /// `value`, whose derivative with respect to this number is `slope`.
    #[inline(always)]
    fn chain(self, value: f64, slope: f64) -> Self {
        let mut slopes = self.slopes;
        for own in &mut slopes {
            *own *= slope;
        }
        Self { value, slopes }
    }

    /// `value`, whose derivatives with respect to this number and the other are `by`.
    #[inline(always)]
    fn join(self, other: &Self, value: f64, by: [f64; 2]) -> Self {
        let mut slopes = self.slopes;
        for (own, others) in slopes.iter_mut().zip(&other.slopes) {
            *own = by[0] * *own + by[1] * *others;
        }
        Self { value, slopes }
    }
}

impl<const N: usize> PartialEq for Dual<N> {
    #[inline(always)]
    fn eq(&self, other: &Self) -> bool {
        self.value == other.value
    }
}

impl<const N: usize> PartialOrd for Dual<N> {
    #[inline(always)]
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        self.value.partial_cmp(&other.value)
    }
    #[inline(always)]
    fn lt(&self, other: &Self) -> bool {
        self.value < other.value
    }
    #[inline(always)]
    fn le(&self, other: &Self) -> bool {
        self.value <= other.value
    }
    #[inline(always)]
    fn gt(&self, other: &Self) -> bool {
        self.value > other.value
    }
    #[inline(always)]
    fn ge(&self, other: &Self) -> bool {
        self.value >= other.value
    }
}

impl<const N: usize> Default for Dual<N> {
    #[inline(always)]
    fn default() -> Self {
        Self::constant(0.0)
    }
}

impl<const N: usize> fmt::Display for Dual<N> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.value.fmt(f)
    }
}

impl<const N: usize> Sealed for Dual<N> {}

impl<const N: usize> Real for Dual<N> {
    const ZERO: Self = Self::constant(0.0);
    const HALF: Self = Self::constant(0.5);
    const ONE: Self = Self::constant(1.0);
    const TWO: Self = Self::constant(2.0);

    #[inline(always)]
    fn of(x: f64) -> Self {
        Self::constant(x)
    }

    #[inline(always)]
    fn double(self) -> f64 {
        self.value
    }
}

impl<const N: usize> Value for Dual<N> {
    fn each(&self, f: &mut dyn FnMut(f64)) {
        f(self.value);
    }
    fn scale(&mut self, factor: f64) {
        *self = self.chain(self.value * factor, factor);
    }
    fn set(&mut self, value: f64) -> bool {
        *self = Self::constant(value);
        true
    }
}

/// In files, the value.
#[cfg(feature = "serde")]
mod in_files {
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    use super::Dual;

    impl<const N: usize> Serialize for Dual<N> {
        fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
            serializer.serialize_f64(self.value)
        }
    }

    impl<'de, const N: usize> Deserialize<'de> for Dual<N> {
        fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
            f64::deserialize(deserializer).map(Self::constant)
        }
    }
}
