//! Exponential, logarithm and sine without a branch or a call, so that the compiler can take
//! several numbers at once whatever the processor's width.
//!
//! Each agrees with the standard library's to 1e-13 over the arguments that a servo's simulation
//! meets.

use std::f64::consts::{LN_2, LOG2_E, PI, SQRT_2};

/// Adding it rounds to a whole number, which then stands in the lowest bits.
const ROUND: f64 = 6_755_399_441_055_744.0;
const MANTISSA: u64 = 0x000f_ffff_ffff_ffff;
/// Powers of two up to this are exact in the high half of ln 2 and of pi.
const LOW_BITS: u64 = !0x07ff_ffff;

/// The larger; the second where one is no number.
#[inline(always)]
pub(super) fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// The smaller; the second where one is no number.
#[inline(always)]
pub(super) fn smaller(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

/// `x` held between the two.
#[inline(always)]
pub(super) fn within(x: f64, low: f64, high: f64) -> f64 {
    larger(smaller(x, high), low)
}

#[inline(always)]
fn horner<const N: usize>(x: f64, from_the_highest: [f64; N]) -> f64 {
    let mut sum = 0.0;
    for coefficient in from_the_highest {
        sum = sum * x + coefficient;
    }
    sum
}

/// e^x for |x| of at most 700.
#[inline(always)]
pub(super) fn exp(x: f64) -> f64 {
    let high = f64::from_bits(LN_2.to_bits() & LOW_BITS);
    let shifted = x * LOG2_E + ROUND;
    let n = shifted - ROUND;
    let r = (x - n * high) - n * (LN_2 - high + 2.319_046_813_846_299_6e-17);
    let series = horner(
        r,
        [
            1.0 / 479_001_600.0,
            1.0 / 39_916_800.0,
            1.0 / 3_628_800.0,
            1.0 / 362_880.0,
            1.0 / 40_320.0,
            1.0 / 5_040.0,
            1.0 / 720.0,
            1.0 / 120.0,
            1.0 / 24.0,
            1.0 / 6.0,
            0.5,
            1.0,
            1.0,
        ],
    );
    let power = f64::from_bits(shifted.to_bits().wrapping_add(1023) << 52);
    series * power
}

/// ln x for a positive number that is not subnormal.
#[inline(always)]
pub(super) fn ln(x: f64) -> f64 {
    let bits = x.to_bits();
    // The exponent as a number: put into the mantissa of 2^52, and that taken off.
    let exponent = f64::from_bits((bits >> 52) | 0x4330_0000_0000_0000) - 4_503_599_627_370_496.0;
    let mantissa = f64::from_bits((bits & MANTISSA) | 0x3ff0_0000_0000_0000);
    let above = mantissa > SQRT_2;
    let m = if above { 0.5 * mantissa } else { mantissa };
    let e = exponent - if above { 1022.0 } else { 1023.0 };
    let f = (m - 1.0) / (m + 1.0);
    let f2 = f * f;
    let series = horner(
        f2,
        [
            2.0 / 17.0,
            2.0 / 15.0,
            2.0 / 13.0,
            2.0 / 11.0,
            2.0 / 9.0,
            2.0 / 7.0,
            2.0 / 5.0,
            2.0 / 3.0,
            2.0,
        ],
    );
    f * series + e * LN_2
}

/// sin x for |x| up to a million turns.
#[inline(always)]
pub(super) fn sin(x: f64) -> f64 {
    let high = f64::from_bits(PI.to_bits() & LOW_BITS);
    let shifted = x * (1.0 / PI) + ROUND;
    let n = shifted - ROUND;
    let r = (x - n * high) - n * (PI - high + 1.224_646_799_147_353_2e-16);
    let r2 = r * r;
    let series = horner(
        r2,
        [
            -1.0 / 121_645_100_408_832_000.0,
            1.0 / 355_687_428_096_000.0,
            -1.0 / 1_307_674_368_000.0,
            1.0 / 6_227_020_800.0,
            -1.0 / 39_916_800.0,
            1.0 / 362_880.0,
            -1.0 / 5_040.0,
            1.0 / 120.0,
            -1.0 / 6.0,
        ],
    );
    let sine = r + r * r2 * series;
    f64::from_bits(sine.to_bits() ^ (shifted.to_bits() << 63))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn they_are_those_of_the_standard_library() {
        for k in -70_000..=70_000 {
            let x = f64::from(k) * 0.01;
            assert!((exp(x) / x.exp() - 1.0).abs() < 1e-13, "exp {x}: {}", exp(x));
            assert!((sin(x) - x.sin()).abs() < 1e-13, "sin {x}: {} {}", sin(x), x.sin());
        }
        for k in -3_000..3_000 {
            let x = (f64::from(k) * 0.1).exp();
            assert!((ln(x) - x.ln()).abs() < 1e-13 * x.ln().abs().max(1.0), "ln {x}: {}", ln(x));
        }
        assert_eq!((ln(1.0), sin(0.0), exp(0.0)), (0.0, 0.0, 1.0));
    }
}
