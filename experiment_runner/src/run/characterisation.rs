//! Experiments 2 to 4 and sequences: which runs they are made of, and what becomes of their
//! results.

use serde::Serialize;

use super::RunError;
use super::bench::Bench;
use super::excited::{Driven, ExcitedJob, MeanRecord, Series};
use super::recorder::{Recorder, Timeline};
use crate::characterise::{
    Breakaway, Closure, LagLoop, Measured, NestedPath, find_breakaway, lag_loop, nested_path,
};
use crate::profile::{DrivenQuantity, Excitation, Profile};
use crate::protocol::{Displacement, Kind, OnsetRule};
use work::sequencer::Completion;

/// Samples of a stretch of varying velocity that its table holds at most.
const TABLE_SAMPLES: usize = 20_000;

/// What experiments 2 to 4 found; none of those that were not run.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Characterisation {
    /// Experiment 2: one entry a frequency.
    pub lag: Vec<LagFigures>,
    /// Experiment 3, stage 1: upwards and downwards.
    pub ramps: Vec<BreakawayFigures>,
    /// Experiment 3, stage 2: the closed loops.
    pub closures: Vec<ClosureFigures>,
    /// Experiment 4: ramps and sines.
    pub rates: Vec<BreakawayFigures>,
    /// What went otherwise than planned.
    pub notes: Vec<String>,
    /// Recordings, means over the repetitions, for the files beside the bag.
    #[serde(skip)]
    pub(super) records: Vec<(String, MeanRecord)>,
    /// The nested path, means over the repetitions: displacement [rad] and torque [N m].
    #[serde(skip)]
    pub(super) path: (Vec<f64>, Vec<f64>),
}

/// Frictional lag at one frequency.
#[derive(Debug, Clone, Serialize)]
pub struct LagFigures {
    /// Angular frequency [rad/s].
    pub frequency: f64,
    /// Loop area [N m rad/s].
    pub area: Measured,
    /// Standard error of the mean area that the stated noise of the torque leads to [N m rad/s].
    pub area_noise: f64,
    /// Whole periods of a run.
    pub periods: u32,
    /// Velocity over one period, mean over the repetitions [rad/s].
    pub velocity: Vec<f64>,
    /// Friction torque over one period, mean over the repetitions [N m].
    pub torque: Vec<f64>,
}

impl LagFigures {
    /// Whether the area is clear of zero by three of its uncertainties.
    #[must_use]
    pub fn visible(&self) -> bool {
        self.area.mean.abs() > 3.0 * self.area.uncertainty().max(self.area_noise)
    }
}

/// Breakaway under one excitation.
#[derive(Debug, Clone, Serialize)]
pub struct BreakawayFigures {
    /// The excitation.
    pub excitation: String,
    /// Rate of the driving torque at the onset, mean over the repetitions [N m/s].
    pub rate: f64,
    /// Friction torque at the onset [N m].
    pub torque: Measured,
    /// Highest friction torque before gross motion [N m].
    pub peak: Measured,
    /// Displacement at the onset [rad].
    pub displacement: Measured,
}

/// One closed loop of the nested path.
#[derive(Debug, Clone, Serialize)]
pub struct ClosureFigures {
    /// Turn at which it begins and turn at which it ends, from 1.
    pub turns: (usize, usize),
    /// Torque level of both [N m].
    pub level: f64,
    /// Displacement at the end minus at the beginning [rad].
    pub gap: Measured,
    /// Work that the loop takes [J].
    pub work: Measured,
}

/// How far a characterisation came.
pub(super) struct Progressed {
    pub completion: Completion,
    pub rig_seconds: f64,
}

impl<R> From<&Driven<R>> for Progressed {
    fn from(driven: &Driven<R>) -> Self {
        Self { completion: driven.completion, rig_seconds: driven.rig_seconds }
    }
}

