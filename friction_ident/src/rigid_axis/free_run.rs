//! The free run of a fitted axis: moved by the recorded force alone, how far does it end up from
//! where the real one went?
//!
//! It is the metric of the EMPS benchmark (Janot, Gautier and Brunot 2019): the simulated position,
//! in open loop, root mean square of the error without the samples that serve to begin. Nothing
//! draws the simulation back, so that a small offset adds up: a much harder test than the force.
//!
//! The force is held over each sample. Between two changes of direction the model is linear, and is
//! solved exactly; at rest it stays as long as the force is below Coulomb's.

use super::AxisFit;
use crate::axis_term::AxisTerm;

/// Samples that serve to begin, as in the benchmark.
///
/// The benchmark does not say how they give the velocity. A line through the second half of them
/// brings the published parameters to within 3 % of their published figures.
pub const BEGIN: usize = 20;
/// Changes of direction within a sample beyond which the axis rests until the next.
const TURNS: usize = 8;

/// What an axis does under a force.
#[derive(Debug, Clone, Copy)]
struct Moved {
    inertia: f64,
    /// Against forward and backward motion.
    viscous: [f64; 2],
    coulomb: [f64; 2],
    offset: f64,
    spring: f64,
    gravity: [f64; 2],
}

impl AxisFit {
    /// The position \[m or rad\] at each sample under `force`, from where the measured one is after
    /// [`BEGIN`] samples and as fast as a line through the second half of these; before that the
    /// measured one.
    /// None where the fit is no axis that can be moved (no inertia, or a term that is not above
    /// zero), or there are too few samples.
    #[must_use]
    pub fn free_run(&self, force: &[f64], position: &[f64], time_step: f64) -> Option<Vec<f64>> {
        let axis = Moved::of(self)?;
        let start = position.get(..BEGIN).filter(|_| force.len() == position.len())?;
        let (mut q, mut v) = end_of_line(&start[BEGIN / 2..], time_step);
        let mut run = start.to_vec();
        for &force in force.get(BEGIN - 1..force.len() - 1)? {
            (q, v) = axis.over(q, v, force, time_step);
            run.push(q);
        }
        run.iter().all(|q| q.is_finite()).then_some(run)
    }
}

/// Root mean square of simulated minus measured position over several runs, each without its first
/// [`BEGIN`] samples; none where nothing is left.
#[must_use]
pub fn free_run_error<'a>(runs: impl IntoIterator<Item = (&'a [f64], &'a [f64])>) -> Option<f64> {
    let (mut sum, mut count) = (0.0, 0usize);
    for (simulated, measured) in runs {
        for (a, b) in simulated.iter().zip(measured).skip(BEGIN) {
            sum += (a - b).powi(2);
            count += 1;
        }
    }
    (count > 0).then(|| (sum / count as f64).sqrt())
}

/// Position and velocity at the last of some samples, by a line through them.
fn end_of_line(position: &[f64], time_step: f64) -> (f64, f64) {
    let n = position.len() as f64;
    let middle = 0.5 * (n - 1.0);
    let mean = position.iter().sum::<f64>() / n;
    let (mut above, mut below) = (0.0, 0.0);
    for (k, q) in position.iter().enumerate() {
        let t = k as f64 - middle;
        above += t * (q - mean);
        below += t * t;
    }
    let slope = above / below;
    (mean + slope * middle, slope / time_step)
}

impl Moved {
    fn of(fit: &AxisFit) -> Option<Self> {
        let each = |both, forward, backward| match fit.term(both) {
            Some(both) => [both.value; 2],
            None => [fit.value(forward), fit.value(backward)],
        };
        let axis = Self {
            inertia: fit.value(AxisTerm::Inertia),
            viscous: each(AxisTerm::Viscous, AxisTerm::ViscousPositive, AxisTerm::ViscousNegative),
            coulomb: each(AxisTerm::Coulomb, AxisTerm::CoulombPositive, AxisTerm::CoulombNegative),
            offset: fit.value(AxisTerm::Offset),
            spring: fit.value(AxisTerm::Spring),
            gravity: [fit.value(AxisTerm::GravitySin), fit.value(AxisTerm::GravityCos)],
        };
        let real =
            axis.inertia > 0.0 && axis.coulomb.iter().chain(&axis.viscous).all(|f| *f >= 0.0);
        real.then_some(axis)
    }

