//! What strangers and a commander that went wrong may do to the motor: each row of
//! [`ros_node::hostile`] that is the driver's.

use ros_node::{
    hostile::{self, Effect},
    one_writer::{OneWriter, Verdict, WriterId},
};

use friction_model::TorqueSource;

use super::*;
use crate::{
    SimulatedRig, SimulationOptions, node::torque_estimate::TorqueEstimate, safety::SafetyLimits,
};

const ONE: WriterId = WriterId([1; 16]);
const OTHER: WriterId = WriterId([2; 16]);
const MS: u64 = 1_000_000;
const EPOCH: u64 = 1_700_000_000_000 * MS;
const CYCLES: u64 = 900;
/// Cycles in which the hostile input comes.
const HOSTILE: std::ops::Range<u64> = 100..700;

/// Observer and controller in the same process.
struct InMemory;

impl InCycle for InMemory {
    fn answer(&mut self, _: &BegunCycle) -> Option<f64> {
        Some(1.0)
    }

    fn end(&mut self, _: EndedCycle) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}

/// What came of a run.
#[derive(Debug, PartialEq)]
struct Run {
    /// Voltage on the motor in each cycle [V], to the bit.
    voltages: Vec<u64>,
    state: State,
    highest: f64,
}

/// The way of a message from the subscription to the motor, cycle by cycle: who sent it, its stamp,
/// its place in the queue, the supervisor.
fn run(
    in_memory: bool,
    mut hostile: impl FnMut(u64, u64) -> Vec<(WriterId, VoltageCommand)>,
    commands: bool,
) -> Run {
    let options = SimulationOptions::default();
    let rig: Box<dyn Rig + Send> =
        Box::new(SimulatedRig::new(options, friction_model::Proposed::test_bed()).unwrap());
    let limits = SafetyLimits::for_simulation(&options);
    let rig = Supervised::new(rig, limits).unwrap();
    let torque = TorqueEstimate::new(TorqueSource::Sensor, options.drive, options.period, 0.01);
    let in_cycle = in_memory.then(|| Box::new(InMemory) as Box<dyn InCycle>);
    let nobody = Waker::default();
    let ((mut to_motor, commands_in), (_requests, requests)) =
        (queue(COMMANDS, &nobody), queue(REQUESTS, &nobody));
    let ((answers, _answers), (cycles, _cycles)) = (queue(REQUESTS, &nobody), queue(4, &nobody));
    let given = Given::new(remembered(&rig));
    let mut task = Task {
        work: Work { rig, torque, in_cycle, station: Arc::default() },
        given,
        in_memory: false,
        commands: commands_in,
        requests,
        answers,
        cycles,
        stop: Arc::default(),
        counters: Arc::default(),
    };
    let mut one = OneWriter::new(None);
    let mut newest = 0;
    let (mut voltages, mut highest) = (Vec::new(), 0.0f64);
    task.work.rig.request(Request::Configure).unwrap();
    for cycle in 0..CYCLES {
        let (now, stamp_ns) = (cycle as f64 * 1e-3, EPOCH + cycle * MS);
        task.work.rig.tell_time(now);
        let seen = task.work.rig.measure();
        voltages.push(seen.voltage_applied.to_bits());
        highest = highest.max(seen.voltage_applied.abs());
        if cycle == 50 {
            one.open(cycle * MS).unwrap();
            task.work.rig.request(Request::Activate).unwrap();
        }
        task.given.note(stamp_ns);
        // A voltage answers the measurement of the cycle before.
        let genuine = (ONE, command(stamp_ns - MS, 1.0));
        let strange = if HOSTILE.contains(&cycle) { hostile(cycle, stamp_ns) } else { Vec::new() };
        let sent = (commands || !HOSTILE.contains(&cycle)).then_some(genuine);
        for (writer, command) in sent.into_iter().filter(|_| cycle > 50).chain(strange) {
            if let Verdict::Taken { .. } = one.hear(writer, cycle * MS) {
                to_motor.send(VoltageCommand { came_ns: cycle * MS, ..command });
            }
        }
        if let Some(inner) = &mut task.work.in_cycle {
            let state = task.work.rig.supervisor().state();
            let begun = BegunCycle { stamp_ns, measurement: seen, effort: 0.0, state };
            let volts = inner.answer(&begun).unwrap();
            task.work.rig.command(now, volts);
            task.in_memory = true;
        }
        task.take_commands(&mut newest, Moment { start_ns: cycle * MS, stamp_ns, now });
        task.work.rig.drive().unwrap();
    }
    Run { voltages, state: task.work.rig.supervisor().state(), highest }
}

