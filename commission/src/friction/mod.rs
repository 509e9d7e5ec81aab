//! Friction: the curve over velocity, in volts, by blocks of constant velocity.
//!
//! A block follows one speed forwards and back with the position loop. The mean voltage of a window
//! less what acts one way only is `u = f_c + (f_s - f_c) exp(-(v/v_s)^2) + v/K`: all forces but
//! friction and back-EMF are left out by taking half the difference of both directions. After each
//! block the curve is fitted anew, and [`choice`] says which speed would tell most.

mod block;
mod choice;
mod curve;
mod drift;
mod menu;
mod rivals;
mod spread;
mod trail;
pub mod wanted;

use controller::PlantInverse;
use controller::design::LinearDrive;
use serde::{Deserialize, Serialize};

pub use block::{Blocks, Measured, Point};
pub use curve::Curve;
pub use trail::Trail;
pub(crate) use trail::{PARTS, Part};

pub(crate) use menu::between;

use self::menu::{MENU, by_limits, menu, narrowed, rarest, varied};

use crate::axis::{Axis, Known};
use crate::board::{Board, Fitted};
use crate::drive::Drive;
use crate::friction::wanted::Wanted;
use crate::loop_design::{LoopDesign, Plant, STEADY, design};
use crate::meet::Met;
use crate::reach::Reach;
use crate::{CommissionError, Stage};

/// Blocks that the next stage holds back.
pub const HELD_BACK: usize = 4;
/// Blocks with which it begins, spread over the menu; the fastest first, which any shaft follows,
/// and then to and fro, so that what warms up meanwhile is not taken for something of the speed.
const FIRST: [usize; 8] = [11, 4, 9, 2, 7, 1, 5, 0];
/// Largest scatter of the speed over its mean in a block that counts.
const UNEVEN: f64 = 0.2;
/// Share of the fastest speed below which such a scatter is from a speed that is too slow.
const SLOW: f64 = 0.1;
/// Blocks without steady motion that are tried, in all.
const FAILED: usize = 12;
/// Blocks after which what is wanted may be met, and a dip that is not seen is believed not to be
/// there.
const ENOUGH: usize = 16;
/// Predicted shrinking of the worst interval below which another block does not help.
const WORTH: f64 = 0.01;
/// Share of the speed limit that the mean speed is on the way to where a block begins.
const HOMEWARD: f64 = 0.2;
/// Share of the breakaway voltage that is fed forward in motion.
const KINETIC: f64 = 0.8;

/// Why the stage ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Ending {
    /// Every wanted interval is met.
    Met,
    /// No dip is clear of the noise, so that f_s and v_s have no meaning; all else is met.
    NoDip,
    /// Another block would narrow the worst interval by less than 1 %.
    NothingToGain,
    /// The rig time that the later stages leave is used up.
    OutOfTime,
}

/// What was found.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Friction {
    /// The curve.
    pub curve: Curve,
    /// Why it ended.
    pub ending: Ending,
    /// Speeds of the blocks, in their order [rad/s].
    pub blocks: Vec<f64>,
    /// What was measured, as it would be at the end of the stage.
    pub points: Vec<Point>,
    /// What the blocks said of their places.
    #[serde(default)]
    pub trails: Vec<Trail>,
    /// Relative change of the friction during the stage; none where none is clear.
    pub change: Option<f64>,
    /// The slowest and the fastest speed that the shaft follows steadily [rad/s].
    pub speeds: (f64, f64),
    /// The fastest speed that the limits allow, where the ends of the travel kept the blocks slower
    /// [rad/s].
    #[serde(default)]
    pub kept_from: Option<f64>,
    /// The loop that followed the speeds.
    pub followed_by: LoopDesign,
}

/// What is kept while the stage goes on.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Underway {
    /// Speeds of the blocks so far [rad/s].
    pub blocks: Vec<f64>,
    /// What they measured.
    pub points: Vec<Point>,
    /// What they said of their places.
    #[serde(default)]
    pub trails: Vec<Trail>,
    /// Speeds that the shaft did not follow steadily [rad/s].
    #[serde(default)]
    pub failed: Vec<f64>,
}

/// The plant that the loop of the stage is designed for.
#[must_use]
pub fn plant(known: &Known, drive: &Drive) -> Plant {
    Plant {
        drive: LinearDrive { gain: drive.gain.value, time_constant: drive.time_constant.value },
        delay: drive.delay.value.max(0.0),
        period: known.period,
        encoder_step: drive.encoder_step,
        voltage_limit: known.voltage,
    }
}

