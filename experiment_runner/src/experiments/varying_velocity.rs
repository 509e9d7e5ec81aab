//! Experiment 2: friction under a velocity that varies and keeps its sign.

use super::excitations::{excitation, in_name, mean_of, repeated};
use crate::characterise::{LagLoop, Measured, lag_loop};
use crate::profile::{DrivenQuantity, Excitation};
use crate::protocol::{Displacement, ProtocolError, ProtocolFile, VaryingVelocityProtocol};
use crate::run::excited::Series;
use crate::run::experiment::{Experiment, Progressed, Put, Running};
use crate::run::{LagFigures, RunError, RunOptions};

/// Samples of a stretch of varying velocity that its table holds at most.
const TABLE_SAMPLES: usize = 20_000;

/// The experiment.
#[derive(Debug, Clone, Copy)]
pub struct VaryingVelocity;

impl Experiment for VaryingVelocity {
    fn name(&self) -> &'static str {
        VaryingVelocityProtocol::NAME
    }

    fn about(&self) -> &'static str {
        "Friction under a velocity that varies without a reversal: frictional lag"
    }

    fn protocol(&self) -> Option<&'static str> {
        Some(VaryingVelocityProtocol::TEXT)
    }

    fn read(&self, text: &str) -> Result<Put, ProtocolError> {
        let protocol = VaryingVelocityProtocol::read(text)?;
        Ok(Box::new(|options| options.varying_velocity = protocol))
    }

    fn rig_seconds(&self, options: &RunOptions) -> f64 {
        options.varying_velocity.rig_seconds()
    }

    fn shorten(&self, options: &mut RunOptions) {
        options.varying_velocity = options.varying_velocity.clone().quick();
    }

    fn repeat(&self, options: &mut RunOptions, repetitions: u32) {
        options.varying_velocity.repetitions = repetitions;
    }

    fn carry_out(&self, running: &mut Running<'_, '_>) -> Result<Progressed, RunError> {
        let protocol = &running.options().varying_velocity;
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
        let driven = running.drive(series, jobs, |job, channels, friction| {
            let &w = protocol.frequencies.get(job.group)?;
            lag_loop(friction, &channels.velocity, channels.period, first(channels.period), w)
        })?;
        for (group, &frequency) in protocol.frequencies.iter().enumerate() {
            let loops: Vec<&LagLoop> = driven.of(group).flatten().collect();
            running.found.characterisation.lag.extend(lag_figures(frequency, &loops));
        }
        let progressed = Progressed::from(&driven);
        let period = running.options().test_bed.simulation.period;
        let run_in = (protocol.run_in / period).round() as usize;
        for (group, record) in driven.means.into_iter().enumerate() {
            let (name, skip) = match protocol.frequencies.get(group) {
                Some(&w) => (format!("lag_{}_rad_s.csv", in_name(w)), first(period)),
                None => ("lag_chirp.csv".to_owned(), run_in),
            };
            running.found.characterisation.records.push((name, record.from(skip, TABLE_SAMPLES)));
        }
        Ok(progressed)
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
