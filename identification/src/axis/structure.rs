//! The structure of an axis: compared by cross-validation, chosen, fitted.

use std::sync::atomic::AtomicBool;
use std::thread;

use friction_ident::adequacy::FitDoubt;
use friction_ident::axis_structure::{
    AxisStructure, AxisUnits, Choice, CrossValidation, Elsewhere, StructureFit, UnknownStructure,
    blocks_for, choose, cross_validate_beside, fit_structure, fit_validated, growth,
};
use friction_ident::one_speed::one_speed;
use friction_ident::{Conditioned, IdentError, ParameterId, Prediction, Side, adequacy};

use super::along::Along;
use super::one_speed::distrust_structure;
use super::ramps;
use recording::AxisKind;
use report::numbers::significant;
use work::progress::Progress;
use work::sequencer::{Completion, run_in_order};

/// Factor of the error that a fit leaves up to which parts kept back may be predicted worse and the
/// recording promises that: beyond, it was fitted to these parts and not to the axis.
const OVERFITTED: f64 = 2.0;

/// Which structures are compared.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum StructureChoice {
    /// Those that a search comes by.
    Auto,
    /// These.
    Named(Vec<AxisStructure>),
}

impl StructureChoice {
    /// The structures to compare next, after those in `scores` and those that were `refused`; none
    /// when all were compared.
    fn next(
        &self,
        scores: &[CrossValidation],
        refused: &[AxisStructure],
        possible: impl Fn(&AxisStructure) -> bool,
    ) -> Vec<AxisStructure> {
        match self {
            Self::Auto => growth::next(scores, refused, possible),
            Self::Named(named) if scores.is_empty() => named.clone(),
            Self::Named(_) => vec![],
        }
    }
}

/// A text that chooses no structures.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ChoiceError {
    /// One of the names is none.
    #[error("{0}; or `auto`")]
    Unknown(#[from] UnknownStructure),
    /// `auto` beside names.
    #[error("`auto` tries all structures and stands alone: leave the names out, or `auto`")]
    AutoBesideNames,
}

impl std::str::FromStr for StructureChoice {
    type Err = ChoiceError;

    fn from_str(text: &str) -> Result<Self, ChoiceError> {
        if text.trim() == "auto" {
            return Ok(Self::Auto);
        }
        if text.split(',').any(|name| name.trim() == "auto") {
            return Err(ChoiceError::AutoBesideNames);
        }
        let names = text.split(',').map(|name| name.trim().parse::<AxisStructure>());
        Ok(Self::Named(names.collect::<Result<_, _>>()?))
    }
}

/// A structure that was chosen.
#[derive(Debug, Clone, PartialEq)]
pub struct Structured {
    /// The cross-validated structures, in the order in which they were tried.
    pub scores: Vec<CrossValidation>,
    /// Those that the recording cannot show, and why.
    pub refused: Vec<(AxisStructure, IdentError)>,
    /// Their ranking.
    pub choice: Choice,
    /// Those that the choice came by and that have a part of which the recording shows no parameter,
    /// and that predict no better than chance for it.
    pub unseen: Vec<AxisStructure>,
    /// The axis stands still where it turns round, so that no bristle was tried, nor a dip at speeds
    /// that it only passes through.
    pub untried_bristle: bool,
    /// The comparison was stopped; it was chosen among what there was by then.
    pub interrupted: bool,
    /// The chosen one, fitted to the whole recording.
    pub fit: StructureFit,
    /// On the recording it was fitted to.
    pub estimation: Prediction,
    /// On the other recording, which nothing was fitted to.
    pub validation: Option<Prediction>,
    /// Why the chosen one is not to be trusted as a whole: said before any table.
    pub warnings: Vec<String>,
    /// What these warnings are of.
    pub doubts: Vec<FitDoubt>,
    /// Whether the ramps of a motion of one speed tell the inertia; none where it has several.
    pub ramps: Option<bool>,
    /// Units.
    pub axis: AxisKind,
}

impl Structured {
    /// The chosen structure's score.
    pub fn chosen(&self) -> Option<&CrossValidation> {
        self.scores.get(self.choice.chosen)
    }

