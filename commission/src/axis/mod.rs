//! The rig as the stages drive it: under the safety layer, with its time counted.

mod opening;
mod repeats;

use std::cell::Cell;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::SystemTime;

use controller::{Controller, ControllerOptions, Feedback, Reference};
use experiment_runner::control_loop::RunningLoop;
use experiment_runner::cycle::CycleSample;
use experiment_runner::waveform::Waveform;
use rig_driver::safety::{MotorThermal, Travel};
use rig_driver::{Calibration, Measurement, Rig, RigError};
use rig_setup::{
    BenchRig, Heat, Opened, REST, RigChoice, RigDescription, RigSetup, RigSetupError, Session,
};
use work::progress::Progress;

use self::opening::Opening;
use self::repeats::Repeats;
use crate::reach::{self, Reach};
use crate::{CommissionError, Stage};

/// Shortest and longest way to a place \[s\], time to settle there, and how often it is tried.
const SHORTEST_GO: f64 = 0.6;
const LONGEST_GO: f64 = 8.0;
const SETTLED: f64 = 0.5;
const GOES: u32 = 2;

/// What is known of a rig before it moves.
#[derive(Debug, Clone, PartialEq)]
pub struct Known {
    /// What it says of itself, in a line.
    pub about: Option<String>,
    /// What it says of itself, number by number.
    pub description: Option<RigDescription>,
    /// Largest voltage \[V\].
    pub voltage: f64,
    /// Largest speed [rad/s].
    pub velocity: f64,
    /// Whether a torque sensor is there; it is not used.
    pub torque: bool,
    /// Period \[s\].
    pub period: f64,
    /// The winding, where the safety layer watches it.
    pub winding: Option<MotorThermal>,
    /// Where the shaft may be, by the rig's own count before it is calibrated.
    pub travel: Option<Travel>,
}

impl Known {
    /// Voltage that the motor bears at rest for ever \[V\].
    #[must_use]
    pub fn continuous(&self) -> f64 {
        self.winding.map_or(f64::INFINITY, |motor| Heat(motor).continuous())
    }
}

/// The rig, opened for one stage at a time. Between stages it is closed, at zero volts.
///
/// Where its line fails, the rig is waited for and the turn at hand repeated from rest, a few times
/// only; what is about the motor, and what the user wants, ends the commission.
pub struct Axis<'a> {
    opening: Opening,
    stop: Arc<AtomicBool>,
    progress: &'a Progress,
    allowed: f64,
    used: f64,
    /// How far the winding was above ambient when the rig was left last \[K\]: whoever opens it anew
    /// tells the safety layer.
    rise: Cell<f64>,
}

impl<'a> Axis<'a> {
    /// A rig that may be driven for `allowed` seconds, `used` of which are over.
    pub fn new(
        rig: &RigChoice,
        setup: RigSetup,
        stop: Arc<AtomicBool>,
        progress: &'a Progress,
        (allowed, used): (f64, f64),
    ) -> Self {
        progress.advance(used);
        Self {
            opening: Opening { rig: rig.clone(), setup, expected: None, encoder_alone: false },
            stop,
            progress,
            allowed,
            used,
            rise: Cell::new(0.0),
        }
    }

    /// Rig time that was used \[s\].
    #[must_use]
    pub const fn used(&self) -> f64 {
        self.used
    }

    /// Rig time that is left \[s\].
    #[must_use]
    pub fn left(&self) -> f64 {
        (self.allowed - self.used).max(0.0)
    }

    /// Says what is done now, on the bar.
    pub fn say(&self, stage: Stage, what: &str) {
        self.progress.stage(format!("{stage}: {what}"));
    }

    /// Readings are corrected by this from now on.
    pub fn calibrate(&mut self, calibration: Calibration) {
        let setup = &mut self.opening.setup;
        let before = setup.calibration.unwrap_or_default();
        // The ends turn with the encoder's sign.
        if before.encoder_sign != calibration.encoder_sign {
            setup.limits.travel = setup.limits.travel.map(|travel| Travel {
                min: -travel.max,
                max: -travel.min,
                ..travel
            });
        }
        setup.calibration = Some(calibration);
    }

    /// The encoder has nothing to be held against: a tachometer that shows no motion, or a torque
    /// sensor that shows no friction, is no fault from now on.
    pub fn trust_the_encoder_alone(&mut self) {
        self.opening.encoder_alone = true;
    }

    /// Only this device is driven from now on.
    pub fn drive_only(&mut self, description: Option<RigDescription>) {
        self.opening.expected = description;
    }

    /// The shaft is to stay in there, by the rig's own count.
    pub fn stay_within(&mut self, travel: Option<Travel>) {
        self.opening.setup.limits.travel = travel;
    }

