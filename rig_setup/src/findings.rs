//! What the steps found, and what is to be thought of it.

use friction_ident::Uncertain;
use rig_driver::{Calibration, Sign};

/// One steady voltage.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Level {
    /// Voltage \[V\].
    pub volts: f64,
    /// Velocity by the encoder, with its sign put right [rad/s].
    pub velocity: f64,
    /// Mean of the tachometer as it reads [rad/s].
    pub tachometer: f64,
    /// Mean of the torque above its zero [N m].
    pub torque: f64,
}

/// Everything that was found.
#[derive(Debug, Clone, PartialEq)]
pub struct Findings {
    /// Sign of the encoder against the voltage.
    pub encoder_sign: Sign,
    /// True velocity over the tachometer's; none if the tachometer shows nothing of the motion.
    pub tachometer_gain: Option<Uncertain>,
    /// Tachometer at rest [rad/s].
    pub tachometer_zero: Uncertain,
    /// Root mean square distance of the tachometer from its line [rad/s].
    pub tachometer_residual: f64,
    /// Sign of the torque sensor; none if it shows nothing of the motion.
    pub torque_sign: Option<Sign>,
    /// Torque sensor at rest [N m].
    pub torque_zero: Uncertain,
    /// Lowest voltage that moves the shaft forwards \[V\].
    pub deadband_forward: Uncertain,
    /// Lowest magnitude that moves it backwards \[V\].
    pub deadband_backward: Uncertain,
    /// The steady voltages.
    pub levels: Vec<Level>,
}

/// One line of the judgement.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Verdict {
    /// What was looked at.
    pub what: &'static str,
    /// What was found, with its standard error.
    pub found: String,
    /// Nothing if it is right, else what is wrong and how to mend it.
    pub wrong: Option<String>,
}

/// A gain that is off by more than this share is wrong, if it is off by three standard errors too.
const GAIN_TOLERANCE: f64 = 0.02;
/// A tachometer's zero beyond this is wrong [rad/s], likewise.
const VELOCITY_TOLERANCE: f64 = 0.01;
/// A torque's zero beyond this is wrong [N m], likewise.
const TORQUE_TOLERANCE: f64 = 0.005;

impl Findings {
    /// Whether everything is reversed: then it is the motor's leads, most likely.
    #[must_use]
    pub fn motor_reversed(&self) -> bool {
        self.encoder_sign == Sign::Reversed
            && self.tachometer_gain.is_some_and(|gain| gain.value < 0.0)
    }

    /// The calibration that puts the readings right. A sensor that shows nothing of the motion is
    /// left as it is.
    #[must_use]
    pub fn calibration(&self) -> Calibration {
        Calibration {
            encoder_sign: self.encoder_sign,
            tachometer_gain: self.tachometer_gain.map_or(1.0, |gain| gain.value),
            tachometer_zero: self.tachometer_zero.value,
            torque_sign: self.torque_sign.unwrap_or_default(),
            torque_zero: self.torque_zero.value,
            deadband_forward: self.deadband_forward.value,
            deadband_backward: self.deadband_backward.value,
        }
    }

    /// The judgement, line by line.
    #[must_use]
    pub fn verdicts(&self) -> Vec<Verdict> {
        let verdict = |what, found, wrong: Option<String>| Verdict { what, found, wrong };
        let forward = |sign| if sign == Sign::Forward { "forward" } else { "reversed" }.to_owned();
        let off = |value: &Uncertain, expected: f64, tolerance: f64| {
            (value.value - expected).abs() > tolerance.max(3.0 * value.standard_error)
        };
        let calibrate = "`frictionlab rig calibrate` puts it right";
        let leads = self.motor_reversed().then(|| {
            format!("encoder and tachometer both turn against the voltage: the motor's leads are swapped, most likely; swap them, or {calibrate} in every sensor")
        });
        let gain = match &self.tachometer_gain {
            None => verdict(
                "tachometer gain",
                "none".to_owned(),
                Some(
                    "the tachometer does not show the motion: look at its plug and its channel"
                        .to_owned(),
                ),
            ),
            Some(gain) => verdict(
                "tachometer gain",
                plus_minus(gain, ""),
                if gain.value < 0.0 {
                    leads.clone().or_else(|| {
                        Some(format!("its leads are swapped; swap them, or {calibrate}"))
                    })
                } else {
                    off(gain, 1.0, GAIN_TOLERANCE).then(|| {
                        let reads = 100.0 / gain.value;
                        format!("it reads {reads:.1} % of the encoder's speed; {calibrate}")
                    })
                },
            ),
        };
        let torque = match self.torque_sign {
            None => verdict(
                "torque sign",
                "none".to_owned(),
                Some("the torque sensor does not show the friction of the motion: a rig without one is driven with --torque-source voltage".to_owned()),
            ),
            Some(sign) => verdict(
                "torque sign",
                forward(sign),
                (sign == Sign::Reversed)
                    .then(|| leads.clone().unwrap_or_else(|| format!("it shows a friction that drives; {calibrate}"))),
            ),
        };
        vec![
            verdict(
                "encoder sign",
                forward(self.encoder_sign),
                (self.encoder_sign == Sign::Reversed).then(|| {
                    leads.clone().unwrap_or_else(|| {
                        format!("its lines are swapped; swap them, or {calibrate}")
                    })
                }),
            ),
            gain,
            verdict(
                "tachometer zero",
                plus_minus(&self.tachometer_zero, "rad/s"),
                off(&self.tachometer_zero, 0.0, VELOCITY_TOLERANCE)
                    .then(|| format!("it shows speed at rest; {calibrate}")),
            ),
            torque,
            verdict(
                "torque zero",
                plus_minus(&self.torque_zero, "N m"),
                off(&self.torque_zero, 0.0, TORQUE_TOLERANCE)
                    .then(|| format!("it shows torque at rest; {calibrate}")),
            ),
            verdict("deadband forwards", plus_minus(&self.deadband_forward, "V"), None),
            verdict("deadband backwards", plus_minus(&self.deadband_backward, "V"), None),
        ]
    }
}

/// A number with its standard error and unit.
pub(super) fn plus_minus(value: &Uncertain, unit: &str) -> String {
    let Uncertain { value, standard_error } = value;
    // Two figures of the error.
    let digits = if *standard_error > 0.0 {
        (1.0 - standard_error.log10().floor()).clamp(0.0, 9.0) as usize
    } else {
        4
    };
    let unit = if unit.is_empty() { String::new() } else { format!(" {unit}") };
    format!("{value:.digits$} ± {standard_error:.digits$}{unit}")
}
