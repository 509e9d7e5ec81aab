//! The device's cycle: orders, the line, the state machine, the motor.

use std::{
    hash::{BuildHasher, RandomState},
    path::{Path, PathBuf},
    sync::{
        atomic::{AtomicBool, Ordering},
        mpsc::Receiver,
    },
    thread,
    time::{Duration, Instant},
};

use anyhow::Context;
use machine_rig::Machine;
use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;
use rig_driver::Rig;
use rig_protocol::{
    Cause, Decoder, Device, DeviceMessage, Hello, HostMessage, Inputs, Message, Readings, State,
    VERSION,
};

use crate::{
    books::{Books, Summary, name},
    control::{Direction, Order},
    line::Line,
    options::Options,
    say,
    terminal::Terminal,
};

/// The device, its line and its motor.
pub(crate) struct Emulator {
    options: Options,
    /// What it says of itself when it starts.
    hello: Hello,
    terminal: Option<Terminal>,
    path: PathBuf,
    device: Device,
    decoder: Decoder<HostMessage>,
    from_host: Line,
    from_device: Line,
    motor: Box<dyn Rig + Send>,
    inputs: Inputs,
    version: u8,
    /// Cycles left until the port is back, the device has started, the device speaks again.
    unplugged: u32,
    starting: u32,
    hanging: u32,
    /// Cycles since the emulator started; the device's own begin anew when it restarts.
    cycle: u64,
    voltage: i16,
    /// By the books: a host activated, and nothing has stopped the motor since.
    permitted: bool,
    /// By the books: cycles since the device accepted anything.
    silent: u32,
    /// Cycle that the last accepted command answers.
    answers: Option<u32>,
    books: Books,
    ended: bool,
}

impl Emulator {
    /// A device that has just started, on a pseudo-terminal.
    pub(crate) fn new(options: &Options) -> anyhow::Result<Self> {
        let machine = options.machine.as_deref().map(Machine::read).transpose()?;
        let hello = options.hello(machine.as_ref())?;
        let terminal = Terminal::open(options.link.as_deref())?;
        let random =
            |stream| Pcg64Mcg::seed_from_u64(options.seed.wrapping_mul(4).wrapping_add(stream));
        Ok(Self {
            path: terminal.path().to_owned(),
            terminal: Some(terminal),
            device: Device::new(hello, unforeseen()).context("the device's description")?,
            decoder: Decoder::new(),
            from_host: Line::new(options.odds(), random(1)),
            from_device: Line::new(options.odds(), random(2)),
            motor: options.motor(machine.as_ref())?,
            inputs: Inputs::default(),
            version: options.speak_version,
            unplugged: 0,
            starting: 0,
            hanging: 0,
            cycle: 0,
            voltage: 0,
            permitted: false,
            silent: 0,
            answers: None,
            books: Books::default(),
            ended: false,
            options: options.clone(),
            hello,
        })
    }

    /// What a host opens.
    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// Everything there is to tell.
    pub(crate) fn summary(&self) -> Summary {
        let hello = self.device.hello();
        Summary {
            validity_limit_cycles: hello.cycles(hello.validity_limit_us),
            books: self.books,
            state: name(self.device.state()),
            voltage: self.voltage,
            from_host: self.from_host.fates(),
            from_device: self.from_device.fates(),
            rejected: self.decoder.rejections().into(),
        }
    }

    /// Runs cycle after cycle until told to end.
    ///
    /// A cycle that is late is not made up for: the device's time stands still while the machine is
    /// busy, so that a host on the same machine does not see a burst of cycles that no device would
    /// make.
    pub(crate) fn run(
        &mut self,
        orders: &Receiver<Order>,
        stop: &AtomicBool,
    ) -> anyhow::Result<()> {
        let period = Duration::from_micros(self.hello.period_us.into());
        let mut next = Instant::now() + period;
        while !stop.load(Ordering::Relaxed) && !self.ended {
            if self.options.cycles.is_some_and(|cycles| self.cycle >= cycles) {
                break;
            }
            thread::sleep(next.saturating_duration_since(Instant::now()));
            let now = Instant::now();
            next += period;
            if now >= next {
                self.books.late_cycles += 1;
                next = now + period;
            }
            for order in orders.try_iter() {
                self.obey(order);
            }
            self.step()?;
        }
        Ok(())
    }

    fn obey(&mut self, order: Order) {
        match order {
            Order::Frames(fault, frames, direction) => {
                if direction != Direction::FromDevice {
                    self.from_host.order(fault, frames);
                }
                if direction != Direction::FromHost {
                    self.from_device.order(fault, frames);
                }
            }
            Order::Garbage(bytes) => {
                self.from_host.garbage(bytes, self.cycle);
                self.from_device.garbage(bytes, self.cycle);
            }
            Order::Reboot(cycles) => {
                self.starting = cycles.max(1);
                self.books.reboots += 1;
            }
            Order::Unplug(cycles) => {
                self.terminal = None;
                self.unplugged = cycles.max(1);
                self.from_host.clear();
                self.from_device.clear();
            }
            Order::Hang(cycles) => self.hanging = cycles,
            Order::Fault => self.inputs.fault = Some(Cause::DriverStage),
            Order::Switch(pressed) => self.inputs.emergency_stop = pressed,
            Order::Version(version) => self.version = version,
            Order::Status => say(&serde_json::to_string(&self.summary()).unwrap_or_default()),
            Order::Quit => self.ended = true,
            Order::EndOfInput => self.ended = self.options.until_eof,
        }
    }

