//! The work: sorts the recordings, identifies every model, tries it on the others, puts the models
//! in order.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};

use friction_ident::statistics::root_mean_square;
use friction_ident::{
    DriveConstant, FrictionData, IdentError, Identified, StagedOptions, SteadyPoint, Stretch,
    choose_position_load, identify_model, refine_jointly,
};
use friction_model::ModelName;

use super::from_drive::{FromDrive, by_name};
use super::ranking::{on_common_ground, ranked};
use super::{
    Criterion, FrictionError, FrictionIdentification, Settings, Source, at_rest_too, constant,
    rivals, trust, wording,
};
use recording::AxisKind;
use recording::stretches::FrictionRecording;
use work::progress::Progress;
use work::sequencer::{Completion, run_in_order};

/// Identifies every model of `settings` from `files` and tries it on `validation`. Once `cancel` is
/// set every search stops where it is, and what there is by then is the result.
///
/// # Errors
/// [`FrictionError`] if not one model could be identified.
pub fn identify(
    files: &[FrictionRecording],
    validation: &[FrictionRecording],
    settings: &Settings,
    progress: &Progress,
    cancel: &AtomicBool,
) -> Result<FrictionIdentification, FrictionError> {
    let reach = settings.reach.or_else(|| bends(files));
    let (data, mut notes) = sorted(files, reach);
    only_pre_sliding(&data, files, reach, settings)?;
    let rotary = settings.axis == AxisKind::Rotary;
    let mut beside = choose_position_load(&data, rotary, settings.staged.asymmetric);
    let with = |shape| {
        let staged = StagedOptions { beside: shape, ..settings.staged };
        Settings { staged, ..settings.clone() }
    };
    let mut settings = with(beside.chosen);
    let reach_there = reach.or_else(|| bends(validation));
    let held_out = (!validation.is_empty()).then(|| sorted(validation, reach_there).0);

    let moved = moved(files, reach, &settings);

    let mut fits = Fits::of((&data, &moved), &settings, progress, cancel);
    let mut interrupted = fits.interrupted(cancel);
    let constant = constant::left_over(&fits.models, &data, &beside).filter(|_| !interrupted);
    let mut left_over = false;
    if let Some(shape) = constant {
        progress.expect(2 * settings.models.len() as u64);
        let more = with(shape);
        let again = Fits::of((&data, &moved), &more, progress, cancel);
        interrupted = again.interrupted(cancel);
        if !interrupted && constant::worth_it(&again.models, &fits.models, &data) {
            (fits, settings, beside.chosen) = (again, more, shape);
            left_over = true;
        }
    }
    let settings = &settings;
    let Fits { mut models, refused, completion } = fits;
    if models.is_empty() {
        return Err(nothing_found(refused, files));
    }
    for (name, error) in refused {
        notes.push(format!("{name} was left out: {error}."));
    }
    if let Completion::Cancelled { delivered } = completion {
        let missing: Vec<_> =
            settings.models.iter().skip(delivered).map(|name| name.as_str().to_owned()).collect();
        notes.push(format!("Stopped before {} was begun.", missing.join(", ")));
    }
    on_common_ground(&mut models, &data);
    let criterion = if held_out.is_some() { Criterion::HeldOut } else { Criterion::Bic };
    let (mut models, chosen) = ranked(models, &data, held_out.as_ref(), criterion);
    let recordings = (&data, held_out.as_ref());
    let again = chosen.and_then(|place| at_rest_too::decide(&models, place, recordings, criterion));
    let (chosen, at_rest_too) = match again {
        Some((place, told)) => (Some(place), Some(told)),
        None => (chosen, None),
    };
    let whole: Vec<_> = models.iter_mut().map(|model| trust::distrust(model, &data)).collect();
    if let Some(chosen) = chosen {
        rivals::heed(&mut models, chosen);
    }
    let mut warnings = wording::in_doubt(files.iter().chain(validation));
    match chosen.and_then(|place| models.get(place).zip(whole.get(place))) {
        Some((chosen, whole)) => {
            warnings.extend(trust::doubts(chosen, whole, &data, settings.axis));
            let elsewhere = held_out.as_ref();
            warnings.extend(
                elsewhere.and_then(|held_out| trust::worse_elsewhere(chosen, &data, held_out)),
            );
        }
        None => warnings.push(wording::NONE_CHOSEN.to_owned()),
    }
    if held_out.is_none() {
        notes.push(
            "All errors are those of the fit: no recording was held out. --validate FILE says how the models do on data they have not seen."
                .to_owned(),
        );
    }
    let said = || wording::beside(&beside);
    notes.extend(if left_over { Some(wording::CONSTANT_LEFT.to_owned()) } else { said() });
    notes.extend(settings.staged.asymmetric.then(|| wording::TWO_DIRECTIONS.to_owned()));
    notes.extend(wording::source_notes(files.iter().chain(validation), settings));
    notes.extend(held_out.as_ref().and_then(|held_out| wording::unseen_kinds(&data, held_out)));
    Ok(FrictionIdentification {
        settings: settings.clone(),
        files: files.iter().map(Source::from).collect(),
        validation: validation.iter().map(Source::from).collect(),
        data,
        held_out,
        models,
        chosen,
        at_rest_too,
        criterion,
        warnings,
        notes,
        beside,
        interrupted,
    })
}

