//! `frictionlab design`: gains from specifications, or what gains are worth.

use std::path::PathBuf;

use controller::design::response::StepDefinition;
use controller::design::{
    LinearDrive, LinearLoop, LoopLaw, PiSpecification, PidRealisation, PositionSpecification,
    VelocitySpecification, lag_from_specification, pi_from_specification, pid_from_specification,
};
use controller::{ControllerError, DerivativeOn, LagGains, PiGains, PidGains, VelocityLaw};
use rig_driver::Drive;

use super::BadInput;
use super::destination::ToFolder;
use crate::design::{DesignOptions, assess, page, parameters, summary};
use crate::drive::parameters::DriveConstants;
use crate::report::render_page;

/// Design the linear controller of velocity or position, or assess gains of your own
///
/// Prints the gains, the step response's figures, the margins continuous and sampled, and what is proven of the loop under friction; writes report.html
/// and controller.yaml, which `run --parameters` and `live --parameters` read.
///
///   frictionlab design velocity --steady-state-error .01 --crossover 110     # lag compensator, the thesis's specification
///   frictionlab design velocity --crossover 150 --phase-margin 60          # PI
///   frictionlab design velocity --gains 1.5136,.0909,.0285                 # three gains: lag; two: PI
///   frictionlab design position --overshoot 15 --rise .2 --settling 1
///   frictionlab design position --gains 5.7517,10,.0768 --drive drive.yaml
#[derive(Debug, clap::Args)]
#[command(verbatim_doc_comment)]
pub struct DesignArgs {
    #[command(subcommand)]
    what: What,
}

#[derive(Debug, clap::Subcommand)]
enum What {
    /// Lag compensator or PI on velocity
    Velocity(VelocityArgs),
    /// PID on position
    Position(PositionArgs),
}

#[derive(Debug, clap::Args)]
struct VelocityArgs {
    /// Error that remains of a constant reference, as a fraction of it; with --crossover: a lag compensator
    #[arg(long, value_name = "FRACTION", conflicts_with_all = ["gains", "phase_margin"], requires = "crossover")]
    steady_state_error: Option<f64>,
    /// Gain crossover [rad/s]
    #[arg(long, value_name = "RAD_S", conflicts_with = "gains")]
    crossover: Option<f64>,
    /// Phase margin [degrees]; with --crossover: a PI
    #[arg(long, value_name = "DEGREES", conflicts_with = "gains", requires = "crossover")]
    phase_margin: Option<f64>,
    /// Gains by hand: K_p,T_i,gamma of a lag compensator, or K_p,K_i of a PI
    #[arg(long, value_name = "GAINS", value_delimiter = ',')]
    gains: Vec<f64>,
    #[command(flatten)]
    shared: SharedArgs,
}

#[derive(Debug, clap::Args)]
struct PositionArgs {
    /// Largest overshoot [%]
    #[arg(long, value_name = "PERCENT", conflicts_with = "gains", requires_all = ["rise", "settling"])]
    overshoot: Option<f64>,
    /// Longest rise time [s]
    #[arg(long, value_name = "SECONDS", conflicts_with = "gains")]
    rise: Option<f64>,
    /// Longest settling time [s]
    #[arg(long, value_name = "SECONDS", conflicts_with = "gains")]
    settling: Option<f64>,
    /// Gains by hand: K_p,K_i,K_d
    #[arg(long, value_name = "GAINS", value_delimiter = ',', allow_negative_numbers = true)]
    gains: Vec<f64>,
    /// The rise is from this to 100 minus this [%]; the thesis does not say which it takes
    #[arg(long, value_name = "PERCENT", default_value_t = 10.0)]
    rise_from: f64,
    /// Half width of the band of the settling time [%]
    #[arg(long, value_name = "PERCENT", default_value_t = 5.0)]
    band: f64,
    /// Largest sensitivity peak a design may have
    #[arg(long, value_name = "PEAK", default_value_t = 2.0)]
    sensitivity: f64,
    /// What the PID differentiates
    #[arg(long, value_enum, default_value_t)]
    derivative: DerivativeArg,
    /// Time constant of the derivative's filter [s]
    #[arg(long, value_name = "SECONDS", default_value_t = 0.005)]
    filter: f64,
    #[command(flatten)]
    shared: SharedArgs,
}

#[derive(Debug, clap::Args)]
struct SharedArgs {
    /// Velocity gain K of the drive [rad/s per V] [default: 1.863, the SRV-02]
    #[arg(long, value_name = "K", conflicts_with = "drive", allow_negative_numbers = true)]
    gain: Option<f64>,
    /// Time constant T of the drive [s] [default: .02388]
    #[arg(long, value_name = "T", conflicts_with = "drive", allow_negative_numbers = true)]
    time_constant: Option<f64>,
    /// Voltage that overcomes 1 N m of friction, Ra/(A Km) [V/(N m)] [default: 4.8426]
    #[arg(long, value_name = "R", conflicts_with = "drive", allow_negative_numbers = true)]
    volts_per_newton_metre: Option<f64>,
    /// The drive as `identify-drive` writes it, or any file with /rig_driver: drive
    #[arg(long, value_name = "FILE")]
    drive: Option<PathBuf>,
    /// Control period [s]
    #[arg(long, value_name = "SECONDS", default_value_t = 1e-3)]
    period: f64,
    #[command(flatten)]
    to: ToFolder,
    /// Print nothing
    #[arg(long, short)]
    quiet: bool,
}

/// [`DerivativeOn`] on the command line.
#[derive(Debug, Clone, Copy, Default, clap::ValueEnum)]
enum DerivativeArg {
    /// The error: quick, with a kick when the reference jumps
    Error,
    /// The measurement, with its sign turned
    #[default]
    Measurement,
}

