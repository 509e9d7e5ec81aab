//! Turns: what the rig is driven by, and what it shows.

use controller::{Controller, ControllerOptions, Feedback, Reference};
use experiment_runner::control_loop::RunningLoop;
use experiment_runner::cycle::CycleSample;
use experiment_runner::waveform::Waveform;
use report::numbers::significant;
use rig_driver::{Measurement, Rig, RigError};
use rig_setup::{Heat, REST};

use super::{Axis, Bench};
use crate::board::{Board, Cycle};
use crate::{CommissionError, Stage};

/// Shortest and longest way to a place \[s\], time to settle there, and how often it is tried.
const SHORTEST_GO: f64 = 0.6;
const LONGEST_GO: f64 = 8.0;
const SETTLED: f64 = 0.5;
const GOES: u32 = 2;
/// Time through which a torque sensor that shows friction never stands still \[s\].
const STANDS: f64 = 3.0;

/// A rig that is lent for one turn.
type Lent = Box<dyn Rig + Send>;

impl Axis<'_> {
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
        self.repeated(bench, |axis| {
            axis.turn(bench, stage, seconds, |_| None, |seen| volts(seen.time))
        })
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
            axis.turn(bench, stage, seconds, |_| None, |seen| volts(&counted(seen)))
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
        let followed =
            |seen: &Measurement| Some((reference(seen.time).position, seen.encoder_position));
        self.turn(bench, stage, seconds, followed, |seen| {
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

    /// Runs a loop of `build` for `seconds`; its cycles from `from` seconds on.
    ///
    /// # Errors
    /// As for [`excite`](Self::excite).
    pub fn track(
        &mut self,
        bench: &Bench,
        stage: Stage,
        (from, seconds): (f64, f64),
        build: impl Fn(Lent) -> Result<Box<dyn RunningLoop>, CommissionError>,
    ) -> Result<Vec<CycleSample>, CommissionError> {
        self.repeated(bench, |axis| {
            let watch = axis.watch();
            axis.in_turn(bench, stage, seconds, |rig| match build(rig) {
                Ok(running) => followed(running, (from, seconds), &watch),
                Err(error) => (0, Err(error)),
            })
        })
    }

    fn turn(
        &mut self,
        bench: &Bench,
        stage: Stage,
        seconds: f64,
        followed: impl Fn(&Measurement) -> Option<(f64, f64)>,
        volts: impl FnMut(&Measurement) -> f64,
    ) -> Result<Vec<Measurement>, CommissionError> {
        let heat = bench.0.winding().map(Heat);
        let watch = self.watch();
        let seen = self.in_turn(bench, stage, seconds, |rig| {
            let mut seen = Vec::with_capacity((seconds / rig.period()).round() as usize + 1);
            let outcome = driven(rig, seconds, heat, volts, |now| {
                watch.saw(now, followed(now));
                seen.push(*now);
            });
            (seen.len(), outcome.map(|()| seen).map_err(CommissionError::from))
        })?;
        self.heed_torque(&seen, bench.period());
        Ok(seen)
    }

    /// Says once where a torque sensor stands still while the shaft goes to and fro.
    fn heed_torque(&self, seen: &[Measurement], period: f64) {
        let Some(first) = seen.first().filter(|_| self.torque.get()) else { return };
        let lasts = seen.len() as f64 * period;
        if lasts < STANDS || seen.iter().any(|now| now.torque != first.torque) {
            return;
        }
        self.torque.set(false);
        let said = format!(
            "the torque sensor stood at {} N m through a turn in which the shaft went to and fro: it is at the end of its range, or its plug came off. Nothing depends on it here",
            significant(first.torque, 3)
        );
        self.tell(&said);
        self.noticed.borrow_mut().push(said);
    }

    /// A turn of `seconds`, begun cool and counted: `work` has the rig, and says how many cycles it
    /// drove beside what came of them.
    fn in_turn<T>(
        &mut self,
        bench: &Bench,
        stage: Stage,
        seconds: f64,
        work: impl FnOnce(Lent) -> (usize, Result<T, CommissionError>),
    ) -> Result<T, CommissionError> {
        self.cool(bench, stage)?;
        self.reserve(stage, seconds + REST)?;
        let (cycles, outcome) = work(bench.0.lend()?);
        self.left_warm(bench);
        self.count(REST + cycles as f64 * bench.period());
        outcome
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

    /// What shows the cycles of a turn that begins now to whoever watches.
    pub(super) fn watch(&self) -> Watch {
        Watch { board: self.board().clone(), before: self.used() }
    }

    /// Remembers how warm the winding is.
    fn left_warm(&self, bench: &Bench) {
        if let Some(rise) = bench.0.winding_rise() {
            self.rise.set(rise);
        }
    }
}

/// Shows the cycles of one turn to whoever watches.
pub(super) struct Watch {
    board: Board,
    before: f64,
}

impl Watch {
    pub(super) fn saw(&self, seen: &Measurement, followed: Option<(f64, f64)>) {
        self.board.cycle(Cycle { before: self.before, seen: *seen, followed });
    }
}

/// Drives for `seconds`, or until the winding is `heat`ed: what would be too hot is ended here, and
/// what was seen is short. `saw` is told of each cycle.
fn driven(
    mut rig: Lent,
    seconds: f64,
    heat: Option<Heat>,
    mut volts: impl FnMut(&Measurement) -> f64,
    mut saw: impl FnMut(&Measurement),
) -> Result<(), RigError> {
    let cycles = (seconds / rig.period()).round() as usize;
    for _ in 0..cycles {
        let now = rig.measure();
        rig.apply(volts(&now))?;
        saw(&now);
        let rise = rig.winding_rise();
        if heat.zip(rise).is_some_and(|(heat, rise)| heat.is_hot(rise)) {
            break;
        }
    }
    // What was applied in the last cycle.
    let last = rig.measure();
    saw(&last);
    if last.fault {
        // Says why, where the reading did not come.
        rig.apply(0.0)?;
    }
    rig.halt()
}

/// Runs a loop for `seconds`: how many cycles it drove, and those from `from` on.
fn followed(
    mut running: Box<dyn RunningLoop>,
    (from, seconds): (f64, f64),
    watch: &Watch,
) -> (usize, Result<Vec<CycleSample>, CommissionError>) {
    let cycles = (seconds / running.period()).round() as usize;
    let skipped = (from / running.period()).round() as usize;
    let mut seen = Vec::with_capacity(cycles);
    let mut outcome = Ok(());
    let mut done = 0;
    for cycle in 0..cycles {
        let step = running.step();
        if let Ok(now) = &step {
            let feedback = now.measurement.encoder_position;
            watch.saw(&now.measurement, Some((now.reference.position, feedback)));
        }
        match step {
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
    (done, outcome.and(stopped).map(|()| seen).map_err(CommissionError::from))
}
