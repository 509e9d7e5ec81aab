//! What is asked of a design: the options of `frictionlab design`, and what they stand for.

use std::path::PathBuf;

use controller::design::response::StepDefinition;
use controller::design::{
    LinearDrive, LinearLoop, LoopLaw, PiSpecification, PidRealisation, PositionSpecification,
    VelocitySpecification, lag_from_specification, pi_from_specification, pid_from_poles,
    pid_from_specification,
};
use controller::{ControllerError, DerivativeOn, LagGains, PiGains, PidGains, VelocityLaw};

use experiment_runner::compensation::additions::{RETUNED_POSITION, RETUNED_VELOCITY};
use identification::asked::advice as drive_advice;
use identification::drive::linear::KnownDrive;
use report::{linked, render_page};
use work::BadInput;
use work::destination::ToFolder;
use work::saying::Saying;

use super::{Assessment, DesignOptions, Worth, assess, document, page, parameters};

/// Design the linear controller, or assess gains of your own
///
/// Prints the gains, the step response's figures, the margins continuous and sampled, and what is
/// proven of the loop under friction; writes report.html, design.json and controller.yaml, which
/// `run --parameters` and `live --parameters` read.
///
///   frictionlab design velocity --steady-state-error 0.01 --crossover 110     # lag compensator,
///   the thesis's specification frictionlab design velocity --crossover 150 --phase-margin 60      
///      # PI frictionlab design velocity --gains 1.5136,0.0909,0.0285                 # three gains: lag; two: PI
///   frictionlab design position --retuned                              # the best gains of
///   monte-carlo's last row frictionlab design position --overshoot 10 --rise 0.05 --settling 0.3
///   frictionlab design position --gains 5.7517,10,0.0768 --drive drive.yaml
///
/// The design is then tried on the simulated rig beside the default gains: what it follows better,
/// the voltage that it needs, the noise that it makes.
#[derive(Debug, clap::Args)]
#[command(verbatim_doc_comment)]
pub struct DesignArgs {
    #[command(subcommand)]
    what: What,
}