    /// Where the stages may be, as the readings are corrected; none where the travel has no ends.
    #[must_use]
    pub fn reach(&self) -> Option<Reach> {
        self.opening.setup.limits.travel.as_ref().map(Reach::within)
    }

    /// Whether the user wants it to end.
    #[must_use]
    pub fn is_stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    /// Opens the rig, looks at it, and closes it. Nothing moves. The travel that is `asked` for is
    /// counted from where the shaft stands \[rad\].
    ///
    /// # Errors
    /// [`CommissionError::Rig`] for a rig that is not there, or limits that contradict each other.
    pub fn look(&self, asked: Option<(f64, f64)>) -> Result<Known, CommissionError> {
        let mut opened = self.open()?;
        opened.limits.check(opened.rig.period())?;
        let known = Known {
            about: opened.about.clone(),
            description: opened.description.clone(),
            voltage: opened.limits.voltage,
            velocity: opened.limits.velocity,
            torque: opened.sensors.torque,
            period: opened.rig.period(),
            winding: opened.limits.motor,
            travel: opened.limits.travel,
        };
        if known.travel.is_none() && asked.is_none() {
            return Ok(known);
        }
        // Where it stands is no matter for the safety layer while nothing moves.
        opened.limits.travel = None;
        let bench = Bench(BenchRig::new(opened, Arc::clone(&self.stop))?);
        let place = bench.place()?;
        let travel = asked.map(|asked| reach::around(place, asked)).or(known.travel);
        travel.as_ref().map_or(Ok(()), |travel| reach::check(travel, place))?;
        Ok(Known { travel, ..known })
    }

    /// Refuses what takes more rig time than is left.
    ///
    /// # Errors
    /// [`CommissionError::OutOfTime`].
    pub fn reserve(&self, stage: Stage, needed: f64) -> Result<(), CommissionError> {
        let left = self.left();
        if needed <= left {
            return Ok(());
        }
        Err(CommissionError::OutOfTime { stage, needed, left, allowed: self.allowed })
    }

