//! Compensations compared in tracking and regulation of velocity and position.

use work::sequencer::Completion;

use crate::protocol::{CompensationProtocol, ProtocolError, ProtocolFile};
use crate::run::experiment::{Experiment, Progressed, Put, Running};
use crate::run::sorted::TrackedTask;
use crate::run::{RunError, RunOptions};

/// The experiment.
#[derive(Debug, Clone, Copy)]
pub struct Compensation;

impl Experiment for Compensation {
    fn name(&self) -> &'static str {
        CompensationProtocol::NAME
    }

    fn about(&self) -> &'static str {
        "Compensations compared: tracking and regulation of velocity and position"
    }

    fn protocol(&self) -> Option<&'static str> {
        Some(CompensationProtocol::TEXT)
    }

    fn read(&self, text: &str) -> Result<Put, ProtocolError> {
        let protocol = CompensationProtocol::read(text)?;
        Ok(Box::new(|options| options.compensation = protocol))
    }

    fn rig_seconds(&self, options: &RunOptions) -> f64 {
        options.compensation.rig_seconds(options.arms())
    }

    fn shorten(&self, options: &mut RunOptions) {
        self.repeat(options, 1);
    }

    fn repeat(&self, options: &mut RunOptions, repetitions: u32) {
        options.compensation = options.compensation.clone().repeated(repetitions);
    }

    fn reads_torque(&self) -> bool {
        false
    }

    fn carry_out(&self, running: &mut Running<'_, '_>) -> Result<Progressed, RunError> {
        let mut whole = Progressed::new(Completion::All, 0.0);
        for (task, stream) in running.options().compensation.tasks.iter().zip(3u64..) {
            let progressed = running.compare(TrackedTask {
                name: task.name.clone(),
                protocol: task.protocol.clone(),
                stream: stream << 32,
                compared: true,
            })?;
            whole.rig_seconds += progressed.rig_seconds;
            if progressed.completion != Completion::All {
                whole.completion = progressed.completion;
                break;
            }
        }
        Ok(whole)
    }
}
