//! All stages in order, from the first that is not done.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use rig_setup::{RigChoice, RigSetup};
use serde::Serialize;
use serde::de::DeserializeOwned;
use work::progress::Progress;

use crate::axis::{Axis, Known};
use crate::bed::Bed;
use crate::board::Board;
use crate::control::{self, Control};
use crate::dossier::Identity;
use crate::drive::{self, Drive};
use crate::friction::wanted::Wanted;
use crate::friction::{self, Friction};
use crate::hand_over::{self, Found};
use crate::meet::{self, Met};
use crate::model::{self, Chosen};
use crate::proof::{self, Proof};
use crate::rows::Rows;
use crate::travel::{Kept, TravelAsked};
use crate::{CommissionError, Dossier, Stage};

/// Rig time that is left for pauses, in which a warm motor rests \[s\].
const SPARE: f64 = 15.0;

/// Rig time of the stage model, about \[s\].
const MODEL: f64 = 45.0;

/// What is asked of a commission.
#[derive(Debug, Clone)]
pub struct Asked {
    /// The rig.
    pub rig: RigChoice,
    /// What it is opened with; its calibration is what the user's file states, and not used: what
    /// contradicts it is refused.
    pub setup: RigSetup,
    /// How well the friction is to be known.
    pub wanted: Wanted,
    /// Where the shaft may be; none for the travel that the folder keeps, else that of the rig's
    /// profile, which is by its own count.
    pub travel: Option<TravelAsked>,
    /// Rig time that may be used, that of before included \[s\].
    pub allowed: f64,
}

/// What a commission came to.
#[derive(Debug)]
pub struct Outcome {
    /// What was found.
    pub found: Found,
    /// The document `commission.json`.
    pub document: String,
}

/// Opens the rig once, looks at it and says whose folder this is. Nothing moves.
///
/// # Errors
/// [`CommissionError`] for a rig that is not there, limits that contradict each other, or a rig
/// that this command does not drive.
pub fn look(asked: &Asked) -> Result<Known, CommissionError> {
    seen(asked, None)
}

/// The same for a commission that goes on: unless another travel is asked for, the one that its
/// folder keeps holds.
///
/// # Errors
/// As for [`look`], and where that travel was counted from a place that nobody knows any more.
pub fn look_again(asked: &Asked, dossier: &Dossier) -> Result<Known, CommissionError> {
    let again = match asked.travel {
        Some(TravelAsked::Around(..)) => None,
        Some(TravelAsked::Find(_)) if !dossier.done().contains(&Stage::Meet) => None,
        Some(TravelAsked::Find(_)) | None => dossier.travel()?,
    };
    seen(asked, again)
}

/// Clears what is latched in the device: its emergency stop, or a fault of it. Nothing moves.
///
/// # Errors
/// [`CommissionError::Rig`] where its cause is still there.
pub fn clear(asked: &Asked) -> Result<(), CommissionError> {
    let progress = Progress::new(1.0, true);
    Axis::new(&asked.rig, asked.setup, Arc::default(), &progress, (0.0, 0.0)).clear()
}

fn seen(asked: &Asked, kept: Option<Kept>) -> Result<Known, CommissionError> {
    let progress = Progress::new(1.0, true);
    let axis = Axis::new(&asked.rig, asked.setup, Arc::default(), &progress, (0.0, 0.0));
    axis.look(asked.travel, kept)
}

/// Does the stages that the folder does not have yet, and keeps each.
///
/// # Errors
/// [`CommissionError`]; the motor is at zero volts and what was done is kept.
pub fn run(
    asked: &Asked,
    known: &Known,
    dossier: &Dossier,
    stop: &Arc<AtomicBool>,
    progress: &Progress,
) -> Result<Outcome, CommissionError> {
    run_watched(asked, known, dossier, stop, (progress, &Board::default()))
}

/// The same while somebody watches: `board` says how it stands.
///
/// # Errors
/// As for [`run`].
pub fn run_watched(
    asked: &Asked,
    known: &Known,
    dossier: &Dossier,
    stop: &Arc<AtomicBool>,
    (progress, board): (&Progress, &Board),
) -> Result<Outcome, CommissionError> {
    let wanted = asked.wanted.iter().map(|(name, share)| (name.to_string(), share));
    board.begin(dossier.folder(), wanted.collect());
    let outcome = stages((asked, known), dossier, stop, (progress, board));
    if let Err(error) = &outcome {
        board.ended(error.to_string());
    }
    outcome
}

