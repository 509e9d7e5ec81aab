//! Every order in which stop, transitions, clearing, faults, a slow back end and given-up requests
//! can follow each other.
//!
//! The world below is the node's logic as it is, with people and threads replaced by a list of what
//! can happen next. The search takes every entry of that list in every state that can be reached,
//! until there is no new one: exhaustive within the budgets, which bound how often people ask. All
//! shared accesses are sequentially consistent, so that orders of steps are all that can differ.

use std::{
    collections::HashSet,
    hash::{DefaultHasher, Hash, Hasher},
};

use super::{
    Checked, ClearStep, Clearing, Desk, Hands, Kind, NodePhase, Permission, Presence, Progress,
    Reason, Station, Stopped, Walk,
};
use crate::{
    Measurement, Rig, RigError,
    safety::{Fault, Request, SafetyLimits, SensorChecks, State, Supervised},
};

const PERIOD: f64 = 1e-3;

/// A motor that turns as soon as it may.
#[derive(Debug, Clone, Default)]
struct Motor {
    faulty: bool,
    /// It does not acknowledge its next emergency stop.
    deaf: bool,
    volts: f64,
}

impl Rig for Motor {
    fn period(&self) -> f64 {
        PERIOD
    }

    fn measure(&mut self) -> Measurement {
        Measurement { fault: std::mem::take(&mut self.faulty), ..Measurement::default() }
    }

    fn apply(&mut self, volts: f64) -> Result<(), RigError> {
        self.volts = volts;
        Ok(())
    }

    fn emergency_stop(&mut self) -> Result<(), RigError> {
        if std::mem::take(&mut self.deaf) { Err(RigError::Lent) } else { self.halt() }
    }
}

/// Where the control thread is in its cycle.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
enum At {
    Measure,
    Take,
    Perform(u64, Request),
    Check,
    Drive,
    Note,
}

#[derive(Debug, Clone)]
struct Thread {
    rig: Supervised<Motor>,
    at: At,
    heard: u64,
    checked: Option<Checked>,
    cycles: u32,
    ends: bool,
}

/// What is left to happen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
struct Budget {
    transitions: u8,
    stops: u8,
    clears: u8,
    faults: u8,
    give_ups: u8,
    deaf: u8,
    leaves: u8,
}

/// The rig's side of the transitions.
#[derive(Debug, Clone, Default)]
struct Bench {
    opened: bool,
    thread: Option<Thread>,
    mail: Option<(u64, Request)>,
    answer: Option<(u64, Result<(), String>)>,
}

impl Hands for Bench {
    fn open(&mut self) -> Result<(), String> {
        self.opened = true;
        Ok(())
    }

    fn start(&mut self) -> Result<(), String> {
        assert!(std::mem::take(&mut self.opened) && self.thread.is_none());
        let limits = SafetyLimits {
            cycle_lost: f64::MAX,
            motor: None,
            sensors: SensorChecks { agreement: None, torque_range: None, frozen_cycles: None },
            ..SafetyLimits::default()
        };
        let rig = Supervised::new(Motor::default(), limits).unwrap();
        self.thread =
            Some(Thread { rig, at: At::Measure, heard: 0, checked: None, cycles: 0, ends: false });
        (self.mail, self.answer) = (None, None);
        Ok(())
    }

    fn send(&mut self, number: u64, request: Request) -> Result<(), String> {
        if self.thread.is_none() {
            return Err("no rig".to_owned());
        }
        self.mail = Some((number, request));
        Ok(())
    }

    fn answer(&mut self, number: u64) -> Option<Result<(), String>> {
        self.answer.take_if(|(of, _)| *of == number).map(|(_, answer)| answer)
    }

    fn end(&mut self) {
        self.opened = false;
        if let Some(thread) = &mut self.thread {
            thread.ends = true;
        }
    }

    fn has_ended(&mut self) -> bool {
        self.thread.is_none()
    }
}

