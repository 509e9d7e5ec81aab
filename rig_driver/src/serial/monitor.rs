//! Whether the device does what this driver sent, and nobody else's bidding. Pure: measurements and
//! times come in.

use rig_protocol::{Hello, Measurement, State};

use super::clock::Jump;
use crate::safety::Fault;

/// Commands that are remembered: those that may still be on their way.
const SENT: usize = 1024;
/// Frames of somebody else within a second that are no fault yet: one that was late at a change of
/// hosts is harmless.
const FOREIGN: u16 = 2;
/// Cycles in a row in which the motor has another voltage than asked for.
const DIFFERING: u32 = 3;
/// By how much the device may run ahead of the time here at once \[s\].
const AHEAD: f64 = 0.25;
/// Time of a session in which it is learned how late measurements are \[s\]: the first may have
/// waited for this side.
const LEARNING: f64 = 1.0;
/// By which part its clock may be slower than the one here, and a jump still be seen at once.
const SLOWER: f64 = 0.1;

/// What was found: the fault, the value seen and its limit.
pub(super) type Finding = (Fault, f64, f64);

/// Watches one session.
#[derive(Debug)]
pub(super) struct LineMonitor {
    period: f64,
    volts_per_count: f64,
    /// How far the voltage on the motor may be from the one asked for \[count\].
    band: i32,
    /// Numbers and voltages sent, by number.
    sent: Box<[Option<(u32, i16)>; SENT]>,
    last: u32,
    before: Option<Measurement>,
    differing: u32,
    window: Option<Window>,
    /// How late the device is against the time here, at the least \[s\].
    least_late: Option<f64>,
    /// Time since the session's first measurement by the device's cycles \[s\].
    device_time: f64,
}

/// A second of cycles in which refusals are counted.
#[derive(Debug, Clone, Copy)]
struct Window {
    first_cycle: u32,
    refused: u16,
    foreign: u16,
}

impl LineMonitor {
    pub(super) fn new(hello: &Hello) -> Self {
        Self {
            period: f64::from(hello.period_us) / 1e6,
            volts_per_count: f64::from(hello.volts_per_count).abs(),
            band: (i32::from(hello.voltage_limit) / 20).max(2),
            sent: Box::new([None; SENT]),
            last: 0,
            before: None,
            differing: 0,
            window: None,
            least_late: None,
            device_time: 0.0,
        }
    }

    /// A command was sent.
    pub(super) fn sent(&mut self, sequence: u32, voltage: i16) {
        self.last = sequence;
        if let Some(place) = self.sent.get_mut(sequence as usize % SENT) {
            *place = Some((sequence, voltage));
        }
    }

    /// Counts anew, after a fault was cleared.
    pub(super) fn restart(&mut self) {
        (self.window, self.differing) = (None, 0);
    }

    /// A measurement came at `now` \[s\]; `jump` is what its clock has against its cycles.
    pub(super) fn heard(
        &mut self,
        device: &Measurement,
        now: f64,
        jump: Option<Jump>,
    ) -> Option<Finding> {
        let before = self.before.replace(*device);
        // Every check sees every measurement.
        let found = [
            self.echo(device, before.as_ref()),
            self.voltage(device, before.as_ref()),
            self.refusals(device),
            self.time(device, before.as_ref(), now),
            jump.map(|jump| {
                (Fault::CycleJump, jump.by_us as f64 / 1e6, jump.allowed_us as f64 / 1e6)
            }),
        ];
        found.into_iter().flatten().next()
    }

    /// The command that the device obeys was sent from here, with this voltage.
    fn echo(&self, device: &Measurement, before: Option<&Measurement>) -> Option<Finding> {
        let number = device.command_sequence;
        let known = match self.sent.get(number as usize % SENT).copied().flatten() {
            _ if number == 0 => device.voltage_asked == 0,
            Some((sequence, voltage)) if sequence == number => device.voltage_asked == voltage,
            // Too long ago to know its voltage: an echo that stands still is as it was.
            Some((sequence, _)) if sequence.wrapping_sub(number) < 1 << 31 => {
                before.is_none_or(|before| {
                    before.command_sequence != number
                        || before.voltage_asked == device.voltage_asked
                })
            }
            _ => false,
        };
        (!known).then(|| (Fault::UnknownEcho, number.into(), self.last.into()))
    }

    /// The motor had the voltage that was asked for in the cycle before.
    fn voltage(&mut self, device: &Measurement, before: Option<&Measurement>) -> Option<Finding> {
        let before = before.filter(|before| device.cycle.wrapping_sub(before.cycle) == 1)?;
        let driven =
            before.state == State::Active && !before.expired && before.command_sequence != 0;
        let asked = if driven { before.voltage_asked } else { 0 };
        let difference = (i32::from(device.voltage_applied) - i32::from(asked)).abs();
        self.differing = if difference > self.band { self.differing + 1 } else { 0 };
        let volts = |counts: i32| f64::from(counts) * self.volts_per_count;
        (self.differing >= DIFFERING)
            .then(|| (Fault::VoltageDiffers, volts(difference), volts(self.band)))
    }