fn stages(
    (asked, known): (&Asked, &Known),
    dossier: &Dossier,
    stop: &Arc<AtomicBool>,
    (progress, board): (&Progress, &Board),
) -> Result<Outcome, CommissionError> {
    let used = used(dossier)?;
    let mut axis =
        Axis::new(&asked.rig, asked.setup, Arc::clone(stop), progress, (asked.allowed, used));
    axis.write_on(board);
    axis.drive_only(known.description.clone());
    axis.stay_within(known.travel);
    if let Some(TravelAsked::Around(..)) = asked.travel {
        dossier.keep_travel(known.travel, known.switched_on)?;
    }

    let met: Met = stage(dossier, Stage::Meet, &mut axis, |axis| {
        meet::meet(axis, known, (asked.travel, asked.setup.calibration), |travel| {
            dossier.keep_travel(travel, known.switched_on)
        })
    })?;
    let known = &met.known(known);
    axis.stay_within(known.travel);
    axis.stay_below(known.velocity);
    axis.calibrate(met.calibration);
    if !(met.tachometer && met.torque) {
        axis.trust_the_encoder_alone();
    }
    if met.torque {
        axis.watch_torque();
    }
    let drive: Drive =
        stage(dossier, Stage::Drive, &mut axis, |axis| drive::drive(axis, known, &met))?;
    let parts = (known, &met, &drive);
    let friction: Friction = stage(dossier, Stage::Friction, &mut axis, |axis| {
        let (underway, before) = dossier.underway()?;
        let begun = axis.used() - before;
        let later = control::seconds_needed() + proof::seconds_needed() + SPARE;
        friction::friction(axis, parts, &asked.wanted, later, underway, |blocks, used| {
            dossier.keep_underway(blocks, used - begun)
        })
    })?;
    friction.show(board);
    // What is left is known by now.
    let last = control::seconds_needed() + proof::seconds_needed() + SPARE;
    axis.expect(MODEL + last);
    let chosen: Chosen =
        stage(dossier, Stage::Model, &mut axis, |axis| model::model(axis, parts, &friction))?;
    axis.expect(last);
    let control: Control = stage(dossier, Stage::Control, &mut axis, |axis| {
        control::control(axis, parts, (&friction, &chosen), proof::seconds_needed())
    })?;
    let bed = Bed::of(known, &drive, (&friction, &chosen), control.design)?
        .breaking_loose(met.breakaway())
        .sticking(control.stuck)?
        .resting(control.resting_angle)
        .leveled(control.level)
        .feeding_back(control.fed_back);
    axis.expect(proof::seconds_needed());
    let proof: Proof =
        stage(dossier, Stage::Proof, &mut axis, |axis| proof::proof(axis, &bed, control.arm))?;
    let bed = proof.handed_over(&bed);

    let seconds = axis.used();
    let noticed = [met.noticed.clone(), axis.noticed()].concat();
    let met = Met { noticed, ..met };
    let rig = asked.rig.to_string();
    let found = Found { rig, seconds, met, drive, friction, chosen, control, proof };
    let document = hand_over::write(dossier, known, &found, &bed, &asked.wanted)?;
    board.handed_over(hand_over::worth(&found));
    Ok(Outcome { found, document })
}

/// What the folder has of a stage, else what `work` finds, kept.
fn stage<'a, T: Serialize + DeserializeOwned + Rows>(
    dossier: &Dossier,
    stage: Stage,
    axis: &mut Axis<'a>,
    work: impl FnOnce(&mut Axis<'a>) -> Result<T, CommissionError>,
) -> Result<T, CommissionError> {
    if let Some((found, seconds)) = dossier.found::<T>(stage)? {
        axis.board().done(stage, seconds, found.rows());
        return Ok(found);
    }
    axis.board().begun(stage);
    // The blocks of a friction stage that was stopped are counted as used already.
    let before = if stage == Stage::Friction { dossier.underway()?.1 } else { 0.0 };
    let begun = axis.used();
    let found = work(axis)?;
    let seconds = before + axis.used() - begun;
    dossier.keep(stage, seconds, &found)?;
    axis.board().done(stage, seconds, found.rows());
    Ok(found)
}

/// Rig time that the folder tells of \[s\].
fn used(dossier: &Dossier) -> Result<f64, CommissionError> {
    let mut seconds = 0.0;
    for stage in dossier.done().into_iter().filter(|stage| *stage != Stage::HandOver) {
        let kept: Option<(serde_json::Value, f64)> = dossier.found(stage)?;
        seconds += kept.map_or(0.0, |(_, seconds)| seconds);
    }
    if !dossier.done().contains(&Stage::Friction) {
        seconds += dossier.underway()?.1;
    }
    Ok(seconds)
}

/// Whose folder a commission of this rig is, as far as it is `known`: before it is opened only its
/// address is.
#[must_use]
pub fn identity(
    asked: &Asked,
    known: Option<&Known>,
    simulated: Option<crate::dossier::Simulated>,
) -> Identity {
    Identity {
        rig: asked.rig.to_string(),
        description: known.and_then(|known| known.description.clone()),
        limits: asked.setup.limits,
        simulated,
    }
}
