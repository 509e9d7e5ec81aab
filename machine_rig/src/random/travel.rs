//! Ends of the travel, drawn by a generator of their own: whatever else a seed draws stays.

use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;
use rig_driver::safety::{RigLimits, Travel};

use super::Draw;
use crate::{Machine, Stops};

/// Share of the machines that have ends.
const SHARE: f64 = 0.2;
/// What the user leaves between an end and the travel that is allowed, as a share of it all.
const GAP: f64 = 0.03;

/// The machine, of which some have ends; its user knows where they are.
pub(super) fn limited(machine: Machine) -> Machine {
    let seed = machine.seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ 0x57_0b5;
    let mut draw = Draw(Pcg64Mcg::seed_from_u64(seed));
    if draw.is(SHARE) { ended(&mut draw, machine) } else { machine }
}

fn ended(draw: &mut Draw, machine: Machine) -> Machine {
    let (width, place) = (draw.decades(1.5, 15.0), draw.even(0.25, 0.75));
    let stops = Stops { low: -place * width, high: (1.0 - place) * width };
    let gap = GAP * width;
    // As the encoder tells it, with its mistakes.
    let reversed =
        machine.wiring.iter().flat_map(|wiring| wiring.split(',')).any(|m| m == "encoder");
    let told = if reversed { -machine.position_scale } else { machine.position_scale };
    let (a, b) = (told * (stops.low + gap), told * (stops.high - gap));
    let travel =
        Travel { min: a.min(b), max: a.max(b), margin: 0.9 * gap * machine.position_scale };
    let limits = RigLimits { travel: Some(travel), ..machine.limits };
    Machine { stops: Some(stops), limits, ..machine }
}
