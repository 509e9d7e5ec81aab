//! An axis under its position controller, simulated forward: the harder test of a fitted model,
//! because its errors come back through the loop.
//!
//! The controller is the cascade of the EMPS benchmark (Janot, Gautier and Brunot 2019) as it acts
//! in discrete time: proportional position loop around a proportional velocity loop, the velocity
//! from differences of the mean of two neighbouring positions. The plant is a mass under the
//! friction of an axis structure, driven by the held and delayed control signal, integrated with
//! steps that end where the input changes.

use std::ops::ControlFlow;

use serde::Serialize;

use super::StructureFit;
use crate::IdentError;
use crate::bounded::{Bound, Minimum, Patience, Residuals, minimise};
use crate::estimate::{Estimates, Unknown};
use crate::parameter_id::{ParameterId, Side};
use crate::residual_whiteness::effective_share;

/// A cascade of position and velocity loop, sampled.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct CascadeController {
    /// Gain of the position loop \[1/s\].
    pub position_gain: f64,
    /// Gain of the velocity loop \[V s/m or V s/rad\].
    pub velocity_gain: f64,
    /// Largest magnitude of the control signal \[V\].
    pub limit: f64,
    /// Sampling period \[s\].
    pub period: f64,
}

impl CascadeController {
    /// The controller that made the EMPS recordings.
    pub const EMPS: Self =
        Self { position_gain: 160.18, velocity_gain: 243.45, limit: 10.0, period: 1e-3 };

    /// Control signal \[V\] from the reference, the position and that of two samples earlier.
    fn control(&self, reference: f64, q: f64, earlier: f64) -> f64 {
        let velocity = (q - earlier) / (2.0 * self.period);
        let signal = self.velocity_gain * (self.position_gain * (reference - q) - velocity);
        signal.clamp(-self.limit, self.limit)
    }

    /// The control signal \[V\] that recorded positions would have caused: a check that it is the
    /// right controller.
    pub fn replay(&self, reference: &[f64], position: &[f64]) -> Vec<f64> {
        let at =
            |k: usize, back: usize| position.get(k.saturating_sub(back)).copied().unwrap_or(0.0);
        let signal = |(k, &r): (usize, &f64)| self.control(r, at(k, 0), at(k, 2));
        reference.iter().take(position.len()).enumerate().map(signal).collect()
    }
}

/// What an axis is asked to do.
#[derive(Debug, Clone, Copy)]
pub struct Task<'a> {
    /// Reference position at each sample \[m or rad\].
    pub reference: &'a [f64],
    /// Volts added to the control signal at each sample, if any.
    pub disturbance: Option<&'a [f64]>,
    /// Where the axis rests at the start \[m or rad\].
    pub start: f64,
}

/// What an axis did, at each sample.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Response {
    /// Position \[m or rad\].
    pub position: Vec<f64>,
    /// Control signal, disturbance included \[V\].
    pub control: Vec<f64>,
}

/// A mass behind a drive, with the friction of an axis structure: a bristle whose limit follows a
/// curve of the speed, each direction its own.
///
/// ```text
/// inertia v' = force_per_volt u(t - delay) - z level(v) - f_v v,     z' = (v - |v| z) / displacement
/// level(v) = f_c + (f_s - f_c) exp(-(v/v_s)^2)
/// ```
///
/// Unlike in LuGre, `f_s` may lie below `f_c`: some axes need it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct BristleAxis {
    /// Moving mass \[kg\] or inertia \[kg m^2\], above zero.
    pub inertia: f64,
    /// Viscous friction, forward and backward \[N s/m or N m s/rad\].
    pub f_v: [f64; 2],
    /// Coulomb friction, forward and backward \[N or N m\].
    pub f_c: [f64; 2],
    /// Friction near rest, forward and backward \[N or N m\].
    pub f_s: [f64; 2],
    /// Speed over which friction goes from one to the other, above zero \[m/s or rad/s\].
    pub v_s: f64,
    /// Displacement over which friction builds up after a reversal, above zero \[m or rad\].
    pub displacement: f64,
    /// Delay of the force behind the held control signal \[s\].
    pub delay: f64,
}