/// How blocks are measured with that loop.
#[must_use]
pub fn blocks(
    known: &Known,
    (met, drive): (&Met, &Drive),
    design: &LoopDesign,
    reach: Option<Reach>,
) -> Blocks {
    let plant = plant(known, drive);
    let mut controller = design.controller(&plant);
    controller.inverse = PlantInverse::Whole(plant.drive);
    controller.compensation.enabled = true;
    controller.compensation.volts_per_newton_metre = 1.0;
    controller.guard = None;
    Blocks {
        controller,
        natural_frequency: design.natural_frequency,
        friction: KINETIC * met.deadband,
        inertia: plant.drive.time_constant / plant.drive.gain,
        gain: plant.drive.gain,
        delay: plant.delay,
        encoder_step: plant.encoder_step,
        reach,
        homeward: HOMEWARD * known.velocity,
    }
}

/// Does the stage from what is underway on; `keep` is told after each block. `later` seconds are
/// left for the stages behind it.
///
/// # Errors
/// [`CommissionError`] if the rig refuses, the time does not do for the first blocks, or the points
/// are no friction.
pub fn friction(
    axis: &mut Axis<'_>,
    (known, met, drive): (&Known, &Met, &Drive),
    wanted: &Wanted,
    later: f64,
    mut underway: Underway,
    mut keep: impl FnMut(&Underway, f64) -> Result<(), CommissionError>,
) -> Result<Friction, CommissionError> {
    let plant = plant(known, drive);
    let followed_by = design(&plant, STEADY, Stage::Friction)?;
    let measured = blocks(known, (met, drive), &followed_by, axis.reach());
    let whole = menu(known, met, drive, &measured)?;
    let able = by_limits(known, met, drive);
    let kept_from = (measured.fastest() < able).then_some(able);
    let able = kept_from.unwrap_or_default();
    let later = later + HELD_BACK as f64 * measured.seconds(whole[MENU / 3]);
    let bench = axis.bench()?;
    let mut curve = None;
    let ending = loop {
        let menu = narrowed(&whole, &underway);
        let next = match FIRST.get(underway.points.len()) {
            Some(&first) => menu[first],
            None => {
                let fitted = fitted(&underway.points, able)?;
                let choice = choice::next(&fitted, &underway.points, wanted, &menu);
                // So many that each speed is there more than once, or near another.
                let done = wanted.missing(&fitted).is_empty() && underway.points.len() >= ENOUGH;
                curve = Some(fitted);
                if done {
                    break Ending::Met;
                }
                let all_else = || wanted.without_dip().missing(&fitted).is_empty();
                if !fitted.dips && underway.blocks.len() >= ENOUGH && all_else() {
                    break Ending::NoDip;
                }
                if choice.gain < WORTH && underway.points.len() >= ENOUGH {
                    break Ending::NothingToGain;
                }
                if axis.left() < later + measured.seconds(menu[0]) {
                    break Ending::OutOfTime;
                }
                // Every other block is where the fewest are: what is wrong with the curve shows there.
                if underway.blocks.len() % 2 == 1 {
                    rarest(&menu, &underway.points)
                } else {
                    choice.velocity
                }
            }
        };
        show(axis.board(), underway.blocks.len(), &underway.points, curve.as_ref());
        axis.say(Stage::Friction, &said(underway.blocks.len() + 1, next, curve.as_ref()));
        let next = varied(next, underway.blocks.len());
        match measured.measure(axis, &bench, Stage::Friction, next)? {
            Some((point, trail)) => {
                if point.uneven > UNEVEN && point.velocity < SLOW * whole[MENU - 1] {
                    underway.failed.push(next);
                }
                // What is uneven says nothing of its places either.
                underway.trails.extend(trail.filter(|_| point.uneven <= UNEVEN));
                underway.points.push(point);
            }
            None => underway.failed.push(next),
        }
        underway.blocks.push(next);
        if underway.failed.len() > FAILED && underway.points.len() < FIRST.len() {
            return Err(unsteady(&underway));
        }
        keep(&underway, axis.used())?;
    };
    let curve = match curve {
        Some(curve) => curve,
        None => fitted(&underway.points, able)?,
    };
    let menu = narrowed(&whole, &underway);
    let Underway { blocks, points, trails, .. } = underway;
    let drift::Drift { points, change } = drift::now(&even(&points));
    let curve = rivals::reaching(curve, &points, able);
    let ending = match ending {
        // What fits as well was not looked at before.
        Ending::Met | Ending::NoDip if !is_known(&curve, wanted) => Ending::NothingToGain,
        ending => ending,
    };
    let speeds = (menu[0], menu[MENU - 1]);
    Ok(Friction { curve, ending, blocks, points, trails, change, speeds, kept_from, followed_by })
}

