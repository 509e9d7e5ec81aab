//! Runge and Kutta's steps, halved until what they lead to holds its tolerance.
//!
//! A step is taken whole and in two halves. Both must end with the same states, force, deflection
//! and level, and each half must hold by its own estimate. So what a model remembers is judged too,
//! and a switch that lies within a step is searched for.

use std::mem;

use friction_model::{ContinuousState, FrictionModel, State, rk4};

/// Most steps in place of one.
const MOST_STEPS: u32 = 8192;

/// A jump of the force is placed as near as this, unless 12 halvings of the step are nearer \[s\].
const NEAR: f64 = 1e-10;

/// What is left of a velocity at the end of its direction: not zero, where a contact that breaks
/// away in the same step would at once be said to stick.
const ALMOST: f64 = 1e-12;

/// How often a step is halved in any case in which the speed becomes four times what it was, or a
/// quarter: a whole Stribeck curve may lie between its stages.
const EVEN: u32 = 8;

/// What was done to the steps that were asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Halvings {
    /// Steps that were taken.
    pub taken: u64,
    /// Steps that did not hold the tolerance and were halved.
    pub halved: u64,
    /// How often the shortest of them was halved.
    pub most: u32,
    /// Steps that no halving makes hold, because the force jumps or turns within them: they are
    /// the shortest.
    pub jumps: u64,
}

/// A step that holds the tolerance at no length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Stiff {
    /// How far into the step that was asked for \[its length\].
    pub part: f64,
    /// The shortest step that was tried \[its length\].
    pub shortest: f64,
}

/// Where the switches of a model stand: more than the sixteen elements of two directions.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Switches([f64; 40]);

impl Switches {
    fn of<M: FrictionModel>(model: &M, memory: &M::Memory) -> Self {
        let mut all = Self([0.0; 40]);
        let mut places = all.0.iter_mut();
        model.switches(memory, &mut |number| {
            if let Some(place) = places.next() {
                *place = number;
            }
        });
        all
    }
}

/// Where a step led, and whether its own estimate holds.
struct Arrival<C, M> {
    state: State<C, M>,
    shown: [f64; 3],
    holds: bool,
}

/// A model on its way.
pub(super) struct Integration<'m, M: FrictionModel> {
    model: &'m M,
    pub state: State<M::Continuous, M::Memory>,
    tolerance: Option<f64>,
    /// The largest magnitude that each state has had, and the deflection.
    seen: M::Continuous,
    deflection: f64,
    /// How often the last step was halved.
    level: u32,
    pub done: Halvings,
}

impl<'m, M: FrictionModel> Integration<'m, M> {
    /// From rest; without a tolerance every step is taken as it is.
    pub fn at_rest(model: &'m M, tolerance: Option<f64>) -> Self {
        let state = model.rest();
        let seen = larger(&state.continuous, &state.continuous);
        Self { model, state, tolerance, seen, deflection: 0.0, level: 0, done: Halvings::default() }
    }

    /// Goes on by `h` \[s\], while the velocity goes straight from one value to another. Where it
    /// changes its sign a step ends: there contacts stick, and may break away again soon after.
    pub fn advance(&mut self, h: f64, [from, to]: [f64; 2]) -> Result<(), Stiff> {
        if mem::size_of::<State<M::Continuous, M::Memory>>() == 0 {
            self.done.taken += 1;
            return Ok(());
        }
        if from * to >= 0.0 {
            return self.stretch(h, [from, to]);
        }
        let turn = from / (from - to);
        let inside = |Stiff { part, shortest }: Stiff, start: f64, length: f64| Stiff {
            part: start + part * length,
            shortest: shortest * length,
        };
        self.stretch(turn * h, [from, ALMOST * from]).map_err(|stiff| inside(stiff, 0.0, turn))?;
        let rest = 1.0 - turn;
        self.stretch(rest * h, [0.0, to]).map_err(|stiff| inside(stiff, turn, rest))
    }

