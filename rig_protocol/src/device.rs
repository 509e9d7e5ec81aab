//! The device's side: what voltage the motor gets, decided once a cycle, trusting no host.

use crate::{
    Cause, DeviceMessage, Event, FaultReport, Hello, HelloError, HostMessage, Measurement, Origin,
    Readings, Rejection, Session, State, VoltageCommand, WINDOW,
};

/// Cycles between two announcements of a device that has no host.
const ANNOUNCE: u32 = 100;

/// Why a message was refused. The device goes on as before.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Refusal {
    /// The message names another session than the present one.
    OtherSession,
    /// A hello came while another session's host is alive.
    Held,
    /// A fault or an emergency stop is latched.
    Latched,
    /// A voltage came while the motor may not move.
    NotActive,
    /// The message's number is not newer than the last one's: a duplicate, a replay, or out of
    /// order.
    NotNewer,
    /// The message's number is further ahead of the last one's than [`WINDOW`].
    TooFarAhead,
    /// The command answers a measurement that is older than the command's validity.
    Stale,
    /// The command answers a measurement that was not made yet.
    FromTheFuture,
}

/// What the device itself sees in a cycle.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Inputs {
    /// The emergency stop's switch is pressed.
    pub emergency_stop: bool,
    /// A fault that the device finds in itself.
    pub fault: Option<Cause>,
}

/// What the device does in a cycle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Output {
    /// Voltage for the motor until the next cycle \[count\].
    pub voltage: i16,
    /// To be sent now: the device stopped the motor by its own decision.
    pub report: Option<FaultReport>,
    /// To be sent now: [`Device::hello`], because no host has asked since the start.
    pub announce: bool,
    /// A host has asked: the cycle's measurement is to be sent.
    pub stream: bool,
}

/// A command that was accepted.
#[derive(Debug, Clone, Copy)]
struct Held {
    sequence: u32,
    voltage: i16,
    /// Cycle that it answers.
    answers: u32,
    /// For how many cycles after that one it holds.
    cycles: u32,
    saturated: bool,
}

/// The device's state machine. One of these runs in the firmware and in the emulator.
///
/// Call [`receive`](Self::receive) for each message and [`tick`](Self::tick) once a cycle, and put
/// what it returns on the motor. The motor has zero volts unless the state is [`State::Active`] and
/// a command is valid, so it has after a restart, which begins with a new `Device`.
#[derive(Debug, Clone)]
pub struct Device {
    hello: Hello,
    state: State,
    cause: Cause,
    /// The present session.
    session: Option<Session>,
    /// Number of the hello that opened it.
    asked: Option<Session>,
    /// From which the next session's number is made.
    seed: u64,
    /// Number of the session's last message.
    sequence: u32,
    cycle: u32,
    /// The last accepted command since the activation; it may have expired.
    held: Option<Held>,
    applied: i16,
    /// Voltage of the cycle before.
    before: i16,
    expired: bool,
    refused: u16,
    foreign: u16,
    /// Cycles since the session's host was heard.
    silent: u32,
    report: Option<FaultReport>,
}

impl Device {
    /// A device that has just started: inactive, without a host.
    ///
    /// From `seed` come the numbers of its sessions. It is to be another one after each start, from
    /// noise of a converter, a generator of random numbers or a counter in non-volatile memory:
    /// then nothing that was recorded before the start counts after it.
    ///
    /// # Errors
    /// [`HelloError`] if the description breaks a rule.
    pub fn new(hello: Hello, seed: u64) -> Result<Self, HelloError> {
        hello.check()?;
        Ok(Self {
            hello: Hello { answers: None, session: None, ..hello },
            state: State::default(),
            cause: Cause::None,
            session: None,
            asked: None,
            seed,
            sequence: 0,
            cycle: 0,
            held: None,
            applied: 0,
            before: 0,
            expired: false,
            refused: 0,
            foreign: 0,
            silent: 0,
            report: None,
        })
    }

    /// The state.
    #[must_use]
    pub const fn state(&self) -> State {
        self.state
    }

    /// Number of the present cycle.
    #[must_use]
    pub const fn cycle(&self) -> u32 {
        self.cycle
    }

    /// Messages of the session refused since the start, with wrap-around.
    #[must_use]
    pub const fn refused(&self) -> u16 {
        self.refused
    }