/// Shows what was measured until now to whoever watches.
fn show(board: &Board, blocks: usize, points: &[Point], curve: Option<&Curve>) {
    let points = points.iter().map(|point| (point.velocity, point.volts)).collect();
    let fitted = |curve: &Curve| {
        let &Curve { f_s, f_c, v_s, slope, dips, .. } = curve;
        Fitted { f_s, f_c, v_s, slope, dips }
    };
    board.measured(blocks, points, curve.map(fitted));
}

/// Whether what is wanted of the curve is known.
fn is_known(curve: &Curve, wanted: &Wanted) -> bool {
    let wanted = if curve.dips { wanted.clone() } else { wanted.without_dip() };
    wanted.missing(curve).is_empty()
}

impl Friction {
    /// Shows it to whoever watches.
    pub(crate) fn show(&self, board: &Board) {
        show(board, self.blocks.len(), &self.points, Some(&self.curve));
    }

    /// Mean speed of the blocks [rad/s].
    #[must_use]
    pub fn mean_speed(&self) -> f64 {
        let sum = self.points.iter().map(|point| point.velocity).sum::<f64>();
        sum / self.points.len().max(1) as f64
    }

    /// The straight line through what was measured, where no dip is believed.
    #[must_use]
    pub fn straight(&self) -> Option<Curve> {
        let line = spread::widened(Curve::straight(&self.points)?, &self.points, Curve::straight);
        Some(rivals::reaching(line, &self.points, self.kept_from.unwrap_or_default()))
    }
}

/// The curve of what was measured, as it is now, of a rig that can turn as fast as `able` [rad/s].
fn fitted(points: &[Point], able: f64) -> Result<Curve, CommissionError> {
    let points = drift::now(&even(points)).points;
    let curve = Curve::of(&points, able)?;
    let again = |points: &[Point]| {
        if curve.dips {
            Curve::of(points, able).ok().filter(|curve| curve.dips)
        } else {
            Curve::straight(points)
        }
    };
    Ok(spread::widened(curve, &points, again))
}

/// The curve of these points with the intervals that their scatter and the choice of their speeds
/// give, however narrow: what the converter's own gain is known to is not in them.
///
/// # Errors
/// As for [`Curve::of`].
pub fn scattered(points: &[Point]) -> Result<Curve, CommissionError> {
    let points = drift::now(&even(points)).points;
    let of = |points: &[Point]| Curve::known_to(points, 0.0, 0.0);
    let curve = of(&points)?;
    Ok(spread::widened(curve, &points, |points| of(points).ok().filter(|again| again.dips)))
}

/// The points at which the shaft turned evenly; all of them where these are too few.
fn even(points: &[Point]) -> Vec<Point> {
    let even: Vec<Point> = points.iter().filter(|point| point.uneven <= UNEVEN).copied().collect();
    if even.len() >= FIRST.len() { even } else { points.to_vec() }
}

/// The shaft follows no speed steadily.
fn unsteady(underway: &Underway) -> CommissionError {
    let fastest = underway.failed.iter().copied().fold(0.0, f64::max);
    CommissionError::Unusable {
        stage: Stage::Friction,
        why: format!(
            "of {} blocks only {} turned steadily, and at {fastest:.3} rad/s the shaft still stuck and slipped; a higher voltage limit allows faster ones, and `frictionlab identify-stiction` tells friction from sticking",
            underway.blocks.len(),
            underway.points.len()
        ),
    }
}

/// Block, speed, and how far the intervals are.
fn said(block: usize, velocity: f64, curve: Option<&Curve>) -> String {
    let so_far = curve.map_or_else(String::new, |curve| {
        let width = |ranged: crate::Ranged| {
            ranged.relative().map_or("open".to_owned(), |share| format!("{:.1} %", 100.0 * share))
        };
        format!(", f_c ±{} v_s ±{}", width(curve.f_c), width(curve.v_s))
    });
    format!("block {block}, {velocity:.2} rad/s{so_far}")
}
