//! Nanoseconds a step of every model: the Rust side of `cargo xtask bench`.
//!
//! `step_bench STEPS [MODEL ...]` prints, for each model and scheme, the model's name, the scheme,
//! nanoseconds a step and the sum of all forces. The schemes:
//!
//! * `exact`: the fixed-step form, `Stepper::step`, in a loop that the compiler may keep the state
//!   in registers for;
//! * `rk4`: the derivative form under classical Runge-Kutta, for models with states;
//! * `known`: the fixed-step form with the state in memory between steps, as in a control loop, of
//!   a model known at compile time;
//! * `chosen`: the same behind `AnyStepper::step`, which finds the model while the program runs.
//!
//! The C side, `xtask/bench/`, does the first two with the same velocities and parameters. Time is
//! the processor's time of this thread: what other programs take is not counted.

use std::f64::consts::PI;
use std::hint::black_box;
use std::io::Write;
use std::process::ExitCode;
use std::time::Duration;

use friction_model::{
    AnyModel, AnyStepper, FrictionModel, ModelName, ModelVisitor, State, Stepper, TimeStep, rk4,
};
use rustix::time::{ClockId, clock_gettime};

const SAMPLES: usize = 4096;

type Velocities = [f64; SAMPLES];

fn main() -> ExitCode {
    let mut arguments = std::env::args().skip(1);
    let steps =
        arguments.next().and_then(|text| text.parse().ok()).filter(|&steps: &usize| steps >= 10);
    let names = arguments.map(|text| text.parse()).collect::<Result<Vec<ModelName>, _>>();
    let (Some(steps), Ok(mut names), Ok(dt)) = (steps, names, TimeStep::new(1e-3)) else {
        // Nothing is lost if nobody reads it.
        let _ =
            writeln!(std::io::stderr(), "usage: step_bench STEPS [MODEL ...] (at least 10 steps)");
        return ExitCode::from(2);
    };
    if names.is_empty() {
        names = ModelName::ALL.into();
    }
    let velocity = std::array::from_fn(|i| {
        let phase = 2.0 * PI * i as f64 / SAMPLES as f64;
        0.02 + 0.2 * (3.0 * phase).sin() + 0.01 * (41.0 * phase).sin()
    });
    for name in names {
        // Numbers that the compiler cannot know.
        let (model, dt) = (black_box(AnyModel::test_bed(name)), black_box(dt));
        model.visit(Measure { dt, velocity: &velocity, steps, chosen: model.start(dt) });
    }
    ExitCode::SUCCESS
}

struct Measure<'a> {
    dt: TimeStep,
    velocity: &'a Velocities,
    steps: usize,
    chosen: AnyStepper,
}

impl ModelVisitor for Measure<'_> {
    type Output = ();

    fn visit<M: FrictionModel>(self, model: M) {
        let Self { dt, velocity, steps, mut chosen } = self;
        let mut state = model.rest();
        if size_of_val(&state) > 0 {
            measure("rk4", M::NAME, steps, |steps| {
                run_rk4(&model, &mut state, velocity, dt.seconds(), steps)
            });
        }
        let mut stepper = Stepper::new(model, dt);
        measure("exact", M::NAME, steps, |steps| run_exact(&mut stepper, velocity, steps));
        stepper.reset();
        let known = |steps| run_known(&mut stepper, velocity, steps);
        let chosen = |steps| run_chosen(&mut chosen, velocity, steps);
        measure_in_turns(["known", "chosen"], M::NAME, steps, known, chosen);
    }
}

/// A first pass of a tenth of the steps, from which the state goes on, warms caches and clock.
fn measure(scheme: &str, name: &str, steps: usize, mut run: impl FnMut(usize) -> f64) {
    let warm = run(steps / 10);
    let (time, sum) = timed(|| run(steps));
    print(scheme, name, steps, time, warm + sum);
}

/// The same for two schemes that differ by little: in turns of a tenth of the steps.
fn measure_in_turns(
    schemes: [&str; 2],
    name: &str,
    steps: usize,
    mut a: impl FnMut(usize) -> f64,
    mut b: impl FnMut(usize) -> f64,
) {
    let turn = steps / 10;
    let mut sums = [a(turn), b(turn)];
    let mut times = [Duration::ZERO; 2];
    for _ in 0..10 {
        let turns = [timed(|| a(turn)), timed(|| b(turn))];
        for ((time, sum), (total_time, total_sum)) in
            turns.into_iter().zip(times.iter_mut().zip(&mut sums))
        {
            *total_time += time;
            *total_sum += sum;
        }
    }
    for ((scheme, time), sum) in schemes.into_iter().zip(times).zip(sums) {
        print(scheme, name, 10 * turn, time, sum);
    }
}

fn timed(run: impl FnOnce() -> f64) -> (Duration, f64) {
    let start = processor_time();
    let sum = run();
    (processor_time() - start, sum)
}

fn print(scheme: &str, name: &str, steps: usize, time: Duration, sum: f64) {
    let nanoseconds = time.as_secs_f64() / steps as f64 * 1e9;
    // A closed pipe shows in the reader.
    let _ = writeln!(std::io::stdout(), "{name} {scheme} {nanoseconds:.4} {sum:.17e}");
}

/// Processor time of this thread.
fn processor_time() -> Duration {
    clock_gettime(ClockId::ThreadCPUTime).try_into().unwrap_or_default()
}

#[inline(never)]
fn run_exact<M: FrictionModel>(
    stepper: &mut Stepper<M>,
    velocity: &Velocities,
    steps: usize,
) -> f64 {
    (0..steps).fold(0.0, |sum, k| sum + stepper.step(velocity[k % SAMPLES]))
}

#[inline(never)]
fn run_known<M: FrictionModel>(
    stepper: &mut Stepper<M>,
    velocity: &Velocities,
    steps: usize,
) -> f64 {
    (0..steps).fold(0.0, |sum, k| sum + black_box(&mut *stepper).step(velocity[k % SAMPLES]))
}

#[inline(never)]
fn run_chosen(stepper: &mut AnyStepper, velocity: &Velocities, steps: usize) -> f64 {
    (0..steps).fold(0.0, |sum, k| sum + black_box(&mut *stepper).step(velocity[k % SAMPLES]))
}

/// The samples are half a step apart: Runge-Kutta asks for the middle of a step too.
#[inline(never)]
fn run_rk4<M: FrictionModel>(
    model: &M,
    state: &mut State<M::Continuous, M::Memory>,
    velocity: &Velocities,
    dt: f64,
    steps: usize,
) -> f64 {
    (0..steps).fold(0.0, |sum, k| {
        let v = [0, 1, 2].map(|i| velocity[(2 * k + i) % SAMPLES]);
        sum + rk4::step(model, state, v, dt)
    })
}
