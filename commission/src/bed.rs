//! The controller of an axis: the loop, and what is fed forward beside it.

use controller::design::LinearDrive;
use controller::{Controller, ControllerOptions, Load, PlantInverse};
use experiment_runner::control_loop::{ControlLoop, EPOCH_NS, RunningLoop};
use experiment_runner::cycle::CycleSample;
use experiment_runner::test_bed::TestBedError;
use experiment_runner::waveform::Waveform;
use friction_ident::statistics::root_mean_square;
use friction_model::{AnyModel, Stribeck, StribeckParameters, TimeStep};
use friction_observer::{EstimatorOptions, FrictionEstimator, NominalDrive, Technique};
use rig_driver::Rig;
use rig_setup::REST;
use serde::{Deserialize, Serialize};

use crate::axis::{Axis, Bench, Known};
use crate::drive::Drive;
use crate::feedback::FedBack;
use crate::friction::{Curve, Friction, plant};
use crate::identified::{Identified, Levels, Settings};
use crate::loop_design::{LoopDesign, Plant};
use crate::model::Chosen;
use crate::reach::Reach;
use crate::{CommissionError, Stage};

/// Amplitude of the task \[rad\], where the shaft is fast enough.
const AMPLITUDE: f64 = 0.2;
/// Share of the fastest steady speed that the task needs.
const SPEED_SHARE: f64 = 0.4;
/// Its period \[s\].
const PERIOD: f64 = 2.0;
/// Its length, and when it begins to count \[s\].
const SECONDS: f64 = 6.0;
const FROM: f64 = 2.0;

/// How near its middle a task begins where the travel has ends, as a share of it.
const NEAR: f64 = 0.1;
/// Part of a travel that the amplitude of the task may be: it has room for a move of as much from
/// beside the middle, and for what overshoots.
pub const PART: f64 = 0.25;

/// The least kinetic level that is believed beside another gain, as a share of what the curve says.
const LEAST: f64 = 0.2;
/// How many times as wide as that of the tones the interval of the curve's slope is before the tones
/// tell the gain.
const WIDER: f64 = 2.0;

/// By what share more than what was seen the voltage that breaks the shaft loose has to be.
const MORE: f64 = 0.05;
/// Where a dip ends that was not seen, as a share of the slowest speed that was followed.
const ENDS: f64 = 0.5;

/// A static level that no block showed, because the shaft follows no speed that is as slow.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Stuck {
    /// The level \[V\]: what broke the shaft loose.
    pub f_s: f64,
    /// Stribeck velocity [rad/s].
    pub v_s: f64,
}

/// What is fed forward.
#[derive(
    Debug,
    Clone,
    Copy,
    PartialEq,
    Eq,
    PartialOrd,
    Ord,
    Serialize,
    Deserialize,
    strum::Display,
    strum::VariantArray,
)]
#[serde(rename_all = "kebab-case")]
#[strum(serialize_all = "kebab-case")]
pub enum Arm {
    /// Nothing: the linear gains alone.
    Linear,
    /// The reference through the inverse of the drive.
    Reference,
    /// And the friction that the reference will meet.
    Friction,
    /// And the load at its place.
    Load,
}

/// The controller and the friction model of an axis, in every arm.
#[derive(Debug, Clone, Copy)]
pub struct Bed {
    plant: Plant,
    design: LoopDesign,
    friction: AnyModel,
    levels: Levels,
    amplitude: f64,
    resting_angle: f64,
    fed_back: Option<FedBack>,
    load: Option<Load>,
    level: f64,
    /// Voltage that breaks the shaft loose, whichever way \[V\].
    breakaway: f64,
}

impl Bed {
    /// Of what the stages found.
    ///
    /// # Errors
    /// [`CommissionError::Unusable`] for a curve that is no friction.
    pub fn of(
        known: &Known,
        drive: &Drive,
        (friction, chosen): (&Friction, &Chosen),
        design: LoopDesign,
    ) -> Result<Self, CommissionError> {
        let curve = &chosen.curve;
        let (f_s, v_s) = seen(curve, friction.speeds.0);
        let plant = refined(known, drive, chosen);
        // What another gain takes from the slope is friction at the speeds that were measured.
        let taken = (curve.slope.value - 1.0 / plant.drive.gain) * friction.mean_speed();
        let f_c = (curve.f_c.value + taken).max(LEAST * curve.f_c.value);
        let levels = (f_s - curve.f_c.value + f_c, f_c);
        let load = chosen.structure.as_ref().and_then(|structure| structure.load);
        let amplitude = amplitude(known, friction);
        Ok(Self::new(plant, design, levels, (v_s, 2.0), amplitude)?.carrying(load))
    }

