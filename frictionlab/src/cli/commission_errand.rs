//! A commission that is asked for over ROS 2.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use clap::{Args, Command};
use commission::friction::wanted::CurveParameter;
use commission::hand_over::{Found, proved};
use commission::{Outcome, Ranged};
use experiment_runner::errand::{Carried, Ending, Errand, Prepared};
use experiment_runner::server::request::parse;
use msgs::friction_msgs::EstimatedParameter;
use rig_setup::RigChoice;
use work::Interrupted;
use work::ending::told;
use work::progress::Progress;

use super::commission_args::CommissionArgs;
use super::commission_planned::{Planned, ended, planned};
use crate::viewing::REQUESTED;

/// Rig time that it usually takes \[s\].
const USUAL: f64 = 450.0;

/// The commission, as an experiment can be asked for.
pub struct Commission;

impl Errand for Commission {
    fn name(&self) -> &'static str {
        "commission"
    }

    fn about(&self) -> &'static str {
        "From an unknown motor to a compensated one, in minutes"
    }

    fn command(&self) -> Command {
        CommissionArgs::augment_args(Command::new("commission"))
    }

    fn reserved(&self) -> &'static [&'static str] {
        &[
            "out",
            "runs",
            "force",
            // Whoever clears a stop stands at the rig.
            "clear",
            "yes",
            "trial",
            "part",
            "join",
            "jobs",
            "protocols",
            "quiet",
            "json",
            "verbose",
            "rig-file",
        ]
    }

    fn rig_seconds(&self) -> f64 {
        USUAL
    }

    fn prepare(
        &self,
        options: &[String],
        rig: &RigChoice,
        profile: Option<&Path>,
    ) -> Result<Box<dyn Prepared>, String> {
        let mut args: CommissionArgs = parse(options).map_err(|refusal| refusal.to_string())?;
        args.rig = Some(rig.clone());
        args.rig_file = profile.map(Path::to_owned);
        let planned = planned(&args).map_err(|error| told(&error))?;
        Ok(Box::new(Ready(planned)))
    }
}

/// A commission that may begin.
struct Ready(Planned);

impl Prepared for Ready {
    fn rig_seconds(&self) -> f64 {
        self.0.asked.allowed
    }

    fn resumes(&self) -> Option<PathBuf> {
        self.0.resumes()
    }

    fn carry_out(
        self: Box<Self>,
        folder: &Path,
        progress: &Progress,
        cancel: &Arc<AtomicBool>,
    ) -> Carried {
        match carried_out(self.0, folder, progress, cancel) {
            Ok(outcome) => Carried {
                ending: Ending::Complete,
                message: format!(
                    "commissioned in {:.0} s of rig time: {}",
                    outcome.found.seconds,
                    proved(&outcome.found.proof)
                ),
                parameters: parameters(&outcome.found),
            },
            Err(error) => {
                // Nothing is in it where the rig was refused.
                let _ = std::fs::remove_dir(folder);
                let stopped = error.downcast_ref::<Interrupted>().is_some();
                Carried {
                    ending: if stopped { Ending::Stopped } else { Ending::Failed },
                    message: told(&error),
                    parameters: Vec::new(),
                }
            }
        }
    }
}

fn carried_out(
    planned: Planned,
    folder: &Path,
    progress: &Progress,
    cancel: &Arc<AtomicBool>,
) -> anyhow::Result<Outcome> {
    progress.stage("looking at the rig");
    let (known, identity) = planned.look()?;
    let asked = planned.asked.clone();
    let dossier = planned.begin(&identity, || Ok(folder.to_owned()))?;
    commission::run_watched(&asked, &known, &dossier, cancel, (progress, &REQUESTED))
        .map_err(|error| ended(error, &dossier))
}

/// What was found, as messages.
fn parameters(found: &Found) -> Vec<EstimatedParameter> {
    let one = |name: &str, unit: &str, ranged: Ranged| EstimatedParameter {
        model: "stribeck".to_owned(),
        name: name.to_owned(),
        unit: unit.to_owned(),
        value: ranged.value,
        standard_error: f64::NAN,
        low: ranged.low.unwrap_or(f64::NAN),
        high: ranged.high.unwrap_or(f64::NAN),
        identified: ranged.low.is_some() && ranged.high.is_some(),
        explanation: String::new(),
    };
    let curve = &found.chosen.curve;
    vec![
        one("gain", "rad/s per V", found.drive.gain),
        one("time_constant", "s", found.drive.time_constant),
        one("delay", "s", found.drive.delay),
        one("f_c", "V", CurveParameter::FC.of(curve)),
        one("f_s", "V", CurveParameter::FS.of(curve)),
        one("v_s", "rad/s", CurveParameter::VS.of(curve)),
        one("slope", "V s/rad", CurveParameter::Slope.of(curve)),
    ]
}