    /// What must be known to read the parameters right.
    pub fn notes(&self) -> Vec<String> {
        let number = |(id, value): &(ParameterId, f64)| {
            let estimate = self.fit.estimates.get(*id);
            let unit = estimate.map_or("s", |estimate| estimate.unit);
            format!("{id} {} {unit}", significant(*value, 4))
        };
        let said: Vec<String> = self.fit.sliding.iter().map(number).collect();
        let late = self.fit.sliding.iter().any(|(id, value)| id.name == "delay" && *value < 0.0);
        let sliding = (!said.is_empty()).then(|| {
            format!(
                "Where the axis slides, away from reversals and rest, least squares finds {}. The structure says something else, most often because \
                 around reversals something acts that it does not have. The intervals reach to both; of steady sliding, those numbers mostly tell more.{}",
                said.join(", "),
                if late {
                    " A delay below zero says that the force was recorded later than the motion. What is late takes viscous friction times that delay off the inertia."
                } else {
                    ""
                }
            )
        });
        let said: Vec<String> = self.fit.curved.iter().map(number).collect();
        let curved = (!said.is_empty()).then(|| {
            format!(
                "Friction is no straight line over the speeds of this recording. Beside a force that goes with a power of the speed the fit finds {}. \
                 The intervals reach to both; beyond these speeds, friction is not what the line says.",
                said.join(", ")
            )
        });
        let rise = self.choice.without_rise.and_then(|best| self.scores.get(best)).map(|best| {
            format!(
                "It predicts clearly better than the best structure whose friction does not rise over the first speeds ({}), and is chosen for that. \
                 Which of the two the axis has is open: the intervals reach to both.",
                best.structure
            )
        });
        let unseen = self.unseen.iter().map(|other| {
            format!(
                "{other} predicts better than {} by no more than chance, and no parameter of what it has besides is clear of its error: it is left out, and \
                 the intervals reach to both.",
                self.fit.structure
            )
        });
        let unseen: Vec<String> = unseen.collect();
        let along = Along::of(&self.fit, self.axis).map(|along| along.note());
        let own = self.fit.notes();
        let new = |below: &String| !own.iter().any(|note| note.starts_with(below));
        let said = |below: String| {
            format!(
                "{below}: a dip is not what this recording shows. The parameter file has f_c for both."
            )
        };
        let below: Vec<String> = below(&self.fit).filter(new).map(said).collect();
        let stopped = self.interrupted.then(|| {
            format!(
                "The comparison was stopped after {} structures: one that was not tried may suit the recording better.",
                self.scores.len()
            )
        });
        let untried = self.untried_bristle.then(|| {
            "The axis stands still wherever it turns round: what its contact does there is not shown, and no bristle was tried, nor a dip at speeds that it only \
             passes through. Motion that turns round without a rest and slow motion show them; another recording behind --validate can bear them out."
                .to_owned()
        });
        stopped
            .into_iter()
            .chain(untried)
            .chain(sliding)
            .chain(curved)
            .chain(along)
            .chain(below)
            .chain(own)
            .chain(rise)
            .chain(unseen)
            .collect()
    }
}

/// Of each direction whose level at rest is not above the kinetic one, that it lies below.
fn below(fit: &StructureFit) -> impl Iterator<Item = String> {
    Side::of(fit.structure.asymmetric).iter().filter_map(|&side| {
        let [f_s, f_c] = ["f_s", "f_c"].map(|name| ParameterId::new(name).side(side));
        let levels = fit.estimates.value(f_s).zip(fit.estimates.value(f_c));
        levels.filter(|(low, high)| low <= high).map(|_| format!("{f_s} lies below {f_c}"))
    })
}

/// Units of an axis.
pub fn units(axis: AxisKind) -> &'static AxisUnits {
    match axis {
        AxisKind::Linear => &AxisUnits::LINEAR,
        AxisKind::Rotary => &AxisUnits::ROTARY,
    }
}

/// Share of the motion that must be slower than the Stribeck velocity of a dip, where the axis stands
/// still to turn round.
const SLOW: f64 = 0.1;

/// Why a dip is none, where next to nothing of the motion is as slow as it.
fn dip_of_starts(score: &CrossValidation, recording: &Conditioned) -> Option<IdentError> {
    let slow = recording.velocity.iter().filter(|v| v.abs() < score.shape.v_s).count();
    let share = slow as f64 / recording.velocity.len() as f64;
    (score.structure.stribeck && share < SLOW).then_some(IdentError::DipOfStarts)
}