/// Position, velocity and bristle.
#[derive(Debug, Clone, Copy)]
struct Moving {
    x: f64,
    v: f64,
    z: f64,
}

/// Longest integration step \[s\].
const STEP: f64 = 2.5e-4;

impl BristleAxis {
    /// From a fit with direction-wise friction, a Stribeck velocity, pre-sliding and a delay; half
    /// a `period` of the fitted delay is the hold's.
    ///
    /// None for a fit without one of them.
    pub fn from_fit(fit: &StructureFit, period: f64) -> Option<Self> {
        let value = |name: &'static str| fit.estimates.value(name);
        let both_ways = |name| {
            let on = |side| fit.estimates.value(ParameterId::new(name).side(side));
            Some([on(Side::Forward)?, on(Side::Backward)?])
        };
        Some(Self {
            inertia: value("inertia")?,
            f_v: both_ways("f_v")?,
            f_c: both_ways("f_c")?,
            f_s: both_ways("f_s")?,
            v_s: value("v_s")?,
            displacement: value("presliding")?,
            delay: (value("delay")? - 0.5 * period).max(0.05 * period),
        })
    }

    /// Runs the axis under `controller`.
    pub fn run(
        &self,
        controller: &CascadeController,
        force_per_volt: f64,
        task: &Task,
    ) -> Response {
        let n = task.reference.len();
        let mut response =
            Response { position: Vec::with_capacity(n), control: Vec::with_capacity(n) };
        let period = controller.period;
        let whole = (self.delay / period).floor();
        let (late, part) = (whole as usize, self.delay - whole * period);
        let mut state = Moving { x: task.start, v: 0.0, z: 0.0 };
        for (k, &reference) in task.reference.iter().enumerate() {
            let earlier = k.checked_sub(2).and_then(|k| response.position.get(k)).copied();
            let pulse = task.disturbance.and_then(|pulse| pulse.get(k)).copied().unwrap_or(0.0);
            let signal =
                controller.control(reference, state.x, earlier.unwrap_or(task.start)) + pulse;
            response.position.push(state.x);
            response.control.push(signal);
            let input = |by: usize| {
                k.checked_sub(by).and_then(|k| response.control.get(k)).copied().unwrap_or(0.0)
            };
            for (length, volts) in [(part, input(late + 1)), (period - part, input(late))] {
                let steps = (length / STEP - 1e-9).ceil().max(0.0);
                for _ in 0..steps as usize {
                    state = self.advance(&state, force_per_volt * volts, length / steps);
                }
            }
        }
        response
    }

    /// The midpoint rule; the bristle is solved exactly for the velocity of the step.
    fn advance(&self, from: &Moving, force: f64, h: f64) -> Moving {
        let acceleration = |v: f64, z: f64| (force - self.friction(v, z)) / self.inertia;
        let v = from.v + 0.5 * h * acceleration(from.v, from.z);
        let z = self.bristle(from.z, 0.5 * (from.v + v), 0.5 * h);
        Moving {
            x: from.x + h * v,
            v: from.v + h * acceleration(v, z),
            z: self.bristle(from.z, v, h),
        }
    }

    fn friction(&self, v: f64, z: f64) -> f64 {
        let near = (-(v / self.v_s).powi(2)).exp();
        let level = |side: usize| self.f_c[side] + (self.f_s[side] - self.f_c[side]) * near;
        level(usize::from(z < 0.0)) * z + self.f_v[usize::from(v < 0.0)] * v
    }

    fn bristle(&self, z: f64, v: f64, h: f64) -> f64 {
        let limit = v.signum();
        limit + (z - limit) * (-v.abs() * h / self.displacement).exp()
    }

    const fn values(&self) -> [f64; UNKNOWNS] {
        let Self { inertia, f_v, f_c, f_s, v_s, displacement, delay } = self;
        [*inertia, f_v[0], f_v[1], f_c[0], f_c[1], f_s[0], f_s[1], *v_s, *displacement, *delay]
    }

