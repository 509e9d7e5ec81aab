//! Powers of two, logarithm and sine without a branch or a call, so that the compiler can take
//! several numbers at once whatever the processor's width.
//!
//! Each agrees with the standard library's to 1e-13 over the arguments that a servo's simulation
//! meets. The coefficients are those of interpolation at Chebyshev's points, which spreads the
//! error evenly over the interval. `FUSED` rounds a product and a sum once, where the processor has
//! an instruction for that.

use std::f64::consts::PI;

/// Adding it rounds to a whole number, which then stands in the lowest bits.
const ROUND: f64 = 6_755_399_441_055_744.0;
const MANTISSA: u64 = 0x000f_ffff_ffff_ffff;
/// The bits of the root of a half.
const ROOT_HALF: u64 = 0x3fe6_a09e_667f_3bcd;
/// The bits of one.
const ONE: u64 = 0x3ff0_0000_0000_0000;

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

/// a b + c.
#[inline(always)]
pub(super) fn mul_add<const FUSED: bool>(a: f64, b: f64, c: f64) -> f64 {
    if FUSED { a.mul_add(b, c) } else { a * b + c }
}

/// A polynomial. Its coefficients of even and of odd powers run side by side, which halves the wait
/// for the last.
#[inline(always)]
fn polynomial<const FUSED: bool, const N: usize>(x: f64, from_the_lowest: [f64; N]) -> f64 {
    let x2 = x * x;
    let mut sums = [0.0; 2];
    for power in (0..N).rev() {
        let sum = &mut sums[power % 2];
        *sum = if power + 2 >= N {
            from_the_lowest[power]
        } else {
            mul_add::<FUSED>(*sum, x2, from_the_lowest[power])
        };
    }
    mul_add::<FUSED>(sums[1], x, sums[0])
}

/// 2^x for |x| of at most 1000.
#[inline(always)]
pub(super) fn exp2<const FUSED: bool>(x: f64) -> f64 {
    let shifted = x + ROUND;
    let r = x - (shifted - ROUND);
    // To 1.4e-14 for |r| of at most a half.
    let series = polynomial::<FUSED, 10>(
        r,
        [
            1.000_000_000_000_013_5,
            0.693_147_180_559_946_2,
            0.240_226_506_956_403_4,
            0.055_504_108_664_651_67,
            0.009_618_129_193_934_313,
            0.001_333_355_820_079_459_2,
            0.000_154_034_337_512_510_1,
            1.525_267_292_485_073_7e-5,
            1.325_964_524_488_711e-6,
            1.020_590_541_376_559_5e-7,
        ],
    );
    // The whole number goes into the exponent.
    f64::from_bits(series.to_bits().wrapping_add(shifted.to_bits() << 52))
}

/// The logarithm to base 2 of a positive number that is not subnormal; of zero some -1023.
#[inline(always)]
pub(super) fn log2<const FUSED: bool>(x: f64) -> f64 {
    // The mantissa m is brought between the root of a half and the root of two.
    let moved = x.to_bits().wrapping_add(ONE - ROOT_HALF);
    let m = f64::from_bits((moved & MANTISSA) + ROOT_HALF);
    // The exponent as a number: put into the mantissa of 2^52, and that and the bias taken off.
    let e = f64::from_bits((moved >> 52) | 0x4330_0000_0000_0000) - 4_503_599_627_371_519.0;
    let f = (m - 1.0) / (m + 1.0);
    // The logarithm of (1 + f) / (1 - f) over f, to 8e-14.
    let series = polynomial::<FUSED, 6>(
        f * f,
        [
            2.885_390_081_777_851,
            0.961_796_694_112_264_9,
            0.577_077_942_660_304_4,
            0.412_209_224_061_104_33,
            0.319_906_803_807_013_36,
            0.282_885_023_407_482_34,
        ],
    );
    mul_add::<FUSED>(f, series, e)
}

/// sin x for |x| up to some hundred turns.
#[inline(always)]
pub(super) fn sin<const FUSED: bool>(x: f64) -> f64 {
    let shifted = mul_add::<FUSED>(x, 1.0 / PI, ROUND);
    let n = shifted - ROUND;
    let r = if FUSED {
        n.mul_add(-PI, x)
    } else {
        // Twenty-six bits of pi, by which a whole number is multiplied exactly, and the rest.
        const HIGH: f64 = 3.1415926218032837;
        const REST: f64 = 3.178650954705639e-08;
        (x - n * HIGH) - n * REST
    };
    let r2 = r * r;
    // (sin r - r) / r^3, to 2e-16 for |r| of at most a quarter turn.
    let series = polynomial::<FUSED, 7>(
        r2,
        [
            -0.166_666_666_666_666_5,
            0.008_333_333_333_325_933,
            -0.000_198_412_698_364_690_24,
            2.755_731_805_568_578_3e-6,
            -2.505_197_292_154_555e-8,
            1.605_097_224_413_563_6e-10,
            -7.408_054_889_542_61e-13,
        ],
    );
    let sine = mul_add::<FUSED>(r * r2, series, r);
    f64::from_bits(sine.to_bits() ^ (shifted.to_bits() << 63))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn they_agree<const FUSED: bool>() {
        for k in -100_000..=100_000 {
            let x = f64::from(k) * 0.01;
            let (e, s) = (exp2::<FUSED>(x), sin::<FUSED>(x));
            assert!((e / x.exp2() - 1.0).abs() < 1e-13, "exp2 {x}: {e}");
            assert!((s - x.sin()).abs() < 2e-13, "sin {x}: {s} {}", x.sin());
        }
        for k in -3_000..3_000 {
            let x = (f64::from(k) * 0.1).exp2();
            let l = log2::<FUSED>(x);
            assert!((l - x.log2()).abs() < 1e-13 * x.log2().abs().max(1.0), "log2 {x}: {l}");
        }
        assert_eq!((log2::<FUSED>(1.0), sin::<FUSED>(0.0)), (0.0, 0.0));
        // A speed of zero has a Stribeck curve of one.
        assert!(log2::<FUSED>(0.0) < -1000.0 && log2::<FUSED>(1e-310) < -1000.0);
    }

    #[test]
    fn they_are_those_of_the_standard_library() {
        they_agree::<false>();
        they_agree::<true>();
    }
}