/// Every model that was asked for, as far as it came.
struct Fits {
    models: Vec<(Identified, Option<FromDrive>)>,
    refused: Vec<(ModelName, IdentError)>,
    completion: Completion,
}

impl Fits {
    fn of(
        (data, moved): (&FrictionData, &[(DriveConstant, FrictionData)]),
        settings: &Settings,
        progress: &Progress,
        cancel: &AtomicBool,
    ) -> Self {
        let (mut models, mut refused) = (Vec::new(), Vec::new());
        let work = |name: &ModelName| {
            let found = one_model(*name, (data, moved), settings, progress, cancel);
            progress.advance(1.0);
            Ok::<_, std::convert::Infallible>(found)
        };
        let Ok(completion) =
            run_in_order(&settings.models, settings.workers, cancel, work, |name, found| {
                match found {
                    Ok(found) => models.push(found),
                    Err(error) => refused.push((*name, error)),
                }
                Ok(())
            });
        Self { models, refused, completion }
    }

    fn interrupted(&self, cancel: &AtomicBool) -> bool {
        let cut = self.completion != Completion::All
            || self.models.iter().any(|(model, _)| model.stopped);
        cancel.load(Ordering::Relaxed) && cut
    }
}

/// Identifies one model, and what of it moves with the drive's constants.
fn one_model(
    name: ModelName,
    (data, moved): (&FrictionData, &[(DriveConstant, FrictionData)]),
    settings: &Settings,
    progress: &Progress,
    cancel: &AtomicBool,
) -> Result<(Identified, Option<FromDrive>), IdentError> {
    let stages_only = StagedOptions { joint: false, ..settings.staged };
    let mut watch = |stage, step: &friction_ident::bounded::Step| {
        progress.stage(wording::progress(name, stage, step.sum));
        if cancel.load(Ordering::Relaxed) {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    };
    let found = identify_model(name, data, &settings.staged, &mut watch)?;
    let refit = |data: &_| {
        let stages = identify_model(name, data, &stages_only, &mut watch)?;
        let joint = if settings.staged.joint {
            refine_jointly(&found, &stages.model, data, &settings.staged, &mut watch)?
        } else {
            None
        };
        let stopped = stages.stopped || cancel.load(Ordering::Relaxed);
        Ok((!stopped).then(|| by_name(stages.stages.iter().chain(&joint))))
    };
    let from_drive = FromDrive::work_out(&found, data, moved, refit)?;
    Ok((found, from_drive))
}

/// Refuses recordings of which none slides.
fn only_pre_sliding(
    data: &FrictionData,
    files: &[FrictionRecording],
    reach: Option<f64>,
    settings: &Settings,
) -> Result<(), FrictionError> {
    let slides = !(data.points.is_empty() && data.lag.is_empty() && data.mixed.is_empty());
    if slides || data.pre_sliding.is_empty() {
        return Ok(());
    }
    let reach = reach.unwrap_or_default();
    Err(FrictionError::OnlyPreSliding {
        files: names(files),
        range: 2.0 * reach,
        unit: settings.axis.position_unit(),
        given: settings.reach.is_some(),
    })
}

fn names(files: &[FrictionRecording]) -> String {
    let files: Vec<_> = files.iter().map(|file| file.path.display().to_string()).collect();
    files.join(", ")
}

/// Why not one model could be identified.
fn nothing_found(
    refused: Vec<(ModelName, IdentError)>,
    files: &[FrictionRecording],
) -> FrictionError {
    match refused.into_iter().next() {
        Some((model, source)) => FrictionError::Refused { model, files: names(files), source },
        None => FrictionError::Nothing,
    }
}

/// Sorts the stretches of all files by what they show.
fn sorted(files: &[FrictionRecording], reach: Option<f64>) -> (FrictionData, Vec<String>) {
    let points: Vec<SteadyPoint> =
        files.iter().flat_map(|file| file.points.iter().copied()).collect();
    let stretches: Vec<Stretch> =
        files.iter().flat_map(|file| file.stretches.iter().cloned()).collect();
    let data = FrictionData::sort(points, stretches, reach);
    let mut notes = Vec::new();
    let moves = !(data.lag.is_empty() && data.mixed.is_empty());
    if data.pre_sliding.is_empty() && moves {
        // Of one recording alone nothing would be left to show the sliding.
        let several = files.len() > 1 || !data.points.is_empty();
        notes.push(format!(
            "No recording stays within pre-sliding{}",
            if several {
                ". If one should, say with --reach how far the contact bends before it slides."
            } else {
                "; one that does, beside this one, shows the stiffness by itself."
            }
        ));
    }
    (data, notes)
}

/// The recordings as they were if each constant of the drive were higher by one standard error.
/// They sort as the others do: their motion is the same.
fn moved(
    files: &[FrictionRecording],
    reach: Option<f64>,
    settings: &Settings,
) -> Vec<(DriveConstant, FrictionData)> {
    let constants = DriveConstant::entering(settings.preparation.torque).iter();
    constants
        .map(|&constant| {
            let (mut points, mut stretches) = (Vec::new(), Vec::new());
            for file in files {
                if let Some(error) =
                    file.drive_errors.iter().find(|error| error.constant == constant)
                {
                    let (more_points, more_stretches) = error.moved(&file.points, &file.stretches);
                    points.extend(more_points);
                    stretches.extend(more_stretches);
                }
            }
            (constant, FrictionData::sort(points, stretches, reach))
        })
        .collect()
}

/// Share of the longest travel that a contact bends by at most.
const SHORT: f64 = 0.1;

/// How far the contact bends, from stretches that turn back and forth and whose friction stays well
/// below the level at which it slides. There it goes with the place more than with the direction, and
/// the way is short beside any on which the axis slides.
fn bends(files: &[FrictionRecording]) -> Option<f64> {
    let stretches = || files.iter().flat_map(|file| &file.stretches);
    let longest = stretches().map(Stretch::range).fold(0.0, f64::max);
    let slides = stretches().any(|stretch| !like_a_spring(stretch));
    let level = files
        .iter()
        .flat_map(|file| &file.points)
        .map(|point| point.torque.abs())
        .chain(stretches().map(|stretch| root_mean_square(&stretch.friction)))
        .fold(f64::NAN, f64::max);
    let slowest_level = files
        .iter()
        .flat_map(|file| &file.points)
        .map(|point| point.torque.abs())
        .fold(level, f64::min);
    let reaches = stretches()
        .filter(|stretch| {
            root_mean_square(&stretch.friction) < 0.8 * slowest_level
                && turns(stretch)
                && like_a_spring(stretch)
                && (!slides || stretch.range() < SHORT * longest)
        })
        .map(Stretch::range);
    reaches
        .fold(None, |most: Option<f64>, range| Some(most.map_or(range, |most| most.max(range))))
        .map(|range| 0.55 * range)
}

/// Whether friction goes with the place more than with the direction of motion.
fn like_a_spring(stretch: &Stretch) -> bool {
    let directions: Vec<f64> = stretch.velocity.iter().map(|v| v.signum()).collect();
    let with = |values: &[f64]| correlation(values, &stretch.friction).abs();
    with(&stretch.travel()) > with(&directions)
}

/// Pearson's coefficient of two columns of one length; 0 where one is constant.
fn correlation(a: &[f64], b: &[f64]) -> f64 {
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len().max(1) as f64;
    let (mean_a, mean_b) = (mean(a), mean(b));
    let (mut both, mut of_a, mut of_b) = (0.0, 0.0, 0.0);
    for (a, b) in a.iter().zip(b) {
        let (a, b) = (a - mean_a, b - mean_b);
        both += a * b;
        of_a += a * a;
        of_b += b * b;
    }
    if of_a > 0.0 && of_b > 0.0 { both / (of_a * of_b).sqrt() } else { 0.0 }
}

/// Whether the travel goes both ways for a good part of its range.
fn turns(stretch: &Stretch) -> bool {
    let travel = stretch.travel();
    let (mut forward, mut backward) = (0.0, 0.0);
    for pair in travel.windows(2) {
        let step = pair[1] - pair[0];
        if step > 0.0 { forward += step } else { backward -= step }
    }
    f64::min(forward, backward) > 0.2 * f64::max(forward, backward)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn recording(points: Vec<SteadyPoint>, stretches: Vec<Stretch>) -> FrictionRecording {
        FrictionRecording {
            path: "x".into(),
            points,
            stretches,
            samples: 0,
            axis: None,
            outliers: Vec::new(),
            drive_errors: Vec::new(),
            irregularities: Default::default(),
        }
    }

    /// A stretch of a spring that slides at 0.1: x = a sin(t).
    fn swing(a: f64) -> Stretch {
        let time = (0..6000).map(|k| f64::from(k) * 1e-3);
        let position: Vec<f64> = time.clone().map(|t| a * (3.0 * t).sin()).collect();
        let velocity: Vec<f64> = time.map(|t| 3.0 * a * (3.0 * t).cos()).collect();
        let friction = position.iter().map(|x| (20.0 * x).clamp(-0.1, 0.1)).collect();
        Stretch::new(1e-3, velocity, Some(position), friction).unwrap()
    }

    #[test]
    fn pre_sliding_is_told_by_its_friction() {
        let points = vec![SteadyPoint::new(0.5, 0.1), SteadyPoint::new(1.0, 0.12)];
        let found = bends(&[recording(points.clone(), vec![swing(0.004), swing(2.0)])]).unwrap();
        assert!((found / 0.0044 - 1.0).abs() < 0.01, "{found}");
        assert_eq!(bends(&[recording(points, vec![swing(2.0)])]), None);
    }

    /// A joint that slides back and forth by 0.5 rad, with less friction than where it goes fast, is
    /// not stuck.
    #[test]
    fn a_stretch_that_slides_slowly_is_no_pre_sliding() {
        let slide = |speed: f64| {
            let time = (0..6000).map(|k| f64::from(k) * 1e-3);
            let position: Vec<f64> = time.clone().map(|t| 0.5 * (speed * t).sin()).collect();
            let velocity: Vec<f64> = time.map(|t| 0.5 * speed * (speed * t).cos()).collect();
            let friction = velocity.iter().map(|v| 0.1 * v.signum() + 0.05 * v).collect();
            Stretch::new(1e-3, velocity, Some(position), friction).unwrap()
        };
        let slow = recording(vec![], vec![slide(2.0), slide(8.0)]);
        assert_eq!(bends(std::slice::from_ref(&slow)), None);
        let with_stuck = recording(vec![], vec![slide(2.0), slide(8.0), swing(0.004)]);
        assert!((bends(&[with_stuck]).unwrap() - 0.0044).abs() < 1e-5);
    }
}
