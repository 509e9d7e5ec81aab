//! Which of the structures that were cross-validated is the one to use.

use serde::Serialize;

use super::cross_validation::{CrossValidation, FirstSpeeds, sum_error};
use crate::statistics::student_95_of;

/// Share of the best error by which another may be larger and still count as alike.
pub(super) const ALIKE: f64 = 0.05;
/// The same share up to which fewer parameters are preferred: what is alike beyond it still has a
/// say in the intervals.
const PREFERRED: f64 = 0.025;
/// Share of the best error by which another may be larger though the difference is certain: what a
/// part takes off less than that is no reason for it.
const WORTHLESS: f64 = 0.001;
/// Share of the least error of the other structures that one whose friction rises over the first
/// speeds must stay below: what a real rise takes off is plain.
const RISEN: f64 = 0.75;
/// The same share of another recording, which then bears that structure out where both together are
/// predicted no worse: it predicts, whatever it is that rises.
const BORNE_OUT: f64 = 1.0 - ALIKE;

/// A structure against the best one.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Ranked {
    /// Its place in the list that was given.
    pub index: usize,
    /// Relative error less that of the best structure \[percentage points\].
    pub excess: f64,
    /// Standard error of the excess, from the differences block by block: what all structures find
    /// hard cancels.
    pub excess_error: f64,
    /// Whether it predicts as well as the best one: the excess is within chance, the best one's own
    /// standard error and a twentieth of its error.
    pub within: bool,
}

/// What the comparison says.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Choice {
    /// The structures from the best to the worst.
    pub ranking: Vec<Ranked>,
    /// Place in the given list of the best prediction.
    pub best: usize,
    /// Place in the given list of the structure to use.
    pub chosen: usize,
    /// Where that has friction that rises over the first speeds, the place of the best one without:
    /// what they say of a parameter may both be true.
    pub without_rise: Option<usize>,
}