/// Who waits for a transition.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
enum For {
    Anybody,
    Clearing,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
enum Phase {
    Primary(NodePhase),
    On(Kind),
}

struct World {
    station: Station,
    phase: Phase,
    before: NodePhase,
    walk: Option<(For, Walk)>,
    bench: Bench,
    /// Presses whose answer is still to come.
    asked: Vec<u64>,
    clearing: Option<Clearing>,
    budget: Budget,
    // What people know.
    /// A stop was answered with success, and no clearing succeeded since.
    held: bool,
    /// Voltages since a press that holds.
    since_press: Option<u8>,
    /// Voltages while the node was neither active nor on its way there or back.
    at_rest: u8,
    given_up: bool,
    /// `held` when the transition took its last step.
    held_at_step: bool,
    withdrawn: u64,
    moved: bool,
    cleared: bool,
}

impl Clone for World {
    fn clone(&self) -> Self {
        let station = Station {
            latch: self.station.latch.copy(),
            permission: self.station.permission.copy(),
            desk: self.station.desk.copy(),
            ..Station::default()
        };
        station.enter(self.station.presence());
        Self {
            station,
            walk: self.walk.clone(),
            bench: self.bench.clone(),
            asked: self.asked.clone(),
            ..*self
        }
    }
}

/// One thing that can happen.
#[derive(Debug, Clone, Copy)]
enum Move {
    Ask(Kind),
    Walk,
    GiveUp,
    Thread,
    Press,
    Answer(usize),
    Clear,
    ClearOn,
    Fault,
    Deaf,
    Leave,
}

impl World {
    fn new(budget: Budget) -> Self {
        Self {
            station: Station::default(),
            phase: Phase::Primary(NodePhase::Unconfigured),
            before: NodePhase::Unconfigured,
            walk: None,
            bench: Bench::default(),
            asked: Vec::new(),
            clearing: None,
            budget,
            held: false,
            since_press: None,
            at_rest: 0,
            given_up: false,
            held_at_step: false,
            withdrawn: 0,
            moved: false,
            cleared: false,
        }
    }

    /// Everything that what comes may depend on; times are left out, because nothing here is late.
    fn key(&self) -> u64 {
        let mut hasher = DefaultHasher::new();
        let thread = self.bench.thread.as_ref().map(|thread| {
            let supervisor = thread.rig.supervisor();
            (
                (
                    supervisor.state(),
                    supervisor.latched().map(|report| report.fault),
                    thread.at,
                    thread.heard,
                ),
                (thread.checked.as_ref().map(|c| format!("{c:?}")), thread.ends, thread.cycles > 0),
                (
                    thread.rig.inner().faulty,
                    thread.rig.inner().deaf,
                    supervisor.applied() != 0.0,
                    thread.rig.may_move(),
                ),
            )
        });
        (
            (
                self.station.latch.counts(),
                self.station.permission.word(),
                self.station.desk.numbers(),
            ),
            (self.station.presence(), self.phase, self.before, &self.walk, thread),
            (
                self.bench.opened,
                self.bench.mail,
                &self.bench.answer,
                &self.asked,
                self.clearing,
                self.budget,
            ),
            (
                self.held,
                self.since_press,
                self.at_rest,
                self.given_up,
                self.held_at_step,
                self.withdrawn,
            ),
            (self.moved, self.cleared),
        )
            .hash(&mut hasher);
        hasher.finish()
    }

    fn moves(&self) -> Vec<Move> {
        let Budget { transitions, stops, clears, faults, give_ups, deaf, leaves } = self.budget;
        let mut moves = Vec::new();
        if let Phase::Primary(phase) = self.phase
            && self.walk.is_none()
            && transitions > 0
        {
            moves.extend(allowed(phase).iter().map(|kind| Move::Ask(*kind)));
        }
        if let Some((_, walk)) = &self.walk {
            moves.push(Move::Walk);
            if give_ups > 0 && walk.waits_for_an_answer() {
                moves.push(Move::GiveUp);
            }
        }
        if let Some(thread) = &self.bench.thread {
            moves.push(Move::Thread);
            if faults > 0 {
                moves.push(Move::Fault);
            }
            if deaf > 0 && !thread.rig.inner().deaf {
                moves.push(Move::Deaf);
            }
        }
        if stops > 0 {
            moves.push(Move::Press);
        }
        moves.extend((0..self.asked.len()).map(Move::Answer));
        if clears > 0 && self.clearing.is_none() {
            moves.push(Move::Clear);
        }
        if self.clearing.is_some() {
            moves.push(Move::ClearOn);
        }
        if leaves > 0 {
            moves.push(Move::Leave);
        }
        moves
    }

