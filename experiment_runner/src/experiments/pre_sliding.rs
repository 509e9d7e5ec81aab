//! Experiment 3: breakaway by slow ramps of torque, and hysteresis below it.

use work::sequencer::Completion;

use super::excitations::{breakaways, excitation, mean_of, repeated};
use crate::characterise::{Closure, Measured, NestedPath, nested_path};
use crate::profile::DrivenQuantity;
use crate::profile::REST;
use crate::protocol::{PreSlidingProtocol, ProtocolError, ProtocolFile};
use crate::run::excited::Series;
use crate::run::experiment::{Experiment, Progressed, Put, Running};
use crate::run::{ClosureFigures, RunError, RunOptions};

/// The experiment.
#[derive(Debug, Clone, Copy)]
pub struct PreSliding;

impl Experiment for PreSliding {
    fn name(&self) -> &'static str {
        PreSlidingProtocol::NAME
    }

    fn about(&self) -> &'static str {
        "Breakaway by slow ramps of torque, and hysteresis below it"
    }

    fn protocol(&self) -> Option<&'static str> {
        Some(PreSlidingProtocol::TEXT)
    }

    fn read(&self, text: &str) -> Result<Put, ProtocolError> {
        let protocol = PreSlidingProtocol::read(text)?;
        Ok(Box::new(|options| options.pre_sliding = protocol))
    }

    fn rig_seconds(&self, options: &RunOptions) -> f64 {
        options.pre_sliding.rig_seconds()
    }

    fn shorten(&self, options: &mut RunOptions) {
        options.pre_sliding = options.pre_sliding.clone().quick();
    }

    fn repeat(&self, options: &mut RunOptions, repetitions: u32) {
        options.pre_sliding.repetitions = repetitions;
    }

    fn carry_out(&self, running: &mut Running<'_, '_>) -> Result<Progressed, RunError> {
        let protocol = &running.options().pre_sliding;
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
        let (ramps, mut progressed) =
            breakaways(running, series, &groups, &protocol.onset, protocol.repetitions)?;
        running.found.characterisation.ramps = ramps;
        if progressed.completion != Completion::All {
            return Ok(progressed);
        }
        let groups = [("nested path".to_owned(), torque(protocol.path()))];
        let series = Series { stream: 5, ..series };
        let jobs = repeated(&groups, protocol.repetitions, false, None);
        let mut driven = running.drive(series, jobs, |_, channels, friction| {
            nested_path(channels, friction, protocol)
        })?;
        let paths: Vec<&NestedPath> = driven.of(0).collect();
        running.found.characterisation.closures = closure_figures(&paths);
        running.found.characterisation.path =
            (mean_of(&paths, |path| &path.displacement), mean_of(&paths, |path| &path.torque));
        let size = (protocol.duration
            / running.options().test_bed.simulation.period
            / f64::from(protocol.samples))
        .round();
        let after = Progressed::from(&driven);
        progressed =
            Progressed { rig_seconds: progressed.rig_seconds + after.rig_seconds, ..after };
        if let Some(record) = driven.means.pop() {
            let rest = (REST / running.options().test_bed.simulation.period) as usize;
            running.found.characterisation.records.push((
                "presliding.csv".to_owned(),
                record.from(rest, usize::MAX).thinned(size as usize),
            ));
        }
        Ok(progressed)
    }
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