    /// Whole frames that were not the session's, since the start, with wrap-around.
    #[must_use]
    pub const fn foreign(&self) -> u16 {
        self.foreign
    }

    /// Counts a frame that the decoder threw away, if it was whole: then it was not noise, but
    /// somebody who speaks another version.
    pub const fn reject(&mut self, rejection: &Rejection) {
        match rejection {
            Rejection::TooLong | Rejection::Framing | Rejection::Crc => {}
            Rejection::Version(_)
            | Rejection::Kind(_)
            | Rejection::Length { .. }
            | Rejection::Value(_) => {
                self.foreign = self.foreign.wrapping_add(1);
            }
        }
    }

    /// What the device says of itself, to the present session.
    #[must_use]
    pub const fn hello(&self) -> Hello {
        Hello { answers: self.asked, session: self.session, ..self.hello }
    }

    /// The present session.
    #[must_use]
    pub const fn session(&self) -> Option<Session> {
        self.session
    }

    /// Takes a message. Returns what is to be sent back at once.
    ///
    /// # Errors
    /// [`Refusal`], which changes nothing but the counts, and that the message's number is used up.
    pub fn receive(&mut self, message: &HostMessage) -> Result<Option<DeviceMessage>, Refusal> {
        let answer = self.obey(message);
        let count = match answer {
            Ok(_) => return answer,
            Err(Refusal::OtherSession | Refusal::Held) => &mut self.foreign,
            Err(_) => &mut self.refused,
        };
        *count = count.wrapping_add(1);
        answer
    }

    fn obey(&mut self, message: &HostMessage) -> Result<Option<DeviceMessage>, Refusal> {
        match *message {
            HostMessage::Hello { number } => {
                self.open(number)?;
                self.happen(Event::Hello, Cause::Deactivated);
                return Ok(Some(DeviceMessage::Hello(self.hello())));
            }
            // To stop is everybody's right.
            HostMessage::Deactivate => {
                self.happen(Event::Deactivate, Cause::Deactivated);
                return Ok(None);
            }
            HostMessage::EmergencyStop => {
                self.happen(Event::EmergencyStop, Cause::EmergencyStop);
                return Ok(None);
            }
            HostMessage::Voltage(command) => {
                self.admit(command.origin)?;
                self.hold(&command)?;
            }
            HostMessage::Heartbeat(origin) => self.admit(origin)?,
            HostMessage::Activate(origin) => {
                self.admit(origin)?;
                if matches!(self.state, State::Fault | State::EmergencyStopped) {
                    return Err(Refusal::Latched);
                }
                self.happen(Event::Activate, Cause::None);
            }
            HostMessage::Clear(origin) => {
                self.admit(origin)?;
                self.happen(Event::Clear, Cause::None);
            }
            HostMessage::Close(origin) => {
                self.admit(origin)?;
                self.happen(Event::Deactivate, Cause::Deactivated);
                (self.session, self.asked) = (None, None);
            }
        }
        // Whose message was obeyed is alive.
        self.silent = 0;
        Ok(None)
    }

    /// Opens a session, unless another host is alive.
    fn open(&mut self, number: Session) -> Result<(), Refusal> {
        let alive = self.session.is_some() && !self.is_forsaken();
        if alive && self.asked != Some(number) {
            return Err(Refusal::Held);
        }
        self.silent = 0;
        // The same hello again: its answer was lost. Session and numbers stay, so that nothing old
        // becomes new.
        if !alive {
            (self.session, self.asked, self.sequence) = (Some(self.draw()), Some(number), 0);
        }
        Ok(())
    }

    /// A session's number that no host knows in advance: SplitMix64 (Steele, Lea and Flood 2014),
    /// stirred by when hosts come.
    fn draw(&mut self) -> Session {
        loop {
            self.seed =
                self.seed.wrapping_add(0x9E37_79B9_7F4A_7C15).wrapping_add(self.cycle as u64);
            let mut mixed = self.seed;
            mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
            mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
            if let Some(session) = Session::new((mixed ^ (mixed >> 31)) as u32)
                && self.session != Some(session)
            {
                return session;
            }
        }
    }

    /// Nothing was heard from the session's host for too long.
    fn is_forsaken(&self) -> bool {
        self.silent > self.hello.cycles(self.hello.host_timeout_us)
    }

