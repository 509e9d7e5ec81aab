//! The options of `frictionlab commission`.

use std::path::PathBuf;

use commission::Stage;
use commission::friction::wanted::Wanted;
use commission::travel::TravelAsked;
use experiment_runner::asked::rig::RigParser;
use friction_model::ModelName;
use rig_driver::RigRegistry;
use rig_setup::RigChoice;
use work::destination::ToFolder;
use work::model_name::model_name;
use work::part::InParts;
use work::saying::Saying;
use work::suggestion::did_you_mean;

/// From an unknown motor to a compensated one, in minutes
///
/// The stages, each with a file of its own in the folder of results:
///
///   meet       signs, zeros and noise; slow ramps until the shaft moves
///   drive      gain, time constant and delay
///   friction   blocks of constant speed, each chosen for what it tells; after each the curve is
///              fitted anew, until --want is met, nothing more is to be gained, or time is up
///   model      which curve predicts a block that was kept back
///   control    linear gains from margins, delay and noise; what is fed forward beside them
///   proof      before and after in alternating blocks, with a 95 % interval
///   hand-over  parameters.yaml for the nodes, commission.json, report.html
///
/// Voltage and encoder alone must do: friction is told in volts. The shaft turns both ways, several
/// times round, and every voltage passes the safety layer. Ctrl-C at any moment puts the motor at
/// zero volts and keeps what is done.
///
///   frictionlab commission                              the simulated rig, to see it
///   frictionlab commission --rig serial:/dev/ttyACM0    a real one; it asks before it moves
///   frictionlab commission --resume runs/commission-1   go on where it was stopped
///   frictionlab commission --resume runs/commission-1 --from friction --minutes 20
///   frictionlab commission --trial 20                   machines that nobody has seen
///   frictionlab commission --protocols                  against the thesis's constant velocities
#[derive(Debug, clap::Args)]
#[command(verbatim_doc_comment)]
pub struct CommissionArgs {
    /// Which rig
    #[arg(long, value_name = "RIG", value_parser = RigParser, hide_possible_values = true, help = format!(
        "Which rig: {} [default: the rig of --rig-file, of the folder of --resume, else simulated]",
        RigRegistry::installed().grammar()
    ))]
    pub(super) rig: Option<RigChoice>,
    /// Rig profile, of which the limits count
    /// [default: rig.yaml of this folder, where --rig names the rig that it is of]
    #[arg(long, value_name = "FILE")]
    pub(super) rig_file: Option<PathBuf>,
    /// Voltage limit of this rig [V], at most its own voltage range
    /// [default: that of the profile, else 6]
    #[arg(long, value_name = "V")]
    pub(super) voltage_limit: Option<f64>,
    /// Where the shaft may be [rad], from where it stands when the command begins, as its encoder
    /// counts: -0.5:1.5 is half a radian back and one and a half on. `find` looks for the ends
    /// gently, two turns either way; find:20 looks 20 rad either way
    /// [default: that of the folder of --resume, else the travel of the profile, by the rig's own
    /// count; else it has no ends]
    #[arg(long, value_name = "LOW:HIGH|find", value_parser = str::parse::<TravelAsked>,
        allow_hyphen_values = true, conflicts_with = "trial")]
    pub(super) travel: Option<TravelAsked>,
    #[command(flatten)]
    pub(super) to: ToFolder,
    /// Go on with the commission in this folder
    #[arg(long, value_name = "FOLDER", conflicts_with_all = ["out", "force"])]
    pub(super) resume: Option<PathBuf>,
    /// Measure this stage and all behind it anew; what they found before is dropped
    #[arg(long, value_name = "STAGE", requires = "resume", value_parser = stage)]
    pub(super) from: Option<Stage>,
    /// First clear what is latched in the device, its emergency stop or a fault: for whoever has
    /// looked at the rig and mended the cause
    #[arg(long, conflicts_with_all = ["trial", "protocols"])]
    pub(super) clear: bool,
    /// Drive a real rig without asking
    #[arg(long)]
    pub(super) yes: bool,
    /// Rig time in all [min], from 4 to 120; a commission that goes on counts that of before
    #[arg(long, value_name = "N", default_value_t = 10.0)]
    pub(super) minutes: f64,
    /// Half widths of the 95 % intervals that are wanted, of f_c, f_s, v_s and slope
    #[arg(long, value_name = "WISHES", default_value_t)]
    pub(super) want: Wanted,
    /// Friction model of the simulated rig
    #[arg(long, value_name = "NAME", default_value = "proposed", value_parser = model_name)]
    pub(super) plant: ModelName,
    /// Seed of the simulated rig's noise, or of the first machine of --trial
    #[arg(long, default_value_t = 1)]
    pub(super) seed: u64,
    /// Wire the simulated rig wrong, as in `frictionlab rig check --help`
    #[arg(long, value_name = "MISTAKES")]
    pub(super) miswired: Option<String>,
    /// Commission so many simulated machines drawn at random, the first with --seed, and say how it
    /// went: each is described by a file in the folder, which `--rig machine:FILE` drives again
    #[arg(long, value_name = "N", value_parser = machines,
        conflicts_with_all = ["rig", "rig_file", "voltage_limit", "resume", "yes", "miswired", "plant"])]
    pub(super) trial: Option<u32>,
    #[command(flatten)]
    pub(super) parts: InParts,
    /// Threads of --trial [default: all cores]; the figures do not depend on it
    #[arg(long, value_name = "N", requires = "trial", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(super) jobs: Option<u16>,
    /// Drive the thesis's constant velocities beside it, and show rig time and intervals of both: on
    /// the simulated rig, or on every machine of --trial
    #[arg(long, conflicts_with_all = ["rig", "rig_file", "voltage_limit", "resume", "yes", "miswired"])]
    pub(super) protocols: bool,
    /// Print nothing but errors
    #[arg(long)]
    pub(super) quiet: bool,
    #[command(flatten)]
    pub(super) saying: Saying,
}

/// A number of machines.
fn machines(text: &str) -> Result<u32, String> {
    text.trim().parse().ok().filter(|machines| (1..=100_000).contains(machines)).ok_or_else(|| {
        format!(
            "`{text}` is no number of machines; expected one from 1 to 100000, as in --trial 20"
        )
    })
}

/// A stage by its name.
fn stage(text: &str) -> Result<Stage, String> {
    let names: Vec<String> = Stage::ALL.iter().map(ToString::to_string).collect();
    text.parse().map_err(|_| {
        format!(
            "there is no stage `{text}`; expected one of {}{}",
            names.join(", "),
            did_you_mean(text, names.iter().map(String::as_str))
        )
    })
}
