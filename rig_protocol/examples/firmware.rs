//! Firmware of a rig, but for the board: the device's cycle with the shared codec and state
//! machine, over a board that a trait describes.
//!
//! Nothing in [`Firmware`] needs the standard library or an allocator. On a microcontroller
//! implement [`Board`] over its drivers, make the `Firmware`, and call `cycle` from a timer's
//! interrupt or a ticker, with the hardware watchdog reloaded behind it; see
//! `docs/how-to/write-firmware.md`.
//! Here a made-up board stands in, so that the example is compiled and run with the tests:
//! `cargo run -p rig_protocol --example firmware`.

use rig_protocol::{
    Cause, Channels, Decoder, Device, DeviceMessage, Hello, HelloError, HostMessage, Inputs,
    Message, Name, Origin, Output, Readings, Session, VoltageCommand,
};

/// What the firmware needs of a board.
pub trait Board {
    /// A number that differs after each start: noise of a converter, a generator of random numbers,
    /// a counter in non-volatile memory.
    fn seed(&mut self) -> u64;
    /// The clock \[us\]; it never runs backwards.
    fn time_us(&mut self) -> u64;
    /// Encoder and converters \[count\].
    fn read(&mut self) -> Readings;
    /// Puts a voltage on the motor \[count of the voltage output\].
    fn drive(&mut self, voltage: i16);
    /// The emergency stop's switch is pressed, or its wire is broken.
    fn emergency_stop(&mut self) -> bool;
    /// The driver stage's fault line.
    fn driver_fault(&mut self) -> bool;
    /// The next byte from the host, if there is one.
    fn receive(&mut self) -> Option<u8>;
    /// Hands bytes to the line. What does not fit into its buffer is dropped: the host counts the
    /// gap.
    fn send(&mut self, bytes: &[u8]);
}

/// What the board is: the scales are the board's own.
#[must_use]
pub fn hello() -> Hello {
    Hello {
        answers: None,
        session: None,
        name: Name::new("rig firmware").unwrap_or_default(),
        firmware: [0, 1, 0],
        channels: Channels {
            tachometer: false,
            potentiometer: false,
            torque: false,
            current: true,
        },
        period_us: 1000,
        counts_per_turn: 4096,
        // A PWM of 1000 steps on a supply of 12 V, and 6 V for the motor.
        volts_per_count: 0.012,
        voltage_limit: 500,
        tachometer_per_count: 0.0,
        potentiometer_per_count: 0.0,
        torque_per_count: 0.0,
        // 12 bits of 3.3 V over 0.5 V/A.
        current_per_count: 0.001_611_328,
        validity_limit_us: 20_000,
        host_timeout_us: 250_000,
    }
}

/// The device's cycle.
pub struct Firmware {
    device: Device,
    decoder: Decoder<HostMessage>,
    /// When the cycle before began \[us\].
    before_us: Option<u64>,
}

impl Firmware {
    /// A device that has just started. The board's motor output is to be at zero before and until
    /// the first cycle.
    ///
    /// # Errors
    /// [`HelloError`] if the description breaks a rule.
    pub fn new(hello: Hello, board: &mut impl Board) -> Result<Self, HelloError> {
        Ok(Self {
            device: Device::new(hello, board.seed())?,
            decoder: Decoder::new(),
            before_us: None,
        })
    }

    /// One cycle, begun by the board's timer.
    pub fn cycle(&mut self, board: &mut impl Board) {
        // Sensors first: as little as possible between the timer and the readings.
        let time_us = board.time_us();
        let readings = board.read();
        // What has come since the last cycle. At 2 Mbaud that is 200 bytes at most: a bound, so
        // that no host can hold the cycle up.
        for _ in 0..256 {
            let Some(byte) = board.receive() else { break };
            // What is no frame is counted in the decoder, what may not be is counted in the device.
            match self.decoder.push(byte) {
                Ok(None) => {}
                Ok(Some(message)) => {
                    if let Ok(Some(answer)) = self.device.receive(&message) {
                        board.send(answer.frame().as_bytes());
                    }
                }
                Err(rejection) => self.device.reject(&rejection),
            }
        }
        let late = self.before_us.is_some_and(|before| {
            time_us.saturating_sub(before) > 2 * u64::from(self.device.hello().period_us)
        });
        self.before_us = Some(time_us);
        let fault = if board.driver_fault() {
            Some(Cause::DriverStage)
        } else if late {
            Some(Cause::CycleOverrun)
        } else {
            None
        };
        let Output { voltage, report, announce, stream } =
            self.device.tick(Inputs { emergency_stop: board.emergency_stop(), fault });
        // The motor before anything is sent.
        board.drive(voltage);
        if let Some(report) = report {
            board.send(DeviceMessage::Fault(report).frame().as_bytes());
        }
        if announce {
            board.send(DeviceMessage::Hello(self.device.hello()).frame().as_bytes());
        }
        if stream {
            let measurement = self.device.measurement(time_us, readings);
            board.send(DeviceMessage::Measurement(measurement).frame().as_bytes());
        }
    }
}