    /// A session of the steps by which signs are found, at most `volts`. Where the line fails they
    /// begin anew.
    ///
    /// # Errors
    /// What the steps or the rig say.
    pub fn session<T>(
        &mut self,
        volts: f64,
        work: impl Fn(&mut Session<'_>, &dyn Fn(&str)) -> Result<T, RigSetupError>,
    ) -> Result<T, CommissionError> {
        let mut repeats = Repeats::none();
        let mut opened = self.open_or_wait(&mut repeats)?;
        loop {
            let heard = Cell::new(SystemTime::now());
            match self.met(opened, volts, &heard, &work) {
                Ok(found) => return Ok(found),
                Err(error) => {
                    opened = self.opened_anew(&mut repeats, error, heard.get())?;
                }
            }
        }
    }

    /// The same once; when the rig was `heard` last is told.
    fn met<T>(
        &mut self,
        mut opened: Opened,
        volts: f64,
        heard: &Cell<SystemTime>,
        work: impl Fn(&mut Session<'_>, &dyn Fn(&str)) -> Result<T, RigSetupError>,
    ) -> Result<T, CommissionError> {
        // A speed whose sign is wrong would count as braking, which heats most: while signs are
        // unknown the winding is counted as at rest.
        opened.limits.motor =
            opened.limits.motor.map(|motor| MotorThermal { back_emf: f64::MIN_POSITIVE, ..motor });
        let stop = Arc::clone(&self.stop);
        let mut session = Session::new(opened, volts, &stop)?;
        session.warm(self.rise.get());
        let first = session.step(|_| 0.0)?.time;
        let say = |text: &str| self.progress.stage(format!("meet: {text}"));
        let outcome = work(&mut session, &say);
        heard.set(session.heard());
        let last = session.step(|_| 0.0).map_or(first, |seen| seen.time);
        self.rise.set(session.winding_rise().unwrap_or_default());
        self.count(last - first);
        Ok(outcome?)
    }

    /// The rig for several turns; it is at zero volts between them and afterwards.
    ///
    /// # Errors
    /// [`CommissionError::Rig`] if it refuses, [`CommissionError::LineLost`] if it is not there.
    pub fn bench(&self) -> Result<Bench, CommissionError> {
        let opened = self.open_or_wait(&mut Repeats::none())?;
        let stop = Arc::clone(&self.stop);
        let bench = if self.opening.comes_back() {
            let again = self.opening.clone();
            BenchRig::reopening(opened, stop, Box::new(move || again.open()))?
        } else {
            // A card whose watchdog expired is not driven again by itself.
            BenchRig::new(opened, stop)?
        };
        bench.warm(self.rise.get());
        Ok(Bench(bench))
    }

    /// Drives a turn by `volts` of the time since it began, for `seconds`.
    ///
    /// # Errors
    /// [`CommissionError::OutOfTime`] before it begins, or what the rig says.
    pub fn excite(
        &mut self,
        bench: &Bench,
        stage: Stage,
        seconds: f64,
        volts: impl Fn(f64) -> f64,
    ) -> Result<Vec<Measurement>, CommissionError> {
        self.repeated(bench, |axis| axis.turn(bench, stage, seconds, |seen| volts(seen.time)))
    }

    /// The same by `volts` of what is seen, positions by the rig's own count. A turn that is
    /// repeated begins in cycle 0 again.
    ///
    /// # Errors
    /// As for [`excite`](Self::excite).
    pub fn answer(
        &mut self,
        bench: &Bench,
        stage: Stage,
        seconds: f64,
        mut volts: impl FnMut(&Measurement) -> f64,
    ) -> Result<Vec<Measurement>, CommissionError> {
        let counted = |seen: &Measurement| Measurement {
            encoder_position: seen.encoder_position + bench.origin(),
            ..*seen
        };
        let seen = self.repeated(bench, |axis| {
            axis.turn(bench, stage, seconds, |seen| volts(&counted(seen)))
        })?;
        Ok(seen.iter().map(counted).collect())
    }

    /// Lets the position loop of `options` follow `reference` for `seconds`; `friction` is what the
    /// reference is believed to meet, for the controller's compensation \[V\].
    ///
    /// # Errors
    /// As for [`excite`](Self::excite).
    pub fn follow(
        &mut self,
        bench: &Bench,
        stage: Stage,
        seconds: f64,
        options: ControllerOptions,
        reference: impl Fn(f64) -> Reference,
        friction: impl Fn(&Reference) -> f64,
    ) -> Result<Vec<Measurement>, CommissionError> {
        self.repeated(bench, |axis| {
            axis.followed(bench, stage, seconds, options, &reference, &friction)
        })
    }

    fn followed(
        &mut self,
        bench: &Bench,
        stage: Stage,
        seconds: f64,
        options: ControllerOptions,
        reference: impl Fn(f64) -> Reference,
        friction: impl Fn(&Reference) -> f64,
    ) -> Result<Vec<Measurement>, CommissionError> {
        let mut controller = Controller::new(options)?;
        self.turn(bench, stage, seconds, |seen| {
            let wanted = reference(seen.time);
            let feedback = Feedback {
                position: seen.encoder_position,
                velocity: seen.tachometer_velocity,
                friction: friction(&wanted),
                cycle: Some(seen.cycle),
            };
            controller.step(&wanted, &feedback).total
        })
    }

    /// Goes smoothly to a place by the rig's own count \[rad\], if the shaft is not within `near` of
    /// it, no faster than `fastest` [rad/s] in the mean.
    ///
    /// # Errors
    /// As for [`excite`](Self::excite).
    pub fn go(
        &mut self,
        bench: &Bench,
        stage: Stage,
        options: ControllerOptions,
        (to, near): (f64, f64),
        fastest: f64,
    ) -> Result<(), CommissionError> {
        for _ in 0..GOES {
            // From where the shaft is by then.
            let is_there = self.repeated(bench, |axis| {
                let way = to - bench.place()?;
                if way.abs() <= near {
                    return Ok(true);
                }
                let duration = (way.abs() / fastest).clamp(SHORTEST_GO, LONGEST_GO);
                let wave = Waveform::MovePosition { position: way, at: 0.0, duration };
                let seconds = duration + SETTLED;
                axis.followed(bench, stage, seconds, options, |time| wave.at(time), |_| 0.0)?;
                Ok(false)
            })?;
            if is_there {
                return Ok(());
            }
        }
        Ok(())
    }

    fn turn(
        &mut self,
        bench: &Bench,
        stage: Stage,
        seconds: f64,
        mut volts: impl FnMut(&Measurement) -> f64,
    ) -> Result<Vec<Measurement>, CommissionError> {
        self.cool(bench, stage)?;
        self.reserve(stage, seconds + REST)?;
        let mut rig = bench.0.lend()?;
        let cycles = (seconds / rig.period()).round() as usize;
        let mut seen = Vec::with_capacity(cycles + 1);
        let heat = bench.0.winding().map(Heat);
        let mut drive = |seen: &mut Vec<Measurement>| -> Result<(), RigError> {
            for _ in 0..cycles {
                let now = rig.measure();
                rig.apply(volts(&now))?;
                seen.push(now);
                // What would be too hot is ended here, and what was seen is short.
                let rise = rig.winding_rise();
                if heat.zip(rise).is_some_and(|(heat, rise)| heat.is_hot(rise)) {
                    break;
                }
            }
            // What was applied in the last cycle.
            let last = rig.measure();
            seen.push(last);
            if last.fault {
                // Says why, where the reading did not come.
                rig.apply(0.0)?;
            }
            rig.halt()
        };
        let outcome = drive(&mut seen);
        drop(rig);
        self.left_warm(bench);
        self.count(REST + seen.len() as f64 * bench.0.period());
        outcome?;
        Ok(seen)
    }

    /// Runs a loop of `build` for `seconds`; its cycles from `from` seconds on.
    ///
    /// # Errors
    /// As for [`excite`](Self::excite).
    pub fn track(
        &mut self,
        bench: &Bench,
        stage: Stage,
        (from, seconds): (f64, f64),
        build: impl Fn(Box<dyn Rig + Send>) -> Result<Box<dyn RunningLoop>, CommissionError>,
    ) -> Result<Vec<CycleSample>, CommissionError> {
        self.repeated(bench, |axis| axis.tracked(bench, stage, (from, seconds), &build))
    }

    fn tracked(
        &mut self,
        bench: &Bench,
        stage: Stage,
        (from, seconds): (f64, f64),
        build: impl Fn(Box<dyn Rig + Send>) -> Result<Box<dyn RunningLoop>, CommissionError>,
    ) -> Result<Vec<CycleSample>, CommissionError> {
        self.cool(bench, stage)?;
        self.reserve(stage, seconds + REST)?;
        let mut running = build(bench.0.lend()?)?;
        let cycles = (seconds / running.period()).round() as usize;
        let skipped = (from / running.period()).round() as usize;
        let mut seen = Vec::with_capacity(cycles);
        let mut outcome = Ok(());
        let mut done = 0;
        for cycle in 0..cycles {
            match running.step() {
                Ok(now) if cycle >= skipped => seen.push(now),
                Ok(_) => {}
                Err(error) => {
                    outcome = Err(error);
                    break;
                }
            }
            done = cycle + 1;
        }
        let stopped = running.stop();
        drop(running);
        self.left_warm(bench);
        self.count(REST + done as f64 * bench.period());
        outcome?;
        stopped?;
        Ok(seen)
    }

    /// Rests while the winding is warm.
    fn cool(&mut self, bench: &Bench, stage: Stage) -> Result<(), CommissionError> {
        let heat = bench.0.winding().map(Heat);
        let pause = heat.zip(bench.0.winding_rise()).map_or(0.0, |(heat, rise)| heat.pause(rise));
        if pause == 0.0 {
            return Ok(());
        }
        self.reserve(stage, pause)?;
        self.say(stage, &format!("the motor is warm; it rests for {pause:.0} s"));
        let mut rig = bench.0.lend()?;
        let cycles = (pause / rig.period()).round() as usize;
        for _ in 0..cycles {
            rig.measure();
            rig.apply(0.0)?;
        }
        drop(rig);
        self.left_warm(bench);
        self.count(pause);
        Ok(())
    }

    /// Remembers how warm the winding is.
    fn left_warm(&self, bench: &Bench) {
        if let Some(rise) = bench.0.winding_rise() {
            self.rise.set(rise);
        }
    }

    fn count(&mut self, seconds: f64) {
        self.used += seconds;
        self.progress.advance(seconds);
    }

    fn open(&self) -> Result<Opened, CommissionError> {
        if self.is_stopped() {
            return Err(RigSetupError::Stopped.into());
        }
        Ok(self.opening.open()?)
    }

    /// The same, waited for where it was there before and does not answer.
    fn open_or_wait(&self, repeats: &mut Repeats) -> Result<Opened, CommissionError> {
        let asked = SystemTime::now();
        self.open().or_else(|error| self.opened_anew(repeats, error, asked))
    }
}

/// A rig that is open for several turns. Dropped, it leaves zero volts.
pub struct Bench(BenchRig);

impl Bench {
    /// Where the shaft is by the rig's own count \[rad\].
    ///
    /// # Errors
    /// [`CommissionError::Rig`] if it refuses to say.
    pub fn place(&self) -> Result<f64, CommissionError> {
        if let Some(place) = self.0.place() {
            return Ok(place);
        }
        drop(self.0.lend()?);
        Ok(self.0.place().unwrap_or_default())
    }

    /// Where it was when the turn that goes on, or the last one, began \[rad\]: readings of a turn
    /// are counted from there.
    #[must_use]
    pub fn origin(&self) -> f64 {
        self.0.origin().unwrap_or_default()
    }

    /// What the safety layer allows \[V\].
    #[must_use]
    pub const fn voltage_limit(&self) -> f64 {
        self.0.voltage_limit()
    }

    /// Period of the cycle \[s\].
    #[must_use]
    pub const fn period(&self) -> f64 {
        self.0.period()
    }
}
