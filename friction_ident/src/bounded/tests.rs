use std::ops::ControlFlow;

use super::*;

struct Curve<F>(usize, F);

impl<F: FnMut(&[f64], usize) -> f64> Residuals for Curve<F> {
    fn len(&self) -> usize {
        self.0
    }
    fn residuals(&mut self, x: &[f64], out: &mut [f64]) -> bool {
        out.iter_mut().enumerate().for_each(|(i, r)| *r = (self.1)(x, i));
        true
    }
}

fn go(problem: &mut impl Residuals, start: &[f64], bounds: &[Bound], broyden: bool) -> Minimum {
    let patience = Patience { broyden, ..Patience::default() };
    minimise(problem, start, bounds, &patience, &mut |_| ControlFlow::Continue(())).unwrap()
}

/// Rosenbrock's valley as two residuals; the minimum is (1, 1).
#[test]
fn follows_a_curved_valley() {
    for broyden in [false, true] {
        let mut problem =
            Curve(2, |x: &[f64], i| if i == 0 { 10.0 * (x[1] - x[0] * x[0]) } else { 1.0 - x[0] });
        let found = go(&mut problem, &[-1.2, 1.0], &[Bound::free(1.0); 2], broyden);
        assert!((found.x[0] - 1.0).abs() < 1e-9 && (found.x[1] - 1.0).abs() < 1e-9, "{found:?}");
    }
}

/// What is asked for alone is found with fewer residuals, as near as the patience asks.
#[test]
fn the_lowest_point_alone_costs_less() {
    let patience = Patience { sum: 1e-5, ..Patience::default() };
    let cost = |alone: bool| {
        let mut asked = 0;
        let mut problem = Curve(9, |x: &[f64], i| {
            asked += usize::from(i == 0);
            (x[0] * i as f64).exp() - 2.0 - 0.1 * (i % 3) as f64
        });
        let bounds = [Bound::free(1.0)];
        let x = match alone {
            true => lowest(&mut problem, &[0.0], &bounds, &patience).unwrap(),
            false => {
                let go = &mut |_: &Step| ControlFlow::Continue(());
                minimise(&mut problem, &[0.0], &bounds, &patience, go).unwrap().x
            }
        };
        (x[0], asked)
    };
    let ((alone, fewer), (whole, more)) = (cost(true), cost(false));
    assert!((alone - whole).abs() < 1e-3 * whole.abs(), "{alone} {whole}");
    assert!(fewer < more, "{fewer} {more}");
}

/// With x0 <= 0.5 the best point of the valley is (0.5, 0.25).
#[test]
fn stops_at_a_bound_and_says_so() {
    let bounds = [Bound::within(-2.0, 0.5, 1.0), Bound::free(1.0)];
    let mut problem =
        Curve(2, |x: &[f64], i| if i == 0 { 10.0 * (x[1] - x[0] * x[0]) } else { 1.0 - x[0] });
    let found = go(&mut problem, &[-1.2, 1.0], &bounds, false);
    assert!((found.x[0] - 0.5).abs() < 1e-12 && (found.x[1] - 0.25).abs() < 1e-8, "{found:?}");
    assert_eq!((found.held, found.ending), (vec![true, false], Ending::Converged));
}

/// Misra1a of NIST's reference data sets (nonlinear regression, start 1).
#[test]
fn agrees_with_a_certified_fit() {
    let x = [
        77.6, 114.9, 141.1, 190.8, 239.9, 289.0, 332.8, 378.4, 434.8, 477.3, 536.8, 593.1, 689.1,
        760.0,
    ];
    let y = [
        10.07, 14.73, 17.94, 23.93, 29.61, 35.18, 40.02, 44.82, 50.76, 55.05, 61.01, 66.40, 75.47,
        81.78,
    ];
    let bounds = [Bound::within(0.0, 1e4, 100.0), Bound::within(0.0, 1.0, 1e-3)];
    for broyden in [false, true] {
        let mut problem =
            Curve(14, |b: &[f64], i: usize| b[0] * (1.0 - (-b[1] * x[i]).exp()) - y[i]);
        let found = go(&mut problem, &[500.0, 1e-4], &bounds, broyden);
        assert!((found.x[0] / 2.3894212918e2 - 1.0).abs() < 1e-7, "{:?}", found.x);
        assert!((found.x[1] / 5.5015643181e-4 - 1.0).abs() < 1e-7, "{:?}", found.x);
        assert!((found.sum / 1.2455138894e-1 - 1.0).abs() < 1e-9, "{}", found.sum);
    }
}

#[test]
fn a_watcher_stops_the_search_and_keeps_the_best() {
    let mut problem =
        Curve(2, |x: &[f64], i| if i == 0 { 10.0 * (x[1] - x[0] * x[0]) } else { 1.0 - x[0] });
    let mut sums = Vec::new();
    let found = minimise(
        &mut problem,
        &[-1.2, 1.0],
        &[Bound::free(1.0); 2],
        &Patience::default(),
        &mut |step| {
            sums.push(step.sum);
            if step.iteration == 4 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        },
    )
    .unwrap();
    assert_eq!((found.ending, sums.len()), (Ending::Stopped, 4));
    assert!(sums.windows(2).all(|pair| pair[1] < pair[0]) && found.sum == sums[3]);
}

#[test]
fn what_is_not_allowed_is_refused_or_avoided() {
    struct Fence;
    impl Residuals for Fence {
        fn len(&self) -> usize {
            1
        }
        fn residuals(&mut self, x: &[f64], out: &mut [f64]) -> bool {
            out[0] = x[0] + 3.0;
            x[0] >= 1.0
        }
    }
    let none = minimise(&mut Fence, &[0.0], &[Bound::free(1.0)], &Patience::default(), &mut |_| {
        ControlFlow::Continue(())
    });
    assert_eq!(none, None);
    let found = go(&mut Fence, &[9.0], &[Bound::free(1.0)], false);
    assert!(found.x[0] >= 1.0 && found.x[0] < 1.01, "{found:?}");
}
