//! Drive: gain, time constant and delay, from voltage and encoder alone.
//!
//! The shaft turns one way under a steady voltage with tones on it, and then the other way. Each
//! direction is cut into stretches, each of which is fitted by itself: the intervals come from how
//! the stretches differ, and hold whatever colour the residual of one has.

mod output_error;
mod strokes;

use std::ops::Range;

use report::numbers::significant;
use rig_driver::Measurement;
use serde::{Deserialize, Serialize};

use self::output_error::{Fit, fit};
use crate::axis::{Axis, Bench, Known};
use crate::meet::Met;
use crate::{CommissionError, Ranged, Stage};

/// Length of the excitation \[s\].
const SECONDS: f64 = 20.0;
/// No gain is known better than this share of it: the converter's own is not.
const KNOWN: f64 = 1e-3;
/// Stretches in each direction.
const PIECES: usize = 4;
/// What is missed in a stretch that counts, over what is usual.
const DISTURBED: f64 = 3.0;
/// A stretch whose gain is so many times that of the others was disturbed too.
const APART: f64 = 1.5;
/// Excitations in all, where the delay stays vague: its half interval is more than that \[s\], or that of
/// the time constant more than that share.
const ROUNDS: u32 = 3;
const VAGUE: (f64, f64) = (1.5e-3, 0.15);
/// Rig time that all later stages take at least \[s\]: no more is spent here where it is not left.
const LATER: f64 = 420.0;
/// The lowest voltage of a further excitation over friction in motion, and over that of before.
const ON: f64 = 1.3;
const LOWER: f64 = 0.5;
/// Time in which the shaft starts in a direction \[s\].
const START: f64 = 1.0;
/// Angular frequencies of the excitation [rad/s]; none is a multiple of another.
const TONES: [f64; 4] = [5.3, 19.7, 47.9, 83.3];
/// Share of the voltage limit that the excitation stays below.
const SHARE: f64 = 0.6;
/// The same above friction, at least, and the highest share.
const ABOVE: f64 = 0.25;
const HIGHEST: f64 = 0.9;
/// Attempts, and how much less of what is above friction each further one has.
const ATTEMPTS: u32 = 5;
const LESS: f64 = 0.6;
/// Share of the peak that is friction, at most.
const LOWEST: f64 = 0.7;
/// Share of what is above friction that the tones have.
const TONE: f64 = 0.45;
/// Share of the speed limit that the excitation stays below.
const SPEED_SHARE: f64 = 0.5;

/// What was found.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Drive {
    /// Gain K of the drive with its bearings [rad/(V s)].
    pub gain: Ranged,
    /// Time constant T with them \[s\].
    pub time_constant: Ranged,
    /// Delay from voltage to motion \[s\].
    pub delay: Ranged,
    /// Peak of the excitation \[V\].
    pub peak: f64,
    /// Root mean square of what the drive misses of the position, in the worst stretch \[rad\].
    pub missed: f64,
    /// Angle of one count \[rad\].
    pub encoder_step: f64,
}

/// A delay below this is none that a drive can have \[s\].
const EARLY: f64 = -2e-4;

impl Drive {
    /// Whether the drive seems to answer before it is asked, as one with a load behind a play does: its
    /// delay is not known then.
    #[must_use]
    pub fn seems_early(&self) -> bool {
        self.delay.high.is_some_and(|high| high < EARLY)
    }

    /// Whether time constant and delay are not well known, so that the loop would be slower than it can
    /// be, or less robust.
    fn is_vague(&self) -> bool {
        let half = |ranged: Ranged| Some(0.5 * (ranged.high? - ranged.low?));
        let late = half(self.delay).is_none_or(|half| half > VAGUE.0);
        let slow = self.time_constant.relative().is_none_or(|share| share > VAGUE.1);
        late || slow
    }

    /// The delay as people read it.
    #[must_use]
    pub fn delay_said(&self) -> String {
        if self.seems_early() {
            return format!(
                "not known: the drive seems to answer {} ms before it is asked, as one with a play does. The gains are made for none, and have less margin than is told where there is one",
                significant(-1e3 * self.delay.value, 2)
            );
        }
        self.delay.said("s")
    }
}

