//! Voltage that shows the drive: recorded, no more.

use super::excitations::repeated;
use crate::protocol::{Displacement, DriveExcitationProtocol, ProtocolError, ProtocolFile};
use crate::run::excited::Series;
use crate::run::experiment::{Experiment, Progressed, Put, Running};
use crate::run::{RunError, RunOptions};

/// The experiment.
#[derive(Debug, Clone, Copy)]
pub struct DriveExcitation;

impl Experiment for DriveExcitation {
    fn name(&self) -> &'static str {
        DriveExcitationProtocol::NAME
    }

    fn about(&self) -> &'static str {
        "Voltage that shows the drive: steps, a binary sequence, a chirp, a slow triangle; `identify-drive` reads its bag"
    }

    fn protocol(&self) -> Option<&'static str> {
        Some(DriveExcitationProtocol::TEXT)
    }

    fn read(&self, text: &str) -> Result<Put, ProtocolError> {
        let protocol = DriveExcitationProtocol::read(text)?;
        Ok(Box::new(|options| options.drive_excitation = protocol))
    }

    fn rig_seconds(&self, options: &RunOptions) -> f64 {
        options.drive_excitation.rig_seconds()
    }

    fn repeat(&self, options: &mut RunOptions, repetitions: u32) {
        options.drive_excitation.repetitions = repetitions;
    }

    fn reads_torque(&self) -> bool {
        false
    }

    fn check(&self, options: &RunOptions) -> Result<(), RunError> {
        let asked = options.drive_excitation.highest;
        let limit = options.test_bed.simulation.voltage_limit;
        if asked > limit { Err(RunError::ExcitedTooFar { asked, limit }) } else { Ok(()) }
    }

    fn carry_out(&self, running: &mut Running<'_, '_>) -> Result<Progressed, RunError> {
        let protocol = &running.options().drive_excitation;
        let name = self.name();
        let groups = [(name.to_owned(), protocol.excitation.clone())];
        let series =
            Series { name, stream: 8, displacement: Displacement::Encoder, every_cycle: true };
        let jobs = repeated(&groups, protocol.repetitions, false, Some(protocol.travel));
        let whole = protocol.excitation.profile.duration();
        let mut driven = running.drive(series, jobs, |job, channels, _| {
            let seconds = channels.time.last().copied().unwrap_or(0.0);
            (job.repetition, seconds)
        })?;
        for &(repetition, seconds) in driven.of(0) {
            if seconds < whole - 0.01 {
                running.found.characterisation.notes.push(format!(
                    "{name}, repetition {}: ended after {seconds:.1} s of {whole:.1} s, where the shaft was {:.2} rad from its start, the protocol's `travel`",
                    repetition + 1,
                    protocol.travel
                ));
            }
        }
        let progressed = Progressed::from(&driven);
        running
            .found
            .characterisation
            .records
            .extend(driven.means.pop().map(|record| (format!("{name}.csv"), record)));
        Ok(progressed)
    }
}