/// Compares the structures on all cores, chooses one, fits it, and tries it on `validation`, which
/// takes part in the choice. None where `cancel` ended it before the first result; a comparison that
/// was cut short chooses among what there is.
///
/// # Errors
/// The [`IdentError`] of the simplest structure, or of one that was named. Others that the search
/// comes by and that the recording cannot show are left out.
pub fn structured(
    estimation: &Conditioned,
    validation: Option<&Conditioned>,
    wanted: &StructureChoice,
    axis: AxisKind,
    progress: &Progress,
    cancel: &AtomicBool,
) -> Result<Option<Structured>, IdentError> {
    let workers = thread::available_parallelism().map_or(1, usize::from);
    let blocks = blocks_for(estimation);
    let untried_bristle =
        estimation.stops_to_turn && validation.is_none() && *wanted == StructureChoice::Auto;
    let possible = |structure: &AxisStructure| {
        // What the contact does where an axis turns round is seen where it does so in motion.
        let unseen = structure.presliding && untried_bristle;
        let places = [Some(estimation), validation].into_iter().flatten();
        !unseen
            && (places.map(|recording| &recording.position).all(Option::is_some)
                || !structure.needs_position())
            && (axis == AxisKind::Rotary || !structure.gravity)
    };
    let mut scores: Vec<CrossValidation> = Vec::new();
    let mut refused: Vec<(AxisStructure, IdentError)> = Vec::new();
    let mut interrupted = false;
    loop {
        let known = scores.clone();
        let work = |structure: &AxisStructure| {
            Ok::<_, IdentError>(cross_validate_beside(estimation, *structure, blocks, &known))
        };
        let not: Vec<AxisStructure> = refused.iter().map(|(structure, _)| *structure).collect();
        let next = wanted.next(&scores, &not, possible);
        if next.is_empty() {
            break;
        }
        progress.expect((scores.len() + refused.len() + next.len()) as u64);
        let completion = run_in_order(&next, workers, cancel, work, |structure, score| {
            progress.stage(format!("{structure}"));
            progress.advance(1.0);
            match score {
                Ok(score) => match dip_of_starts(&score, estimation).filter(|_| untried_bristle) {
                    Some(error) => refused.push((*structure, error)),
                    None => scores.push(score),
                },
                Err(error) if scores.is_empty() || *wanted != StructureChoice::Auto => {
                    return Err(error);
                }
                Err(error) => refused.push((*structure, error)),
            }
            Ok(())
        })?;
        if let Completion::Cancelled { .. } = completion {
            // The rest is short, and is done all the same, so that there is a result.
            interrupted = true;
            progress.line(&format!("stopped: {} structures were compared", scores.len()));
            break;
        }
    }
    if let Some(other) = validation.filter(|_| scores.len() > 1) {
        try_on(estimation, other, &mut scores, workers);
    }
    let Some((choice, fit)) = chosen(estimation, &mut scores, &mut refused, units(axis))? else {
        return Ok(None);
    };
    let (choice, mut fit, unseen) = without_unseen(estimation, &scores, (choice, fit), units(axis));
    let rivals: Vec<CrossValidation> =
        choice.rivals().filter_map(|rival| scores.get(rival)).cloned().collect();
    fit.heed(estimation, &rivals);
    let here = fit.predict(estimation)?;
    let there = validation.map(|other| fit.predict(other)).transpose()?;
    let fails = promised(&scores).zip(there.as_ref()).and_then(|((error, power), there)| {
        adequacy::elsewhere(error.min(OVERFITTED * here.relative_error), power, there)
    });
    let outdone = there.as_ref().zip(validation).and_then(|(there, other)| {
        let simpler = scores.iter().map(|score| score.structure).filter(|simpler| {
            simpler.is_linear() && simpler.parameters() < fit.structure.parameters()
        });
        let error = |simpler: AxisStructure| {
            let fit = fit_structure(estimation, simpler, units(axis)).ok()?;
            Some((simpler, fit.predict(other).ok()?.relative_error))
        };
        adequacy::outdone(there, simpler.filter_map(error))
    });
    let mut doubts = adequacy::doubts(&here, estimation);
    doubts.extend(fit.impossible());
    doubts.extend(fit.parts(estimation));
    doubts.extend(fails);
    doubts.extend(outdone);
    let speed = one_speed(&estimation.velocity);
    let inertia = fit.estimates.value("inertia").unwrap_or(0.0);
    let condemned = doubts.iter().any(FitDoubt::condemns);
    let ramps = speed.map(|speed| !condemned && ramps::tell_inertia(&here, speed, inertia));
    if condemned {
        fit.estimates.distrust();
    } else if let Some(ramps) = ramps {
        // Said once, of the recording.
        distrust_structure(&mut fit.estimates, ramps);
    }
    let name = fit.structure;
    let warnings = doubts.iter().map(|doubt| format!("The structure {name} {doubt}.")).collect();
    let (estimation, validation) = (here, there);
    Ok(Some(Structured {
        scores,
        refused,
        choice,
        unseen,
        untried_bristle,
        interrupted,
        fit,
        estimation,
        validation,
        warnings,
        doubts,
        ramps,
        axis,
    }))
}

