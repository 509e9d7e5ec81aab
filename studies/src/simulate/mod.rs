//! Any model along any motion: the force and the inner quantities as a table.
//!
//! Between two rows of the motion the velocity is a straight line, and the step between them is
//! divided into equal parts no longer than the step asked for. A row of the result holds the force
//! at the row's time and velocity, with the state that the contact has reached by then, before it
//! moves on; the first row starts at rest and unloaded. The inner quantities are those of the same
//! moment.

mod runge_kutta;
mod table;

use friction_model::{AnyModel, FrictionModel, MAX_SPEED, ModelVisitor, Range, TimeStep};

pub use self::runge_kutta::Halvings;
use self::runge_kutta::{Integration, Stiff};
use self::table::Table;
use recording::trajectory::Trajectory;

/// How the states advance.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, clap::ValueEnum)]
pub enum Scheme {
    /// The model's fixed-step form under the mean velocity of each step: of second order where the
    /// model has no jumps, and stable for every model; steps up to 10 ms
    #[default]
    Mean,
    /// The fixed-step form with the velocity held over each step, as a loop runs it that knows no
    /// more: of first order, and stable for every model; steps up to 10 ms
    Held,
    /// The derivative form with the classical Runge-Kutta method of fourth order: each step is
    /// halved until its error holds the tolerance
    Rk4,
}

/// How to simulate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// How the states advance.
    pub scheme: Scheme,
    /// Longest step \[s\].
    pub dt: f64,
    /// Error that a step of Runge and Kutta may have, relative to the largest magnitude of each
    /// state.
    pub tolerance: f64,
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
    /// A tolerance that is none.
    #[error("--tolerance must lie between 1e-12 and 0.1, but is {0}")]
    Tolerance(f64),
    /// A velocity that no model is asked for.
    #[error(
        "the velocity is {velocity} at {time} s, but at most {MAX_SPEED:e} either way is accepted; look at the unit of the column"
    )]
    TooFast {
        /// When \[s\].
        time: f64,
        /// The velocity there.
        velocity: f64,
    },
    /// No step of Runge and Kutta holds the tolerance.
    #[error(
        "at {time} s no step holds the tolerance of {tolerance}: {dt} s was halved as often as it may be (to {shortest:.1e} s). The model is too stiff there for --scheme rk4; use --scheme mean, a shorter --dt or a larger --tolerance"
    )]
    Stiff {
        /// When \[s\].
        time: f64,
        /// Longest step \[s\].
        dt: f64,
        /// The shortest that was tried \[s\].
        shortest: f64,
        /// The tolerance.
        tolerance: f64,
    },
    /// A number of the result is none.
    #[error("the {what} is {value} at {time} s: these parameters cannot be evaluated there")]
    NotFinite {
        /// Which number.
        what: &'static str,
        /// What came.
        value: f64,
        /// When \[s\].
        time: f64,
    },
}

/// What was done.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Done {
    /// Rows of the result.
    pub rows: u64,
    /// Rows on which the contact stands still and a velocity does not tell what it holds: they
    /// have the force 0.
    pub held: u64,
    /// What happened to the steps of Runge and Kutta.
    pub halvings: Halvings,
}

/// Evaluates `model` along the motion and returns a CSV table with one line a row of it, and what
/// was done. `tick` is called with the seconds of motion that were done since its last call.
///
/// # Errors
/// [`SimulateError`].
pub fn simulate(
    model: &AnyModel,
    motion: &Trajectory,
    settings: &Settings,
    tick: &mut dyn FnMut(f64),
) -> Result<(String, Done), SimulateError> {
    let Settings { dt, load_gain, .. } = *settings;
    settings.check()?;
    let load = match (load_gain, &motion.load) {
        (None, _) => None,
        (Some(_), None) => return Err(SimulateError::NoLoad),
        (Some(gain), Some(load)) => Some((gain, load.as_slice())),
    };
    let mut rows = motion.time.iter().zip(&motion.velocity);
    if let Some((&time, &velocity)) = rows.find(|(_, velocity)| velocity.abs() > MAX_SPEED) {
        return Err(SimulateError::TooFast { time, velocity });
    }
    let duration = motion.duration();
    let steps = duration / dt;
    if steps > 1e11 {
        return Err(SimulateError::TooLong { duration, dt, steps });
    }
    model.visit(Simulation { motion, settings: *settings, load, tick })
}

impl Settings {
    fn check(&self) -> Result<(), SimulateError> {
        let Self { scheme, dt, tolerance, load_gain } = *self;
        let expected = match scheme {
            Scheme::Mean | Scheme::Held if TimeStep::new(dt).is_err() => {
                Some("above 0 and at most 0.01 s with --scheme mean and held")
            }
            Scheme::Rk4 if !(dt > 0.0 && dt.is_finite()) => Some("a finite number above zero"),
            _ => None,
        };
        if let Some(expected) = expected {
            return Err(SimulateError::Step { expected, dt });
        }
        if !(1e-12..=0.1).contains(&tolerance) {
            return Err(SimulateError::Tolerance(tolerance));
        }
        match load_gain {
            Some(gain) if !Range::NonNegative.holds(gain) => Err(SimulateError::LoadGain(gain)),
            _ => Ok(()),
        }
    }
}

