//! What can be wrong with a recording or with what it says.

use friction_model::{ModelError, Range};

use crate::axis_term::AxisTerm;
use crate::structure::AxisStructure;

/// Why an identification was refused.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum IdentError {
    /// The recording is too short for what was asked.
    #[error(
        "{what} needs at least {needed} samples, but there are {found}; record longer{}",
        lower.map_or_else(String::new, |lower| format!(", or lower {lower}"))
    )]
    TooFewSamples {
        /// The step that needs them.
        what: &'static str,
        /// How many it needs.
        needed: usize,
        /// How many came.
        found: usize,
        /// What may be lowered instead, if anything.
        lower: Option<&'static str>,
    },
    /// A value is NaN, infinite or beyond anything that can be measured.
    #[error(
        "sample {index} of {channel} is {value}, but every sample must be a finite number, at most 1e50; repair or cut the recording there"
    )]
    NotFinite {
        /// The channel.
        channel: &'static str,
        /// Its sample, counted from zero.
        index: usize,
        /// What came.
        value: f64,
    },
    /// Two channels differ in length.
    #[error(
        "{channel} has {found} samples, but {expected} were expected: all channels must be sampled together"
    )]
    UnequalLengths {
        /// The channel.
        channel: &'static str,
        /// Its samples.
        found: usize,
        /// The force's samples.
        expected: usize,
    },
    /// Neither position nor velocity was given.
    #[error("the motion is missing: give the position or the velocity beside the force")]
    NoMotion,
    /// The sampling period is not a positive number.
    #[error("the sampling period must be a positive number of seconds, but is {0} s")]
    TimeStep(f64),
    /// The low-pass cannot be built.
    #[error(
        "the low-pass cutoff must lie above 0 and below half the sampling rate, {nyquist} Hz here, but is {cutoff} Hz; choose a lower cutoff"
    )]
    Cutoff {
        /// What was asked \[Hz\].
        cutoff: f64,
        /// Half the sampling rate \[Hz\].
        nyquist: f64,
    },
    /// The order of the low-pass is out of range.
    #[error("the order of the low-pass must lie between 1 and 12, but is {0}")]
    Order(usize),
    /// The frame of a local polynomial does not suit its order.
    #[error(
        "a Savitzky-Golay frame must be an odd number of samples, larger than the order (0 to 8) and at most 999, but the frame is {frame} and the order {order}"
    )]
    Frame {
        /// Order of the polynomial.
        order: usize,
        /// Samples of the frame.
        frame: usize,
    },
    /// The outlier identifier has no window or no threshold.
    #[error(
        "the Hampel identifier needs a window of three samples at least on either side and a threshold above zero, but has {half_window} and {threshold}"
    )]
    Hampel {
        /// Samples on either side.
        half_window: usize,
        /// Robust deviations.
        threshold: f64,
    },
    /// The decimation factor is out of range.
    #[error("the decimation factor must lie between 1 and 1000, but is {0}")]
    Decimation(usize),
    /// The recording does not move in a way that shows these terms.
    #[error("the recording cannot tell {} {}: {}", join(terms), if terms.len() > 1 { "apart" } else { "at all" }, excite(terms))]
    NotExcited {
        /// The terms that are unseen, or that cannot be told from one another.
        terms: Vec<AxisTerm>,
    },
    /// A constant of the drive, or its standard error, is out of range.
    #[error(
        "the drive's {name} must be a finite number above zero with a standard error of zero or more, but is {value} +- {standard_error}"
    )]
    DriveConstant {
        /// The constant.
        name: &'static str,
        /// Its value.
        value: f64,
        /// Its standard error.
        standard_error: f64,
    },
    /// The axis holds its place: the position goes to and fro between a few readings of its encoder.
    #[error(
        "the axis does not move: its position stays within {steps:.0} steps of its encoder; record a motion that goes further"
    )]
    HoldsStill {
        /// Between the lowest and the highest reading, in steps.
        steps: f64,
    },
    /// The motion is too fast for the rate at which it was recorded, and no model explains the force.
    #[error(
        "{:.0} % of the motion is faster than the {} Hz that can be followed at {} Hz, and the best model explains only {:.0} % of the force: sample faster or move more slowly",
        100.0 * share, thousandths(*cutoff), thousandths(*rate), 100.0 * explained
    )]
    CannotFollow {
        /// Share of the motion's variance that is faster.
        share: f64,
        /// Up to which frequency motion is taken \[Hz\].
        cutoff: f64,
        /// Sampling rate \[Hz\].
        rate: f64,
        /// Share of the force's mean square that is explained.
        explained: f64,
    },
    /// The force is zero throughout, so that nothing can be explained.
    #[error("the force is zero in every sample; check that the force was recorded, and its unit")]
    ZeroForce,
    /// The driving force is one and the same throughout, although the axis moves as it likes.
    #[error(
        "the driving force is {0} in every sample, while the motion changes: what drives the axis was not recorded; check which column the force is"
    )]
    ConstantForce(f64),
    /// The recording does not move in a way that shows these parameters.
    #[error("the recording cannot tell {} {}; record a motion that reverses, accelerates and runs at several speeds, or choose a simpler structure", names.join(", "), if names.len() > 1 { "apart" } else { "at all" })]
    Columns {
        /// The parameters that are unseen, or that cannot be told from one another.
        names: Vec<String>,
    },
    /// A structure depends on the position, which was not recorded.
    #[error(
        "the structure {structure} depends on the position, but the recording has none; record it, or leave `position` and `harmonic` out"
    )]
    NoPosition {
        /// The structure.
        structure: AxisStructure,
    },
    /// A force that repeats along the axis repeats otherwise in another part of the recording.
    #[error(
        "both halves of the recording do not share one wave: its period is {low:.4} in one part and {high:.4} in another"
    )]
    OtherWaves {
        /// The shortest period that a part asks for \[m or rad\].
        low: f64,
        /// The longest.
        high: f64,
    },
    /// The levels of a dip that lags are not those that its lag was made of.
    #[error(
        "the lag of the dip does not settle: f_s over f_c comes out as {found:.2} where the lag is that of {of:.2}; without lag the dip follows at once"
    )]
    UnsettledLag {
        /// `f_s` over `f_c` as it was fitted.
        found: f64,
        /// As the lag was made of it.
        of: f64,
    },
    /// A dip of which an axis that stops to turn shows no more than how its moves begin and end.
    #[error(
        "the dip lies at speeds that the axis only passes through: where it stands still to turn round, that is how its moves begin and end; record slow motion"
    )]
    DipOfStarts,
    /// A dip that lags fits no better than one that follows at once.
    #[error("the dip does not lag: one that follows the velocity at once fits as well")]
    IdleLag,
    /// A level of friction at rest that no force of the recording comes near.
    #[error(
        "the friction at rest comes out at {level:.3e}, but the force of the motion is {force:.3e} at most: the recording does not show such a dip"
    )]
    LevelBeyond {
        /// The level \[N or N m\].
        level: f64,
        /// The largest force of the motion \[N or N m\].
        force: f64,
    },
    /// A dip that lags has nothing to lag where the friction does not fall.
    #[error(
        "no dip lags: the friction does not fall over the first speeds (f_s over f_c is {ratio:.2})"
    )]
    NoDipToLag {
        /// `f_s` over `f_c` as it was fitted.
        ratio: f64,
    },
    /// A load depends on the position, which the recording lacks.
    #[error("a spring or gravity depends on the position, but the recording has none; record it")]
    NoPositionForLoad,
    /// A recording cannot be cut into so many blocks.
    #[error(
        "the number of blocks must lie between 2 and {most} for this recording of {rows} thinned samples, but is {blocks}"
    )]
    BlockCount {
        /// What was asked.
        blocks: usize,
        /// Samples after thinning.
        rows: usize,
        /// Most blocks that are long enough.
        most: usize,
    },
    /// The best fit has an inertia no body can have.
    #[error(
        "the inertia comes out negative ({value} +- {standard_error}), which no axis can have; the force probably has the wrong sign (turn it round), or is friction alone and not the driving force (then leave the inertia out), or something acts that the model does not have, as gravity does on a joint (then fit a structure that has it)"
    )]
    NegativeInertia {
        /// The estimate.
        value: f64,
        /// Its standard error.
        standard_error: f64,
    },
    /// A standard deviation of a steady point is not positive.
    #[error(
        "the standard deviation of steady point {index} must be a positive number, but is {value}; leave it out if it is unknown"
    )]
    StandardDeviation {
        /// The point, counted from zero.
        index: usize,
        /// What came.
        value: f64,
    },
    /// A standard deviation is so small beside the others that its point alone would count.
    #[error(
        "the standard deviation of steady point {index} is {value:e}, less than a billionth of the largest, {largest:e}; correct it, or leave the deviations out"
    )]
    DeviationRange {
        /// The point, counted from zero.
        index: usize,
        /// What came.
        value: f64,
        /// The largest of all.
        largest: f64,
    },
    /// Some points have a standard deviation and others have none.
    #[error(
        "steady point {index} has no standard deviation while others have; give it for all points or for none"
    )]
    MixedDeviations {
        /// The first point without one, counted from zero.
        index: usize,
    },
    /// The exponent of the Stribeck curve is out of range.
    #[error("the exponent of the Stribeck curve must lie between 0.1 and 10, but is {0}")]
    Exponent(f64),
    /// The points do not span enough speeds.
    #[error(
        "the steady points have {found} different speeds, but the curve needs at least {needed}; measure at more speeds"
    )]
    TooFewSpeeds {
        /// How many it needs.
        needed: usize,
        /// Different absolute velocities found.
        found: usize,
    },
    /// The points push the axis instead of braking it.
    #[error(
        "the best fit has a Coulomb friction of {f_c}, but friction must oppose motion (a positive torque at a positive velocity); check the sign of the torque"
    )]
    NotFriction {
        /// The best Coulomb level.
        f_c: f64,
    },
    /// The best fit is not a curve that friction can have.
    #[error(
        "the best fit is no {model} friction: {parameter} is {value}, but must be {expected}; check the sign of the torque, or measure at more and higher speeds"
    )]
    NotAModel {
        /// The model.
        model: &'static str,
        /// Its parameter.
        parameter: &'static str,
        /// The best value.
        value: f64,
        /// What friction allows.
        expected: Range,
    },
    /// The points lie on one straight line as well as on two.
    #[error(
        "the points show no bend: the slope changes by {change:.3e}, which is not clear of its standard error {standard_error:.3e}; measure at more low speeds, or use Coulomb and viscous friction"
    )]
    NoBend {
        /// The best change of the slope.
        change: f64,
        /// Its standard error; zero where the points lie on a line exactly.
        standard_error: f64,
    },
    /// The number of radial basis functions is out of range.
    #[error("the number of centres must lie between 3 and 32, but is {0}")]
    CentreCount(usize),
    /// The radial basis functions cannot be placed there.
    #[error(
        "the centres must span speeds with 0 < smallest < largest, but smallest is {smallest} and largest {largest}"
    )]
    CentreSpan {
        /// First centre above zero.
        smallest: f64,
        /// Last centre.
        largest: f64,
    },
    /// The weight of the ridge is out of range.
    #[error("the ridge must be a positive number, but is {0}; 1e-10 suits most data")]
    Ridge(f64),
    /// A recording of sliding in one direction stops or turns.
    #[error(
        "the velocity stops or turns at sample {index}, but the frictional lag needs sliding in one direction; cut the recording there, or raise the bias of the motion"
    )]
    Reversal {
        /// The first sample without motion in the first direction.
        index: usize,
    },
    /// A micro-damping cannot be computed from these numbers.
    #[error(
        "{what} is {value}, but must be positive for a micro-damping 2 zeta sqrt(J k) - f_v (the viscous friction zero or more); check the earlier stages, or choose a larger damping ratio"
    )]
    NotAnOscillator {
        /// What is out of range.
        what: &'static str,
        /// What came.
        value: f64,
    },
    /// Time stands still or runs backwards.
    #[error(
        "time does not increase at sample {index} ({time} s); sort the samples by time and delete repeated ones"
    )]
    TimeOrder {
        /// The sample, counted from zero.
        index: usize,
        /// Its time \[s\].
        time: f64,
    },
    /// The step of the encoder is not a positive number.
    #[error("one count of the encoder must be a positive angle, but is {0} rad")]
    Resolution(f64),
    /// A servo log's header holds what no servo has.
    #[error(
        "the {what} of a servo log must be a positive number that a servo can have, but is {value}; mend the log's header"
    )]
    ServoHeader {
        /// Which entry.
        what: &'static str,
        /// What came.
        value: f64,
    },
    /// The number of elements is out of range.
    #[error("the number of elements must lie between 1 and 16, but is {0}")]
    ElementCount(usize),
    /// No log at all.
    #[error("there is no servo log to fit: every log is held out; give at least one that is not")]
    NoLogs,
    /// The nonlinear solver stopped without a result.
    #[error("the least squares solver gave up: {0}; check the points for outliers")]
    NoConvergence(String),
}

