//! Every sequence of events, up to a length, driven through the device: every message of its host
//! and of a stranger, fresh, replayed, stale and ahead, time that passes, faults and the switch.
//! And every single damage to the bytes of a frame.

mod promises;

use promises::{LIMIT, Promises, hello, of, session};
use rig_protocol::{
    Cause, Decoder, Device, DeviceMessage, HostMessage, Inputs, Message, Origin, Readings,
    Rejection, Session, State, VoltageCommand, WINDOW,
};

/// Cycles that a command holds at most.
const VALIDITY: u32 = 2;
/// Cycles of silence after which the host is lost.
const TIMEOUT: u32 = 3;

#[derive(Debug, Clone, Copy)]
enum Happening {
    /// A cycle.
    Cycle,
    /// As many cycles as lose the host.
    Silence,
    DriverFault,
    Switch,
    /// From the first or the second host, with a fresh number.
    Hello(u32),
    Activate(u32),
    Clear(u32),
    Close,
    Heartbeat,
    /// Fresh, of this session, answering the cycle so many before the present one.
    Command(u32, i32, i16),
    /// The last command that was sent, to the last bit.
    Replay,
    /// The last activation that was sent, to the last bit.
    ReplayedActivation,
    /// A number too far ahead.
    FarAhead,
    Deactivate,
    EmergencyStop,
    /// A frame of version 1.
    OldVersion,
}

const HAPPENINGS: [Happening; 22] = {
    use Happening::{Activate, Clear, Command, Hello};
    [
        Happening::Cycle,
        Happening::Silence,
        Happening::DriverFault,
        Happening::Switch,
        Hello(1),
        Hello(2),
        Activate(1),
        Activate(2),
        Clear(1),
        Happening::Close,
        Happening::Heartbeat,
        Command(1, 0, 500),
        Command(1, 0, i16::MIN),
        Command(1, VALIDITY as i32, 500),
        Command(1, -1, 500),
        Command(2, 0, 500),
        Happening::Replay,
        Happening::ReplayedActivation,
        Happening::FarAhead,
        Happening::Deactivate,
        Happening::EmergencyStop,
        Happening::OldVersion,
    ]
};

#[derive(Clone, Copy)]
struct Search {
    events: u64,
    driven: u64,
    path: [Happening; 16],
    length: usize,
}

/// A device, its books, and what its hosts have sent.
#[derive(Clone)]
struct Bench {
    device: Device,
    promises: Promises,
    /// The session that each of the two hosts was granted last, and the last number of its messages
    /// in it.
    hosts: [(Option<Session>, u32); 2],
    last: Option<HostMessage>,
    last_activation: Option<HostMessage>,
}

impl Bench {
    fn new() -> Self {
        Self {
            device: Device::new(hello(VALIDITY, TIMEOUT), 7).unwrap(),
            promises: Promises::new(VALIDITY, TIMEOUT),
            hosts: [(None, 0); 2],
            last: None,
            last_activation: None,
        }
    }

    fn fresh(&mut self, number: u32) -> Origin {
        let (granted, sequence) = &mut self.hosts[number as usize - 1];
        *sequence += 1;
        // Who was granted none can only guess.
        of(granted.unwrap_or(session(number)), *sequence)
    }