    /// Refusals within a second.
    fn refusals(&mut self, device: &Measurement) -> Option<Finding> {
        let &Measurement { cycle, refused, foreign, .. } = device;
        let length = (1.0 / self.period).round().max(1.0) as u32;
        let fresh = Window { first_cycle: cycle, refused, foreign };
        let window = self.window.get_or_insert(fresh);
        let refusals = (refused.wrapping_sub(window.refused), foreign.wrapping_sub(window.foreign));
        if cycle.wrapping_sub(window.first_cycle) >= length {
            *window = fresh;
        }
        let most = length.div_ceil(2).min(u32::from(u16::MAX) / 2);
        if refusals.1 > FOREIGN {
            return Some((Fault::ForeignFrames, refusals.1.into(), FOREIGN.into()));
        }
        (u32::from(refusals.0) > most)
            .then(|| (Fault::CommandsRefused, refusals.0.into(), most.into()))
    }

    /// The device does not run ahead of the time here. That it is late is no jump: what waits in a
    /// buffer is late.
    fn time(
        &mut self,
        device: &Measurement,
        before: Option<&Measurement>,
        now: f64,
    ) -> Option<Finding> {
        let cycles = before.map_or(0, |before| device.cycle.wrapping_sub(before.cycle));
        let passed = f64::from(cycles) * self.period;
        self.device_time += passed;
        let late = now - self.device_time;
        let least = *self.least_late.get_or_insert(late);
        let ahead = least - late;
        // By the device's time: of a host that was stopped, none passes while it reads what waited
        // for it.
        self.least_late = Some(late.min(least + SLOWER * passed));
        let learned = self.device_time - passed > LEARNING;
        (learned && ahead > AHEAD).then_some((Fault::CycleJump, ahead, AHEAD))
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use rig_protocol::{
        Device, DeviceMessage, HostMessage, Inputs, Origin, Readings, Session, VoltageCommand,
    };

    use super::*;
    use crate::serial::test_messages::{hello, measured};

    /// A device and its host, with nothing between them but what `Line` does.
    struct Bench {
        device: Device,
        monitor: LineMonitor,
        session: Session,
        sequence: u32,
        now: f64,
        /// Frames that are late.
        waiting: Vec<HostMessage>,
    }

    /// What becomes of a command.
    #[derive(Debug, Clone, Copy)]
    enum Line {
        Good,
        Lost,
        Twice,
        /// With the one after.
        Late,
    }

    impl Bench {
        fn new() -> Self {
            let mut device = Device::new(hello(), 1).unwrap();
            let Ok(Some(DeviceMessage::Hello(answer))) =
                device.receive(&HostMessage::Hello { number: Session::MIN })
            else {
                panic!("no answer")
            };
            let session = answer.session.unwrap();
            let monitor = LineMonitor::new(&hello());
            let mut bench =
                Self { device, monitor, session, sequence: 0, now: 0.0, waiting: Vec::new() };
            let origin = bench.origin();
            bench.device.receive(&HostMessage::Activate(origin)).unwrap();
            bench
        }

        fn origin(&mut self) -> Origin {
            self.sequence += 1;
            Origin { session: self.session, sequence: self.sequence }
        }

        fn command(&mut self, voltage: i16) -> HostMessage {
            let origin = self.origin();
            self.monitor.sent(origin.sequence, voltage);
            let answers = self.device.cycle();
            HostMessage::Voltage(VoltageCommand { origin, answers, voltage, validity_us: 20_000 })
        }

        /// A cycle, and the measurement as `change` makes it; `heard` says whether it comes
        /// through.
        fn cycle(&mut self, heard: bool, change: impl Fn(&mut Measurement)) -> Option<Finding> {
            self.now += 1e-3;
            self.device.tick(Inputs::default());
            let time_us = u64::from(self.device.cycle()) * 1000;
            let mut seen = self.device.measurement(time_us, Readings::default());
            change(&mut seen);
            if heard { self.monitor.heard(&seen, self.now, None) } else { None }
        }

        fn drive(&mut self, line: Line, voltage: i16) {
            let message = self.command(voltage);
            match line {
                Line::Lost => {}
                Line::Late => self.waiting.push(message),
                Line::Good | Line::Twice => {
                    for message in self.waiting.drain(..).chain([message]) {
                        let _ = self.device.receive(&message);
                    }
                    if matches!(line, Line::Twice) {
                        let _ = self.device.receive(&message);
                    }
                }
            }
        }
    }

    fn line() -> impl Strategy<Value = Line> {
        prop_oneof![
            8 => Just(Line::Good), 1 => Just(Line::Lost), 1 => Just(Line::Twice), 1 => Just(Line::Late)
        ]
    }

    proptest! {
        /// A line that loses, doubles and delays in both directions, a host that pauses: no alarm.
        #[test]
        fn a_bad_line_raises_no_alarm(
            cycles in proptest::collection::vec((line(), -700..700i16, proptest::bool::weighted(0.9), 0..3u8), 1..1500),
        ) {
            let mut bench = Bench::new();
            for (line, voltage, heard, what) in cycles {
                if what > 0 {
                    bench.drive(line, voltage.clamp(-600, 600));
                }
                let found = bench.cycle(heard, |_| ());
                prop_assert_eq!(found, None);
            }
        }

        /// Whatever a device says and when, it is judged without a panic.
        #[test]
        fn any_measurement_is_judged(
            said in proptest::collection::vec((any::<(u32, i16, i16, u32, u16, u16)>(), any::<f64>()), 1..100),
        ) {
            let mut monitor = LineMonitor::new(&hello());
            for ((cycle, voltage_asked, voltage_applied, command_sequence, refused, foreign), now) in said {
                monitor.sent(command_sequence ^ 1, voltage_asked);
                let seen =
                    Measurement { cycle, voltage_asked, voltage_applied, command_sequence, refused, foreign, ..measured() };
                monitor.heard(&seen, now, None);
            }
        }

        /// A forged command is told, whatever its number and voltage: they are not those of a
        /// command that was sent.
        #[test]
        fn a_forged_command_is_an_unknown_echo(ahead in 1..1000u32, voltage in 1..600i16) {
            let mut bench = Bench::new();
            bench.drive(Line::Good, 100);
            prop_assert_eq!(bench.cycle(true, |_| ()), None);
            let origin = Origin { session: bench.session, sequence: bench.sequence + ahead };
            let answers = bench.device.cycle();
            let forged = VoltageCommand { origin, answers, voltage, validity_us: 20_000 };
            bench.device.receive(&HostMessage::Voltage(forged)).unwrap();
            let found = bench.cycle(true, |_| ());
            prop_assert_eq!(found.map(|found| found.0), Some(Fault::UnknownEcho));
        }
    }

    /// Drives for two seconds, with the measurements as `change` makes them: what is found first,
    /// and in which cycle.
    fn find(change: impl Fn(&mut Measurement, u32)) -> Option<(Fault, u32)> {
        let mut bench = Bench::new();
        (0..2000).find_map(|cycle| {
            bench.drive(Line::Good, 300);
            bench.cycle(true, |seen| change(seen, cycle)).map(|(fault, ..)| (fault, cycle))
        })
    }

    #[test]
    fn each_contradiction_has_its_fault() {
        assert_eq!(find(|_, _| ()), None);
        // A command's own number with another voltage.
        let echo = find(|seen, cycle| {
            if cycle == 50 {
                seen.voltage_asked = -300;
            }
        });
        assert_eq!(echo, Some((Fault::UnknownEcho, 50)));
        // The band is 30 counts, and two cycles may be wrong.
        for (counts, cycles, found) in [
            (331, 100..2000, Some((Fault::VoltageDiffers, 102))),
            (0, 100..103, Some((Fault::VoltageDiffers, 102))),
            (330, 100..2000, None),
            (0, 100..102, None),
        ] {
            let came = find(|seen, cycle| {
                if cycles.contains(&cycle) {
                    seen.voltage_applied = counts;
                }
            });
            assert_eq!(came, found, "{counts} in {cycles:?}");
        }
        // Two foreign frames in a second are no fault, three are.
        assert_eq!(find(|seen, cycle| seen.foreign = (cycle / 400) as u16), None);
        assert_eq!(
            find(|seen, cycle| seen.foreign = (cycle / 300) as u16),
            Some((Fault::ForeignFrames, 900))
        );
        let refused = find(|seen, cycle| seen.refused = cycle.saturating_sub(300) as u16);
        assert_eq!(refused, Some((Fault::CommandsRefused, 801)));
        // The device's cycle leaps by a second.
        let leap = find(|seen, cycle| seen.cycle += if cycle < 1100 { 0 } else { 300 });
        assert_eq!(leap, Some((Fault::CycleJump, 1100)));
        // A side that was held up when the session began finds out how late it is.
        assert_eq!(find(|seen, cycle| seen.cycle += if cycle < 70 { 0 } else { 1000 }), None);
    }

    /// A host that was stopped for a minute finds a few old measurements and then new ones: no
    /// jump.
    #[test]
    fn a_host_that_was_stopped_sees_no_jump() {
        let mut bench = Bench::new();
        for _ in 0..2000 {
            assert_eq!(bench.cycle(true, |_| ()), None);
        }
        let stopped_at = bench.now;
        bench.now += 60.0;
        for _ in 0..70 {
            bench.now -= 1e-3;
            assert_eq!(bench.cycle(true, |_| ()), None);
        }
        bench.now = stopped_at + 0.07;
        for _ in 0..60_000 {
            bench.cycle(false, |_| ());
        }
        for _ in 0..2000 {
            assert_eq!(bench.cycle(true, |_| ()), None);
        }
    }

    /// A device whose clock is off by a tenth, either way, is no jump.
    #[test]
    fn a_clock_that_is_off_is_no_jump() {
        for rate in [0.9, 1.1] {
            let mut bench = Bench::new();
            for cycle in 0..100_000 {
                bench.now = f64::from(cycle) * 1e-3 * rate;
                assert_eq!(bench.cycle(true, |_| ()), None);
            }
        }
    }
}
