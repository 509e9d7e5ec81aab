//! A commission that is asked for, whoever asks: the command, or a request over ROS 2.

use std::path::PathBuf;

use commission::axis::Known;
use commission::dossier::{Identity, Simulated};
use commission::run::{identity, look, look_again};
use commission::travel::TravelAsked;
use commission::{Asked, CommissionError, Dossier, Stage};
use experiment_runner::asked::rig::{Chosen, choose};
use friction_model::AnyModel;
use rig_driver::Miswiring;
use rig_setup::{RigChoice, RigSetup};
use work::{BadInput, Interrupted};

use super::commission_args::CommissionArgs;
use super::commission_words::worded;

/// What is asked of a commission, before the rig is looked at.
pub(super) struct Planned {
    /// What is asked for.
    pub(super) asked: Asked,
    /// What to say of the rig's profile.
    pub(super) note: Option<String>,
    of_rig: Option<Simulated>,
    before: Option<(Dossier, Identity)>,
    from: Option<Stage>,
}

/// Refuses numbers that cannot be.
///
/// # Errors
/// [`BadInput`].
pub(super) fn checked(args: &CommissionArgs) -> anyhow::Result<()> {
    let in_parts = args.parts.part.is_some() || args.parts.join.is_some();
    if in_parts && args.trial.is_none() {
        let said = "--part and --join cut a trial; expected them with --trial N";
        return Err(BadInput(said.to_owned()).into());
    }
    if (4.0..=120.0).contains(&args.minutes) {
        return Ok(());
    }
    let said = format!("--minutes must be a number from 4 to 120, but is {}", args.minutes);
    Err(BadInput(said).into())
}

/// What these options say. Nothing has moved.
///
/// # Errors
/// [`BadInput`] for what the user can mend; the folder of another rig is such a thing.
pub(super) fn planned(args: &CommissionArgs) -> anyhow::Result<Planned> {
    checked(args)?;
    let before = args.resume.as_deref().map(Dossier::open).transpose().map_err(worded)?;
    let chosen = chosen(args, before.as_ref().map(|(_, identity)| identity))?;
    let asked = asked(args, &chosen)?;
    let of_rig = simulated(args, &chosen.rig);
    if let Some((dossier, of)) = &before {
        of.require(&identity(&asked, None, of_rig.clone()), dossier.folder()).map_err(worded)?;
    }
    Ok(Planned { asked, note: chosen.note, of_rig, before, from: args.from })
}

impl Planned {
    /// Opens the rig once and looks at it. Nothing moves.
    ///
    /// # Errors
    /// As for a commission; another device than that of the folder is refused.
    pub(super) fn look(&self) -> anyhow::Result<(Known, Identity)> {
        let known = match &self.before {
            Some((dossier, _)) if !self.seeks_anew() => look_again(&self.asked, dossier),
            _ => look(&self.asked),
        };
        let known = known.map_err(worded)?;
        let identity = identity(&self.asked, Some(&known), self.of_rig.clone());
        if let Some((dossier, of)) = &self.before {
            of.require(&identity, dossier.folder()).map_err(worded)?;
        }
        Ok((known, identity))
    }

    /// The folder in which it goes on, if it does.
    pub(super) fn resumes(&self) -> Option<PathBuf> {
        self.before.as_ref().map(|(dossier, _)| dossier.folder().to_owned())
    }

    /// The folder: that of before, less what is measured anew, or a `new` one.
    ///
    /// # Errors
    /// Where it cannot be written.
    pub(super) fn begin(
        self,
        identity: &Identity,
        new: impl FnOnce() -> anyhow::Result<PathBuf>,
    ) -> anyhow::Result<Dossier> {
        match self.before {
            Some((dossier, _)) => {
                self.from.map_or(Ok(()), |from| dossier.forget_from(from)).map_err(worded)?;
                Ok(dossier)
            }
            // It stays, with what is found until then.
            None => Dossier::begin(&new()?, identity).map_err(worded),
        }
    }

    /// Whether the ends are looked for once more.
    fn seeks_anew(&self) -> bool {
        self.from == Some(Stage::Meet) && matches!(self.asked.travel, Some(TravelAsked::Find(_)))
    }
}

/// The rig of the options, else that of the folder.
fn chosen(args: &CommissionArgs, before: Option<&Identity>) -> anyhow::Result<Chosen> {
    let named = match (&args.rig, &args.rig_file, before) {
        (None, None, Some(identity)) => {
            Some(identity.rig.parse::<RigChoice>().map_err(|error| BadInput(error.to_string()))?)
        }
        (rig, ..) => rig.clone(),
    };
    let chosen = choose(named.as_ref(), args.rig_file.as_deref())?;
    let only_simulated = args.miswired.is_some() && chosen.rig != RigChoice::Simulated;
    if only_simulated {
        return Err(BadInput(
            "--miswired is for the simulated rig; a real one is wired as it is".to_owned(),
        )
        .into());
    }
    Ok(chosen)
}

pub(super) fn asked(args: &CommissionArgs, chosen: &Chosen) -> anyhow::Result<Asked> {
    let wiring = args.miswired.as_deref().map(str::parse::<Miswiring>).transpose();
    let mut setup = RigSetup {
        limits: chosen.limits(args.voltage_limit),
        friction: AnyModel::test_bed(args.plant),
        calibration: chosen.of_real().and_then(|profile| profile.calibration),
        wiring: wiring.map_err(|error| BadInput(format!("--miswired: {error}")))?,
        ..RigSetup::default()
    };
    setup.simulation.seed = args.seed;
    let (rig, wanted) = (chosen.rig.clone(), args.want.clone());
    Ok(Asked { rig, setup, wanted, travel: args.travel, allowed: 60.0 * args.minutes })
}

/// What the simulated rig is made of; none of a real one.
fn simulated(args: &CommissionArgs, rig: &RigChoice) -> Option<Simulated> {
    (*rig == RigChoice::Simulated).then(|| Simulated {
        plant: args.plant.to_string(),
        seed: args.seed,
        miswired: args.miswired.clone(),
    })
}

/// What is kept after an error of the stages, and how to go on.
pub(super) fn kept(error: &CommissionError, dossier: &Dossier) -> String {
    let folder = dossier.folder().display();
    let done: Vec<String> = dossier.done().iter().map(ToString::to_string).collect();
    let kept = if done.is_empty() { "no stage yet".to_owned() } else { done.join(", ") };
    if error.is_held() {
        format!(
            "kept: {kept}; once somebody has looked at the rig and mended the cause, `frictionlab commission --resume {folder} --clear` clears it and goes on"
        )
    } else {
        format!("kept: {kept}; `frictionlab commission --resume {folder}` goes on")
    }
}

/// An error of the stages, with what is kept.
pub(super) fn ended(error: CommissionError, dossier: &Dossier) -> anyhow::Error {
    let kept = kept(&error, dossier);
    if error.is_stopped() {
        return Interrupted(format!("stopped; the motor is at zero volts. {kept}")).into();
    }
    eprintln!("{kept}");
    worded(error)
}
