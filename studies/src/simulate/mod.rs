//! Any model along any motion: the force and the inner quantities as a table.
//!
//! Between two rows of the motion the velocity is a straight line, and the step between them is
//! divided into equal parts no longer than the step asked for. A row of the result holds the force
//! at the row's time and velocity, with the state that the contact has reached by then, before it
//! moves on; the first row starts at rest and unloaded. The inner quantities are those of the same
//! moment.

mod refusal;
mod runge_kutta;
mod table;

use std::io::Write;

use friction_model::{
    AnyModel, FrictionModel, MAX_SPEED, ModelName, ModelVisitor, Range, TimeStep,
};

pub use self::refusal::{SimulateError, Stopped};
pub use self::runge_kutta::Halvings;
use self::runge_kutta::{Integration, Stiff};
use self::table::{Csv, Table};
pub use self::table::{InMemory, Rows};
use recording::trajectory::Point;
use recording::{AxisKind, RecordingError};

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
    /// halved until two halves lead to what the whole does
    Rk4,
}

/// Whether steps of Runge and Kutta can be held to a tolerance: a model that draws at random when a
/// step is accepted is another one with other steps.
#[must_use]
pub fn holds_a_tolerance(model: &AnyModel) -> bool {
    model.name() != ModelName::Bristle
}

/// How to simulate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// How the states advance.
    pub scheme: Scheme,
    /// Longest step \[s\].
    pub dt: f64,
    /// Error that a step of Runge and Kutta may have: in each state and the deflection relative to
    /// the largest magnitude so far, in the level and the force relative to their own, in the
    /// force at least to the level.
    pub tolerance: f64,
    /// Growth of every level with the load, relative to the level \[1/(N m) or 1/N\]; see
    /// [`friction_model::load_dependent`].
    pub load_gain: Option<f64>,
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

/// A motion on its way.
#[derive(Debug)]
pub struct Motion<P> {
    /// Units.
    pub axis: AxisKind,
    /// Whether its points have loads.
    pub loaded: bool,
    /// The moments of the motion, times increasing.
    pub points: P,
}

/// Evaluates `model` along the motion and writes a CSV table with one line a point of it; what was
/// done is returned. Only the point at hand and the next one stand in memory.
///
/// # Errors
/// [`Stopped`]; the table is then as long as it had become.
pub fn simulate<P>(
    model: &AnyModel,
    motion: Motion<P>,
    settings: &Settings,
    out: &mut dyn Write,
) -> Result<Done, Stopped>
where
    P: Iterator<Item = Result<Point, RecordingError>>,
{
    simulate_into(model, motion, settings, &mut Csv::new(out))
}

/// Evaluates `model` along the motion and hands over a row a point of it, as [`simulate`] does.
///
/// # Errors
/// [`Stopped`]; the rows until then were handed over.
pub fn simulate_into<P>(
    model: &AnyModel,
    motion: Motion<P>,
    settings: &Settings,
    out: &mut dyn Rows,
) -> Result<Done, Stopped>
where
    P: Iterator<Item = Result<Point, RecordingError>>,
{
    settings.check()?;
    if settings.load_gain.is_some() && !motion.loaded {
        return Err(SimulateError::NoLoad.into());
    }
    let mut path = Path { points: motion.points, before: None, dt: settings.dt };
    let Some(first) = path.next()? else { return Ok(Done::default()) };
    let units = motion.axis;
    let tolerance = holds_a_tolerance(model).then_some(settings.tolerance);
    model.visit(Simulation { first, path, units, settings: *settings, tolerance, out })
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

/// The points of a motion, each looked at before anything is computed along it.
struct Path<P> {
    points: P,
    /// Time of the last one \[s\].
    before: Option<f64>,
    dt: f64,
}

/// Most steps between two points: a step so short is a slip of the pen, and nothing would be seen
/// of the result for a minute.
const MOST_STEPS: f64 = 1e9;

impl<P: Iterator<Item = Result<Point, RecordingError>>> Path<P> {
    fn next(&mut self) -> Result<Option<Point>, Stopped> {
        let Some(point) = self.points.next().transpose()? else { return Ok(None) };
        let Point { time, velocity, .. } = point;
        if velocity.abs() > MAX_SPEED {
            return Err(SimulateError::TooFast { time, velocity }.into());
        }
        let (duration, dt) = (time - self.before.replace(time).unwrap_or(time), self.dt);
        let steps = duration / dt;
        if steps > MOST_STEPS {
            return Err(SimulateError::TooLong { duration, dt, steps }.into());
        }
        Ok(Some(point))
    }
}

struct Simulation<'a, P> {
    first: Point,
    path: Path<P>,
    units: AxisKind,
    settings: Settings,
    /// None where no steps of Runge and Kutta hold one.
    tolerance: Option<f64>,
    out: &'a mut dyn Rows,
}

