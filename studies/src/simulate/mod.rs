//! Any model along any motion: the force and the inner quantities as a table.
//!
//! Between two rows of the motion the velocity is a straight line, and the step between them is
//! divided into equal parts no longer than the step asked for. A row of the result holds the force
//! at the row's time and velocity, with the state that the contact has reached by then, before it
//! moves on; the first row starts at rest and unloaded. The inner quantities are those of the same
//! moment.

mod table;

use friction_model::{AnyModel, FrictionModel, ModelVisitor, Range, TimeStep, rk4};

use self::table::Table;
use recording::trajectory::Trajectory;

/// How the states advance.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, clap::ValueEnum)]
pub enum Scheme {
    /// The model's fixed-step form, as an observer runs it in real time: the velocity is held over
    /// each step, and the step is exact where the model has a closed form. Stable for every model;
    /// steps up to 10 ms
    #[default]
    Exact,
    /// The derivative form with the classical Runge-Kutta method of fourth order: accurate, but
    /// diverges where the step is too long for a stiff model
    Rk4,
}

/// How to simulate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// How the states advance.
    pub scheme: Scheme,
    /// Longest step \[s\].
    pub dt: f64,
    /// Growth of every level with the load, relative to the level \[1/(N m) or 1/N\]; see
    /// [`friction_model::load_dependent`].
    pub load_gain: Option<f64>,
}

/// Why a model cannot be evaluated.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SimulateError {
    /// A step that the scheme does not accept.
    #[error("--dt must be {expected}, but is {dt} s")]
    Step {
        /// What was expected.
        expected: &'static str,
        /// What came \[s\].
        dt: f64,
    },
    /// A load gain that is no gain.
    #[error("--load-gain must be a finite number, zero or more, but is {0}")]
    LoadGain(f64),
    /// A load gain without loads.
    #[error(
        "--load-gain needs the load at each time, but the file has no column load_Nm or load_N"
    )]
    NoLoad,
    /// Too many steps to end within days.
    #[error(
        "{duration} s in steps of {dt} s are {steps:.1e} steps, but at most 1e11 are accepted; choose a longer --dt"
    )]
    TooLong {
        /// Duration of the motion \[s\].
        duration: f64,
        /// Longest step \[s\].
        dt: f64,
        /// Number of steps.
        steps: f64,
    },
    /// The force is no longer finite.
    #[error(
        "the force is {force} at {time} s: the step of {dt} s is too long for this model with --scheme rk4; choose a shorter --dt, or --scheme exact"
    )]
    Diverged {
        /// When \[s\].
        time: f64,
        /// The force there.
        force: f64,
        /// Longest step \[s\].
        dt: f64,
    },
}

/// Evaluates `model` along the motion and returns a CSV table with one line a row of it. `tick` is
/// called with the seconds of motion that were done since its last call.
///
/// # Errors
/// [`SimulateError`].
pub fn simulate(
    model: &AnyModel,
    motion: &Trajectory,
    settings: &Settings,
    tick: &mut dyn FnMut(f64),
) -> Result<String, SimulateError> {
    let Settings { scheme, dt, load_gain } = *settings;
    let expected = match scheme {
        Scheme::Exact if TimeStep::new(dt).is_err() => {
            Some("above 0 and at most 0.01 s with --scheme exact")
        }
        Scheme::Rk4 if !(dt > 0.0 && dt.is_finite()) => Some("a finite number above zero"),
        _ => None,
    };
    if let Some(expected) = expected {
        return Err(SimulateError::Step { expected, dt });
    }
    let load = match (load_gain, &motion.load) {
        (None, _) => None,
        (Some(gain), _) if !Range::NonNegative.holds(gain) => {
            return Err(SimulateError::LoadGain(gain));
        }
        (Some(_), None) => return Err(SimulateError::NoLoad),
        (Some(gain), Some(load)) => Some((gain, load.as_slice())),
    };
    let duration = motion.duration();
    let steps = duration / dt;
    if steps > 1e11 {
        return Err(SimulateError::TooLong { duration, dt, steps });
    }
    model.visit(Simulation { motion, scheme, dt, load, tick })
}