    /// Of a plant, the static and the kinetic level \[V\], velocity [rad/s] and shape of the dip, and
    /// the amplitude of the task \[rad\].
    ///
    /// # Errors
    /// [`CommissionError::Unusable`] for a curve that is no friction.
    pub fn new(
        plant: Plant,
        design: LoopDesign,
        (f_s, f_c): (f64, f64),
        (v_s, delta): (f64, f64),
        amplitude: f64,
    ) -> Result<Self, CommissionError> {
        // Viscous friction is in the gain of the drive.
        let parameters = StribeckParameters { f_s, f_c, v_s, delta, f_v: 0.0 };
        let friction = Stribeck::try_from(parameters).map_err(|error| {
            CommissionError::Unusable { stage: Stage::Control, why: error.to_string() }
        })?;
        Ok(Self {
            plant,
            design,
            friction: AnyModel::Stribeck(friction),
            levels: Levels { f_s, f_c, v_s, delta },
            amplitude,
            resting_angle: plant.encoder_step,
            fed_back: None,
            load: None,
            level: 1.0,
            breakaway: f_s,
        })
    }

    /// The same with an integral that stands still up to that error \[rad\] while the reference
    /// does.
    #[must_use]
    pub const fn resting(self, resting_angle: f64) -> Self {
        Self { resting_angle, ..self }
    }

    /// The same of a shaft that breaks loose at that voltage, whichever way it is pushed \[V\].
    #[must_use]
    pub const fn breaking_loose(self, breakaway: f64) -> Self {
        Self { breakaway: self.breakaway.max(breakaway), ..self }
    }

    /// The same with the voltage that breaks the shaft loose as its static level, where that is more than
    /// was seen at the `slowest` speed that was followed [rad/s]: the dip ends below it. None where what
    /// was seen goes on to rest.
    #[must_use]
    pub fn stuck(&self, slowest: f64) -> Option<Stuck> {
        let Levels { f_s, v_s, .. } = self.levels;
        let hidden = f_s <= self.levels.f_c || v_s >= slowest;
        let more = self.breakaway > (1.0 + MORE) * f_s;
        (hidden && more).then_some(Stuck { f_s: self.breakaway, v_s: ENDS * slowest })
    }

    /// The same with that static level; as it is for none.
    ///
    /// # Errors
    /// As for [`new`](Self::new).
    pub fn sticking(self, stuck: Option<Stuck>) -> Result<Self, CommissionError> {
        let Some(Stuck { f_s, v_s }) = stuck else { return Ok(self) };
        let Levels { f_c, delta, .. } = self.levels;
        let other = Self::new(self.plant, self.design, (f_s, f_c), (v_s, delta), self.amplitude)?;
        Ok(Self { friction: other.friction, levels: other.levels, ..self })
    }

    /// By what a shaft slips that the integral breaks loose \[rad\]: the proportional gain is a spring,
    /// which the difference of stick and kinetic level shortens. An integral that stands still up to that
    /// error does not break it loose once more on the other side.
    #[must_use]
    pub fn slip(&self) -> f64 {
        (self.breakaway - self.levels.f_c).max(0.0) / self.design.gains.k_p
    }

    /// The same with a load that depends on the place, by the rig's own count.
    #[must_use]
    pub const fn carrying(self, load: Option<Load>) -> Self {
        Self { load, ..self }
    }

    /// The load that depends on the place, where one was found.
    #[must_use]
    pub const fn load(&self) -> Option<Load> {
        self.load
    }

    /// The same with so much of the friction compensated, of what the curve says.
    #[must_use]
    pub const fn leveled(self, level: f64) -> Self {
        Self { level, ..self }
    }

    /// How much of the friction is compensated, of what the curve says.
    #[must_use]
    pub const fn level(&self) -> f64 {
        self.level
    }

    /// Those arms that differ here, the simplest first.
    #[must_use]
    pub fn arms(&self) -> Vec<Arm> {
        let differs = |arm: &Arm| *arm != Arm::Load || self.load.is_some();
        <Arm as strum::VariantArray>::VARIANTS.iter().copied().filter(differs).collect()
    }

    /// The same with another loop.
    #[must_use]
    pub fn with(self, design: LoopDesign) -> Self {
        let fed_back = self.fed_back.map(|fed| FedBack { design, ..fed });
        Self { design, fed_back, ..self }
    }

    /// The same with what is fed back, and the loop that it has; nothing where it is none.
    #[must_use]
    pub fn feeding_back(self, fed_back: Option<FedBack>) -> Self {
        Self { fed_back, design: fed_back.map_or(self.design, |fed| fed.design), ..self }
    }

