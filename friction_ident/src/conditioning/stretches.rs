//! A recording with gaps: each stretch for itself.

use super::conditioned::{Conditioned, Piece, THINNING_PADDING};
use super::filter::{Signals, condition};
use super::settings::Conditioning;
use crate::IdentError;

/// Conditions each stretch of a recording for itself and puts them one behind the other. Each comes
/// with the time of its first sample \[s\]; all have one sampling period. Stretches too short for
/// the filters are left out, which [`Conditioned::stretches`] tells.
///
/// # Errors
/// Those of [`condition`] for the longest stretch, and [`IdentError::TimeStep`] where the sampling
/// periods differ.
pub fn condition_stretches(
    stretches: &[(f64, Signals)],
    how: &Conditioning,
) -> Result<Conditioned, IdentError> {
    let longest =
        (0..stretches.len()).max_by_key(|&i| (stretches[i].1.force.len(), stretches.len() - i));
    let Some(longest) = longest else { return Err(IdentError::NoMotion) };
    let dt = stretches[longest].1.time_step;
    if let Some((_, other)) = stretches.iter().find(|(_, signals)| signals.time_step != dt) {
        return Err(IdentError::TimeStep(other.time_step));
    }
    let thinning = if how.decimate > 1 { THINNING_PADDING } else { 0 };
    let mut found: Option<Conditioned> = None;
    for (i, (start, signals)) in stretches.iter().enumerate() {
        let mut one = match condition(signals, how) {
            Err(IdentError::TooFewSamples { .. }) if i != longest => continue,
            other => other?,
        };
        if i != longest && one.force.len() <= thinning {
            continue;
        }
        let (before, begin) =
            found.as_ref().map_or((0, 0), |all| (all.force.len(), all.lived.len()));
        let kept = before..before + one.force.len();
        let origin = begin + one.first..begin + one.first + kept.len();
        let way = one.pieces.first().map_or(0.0, |piece| piece.way);
        let piece = Piece { stretch: i, kept, origin, begin, way, start: *start };
        let Some(all) = &mut found else {
            one.pieces = vec![piece];
            found = Some(one);
            continue;
        };
        all.pieces.push(piece);
        if let (Some(all), Some(one)) = (&mut all.position, &one.position) {
            all.extend_from_slice(one);
        }
        all.velocity.extend_from_slice(&one.velocity);
        all.acceleration.extend_from_slice(&one.acceleration);
        all.force.extend_from_slice(&one.force);
        all.lived.extend_from_slice(&one.lived);
        all.sticks.extend_from_slice(&one.sticks);
        all.step = all.step.max(one.step);
        all.velocity_floor = all.velocity_floor.max(one.velocity_floor);
        all.acceleration_floor = all.acceleration_floor.max(one.acceleration_floor);
    }
    found.ok_or(IdentError::NoMotion)
}