/// Every group's excitation, each repeated, group after group.
fn repeated(
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

fn excitation(quantity: DrivenQuantity, profile: Profile) -> Excitation {
    Excitation { quantity, profile }
}

/// Text of a number in a file's name: `2.5` becomes `2_5`.
fn in_name(value: f64) -> String {
    format!("{value}").replace('.', "_")
}

impl Bench<'_> {
    /// Experiment 2.
    pub(super) fn varying_velocity(
        &self,
        found: &mut Characterisation,
        recorder: &mut Recorder,
        timeline: &mut Timeline,
    ) -> Result<Progressed, RunError> {
        let protocol = &self.options.varying_velocity;
        let velocity = |profile| excitation(DrivenQuantity::Velocity, profile);
        let mut groups: Vec<(String, Excitation)> = protocol
            .frequencies
            .iter()
            .map(|&w| (format!("{w} rad/s"), velocity(protocol.sine(w))))
            .collect();
        groups.push(("chirp".to_owned(), velocity(protocol.chirp())));
        let first =
            |period: f64| ((protocol.run_in + protocol.drop_first) / period).round() as usize;
        let series = Series {
            name: "varying-velocity",
            stream: 3,
            displacement: Displacement::Encoder,
            every_cycle: false,
        };
        let jobs = repeated(&groups, protocol.repetitions, protocol.feed_forward, None);
        let driven = self.drive(series, jobs, recorder, timeline, |job, channels, friction| {
            let &w = protocol.frequencies.get(job.group)?;
            lag_loop(friction, &channels.velocity, channels.period, first(channels.period), w)
        })?;
        for (group, &frequency) in protocol.frequencies.iter().enumerate() {
            let loops: Vec<&LagLoop> = driven.of(group).flatten().collect();
            found.lag.extend(lag_figures(frequency, &loops));
        }
        let progressed = Progressed::from(&driven);
        let period = self.options.test_bed.simulation.period;
        let run_in = (protocol.run_in / period).round() as usize;
        for (group, record) in driven.means.into_iter().enumerate() {
            let (name, skip) = match protocol.frequencies.get(group) {
                Some(&w) => (format!("lag_{}_rad_s.csv", in_name(w)), first(period)),
                None => ("lag_chirp.csv".to_owned(), run_in),
            };
            found.records.push((name, record.from(skip, TABLE_SAMPLES)));
        }
        Ok(progressed)
    }

    /// Experiment 3, both stages.
    pub(super) fn pre_sliding(
        &self,
        found: &mut Characterisation,
        recorder: &mut Recorder,
        timeline: &mut Timeline,
    ) -> Result<Progressed, RunError> {
        let protocol = &self.options.pre_sliding;
        let torque = |profile| excitation(DrivenQuantity::Torque, profile);
        let groups = [
            ("ramp upwards".to_owned(), torque(protocol.ramp(1.0))),
            ("ramp downwards".to_owned(), torque(protocol.ramp(-1.0))),
        ];
        let series = Series {
            name: "pre-sliding",
            stream: 4,
            displacement: protocol.displacement,
            every_cycle: false,
        };
        let (ramps, mut progressed) = self.breakaways(
            series,
            &groups,
            &protocol.onset,
            protocol.repetitions,
            found,
            (recorder, timeline),
        )?;
        found.ramps = ramps;
        if progressed.completion != Completion::All {
            return Ok(progressed);
        }
        let groups = [("nested path".to_owned(), torque(protocol.path()))];
        let series = Series { stream: 5, ..series };
        let jobs = repeated(&groups, protocol.repetitions, false, None);
        let mut driven =
            self.drive(series, jobs, recorder, timeline, |_, channels, friction| {
                nested_path(channels, friction, protocol)
            })?;
        let paths: Vec<&NestedPath> = driven.of(0).collect();
        found.closures = closure_figures(&paths);
        found.path =
            (mean_of(&paths, |path| &path.displacement), mean_of(&paths, |path| &path.torque));
        let size = (protocol.duration
            / self.options.test_bed.simulation.period
            / f64::from(protocol.samples))
        .round();
        let after = Progressed::from(&driven);
        progressed =
            Progressed { rig_seconds: progressed.rig_seconds + after.rig_seconds, ..after };
        if let Some(record) = driven.means.pop() {
            let rest = (crate::protocol::REST / self.options.test_bed.simulation.period) as usize;
            found.records.push((
                "presliding.csv".to_owned(),
                record.from(rest, usize::MAX).thinned(size as usize),
            ));
        }
        Ok(progressed)
    }

    /// Experiment 4.
    pub(super) fn breakaway_rate(
        &self,
        found: &mut Characterisation,
        recorder: &mut Recorder,
        timeline: &mut Timeline,
    ) -> Result<Progressed, RunError> {
        let protocol = &self.options.breakaway_rate;
        let torque = |profile| excitation(DrivenQuantity::Torque, profile);
        let ramps = protocol
            .rates
            .iter()
            .map(|&rate| (format!("ramp {rate} N m/s"), torque(protocol.ramp(rate))));
        let sines = protocol
            .frequencies
            .iter()
            .map(|&w| (format!("sine {w} rad/s"), torque(protocol.sine(w))));
        let groups: Vec<(String, Excitation)> = ramps.chain(sines).collect();
        let series = Series {
            name: "breakaway-rate",
            stream: 6,
            displacement: protocol.displacement,
            every_cycle: false,
        };
        let (rates, progressed) = self.breakaways(
            series,
            &groups,
            &protocol.onset,
            protocol.repetitions,
            found,
            (recorder, timeline),
        )?;
        found.rates = rates;
        Ok(progressed)
    }

    /// Voltage that shows the drive: recorded, no more.
    pub(super) fn drive_excitation(
        &self,
        found: &mut Characterisation,
        recorder: &mut Recorder,
        timeline: &mut Timeline,
    ) -> Result<Progressed, RunError> {
        let protocol = &self.options.drive_excitation;
        let name = Kind::DriveExcitation.name();
        let groups = [(name.to_owned(), protocol.excitation.clone())];
        let series =
            Series { name, stream: 8, displacement: Displacement::Encoder, every_cycle: true };
        let jobs = repeated(&groups, protocol.repetitions, false, Some(protocol.travel));
        let whole = protocol.excitation.profile.duration();
        let mut driven = self.drive(series, jobs, recorder, timeline, |job, channels, _| {
            let seconds = channels.time.last().copied().unwrap_or(0.0);
            (job.repetition, seconds)
        })?;
        for &(repetition, seconds) in driven.of(0) {
            if seconds < whole - 0.01 {
                found.notes.push(format!(
                    "{name}, repetition {}: ended after {seconds:.1} s of {whole:.1} s, where the shaft was {:.2} rad from its start, the protocol's `travel`",
                    repetition + 1,
                    protocol.travel
                ));
            }
        }
        let progressed = Progressed::from(&driven);
        found.records.extend(driven.means.pop().map(|record| (format!("{name}.csv"), record)));
        Ok(progressed)
    }

    /// A sequence of one's own: recorded, no more.
    pub(super) fn sequence(
        &self,
        found: &mut Characterisation,
        recorder: &mut Recorder,
        timeline: &mut Timeline,
    ) -> Result<Progressed, RunError> {
        let Some(protocol) = &self.options.sequence else {
            return Ok(Progressed { completion: Completion::All, rig_seconds: 0.0 });
        };
        let groups = [(protocol.name.clone(), protocol.excitation.clone())];
        let series = Series {
            name: "sequence",
            stream: 7,
            displacement: Displacement::Encoder,
            every_cycle: false,
        };
        let jobs = repeated(&groups, protocol.repetitions, protocol.feed_forward, None);
        let mut driven = self.drive(series, jobs, recorder, timeline, |_, _, _| ())?;
        let progressed = Progressed::from(&driven);
        found
            .records
            .extend(driven.means.pop().map(|record| (format!("{}.csv", protocol.name), record)));
        Ok(progressed)
    }

    /// Runs that end in breakaway, and what they show.
    fn breakaways(
        &self,
        series: Series,
        groups: &[(String, Excitation)],
        onset: &OnsetRule,
        repetitions: u32,
        found: &mut Characterisation,
        (recorder, timeline): (&mut Recorder, &mut Timeline),
    ) -> Result<(Vec<BreakawayFigures>, Progressed), RunError> {
        let jobs = repeated(groups, repetitions, false, Some(3.0 * onset.gross_motion));
        let direction = |excitation: &Excitation| {
            let profile = &excitation.profile;
            if profile.at(profile.duration() * 0.5).0 < 0.0 { -1.0 } else { 1.0 }
        };
        let driven = self.drive(series, jobs, recorder, timeline, |job, channels, friction| {
            find_breakaway(
                channels,
                friction,
                onset,
                series.displacement,
                direction(&job.excitation),
            )
            .map_err(|why| {
                format!("{}, {}, repetition {}: {why}", series.name, job.stage, job.repetition + 1)
            })
        })?;
        let mut figures = Vec::new();
        for (group, (name, excitation)) in groups.iter().enumerate() {
            let runs: Vec<Breakaway> =
                driven.of(group).filter_map(|run| run.as_ref().ok().copied()).collect();
            found.notes.extend(driven.of(group).filter_map(|run| run.as_ref().err().cloned()));
            figures.extend(breakaway_figures(name, excitation, &runs));
        }
        let progressed = Progressed::from(&driven);
        for ((name, _), record) in groups.iter().zip(driven.means) {
            let name: String =
                name.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
            found.records.push((format!("breakaway_{name}.csv"), record));
        }
        Ok((figures, progressed))
    }
}