    /// What is fed back.
    #[must_use]
    pub const fn fed_back(&self) -> Option<&FedBack> {
        self.fed_back.as_ref()
    }

    /// What was identified, to be simulated.
    #[must_use]
    pub const fn identified(&self) -> Identified {
        Identified { plant: self.plant, levels: self.levels }
    }

    /// The loop.
    #[must_use]
    pub const fn design(&self) -> &LoopDesign {
        &self.design
    }

    /// The plant that it is for.
    #[must_use]
    pub const fn plant(&self) -> &Plant {
        &self.plant
    }

    /// Error up to which the integral stands still while the reference does \[rad\]; one count at
    /// least, because the encoder shows no less.
    #[must_use]
    pub const fn resting_angle(&self) -> f64 {
        self.resting_angle
    }

    /// Angle of one count \[rad\].
    #[must_use]
    pub const fn encoder_step(&self) -> f64 {
        self.plant.encoder_step
    }

    /// The friction model; its forces are volts.
    #[must_use]
    pub const fn friction(&self) -> &AnyModel {
        &self.friction
    }

    /// Controller and estimator of an arm.
    #[must_use]
    pub fn settings(&self, arm: Arm) -> (ControllerOptions, EstimatorOptions) {
        let mut controller = self.design.controller(&self.plant);
        // Friction is told in volts: one of them overcomes one of them.
        controller.compensation.volts_per_newton_metre = 1.0;
        controller.resting_angle = self.resting_angle;
        controller.compensation.scale = self.level;
        controller.compensation.enabled = arm >= Arm::Friction;
        controller.inverse = match arm {
            Arm::Linear => PlantInverse::Off,
            _ => PlantInverse::Whole(self.plant.drive),
        };
        if arm == Arm::Load {
            controller.load = self.load.unwrap_or(Load::NONE);
        }
        if let Some(fed_back) = &self.fed_back {
            controller.compensation.enabled = true;
            controller.compensation.scale = 1.0;
            controller.inverse = PlantInverse::Whole(self.plant.drive);
            return (controller, fed_back.estimator(&self.plant, self.levels.f_s));
        }
        let LinearDrive { gain, time_constant } = self.plant.drive;
        let drive = NominalDrive { gain, time_constant, volts_per_newton_metre: 1.0 };
        let technique = Technique::Feedforward;
        (controller, EstimatorOptions { technique, drive, ..EstimatorOptions::default() })
    }

    /// One try of an arm: the root mean square error \[rad\].
    ///
    /// # Errors
    /// [`CommissionError`] if the rig refuses or the time is up.
    pub fn try_out(
        &self,
        axis: &mut Axis<'_>,
        bench: &Bench,
        stage: Stage,
        arm: Arm,
    ) -> Result<f64, CommissionError> {
        Ok(root_mean_square(&missed(&self.heard(axis, bench, stage, arm)?)))
    }

    /// The same, cycle by cycle.
    ///
    /// # Errors
    /// As for [`try_out`](Self::try_out).
    pub fn heard(
        &self,
        axis: &mut Axis<'_>,
        bench: &Bench,
        stage: Stage,
        arm: Arm,
    ) -> Result<Vec<CycleSample>, CommissionError> {
        self.track(axis, bench, stage, arm, self.sine(), (FROM, SECONDS))
    }

    /// Any task: what each cycle's encoder misses \[rad\], of the part of the time that is asked
    /// for.
    ///
    /// # Errors
    /// As for [`try_out`](Self::try_out).
    pub fn does(
        &self,
        axis: &mut Axis<'_>,
        bench: &Bench,
        stage: Stage,
        (arm, task): (Arm, Waveform),
        part: (f64, f64),
    ) -> Result<Vec<f64>, CommissionError> {
        Ok(missed(&self.track(axis, bench, stage, arm, task, part)?))
    }

    /// A smooth move by the task's amplitude, which is then held: what each cycle's encoder misses
    /// \[rad\], of the part of the time that is asked for.
    ///
    /// # Errors
    /// As for [`try_out`](Self::try_out).
    pub fn move_and_hold(
        &self,
        axis: &mut Axis<'_>,
        bench: &Bench,
        stage: Stage,
        (arm, forward): (Arm, bool),
        part: (f64, f64),
    ) -> Result<Vec<f64>, CommissionError> {
        self.does(axis, bench, stage, (arm, self.smooth_move(forward)), part)
    }

    /// The sine, and when it begins to count and ends \[s\].
    #[must_use]
    pub const fn counted() -> (f64, f64) {
        (FROM, SECONDS)
    }