    /// Position and velocity after `h` under a constant force; what the position decides is held.
    fn over(&self, mut q: f64, mut v: f64, force: f64, h: f64) -> (f64, f64) {
        let load = self.spring * q + self.gravity[0] * q.sin() + self.gravity[1] * q.cos();
        let net = force - self.offset - load;
        let mut left = h;
        for _ in 0..TURNS {
            let direction = if v != 0.0 { v.signum() } else { net.signum() };
            let side = usize::from(direction < 0.0);
            if v == 0.0 && net.abs() <= self.coulomb[side] {
                break;
            }
            let drive = (net - direction * self.coulomb[side]) / self.inertia;
            let rate = self.viscous[side] / self.inertia;
            let (dq, after) = moved(v, drive, rate, left);
            if after * direction >= 0.0 {
                (q, v) = (q + dq, after);
                break;
            }
            // It comes to rest on the way.
            let time = turn(v, drive, rate).min(left);
            q += moved(v, drive, rate, time).0;
            v = 0.0;
            left -= time;
        }
        (q, v)
    }
}

/// Travel and velocity after `t` of `v' = drive - rate v`.
fn moved(v: f64, drive: f64, rate: f64, t: f64) -> (f64, f64) {
    let x = rate * t;
    if x < 1e-6 {
        let mean = drive - rate * v;
        return (v * t + 0.5 * mean * t * t, v + mean * t);
    }
    let end = drive / rate;
    let gone = -(-x).exp_m1();
    (end * t + (v - end) * gone / rate, v + (end - v) * gone)
}

/// When the velocity is zero.
fn turn(v: f64, drive: f64, rate: f64) -> f64 {
    let x = rate * v / drive;
    if x.abs() < 1e-6 { -v / drive } else { (-x).ln_1p() / rate }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{AxisModel, Load, TermEstimate};

    fn axis(load: Load) -> AxisFit {
        let model = AxisModel { load, ..AxisModel::SYMMETRIC };
        let values = [2.0, 0.8, 1.5, 0.25, 3.0];
        let term = |(term, value)| TermEstimate {
            term,
            value,
            standard_error: 0.0,
            half_width: 0.0,
            white_error: 0.0,
            doubt: None,
        };
        let terms = model.terms().into_iter().zip(values).map(term).collect();
        let correlation = Vec::new();
        AxisFit { model, terms, correlation, relative_error: 0.0, residual_rms: 0.0, samples: 0 }
    }

    /// Runge and Kutta with steps far below the time between two changes.
    fn reference(force: &[f64], dt: f64, spring: f64) -> Vec<f64> {
        let (mut q, mut v) = (0.0f64, 0.0f64);
        let mut all = vec![q];
        for &f in &force[..force.len() - 1] {
            for _ in 0..1000 {
                let h = dt / 1000.0;
                let net = f - 0.25 - spring * q;
                let a = if v == 0.0 && net.abs() <= 1.5 {
                    0.0
                } else {
                    let direction = if v != 0.0 { v.signum() } else { net.signum() };
                    (net - 0.8 * v - 1.5 * direction) / 2.0
                };
                let next = v + h * a;
                (q, v) = (q + h * 0.5 * (v + next), if next * v < 0.0 { 0.0 } else { next });
            }
            all.push(q);
        }
        all
    }

    #[test]
    fn it_is_the_motion_of_the_axis_through_rest_and_reversals() {
        let dt = 2e-3;
        let force: Vec<f64> =
            (0..6000).map(|k| 3.0 * (1.7 * f64::from(k) * dt).sin() + 0.25).collect();
        for (load, spring) in [(Load::None, 0.0), (Load::Spring, 3.0)] {
            let truth = reference(&force, dt, spring);
            let run = axis(load).free_run(&force, &truth, dt).unwrap();
            let error = free_run_error([(run.as_slice(), truth.as_slice())]).unwrap();
            let size = truth.iter().map(|q| q * q).sum::<f64>().sqrt() / 6000f64.sqrt();
            assert!(error < 0.01 * size, "{load:?}: {error} of {size}");
        }
    }

    #[test]
    fn what_cannot_be_moved_is_not() {
        let mut fit = axis(Load::None);
        assert_eq!(fit.free_run(&[0.0; 10], &[0.0; 10], 1e-3), None);
        fit.terms[0].value = -1.0;
        assert_eq!(fit.free_run(&[0.0; 100], &[0.0; 100], 1e-3), None);
        assert_eq!(free_run_error([]), None);
    }
}