struct Simulation<'a> {
    motion: &'a Trajectory,
    scheme: Scheme,
    dt: f64,
    /// The gain, and the load of each row.
    load: Option<(f64, &'a [f64])>,
    tick: &'a mut dyn FnMut(f64),
}

impl ModelVisitor for Simulation<'_> {
    type Output = Result<String, SimulateError>;

    fn visit<M: FrictionModel>(self, model: M) -> Self::Output {
        match self.scheme {
            Scheme::Rk4 => self.rk4(&model),
            Scheme::Exact => self.exact(&model),
        }
    }
}

impl Simulation<'_> {
    fn rk4<M: FrictionModel>(mut self, model: &M) -> Result<String, SimulateError> {
        let mut state = model.rest();
        let mut table = Table::new(model, &state, self.motion.axis, self.load);
        let mut done = 0.0;
        for (row, (&t, &v)) in self.motion.time.iter().zip(&self.motion.velocity).enumerate() {
            let force = model.evaluate(&state.continuous, &state.memory, v).force;
            if !force.is_finite() {
                return Err(SimulateError::Diverged { time: t, force, dt: self.dt });
            }
            table.row(model, row, [t, v], &state, force);
            let Some(next) = self.next(row) else { break };
            let (steps, h) = next.division(t, self.dt);
            for step in 0..steps {
                let at = |part: f64| next.between(v, (step as f64 + part) / steps as f64);
                rk4::step(model, &mut state, [at(0.0), at(0.5), at(1.0)], h);
            }
            self.report(&mut done, next.time - t);
        }
        Ok(table.finish())
    }

    fn exact<M: FrictionModel>(mut self, model: &M) -> Result<String, SimulateError> {
        let dt = self.dt;
        let refused = |_| SimulateError::Step { expected: "above zero", dt };
        let mut state = model.rest();
        let mut h = dt;
        let mut discrete = model.discretise(TimeStep::new(h).map_err(refused)?);
        let mut table = Table::new(model, &state, self.motion.axis, self.load);
        let mut done = 0.0;
        for (row, (&t, &v)) in self.motion.time.iter().zip(&self.motion.velocity).enumerate() {
            let before = state.clone();
            let next = self.next(row);
            let (steps, step) = next.map_or((1, h), |next| next.division(t, dt));
            if step != h {
                h = step;
                discrete = model.discretise(TimeStep::new(h).map_err(refused)?);
            }
            let force = model.step(&discrete, &mut state, v);
            table.row(model, row, [t, v], &before, force);
            let Some(next) = next else { break };
            for step in 1..steps {
                model.step(&discrete, &mut state, next.between(v, step as f64 / steps as f64));
            }
            self.report(&mut done, next.time - t);
        }
        Ok(table.finish())
    }

    fn next(&self, row: usize) -> Option<Next> {
        let motion = self.motion;
        Some(Next { time: *motion.time.get(row + 1)?, velocity: *motion.velocity.get(row + 1)? })
    }

    /// Ticks for every second that is done.
    fn report(&mut self, done: &mut f64, seconds: f64) {
        *done += seconds;
        if *done >= 1.0 {
            (self.tick)(done.floor());
            *done -= done.floor();
        }
    }
}

/// The row that is approached.
#[derive(Debug, Clone, Copy)]
struct Next {
    time: f64,
    velocity: f64,
}

impl Next {
    /// Number and length of equal steps from `time`, none longer than `dt`.
    fn division(self, time: f64, dt: f64) -> (u64, f64) {
        let distance = self.time - time;
        // Times are rounded: a step too long by a billionth is none too many.
        let steps = (distance / dt * (1.0 - 1e-9)).ceil().max(1.0);
        (steps as u64, (distance / steps).min(dt))
    }

    /// The velocity at this part of the way from `velocity`.
    fn between(self, velocity: f64, part: f64) -> f64 {
        velocity + (self.velocity - velocity) * part
    }
}

#[cfg(test)]
mod tests;