/// The relative error \[%\] that the recording by itself promises, and the mean square of its force.
/// A structure that was chosen because the other recording bears it better promises less, and would
/// hide that what holds here does not hold there.
fn promised(scores: &[CrossValidation]) -> Option<(f64, f64)> {
    let here = |score: &CrossValidation| CrossValidation { elsewhere: None, ..score.clone() };
    let here: Vec<CrossValidation> = scores.iter().map(here).collect();
    let chosen = here.get(choose(&here)?.chosen)?;
    Some((chosen.relative_error, chosen.force_power))
}

/// Tries the structures on another recording, or none of them where one cannot be.
fn try_on(
    estimation: &Conditioned,
    other: &Conditioned,
    scores: &mut [CrossValidation],
    workers: usize,
) {
    let mut tried = Vec::with_capacity(scores.len());
    let work = |score: &CrossValidation| score.tried_on(estimation, other);
    let keep = |_: &CrossValidation, found: Elsewhere| {
        tried.push(found);
        Ok::<_, IdentError>(())
    };
    // The work is short: whoever asks for an end has a result by then.
    if run_in_order(scores, workers, &AtomicBool::new(false), work, keep).is_ok() {
        for (score, found) in scores.iter_mut().zip(tried) {
            score.elsewhere = Some(found);
        }
    }
}

/// The structure that is chosen, with its fit. One with a wave that both halves of the recording do
/// not share describes this recording and not the axis, one whose inertia is clearly below zero
/// describes no axis, and one whose lag does not settle no bristle: such structures are refused, and
/// the choice is made among the others.
fn chosen(
    estimation: &Conditioned,
    scores: &mut Vec<CrossValidation>,
    refused: &mut Vec<(AxisStructure, IdentError)>,
    units: &AxisUnits,
) -> Result<Option<(Choice, StructureFit)>, IdentError> {
    loop {
        let Some(choice) = choose(scores) else { return Ok(None) };
        let Some(chosen) = scores.get(choice.chosen) else { return Ok(None) };
        let structure = chosen.structure;
        let fit = match fit_validated(estimation, chosen, units) {
            Err(error) if scores.len() > 1 => {
                scores.retain(|score| score.structure != structure);
                refused.push((structure, error));
                continue;
            }
            fit => fit?,
        };
        let others = scores.iter().any(|score| !score.structure.harmonic);
        match fit.other_waves() {
            Some((low, high)) if structure.harmonic && others => {
                let mut waves = Vec::new();
                scores.retain(|score| {
                    if score.structure.harmonic {
                        waves.push(score.structure);
                    }
                    !score.structure.harmonic
                });
                let why = |wave| (wave, IdentError::OtherWaves { low, high });
                refused.extend(waves.into_iter().map(why));
            }
            _ => return Ok(Some((choice, fit))),
        }
    }
}

/// The choice without parts of which the recording shows no parameter, where they help no more than
/// chance does; and the structures that were left for that.
fn without_unseen(
    estimation: &Conditioned,
    scores: &[CrossValidation],
    (mut choice, mut fit): (Choice, StructureFit),
    units: &AxisUnits,
) -> (Choice, StructureFit, Vec<AxisStructure>) {
    let mut left = Vec::new();
    loop {
        let simpler = fit.without_unseen().find_map(|without| {
            let choice = choice.among(scores, &without)?;
            let fit = fit_validated(estimation, scores.get(choice.chosen)?, units).ok()?;
            Some((choice, fit))
        });
        let Some((other, simpler)) = simpler else { return (choice, fit, left) };
        left.push(std::mem::replace(&mut fit, simpler).structure);
        choice = other;
    }
}