fn command(stamp_ns: u64, volts: f64) -> VoltageCommand {
    VoltageCommand { stamp_ns, volts, came_ns: 0 }
}

/// What a row's input does, beside a commander that asks for one volt.
fn effect(input: &str, from: &str) -> Effect {
    let mine = from != "another";
    let who = if mine { ONE } else { OTHER };
    let quiet = run(false, |_, _| Vec::new(), true);
    let quiet_in_memory = run(true, |_, _| Vec::new(), false);
    assert_eq!((quiet.state, quiet_in_memory.state), (State::Active, State::Active));
    assert!(quiet.highest > 0.9 && quiet.highest < 1.1);
    let judged = |done: Run, quiet: &Run| {
        if done == *quiet {
            Effect::Dropped
        } else if done.state == State::Faulted && done.highest < 1.1 {
            Effect::Stops
        } else if done.state == State::Active && done.highest <= 6.0 + 0.0025 && mine {
            Effect::Limited
        } else {
            panic!("`{input}` from {from} moves the motor: {} V, {}", done.highest, done.state)
        }
    };
    match input {
        "a voltage, whatever its stamp" => {
            let stamps = |stamp: u64| [0, 1, stamp, stamp - MS, stamp + 10_000 * MS, u64::MAX];
            let all = |_, stamp| stamps(stamp).map(|stamp| (who, command(stamp, 6.0))).to_vec();
            judged(run(false, all, true), &quiet)
        }
        "a voltage that is no number" => {
            let bad = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY];
            let all = |_, stamp| bad.map(|volts| (who, command(stamp, volts))).to_vec();
            judged(run(false, all, true), &quiet)
        }
        "a voltage beyond the limit" => {
            judged(run(false, |_, stamp| vec![(who, command(stamp, 1e308))], true), &quiet)
        }
        "a voltage with a stamp from the future" => {
            let all = |_, stamp| {
                vec![(who, command(stamp + 1, 6.0)), (who, command(stamp + 10_000 * MS, 6.0))]
            };
            judged(run(false, all, true), &quiet)
        }
        "a voltage with a stamp of no measurement" => {
            let all = |_, stamp| {
                vec![(who, command(stamp - 1, 6.0)), (who, command(stamp - MS + 1, -6.0))]
            };
            judged(run(false, all, true), &quiet)
        }
        "a voltage older than command_lost" => {
            let all =
                |_, stamp| vec![(who, command(1, 6.0)), (who, command(stamp - 501 * MS, 6.0))];
            judged(run(false, all, true), &quiet)
        }
        "no voltage for command_lost" => judged(run(false, |_, _| Vec::new(), false), &quiet),
        "a voltage before the activation" => {
            let mut one = OneWriter::new(None);
            match one.hear(ONE, 0) {
                Verdict::Closed => Effect::Unheard,
                verdict => panic!("{verdict:?}"),
            }
        }
        "voltages of two within half a second before an activation" => {
            let mut one = OneWriter::new(None);
            one.hear(ONE, 0);
            one.hear(OTHER, 499 * MS);
            assert!(one.open(499 * MS).is_err());
            Effect::Refused
        }
        "any voltage while the controller in the same process (`live`) commands" => {
            let bad = [6.0, -6.0, f64::NAN, f64::INFINITY, 1e308];
            let all = |_, stamp| bad.map(|volts| (OTHER, command(stamp, volts))).to_vec();
            judged(run(true, all, false), &quiet_in_memory)
        }
        other => panic!("no test gives `{other}` to the logic"),
    }
}

#[test]
fn every_hostile_input_does_what_the_table_says_and_none_moves_the_motor() {
    for row in hostile::of("rig_driver") {
        assert_eq!(effect(row.input, row.from), row.effect, "{row:?}");
    }
}
