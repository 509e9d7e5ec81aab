//! Which forces beside friction recordings show.
//!
//! All of them are linear, so that asking costs next to nothing beside a fit. Friction itself is
//! stood for by columns that bend to any of its shapes: the direction of motion, the velocity, two
//! dips, and hysteresis of four reaches (Dahl's operator, which depends on nothing but the travel).
//! The recordings are cut into contiguous blocks, and each is predicted by the fit to the others.

use serde::Serialize;

use super::FrictionData;
use super::load_rows::{BLOCKS, Rows};
use crate::position_load::{LoadShape, PositionLoad};
use crate::rigid_axis::Load;
use crate::statistics::Sample;

/// What the comparison says.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PositionLoadChoice {
    /// What to estimate beside friction.
    pub chosen: LoadShape,
    /// What was compared, each with the share of the force that a fit to the other blocks does not
    /// predict: `100 |error| / |force|` \[%\]. Empty where there is too little to compare anything.
    pub compared: Vec<(LoadShape, f64)>,
}

/// Share of the mean square error that a force of the position must take away.
const WORTH: f64 = 0.1;
/// The same of a constant force, which nothing else goes with.
const OFFSET_WORTH: f64 = 0.01;
/// Standard errors that a gain must be clear of zero by, or how likely chance may be to give it.
const CLEAR: f64 = 2.0;
const CHANCE: f64 = 1.0 / 32.0;
/// How likely chance may be to give a gain of one load over a simpler one: that of one standard error.
const BETTER: f64 = 0.16;
/// Reaches of a contact that bends along much of the travel, as shares of the longest.
const LONG: [f64; 6] = [0.05, 0.1, 0.15, 0.2, 0.3, 0.5];

/// Chooses what is estimated beside friction. A constant force is used where it takes away a
/// hundredth of the mean square error, a force of the position where it takes away a tenth of what
/// a constant one leaves, each clear of chance by two standard errors over the blocks or by the signs
/// of what they gain; of two that are within one standard error the simpler. A contact that bends
/// along much of the travel looks like a spring: where hysteresis of one long reach predicts as well,
/// there is no force of the position. `asymmetric` models have no constant force beside them: they
/// have it in their two directions. Nor has an axis that goes one way only. Gravity is offered to an
/// axis that turns.
pub fn choose_position_load(
    data: &FrictionData,
    rotary: bool,
    asymmetric: bool,
) -> PositionLoadChoice {
    let nothing = PositionLoadChoice { chosen: LoadShape::NONE, compared: Vec::new() };
    let rows = Rows::new(data, asymmetric, None);
    let offset = !asymmetric && rows.both_ways;
    let plain = LoadShape { offset, position: Load::None };
    let mut compared = Vec::new();
    let mut errors = |shape: LoadShape| {
        let errors = rows.errors(shape)?;
        compared.push((shape, 100.0 * (sum(&errors) / rows.power).sqrt()));
        Some(errors)
    };
    let Some(without) = errors(LoadShape::NONE) else { return nothing };
    let with_offset = if offset { errors(plain) } else { Some(without.clone()) };
    let Some(with_offset) = with_offset else { return nothing };
    let mut chosen =
        if clear(&without, &with_offset, OFFSET_WORTH) { plain } else { LoadShape::NONE };
    let mut best: Option<Vec<f64>> = None;
    let positions: &[Load] = match (rows.has_places, rotary) {
        (false, _) => &[],
        (true, true) => &[Load::Spring, Load::Gravity],
        (true, false) => &[Load::Spring],
    };
    for &position in positions {
        let shape = LoadShape { position, ..plain };
        let Some(with) = errors(shape) else { continue };
        let worth = clear(&with_offset, &with, WORTH);
        // Simple ones come first: a later one must be better by more than its standard error.
        if worth && best.as_ref().is_none_or(|best| better(best, &with)) {
            (chosen, best) = (shape, Some(with));
        }
    }
    if let Some(with) = best {
        let bends = |reach: f64| {
            let rows = Rows::new(data, asymmetric, Some(reach));
            let without = rows.errors(LoadShape::NONE)?;
            let with_offset = if offset { rows.errors(plain)? } else { without.clone() };
            let shape =
                if clear(&without, &with_offset, OFFSET_WORTH) { plain } else { LoadShape::NONE };
            Some((shape, if shape == plain { with_offset } else { without }))
        };
        let contact = LONG.into_iter().filter_map(bends);
        let contact = contact.min_by(|(_, a), (_, b)| sum(a).total_cmp(&sum(b)));
        if let Some((shape, _)) = contact.filter(|(_, contact)| !better(contact, &with)) {
            chosen = shape;
        }
    }
    PositionLoadChoice { chosen, compared }
}

/// Values to begin with, beside the columns that stand for friction.
pub(super) fn first_values(
    data: &FrictionData,
    shape: LoadShape,
    asymmetric: bool,
) -> PositionLoad {
    let terms = shape.terms();
    let rows = Rows::new(data, asymmetric, None);
    if terms.is_empty() || rows.force.is_empty() {
        return PositionLoad::default();
    }
    let normal = rows.normal(&terms, |_| true);
    let values = normal.solve().unwrap_or_default();
    PositionLoad::of(&terms, values.get(rows.columns..).unwrap_or_default())
}

fn sum(blocks: &[f64]) -> f64 {
    blocks.iter().sum()
}

/// What `with` errs less than `without` over all blocks, and the standard error of that.
fn gain(without: &[f64], with: &[f64]) -> (f64, f64) {
    let sample = Sample::of(without.iter().zip(with).map(|(a, b)| a - b));
    let blocks = sample.count as f64;
    (blocks * sample.mean, (blocks * sample.variance()).sqrt())
}

fn clear(without: &[f64], with: &[f64], worth: f64) -> bool {
    let (gain, error) = gain(without, with);
    let clear = gain > CLEAR * error || chance(without, with) <= CHANCE;
    clear && gain > worth * sum(without)
}

/// Whether `with` predicts better than `without` by more than one standard error, or by signs.
fn better(without: &[f64], with: &[f64]) -> bool {
    let (gain, error) = gain(without, with);
    gain > error || chance(without, with) <= BETTER
}

/// How likely so much gain is where each block might as well have lost what it gains: Fisher's test
/// of all signs. A load that pulls where the axis goes far gains most of all in few blocks, which a
/// standard error takes for chance.
fn chance(without: &[f64], with: &[f64]) -> f64 {
    let gains: Vec<f64> = without.iter().zip(with).map(|(a, b)| a - b).collect();
    let found = sum(&gains) * (1.0 - 1e-9);
    let signed = |signs: u32| {
        let gain = |(k, gain): (usize, &f64)| if signs >> k & 1 == 0 { *gain } else { -gain };
        gains.iter().enumerate().map(gain).sum::<f64>()
    };
    let all = 1u32 << gains.len().min(BLOCKS);
    let many = (0..all).filter(|&signs| signed(signs) >= found).count();
    many as f64 / f64::from(all)
}
