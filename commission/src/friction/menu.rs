//! The speeds that blocks may have: what encoder, limits and heat allow, less what the shaft did not
//! follow.

use super::block::WINDOW;
use super::{Blocks, Point, Underway};
use crate::axis::Known;
use crate::drive::Drive;
use crate::meet::Met;
use crate::{CommissionError, Stage};

/// Speeds of the menu.
pub const MENU: usize = 12;
/// The fastest speed over the slowest, at most.
const SPAN: f64 = 500.0;
/// The same where the encoder is coarse.
const NARROW: f64 = 10.0;
/// A speed that the shaft did not follow steadily is given up, and all up to this many times
/// slower or faster.
const GIVEN_UP: f64 = 1.2;
/// The slowest speed over the fastest, at most.
const NARROWEST: f64 = 0.7;
/// Speeds are varied by this share, so that what is wrong at one speed by chance is not repeated.
const VARIED: f64 = 0.1;
/// Counts that the slowest speed makes in a window: at best, and at least.
const COUNTS: f64 = 8.0;
const FEW: f64 = 3.0;
/// Share of the voltage limit that the fastest speed needs.
const SHARE: f64 = 0.6;
/// The same above friction, at least.
const LEAST: f64 = 0.1;
/// Share of what the winding bears for ever that a steady speed may take.
const HOT: f64 = 0.9;
/// Share of the speed limit that the fastest speed is.
const SPEED_SHARE: f64 = 0.4;

/// Speeds that may be measured, slowest first [rad/s].
///
/// # Errors
/// [`CommissionError::Unusable`] where the encoder is too coarse for the speeds that the voltage
/// allows.
pub(super) fn menu(
    known: &Known,
    met: &Met,
    drive: &Drive,
    blocks: &Blocks,
) -> Result<Vec<f64>, CommissionError> {
    let counts = |counts: f64| counts * drive.encoder_step / WINDOW;
    let by_travel = blocks.fastest();
    let fastest = by_limits(known, met, drive).min(by_travel);
    let slowest = counts(COUNTS).min(fastest / NARROW).max(counts(FEW)).max(fastest / SPAN);
    if fastest < 4.0 * slowest && fastest == by_travel {
        return Err(CommissionError::Unusable {
            stage: Stage::Friction,
            why: format!(
                "the encoder shows speeds from {slowest:.3} rad/s on, and the travel ends at {fastest:.3} rad/s: too little between; a travel {:.1} times as long, or a finer encoder, helps",
                4.0 * slowest / fastest
            ),
        });
    }
    if fastest < 4.0 * slowest {
        return Err(CommissionError::Unusable {
            stage: Stage::Friction,
            why: format!(
                "the encoder shows speeds from {slowest:.3} rad/s on, and voltage and speed limits end at {fastest:.3} rad/s: too little between; a finer encoder or higher limits help"
            ),
        });
    }
    Ok(between(slowest, fastest))
}

/// The fastest speed that voltage, heat and the speed limit allow, whatever the travel [rad/s].
pub(super) fn by_limits(known: &Known, met: &Met, drive: &Drive) -> f64 {
    let by_voltage =
        (SHARE * known.voltage - met.deadband).max(LEAST * known.voltage) * drive.gain.value;
    // What a steady speed heats is what of its voltage is no back-EMF.
    let heats = 1.0 / drive.gain.value - known.winding.map_or(0.0, |motor| motor.back_emf);
    let by_heat = (HOT * known.continuous() - met.deadband) / heats.max(f64::MIN_POSITIVE);
    let by_heat = by_heat.max(LEAST * by_voltage);
    by_voltage.min(SPEED_SHARE * known.velocity).min(by_heat)
}

/// Speeds from the slowest to the fastest, evenly in the logarithm.
pub(crate) fn between(slowest: f64, fastest: f64) -> Vec<f64> {
    let ratio = fastest / slowest;
    (0..MENU).map(|i| slowest * ratio.powf(i as f64 / (MENU - 1) as f64)).collect()
}

/// The menu without the speeds that the shaft did not follow: one that failed below another that
/// did not was too slow, any other too fast.
pub(super) fn narrowed(menu: &[f64], underway: &Underway) -> Vec<f64> {
    let (mut slowest, mut fastest) = (menu[0], menu[MENU - 1]);
    for &failed in &underway.failed {
        if underway.points.iter().any(|point| point.velocity > failed) {
            slowest = slowest.max(GIVEN_UP * failed);
        } else {
            fastest = fastest.min(failed / GIVEN_UP);
        }
    }
    between(slowest.min(NARROWEST * fastest), fastest)
}

/// The speed of the menu near which there are the fewest points.
pub(super) fn rarest(menu: &[f64], points: &[Point]) -> f64 {
    let ratio = (menu[1] / menu[0]).sqrt();
    let near = |velocity: f64| {
        let close = |point: &&Point| (velocity / ratio..velocity * ratio).contains(&point.velocity);
        points.iter().filter(close).count()
    };
    menu.iter().copied().min_by_key(|velocity| near(*velocity)).unwrap_or(menu[0])
}

/// A speed of the menu, a little off: never the same twice.
pub(super) fn varied(velocity: f64, block: usize) -> f64 {
    const GOLDEN: f64 = 0.618_033_988_749_895;
    velocity * (1.0 + VARIED * (block as f64 * GOLDEN).fract())
}