/// A board in memory.
#[derive(Debug, Default)]
struct Imagined {
    time_us: u64,
    voltage: i16,
    broken: bool,
    to_device: std::collections::VecDeque<u8>,
    from_device: Vec<u8>,
}

impl Board for Imagined {
    fn seed(&mut self) -> u64 {
        2017
    }

    fn time_us(&mut self) -> u64 {
        self.time_us += 1000;
        self.time_us
    }

    fn read(&mut self) -> Readings {
        Readings { encoder: 42, current: 7, ..Readings::default() }
    }

    fn drive(&mut self, voltage: i16) {
        self.voltage = voltage;
    }

    fn emergency_stop(&mut self) -> bool {
        false
    }

    fn driver_fault(&mut self) -> bool {
        self.broken
    }

    fn receive(&mut self) -> Option<u8> {
        self.to_device.pop_front()
    }

    fn send(&mut self, bytes: &[u8]) {
        self.from_device.extend_from_slice(bytes);
    }
}

impl Imagined {
    fn say(&mut self, message: &HostMessage) {
        self.to_device.extend(message.frame().as_bytes());
    }

    fn heard(&mut self) -> Vec<DeviceMessage> {
        let mut decoder = Decoder::new();
        self.from_device.drain(..).filter_map(|byte| decoder.push(byte).ok().flatten()).collect()
    }
}

impl Imagined {
    /// Says hello for a host. Returns the session that the device grants.
    fn open(&mut self, firmware: &mut Firmware) -> Option<Session> {
        // A host draws it at random.
        self.say(&HostMessage::Hello { number: Session::MIN });
        firmware.cycle(self);
        let heard = self.heard();
        println!("to a host: {heard:?}");
        heard.iter().find_map(|message| match message {
            DeviceMessage::Hello(hello) => hello.session,
            _ => None,
        })
    }
}

/// A conversation: hello, activation, one command, silence.
fn main() -> Result<(), HelloError> {
    let mut board = Imagined::default();
    let mut firmware = Firmware::new(hello(), &mut board)?;
    firmware.cycle(&mut board);
    println!("by itself: {:?}", board.heard());
    let Some(session) = board.open(&mut firmware) else { return Ok(()) };
    let origin = |sequence| Origin { session, sequence };
    board.say(&HostMessage::Activate(origin(1)));
    let command =
        VoltageCommand { origin: origin(2), answers: 2, voltage: 250, validity_us: 20_000 };
    board.say(&HostMessage::Voltage(command));
    let driven = (0..100).take_while(|_| {
        firmware.cycle(&mut board);
        board.voltage != 0
    });
    println!("one command, then silence: {} cycles with 3 V, then none", driven.count());
    Ok(())
}

#[cfg(test)]
mod tests {
    use rig_protocol::State;

    use super::*;

    fn active() -> (Firmware, Imagined) {
        let mut board = Imagined::default();
        let mut firmware = Firmware::new(hello(), &mut board).unwrap();
        let session = board.open(&mut firmware).unwrap();
        board.say(&HostMessage::Activate(Origin { session, sequence: 1 }));
        firmware.cycle(&mut board);
        board.say(&HostMessage::Voltage(VoltageCommand {
            origin: Origin { session, sequence: 2 },
            answers: 2,
            voltage: 250,
            validity_us: 20_000,
        }));
        firmware.cycle(&mut board);
        assert_eq!(board.voltage, 250);
        (firmware, board)
    }

    /// What a version 1 host would send: it moves nothing, and the host that is there sees in the
    /// next measurement that somebody spoke.
    #[test]
    fn a_frame_of_version_1_moves_nothing_and_is_counted() {
        let (mut firmware, mut board) = active();
        board.heard();
        let old = HostMessage::EmergencyStop.frame().of_version(1);
        board.to_device.extend(old.as_bytes());
        firmware.cycle(&mut board);
        let Some(DeviceMessage::Measurement(last)) = board.heard().pop() else {
            panic!("no measurement")
        };
        assert_eq!((last.state, last.foreign, board.voltage), (State::Active, 1, 250));
    }

    #[test]
    fn a_command_without_a_successor_ends_after_its_validity() {
        let (mut firmware, mut board) = active();
        let mut driven = 1;
        while board.voltage != 0 {
            firmware.cycle(&mut board);
            driven += usize::from(board.voltage != 0);
        }
        assert_eq!(driven, 20);
    }

    #[test]
    fn a_fault_of_the_driver_stage_and_a_late_cycle_stop_the_motor_in_the_same_cycle() {
        for late in [false, true] {
            let (mut firmware, mut board) = active();
            board.broken = !late;
            board.time_us += if late { 5000 } else { 0 };
            firmware.cycle(&mut board);
            assert_eq!(board.voltage, 0);
            let Some(DeviceMessage::Measurement(last)) = board.heard().pop() else {
                panic!("no measurement")
            };
            let cause = if late { Cause::CycleOverrun } else { Cause::DriverStage };
            assert_eq!((last.state, last.cause), (State::Fault, cause));
        }
    }
}