impl From<ModelError> for IdentError {
    /// What a model says to fitted parameters.
    fn from(error: ModelError) -> Self {
        match error {
            ModelError::OutOfRange { model, parameter, value, expected, .. } => {
                Self::NotAModel { model, parameter, value, expected }
            }
            other => Self::NoConvergence(other.to_string()),
        }
    }
}

/// Rounded to a thousandth: a rate that comes from a step is not even.
fn thousandths(value: f64) -> f64 {
    (1e3 * value).round() / 1e3
}

fn join(terms: &[AxisTerm]) -> String {
    let names: Vec<_> = terms.iter().map(|term| term.describe()).collect();
    match names.split_last() {
        Some((last, rest)) if !rest.is_empty() => format!("{} and {last}", rest.join(", ")),
        _ => names.concat(),
    }
}

fn excite(terms: &[AxisTerm]) -> &'static str {
    if terms.contains(&AxisTerm::Inertia) {
        "the axis never accelerates; record a motion that speeds up and slows down, or leave the inertia out"
    } else if terms.iter().any(|term| term.direction().is_some()) {
        "the axis must move in both directions; record a motion that reverses"
    } else if terms.contains(&AxisTerm::Offset) && !terms.contains(&AxisTerm::Viscous) {
        "the axis moves in one direction only; record a motion that reverses, or leave the offset out"
    } else {
        "the axis must move at several speeds in both directions; record such a motion"
    }
}