    fn begin(&mut self, who: For, kind: Kind) {
        if let Phase::Primary(phase) = self.phase {
            self.before = phase;
        }
        self.phase = Phase::On(kind);
        self.at_rest = if kind == Kind::Activate { 0 } else { self.at_rest };
        self.walk = Some((who, Walk::new(kind)));
    }

    fn take(&mut self, what: Move) {
        match what {
            Move::Ask(kind) => {
                self.budget.transitions -= 1;
                self.begin(For::Anybody, kind);
            }
            Move::Walk => self.walk(),
            Move::GiveUp => {
                self.budget.give_ups -= 1;
                self.given_up = true;
                if let Some((_, walk)) = &mut self.walk {
                    walk.give_up();
                }
            }
            Move::Thread => self.thread(),
            Move::Press => {
                self.budget.stops -= 1;
                let press = self.station.latch.press();
                self.asked.push(press);
                self.since_press = Some(0);
            }
            Move::Answer(index) => {
                if let Some(stopped) = self.station.stopped(self.asked[index]) {
                    let press = self.asked.remove(index);
                    // Answered after it was cleared already: then it does not hold.
                    self.held |= self.station.latch.counts()[2] < press;
                    if stopped == Stopped::NoRig {
                        assert!(self.station.latch.counts()[2] >= press || self.volts() == 0.0);
                    }
                }
            }
            Move::Clear => {
                self.budget.clears -= 1;
                self.clearing = Clearing::begin(&self.station);
            }
            Move::ClearOn => self.clear(),
            Move::Fault => {
                self.budget.faults -= 1;
                if let Some(thread) = &mut self.bench.thread {
                    thread.rig.inner_mut().faulty = true;
                }
            }
            Move::Deaf => {
                self.budget.deaf -= 1;
                if let Some(thread) = &mut self.bench.thread {
                    thread.rig.inner_mut().deaf = true;
                }
            }
            Move::Leave => {
                self.budget.leaves -= 1;
                self.station.permission.leave();
            }
        }
    }

    fn volts(&self) -> f64 {
        self.bench.thread.as_ref().map_or(0.0, |thread| thread.rig.inner().volts)
    }

    fn walk(&mut self) {
        let Some((_, walk)) = &mut self.walk else { return };
        let progress = walk.step(&self.station, &mut self.bench);
        let held = std::mem::replace(&mut self.held_at_step, self.held);
        let Progress::Done(outcome) = progress else { return };
        if outcome.is_ok() && matches!(self.phase, Phase::On(Kind::Configure | Kind::Activate)) {
            assert!(
                !held,
                "a transition succeeds although a stop was answered before its last look"
            );
        }

        if let (Err(Reason::NoAnswer { begun: false }), [last, _]) =
            (&outcome, self.station.desk.numbers())
        {
            self.withdrawn = last;
        }
        let Phase::On(kind) = self.phase else { panic!("no transition is under way") };
        let phase = match (kind, outcome.is_ok()) {
            (Kind::Configure | Kind::Deactivate, true) => NodePhase::Inactive,
            (Kind::Activate, true) => NodePhase::Active,
            (Kind::CleanUp, true) | (Kind::Configure, false) => NodePhase::Unconfigured,
            (Kind::Activate, false) => NodePhase::Inactive,
            // The node cannot say that it moves when it does not know: the rig is closed, as
            // `recover` does.
            (Kind::Deactivate | Kind::CleanUp, false) => {
                self.begin(For::Anybody, Kind::CleanUp);
                return;
            }
        };
        self.phase = Phase::Primary(phase);
        self.walk = None;
    }

