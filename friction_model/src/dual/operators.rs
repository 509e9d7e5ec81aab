//! The four operations, and what else makes a number of them.

use core::iter::Sum;
use core::ops::{
    Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Rem, RemAssign, Sub, SubAssign,
};

use num_traits::{Num, NumCast, One, ToPrimitive, Zero};

use super::Dual;

impl<const N: usize> Add for Dual<N> {
    type Output = Self;
    #[inline(always)]
    fn add(mut self, other: Self) -> Self {
        self.value += other.value;
        for (own, others) in self.slopes.iter_mut().zip(&other.slopes) {
            *own += others;
        }
        self
    }
}

impl<const N: usize> Sub for Dual<N> {
    type Output = Self;
    #[inline(always)]
    fn sub(mut self, other: Self) -> Self {
        self.value -= other.value;
        for (own, others) in self.slopes.iter_mut().zip(&other.slopes) {
            *own -= others;
        }
        self
    }
}

impl<const N: usize> Mul for Dual<N> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.join(&other, self.value * other.value, [other.value, self.value])
    }
}

impl<const N: usize> Div for Dual<N> {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        let (value, inverse) = (self.value / other.value, 1.0 / other.value);
        self.join(&other, value, [inverse, -value * inverse])
    }
}

/// `a - b trunc(a / b)`: the whole number does not change with either.
impl<const N: usize> Rem for Dual<N> {
    type Output = Self;
    fn rem(self, other: Self) -> Self {
        let whole = num_traits::Float::trunc(self.value / other.value);
        self.join(&other, self.value % other.value, [1.0, -whole])
    }
}

impl<const N: usize> Neg for Dual<N> {
    type Output = Self;
    #[inline(always)]
    fn neg(mut self) -> Self {
        self.value = -self.value;
        for slope in &mut self.slopes {
            *slope = -*slope;
        }
        self
    }
}

macro_rules! assigning {
    ($($assigning:ident $method:ident $operation:ident;)+) => {
        $(
            impl<const N: usize> $assigning for Dual<N> {
                #[inline(always)]
                fn $method(&mut self, other: Self) {
                    *self = self.$operation(other);
                }
            }
        )+
    };
}

assigning! {
    AddAssign add_assign add;
    SubAssign sub_assign sub;
    MulAssign mul_assign mul;
    DivAssign div_assign div;
    RemAssign rem_assign rem;
}

impl<const N: usize> Sum for Dual<N> {
    /// From -0, as for plain numbers.
    #[inline]
    fn sum<I: Iterator<Item = Self>>(numbers: I) -> Self {
        numbers.fold(Self::constant(-0.0), Add::add)
    }
}

impl<const N: usize> Zero for Dual<N> {
    fn zero() -> Self {
        Self::constant(0.0)
    }
    fn is_zero(&self) -> bool {
        self.value == 0.0
    }
}

impl<const N: usize> One for Dual<N> {
    fn one() -> Self {
        Self::constant(1.0)
    }
}

impl<const N: usize> Num for Dual<N> {
    type FromStrRadixErr = <f64 as Num>::FromStrRadixErr;

    fn from_str_radix(text: &str, radix: u32) -> Result<Self, Self::FromStrRadixErr> {
        f64::from_str_radix(text, radix).map(Self::constant)
    }
}

impl<const N: usize> ToPrimitive for Dual<N> {
    fn to_i64(&self) -> Option<i64> {
        self.value.to_i64()
    }
    fn to_u64(&self) -> Option<u64> {
        self.value.to_u64()
    }
    fn to_f64(&self) -> Option<f64> {
        Some(self.value)
    }
}

impl<const N: usize> NumCast for Dual<N> {
    fn from<T: ToPrimitive>(number: T) -> Option<Self> {
        number.to_f64().map(Self::constant)
    }
}