/// Runs it.
///
/// # Errors
/// [`BadInput`] for gains, specifications or a drive that cannot be, or a folder that cannot be written.
pub fn execute(args: &DesignArgs) -> anyhow::Result<()> {
    let shared = match &args.what {
        What::Velocity(args) => &args.shared,
        What::Position(args) => &args.shared,
    };
    let (drive, volts_per_newton_metre) = drive(shared)?;
    let bad = |error: ControllerError| BadInput(error.to_string());
    let (law, asked) = match &args.what {
        What::Velocity(args) => velocity(args, &drive)?,
        What::Position(args) => position(args, &drive)?,
    };
    let linear = LinearLoop { drive, law };
    let found = assess(DesignOptions { linear, period: shared.period, volts_per_newton_metre, asked })
        .map_err(bad)?;
    let folder = shared.to.reserve("design")?;
    let files =
        [("report.html", render_page(&page(&found))), ("controller.yaml", parameters(&found.options))];
    folder.write(&files)?;
    if !shared.quiet {
        let file = |name: &str| folder.join(name).display().to_string();
        super::print(&format!(
            "{}Report  {}\nGains   {}\n",
            summary(&found),
            file("report.html"),
            file("controller.yaml")
        ))?;
    }
    Ok(())
}

/// The drive, and the volts that overcome a newton metre.
fn drive(args: &SharedArgs) -> Result<(LinearDrive, f64), BadInput> {
    if let Some(file) = &args.drive {
        let blame = |error: String| BadInput(format!("--drive {}: {error}", file.display()));
        let text = crate::input::text(file).map_err(|error| blame(error.to_string()))?;
        let found = DriveConstants::read(&text).map_err(blame)?;
        let drive = Drive::try_from(found.parameters).map_err(|error| blame(error.to_string()))?;
        let linear = LinearDrive { gain: drive.gain(), time_constant: drive.time_constant() };
        return Ok((linear, drive.volts_per_newton_metre()));
    }
    let default = LinearDrive::SRV02;
    let linear = LinearDrive {
        gain: args.gain.unwrap_or(default.gain),
        time_constant: args.time_constant.unwrap_or(default.time_constant),
    };
    Ok((linear, args.volts_per_newton_metre.unwrap_or(4.8426)))
}

fn velocity(args: &VelocityArgs, drive: &LinearDrive) -> Result<(LoopLaw, String), BadInput> {
    let bad = |error: ControllerError| BadInput(error.to_string());
    let (law, asked) = match (
        args.gains.as_slice(),
        args.crossover,
        args.steady_state_error,
        args.phase_margin,
    ) {
        (&[k_p, t_i, gamma], ..) => {
            (VelocityLaw::Lag(LagGains { k_p, t_i, gamma }), "gains by hand".to_owned())
        }
        (&[k_p, k_i], ..) => (VelocityLaw::Pi(PiGains { k_p, k_i }), "gains by hand".to_owned()),
        ([], Some(crossover), Some(error), None) => {
            let specification = VelocitySpecification { steady_state_error: error, crossover };
            let gains = lag_from_specification(drive, &specification).map_err(bad)?;
            (VelocityLaw::Lag(gains), format!("steady-state error {error}, crossover {crossover} rad/s"))
        }
        ([], Some(crossover), None, Some(phase_margin)) => {
            let specification = PiSpecification { crossover, phase_margin };
            let gains = pi_from_specification(drive, &specification).map_err(bad)?;
            (
                VelocityLaw::Pi(gains),
                format!("crossover {crossover} rad/s, phase margin {phase_margin} degrees"),
            )
        }
        _ => {
            let ways = "--steady-state-error with --crossover (lag), --crossover with --phase-margin (PI), or --gains with three numbers \
                        (lag: K_p,T_i,gamma) or two (PI: K_p,K_i)";
            return Err(BadInput(format!("expected one of: {ways}")));
        }
    };
    Ok((LoopLaw::Velocity(law), asked))
}

fn position(args: &PositionArgs, drive: &LinearDrive) -> Result<(LoopLaw, String), BadInput> {
    let derivative_on = match args.derivative {
        DerivativeArg::Error => DerivativeOn::Error,
        DerivativeArg::Measurement => DerivativeOn::Measurement,
    };
    let filter = args.filter;
    let (gains, asked) = match (args.gains.as_slice(), args.overshoot, args.rise, args.settling) {
        (&[k_p, k_i, k_d], ..) => (PidGains { k_p, k_i, k_d }, "gains by hand".to_owned()),
        ([], Some(overshoot), Some(rise_time), Some(settling_time)) => {
            let definition = StepDefinition { rise_from: 0.01 * args.rise_from, band: 0.01 * args.band };
            let specification = PositionSpecification {
                overshoot: 0.01 * overshoot,
                rise_time,
                settling_time,
                definition,
                sensitivity_peak: args.sensitivity,
            };
            let realisation = PidRealisation { derivative_on, filter, period: args.shared.period };
            let gains = pid_from_specification(drive, &specification, &realisation)
                .map_err(|error| BadInput(error.to_string()))?;
            let asked = format!(
                "overshoot {overshoot} %, rise {rise_time} s ({} to {} %), settling {settling_time} s ({} %), sensitivity peak {}",
                args.rise_from,
                100.0 - args.rise_from,
                args.band,
                args.sensitivity
            );
            (gains, asked)
        }
        _ => {
            let ways =
                "--overshoot, --rise and --settling together, or --gains with three numbers, K_p,K_i,K_d";
            return Err(BadInput(format!("expected one of: {ways}")));
        }
    };
    Ok((LoopLaw::Position { gains, derivative_on, filter }, asked))
}