    fn clear(&mut self) {
        let Some(clearing) = self.clearing else { return };
        let phase = match self.phase {
            Phase::Primary(phase) => phase,
            Phase::On(_) if matches!(self.walk, Some((For::Clearing, _))) => return,
            Phase::On(_) => NodePhase::Between,
        };
        let unseen = self.station.presence() == Presence::Running
            && !self.station.latch.was_seen(clearing.press());
        let step = clearing.step(&self.station, phase);
        assert!(!unseen || matches!(step, ClearStep::Done(Err(_))));
        let kind = match step {
            ClearStep::Deactivate => Kind::Deactivate,
            ClearStep::CleanUp => Kind::CleanUp,
            ClearStep::Done(outcome) => {
                self.clearing = None;
                if outcome.is_ok() {
                    let [pressed, seen, cleared] = self.station.latch.counts();
                    assert!(pressed == seen && seen == cleared, "cleared before it was seen");
                    (self.held, self.since_press, self.cleared) = (false, None, true);
                }
                return;
            }
        };
        self.begin(For::Clearing, kind);
    }

    fn thread(&mut self) {
        let station = &self.station;
        let Some(thread) = &mut self.bench.thread else { return };
        thread.at = match thread.at {
            At::Measure if thread.ends => {
                // The rig is dropped at zero volts, then the thread is gone.
                self.bench.thread = None;
                station.enter(Presence::Absent);
                return;
            }
            At::Measure => {
                thread.cycles += 1;
                thread.rig.tell_time(f64::from(thread.cycles) * PERIOD);
                thread.rig.measure();
                At::Take
            }
            At::Take => match self.bench.mail.take() {
                Some((number, request)) if station.desk.begin(number) => {
                    At::Perform(number, request)
                }
                _ => At::Check,
            },
            At::Perform(number, request) => {
                assert_ne!(number, self.withdrawn, "a request that was withdrawn is done");
                let answer = station.carry_out(&mut thread.rig, request);
                self.bench.answer =
                    Some((number, answer.map(drop).map_err(|error| error.to_string())));
                At::Take
            }
            At::Check => {
                let now = f64::from(thread.cycles) * PERIOD;
                thread.rig.command(now, 1.0);
                thread.checked = Some(station.check(&mut thread.rig, &mut thread.heard));
                At::Drive
            }
            At::Drive => {
                thread.rig.drive().unwrap();
                At::Note
            }
            At::Note => {
                station.note(&thread.checked.take().unwrap(), true);
                At::Measure
            }
        };
        let (at, volts) = (thread.at, thread.rig.inner().volts);
        if at == At::Note && volts != 0.0 {
            self.voltage();
        }
    }

    /// A cycle with a voltage: what must hold.
    fn voltage(&mut self) {
        self.moved = true;
        assert!(!self.held, "the motor moves after a stop was answered and before it was cleared");
        assert!(!self.station.permission.has_left() || self.budget.leaves == 0);
        if let Some(count) = &mut self.since_press {
            *count += 1;
            assert!(*count <= 1, "more than the cycle that had begun moves after a press");
        }
        if let Phase::Primary(
            NodePhase::Unconfigured | NodePhase::Inactive | NodePhase::Finalized,
        )
        | Phase::On(Kind::Configure | Kind::CleanUp) = self.phase
        {
            self.at_rest += 1;
            assert!(self.at_rest <= 1, "the motor moves while the node rests");
            // An activation that a press ends may end before the cycle that had begun.
            let cut_short =
                self.given_up || self.since_press.is_some() || self.station.permission.has_left();
            assert!(cut_short, "the node rests only after the motor does");
        }
    }
}

fn allowed(phase: NodePhase) -> &'static [Kind] {
    match phase {
        NodePhase::Unconfigured => &[Kind::Configure],
        NodePhase::Inactive => &[Kind::Activate, Kind::CleanUp],
        NodePhase::Active => &[Kind::Deactivate],
        _ => &[],
    }
}