    /// Puts an event to the device and to the books. Says whether it changed anything.
    fn happen(&mut self, happening: Happening) -> Result<bool, String> {
        let message = match happening {
            Happening::Cycle => return self.tick(Inputs::default()),
            Happening::Silence => {
                for _ in 0..=TIMEOUT {
                    self.tick(Inputs::default())?;
                }
                return Ok(true);
            }
            Happening::DriverFault => {
                return self
                    .tick(Inputs { emergency_stop: false, fault: Some(Cause::DriverStage) });
            }
            Happening::Switch => return self.tick(Inputs { emergency_stop: true, fault: None }),
            Happening::OldVersion => {
                self.device.reject(&Rejection::Version(1));
                self.promises.foreign += 1;
                return Ok(false);
            }
            Happening::Hello(number) => HostMessage::Hello { number: session(number) },
            Happening::Activate(number) => HostMessage::Activate(self.fresh(number)),
            Happening::Clear(number) => HostMessage::Clear(self.fresh(number)),
            Happening::Close => HostMessage::Close(self.fresh(1)),
            Happening::Heartbeat => HostMessage::Heartbeat(self.fresh(1)),
            Happening::Command(number, age, voltage) => HostMessage::Voltage(VoltageCommand {
                origin: self.fresh(number),
                answers: self.device.cycle().wrapping_add_signed(-age),
                voltage,
                validity_us: 1000 * VALIDITY,
            }),
            Happening::Replay => match self.last {
                Some(message) => message,
                None => return Ok(false),
            },
            Happening::ReplayedActivation => match self.last_activation {
                Some(message) => message,
                None => return Ok(false),
            },
            Happening::FarAhead => {
                let (granted, sequence) = self.hosts[0];
                HostMessage::Activate(of(
                    granted.unwrap_or(session(1)),
                    sequence.wrapping_add(WINDOW + 2),
                ))
            }
            Happening::Deactivate => HostMessage::Deactivate,
            Happening::EmergencyStop => HostMessage::EmergencyStop,
        };
        let replayed = matches!(happening, Happening::Replay | Happening::ReplayedActivation);
        let before = (self.promises.last, self.device.state());
        let answer = self.device.receive(&message);
        let obeyed = answer.is_ok();
        let granted = match answer {
            Ok(Some(DeviceMessage::Hello(hello))) => hello.session,
            _ => None,
        };
        if obeyed != self.promises.says(&message, granted) {
            return Err(format!("obeyed: {obeyed}"));
        }
        if let (Happening::Hello(number), Some(_)) = (happening, granted) {
            let host = &mut self.hosts[number as usize - 1];
            if host.0 != granted {
                *host = (granted, 0);
            }
        }
        // What has come once is never obeyed again, whatever happened in between.
        if replayed && obeyed {
            return Err("a replayed frame was obeyed".to_owned());
        }
        match message {
            HostMessage::Voltage(_) => self.last = Some(message),
            HostMessage::Activate(_) => self.last_activation = Some(message),
            _ => {}
        }
        let after = self.device.state();
        let own = matches!(happening, Happening::Activate(1 | 2));
        if after == State::Active && before.1 != State::Active && !own {
            return Err(format!("active by {message:?}"));
        }
        self.agree()?;
        Ok(obeyed || self.promises.last != before.0)
    }

    fn tick(&mut self, inputs: Inputs) -> Result<bool, String> {
        let output = self.device.tick(inputs);
        let expected = self.promises.ticks(inputs);
        if output.voltage != expected {
            return Err(format!("{} counts, where {expected} are right", output.voltage));
        }
        if output.voltage != 0 && self.device.state() != State::Active
            || output.voltage.abs() > LIMIT
        {
            return Err(format!("{} counts in {:?}", output.voltage, self.device.state()));
        }
        self.agree()?;
        Ok(true)
    }

    fn agree(&self) -> Result<(), String> {
        let (state, promises) = (self.device.state(), &self.promises);
        let shown = self.device.measurement(0, Readings::default());
        let right = (state == State::Active) == promises.active
            && matches!(state, State::Fault | State::EmergencyStopped) == promises.latched
            && shown.session == promises.owner.map(|(_, session)| session)
            && (shown.refused, shown.foreign) == (promises.refused, promises.foreign);
        if right { Ok(()) } else { Err(format!("{shown:?} against {promises:?}")) }
    }
}

impl Search {
    /// One event, then every sequence of `left` more.
    fn follow(&mut self, bench: &Bench, left: u32) {
        for happening in HAPPENINGS {
            let mut bench = bench.clone();
            self.path[self.length] = happening;
            self.length += 1;
            self.events += 1;
            match bench.happen(happening) {
                Ok(changed) => {
                    self.driven += u64::from(
                        bench.device.measurement(0, Readings::default()).voltage_asked != 0,
                    );
                    // What changed nothing but a count is followed by what follows without it, and
                    // that is searched there.
                    if left > 0 && changed {
                        self.follow(&bench, left - 1);
                    }
                }
                Err(error) => panic!("{error}, after {:?}", &self.path[..self.length]),
            }
            self.length -= 1;
        }
    }
}

