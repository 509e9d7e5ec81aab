//! Which structures are worth comparing: a search that grows the model by one part after the other.
//!
//! A list made beforehand has either too many structures to fit or not the one that a machine needs:
//! seven parts make 128. The search begins with the simplest structure and looks at all that differ
//! from the best one so far by one part, more or less (stepwise selection; Efroymson 1960), judged
//! by the cross-validation and not by the fit. It ends where none of them predicts better.

use super::{AxisStructure, CrossValidation};

/// What a part must gain for the search to go on from a structure that has it, as a share of the
/// error: smaller ones are the luck of the blocks.
const WORTH: f64 = 0.99;

/// The structures to compare next, after those in `scores` and those that were `refused`; none when
/// the search is at its end. `possible` says which structures the recording can show.
///
/// ```
/// use friction_ident::axis_structure::{AxisStructure, growth};
///
/// let first = growth::next(&[], &[], |_| true);
/// assert_eq!(first, [AxisStructure::SYMMETRIC]);
/// ```
pub fn next(
    scores: &[CrossValidation],
    refused: &[AxisStructure],
    possible: impl Fn(&AxisStructure) -> bool,
) -> Vec<AxisStructure> {
    let best = scores.iter().min_by(|a, b| a.relative_error.total_cmp(&b.relative_error));
    let Some(best) = best else {
        let first = AxisStructure::SYMMETRIC;
        return if refused.contains(&first) { vec![] } else { vec![first] };
    };
    let before = scores
        .iter()
        .filter(|score| score.structure.parameters() < best.structure.parameters())
        .map(|score| score.relative_error)
        .reduce(f64::min);
    if before.is_some_and(|before| best.relative_error > WORTH * before) {
        return vec![];
    }
    let known = |structure: &AxisStructure| {
        refused.contains(structure) || scores.iter().any(|score| score.structure == *structure)
    };
    let mut near = best.structure.neighbours();
    near.retain(|structure| !known(structure) && possible(structure));
    near
}

#[cfg(test)]
mod tests {
    use super::*;

    fn score(structure: AxisStructure, relative_error: f64) -> CrossValidation {
        let blocks = vec![relative_error; 4];
        CrossValidation { structure, blocks, force_power: 1.0, relative_error, standard_error: 0.1 }
    }

    /// Of each part what it takes off the error; two of them only together.
    fn error(structure: &AxisStructure) -> f64 {
        let gain = |has: bool, gain: f64| if has { gain } else { 0.0 };
        10.0 - gain(structure.gravity, 5.0)
            - gain(structure.delay, 0.05)
            - gain(structure.presliding, 1.0)
            - gain(structure.presliding && structure.stribeck, 1.0)
    }

    #[test]
    fn it_finds_the_parts_that_help_and_tries_far_fewer_than_there_are() {
        let mut scores = Vec::new();
        loop {
            let wanted = next(&scores, &[], |_| true);
            if wanted.is_empty() {
                break;
            }
            scores.extend(wanted.iter().map(|structure| score(*structure, error(structure))));
        }
        let best = scores.iter().min_by(|a, b| a.relative_error.total_cmp(&b.relative_error));
        let found = best.unwrap().structure;
        assert!(found.gravity && found.presliding && found.stribeck, "{found}");
        assert!(!found.position && !found.harmonic && !found.asymmetric, "{found}");
        assert!(scores.len() < 40, "{}", scores.len());
    }

    #[test]
    fn what_cannot_be_shown_or_was_refused_is_not_asked_for() {
        let first = [score(AxisStructure::SYMMETRIC, 10.0)];
        let all = next(&first, &[], |_| true);
        let without = next(&first, &all[..1], |structure| !structure.needs_position());
        assert!(!without.contains(&all[0]));
        assert!(!without.is_empty() && without.iter().all(|structure| !structure.needs_position()));
        assert_eq!(next(&[], &[AxisStructure::SYMMETRIC], |_| true), []);
    }
}