/// What a search came across.
#[derive(Debug, Default)]
struct Found {
    states: usize,
    moved: bool,
    moved_after_clearing: bool,
    stopped_while_opening: bool,
    permission_withdrawn: bool,
}

fn search(budget: Budget) -> Found {
    let mut seen = HashSet::new();
    let mut found = Found::default();
    let mut open = vec![World::new(budget)];
    while let Some(world) = open.pop() {
        for what in world.moves() {
            let mut next = world.clone();
            let moved = next.moved;
            next.take(what);
            found.moved |= next.moved;
            found.moved_after_clearing |= next.cleared && !moved && next.moved;
            found.stopped_while_opening |=
                world.station.presence() == Presence::Opening && !world.held && next.held;
            let latched =
                next.bench.thread.as_ref().and_then(|thread| thread.rig.supervisor().latched());
            found.permission_withdrawn |=
                latched.is_some_and(|report| report.fault == Fault::PermissionWithdrawn);
            if seen.insert(next.key()) {
                open.push(next);
            }
        }
    }
    found.states = seen.len();
    found
}

const NONE: Budget =
    Budget { transitions: 0, stops: 0, clears: 0, faults: 0, give_ups: 0, deaf: 0, leaves: 0 };

/// From unconfigured to active takes two transitions; with four, or five after a clearing, every
/// way there is goes through.
#[test]
fn no_order_of_stop_transitions_and_clearing_moves_the_motor_after_the_stops_answer() {
    let found = search(Budget { transitions: 4, stops: 2, clears: 1, ..NONE });
    println!("{found:?}");
    assert!(found.moved && found.moved_after_clearing && found.stopped_while_opening, "{found:?}");
    assert!(!found.permission_withdrawn, "orderly transitions are no fault: {found:?}");
}

/// Ctrl-C ended a live run with a fault and exit code 1, where a cycle came between the node's leaving
/// and its request for rest.
#[test]
fn a_node_that_leaves_while_its_motor_is_active_is_no_fault() {
    for deaf in [0, 1] {
        let found = search(Budget { transitions: 3, stops: 1, deaf, leaves: 1, ..NONE });
        println!("{found:?}");
        assert!(found.moved && !found.permission_withdrawn, "{found:?}");
    }
}

#[test]
fn nor_with_a_fault_a_deaf_device_and_a_request_that_is_given_up() {
    for budget in [
        Budget { transitions: 3, stops: 1, clears: 1, faults: 1, give_ups: 1, ..NONE },
        Budget { transitions: 3, stops: 1, clears: 1, deaf: 1, give_ups: 1, ..NONE },
        Budget { transitions: 3, stops: 1, give_ups: 2, leaves: 1, ..NONE },
    ] {
        let found = search(budget);
        println!("{budget:?}: {found:?}");
        assert!(found.moved && found.permission_withdrawn, "{budget:?}: {found:?}");
    }
}

/// Larger budgets; minutes.
#[tests::needs(long_tier)]
#[test]
fn nor_in_longer_stories() {
    let found =
        search(Budget { transitions: 4, stops: 2, clears: 1, faults: 1, give_ups: 1, ..NONE });
    println!("{found:?}");
    assert!(found.moved_after_clearing);
}

/// The pieces that a world is copied by are those that it consists of.
#[test]
fn a_copied_station_is_the_same_and_another_one() {
    let station = Station::default();
    station.latch.press();
    assert!(station.permission.give());
    station.desk.number();
    let copy = Station {
        latch: station.latch.copy(),
        permission: station.permission.copy(),
        desk: station.desk.copy(),
        ..Station::default()
    };
    assert_eq!(copy.latch.counts(), station.latch.counts());
    assert_eq!(
        (copy.permission.word(), copy.desk.numbers()),
        (station.permission.word(), station.desk.numbers())
    );
    copy.latch.press();
    assert_eq!(station.latch.counts(), [1, 0, 0]);
    let _: (Desk, Permission, State) = (copy.desk, copy.permission, State::Active);
}
