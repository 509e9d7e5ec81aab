//! Scan, then Levenberg and Marquardt.

use nalgebra::{DMatrix, DVector};

use super::data::{Data, F_C, F_S, F_V, V_S};
use super::intervals::intervals;
use super::separable::Separable;
use super::{SteadyPoint, StribeckFit, StribeckOptions, StribeckValues, Unidentifiable, check};
use crate::IdentError;
use crate::least_squares;
use crate::trust_region::{self, minimise};

/// Trial Stribeck velocities of the scan.
const TRIALS: usize = 80;
/// Standard errors the dip must be worth. Three rather than two: the scan picks the `v_s` where
/// noise looks most like a dip.
const CLEAR_DIP: f64 = 3.0;

/// Fits a Stribeck curve to steady points of either sign of velocity. Points at rest count for
/// nothing.
///
/// # Errors
/// [`IdentError::TooFewSamples`] below eight points, [`IdentError::TooFewSpeeds`] below five
/// speeds, [`IdentError::NotFinite`], [`IdentError::StandardDeviation`],
/// [`IdentError::MixedDeviations`], [`IdentError::Exponent`], [`IdentError::ZeroForce`],
/// [`IdentError::NotFriction`] for torques that drive instead of braking,
/// [`IdentError::NoConvergence`]. A dip that the data do not show is no error: see
/// [`StribeckFit::unidentifiable`].
pub fn fit_stribeck(
    points: &[SteadyPoint],
    options: &StribeckOptions,
) -> Result<StribeckFit, IdentError> {
    let speeds = check(points, options)?;
    let moving: Vec<_> = points.iter().copied().filter(|point| point.velocity != 0.0).collect();
    let data = Data::new(&moving);
    let separable = Separable::new(&data, options.delta);
    let mut fit = best_curve(&data, &separable, speeds, options.delta)?;
    let Some(separable) = &separable else { return Ok(fit) };
    let sum = fit.variance * fit.degrees_of_freedom as f64;
    let [f_s, f_c, v_s, f_v] = intervals(separable, speeds, fit.parameters.v_s, sum);
    let open = Unidentifiable::OpenInterval { low: v_s.low, high: v_s.high };
    if fit.standard_errors[V_S].is_some() && v_s.low == 0.0 {
        fit = without_dip(&data, speeds, options.delta, open)?;
    } else if v_s.high == f64::INFINITY {
        fit.unidentifiable[V_S].get_or_insert(open);
    }
    // Held by its bound, `f_v` stands for more than an interval can say.
    fit.intervals = [Some(f_s), Some(f_c), Some(v_s), fit.standard_errors[F_V].map(|_| f_v)];
    Ok(fit)
}

/// The best curve, without intervals.
fn best_curve(
    data: &Data,
    separable: &Option<Separable>,
    speeds: (f64, f64),
    delta: f64,
) -> Result<StribeckFit, IdentError> {
    let Start { values, free, at_edge } = scan(data, separable, speeds, delta)?;
    if !free.contains(&V_S) {
        let no_dip = Unidentifiable::NoDip { dip: 0.0, standard_error: 0.0 };
        return without_dip(data, speeds, delta, no_dip);
    }
    let (slowest, fastest) = speeds;
    let outside = Unidentifiable::OutsideSpeeds { slowest, fastest };
    if at_edge {
        return without_dip(data, speeds, delta, outside);
    }
    let mut polished = polish(data, values, &free).unwrap_or(values);
    // The curve is even in v_s; the solver may have crossed zero.
    polished.v_s = polished.v_s.abs();
    let (low, high) = trial_range(speeds);
    if !(low..=high).contains(&polished.v_s) {
        return without_dip(data, speeds, delta, outside);
    }
    // The free optimum may break a bound that the scan respected; the scan's own fit stays then.
    let values = if valid(&polished) { polished } else { values };
    // One speed alone in the dip tells neither how deep nor how wide it is.
    let Ok(fit) = summarise(data, values, &free, speeds) else {
        return without_dip(data, speeds, delta, outside);
    };
    let dip = fit.parameters.f_s - fit.parameters.f_c;
    let covariance = &fit.covariance;
    let variance = covariance[F_S][F_S] + covariance[F_C][F_C] - 2.0 * covariance[F_S][F_C];
    let standard_error = variance.max(0.0).sqrt();
    if dip < CLEAR_DIP * standard_error || standard_error.is_nan() {
        return without_dip(data, speeds, delta, Unidentifiable::NoDip { dip, standard_error });
    }
    Ok(fit)
}

