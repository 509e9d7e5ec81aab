//! The simulated test bed: how long chosen blocks take to the intervals of `run characterise`.
//!
//! Both tell the four parameters of the Stribeck curve with 95 % intervals from their own scatter.
//! The fixed protocol reads the torque sensor, the commission the voltage: what the gains of the
//! sensor and of the converter are known to is in neither. The designed side counts besides how its
//! curve depends on each of its speeds.

use std::fmt;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use experiment_runner::characterise::TorqueReading;
use experiment_runner::constant_velocity::{SteadyError, SteadyJob, SteadyRun};
use experiment_runner::control_loop::EPOCH_NS;
use experiment_runner::protocol::ConstantVelocityProtocol;
use experiment_runner::test_bed::TestBed;
use friction_ident::{StribeckFit, StribeckOptions, StribeckParameter, TorqueSource, fit_stribeck};
use friction_model::{AnyModel, ModelName, Motor};
use rig_setup::RigSetupError;
use serde::Serialize;
use work::progress::Progress;
use work::sequencer::{Completion, run_in_order};

use crate::axis::Axis;
use crate::friction::wanted::{CurveParameter, Wanted};
use crate::friction::{Curve, Friction, Point, friction, scattered};
use crate::{Asked, CommissionError, Ranged, Stage, drive, meet};

/// The part of the protocol's rig time that the designed experiment may take.
pub const PART: f64 = 1.0 / 20.0;
/// Blocks before which no curve is told.
const FEWEST: usize = 8;
/// Intervals that no experiment reaches: blocks are measured until the time is up.
const WITHOUT_END: &str = "f_c:0.01%,f_s:0.01%,v_s:0.01%,slope:0.01%";

/// A parameter as both tell it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Row {
    /// Its name.
    pub name: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// What the test bed has; none where its friction has no such parameter.
    pub truth: Option<f64>,
    /// The fixed protocol.
    pub protocol: Ranged,
    /// The designed experiment, when its intervals were reached, else at its end.
    pub designed: Ranged,
}

/// Both beside each other.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Beside {
    /// Rig time of the fixed protocol \[s\].
    pub protocol_seconds: f64,
    /// Rig time that the designed experiment had, meeting the rig and its drive included \[s\].
    pub allowed: f64,
    /// Rig time after which all its intervals were at most as wide, and the blocks of it; none
    /// where they never were.
    pub reached: Option<(f64, usize)>,
    /// The parameters, in N m and rad/s.
    pub rows: Vec<Row>,
}

/// Does both on the simulated test bed that was asked for.
///
/// # Errors
/// [`CommissionError`] if a stage fails, or the user stops it.
pub fn beside(
    asked: &Asked,
    protocol: &ConstantVelocityProtocol,
    stop: &Arc<AtomicBool>,
    progress: &Progress,
) -> Result<Beside, CommissionError> {
    let fixed = characterised(asked, protocol, stop, progress)?;
    let allowed = PART * protocol.rig_seconds();
    let points = designed(asked, allowed, stop, progress)?;
    let told = |points: &[Point]| Ok::<_, CommissionError>(in_newton_metres(&scattered(points)?));
    let widths = widths(&fixed);
    let mut reached = None;
    for blocks in FEWEST..=points.len() {
        let rows = told(&points[..blocks])?;
        if rows.iter().zip(widths).all(|(ranged, width)| half(ranged) <= width) {
            reached = Some((blocks, rows));
            break;
        }
    }
    let (blocks, rows) = match reached {
        Some((blocks, rows)) => (Some(blocks), rows),
        None => (None, told(&points)?),
    };
    let friction = &asked.setup.friction;
    let row = |((parameter, (name, unit)), designed)| Row {
        name,
        unit,
        truth: friction.parameter(name),
        protocol: interval(&fixed, parameter),
        designed,
    };
    let names = [("f_s", "N m"), ("f_c", "N m"), ("v_s", "rad/s"), ("f_v", "N m s/rad")];
    let rows = StribeckParameter::ALL.into_iter().zip(names).zip(rows).map(row).collect();
    let reached = blocks.map(|blocks| (points[blocks - 1].time, blocks));
    Ok(Beside { protocol_seconds: protocol.rig_seconds(), allowed, reached, rows })
}