    const fn from_values(x: [f64; UNKNOWNS]) -> Self {
        let [inertia, v0, v1, c0, c1, s0, s1, v_s, displacement, delay] = x;
        Self { inertia, f_v: [v0, v1], f_c: [c0, c1], f_s: [s0, s1], v_s, displacement, delay }
    }
}

/// Unknowns of [`refine`].
const UNKNOWNS: usize = 10;

/// Samples at each end that relative errors leave out.
const ENDS: usize = 50;

/// `100 |measured - simulated| / |measured|` over all samples but 50 at each end \[%\].
pub fn relative_error(measured: &[f64], simulated: &[f64]) -> f64 {
    let kept = ENDS..measured.len().min(simulated.len()).saturating_sub(ENDS).max(ENDS);
    let pairs = || kept.clone().filter_map(|k| Some((measured.get(k)?, simulated.get(k)?)));
    let error: f64 = pairs().map(|(a, b)| (a - b).powi(2)).sum();
    100.0 * (error / pairs().map(|(a, _)| a * a).sum::<f64>()).sqrt()
}

/// An axis refined by its closed loop.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Refined {
    /// The axis.
    pub axis: BristleAxis,
    /// Its parameters, with errors that count the residual's correlation.
    pub estimates: Estimates,
    /// [`relative_error`] of the control signal \[%\].
    pub relative_error: f64,
    /// Whether the search was stopped before its end.
    pub stopped: bool,
}

/// What an axis is refined with.
#[derive(Debug, Clone, Copy)]
pub struct Loop<'a> {
    /// The controller.
    pub controller: CascadeController,
    /// What it was asked.
    pub task: Task<'a>,
    /// Measured control signal \[V\].
    pub control: &'a [f64],
    /// Force per volt \[N/V or N m/V\].
    pub force_per_volt: f64,
}

/// Output error: the parameters whose simulated control signal is nearest the measured one, from
/// `start`. `watch` sees the relative error after every iteration and may stop the search.
///
/// # Errors
/// [`IdentError::UnequalLengths`], [`IdentError::NoConvergence`] where the start cannot be
/// simulated.
pub fn refine(
    start: &BristleAxis,
    with: &Loop,
    watch: &mut dyn FnMut(f64) -> ControlFlow<()>,
) -> Result<Refined, IdentError> {
    let (expected, found) = (with.task.reference.len(), with.control.len());
    if expected != found {
        return Err(IdentError::UnequalLengths { channel: "the control signal", found, expected });
    }
    let scale = start.values();
    let mut problem = OutputError { with, scale };
    // Relative to the start; the scale makes the differences wide enough for a simulation.
    let mut bounds = [Bound::within(0.2, 5.0, 1e4); UNKNOWNS];
    // What starts small may grow, and a delay may vanish.
    bounds[8] = Bound::within(0.05, 20.0, 1e4);
    bounds[9] = Bound::within(0.0, 20.0, 1e4);
    let patience = Patience { sum: 1e-5, step: 1e-5, iterations: 12, broyden: true };
    let power: f64 = with.control.iter().map(|u| u * u).sum();
    let see = &mut |step: &crate::bounded::Step| watch(100.0 * (step.sum / power).sqrt());
    let minimum =
        minimise(&mut problem, &[1.0; UNKNOWNS], &bounds, &patience, see).ok_or_else(|| {
            IdentError::NoConvergence("the axis cannot be simulated from the start".to_owned())
        })?;
    let axis = problem.axis(&minimum.x);
    let stopped = minimum.ending == crate::Ending::Stopped;
    let estimates = estimates(&minimum, &scale);
    let simulated = axis.run(&with.controller, with.force_per_volt, &with.task);
    let relative_error = relative_error(with.control, &simulated.control);
    Ok(Refined { axis, estimates, relative_error, stopped })
}

