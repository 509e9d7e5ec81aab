//! Experiment 4: breakaway against the rate of the torque.

use super::excitations::{breakaways, excitation};
use crate::profile::{DrivenQuantity, Excitation};
use crate::protocol::{BreakawayRateProtocol, ProtocolError, ProtocolFile};
use crate::run::excited::Series;
use crate::run::experiment::{Experiment, Progressed, Put, Running};
use crate::run::{RunError, RunOptions};

/// The experiment.
#[derive(Debug, Clone, Copy)]
pub struct BreakawayRate;

impl Experiment for BreakawayRate {
    fn name(&self) -> &'static str {
        BreakawayRateProtocol::NAME
    }

    fn about(&self) -> &'static str {
        "Breakaway against the rate of the torque"
    }

    fn protocol(&self) -> Option<&'static str> {
        Some(BreakawayRateProtocol::TEXT)
    }

    fn read(&self, text: &str) -> Result<Put, ProtocolError> {
        let protocol = BreakawayRateProtocol::read(text)?;
        Ok(Box::new(|options| options.breakaway_rate = protocol))
    }

    fn rig_seconds(&self, options: &RunOptions) -> f64 {
        options.breakaway_rate.rig_seconds()
    }

    fn shorten(&self, options: &mut RunOptions) {
        options.breakaway_rate = options.breakaway_rate.clone().quick();
    }

    fn repeat(&self, options: &mut RunOptions, repetitions: u32) {
        options.breakaway_rate.repetitions = repetitions;
    }

    fn carry_out(&self, running: &mut Running<'_, '_>) -> Result<Progressed, RunError> {
        let protocol = &running.options().breakaway_rate;
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
        let (rates, progressed) =
            breakaways(running, series, &groups, &protocol.onset, protocol.repetitions)?;
        running.found.characterisation.rates = rates;
        Ok(progressed)
    }
}