#[cfg(test)]
mod tests {
    use friction_ident::axis_structure::cross_validate;
    use friction_ident::{Conditioning, Signals, condition};

    use super::*;

    /// An axis with next to no inertia whose force comes 8 ms late: without the delay its inertia
    /// comes out below zero. It was refused for that, though another structure shows it well.
    #[test]
    fn a_structure_that_cannot_be_fitted_makes_room_for_another() {
        let at = |t: f64| {
            let (v, a) = (
                2.2 * (1.1 * t).cos() + 1.9 * (3.7 * t).cos(),
                -2.42 * (1.1 * t).sin() - 7.03 * (3.7 * t).sin(),
            );
            (
                2.0 * (1.1 * t).sin() + 1.9 / 3.7 * (3.7 * t).sin(),
                0.002 * a + 0.5 * v + 0.3 * v.signum(),
            )
        };
        let time = || (0..20_000).map(|k| 1e-3 * f64::from(k));
        let place: Vec<f64> = time().map(|t| at(t).0).collect();
        let force: Vec<f64> = time().map(|t| at(t - 8e-3).1).collect();
        let signals = Signals {
            time_step: 1e-3,
            position: Some(&place),
            readings: None,
            velocity: None,
            force: &force,
        };
        let recording = condition(&signals, &Conditioning::for_time_step(1e-3)).unwrap();
        let [simple, late] = ["symmetric", "symmetric+delay"].map(|name| name.parse().unwrap());
        let wanted = StructureChoice::Named(vec![late]);
        let (progress, cancel) =
            (Progress::counting(1, "structures", true), AtomicBool::new(false));
        let found = structured(&recording, None, &wanted, AxisKind::Rotary, &progress, &cancel);
        let mut found = found.unwrap().unwrap();
        assert!(!found.notes().iter().any(|note| note.contains("slides")), "{:?}", found.notes());
        found.fit.sliding = vec![("inertia".into(), 6.125e-5)];
        let note = found.notes().swap_remove(0);
        assert!(note.contains("least squares finds inertia 6.125e-5 kg m^2."), "{note}");
        let mut scores = [simple, late].map(|of| cross_validate(&recording, of, 8).unwrap());
        // As if it predicted best.
        scores[0].relative_error = 0.0;
        scores[0].blocks = vec![0.0; 8];
        let (mut scores, mut refused) = (scores.to_vec(), Vec::new());
        let found = chosen(&recording, &mut scores, &mut refused, &AxisUnits::ROTARY).unwrap();
        let (_, fit) = found.unwrap();
        assert_eq!(fit.structure, late);
        assert!(
            matches!(refused[..], [(of, IdentError::NegativeInertia { value, .. })] if of == simple && value < 0.0),
            "{refused:?}"
        );
        // Nor does one that cannot be fitted to all of the recording, as where a lag runs away only
        // after the cross-validation's end, take the others with it.
        let mut blind = recording.clone();
        blind.position = None;
        let heavy = "symmetric+delay+gravity".parse().unwrap();
        let best = CrossValidation {
            structure: heavy,
            relative_error: 0.0,
            blocks: vec![0.0; 8],
            ..scores[0].clone()
        };
        scores.push(best);
        let found = chosen(&blind, &mut scores, &mut refused, &AxisUnits::ROTARY).unwrap();
        assert_eq!(found.unwrap().1.structure, late);
        assert!(
            matches!(refused[..], [_, (of, IdentError::NoPosition { .. })] if of == heavy),
            "{refused:?}"
        );
    }