/// The estimates in their own units.
fn estimates(minimum: &Minimum, scale: &[f64; UNKNOWNS]) -> Estimates {
    let mut natural = minimum.clone();
    for (j, factor) in scale.iter().enumerate() {
        natural.x[j] *= factor;
        natural.jacobian.column_mut(j).unscale_mut(*factor);
    }
    let plain = |name| ParameterId::new(name);
    let (forward, backward) =
        (|name| plain(name).side(Side::Forward), |name| plain(name).side(Side::Backward));
    let ids = [
        (plain("inertia"), "kg"),
        (forward("f_v"), "N s/m"),
        (backward("f_v"), "N s/m"),
        (forward("f_c"), "N"),
        (backward("f_c"), "N"),
        (forward("f_s"), "N"),
        (backward("f_s"), "N"),
        (plain("v_s"), "m/s"),
        (plain("presliding"), "m"),
        (plain("delay"), "s"),
    ];
    let remedy = "a motion that excites it more strongly";
    let unknowns = ids.map(|(id, unit)| Unknown { id, unit, remedy });
    Estimates::linearised(&natural, &unknowns, effective_share(natural.residuals.as_slice()))
}

struct OutputError<'a> {
    with: &'a Loop<'a>,
    scale: [f64; UNKNOWNS],
}

impl OutputError<'_> {
    fn axis(&self, x: &[f64]) -> BristleAxis {
        let mut values = self.scale;
        values.iter_mut().zip(x).for_each(|(value, x)| *value *= x);
        BristleAxis::from_values(values)
    }
}

impl Residuals for OutputError<'_> {
    fn len(&self) -> usize {
        self.with.control.len().saturating_sub(2 * ENDS)
    }

    fn residuals(&mut self, x: &[f64], out: &mut [f64]) -> bool {
        let Loop { controller, force_per_volt, task, .. } = self.with;
        let simulated = self.axis(x).run(controller, *force_per_volt, task).control;
        for ((r, a), b) in
            out.iter_mut().zip(simulated.iter().skip(ENDS)).zip(self.with.control.iter().skip(ENDS))
        {
            *r = a - b;
        }
        out.iter().all(|r| r.is_finite())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TRUTH: BristleAxis = BristleAxis {
        inertia: 95.0,
        f_v: [170.0, 240.0],
        f_c: [20.0, 21.0],
        f_s: [15.0, 24.0],
        v_s: 0.02,
        displacement: 2e-5,
        delay: 0.4e-3,
    };

    fn reference() -> Vec<f64> {
        (0..3000).map(|k| 0.03 * (1.0 - (f64::from(k) * 4e-3).cos())).collect()
    }

    fn task(reference: &[f64]) -> Task<'_> {
        Task { reference, disturbance: None, start: 0.0 }
    }

    #[test]
    fn the_simulated_positions_replay_to_the_simulated_control() {
        let reference = reference();
        let response = TRUTH.run(&CascadeController::EMPS, 35.0, &task(&reference));
        let replayed = CascadeController::EMPS.replay(&reference, &response.position);
        assert!(relative_error(&response.control, &replayed) < 1e-9);
        let worst = reference
            .iter()
            .zip(&response.position)
            .map(|(r, q)| (r - q).abs())
            .fold(0.0, f64::max);
        assert!(worst < 2e-3, "the loop follows: {worst}");
    }

    #[test]
    fn refinement_returns_to_the_axis_that_made_the_data() {
        let reference = reference();
        let made = TRUTH.run(&CascadeController::EMPS, 35.0, &task(&reference));
        let with = Loop {
            controller: CascadeController::EMPS,
            task: task(&reference),
            control: &made.control,
            force_per_volt: 35.0,
        };
        let start = BristleAxis {
            inertia: 92.0,
            f_v: [150.0, 260.0],
            f_c: [22.0, 20.0],
            f_s: [17.0, 22.0],
            v_s: 0.025,
            displacement: 3e-5,
            delay: 0.3e-3,
        };
        let refined = refine(&start, &with, &mut |_| ControlFlow::Continue(())).unwrap();
        for (found, truth) in refined.axis.values().iter().zip(TRUTH.values()) {
            assert!((found / truth - 1.0).abs() < 0.02, "{:?}", refined.axis);
        }
        assert!(refined.relative_error < 0.05, "{}", refined.relative_error);
    }
}