impl DesignArgs {
    /// The options that every design has.
    #[must_use]
    pub const fn shared(&self) -> &SharedArgs {
        match &self.what {
            What::Velocity(args) => &args.shared,
            What::Position(args) => &args.shared,
        }
    }
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
    /// Error that remains of a constant reference, as a fraction of it; with --crossover: a lag
    /// compensator
    #[arg(long, value_name = "FRACTION", conflicts_with_all = ["gains", "phase_margin"], requires = "crossover")]
    steady_state_error: Option<f64>,
    /// Gain crossover [rad/s]
    #[arg(long, value_name = "RAD_S", conflicts_with = "gains")]
    crossover: Option<f64>,
    /// Phase margin [degrees]; with --crossover: a PI
    #[arg(long, value_name = "DEGREES", conflicts_with = "gains", requires = "crossover")]
    phase_margin: Option<f64>,
    /// Gains by hand: K_p,T_i,gamma of a lag compensator, or K_p,K_i of a PI
    #[arg(long, value_name = "GAINS", value_delimiter = ',', allow_hyphen_values = true)]
    gains: Vec<f64>,
    /// A PI with as much gain as the rig's noise allows: that of `retuned-pid` in monte-carlo
    #[arg(long, conflicts_with_all = ["gains", "crossover", "steady_state_error", "phase_margin"])]
    retuned: bool,
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
    #[arg(long, value_name = "GAINS", value_delimiter = ',', allow_hyphen_values = true)]
    gains: Vec<f64>,
    /// As much gain as the rig's margins allow: that of `retuned-pid` in monte-carlo
    #[arg(long, conflicts_with_all = ["gains", "overshoot", "rise", "settling"])]
    retuned: bool,
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

/// The options that every design has.
#[derive(Debug, clap::Args)]
pub struct SharedArgs {
    /// Velocity gain K of the drive [rad/s per V] [default: 1.863, the SRV-02]
    #[arg(long, value_name = "K", conflicts_with = "drive", allow_negative_numbers = true)]
    gain: Option<f64>,
    /// Time constant T of the drive [s] [default: 0.02388]
    #[arg(long, value_name = "T", conflicts_with = "drive", allow_negative_numbers = true)]
    time_constant: Option<f64>,
    /// Voltage that overcomes 1 N m of friction, Ra/(A Km) [V/(N m)]
    /// [default: as the drive's file says, else 4.8426]
    #[arg(long, value_name = "R", allow_negative_numbers = true)]
    volts_per_newton_metre: Option<f64>,
    /// The drive as `identify-drive` writes it: the motor's constants, or gain and time constant
    /// alone
    #[arg(long, value_name = "FILE")]
    drive: Option<PathBuf>,
    /// Voltage that the rig gives at most [V]
    #[arg(long, value_name = "VOLTS", default_value_t = 6.0, allow_negative_numbers = true)]
    voltage_limit: f64,
    /// Control period [s]
    #[arg(long, value_name = "SECONDS", default_value_t = 1e-3)]
    period: f64,
    /// Where the results go
    #[command(flatten)]
    pub to: ToFolder,
    /// Print nothing but errors
    #[arg(long)]
    pub quiet: bool,
    /// What is told besides
    #[command(flatten)]
    pub saying: Saying,
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

/// Designs what the options ask for, and says what it is worth.
///
/// # Errors
/// [`BadInput`] for gains, specifications or a drive that cannot be.
pub fn designed(args: &DesignArgs) -> Result<Assessment, BadInput> {
    let shared = args.shared();
    if !(shared.voltage_limit > 0.0 && shared.voltage_limit.is_finite()) {
        let why = format!("--voltage-limit must be above 0 V, but is {} V", shared.voltage_limit);
        return Err(BadInput(why));
    }
    let (drive, volts_per_newton_metre) = drive(shared)?;
    let (law, asked) = match &args.what {
        What::Velocity(args) => velocity(args, &drive)?,
        What::Position(args) => position(args, &drive)?,
    };
    let linear = LinearLoop { drive, law };
    let mut found =
        assess(DesignOptions { linear, period: shared.period, volts_per_newton_metre, asked })
            .map_err(worded)?;
    // A period that no rig has can be designed for, but not tried.
    found.worth = Worth::of(&found.options, shared.voltage_limit).ok();
    Ok(found)
}

/// Names and contents of the files that a design leaves.
#[must_use]
pub fn contents(found: &Assessment) -> [(&'static str, String); 3] {
    let page = linked(page(found), ["controller.yaml", "design.json"]);
    [
        ("report.html", render_page(&page)),
        ("controller.yaml", parameters(&found.options)),
        ("design.json", format!("{:#}\n", document(found))),
    ]
}

/// Voltage that overcomes 1 N m on the SRV-02 [V/(N m)].
const SRV02_VOLTS_PER_NEWTON_METRE: f64 = 4.8426;

/// A number out of range in the words of the option that it came by.
fn worded(error: ControllerError) -> BadInput {
    let ControllerError::OutOfRange { name, value, expected } = error else {
        return BadInput(error.to_string());
    };
    let percent = |option: &str| {
        // As it was typed: the fraction has lost its last digits.
        let value = (1e8 * value).round() / 1e6;
        format!("{option} must be a number of per cent, zero or more, but is {value} %")
    };
    let option = match name {
        "overshoot" => return BadInput(percent("--overshoot")),
        "definition" => {
            let expected =
                "--rise-from must lie between 0 and 50 %, and --band between 0 and 100 %";
            return BadInput(format!(
                "{expected}; the rise is from {} %",
                (1e8 * value).round() / 1e6
            ));
        }
        "rise_time" => "--rise [s]",
        "settling_time" => "--settling [s]",
        "sensitivity_peak" => "--sensitivity",
        "steady_state_error" => "--steady-state-error",
        "phase_margin" => "--phase-margin [degrees]",
        "crossover" => "--crossover [rad/s]",
        "volts_per_newton_metre" => "--volts-per-newton-metre [V/(N m)]",
        "time_constant" => "--time-constant [s]",
        "gain" => "--gain [rad/s per V]",
        "period" | "dt" => "--period [s]",
        "filter" => "--filter [s]",
        gain @ ("k_p" | "k_i" | "k_d" | "t_i" | "gamma") => {
            return BadInput(format!("{gain} of --gains must be {expected}, but is {value}"));
        }
        other => other,
    };
    BadInput(format!("{option} must be {expected}, but is {value}"))
}

/// The drive, and the volts that overcome a newton metre.
fn drive(args: &SharedArgs) -> Result<(LinearDrive, f64), BadInput> {
    if let Some(file) = &args.drive {
        let blame = |error: String| BadInput(format!("--drive {}: {error}", file.display()));
        let text = files::input::text(file).map_err(|error| blame(error.to_string()))?;
        let found = KnownDrive::read(&text)
            .map_err(|error| blame(format!("{error}{}", drive_advice(&error))))?;
        let volts = args.volts_per_newton_metre.or(found.volts_per_newton_metre);
        return Ok((found.linear, volts.unwrap_or(SRV02_VOLTS_PER_NEWTON_METRE)));
    }
    let default = LinearDrive::THESIS;
    let linear = LinearDrive {
        gain: args.gain.unwrap_or(default.gain),
        time_constant: args.time_constant.unwrap_or(default.time_constant),
    };
    Ok((linear, args.volts_per_newton_metre.unwrap_or(SRV02_VOLTS_PER_NEWTON_METRE)))
}

fn velocity(args: &VelocityArgs, drive: &LinearDrive) -> Result<(LoopLaw, String), BadInput> {
    if args.retuned {
        let gains = pi_from_specification(drive, &RETUNED_VELOCITY).map_err(worded)?;
        return Ok((
            LoopLaw::Velocity(VelocityLaw::Pi(gains)),
            "--retuned, the gains that the rig allows".to_owned(),
        ));
    }
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
            let gains = lag_from_specification(drive, &specification).map_err(worded)?;
            (
                VelocityLaw::Lag(gains),
                format!("steady-state error {error}, crossover {crossover} rad/s"),
            )
        }
        ([], Some(crossover), None, Some(phase_margin)) => {
            let specification = PiSpecification { crossover, phase_margin };
            let gains = pi_from_specification(drive, &specification).map_err(worded)?;
            (
                VelocityLaw::Pi(gains),
                format!("crossover {crossover} rad/s, phase margin {phase_margin} degrees"),
            )
        }
        _ => {
            let ways = "--steady-state-error with --crossover (lag), --crossover with --phase-margin (PI), --retuned, or --gains with three numbers \
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
        _ if args.retuned => {
            let gains = pid_from_poles(drive, &RETUNED_POSITION).map_err(worded)?;
            (gains, "--retuned, the gains that the rig allows".to_owned())
        }
        (&[k_p, k_i, k_d], ..) => (PidGains { k_p, k_i, k_d }, "gains by hand".to_owned()),
        ([], Some(overshoot), Some(rise_time), Some(settling_time)) => {
            let definition =
                StepDefinition { rise_from: 0.01 * args.rise_from, band: 0.01 * args.band };
            let specification = PositionSpecification {
                overshoot: 0.01 * overshoot,
                rise_time,
                settling_time,
                definition,
                sensitivity_peak: args.sensitivity,
            };
            let realisation = PidRealisation { derivative_on, filter, period: args.shared.period };
            let gains =
                pid_from_specification(drive, &specification, &realisation).map_err(worded)?;
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
            let ways = "--overshoot, --rise and --settling together, --retuned, or --gains with three numbers, K_p,K_i,K_d";
            return Err(BadInput(format!("expected one of: {ways}")));
        }
    };
    Ok((LoopLaw::Position { gains, derivative_on, filter }, asked))
}