/// Coulomb and viscous friction alone: what is left, and safe to compensate with, where the data
/// show no dip. A curve kept with an unproven dip may rise to any height below the slowest measured
/// speed.
fn without_dip(
    data: &Data,
    speeds: (f64, f64),
    delta: f64,
    why: Unidentifiable,
) -> Result<StribeckFit, IdentError> {
    let shapes: [&[usize]; 2] = [&[F_C, F_V], &[F_C]];
    let fits = shapes.map(|free| (linear(data, speeds.0, delta, free), free));
    let best =
        fits.iter().find_map(|(values, free)| values.filter(valid).map(|values| (values, *free)));
    let Some((values, free)) = best else {
        let f_c = fits
            .iter()
            .filter_map(|(values, _)| values.map(|values| values.f_c))
            .fold(f64::NAN, f64::max);
        return Err(IdentError::NotFriction { f_c });
    };
    let mut fit = summarise(data, values, free, speeds)?;
    fit.unidentifiable[F_S] = Some(why);
    fit.unidentifiable[V_S] = Some(why);
    Ok(fit)
}

/// Range of trial Stribeck velocities: below it the dip has vanished before the slowest point,
/// above it the exponential bends too little over the measured speeds to be told from friction and
/// slope.
fn trial_range((slowest, fastest): (f64, f64)) -> (f64, f64) {
    (0.5 * slowest, fastest)
}

/// Where the scan ends.
struct Start {
    values: StribeckValues,
    /// Parameters that no bound holds.
    free: Vec<usize>,
    /// The best trial is the first or the last.
    at_edge: bool,
}

fn scan(
    data: &Data,
    separable: &Option<Separable>,
    speeds: (f64, f64),
    delta: f64,
) -> Result<Start, IdentError> {
    let (low, high) = trial_range(speeds);
    let mut best: Option<(f64, usize, StribeckValues, Vec<usize>)> = None;
    let rounding = 1e-26 * data.torque.iter().map(|torque| torque * torque).sum::<f64>();
    let mut worst_f_c = f64::NEG_INFINITY;
    for trial in 0..TRIALS {
        let v_s = low * (high / low).powf(trial as f64 / (TRIALS - 1) as f64);
        // All bounds open first, by variable projection.
        if let Some(open) = separable.as_ref().and_then(|separable| separable.trial(v_s))
            && open.valid()
            && open.dip > 0.0
        {
            let squares = open.sum + rounding * 3.0;
            if best.as_ref().is_none_or(|(least, ..)| squares < *least) {
                best = Some((squares, trial, open.values(delta), vec![F_S, F_C, F_V]));
            }
            continue;
        }
        // Then those that were broken closed, fewest first.
        let shapes: [&[usize]; 3] = [&[F_S, F_C], &[F_C, F_V], &[F_C]];
        for free in shapes {
            let Some(values) = linear(data, v_s, delta, free) else { continue };
            worst_f_c = worst_f_c.max(values.f_c);
            if !valid(&values) {
                continue;
            }
            // On exact data a richer shape wins by rounding alone; it has to win by more than that.
            let squares = data.residuals(&values).norm_squared() + rounding * free.len() as f64;
            if best.as_ref().is_none_or(|(least, ..)| squares < *least) {
                best = Some((squares, trial, values, free.to_vec()));
            }
        }
    }
    let Some((_, trial, values, mut free)) = best else {
        return Err(IdentError::NotFriction { f_c: worst_f_c });
    };
    let has_dip = free.contains(&F_S);
    if has_dip {
        free.push(V_S);
        free.sort_unstable();
    }
    Ok(Start { values, free, at_edge: has_dip && (trial == 0 || trial == TRIALS - 1) })
}

fn valid(values: &StribeckValues) -> bool {
    let StribeckValues { f_s, f_c, v_s, f_v, .. } = *values;
    let finite = f_s.is_finite() && v_s.is_finite();
    finite && f_c > 0.0 && f_s >= f_c && v_s > 0.0 && f_v >= 0.0
}