    /// Goes on by `h` \[s\] without a change of direction.
    fn stretch(&mut self, h: f64, [from, to]: [f64; 2]) -> Result<(), Stiff> {
        let at = |part: f64| if part < 1.0 { from + (to - from) * part } else { to };
        let Some(tolerance) = self.tolerance else {
            self.state = self.step(&self.state, h, [0.0, 1.0], &at, 1.0).state;
            self.done.taken += 1;
            return Ok(());
        };
        if h == 0.0 {
            return Ok(());
        }
        let deepest = ((h / NEAR).log2().ceil() as u32).clamp(12, 40);
        let whole = 1u64 << deepest;
        let part = |place: u64| place as f64 / whole as f64;
        self.level = self.level.min(deepest);
        let (mut place, mut tried) = (0, 0);
        while place < whole {
            let length = whole >> self.level;
            let (start, end) = (part(place), part(place + length));
            let stiff = Stiff { part: start, shortest: part(length) };
            let middle = 0.5 * (start + end);
            let once = self.step(&self.state, h, [start, end], &at, tolerance);
            let first = self.step(&self.state, h, [start, middle], &at, tolerance);
            let second = self.step(&first.state, h, [middle, end], &at, tolerance);
            let [slow, fast] = [at(start), at(end)].map(f64::abs);
            let even = self.level >= EVEN || slow.min(fast) * 4.0 >= slow.max(fast);
            let smooth = first.holds && second.holds && even;
            let agreement = self.compare(&once, &second, tolerance);
            let last = self.level == deepest;
            let holds = agreement == Agreement::All || (last && agreement != Agreement::None);
            tried += 1;
            if smooth && holds {
                self.done.jumps += u64::from(agreement != Agreement::All);
                self.seen =
                    larger(&self.seen, &larger(&first.state.continuous, &second.state.continuous));
                let [_, deflection, _] = second.shown;
                self.deflection = self.deflection.max(deflection.abs());
                self.state = second.state;
                self.done.taken += 2;
                place += length;
                // A longer one next, where it would begin at one of its own places.
                if self.level > 0 && place % (2 * length) == 0 {
                    self.level -= 1;
                }
            } else if last {
                return Err(stiff);
            } else {
                self.level += 1;
                self.done.halved += 1;
                self.done.most = self.done.most.max(self.level);
            }
            if tried > MOST_STEPS {
                return Err(stiff);
            }
        }
        Ok(())
    }

    /// A step from one part of the way to another.
    fn step(
        &self,
        state: &State<M::Continuous, M::Memory>,
        h: f64,
        [start, end]: [f64; 2],
        at: &impl Fn(f64) -> f64,
        tolerance: f64,
    ) -> Arrival<M::Continuous, M::Memory> {
        let step = h * (end - start);
        let velocities = [start, 0.5 * (start + end), end].map(at);
        let attempt = rk4::attempt(self.model, state, velocities, step);
        let mut state = State { continuous: attempt.reached, memory: state.memory.clone() };
        self.model.commit(&mut state, velocities[2], step);
        let holds = attempt.holds(&larger(&self.seen, &state.continuous), tolerance);
        let shown = shown(self.model, &state, velocities[2]);
        Arrival { state, shown, holds }
    }

    /// How far two arrivals are the same but for the tolerance.
    fn compare(
        &self,
        a: &Arrival<M::Continuous, M::Memory>,
        b: &Arrival<M::Continuous, M::Memory>,
        tolerance: f64,
    ) -> Agreement {
        let stands = |memory| Switches::of(self.model, memory);
        let before = stands(&self.state.memory);
        if [a, b].iter().any(|arrival| stands(&arrival.state.memory) != before) {
            return Agreement::Switched;
        }
        let (a_states, b_states) = (&a.state.continuous, &b.state.continuous);
        let most = larger(&self.seen, b_states);
        let apart = a_states.zip(b_states, |a, b| (a - b).abs());
        let mut states = true;
        apart.zip(&most, |apart, most| apart - tolerance * most).each(&mut |x| states &= x <= 0.0);
        let [force, deflection, level] = b.shown.map(f64::abs);
        let scales = [force.max(level), deflection.max(self.deflection), level];
        let both = a.shown.iter().zip(b.shown).zip(scales);
        let shown = both.clone().all(|((a, b), scale)| (a - b).abs() <= tolerance * scale);
        match (states, shown) {
            (false, _) => Agreement::None,
            (true, false) => Agreement::States,
            (true, true) => Agreement::All,
        }
    }
}

/// How far two ways to take a step agree.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Agreement {
    /// They do not.
    None,
    /// A switch was thrown in the step: wherever that had to be, both would say at its end.
    Switched,
    /// In the states, which never jump, but not in all that is shown.
    States,
    /// In everything.
    All,
}

/// What the table shows of a state: force, deflection and level.
fn shown<M: FrictionModel>(
    model: &M,
    state: &State<M::Continuous, M::Memory>,
    velocity: f64,
) -> [f64; 3] {
    let inner = model.internals(state, velocity);
    [model.force(state, velocity), inner.deflection, inner.gamma]
}

fn larger<C: ContinuousState>(a: &C, b: &C) -> C {
    a.zip(b, |a, b| if b.abs() > a.abs() { b.abs() } else { a.abs() })
}
