//! A sequence of one's own: recorded, no more.

use work::sequencer::Completion;

use super::excitations::repeated;
use crate::protocol::{Displacement, ProtocolError, ProtocolFile, SequenceProtocol};
use crate::run::excited::Series;
use crate::run::experiment::{Experiment, Progressed, Put, Running};
use crate::run::{RunError, RunOptions};

/// The experiment.
#[derive(Debug, Clone, Copy)]
pub struct Sequence;

impl Experiment for Sequence {
    fn name(&self) -> &'static str {
        SequenceProtocol::NAME
    }

    fn about(&self) -> &'static str {
        "A sequence of one's own, from `--protocol FILE`"
    }

    fn protocol(&self) -> Option<&'static str> {
        Some(SequenceProtocol::TEXT)
    }

    fn read(&self, text: &str) -> Result<Put, ProtocolError> {
        let protocol = SequenceProtocol::read(text)?;
        Ok(Box::new(|options| options.sequence = Some(protocol)))
    }

    fn rig_seconds(&self, options: &RunOptions) -> f64 {
        options.sequence.as_ref().map_or(0.0, SequenceProtocol::rig_seconds)
    }

    fn needs_protocol(&self) -> bool {
        true
    }

    fn carry_out(&self, running: &mut Running<'_, '_>) -> Result<Progressed, RunError> {
        let Some(protocol) = &running.options().sequence else {
            return Ok(Progressed::new(Completion::All, 0.0));
        };
        let groups = [(protocol.name.clone(), protocol.excitation.clone())];
        let series = Series {
            name: "sequence",
            stream: 7,
            displacement: Displacement::Encoder,
            every_cycle: false,
        };
        let jobs = repeated(&groups, protocol.repetitions, protocol.feed_forward, None);
        let mut driven = running.drive(series, jobs, |_, _, _| ())?;
        let progressed = Progressed::from(&driven);
        running
            .found
            .characterisation
            .records
            .extend(driven.means.pop().map(|record| (format!("{}.csv", protocol.name), record)));
        Ok(progressed)
    }
}