/// Does the stage, and says what of it cannot be.
///
/// # Errors
/// [`CommissionError`] if the rig refuses, or the recording says nothing of the drive.
pub fn drive(axis: &mut Axis<'_>, known: &Known, met: &Met) -> Result<Drive, CommissionError> {
    let found = excited(axis, known, met)?;
    if found.seems_early() {
        axis.tell(&format!("delay: {}", found.delay_said()));
    }
    Ok(found)
}

/// Does the stage.
///
/// # Errors
/// [`CommissionError`] if the rig refuses, or the recording says nothing of the drive.
fn excited(axis: &mut Axis<'_>, known: &Known, met: &Met) -> Result<Drive, CommissionError> {
    axis.say(Stage::Drive, "tones of voltage, forwards and back");
    let mut peak = peak(known, met);
    if let Some(reach) = axis.reach() {
        return strokes::drive(axis, met, reach, peak);
    }
    let mut low = met.deadband.min(LOWEST * peak);
    let bench = axis.bench()?;
    let mut heard: Vec<Fit> = Vec::new();
    let mut round = 1;
    loop {
        let (seen, driven) = tones_at(axis, &bench, low, peak)?;
        peak = driven;
        let pieces = pieces(seen.len() - 1, bench.period());
        heard.extend(fits(&seen, pieces, bench.period()));
        let found = evaluate(heard.clone(), encoder_step(&seen), peak);
        let vague = found.as_ref().map_or(true, Drive::is_vague);
        if !vague || round == ROUNDS || axis.left() < LATER {
            return found;
        }
        axis.say(Stage::Drive, "once more: the delay is not well known");
        // A shaft that turns needs no more than its friction to go on: the tones may be larger.
        let slow = heard.iter().map(|fit| fit.slow).fold(0.0, f64::max);
        low = low.min((ON * slow).max(LOWER * low));
        round += 1;
    }
}

/// The excitation between these voltages, less where the motor becomes too warm; and its peak.
fn tones_at(
    axis: &mut Axis<'_>,
    bench: &Bench,
    low: f64,
    mut peak: f64,
) -> Result<(Vec<Measurement>, f64), CommissionError> {
    let whole = (SECONDS / bench.period()) as usize;
    for _ in 0..ATTEMPTS {
        let seen = axis.excite(bench, Stage::Drive, SECONDS, |time| excitation(low, peak, time))?;
        // What became too warm was cut short: once it has cooled, less will do.
        if seen.len() >= whole {
            return Ok((seen, peak));
        }
        peak = low + LESS * (peak - low);
    }
    Err(CommissionError::Unusable {
        stage: Stage::Drive,
        why: "the motor becomes too warm by the model of the safety layer, even under little more than its friction; the thermal constants of the rig's parameters should be those of this motor".to_owned(),
    })
}

/// As much as limits of voltage and speed allow.
fn peak(known: &Known, met: &Met) -> f64 {
    let by_speed = met.deadband + SPEED_SHARE * known.velocity * met.slope;
    let usual = (SHARE * known.voltage).max(met.deadband + ABOVE * known.voltage);
    // Half of what tones and friction may heat together.
    let by_heat = met.deadband + known.continuous();
    usual.min(HIGHEST * known.voltage).min(by_speed).min(by_heat)
}

/// Tones on a steady voltage above what just moves the shaft, forwards and then backwards: it never
/// stands but once between, so that neither stiction nor the elastic part of friction are mistaken
/// for inertia.
fn excitation(low: f64, peak: f64, time: f64) -> f64 {
    let sign = if time < 0.5 * SECONDS { 1.0 } else { -1.0 };
    sign * (low + (peak - low) * (1.0 - TONE + TONE * tones(time)))
}

/// The mean of all tones, from -1 to 1.
fn tones(time: f64) -> f64 {
    let tones: f64 = TONES.iter().enumerate().map(|(i, w)| (w * time + i as f64).sin()).sum();
    tones / TONES.len() as f64
}