    /// Begins the next cycle: the voltage for it, and what is to be sent.
    pub fn tick(&mut self, inputs: Inputs) -> Output {
        self.cycle = self.cycle.wrapping_add(1);
        self.silent = self.silent.saturating_add(1);
        if self.state == State::Active && self.is_forsaken() {
            self.happen(Event::HostLost, Cause::HostLost);
        }
        if let Some(cause) = inputs.fault {
            self.happen(Event::Fault, cause);
        }
        if inputs.emergency_stop {
            self.happen(Event::EmergencyStop, Cause::EmergencyStop);
        }
        let valid = self.held.filter(|held| self.cycle.wrapping_sub(held.answers) <= held.cycles);
        self.before = self.applied;
        self.applied = match (self.state, valid) {
            (State::Active, Some(held)) => held.voltage,
            _ => 0,
        };
        // It stays expired until the next command: the cycle's number comes round again after 2^32
        // cycles.
        self.expired = self.held.is_some() && valid.is_none();
        if self.expired {
            self.held = self.held.map(|held| Held {
                cycles: 0,
                answers: self.cycle.wrapping_sub(1),
                ..held
            });
        }
        Output {
            voltage: self.applied,
            report: self.report.take(),
            announce: self.session.is_none() && self.cycle % ANNOUNCE == 1,
            stream: self.session.is_some(),
        }
    }

    /// The cycle's measurement of `readings`, made at the tick, at `time_us` on the device's clock.
    #[must_use]
    pub fn measurement(&self, time_us: u64, readings: Readings) -> Measurement {
        Measurement {
            cycle: self.cycle,
            time_us,
            readings,
            voltage_asked: self.held.map_or(0, |held| held.voltage),
            voltage_applied: self.before,
            session: self.session,
            command_sequence: self.held.map_or(0, |held| held.sequence),
            refused: self.refused,
            foreign: self.foreign,
            state: self.state,
            cause: self.cause,
            saturated: self.held.is_some_and(|held| held.saturated),
            expired: self.expired,
        }
    }

    /// Accepts a command, or says why not.
    fn hold(&mut self, command: &VoltageCommand) -> Result<(), Refusal> {
        if self.state != State::Active {
            return Err(Refusal::NotActive);
        }
        if newer(command.answers, self.cycle) {
            return Err(Refusal::FromTheFuture);
        }
        let cycles = self.hello.cycles(command.validity_us.min(self.hello.validity_limit_us));
        // It would be applied in the next cycle.
        if self.cycle.wrapping_add(1).wrapping_sub(command.answers) > cycles {
            return Err(Refusal::Stale);
        }
        let limit = self.hello.voltage_limit;
        let voltage = command.voltage.clamp(-limit, limit);
        self.held = Some(Held {
            sequence: command.origin.sequence,
            voltage,
            answers: command.answers,
            cycles,
            saturated: voltage != command.voltage,
        });
        Ok(())
    }

    /// Whether a message is the session's next. Its number is used up then, whatever becomes of the
    /// message.
    fn admit(&mut self, Origin { session, sequence }: Origin) -> Result<(), Refusal> {
        if self.session != Some(session) {
            return Err(Refusal::OtherSession);
        }
        match sequence.wrapping_sub(self.sequence) {
            1..=WINDOW => {
                self.sequence = sequence;
                Ok(())
            }
            0 | 0x8000_0000.. => Err(Refusal::NotNewer),
            _ => Err(Refusal::TooFarAhead),
        }
    }

    /// Follows the table. Whatever leads out of motion, or into it, forgets the command that was
    /// held.
    fn happen(&mut self, event: Event, cause: Cause) {
        let before = self.state;
        self.state = before.after(event);
        if self.state == before {
            return;
        }
        self.held = None;
        self.cause = cause;
        if matches!(event, Event::Fault | Event::EmergencyStop | Event::HostLost) {
            self.report = Some(FaultReport { cycle: self.cycle, cause, state: self.state });
        }
    }
}

/// Whether `number` comes after `than`, both with wrap-around.
const fn newer(number: u32, than: u32) -> bool {
    let ahead = number.wrapping_sub(than);
    ahead != 0 && ahead < 1 << 31
}
