//! What experiments share whose runs follow a profile.

use crate::characterise::{Breakaway, Measured, find_breakaway};
use crate::profile::REST;
use crate::profile::{DrivenQuantity, Excitation, Profile};
use crate::protocol::OnsetRule;
use crate::run::excited::{ExcitedJob, Series};
use crate::run::experiment::{Progressed, Running};
use crate::run::{BreakawayFigures, RunError};

/// Every group's excitation, each repeated, group after group.
pub(super) fn repeated(
    groups: &[(String, Excitation)],
    repetitions: u32,
    feed_forward: bool,
    until: Option<f64>,
) -> Vec<ExcitedJob> {
    let job = |group: usize, (stage, excitation): &(String, Excitation), repetition| ExcitedJob {
        stage: stage.clone(),
        group,
        repetition,
        excitation: excitation.clone(),
        feed_forward,
        until,
    };
    let each = |(group, of)| (0..repetitions).map(move |repetition| job(group, of, repetition));
    groups.iter().enumerate().flat_map(each).collect()
}

/// An excitation by a quantity.
pub(super) fn excitation(quantity: DrivenQuantity, profile: Profile) -> Excitation {
    Excitation { quantity, profile }
}

/// Text of a number in a file's name: `2.5` becomes `2_5`.
pub(super) fn in_name(value: f64) -> String {
    format!("{value}").replace('.', "_")
}

/// Runs that end in breakaway, and what they show.
pub(super) fn breakaways(
    running: &mut Running<'_, '_>,
    series: Series,
    groups: &[(String, Excitation)],
    onset: &OnsetRule,
    repetitions: u32,
) -> Result<(Vec<BreakawayFigures>, Progressed), RunError> {
    let jobs = repeated(groups, repetitions, false, Some(3.0 * onset.gross_motion));
    let direction = |excitation: &Excitation| {
        let profile = &excitation.profile;
        if profile.at(profile.duration() * 0.5).0 < 0.0 { -1.0 } else { 1.0 }
    };
    let driven = running.drive(series, jobs, |job, channels, friction| {
        find_breakaway(channels, friction, onset, series.displacement, direction(&job.excitation))
            .map_err(|why| {
                format!("{}, {}, repetition {}: {why}", series.name, job.stage, job.repetition + 1)
            })
    })?;
    let mut figures = Vec::new();
    for (group, (name, excitation)) in groups.iter().enumerate() {
        let runs: Vec<Breakaway> =
            driven.of(group).filter_map(|run| run.as_ref().ok().copied()).collect();
        running
            .found
            .characterisation
            .notes
            .extend(driven.of(group).filter_map(|run| run.as_ref().err().cloned()));
        figures.extend(breakaway_figures(name, excitation, &runs));
    }
    let progressed = Progressed::from(&driven);
    for ((name, _), record) in groups.iter().zip(driven.means) {
        let name: String =
            name.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
        running.found.characterisation.records.push((format!("breakaway_{name}.csv"), record));
    }
    Ok((figures, progressed))
}

fn breakaway_figures(
    name: &str,
    excitation: &Excitation,
    runs: &[Breakaway],
) -> Option<BreakawayFigures> {
    let of = |value: &dyn Fn(&Breakaway) -> (f64, f64)| {
        Measured::of(&runs.iter().map(value).collect::<Vec<_>>())
    };
    let rate = |run: &Breakaway| excitation.profile.at(REST + run.time).1.abs();
    Some(BreakawayFigures {
        excitation: name.to_owned(),
        rate: runs.iter().map(rate).sum::<f64>() / runs.len() as f64,
        torque: of(&|run| (run.torque, run.torque_systematic))?,
        peak: of(&|run| (run.peak, run.torque_systematic))?,
        displacement: of(&|run| (run.displacement, 0.0))?,
    })
}

/// Mean over things of one of their lists, as long as the shortest.
pub(super) fn mean_of<T>(of: &[&T], list: impl Fn(&T) -> &Vec<f64>) -> Vec<f64> {
    let shortest = of.iter().map(|one| list(one).len()).min().unwrap_or(0);
    (0..shortest)
        .map(|i| of.iter().map(|one| list(one)[i]).sum::<f64>() / of.len() as f64)
        .collect()
}