    /// The slow sine with its reversals.
    #[must_use]
    pub const fn sine(&self) -> Waveform {
        Waveform::SinePosition {
            amplitude: self.amplitude,
            angular_frequency: std::f64::consts::TAU / PERIOD,
        }
    }

    /// Amplitude of the task \[rad\].
    #[must_use]
    pub const fn amplitude(&self) -> f64 {
        self.amplitude
    }

    /// The smooth move.
    #[must_use]
    pub const fn smooth_move(&self, forward: bool) -> Waveform {
        Waveform::MovePosition {
            position: if forward { self.amplitude } else { -self.amplitude },
            at: 0.5,
            duration: PERIOD,
        }
    }

    /// Highest speed of the sine [rad/s].
    #[must_use]
    pub const fn speed(&self) -> f64 {
        self.amplitude * std::f64::consts::TAU / PERIOD
    }

    /// The arm as a simulation takes it.
    #[must_use]
    pub fn simulated(&self, arm: Arm) -> Settings {
        let (mut controller, estimator) = self.settings(arm);
        // What was identified hangs nowhere.
        controller.load = Load::NONE;
        Settings { controller, estimator, friction: self.friction }
    }

    fn track(
        &self,
        axis: &mut Axis<'_>,
        bench: &Bench,
        stage: Stage,
        arm: Arm,
        task: Waveform,
        part: (f64, f64),
    ) -> Result<Vec<CycleSample>, CommissionError> {
        let (mut controller, estimator) = self.settings(arm);
        if let Some(reach) = axis.reach() {
            let place = (reach.middle(), NEAR * reach.length());
            let still = self.settings(Arm::Linear).0;
            axis.go(bench, stage, still, place, self.amplitude / PERIOD)?;
        }
        // A turn counts from where it begins.
        controller.load = controller.load.from(bench.place()?);
        axis.track(bench, stage, part, |rig: Box<dyn Rig + Send>| {
            let dt = TimeStep::new(rig.period()).map_err(TestBedError::from)?;
            let estimator = FrictionEstimator::new(&self.friction, estimator, dt)
                .map_err(TestBedError::from)?;
            let controller = Controller::new(controller)?;
            let running = ControlLoop::new(rig, estimator, controller, task, EPOCH_NS);
            Ok(Box::new(running) as Box<dyn RunningLoop>)
        })
    }
}

/// Static level \[V\] and Stribeck velocity [rad/s] of a curve that was seen from `slowest` [rad/s] on:
/// below that no more friction is believed than a dip has that ends there. Too much would push.
fn seen(curve: &Curve, slowest: f64) -> (f64, f64) {
    let (f_s, f_c, v_s) = (curve.f_s.value, curve.f_c.value, curve.v_s.value);
    if !curve.dips || slowest <= v_s {
        return (f_s, v_s);
    }
    let dip = (f_s - f_c) * (1.0 - (slowest / v_s).powi(2)).exp();
    (f_c + dip, slowest)
}

/// What each cycle's encoder misses of the reference \[rad\].
#[must_use]
pub fn missed(seen: &[CycleSample]) -> Vec<f64> {
    seen.iter().map(|now| now.reference.position - now.measurement.encoder_position).collect()
}

/// Amplitude of the task \[rad\].
#[must_use]
pub fn amplitude(known: &Known, friction: &Friction) -> f64 {
    let travel = known.travel.as_ref().map_or(f64::INFINITY, |t| Reach::within(t).length());
    AMPLITUDE
        .min(PART * travel)
        .min(SPEED_SHARE * friction.speeds.1 * PERIOD / std::f64::consts::TAU)
}

/// The plant with the gain of the friction curve, which is the better known, unless the speeds of the
/// blocks were too near each other for it; what the excitation told of the inertia, T/K, stays.
pub(crate) fn refined(known: &Known, drive: &Drive, chosen: &Chosen) -> Plant {
    let before = plant(known, drive);
    let slope = chosen.curve.slope;
    let width = |ranged: crate::Ranged| ranged.relative().unwrap_or(f64::INFINITY);
    let is_known = slope.value > 0.0 && width(slope) <= WIDER * width(drive.gain);
    let gain = if is_known { 1.0 / slope.value } else { before.drive.gain };
    let time_constant = before.drive.time_constant * gain / before.drive.gain;
    Plant { drive: LinearDrive { gain, time_constant }, ..before }
}

/// Rig time of one try, with the rest before it \[s\].
#[must_use]
pub fn seconds() -> f64 {
    REST + SECONDS
}