impl<P: Iterator<Item = Result<Point, RecordingError>>> ModelVisitor for Simulation<'_, P> {
    type Output = Result<Done, Stopped>;

    fn visit<M: FrictionModel>(self, model: M) -> Self::Output {
        match self.settings.scheme {
            Scheme::Rk4 => self.rk4(&model),
            Scheme::Mean => self.mean(&model),
            Scheme::Held => self.held(&model),
        }
    }
}

impl<P: Iterator<Item = Result<Point, RecordingError>>> Simulation<'_, P> {
    fn rk4<M: FrictionModel>(mut self, model: &M) -> Result<Done, Stopped> {
        let Settings { dt, tolerance, load_gain, .. } = self.settings;
        // A model that holds at rest has no states, and no force that a velocity would tell there.
        let holds = model.holding(0.0).is_some();
        let mut going = Integration::at_rest(model, self.tolerance);
        let mut table = Table::new(model, &going.state, self.units, load_gain, self.out);
        let mut here = self.first;
        loop {
            let v = here.velocity;
            let force = if holds { model.steady_state(v) } else { model.force(&going.state, v) };
            table.row(model, here, &going.state, force)?;
            let Some(next) = self.path.next()? else { break };
            let way = Way { from: here, to: next };
            let (steps, h) = way.division(dt);
            let at = |step: u64| way.velocity(step as f64 / steps as f64);
            for step in 0..steps {
                let stiff = |Stiff { part, shortest }| SimulateError::Stiff {
                    time: here.time + (step as f64 + part) * h,
                    dt: h,
                    shortest: h * shortest,
                    tolerance,
                };
                going.advance(h, [at(step), at(step + 1)]).map_err(stiff)?;
            }
            here = next;
        }
        table.finish(going.done)
    }

    fn mean<M: FrictionModel>(mut self, model: &M) -> Result<Done, Stopped> {
        let Settings { dt, load_gain, .. } = self.settings;
        let mut state = model.rest();
        let mut fixed = Fixed::new(model, dt)?;
        let mut table = Table::new(model, &state, self.units, load_gain, self.out);
        let mut here = self.first;
        loop {
            table.row(model, here, &state, model.force(&state, here.velocity))?;
            let Some(next) = self.path.next()? else { break };
            let way = Way { from: here, to: next };
            let (steps, h) = way.division(dt);
            let discrete = fixed.of(model, h)?;
            let mut from = here.velocity;
            for step in 1..=steps {
                let to = way.velocity(step as f64 / steps as f64);
                model.advance(discrete, &mut state, from, to);
                from = to;
            }
            here = next;
        }
        table.finish(Halvings::default())
    }

    fn held<M: FrictionModel>(mut self, model: &M) -> Result<Done, Stopped> {
        let Settings { dt, load_gain, .. } = self.settings;
        let mut state = model.rest();
        let mut fixed = Fixed::new(model, dt)?;
        let mut table = Table::new(model, &state, self.units, load_gain, self.out);
        let mut here = self.first;
        loop {
            let before = state.clone();
            let next = self.path.next()?;
            let way = next.map(|to| Way { from: here, to });
            let (steps, h) = way.map_or((1, fixed.h), |way| way.division(dt));
            let discrete = fixed.of(model, h)?;
            let force = model.step(discrete, &mut state, here.velocity);
            table.row(model, here, &before, force)?;
            let Some(way) = way else { break };
            for step in 1..steps {
                model.step(discrete, &mut state, way.velocity(step as f64 / steps as f64));
            }
            here = way.to;
        }
        table.finish(Halvings::default())
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

/// From one point to the next.
#[derive(Debug, Clone, Copy)]
struct Way {
    from: Point,
    to: Point,
}

impl Way {
    /// Number and length of equal steps, none longer than `dt`.
    fn division(self, dt: f64) -> (u64, f64) {
        let distance = self.to.time - self.from.time;
        // Times are rounded: a step too long by a billionth is none too many.
        let steps = (distance / dt * (1.0 - 1e-9)).ceil().max(1.0);
        (steps as u64, (distance / steps).min(dt))
    }

    /// The velocity at this part of the way.
    fn velocity(self, part: f64) -> f64 {
        self.from.velocity + (self.to.velocity - self.from.velocity) * part
    }
}

#[cfg(test)]
mod tests;
#[cfg(test)]
mod whole_range;