fn search(path: &[Happening], depth: u32) -> Search {
    let mut bench = Bench::new();
    let mut search =
        Search { events: 0, driven: 0, path: [Happening::Cycle; 16], length: path.len() };
    search.path[..path.len()].copy_from_slice(path);
    for happening in path {
        bench.happen(*happening).unwrap_or_else(|error| panic!("{error} in {path:?}"));
    }
    search.follow(&bench, depth - 1);
    search
}

/// From the start seven events, with FRICTION_FULL eight; from a motor that turns, and after a
/// change of hosts, one less.
#[test]
fn no_sequence_of_events_gives_the_motor_a_voltage_that_it_may_not_have() {
    use Happening::{Activate, Command, Cycle, Hello};
    let depth = if std::env::var_os("FRICTION_FULL").is_some() { 8 } else { 7 };
    let start = search(&[], depth);
    let turning = search(&[Cycle, Hello(1), Activate(1), Command(1, 0, 500), Cycle], depth - 1);
    // The stranger was host before: its session, its last activation and its last command are known
    // to the device.
    let changed = search(
        &[Cycle, Hello(2), Activate(2), Command(2, 0, 500), Happening::Silence, Hello(1)],
        depth - 1,
    );
    for (name, found) in [("start", &start), ("turning", &turning), ("changed hosts", &changed)] {
        println!("{name}: {} sequences, {} with a command", found.events, found.driven);
        assert!(found.events > 100_000 && found.driven > 1000);
    }
}

/// Every byte of every frame set to every other value, every byte left out, and every beginning of
/// one frame before another: the decoder says what was sent or nothing, and the device does nothing
/// else.
#[test]
fn no_single_damage_to_a_frame_says_anything_that_was_not_sent() {
    let origin = of(session(1), 1);
    let messages = [
        HostMessage::Hello { number: session(1) },
        HostMessage::Voltage(VoltageCommand {
            origin,
            answers: 256,
            voltage: 500,
            validity_us: 2000,
        }),
        HostMessage::Heartbeat(origin),
        HostMessage::Activate(origin),
        HostMessage::Deactivate,
        HostMessage::EmergencyStop,
        HostMessage::Clear(origin),
        HostMessage::Close(origin),
    ];
    let mut decoder = Decoder::<HostMessage>::new();
    let mut said = |bytes: &[u8]| -> Vec<HostMessage> {
        // A zero before and after: each trial begins and ends between frames.
        [&[0][..], bytes, &[0][..]]
            .concat()
            .iter()
            .filter_map(|byte| decoder.push(*byte).ok().flatten())
            .collect()
    };
    let mut trials = 0;
    for message in messages {
        let frame = message.frame();
        let bytes = frame.as_bytes();
        for place in 0..bytes.len() {
            for value in 0..=u8::MAX {
                let mut damaged = bytes.to_vec();
                damaged[place] = value;
                let came = said(&damaged);
                assert!(
                    came.is_empty() || (value == bytes[place] && came == [message]),
                    "{came:?} of {message:?}"
                );
                trials += 1;
            }
            let mut shorter = bytes.to_vec();
            shorter.remove(place);
            // The last byte is the frame's end, which the next zero stands in for.
            assert!(
                place == bytes.len() - 1 || said(&shorter).is_empty(),
                "{message:?} without byte {place}"
            );
            for other in messages {
                let spliced = [&bytes[..place], other.frame().as_bytes()].concat();
                let came = said(&spliced);
                assert!(
                    came.is_empty() || came == [other],
                    "{came:?} of {message:?} and {other:?}"
                );
                trials += 1;
            }
        }
    }
    println!("{trials} damaged frames");
}
