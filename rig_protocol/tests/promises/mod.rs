//! The device's promises as books of their own, written from `PROTOCOL.md` and not from the
//! device's code: which message is taken, and what voltage the motor has. Tests put the same events
//! to a device and to these books.

use rig_protocol::{
    Channels, Hello, HostMessage, Inputs, Name, Origin, Session, VoltageCommand, WINDOW,
};

/// Largest voltage \[count\].
pub const LIMIT: i16 = 1000;

/// A device with cycles of 1 ms, whose validity limit and host timeout are given in cycles.
pub fn hello(validity: u32, timeout: u32) -> Hello {
    Hello {
        answers: None,
        session: None,
        name: Name::new("test").unwrap(),
        firmware: [0, 1, 0],
        channels: Channels::default(),
        period_us: 1000,
        counts_per_turn: 4096,
        volts_per_count: 0.005,
        voltage_limit: LIMIT,
        tachometer_per_count: 0.0,
        potentiometer_per_count: 0.0,
        torque_per_count: 0.0,
        current_per_count: 0.0,
        validity_limit_us: validity * 1000,
        host_timeout_us: timeout * 1000,
    }
}

pub fn session(number: u32) -> Session {
    Session::new(number).unwrap()
}

/// The next message of a host with `session`.
pub fn of(session: Session, sequence: u32) -> Origin {
    Origin { session, sequence }
}

/// The books.
#[derive(Debug, Clone, Copy)]
pub struct Promises {
    validity: u32,
    timeout: u32,
    /// Number of the hello that opened the present session, and the session.
    pub owner: Option<(Session, Session)>,
    /// Number of the owner's last message.
    pub last: u32,
    /// Cycles since a message of the owner was obeyed.
    silent: u32,
    cycle: u32,
    pub active: bool,
    pub latched: bool,
    /// Cycles that the last accepted command still holds, and its voltage.
    held: Option<(u32, i16)>,
    /// Messages that were not the owner's.
    pub foreign: u16,
    /// Messages of the owner that were refused.
    pub refused: u16,
}

impl Promises {
    /// Of a device that has just started.
    pub fn new(validity: u32, timeout: u32) -> Self {
        Self {
            validity,
            timeout,
            owner: None,
            last: 0,
            silent: 0,
            cycle: 0,
            active: false,
            latched: false,
            held: None,
            foreign: 0,
            refused: 0,
        }
    }

    /// A message comes. Says whether it is to be obeyed. Where it is a hello, `granted` is the
    /// session that the device named.
    pub fn says(&mut self, message: &HostMessage, granted: Option<Session>) -> bool {
        let (origin, possible) = match *message {
            HostMessage::Hello { number } => return self.greeted(number, granted),
            HostMessage::Deactivate => {
                self.stop();
                return true;
            }
            HostMessage::EmergencyStop => {
                self.stop();
                self.latched = true;
                return true;
            }
            HostMessage::Voltage(VoltageCommand { origin, answers, validity_us, .. }) => {
                let age = i64::from(self.cycle) - i64::from(answers);
                let validity = i64::from(validity_us.div_ceil(1000).min(self.validity));
                (origin, self.active && age >= 0 && age < validity)
            }
            HostMessage::Activate(origin) => (origin, !self.latched),
            HostMessage::Heartbeat(origin)
            | HostMessage::Clear(origin)
            | HostMessage::Close(origin) => (origin, true),
        };
        if self.owner.map(|(_, session)| session) != Some(origin.session) {
            self.foreign += 1;
            return false;
        }
        let ahead = origin.sequence.wrapping_sub(self.last);
        let next = ahead > 0 && ahead <= WINDOW;
        if next {
            self.last = origin.sequence;
        }
        if !(next && possible) {
            self.refused += 1;
            return false;
        }
        self.silent = 0;
        match *message {
            HostMessage::Voltage(VoltageCommand { answers, voltage, validity_us, .. }) => {
                let validity = validity_us.div_ceil(1000).min(self.validity);
                self.held = Some((validity - (self.cycle - answers), voltage.clamp(-LIMIT, LIMIT)));
            }
            HostMessage::Activate(_) if !self.active => (self.active, self.held) = (true, None),
            HostMessage::Clear(_) => self.latched = false,
            HostMessage::Close(_) => {
                self.stop();
                self.owner = None;
            }
            _ => {}
        }
        true
    }

    fn greeted(&mut self, number: Session, granted: Option<Session>) -> bool {
        let alive = self.owner.filter(|_| self.silent <= self.timeout);
        match (alive, granted) {
            (Some((asked, session)), _) if asked == number => assert_eq!(granted, Some(session)),
            (Some(_), _) => {
                self.foreign += 1;
                return false;
            }
            (None, Some(granted)) => {
                assert!(
                    self.owner.is_none_or(|(_, session)| session != granted),
                    "the same session twice"
                );
                (self.owner, self.last) = (Some((number, granted)), 0);
            }
            (None, None) => panic!("a hello that nothing speaks against was not answered"),
        }
        self.silent = 0;
        self.stop();
        true
    }

    fn stop(&mut self) {
        (self.active, self.held) = (false, None);
    }

    /// A cycle begins. Returns the voltage that the motor has to have in it.
    pub fn ticks(&mut self, inputs: Inputs) -> i16 {
        self.cycle += 1;
        self.silent += 1;
        if self.silent > self.timeout {
            self.stop();
        }
        if inputs.emergency_stop || inputs.fault.is_some() {
            self.stop();
            self.latched = true;
        }
        let (left, voltage) = self.held.unwrap_or((0, 0));
        self.held = self.held.map(|_| (left.saturating_sub(1), voltage));
        if self.active && left > 0 { voltage } else { 0 }
    }
}