    /// One cycle.
    fn step(&mut self) -> anyhow::Result<()> {
        self.cycle += 1;
        if self.terminal.is_none() {
            self.unplugged = self.unplugged.saturating_sub(1);
            if self.unplugged == 0 {
                self.terminal = Some(Terminal::open(self.options.link.as_deref())?);
            }
        }
        let came = self.terminal.as_ref().map(Terminal::receive).unwrap_or_default();
        self.from_host.put(&came, self.cycle);
        let came = self.from_host.take(self.cycle);
        if self.starting > 0 {
            self.restart();
        } else {
            self.listen(&came);
            self.drive()?;
        }
        let out = self.from_device.take(self.cycle);
        if let Some(terminal) = &self.terminal {
            terminal.send(&out);
        }
        Ok(())
    }

    /// A cycle of a device that starts: no voltage, no ears.
    fn restart(&mut self) {
        self.starting -= 1;
        (self.voltage, self.permitted, self.answers) = (0, false, None);
        self.inputs.fault = None;
        // Checked when the first one was made.
        if let Ok(device) = Device::new(self.hello, unforeseen()) {
            self.device = device;
        }
        self.apply();
        self.books.cycle(0, false, None);
    }

    /// The messages that have come.
    fn listen(&mut self, bytes: &[u8]) {
        for byte in bytes {
            let message = match self.decoder.push(*byte) {
                // A device of another version throws away what this version's hosts say.
                Ok(Some(message)) if self.version == VERSION => message,
                Ok(_) => continue,
                Err(rejection) => {
                    self.device.reject(&rejection);
                    continue;
                }
            };
            let before = self.device.state();
            match self.device.receive(&message) {
                Ok(answer) => {
                    self.silent = 0;
                    self.note(&message);
                    if let Some(answer) = answer {
                        self.send(&answer);
                    }
                }
                Err(refusal) => self.books.refusal(refusal),
            }
            self.books.activations +=
                u64::from(before != State::Active && self.device.state() == State::Active);
        }
    }

    /// What an accepted message means for the books.
    fn note(&mut self, message: &HostMessage) {
        match message {
            HostMessage::Hello { .. } => {
                self.books.sessions += 1;
                self.permitted = false;
            }
            HostMessage::Voltage(command) => {
                self.books.command();
                self.answers = Some(command.answers);
            }
            HostMessage::Activate { .. } => self.permitted = true,
            HostMessage::Deactivate | HostMessage::EmergencyStop | HostMessage::Close(_) => {
                self.permitted = false
            }
            HostMessage::Heartbeat(_) | HostMessage::Clear(_) => {}
        }
    }

    /// The device decides, the motor turns, the sensors are read.
    fn drive(&mut self) -> anyhow::Result<()> {
        let output = self.device.tick(self.inputs);
        self.silent = self.silent.saturating_add(1);
        self.permitted &= !self.inputs.emergency_stop
            && self.inputs.fault.is_none()
            && self.silent <= self.options.host_timeout.div_ceil(self.hello.period_us);
        self.inputs.fault = None;
        self.voltage = output.voltage;
        let age = self.answers.map(|answers| self.device.cycle().wrapping_sub(answers));
        self.books.cycle(output.voltage, self.permitted, age);
        let seen = self.motor.measure();
        let scale = |value: f64, per_count: f32| {
            if per_count == 0.0 { 0 } else { (value / f64::from(per_count)).round() as i32 }
        };
        let hello = self.device.hello();
        let readings = Readings {
            // The device's counter wraps.
            encoder: seen.encoder_counts as i32,
            tachometer: scale(seen.tachometer_velocity, hello.tachometer_per_count),
            potentiometer: scale(seen.potentiometer_position, hello.potentiometer_per_count),
            torque: scale(seen.torque, hello.torque_per_count),
            current: scale(seen.motor_current.unwrap_or(0.0), hello.current_per_count),
        };
        let time_us = u64::from(self.device.cycle()) * u64::from(self.hello.period_us);
        let measurement = self.device.measurement(time_us, readings);
        self.books.expired += u64::from(measurement.expired);
        if self.hanging > 0 {
            self.hanging -= 1;
        } else {
            if output.announce {
                self.send(&DeviceMessage::Hello(hello));
            }
            if let Some(report) = output.report {
                self.send(&DeviceMessage::Fault(report));
            }
            if output.stream {
                self.send(&DeviceMessage::Measurement(measurement));
            }
        }
        self.apply();
        Ok(())
    }

    /// The motor turns for a period.
    fn apply(&mut self) {
        let volts = f64::from(self.voltage) * f64::from(self.device.hello().volts_per_count);
        // Only a voltage that is not a number is refused, and a count is one.
        let _ = self.motor.apply(volts);
    }

    fn send(&mut self, message: &DeviceMessage) {
        let frame = message.frame();
        let frame = if self.version == VERSION { frame } else { frame.of_version(self.version) };
        self.from_device.put(frame.as_bytes(), self.cycle);
    }
}

/// A seed for the sessions of a device that starts: another one each time, as a microcontroller has
/// it from its converters' noise.
fn unforeseen() -> u64 {
    // The standard library seeds its hashers from the system's randomness.
    RandomState::new().hash_one("device")
}
