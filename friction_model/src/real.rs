//! The floating-point numbers that models compute with.

use core::fmt::{Debug, Display};
use core::iter::Sum;

use num_traits::{Float, NumAssign};

use crate::Value;

/// `f64` or `f32`, or a number with its derivatives ([`Dual`](crate::Dual)). Models, parameters and
/// steppers are of `f64` where nothing else is said.
///
/// With `f32` a model carries about seven digits, which is more than a sensor does, and is several
/// times faster on a microcontroller that computes single precision only. Periods
/// ([`TimeStep`](crate::TimeStep)), ranges and errors are told in `f64` throughout.
///
/// ```
/// use friction_model::{LuGre, LuGreParameters, Stepper, TimeStep, presets::Presets};
///
/// let single: LuGreParameters<f32> = LuGreParameters::test_bed().cast();
/// let mut friction = Stepper::new(LuGre::try_from(single)?, TimeStep::new(1e-3)?);
/// let torque: f32 = friction.step(0.5);
/// # assert!(torque.is_finite());
/// # Ok::<(), friction_model::ModelError>(())
/// ```
pub trait Real:
    Float
    + NumAssign
    + Sum
    + Default
    + Debug
    + Display
    + Value
    + InFiles
    + Send
    + Sync
    + Sealed
    + 'static
{
    /// 0
    const ZERO: Self;
    /// 1/2
    const HALF: Self;
    /// 1
    const ONE: Self;
    /// 2
    const TWO: Self;

    /// The number nearest to `x`.
    fn of(x: f64) -> Self;

    /// The same number in double precision.
    fn double(self) -> f64;
}

macro_rules! real {
    ($($number:ty),+) => {
        $(
            impl Real for $number {
                const ZERO: Self = 0.0;
                const HALF: Self = 0.5;
                const ONE: Self = 1.0;
                const TWO: Self = 2.0;

                #[inline]
                fn of(x: f64) -> Self {
                    x as Self
                }

                #[inline]
                fn double(self) -> f64 {
                    self.into()
                }
            }

            impl Sealed for $number {}
        )+
    };
}

real!(f32, f64);

impl<T: Real> Value for Option<T> {
    fn each(&self, f: &mut dyn FnMut(f64)) {
        if let Some(value) = self {
            f(value.double());
        }
    }
    fn scale(&mut self, factor: f64) {
        if let Some(value) = self {
            value.scale(factor);
        }
    }
    fn set(&mut self, value: f64) -> bool {
        *self = Some(T::of(value));
        true
    }
}

/// Keeps [`Real`] to the numbers of this crate.
pub trait Sealed {}

/// What can be read from files and written to them.
#[cfg(feature = "serde")]
pub trait InFiles: serde::Serialize + serde::de::DeserializeOwned {}

#[cfg(feature = "serde")]
impl<T: serde::Serialize + serde::de::DeserializeOwned> InFiles for T {}

/// Files are not asked for.
#[cfg(not(feature = "serde"))]
pub trait InFiles {}

#[cfg(not(feature = "serde"))]
impl<T> InFiles for T {}

/// The same quantity in numbers of another kind.
pub trait Translate<From, To> {
    /// What it becomes.
    type Into;

    /// Each number becomes what `number` makes of it; it is given the place among the quantity's
    /// numbers, zero for one that is no list. Whole numbers stay.
    fn translate(self, number: &mut dyn FnMut(usize, From) -> To) -> Self::Into;
}

impl<T: Real, U: Real> Translate<T, U> for T {
    type Into = U;
    fn translate(self, number: &mut dyn FnMut(usize, T) -> U) -> U {
        number(0, self)
    }
}

impl<T: Real, U: Real> Translate<T, U> for Option<T> {
    type Into = Option<U>;
    fn translate(self, number: &mut dyn FnMut(usize, T) -> U) -> Option<U> {
        self.map(|value| number(0, value))
    }
}

impl<T: Real, U: Real> Translate<T, U> for u32 {
    type Into = Self;
    fn translate(self, _: &mut dyn FnMut(usize, T) -> U) -> Self {
        self
    }
}
