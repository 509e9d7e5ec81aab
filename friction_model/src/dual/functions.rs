//! The functions of floating-point numbers, each with its derivative.

use core::num::FpCategory;

use num_traits::Float;

use super::Dual;

/// Functions of one number, each with its derivative there.
macro_rules! functions {
    ($($name:ident($x:ident) $slope:expr;)+) => {
        $(
            #[inline(always)]
            fn $name(self) -> Self {
                let $x = self.value;
                self.chain(Float::$name($x), $slope)
            }
        )+
    };
}

/// Numbers that hang on nothing.
macro_rules! constants {
    ($($name:ident)+) => {
        $(
            #[inline]
            fn $name() -> Self {
                Self::constant(<f64 as Float>::$name())
            }
        )+
    };
}

/// Questions about the value.
macro_rules! questions {
    ($($name:ident -> $answer:ty;)+) => {
        $(
            #[inline(always)]
            fn $name(self) -> $answer {
                Float::$name(self.value)
            }
        )+
    };
}

impl<const N: usize> Float for Dual<N> {
    constants! {
        nan infinity neg_infinity neg_zero min_value min_positive_value epsilon max_value
    }

    questions! {
        is_nan -> bool;
        is_infinite -> bool;
        is_finite -> bool;
        is_normal -> bool;
        is_subnormal -> bool;
        is_sign_positive -> bool;
        is_sign_negative -> bool;
        classify -> FpCategory;
        integer_decode -> (u64, i16, i8);
    }

    functions! {
        floor(_x) 0.0;
        ceil(_x) 0.0;
        round(_x) 0.0;
        trunc(_x) 0.0;
        signum(_x) 0.0;
        fract(_x) 1.0;
        abs(x) x.signum();
        recip(x) -1.0 / (x * x);
        // At zero, where it is infinite, the number counts as constant.
        sqrt(x) if x == 0.0 { 0.0 } else { 0.5 / Float::sqrt(x) };
        cbrt(x) if x == 0.0 { 0.0 } else { 1.0 / (3.0 * Float::cbrt(x) * Float::cbrt(x)) };
        exp2(x) core::f64::consts::LN_2 * Float::exp2(x);
        exp_m1(x) Float::exp(x);
        ln(x) 1.0 / x;
        ln_1p(x) 1.0 / (1.0 + x);
        log2(x) core::f64::consts::LOG2_E / x;
        log10(x) core::f64::consts::LOG10_E / x;
        to_degrees(_x) 1f64.to_degrees();
        to_radians(_x) 1f64.to_radians();
        sin(x) Float::cos(x);
        cos(x) -Float::sin(x);
        tan(x) 1.0 + Float::tan(x) * Float::tan(x);
        asin(x) 1.0 / Float::sqrt(1.0 - x * x);
        acos(x) -1.0 / Float::sqrt(1.0 - x * x);
        atan(x) 1.0 / (1.0 + x * x);
        sinh(x) Float::cosh(x);
        cosh(x) Float::sinh(x);
        tanh(x) 1.0 - Float::tanh(x) * Float::tanh(x);
        asinh(x) 1.0 / Float::sqrt(1.0 + x * x);
        acosh(x) 1.0 / Float::sqrt(x * x - 1.0);
        atanh(x) 1.0 / (1.0 - x * x);
    }

    #[inline(always)]
    fn exp(self) -> Self {
        let value = Float::exp(self.value);
        self.chain(value, value)
    }

    #[inline]
    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = Float::sin_cos(self.value);
        (self.chain(sin, cos), self.chain(cos, -sin))
    }

    #[inline]
    fn mul_add(self, a: Self, b: Self) -> Self {
        let product = self * a + b;
        Self { value: Float::mul_add(self.value, a.value, b.value), ..product }
    }

    #[inline]
    fn powi(self, n: i32) -> Self {
        let slope = if n == 0 { 0.0 } else { f64::from(n) * Float::powi(self.value, n - 1) };
        self.chain(Float::powi(self.value, n), slope)
    }

    /// A base of zero counts as constant where the power's slope there is infinite, and so does the
    /// exponent of a base that is not above zero. Never inlined: compilers take the plain power for
    /// so cheap that they compute it before they know whether it is needed.
    #[inline(never)]
    fn powf(self, n: Self) -> Self {
        let (x, power) = (self.value, Float::powf(self.value, n.value));
        let by = if x == 0.0 {
            [f64::from(u8::from(n.value == 1.0)), 0.0]
        } else {
            let growth = if x > 0.0 { Float::ln(x) } else { 0.0 };
            [n.value * power / x, power * growth]
        };
        self.join(&n, power, by)
    }

    fn log(self, base: Self) -> Self {
        self.ln() / base.ln()
    }

    #[inline]
    fn max(self, other: Self) -> Self {
        if self.value >= other.value || other.value.is_nan() { self } else { other }
    }

    #[inline]
    fn min(self, other: Self) -> Self {
        if self.value <= other.value || other.value.is_nan() { self } else { other }
    }

    fn abs_sub(self, other: Self) -> Self {
        if self.value <= other.value { Self::constant(0.0) } else { self - other }
    }

    fn hypot(self, other: Self) -> Self {
        let value = Float::hypot(self.value, other.value);
        let divisor = if value == 0.0 { 1.0 } else { value };
        self.join(&other, value, [self.value / divisor, other.value / divisor])
    }

    fn atan2(self, other: Self) -> Self {
        let square = self.value * self.value + other.value * other.value;
        let by = [other.value / square, -self.value / square];
        self.join(&other, Float::atan2(self.value, other.value), by)
    }

    #[inline]
    fn copysign(self, sign: Self) -> Self {
        let turned = self.value.is_sign_negative() != sign.value.is_sign_negative();
        if turned { -self } else { self }
    }
}