/// The curve that the constant velocities of `run characterise` give: of the first set, which is
/// the one that identifies.
fn characterised(
    asked: &Asked,
    protocol: &ConstantVelocityProtocol,
    stop: &Arc<AtomicBool>,
    progress: &Progress,
) -> Result<StribeckFit, CommissionError> {
    let simulation = asked.setup.simulation;
    let bed = TestBed {
        simulation,
        friction: asked.setup.friction,
        controller: Default::default(),
        estimator: Default::default(),
    };
    let observer = AnyModel::test_bed(ModelName::Proposed);
    let reading = TorqueReading::new(
        TorqueSource::Sensor,
        &simulation.drive,
        &simulation.sensors,
        TorqueReading::RELATIVE_ERRORS,
    );
    progress.stage(format!("the fixed protocol: {:.0} s of rig time", protocol.rig_seconds()));
    let jobs: Vec<(u64, SteadyJob)> =
        (0..).zip(SteadyJob::all(protocol)).filter(|(_, job)| job.set == 0).collect();
    let workers = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    let mut runs: Vec<SteadyRun> = Vec::with_capacity(jobs.len());
    let work = |&(index, job): &(u64, SteadyJob)| {
        let seed = asked.setup.simulation.seed.wrapping_add(index);
        let task = (SteadyJob::MODE, job.reference());
        let control = bed.control_loop(task.0, task.1, &observer, None, seed, EPOCH_NS)?;
        job.run(protocol, &reading, control, |_| {}).map_err(of_steps)
    };
    let completion = run_in_order(&jobs, workers, stop, work, |_, run| {
        runs.push(run);
        Ok::<_, CommissionError>(())
    })?;
    if completion != Completion::All {
        return Err(RigSetupError::Stopped.into());
    }
    let points: Vec<_> = runs.iter().map(SteadyRun::point).collect();
    fit_stribeck(&points, &StribeckOptions::default())
        .map_err(|source| CommissionError::Identification { stage: Stage::Friction, source })
}

fn of_steps(error: SteadyError) -> CommissionError {
    match error {
        SteadyError::Torque(source) => {
            CommissionError::Identification { stage: Stage::Friction, source }
        }
        SteadyError::Rig(error) => error.into(),
        error => CommissionError::Asked(error.to_string()),
    }
}

/// Meet, drive and friction for so long; what the blocks measured.
fn designed(
    asked: &Asked,
    allowed: f64,
    stop: &Arc<AtomicBool>,
    progress: &Progress,
) -> Result<Vec<Point>, CommissionError> {
    let known = crate::run::look(asked)?;
    let rig = &asked.rig;
    let mut axis = Axis::new(rig, asked.setup, Arc::clone(stop), progress, (allowed, 0.0));
    let met = meet::meet(&mut axis, &known, (None, None), |_| Ok(()))?;
    axis.calibrate(met.calibration);
    let drive = drive::drive(&mut axis, &known, &met)?;
    let wanted: Wanted =
        WITHOUT_END.parse().map_err(|error| CommissionError::Asked(format!("{error}")))?;
    let parts = (&known, &met, &drive);
    let Friction { points, .. } =
        friction(&mut axis, parts, &wanted, 0.0, Default::default(), |_, _| Ok(()))?;
    Ok(points)
}

/// The curve in volts as the test bed's motor turns it into torques: f_s, f_c, v_s, f_v.
fn in_newton_metres(curve: &Curve) -> [Ranged; 4] {
    let motor = Motor::SRV02;
    let volts = motor.volts_per_newton_metre();
    let torque = |ranged: Ranged, less: f64| Ranged {
        value: (ranged.value - less) / volts,
        low: ranged.low.map(|low| (low - less) / volts),
        high: ranged.high.map(|high| (high - less) / volts),
    };
    let of = |parameter: CurveParameter| parameter.of(curve);
    [
        torque(of(CurveParameter::FS), 0.0),
        torque(of(CurveParameter::FC), 0.0),
        of(CurveParameter::VS),
        torque(of(CurveParameter::Slope), motor.back_emf()),
    ]
}

fn interval(fit: &StribeckFit, parameter: StribeckParameter) -> Ranged {
    let estimate = fit.estimate(parameter);
    let (low, high) = estimate.interval.unwrap_or((f64::NEG_INFINITY, f64::INFINITY));
    Ranged::new(estimate.value, low, high)
}

/// Half the widths of the fixed protocol's intervals.
fn widths(fit: &StribeckFit) -> [f64; 4] {
    StribeckParameter::ALL.map(|parameter| half(&interval(fit, parameter)))
}

/// Half an interval; without end where an end is open.
fn half(ranged: &Ranged) -> f64 {
    ranged.low.zip(ranged.high).map_or(f64::INFINITY, |(low, high)| 0.5 * (high - low))
}

impl fmt::Display for Beside {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let told = |ranged: &Ranged| {
            let value = report::numbers::significant(ranged.value, 4);
            format!("{value} ± {}", report::numbers::significant(half(ranged), 2))
        };
        writeln!(
            f,
            "{:<16}{:<24}{:<24}test bed",
            "", "run characterise", "blocks that are chosen"
        )?;
        for row in &self.rows {
            let truth =
                row.truth.map_or("-".to_owned(), |truth| report::numbers::significant(truth, 4));
            let name = format!("{} [{}]", row.name, row.unit);
            writeln!(f, "{name:<16}{:<24}{:<24}{truth}", told(&row.protocol), told(&row.designed))?;
        }
        let whole = self.protocol_seconds;
        match self.reached {
            Some((seconds, blocks)) => writeln!(
                f,
                "rig time        {whole:<24.0}{seconds:.0} s, {blocks} blocks: 1/{:.0} of it",
                whole / seconds
            ),
            None => {
                writeln!(f, "rig time        {whole:<24.0}not reached in {:.0} s", self.allowed)
            }
        }
    }
}
