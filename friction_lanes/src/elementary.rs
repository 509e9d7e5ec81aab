//! Powers of two, logarithm and sine without a branch or a call, so that the compiler can take
//! several numbers at once whatever the processor's width.
//!
//! [`exp`], [`exp_m1`], [`sine`] and [`cosine`] agree with the standard library's to rounding,
//! [`power`] nearly. [`exp2`], [`log2`] and [`sin`] agree to 1e-13 over the arguments that a servo's
//! simulation meets, and are faster; their coefficients are those of interpolation at Chebyshev's
//! points, which spreads the error evenly over the interval. `FUSED` rounds a product and a sum
//! once, where the processor has an instruction for that.

use std::f64::consts::{FRAC_PI_2, LOG2_E, PI};

/// Adding it rounds to a whole number, which then stands in the lowest bits.
const ROUND: f64 = 6_755_399_441_055_744.0;
const MANTISSA: u64 = 0x000f_ffff_ffff_ffff;
/// The bits of the root of a half.
const ROOT_HALF: u64 = 0x3fe6_a09e_667f_3bcd;
/// The bits of one.
const ONE: u64 = 0x3ff0_0000_0000_0000;

/// The larger; the second where one is no number.
#[inline(always)]
#[must_use]
pub fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// The smaller; the second where one is no number.
#[inline(always)]
#[must_use]
pub fn smaller(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

/// `x` held between the two.
#[inline(always)]
#[must_use]
pub fn within(x: f64, low: f64, high: f64) -> f64 {
    larger(smaller(x, high), low)
}

/// Whether the instructions that were chosen fuse a product with a sum: those of four lanes or more,
/// and ARM's.
#[inline(always)]
#[must_use]
pub fn fuses<S: pulp::Simd>() -> bool {
    S::F64_LANES >= 4 || cfg!(target_arch = "aarch64")
}

/// a b + c.
#[inline(always)]
#[must_use]
pub fn mul_add<const FUSED: bool>(a: f64, b: f64, c: f64) -> f64 {
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
#[must_use]
pub fn exp2<const FUSED: bool>(x: f64) -> f64 {
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

/// A positive number that is not subnormal as 2^e (1 + f) / (1 - f).
#[inline(always)]
fn split(x: f64) -> (f64, f64) {
    // The mantissa m is brought between the root of a half and the root of two.
    let moved = x.to_bits().wrapping_add(ONE - ROOT_HALF);
    let m = f64::from_bits((moved & MANTISSA) + ROOT_HALF);
    // The exponent as a number: put into the mantissa of 2^52, and that and the bias taken off.
    let e = f64::from_bits((moved >> 52) | 0x4330_0000_0000_0000) - 4_503_599_627_371_519.0;
    (e, (m - 1.0) / (m + 1.0))
}

/// The logarithm to base 2 of a positive number that is not subnormal; of zero some -1023.
#[inline(always)]
#[must_use]
pub fn log2<const FUSED: bool>(x: f64) -> f64 {
    let (e, f) = split(x);
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
#[must_use]
pub fn sin<const FUSED: bool>(x: f64) -> f64 {
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
    // (sin r - r) / r^3, with which the sine has an error of 8e-16 for |r| of at most a quarter turn.
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

/// Thirty-two bits of ln 2, by which a whole number is multiplied exactly, and the rest.
const LN_2: [f64; 2] =
    [f64::from_bits(0x3fe6_2e42_fee0_0000), f64::from_bits(0x3dea_39ef_3579_3c76)];

/// `x` without a multiple of ln 2: that multiple in the lowest bits, and e^r - 1 of what is left.
#[inline(always)]
fn reduced<const FUSED: bool>(x: f64) -> (u64, f64) {
    let shifted = mul_add::<FUSED>(x, LOG2_E, ROUND);
    let n = shifted - ROUND;
    let r = mul_add::<FUSED>(-n, LN_2[1], mul_add::<FUSED>(-n, LN_2[0], x));
    // (e^r - 1 - r) / r^2, with which e^r has an error of 2e-17 for |r| of at most 0.35.
    let series = polynomial::<FUSED, 10>(
        r,
        [
            0.500_000_000_000_000_1,
            0.166_666_666_666_666_69,
            0.041_666_666_666_624_13,
            0.008_333_333_333_330_062,
            0.001_388_888_891_721_371_7,
            0.000_198_412_698_630_536_18,
            2.480_152_129_595_437_6e-05,
            2.755_726_845_999_706_4e-06,
            2.762_008_844_540_974_6e-07,
            2.510_038_549_551_032e-08,
        ],
    );
    (shifted.to_bits() << 52, mul_add::<FUSED>(r * r, series, r))
}

/// e^x for x of at most 709, with a relative error of at most 4.5e-16; below -708 what it is at -708,
/// 3e-308.
#[inline(always)]
#[must_use]
pub fn exp<const FUSED: bool>(x: f64) -> f64 {
    let (n, less_one) = reduced::<FUSED>(larger(x, -708.0));
    f64::from_bits((1.0 + less_one).to_bits().wrapping_add(n))
}

/// e^x - 1, with a relative error of at most 7e-16, for x of at most 700; -1 below -708.
#[inline(always)]
#[must_use]
pub fn exp_m1<const FUSED: bool>(x: f64) -> f64 {
    let (n, less_one) = reduced::<FUSED>(larger(x, -708.0));
    let scale = f64::from_bits(ONE.wrapping_add(n));
    mul_add::<FUSED>(scale, less_one, scale - 1.0)
}

/// x^y for x and y of zero or more, with a relative error of at most 4.5e-16 (1 + |y log2 x|), between
/// 2^-1000 and 2^1000; zero of zero and of what is subnormal, infinite of infinity.
#[inline(always)]
#[must_use]
pub fn power<const FUSED: bool>(x: f64, y: f64) -> f64 {
    let (e, f) = split(x);
    // The logarithm of (1 + f) / (1 - f) over f to base e, to 3e-18.
    let series = polynomial::<FUSED, 8>(
        f * f,
        [
            2.0,
            0.666_666_666_666_676_5,
            0.399_999_999_993_019_1,
            0.285_714_287_607_382_8,
            0.222_221_970_464_042_74,
            0.181_836_322_416_170_26,
            0.153_125_131_147_383,
            0.148_098_675_723_130_62,
        ],
    );
    let log = f * series;
    // The whole powers of two apart from the rest: neither takes digits of the other.
    let whole = within(y * e, -1000.0, 1000.0);
    let shifted = whole + ROUND;
    let n = shifted - ROUND;
    let rest = mul_add::<FUSED>(whole - n, std::f64::consts::LN_2, y * log);
    let found = exp::<FUSED>(rest) * f64::from_bits(ONE.wrapping_add(shifted.to_bits() << 52));
    let found = if x < f64::MIN_POSITIVE { 0.0 } else { found };
    if x > f64::MAX { x } else { found }
}

/// sin x for |x| of at most a quarter turn (pi / 2), with an error of at most 4.5e-16.
#[inline(always)]
#[must_use]
pub fn sine<const FUSED: bool>(x: f64) -> f64 {
    let x2 = x * x;
    // (sin x - x) / x^3, with which the sine has an error of 4e-17.
    let series = polynomial::<FUSED, 8>(
        x2,
        [
            -0.166_666_666_666_666_66,
            0.008_333_333_333_333_316,
            -0.000_198_412_698_412_549_66,
            2.755_731_921_916_083_3e-06,
            -2.505_210_761_669_045e-08,
            1.605_897_729_264_274_3e-10,
            -7.643_969_663_988_074e-13,
            2.731_436_876_937_989_3e-15,
        ],
    );
    mul_add::<FUSED>(x * x2, series, x)
}

/// cos x for |x| of at most a quarter turn (pi / 2), with an error of at most 4.5e-16.
#[inline(always)]
#[must_use]
pub fn cosine<const FUSED: bool>(x: f64) -> f64 {
    sine::<FUSED>(FRAC_PI_2 - x.abs())
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

    /// The largest of `error` over many numbers between two.
    fn worst(low: f64, high: f64, error: impl Fn(f64) -> f64) -> f64 {
        let count = 300_000;
        let at = |k: i32| low + (high - low) * f64::from(k) / f64::from(count);
        (0..=count).map(|k| error(at(k))).fold(0.0, f64::max)
    }

    fn exact<const FUSED: bool>() {
        let relative = |a: f64, b: f64| if b == 0.0 { a.abs() } else { (a / b - 1.0).abs() };
        for reach in [1e-9, 1e-3, 0.4, 3.0, 700.0] {
            let e = worst(-reach, reach, |x| relative(exp::<FUSED>(x), x.exp()));
            let m = worst(-reach, reach, |x| relative(exp_m1::<FUSED>(x), x.exp_m1()));
            assert!(e < 4.5e-16 && m < 7e-16, "{reach}: exp {e:e}, exp_m1 {m:e}");
        }
        let quarter = FRAC_PI_2 * (1.0 + f64::EPSILON);
        let s = worst(-quarter, quarter, |x| (sine::<FUSED>(x) - x.sin()).abs());
        let c = worst(-quarter, quarter, |x| (cosine::<FUSED>(x) - x.cos()).abs());
        assert!(s < 4.5e-16 && c < 4.5e-16, "sine {s:e}, cosine {c:e}");
        for y in [0.01, 0.3, 1.0, 1.7, 2.0, 4.0, 10.0] {
            let p = worst(-30.0, 30.0, |l| {
                let x = l.exp2();
                relative(power::<FUSED>(x, y), x.powf(y)) / (1.0 + (y * l).abs())
            });
            assert!(p < 4.5e-16, "power {y}: {p:e}");
        }
        assert_eq!((exp::<FUSED>(0.0), exp_m1::<FUSED>(0.0)), (1.0, 0.0));
        assert_eq!((sine::<FUSED>(0.0), exp_m1::<FUSED>(-1e300)), (0.0, -1.0));
        assert!(exp::<FUSED>(f64::NEG_INFINITY) < 4e-308);
        assert_eq!(power::<FUSED>(0.0, 0.01), 0.0);
        assert_eq!(power::<FUSED>(f64::INFINITY, 0.01), f64::INFINITY);
    }

    #[test]
    fn the_exact_ones_are_those_of_the_standard_library_to_rounding() {
        exact::<false>();
        exact::<true>();
    }

    #[test]
    fn they_are_those_of_the_standard_library() {
        they_agree::<false>();
        they_agree::<true>();
    }
}