/// The fits of stretches of one recording.
fn fits(
    seen: &[Measurement],
    pieces: impl IntoIterator<Item = Range<usize>>,
    period: f64,
) -> Vec<Fit> {
    // A reading tells the voltage of the cycle before it.
    let voltage: Vec<f64> = seen.iter().skip(1).map(|seen| seen.voltage_applied).collect();
    let position: Vec<f64> = seen.iter().map(|seen| seen.encoder_position).collect();
    pieces.into_iter().filter_map(|piece| fit(&voltage, &position, piece, period)).collect()
}

fn evaluate(fits: Vec<Fit>, step: Option<f64>, peak: f64) -> Result<Drive, CommissionError> {
    let unusable =
        |why: &str| CommissionError::Unusable { stage: Stage::Drive, why: why.to_owned() };
    let encoder_step = step.ok_or_else(|| {
        unusable("the encoder did not move under the excitation; look at its plug")
    })?;
    // A stretch that is missed far more than the others was disturbed.
    let mut missed: Vec<f64> = fits.iter().map(|fit| fit.missed).collect();
    missed.sort_by(f64::total_cmp);
    let usual = missed.get(missed.len() / 2).copied().unwrap_or_default();
    let fits: Vec<Fit> = fits.into_iter().filter(|fit| fit.missed <= DISTURBED * usual).collect();
    let fits = alike(fits);
    let of = |value: fn(&Fit) -> f64| {
        let values: Vec<f64> = fits.iter().map(value).collect();
        Ranged::mean_of(&values)
    };
    let gain = of(|fit| fit.gain).map(|gain| gain.at_least(KNOWN));
    let all = (gain, of(|fit| fit.time_constant), of(|fit| fit.delay));
    let (Some(gain), Some(time_constant), Some(delay)) = all else {
        return Err(unusable(
            "the shaft does not follow the voltage as a motor does; `frictionlab rig check` looks at signs and sensors",
        ));
    };
    let missed = fits.iter().map(|fit| fit.missed).fold(0.0, f64::max);
    Ok(Drive { gain, time_constant, delay, peak, missed, encoder_step })
}

/// Stretches whose gain is that of most of them: no drive has two. All of them where most differ.
fn alike(fits: Vec<Fit>) -> Vec<Fit> {
    let mut gains: Vec<f64> = fits.iter().map(|fit| fit.gain).collect();
    gains.sort_by(f64::total_cmp);
    let Some(&usual) = gains.get(gains.len() / 2) else { return fits };
    let near = |fit: &&Fit| fit.gain < APART * usual && usual < APART * fit.gain;
    let kept: Vec<Fit> = fits.iter().filter(near).copied().collect();
    if 2 * kept.len() > fits.len() && kept.len() > 2 { kept } else { fits }
}

/// Stretches of one direction, each a measurement of its own: the first part of either direction is
/// left out, in which the shaft starts.
fn pieces(cycles: usize, period: f64) -> impl Iterator<Item = Range<usize>> {
    let at = move |seconds: f64| (seconds / period).round() as usize;
    let length = (0.5 * SECONDS - START) / PIECES as f64;
    let starts = [0.0, 0.5 * SECONDS]
        .into_iter()
        .flat_map(move |half| (0..PIECES).map(move |piece| half + START + piece as f64 * length));
    starts.map(move |start| at(start)..at(start + length) - 1).filter(move |p| p.end < cycles)
}

/// Angle of one count, from the farthest two readings.
fn encoder_step(seen: &[Measurement]) -> Option<f64> {
    let by_counts = |seen: &&Measurement| seen.encoder_counts;
    let (low, high) = (seen.iter().min_by_key(by_counts)?, seen.iter().max_by_key(by_counts)?);
    let counts = high.encoder_counts - low.encoder_counts;
    let step = ((high.encoder_position - low.encoder_position) / counts as f64).abs();
    (counts > 0 && step > 0.0 && step.is_finite()).then_some(step)
}