fn lag_figures(frequency: f64, loops: &[&LagLoop]) -> Option<LagFigures> {
    let area = Measured::of(
        &loops.iter().map(|found| (found.area, found.area_systematic)).collect::<Vec<_>>(),
    )?;
    let n = loops.len() as f64;
    Some(LagFigures {
        frequency,
        area,
        area_noise: loops.iter().map(|found| found.area_noise).sum::<f64>() / n / n.sqrt(),
        periods: loops.first()?.periods,
        velocity: mean_of(loops, |found| &found.velocity),
        torque: mean_of(loops, |found| &found.torque),
    })
}

fn breakaway_figures(
    name: &str,
    excitation: &Excitation,
    runs: &[Breakaway],
) -> Option<BreakawayFigures> {
    let of = |value: &dyn Fn(&Breakaway) -> (f64, f64)| {
        Measured::of(&runs.iter().map(value).collect::<Vec<_>>())
    };
    let rate = |run: &Breakaway| excitation.profile.at(crate::protocol::REST + run.time).1.abs();
    Some(BreakawayFigures {
        excitation: name.to_owned(),
        rate: runs.iter().map(rate).sum::<f64>() / runs.len() as f64,
        torque: of(&|run| (run.torque, run.torque_systematic))?,
        peak: of(&|run| (run.peak, run.torque_systematic))?,
        displacement: of(&|run| (run.displacement, 0.0))?,
    })
}

fn closure_figures(paths: &[&NestedPath]) -> Vec<ClosureFigures> {
    let Some(first) = paths.first() else { return Vec::new() };
    let of = |index: usize, value: fn(&Closure) -> (f64, f64)| {
        let each = paths.iter().filter_map(|path| path.closures.get(index)).map(value);
        Measured::of(&each.collect::<Vec<_>>())
    };
    let figures = |(index, closure): (usize, &Closure)| {
        Some(ClosureFigures {
            turns: (closure.begin + 1, closure.end + 1),
            level: closure.level,
            gap: of(index, |closure| (closure.gap, 0.0))?,
            work: of(index, |closure| (closure.work, closure.work_systematic))?,
        })
    };
    first.closures.iter().enumerate().filter_map(figures).collect()
}

/// Mean over things of one of their lists, as long as the shortest.
fn mean_of<T>(of: &[&T], list: impl Fn(&T) -> &Vec<f64>) -> Vec<f64> {
    let shortest = of.iter().map(|one| list(one).len()).min().unwrap_or(0);
    (0..shortest)
        .map(|i| of.iter().map(|one| list(one)[i]).sum::<f64>() / of.len() as f64)
        .collect()
}
