use super::*;
use crate::estimate::{Estimates, Unknown};

/// `x0 (1 - exp(-x1 t))` or a straight line against data.
struct Curve<'a> {
    t: &'a [f64],
    y: &'a [f64],
    model: fn(&[f64], f64) -> f64,
}

impl Residuals for Curve<'_> {
    fn len(&self) -> usize {
        self.t.len()
    }
    fn residuals(&mut self, x: &[f64], out: &mut [f64]) -> bool {
        for ((r, &t), &y) in out.iter_mut().zip(self.t).zip(self.y) {
            *r = (self.model)(x, t) - y;
        }
        true
    }
}

fn minimum(problem: &mut Curve, start: &[f64], bounds: &[Bound]) -> Minimum {
    minimise(problem, start, bounds, &Patience::default(), &mut |_| ControlFlow::Continue(()))
        .unwrap()
}

#[test]
fn of_a_straight_line_it_is_the_interval_of_the_standard_error() {
    let t: Vec<f64> = (0..12).map(f64::from).collect();
    let y: Vec<f64> = t.iter().map(|t| 1.0 + 0.3 * t + (5.0 * t).sin()).collect();
    let mut problem = Curve { t: &t, y: &y, model: |x, t| x[0] + x[1] * t };
    let bounds = [Bound::free(1.0); 2];
    let found = minimum(&mut problem, &[0.0, 0.0], &bounds);
    let unknown = |name| Unknown { id: crate::ParameterId::new(name), unit: "", remedy: "" };
    let linear = Estimates::linearised(&found, &[unknown("a"), unknown("b")], 1.0);
    for (j, estimate) in linear.parameters.iter().enumerate() {
        let error = estimate.standard_error.unwrap();
        let profile =
            profile_of(&mut problem, &found, &bounds, j, error, 1.0, &Patience::default()).unwrap();
        let expected = estimate.interval.unwrap();
        assert!((profile.low - expected.low).abs() < 1e-3 * error, "{profile:?} {expected:?}");
        assert!((profile.high - expected.high).abs() < 1e-3 * error, "{profile:?} {expected:?}");
    }
}

/// The biochemical oxygen demand of Bates and Watts (1988), A1.4: `y = 19.143 (1 - exp(-.5311 t))`
/// through six points. The interval of the rate reaches far further up than down, and is open where
/// the residuals are worth less.
#[test]
fn the_rate_of_the_oxygen_demand_reaches_far_up() {
    let t = [1.0, 2.0, 3.0, 4.0, 5.0, 7.0];
    let y = [8.3, 10.3, 19.0, 16.0, 15.6, 19.8];
    let mut problem = Curve { t: &t, y: &y, model: |x, t| x[0] * (1.0 - (-x[1] * t).exp()) };
    let bounds = [Bound::within(0.0, 1e4, 10.0), Bound::within(0.0, f64::INFINITY, 1.0)];
    let found = minimum(&mut problem, &[20.0, 0.24], &bounds);
    assert!(
        (found.x[0] - 19.143).abs() < 1e-3 && (found.x[1] - 0.5311).abs() < 1e-4,
        "{:?}",
        found.x
    );
    let mut rate = |share| {
        profile_of(&mut problem, &found, &bounds, 1, 0.2, share, &Patience::default()).unwrap()
    };
    let whole = rate(1.0);
    assert!(whole.high - 0.5311 > 2.0 * (0.5311 - whole.low), "{whole:?}");
    // The ends are where the least sum of squares over the asymptote, a linear fit, meets the
    // limit.
    let limit = sum_limit(found.sum, 6, 2, 1.0);
    for end in [whole.low, whole.high] {
        let base: Vec<f64> = t.iter().map(|t| 1.0 - (-end * t).exp()).collect();
        let squares = base.iter().map(|b| b * b).sum::<f64>();
        let asymptote = base.iter().zip(&y).map(|(b, y)| b * y).sum::<f64>() / squares;
        let sum: f64 = base.iter().zip(&y).map(|(b, y)| (y - asymptote * b).powi(2)).sum();
        assert!((sum / limit - 1.0).abs() < 1e-3, "{sum} {limit}");
    }
    let half = rate(0.6);
    assert_eq!(half.high, f64::INFINITY);
    assert!(half.low < whole.low, "{half:?}");
}

#[test]
fn a_wall_ends_the_interval() {
    let search = Search { best: 1.0, step: 0.1, low: 0.0, high: 1.2, limit: 2.0 };
    let flat = profile_interval(&search, &mut |_| Some(1.0));
    assert_eq!((flat.low, flat.high), (0.0, 1.2));
    let forbidden = profile_interval(&search, &mut |x| (x < 1.1).then_some(1.0));
    assert!((forbidden.high - 1.1).abs() < 1e-4, "{forbidden:?}");
}

#[test]
fn residuals_worth_less_widen_the_limit() {
    let white = sum_limit(2.0, 1000, 3, 1.0) - 2.0;
    let alike = sum_limit(2.0, 1000, 3, 0.25) - 2.0;
    assert!((alike / white / 4.0 - 1.0).abs() < 0.02, "{white} {alike}");
    assert_eq!(sum_limit(2.0, 3, 3, 1.0), f64::INFINITY);
}