    /// The dip of an axis that has none, which predicts by chance a little better.
    #[test]
    fn a_dip_that_nothing_is_known_of_is_left_and_that_is_said() {
        let at = |k: u32| {
            let t = 1e-3 * f64::from(k);
            let of = |a: f64, w: f64| {
                [(w * t).sin(), w * (w * t).cos(), -w * w * (w * t).sin()].map(|x| a * x)
            };
            let ([q1, v1, a1], [q2, v2, a2]) = (of(1.0, 2.2), of(0.4, 5.3));
            let shake = 0.03 * (977.0 * t * t).sin();
            (q1 + q2, 0.05 * (a1 + a2) + 0.1 * (v1 + v2) + 0.5 * (v1 + v2).signum() + shake)
        };
        let (place, force): (Vec<f64>, Vec<f64>) = (0..20_000).map(at).unzip();
        let signals = Signals {
            time_step: 1e-3,
            position: Some(&place),
            readings: None,
            velocity: None,
            force: &force,
        };
        let recording = condition(&signals, &Conditioning::for_time_step(1e-3)).unwrap();
        let [plain, dip] = ["symmetric", "symmetric+stribeck"].map(|name| name.parse().unwrap());
        let mut scores = [plain, dip].map(|of| cross_validate(&recording, of, 8).unwrap());
        // As if it predicted better: in half of the blocks.
        scores[1].blocks = scores[0].blocks.clone();
        scores[1].blocks.iter_mut().step_by(2).for_each(|block| *block *= 0.9);
        let units = &AxisUnits::ROTARY;
        let fit = fit_validated(&recording, &scores[1], units).unwrap();
        let choice = Choice { chosen: 1, ..choose(&scores).unwrap() };
        let (choice, fit, unseen) = without_unseen(&recording, &scores, (choice, fit), units);
        assert_eq!((choice.chosen, fit.structure, &unseen[..]), (0, plain, &[dip][..]));
        let wanted = StructureChoice::Named(vec![plain]);
        let (progress, cancel) =
            (Progress::counting(1, "structures", true), AtomicBool::new(false));
        let found = structured(&recording, None, &wanted, AxisKind::Rotary, &progress, &cancel);
        let found = Structured { unseen, ..found.unwrap().unwrap() };
        let said = found.notes();
        assert!(
            said.iter().any(
                |note| note.starts_with("symmetric+stribeck predicts better than symmetric by")
            ),
            "{said:?}"
        );
    }

    /// Clean moves of a rigid axis with a rest at each end were given a bristle that predicted other
    /// motion ten times worse, without a word.
    #[test]
    fn no_bristle_is_tried_where_the_axis_stands_still_to_turn() {
        let at = |t: f64| {
            let (number, within) = ((t / 1.5).floor(), (t % 1.5).min(1.0));
            let (place, v, a) = match within {
                begun if begun < 0.2 => (2.5 * begun * begun, 5.0 * begun, 5.0),
                cruising if cruising < 0.8 => (cruising - 0.1, 1.0, 0.0),
                ending => (0.8 - 2.5 * (1.0 - ending).powi(2), 5.0 * (1.0 - ending), -5.0),
            };
            let moves = if within < 1.0 { 1.0 } else { 0.0 };
            let force = moves * (0.3 * a + 0.2 * v + 1.0);
            if number % 2.0 == 0.0 { (place, force) } else { (0.8 - place, -force) }
        };
        let (place, force): (Vec<f64>, Vec<f64>) =
            (0..15_000).map(|k| at(1e-3 * f64::from(k))).unzip();
        let signals = Signals {
            time_step: 1e-3,
            position: Some(&place),
            readings: None,
            velocity: None,
            force: &force,
        };
        let recording = condition(&signals, &Conditioning::for_motion(1e-3, &[signals]));
        let (recording, _) = recording.unwrap().moving().unwrap();
        let found = |other: Option<&Conditioned>| {
            let (progress, cancel) =
                (Progress::counting(1, "structures", true), AtomicBool::new(false));
            let (wanted, axis) = (StructureChoice::Auto, AxisKind::Linear);
            structured(&recording, other, &wanted, axis, &progress, &cancel).unwrap().unwrap()
        };
        let alone = found(None);
        assert!(alone.untried_bristle && recording.stops_to_turn);
        assert!(alone.scores.iter().all(|score| !score.structure.presliding));
        assert!(alone.notes().iter().any(|note| note.contains("no bristle was tried")));
        let beside = found(Some(&recording));
        assert!(!beside.untried_bristle);
        assert!(beside.scores.iter().any(|score| score.structure.presliding));
    }

    #[test]
    fn the_option_names_its_mistake() {
        assert_eq!("auto".parse(), Ok(StructureChoice::Auto));
        let both = "auto,symmetric".parse::<StructureChoice>().unwrap_err().to_string();
        assert!(both.contains("stands alone"), "{both}");
        let named = "symmetric, asymmetric+delay".parse::<StructureChoice>().unwrap();
        assert!(matches!(named, StructureChoice::Named(list) if list.len() == 2));
        let message = "symmetric,stribeck".parse::<StructureChoice>().unwrap_err().to_string();
        assert!(message.contains("`stribeck`") && message.contains("auto"), "{message}");
    }
}