/// Chooses by the one-standard-error rule (Breiman, Friedman, Olshen and Stone 1984): of the
/// structures whose excess over the best is within one standard error, the one with the fewest
/// parameters; of equals the better one. The standard error is that of the paired difference, and
/// at most that of the best structure's own error: an excess is not excused by being uncertain
/// because it is large. One that is larger than a fortieth of the best error is not excused either;
/// one below a thousandth of it always is, however certain. A structure that predicts worse than one
/// with no more parameters is never chosen.
///
/// Nor is one whose friction rises over speeds that the recording only passes through, unless it
/// leaves at most three quarters of the error of all others: what looks like a rise is most often
/// how friction builds up around the reversals of this recording, and fails where the axis slows
/// down without turning round. Where it predicts another recording clearly better too, it is the one
/// to predict with, and [`without_rise`](Choice::without_rise) names the best of the others. It
/// stays in the ranking, ahead of the best where it predicts better.
///
/// Where all were tried on another recording, its blocks count as those that were kept back do, and
/// fewer parameters are not preferred where one of the two alone is predicted clearly worse.
///
/// None for an empty list, or for structures with different numbers of blocks.
pub fn choose(scores: &[CrossValidation]) -> Option<Choice> {
    let here: Vec<f64> = scores.iter().map(|score| score.relative_error).collect();
    let there: Vec<Option<f64>> =
        scores.iter().map(|score| Some(score.elsewhere.as_ref()?.relative_error)).collect();
    let scores: Vec<CrossValidation> = scores.iter().map(CrossValidation::pooled).collect();
    let best_of = |first_speeds: FirstSpeeds| {
        let of_kind = (0..scores.len()).filter(|&index| scores[index].first_speeds == first_speeds);
        of_kind.min_by(|&a, &b| scores[a].relative_error.total_cmp(&scores[b].relative_error))
    };
    let (falls, rises) = (best_of(FirstSpeeds::Plausible), best_of(FirstSpeeds::Rises));
    let believed = match (falls, rises) {
        (Some(falls), Some(rises)) => {
            let share = scores[rises].relative_error / scores[falls].relative_error;
            let borne_out = there[rises].zip(there[falls]);
            let borne_out = borne_out.is_some_and(|(rises, falls)| rises <= BORNE_OUT * falls);
            match share <= RISEN || borne_out && share <= 1.0 {
                true => FirstSpeeds::Rises,
                false => FirstSpeeds::Plausible,
            }
        }
        (Some(_), None) => FirstSpeeds::Plausible,
        (None, _) => FirstSpeeds::Rises,
    };
    let possible = |index: usize| scores[index].first_speeds <= believed;
    let best = (0..scores.len())
        .filter(|&index| possible(index))
        .min_by(|&a, &b| scores[a].relative_error.total_cmp(&scores[b].relative_error))?;
    let winner = &scores[best];
    if scores.iter().any(|score| score.blocks.len() != winner.blocks.len()) {
        return None;
    }
    let mut ranking: Vec<Ranked> = scores
        .iter()
        .enumerate()
        .map(|(index, score)| {
            let difference: Vec<f64> =
                score.blocks.iter().zip(&winner.blocks).map(|(a, b)| a - b).collect();
            let (a, b) = (score.blocks.iter().sum::<f64>(), winner.blocks.iter().sum::<f64>());
            let root = winner.force_power.sqrt() * (a.sqrt() + b.sqrt());
            let percent = |value: f64| if root > 0.0 { 100.0 * value / root } else { 0.0 };
            let (excess, excess_error) = (percent(a - b), percent(sum_error(&difference)));
            let chance = student_95_of(winner.blocks.len().saturating_sub(1) as f64) * excess_error;
            let within = excess
                <= chance.min(winner.standard_error).min(ALIKE * winner.relative_error)
                || excess <= WORTHLESS * winner.relative_error;
            Ranked { index, excess, excess_error, within }
        })
        .collect();
    ranking.sort_by(|a, b| a.excess.total_cmp(&b.excess));
    let parameters = |ranked: &Ranked| scores[ranked.index].structure.parameters();
    let possible = ranking.iter().filter(|ranked| possible(ranked.index));
    let beaten = |ranked: &Ranked| {
        let better = |other: &Ranked| other.excess < ranked.excess;
        possible.clone().any(|other| better(other) && parameters(other) <= parameters(ranked))
    };
    // One of two recordings may be clearly against a structure. Where the other is as clearly against
    // the best, they contradict each other, and fewer parameters are as good.
    let borne = |index: usize| {
        let against = |index: usize, other: usize| {
            let clear = |error: f64, least: f64| error > (1.0 + ALIKE) * least;
            let there = there[index].zip(there[other]);
            there.is_some_and(|(error, least)| clear(error, least))
                || clear(here[index], here[other])
        };
        !against(index, best) || against(best, index)
    };
    let chosen = possible
        .clone()
        .filter(|ranked| ranked.within && !beaten(ranked))
        .filter(|ranked| ranked.excess <= PREFERRED * winner.relative_error)
        .filter(|ranked| borne(ranked.index))
        .min_by(|a, b| parameters(a).cmp(&parameters(b)).then(a.excess.total_cmp(&b.excess)))?;
    let chosen = chosen.index;
    let without_rise = falls.filter(|_| scores[chosen].first_speeds != FirstSpeeds::Plausible);
    Some(Choice { ranking, best, chosen, without_rise })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::axis_structure::{AxisStructure, Elsewhere, Shape};

    fn score(structure: AxisStructure, blocks: &[f64]) -> CrossValidation {
        let sum: f64 = blocks.iter().sum();
        CrossValidation {
            structure,
            shape: Shape::UNUSED,
            blocks: blocks.to_vec(),
            force_power: 1.0,
            relative_error: 100.0 * sum.sqrt(),
            standard_error: 100.0 * sum_error(blocks) / (2.0 * sum.sqrt()),
            first_speeds: FirstSpeeds::Plausible,
            rows: 4,
            elsewhere: None,
        }
    }

    /// A rise that takes a tenth off the error is not believed, one that takes a half off is.
    #[test]
    fn friction_that_rises_is_chosen_where_that_is_plain() {
        let dip = AxisStructure { stribeck: true, ..AxisStructure::SYMMETRIC };
        let rising = |share: f64| {
            let blocks = [0.010, 0.020, 0.015].map(|block| share * share * block);
            CrossValidation { first_speeds: FirstSpeeds::Rises, ..score(dip, &blocks) }
        };
        let plain = score(AxisStructure::SYMMETRIC, &[0.010, 0.020, 0.015]);
        let choice = choose(&[plain.clone(), rising(0.9)]).unwrap();
        assert_eq!((choice.best, choice.chosen), (0, 0));
        assert!(choice.ranking[0].index == 1 && choice.ranking[0].excess < 0.0, "{choice:?}");
        assert_eq!(choice.rivals().collect::<Vec<_>>(), [1], "it may still be true");
        let choice = choose(&[plain.clone(), rising(0.5)]).unwrap();
        assert_eq!((choice.best, choice.chosen), (1, 1));
        assert_eq!(choose(&[rising(0.9)]).unwrap().chosen, 0, "there is no other");
    }

    /// Damping of a bristle that took the same 0.03 % off each block.
    #[test]
    fn a_part_that_takes_next_to_nothing_off_is_left_out_however_certain_that_is() {
        let bristle = AxisStructure { presliding: true, ..AxisStructure::SYMMETRIC };
        let damped = AxisStructure { damping: true, ..bristle };
        let blocks = [0.010, 0.020, 0.015];
        let with = |share: f64| score(damped, &blocks.map(|block| share * share * block));
        let choice = choose(&[score(bristle, &blocks), with(0.9997)]).unwrap();
        assert_eq!((choice.best, choice.chosen), (1, 0), "{choice:?}");
        let choice = choose(&[score(bristle, &blocks), with(0.98)]).unwrap();
        assert_eq!((choice.best, choice.chosen), (1, 1), "{choice:?}");
    }

    /// A tenth off the error here and there: it predicts, and what the best without a rise says of
    /// the parameters may be true all the same.
    #[test]
    fn friction_that_rises_is_chosen_where_another_recording_bears_it_out() {
        let of = |first_speeds, here: f64, there: f64| {
            let dip = AxisStructure { stribeck: true, ..AxisStructure::SYMMETRIC };
            let plain = first_speeds == FirstSpeeds::Plausible;
            let structure = if plain { AxisStructure::SYMMETRIC } else { dip };
            let blocks = |share: f64| [0.010, 0.020, 0.015].map(|b| share * share * b).to_vec();
            let relative_error = 100.0 * blocks(there).iter().sum::<f64>().sqrt();
            let elsewhere =
                Elsewhere { blocks: blocks(there), force_power: 1.0, relative_error, rows: 4 };
            CrossValidation {
                first_speeds,
                elsewhere: Some(elsewhere),
                ..score(structure, &blocks(here))
            }
        };
        let plain = of(FirstSpeeds::Plausible, 1.0, 1.0);
        let with = |here, there| choose(&[plain.clone(), of(FirstSpeeds::Rises, here, there)]);
        let choice = with(0.9, 0.9).unwrap();
        assert_eq!((choice.chosen, choice.without_rise), (1, Some(0)));
        assert_eq!(choice.rivals().collect::<Vec<_>>(), [0], "however much worse it predicts");
        assert_eq!(with(1.0, 0.92).unwrap().chosen, 1, "another recording alone may tell it");
        for (here, there) in [(0.8, 0.97), (1.1, 0.92)] {
            let choice = with(here, there).unwrap();
            assert_eq!((choice.chosen, choice.without_rise), (0, None), "{here} {there}");
        }
    }

    /// Differences of 1e-4, 3e-4, 1e-4, 3e-4: their sum is 8e-4 with a standard error of sqrt(4 *
    /// 4/3) e-4.
    #[test]
    fn the_excess_is_paired_block_by_block() {
        let best = score(
            AxisStructure { delay: true, ..AxisStructure::ASYMMETRIC },
            &[0.01, 0.02, 0.01, 0.05],
        );
        let other = score(AxisStructure::ASYMMETRIC, &[0.0101, 0.0203, 0.0101, 0.0503]);
        let choice = choose(&[other.clone(), best.clone()]).unwrap();
        assert_eq!((choice.best, choice.chosen), (1, 1));
        let worse = choice.ranking[1];
        let root = 0.09f64.sqrt() + 0.0908f64.sqrt();
        assert!((worse.excess - 100.0 * 8e-4 / root).abs() < 1e-9, "{worse:?}");
        assert!(
            (worse.excess_error - 100.0 * (16.0f64 / 3.0).sqrt() * 1e-4 / root).abs() < 1e-9,
            "{worse:?}"
        );
        assert!((worse.excess - (other.relative_error - best.relative_error)).abs() < 1e-9);
    }

    #[test]
    fn of_equally_good_structures_the_simplest_is_chosen() {
        let rich = AxisStructure { delay: true, stribeck: true, ..AxisStructure::ASYMMETRIC };
        let scores = [
            score(rich, &[0.01, 0.02, 0.03]),
            score(AxisStructure::ASYMMETRIC, &[0.011, 0.0195, 0.03]),
        ];
        let choice = choose(&scores).unwrap();
        assert_eq!((choice.chosen, choice.rivals().collect()), (1, vec![0]));
        assert_eq!(choose(&[]), None);
    }

    /// 13 % beside 6.6 %, because of one block that the simple structure cannot predict at all: the
    /// excess is as uncertain as it is large.
    #[test]
    fn a_structure_that_is_worse_is_not_chosen_because_its_excess_is_uncertain() {
        let rich = AxisStructure { delay: true, stribeck: true, ..AxisStructure::ASYMMETRIC };
        let middle = AxisStructure { delay: true, ..AxisStructure::ASYMMETRIC };
        let best = score(rich, &[0.0006, 0.0005, 0.0006, 0.0005, 0.0006, 0.0005, 0.0006, 0.0005]);
        let worst = score(
            AxisStructure::SYMMETRIC,
            &[0.0006, 0.0005, 0.0006, 0.0135, 0.0006, 0.0005, 0.0006, 0.0005],
        );
        let choice = choose(&[worst.clone(), best.clone()]).unwrap();
        assert!(choice.ranking[1].excess <= choice.ranking[1].excess_error, "{choice:?}");
        assert_eq!(choice.chosen, 1);
        // One that is sure to be a little worse does not make room for one that may be much worse.
        let blocks = best.blocks.iter().map(|block| block + 2e-6).collect::<Vec<_>>();
        let choice = choose(&[worst, score(middle, &blocks), best]).unwrap();
        assert_ne!(choice.chosen, 0, "{choice:?}");
    }

    /// In the parts kept back the rich one is better by a little, on another recording far worse.
    #[test]
    fn another_recording_counts_as_much_as_the_parts_kept_back() {
        let rich = AxisStructure { presliding: true, damping: true, ..AxisStructure::SYMMETRIC };
        let there = |blocks: &[f64]| {
            Some(Elsewhere {
                blocks: blocks.to_vec(),
                force_power: 1.0,
                relative_error: 0.0,
                rows: 4,
            })
        };
        let mut scores = [
            score(AxisStructure::SYMMETRIC, &[0.022, 0.021, 0.024, 0.023]),
            score(rich, &[0.016, 0.015, 0.017, 0.016]),
        ];
        assert_eq!(choose(&scores).unwrap().chosen, 1);
        scores[0].elsewhere = there(&[0.005, 0.006, 0.005, 0.006]);
        assert_eq!(choose(&scores), None, "what was tried on one recording and what on two");
        scores[1].elsewhere = there(&[0.021, 0.022, 0.021, 0.023]);
        let choice = choose(&scores).unwrap();
        assert_eq!((choice.best, choice.chosen), (0, 0), "{choice:?}");
        // As an error over all eight blocks of equal length, of a force of power 1.
        let sums = [0.112f64, 0.151];
        let excess = 100.0 * (sums[1] / 2.0).sqrt() - 100.0 * (sums[0] / 2.0).sqrt();
        assert!((choice.ranking[1].excess - excess).abs() < 1e-9, "{choice:?} {excess}");
    }

    /// Over both recordings the simple one is worse by 2 %, and would be preferred; on the second one
    /// it is worse by 9 %, and on the first one hardly better.
    #[test]
    fn fewer_parameters_are_not_preferred_where_one_recording_is_clearly_against_them() {
        let rich = AxisStructure { presliding: true, ..AxisStructure::SYMMETRIC };
        let of = |structure, here: f64, there: f64| {
            let uneven = if structure == rich { 0.0 } else { 0.1 };
            let share = |k: usize| 1.0 + if k.is_multiple_of(2) { uneven } else { -uneven };
            let blocks = |e: f64| (0..4).map(|k| share(k) * e * e / 4.0).collect::<Vec<_>>();
            let relative_error = 100.0 * there;
            let elsewhere =
                Elsewhere { blocks: blocks(there), force_power: 1.0, relative_error, rows: 4 };
            CrossValidation { elsewhere: Some(elsewhere), ..score(structure, &blocks(here)) }
        };
        let chosen = |simple: [f64; 2], best: [f64; 2]| {
            let scores =
                [of(AxisStructure::SYMMETRIC, simple[0], simple[1]), of(rich, best[0], best[1])];
            choose(&scores).unwrap().chosen
        };
        assert_eq!(chosen([0.0408, 0.0334], [0.0400, 0.0332]), 0);
        assert_eq!(chosen([0.0387, 0.0363], [0.0400, 0.0332]), 1);
        assert_eq!(chosen([0.0363, 0.0387], [0.0332, 0.0400]), 1);
        // What one shows the other one does not have.
        assert_eq!(chosen([0.1850, 0.0187], [0.0187, 0.1850]), 0);
        assert_eq!(chosen([0.0550, 0.0400], [0.0400, 0.0540]), 0);
    }

    /// Its excess is uncertain, that of a simpler structure is smaller and sure.
    #[test]
    fn a_structure_is_never_worse_than_a_simpler_one() {
        let rich = AxisStructure { delay: true, stribeck: true, ..AxisStructure::ASYMMETRIC };
        let middle = AxisStructure { delay: true, ..AxisStructure::ASYMMETRIC };
        let best = score(rich, &[0.010, 0.020, 0.010, 0.050]);
        let simple = score(AxisStructure::ASYMMETRIC, &[0.0101, 0.0201, 0.0101, 0.0501]);
        let unsure = score(middle, &[0.010, 0.015, 0.013, 0.0535]);
        let choice = choose(&[unsure, simple, best]).unwrap();
        let place = |index| choice.ranking.iter().find(|ranked| ranked.index == index).unwrap();
        assert!(place(0).excess <= place(0).excess_error && place(0).excess > place(1).excess);
        assert!(place(1).excess > place(1).excess_error);
        assert_eq!(choice.chosen, 2);
    }
}