/// The best values for a given `v_s`; without a free `f_s` there is no dip, without `f_v` no
/// viscous friction.
fn linear(data: &Data, v_s: f64, delta: f64, free: &[usize]) -> Option<StribeckValues> {
    let mut values = StribeckValues { f_s: 0.0, f_c: 0.0, v_s, f_v: 0.0, delta };
    let torque = DVector::from_iterator(
        data.torque.len(),
        data.torque.iter().zip(&data.weight).map(|(torque, weight)| weight * torque),
    );
    let solution = least_squares::solve(&data.design(&values, free), &torque).ok()?;
    assign(&mut values, free, solution.x.as_slice());
    Some(values)
}

/// Sets the free parameters; `f_s` follows `f_c` where it is not free.
fn assign(values: &mut StribeckValues, free: &[usize], x: &[f64]) {
    for (&parameter, &value) in free.iter().zip(x) {
        match parameter {
            F_S => values.f_s = value,
            F_C => values.f_c = value,
            V_S => values.v_s = value,
            _ => values.f_v = value,
        }
    }
    if !free.contains(&F_S) {
        values.f_s = values.f_c;
    }
}

/// The nonlinear problem over the free parameters.
struct Problem<'a> {
    data: &'a Data,
    start: StribeckValues,
    free: &'a [usize],
}

impl Problem<'_> {
    fn values(&self, x: &[f64]) -> StribeckValues {
        let mut values = self.start;
        assign(&mut values, self.free, x);
        values
    }
}

impl trust_region::Problem for Problem<'_> {
    fn residuals(&self, x: &[f64]) -> DVector<f64> {
        self.data.residuals(&self.values(x))
    }

    fn jacobian(&self, x: &[f64]) -> DMatrix<f64> {
        self.data.jacobian(&self.values(x), self.free)
    }
}

/// The curve at the minimum beside `start`, or where patience ended, which the caller checks
/// against the bounds.
fn polish(
    data: &Data,
    start: StribeckValues,
    free: &[usize],
) -> Result<StribeckValues, IdentError> {
    let problem = Problem { data, start, free };
    let StribeckValues { f_s, f_c, v_s, f_v, .. } = start;
    let all = [f_s, f_c, v_s, f_v];
    let x: Vec<f64> = free.iter().map(|&parameter| all[parameter]).collect();
    match minimise(&problem, &x) {
        Ok(x) => Ok(problem.values(&x)),
        Err(what) => Err(IdentError::NoConvergence(format!("not finite: {what}"))),
    }
}

fn summarise(
    data: &Data,
    values: StribeckValues,
    free: &[usize],
    speeds: (f64, f64),
) -> Result<StribeckFit, IdentError> {
    let points = data.velocity.len();
    let degrees_of_freedom = points - free.len();
    let variance = data.residuals(&values).norm_squared() / degrees_of_freedom as f64;
    let plain = data.velocity.iter().zip(&data.torque);
    let mse =
        plain.map(|(&v, torque)| (values.torque(v) - torque).powi(2)).sum::<f64>() / points as f64;

    let solution = least_squares::solve(&data.design(&values, free), &DVector::zeros(points))
        .map_err(|_| {
            IdentError::NoConvergence("the parameters depend on one another".to_owned())
        })?;
    let mut covariance = [[0.0; 4]; 4];
    let mut standard_errors = [None; 4];
    for (i, &row) in free.iter().enumerate() {
        for (j, &column) in free.iter().enumerate() {
            covariance[row][column] = variance * solution.inverse_normal[(i, j)];
        }
        standard_errors[row] = Some(covariance[row][row].sqrt());
    }
    if !free.contains(&F_S) {
        // Tied to f_c, so it moves with it.
        covariance[F_S] = covariance[F_C];
        for row in &mut covariance {
            row[F_S] = row[F_C];
        }
    }
    let all = [values.f_s, values.f_c, values.v_s, values.f_v];
    let mut unidentifiable = [None; 4];
    for (parameter, reason) in unidentifiable.iter_mut().enumerate() {
        let relative_error = standard_errors[parameter].map(|error| error / all[parameter].abs());
        if let Some(relative_error) = relative_error.filter(|error| *error > 0.5 || error.is_nan())
        {
            *reason = Some(Unidentifiable::LargeError { relative_error });
        }
    }
    if !free.contains(&F_V) {
        unidentifiable[F_V] = Some(Unidentifiable::AtBound { bound: 0.0 });
    }
    Ok(StribeckFit {
        parameters: values,
        standard_errors,
        covariance,
        intervals: [None; 4],
        variance,
        mse,
        points,
        degrees_of_freedom,
        speeds,
        unidentifiable,
    })
}
