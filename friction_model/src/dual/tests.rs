use num_traits::Float;
use proptest::prelude::*;

use super::*;

/// A function of dual numbers, and the same of plain ones.
type Both = (fn(Dual<2>, Dual<2>) -> Dual<2>, fn(f64, f64) -> f64);

macro_rules! both {
    ($(|$x:ident, $y:ident| $formula:expr;)+) => {
        [$((|$x: Dual<2>, $y: Dual<2>| $formula, |$x: f64, $y: f64| $formula),)+]
    };
}

/// Every operation and function, of arguments between 0.1 and 0.9.
const ALL: [Both; 45] = both! {
    |x, y| x + y;
    |x, y| x - y;
    |x, y| x * y;
    |x, y| x / y;
    |x, y| x % (y * y * y);
    |x, y| -x * y;
    |x, y| { let mut z = x; z += y; z *= y; z -= x; z /= y; z };
    |x, y| [x, y, x].into_iter().sum();
    |x, _y| x.abs();
    |x, y| (x - y).abs();
    |x, y| x.copysign(-y);
    |x, y| x * y.signum() + x.floor() + x.ceil() + y.round() + y.trunc();
    |x, y| (x / y).fract();
    |x, _y| x.recip();
    |x, _y| x.sqrt();
    |x, _y| x.cbrt();
    |x, _y| x.exp();
    |x, _y| x.exp2();
    |x, _y| x.exp_m1();
    |x, _y| x.ln();
    |x, _y| x.ln_1p();
    |x, _y| x.log2();
    |x, _y| x.log10();
    |x, y| x.log(y);
    |x, _y| x.to_degrees();
    |x, _y| x.to_radians();
    |x, _y| x.sin();
    |x, _y| x.cos();
    |x, _y| x.tan();
    |x, _y| x.asin();
    |x, _y| x.acos();
    |x, _y| x.atan();
    |x, _y| x.sinh();
    |x, _y| x.cosh();
    |x, _y| x.tanh();
    |x, _y| x.asinh();
    |x, y| (x.recip() + y).acosh();
    |x, _y| x.atanh();
    |x, y| x.sin_cos().0 * y.sin_cos().1;
    |x, y| x.mul_add(y, y);
    |x, y| x.powi(3) * y.powi(-2) * y.powi(0);
    |x, y| x.powf(y);
    |x, y| x.max(y) * x.min(y) + x.max(y);
    |x, y| Float::abs_sub(x, y) + x.hypot(y);
    |x, y| x.atan2(y);
};

proptest! {
    // A sixth of the draws lies at a kink.
    #![proptest_config(ProptestConfig { max_global_rejects: u32::MAX, ..ProptestConfig::default() })]

    /// Against central differences.
    #[test]
    fn every_function_has_its_value_and_its_derivatives(x in 0.1..0.9f64, y in 0.1..0.9f64) {
        let h = 1e-6;
        // Whole numbers and equal arguments are kinks of some. Quotients of up to 900 move by 0.03.
        let whole = |z: f64| (z - z.round()).abs() < 0.05;
        prop_assume!((x - y).abs() > 1e-3 && !whole(x / y) && !whole(x / (y * y * y)));
        prop_assume!((y - 0.5).abs() > 1e-3);
        for (i, (dual, plain)) in ALL.iter().enumerate() {
            let found = dual(Dual::variable(x, 0), Dual::variable(y, 1));
            prop_assert_eq!(found.value(), plain(x, y));
            let slopes = [
                (plain(x + h, y) - plain(x - h, y)) / (2.0 * h),
                (plain(x, y + h) - plain(x, y - h)) / (2.0 * h),
            ];
            for (found, expected) in found.slopes().iter().zip(slopes) {
                let off = (found - expected).abs();
                prop_assert!(off <= 1e-6 * (1.0 + expected.abs()), "{}: {} {}", i, found, expected);
            }
        }
    }
}

#[test]
fn numbers_are_compared_by_value() {
    let (a, b) = (Dual::<2>::variable(1.0, 0), Dual::<2>::constant(1.0));
    assert!(a == b && a <= b && a >= b);
    let [below, above] = [a < b, a > b];
    assert!(!below && !above);
    assert!(Dual::<1>::nan().is_nan() && Dual::<1>::nan() != Dual::nan());
    assert_eq!(a.partial_cmp(&Dual::constant(2.0)), Some(Ordering::Less));
}

/// Where a slope is infinite, the number counts as constant: what hangs on nothing stays so.
#[test]
fn at_zero_roots_and_powers_stay_numbers() {
    let zero = Dual::<1>::constant(0.0);
    for number in [zero.sqrt(), zero.cbrt(), zero.powf(Dual::HALF), zero.hypot(zero)] {
        assert_eq!((number.value(), number.slopes()), (0.0, &[0.0]));
    }
    assert_eq!(Dual::<1>::variable(0.0, 0).powf(Dual::ONE).slopes(), &[1.0]);
    assert_eq!(Dual::<1>::variable(0.0, 0).powf(Dual::TWO).slopes(), &[0.0]);
}

#[test]
fn files_have_the_value() {
    let text = serde_json::to_string(&Dual::<2>::variable(2.5, 1)).unwrap();
    let back: Dual<2> = serde_json::from_str(&text).unwrap();
    assert_eq!((text.as_str(), back.value(), back.slopes()), ("2.5", 2.5, &[0.0, 0.0]));
}

#[test]
fn a_parameter_can_be_scaled_and_set() {
    let mut number = Dual::<1>::variable(3.0, 0);
    number.scale(2.0);
    assert_eq!((number.value(), number.slopes()), (6.0, &[2.0]));
    assert!(number.set(5.0));
    assert_eq!((number.value(), number.slopes()), (5.0, &[0.0]));
}