struct Simulation<'a> {
    motion: &'a Trajectory,
    settings: Settings,
    /// The gain, and the load of each row.
    load: Option<(f64, &'a [f64])>,
    tick: &'a mut dyn FnMut(f64),
}

impl ModelVisitor for Simulation<'_> {
    type Output = Result<(String, Done), SimulateError>;

    fn visit<M: FrictionModel>(self, model: M) -> Self::Output {
        match self.settings.scheme {
            Scheme::Rk4 => self.rk4(&model),
            Scheme::Mean => self.mean(&model),
            Scheme::Held => self.held(&model),
        }
    }
}

impl Simulation<'_> {
    fn rk4<M: FrictionModel>(mut self, model: &M) -> Result<(String, Done), SimulateError> {
        let Settings { dt, tolerance, .. } = self.settings;
        // A model that holds at rest has no states, and no force that a velocity would tell there.
        let holds = model.holding(0.0).is_some();
        let mut going = Integration::at_rest(model, tolerance);
        let mut table = Table::new(model, &going.state, self.motion.axis, self.load);
        let mut done = 0.0;
        for (row, (&t, &v)) in self.motion.time.iter().zip(&self.motion.velocity).enumerate() {
            let force = if holds { model.steady_state(v) } else { model.force(&going.state, v) };
            table.row(model, row, [t, v], &going.state, force)?;
            let Some(next) = self.next(row) else { break };
            let (steps, h) = next.division(t, dt);
            for step in 0..steps {
                let at = |part: f64| next.between(v, (step as f64 + part) / steps as f64);
                going.advance(h, at).map_err(|Stiff { part, shortest }| SimulateError::Stiff {
                    time: t + (step as f64 + part) * h,
                    dt: h,
                    shortest: h * shortest,
                    tolerance,
                })?;
            }
            self.report(&mut done, next.time - t);
        }
        Ok(table.finish(going.done))
    }

    fn mean<M: FrictionModel>(mut self, model: &M) -> Result<(String, Done), SimulateError> {
        let mut state = model.rest();
        let mut fixed = Fixed::new(model, self.settings.dt)?;
        let mut table = Table::new(model, &state, self.motion.axis, self.load);
        let mut done = 0.0;
        for (row, (&t, &v)) in self.motion.time.iter().zip(&self.motion.velocity).enumerate() {
            table.row(model, row, [t, v], &state, model.force(&state, v))?;
            let Some(next) = self.next(row) else { break };
            let (steps, h) = next.division(t, self.settings.dt);
            let discrete = fixed.of(model, h)?;
            let mut from = v;
            for step in 1..=steps {
                let to = next.between(v, step as f64 / steps as f64);
                model.advance(discrete, &mut state, from, to);
                from = to;
            }
            self.report(&mut done, next.time - t);
        }
        Ok(table.finish(Halvings::default()))
    }

    fn held<M: FrictionModel>(mut self, model: &M) -> Result<(String, Done), SimulateError> {
        let mut state = model.rest();
        let mut fixed = Fixed::new(model, self.settings.dt)?;
        let mut table = Table::new(model, &state, self.motion.axis, self.load);
        let mut done = 0.0;
        for (row, (&t, &v)) in self.motion.time.iter().zip(&self.motion.velocity).enumerate() {
            let before = state.clone();
            let next = self.next(row);
            let (steps, h) = next.map_or((1, fixed.h), |next| next.division(t, self.settings.dt));
            let discrete = fixed.of(model, h)?;
            let force = model.step(discrete, &mut state, v);
            table.row(model, row, [t, v], &before, force)?;
            let Some(next) = next else { break };
            for step in 1..steps {
                model.step(discrete, &mut state, next.between(v, step as f64 / steps as f64));
            }
            self.report(&mut done, next.time - t);
        }
        Ok(table.finish(Halvings::default()))
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

/// The coefficients of the fixed-step form, computed again where the step changes.
struct Fixed<D> {
    h: f64,
    discrete: D,
}

impl<D> Fixed<D> {
    fn new<M: FrictionModel<Discrete = D>>(model: &M, h: f64) -> Result<Self, SimulateError> {
        let refused = |_| SimulateError::Step { expected: "above zero", dt: h };
        Ok(Self { h, discrete: model.discretise(TimeStep::new(h).map_err(refused)?) })
    }

    fn of<M: FrictionModel<Discrete = D>>(
        &mut self,
        model: &M,
        h: f64,
    ) -> Result<&D, SimulateError> {
        if h != self.h {
            *self = Self::new(model, h)?;
        }
        Ok(&self.discrete)
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
