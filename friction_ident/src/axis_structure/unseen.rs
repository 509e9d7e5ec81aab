//! Parts of a structure that the recording does not show.
//!
//! A dip or a bristle of which no parameter is known describes some rows of this recording, and
//! predicts anything elsewhere. Where leaving it out costs no more than chance, the structure without
//! it is the one to use, and what the other says still counts for the intervals.

use super::choice::{ALIKE, Choice, choose};
use super::cross_validation::{CrossValidation, sum_error};
use super::fit::StructureFit;
use super::{AxisStructure, FirstSpeeds, doubts};
use crate::estimate::Estimate;
use crate::parameter_id::{ParameterId, Side};
use crate::statistics::student_95_of;

/// Standard errors by which a parameter is clear of zero.
const CLEARLY: f64 = 2.0;
/// Share of the error by which the structure without may be larger, however uncertain that is.
const MOST: f64 = 0.1;

impl StructureFit {
    /// The structure without a part of which it knows no parameter; none where each part is clear of
    /// its error. The parts are what happens around rest: the dip, the bristle, and its damping.
    pub fn without_unseen(&self) -> impl Iterator<Item = AxisStructure> {
        let own = self.structure;
        let is_known =
            |name: &'static str| self.estimates.get(name).is_some_and(Estimate::is_identified);
        // Beside no error there is nothing to be clear of: it lies at a bound.
        let is_clear = |name: &'static str| {
            let error = |estimate: &Estimate| Some((estimate.value, estimate.standard_error?));
            let found = self.estimates.get(name).and_then(error);
            found.is_none_or(|(value, error)| value.abs() >= CLEARLY * error)
        };
        let is_deep = |&side: &Side| {
            let [f_s, f_c] = ["f_s", "f_c"].map(|name| ParameterId::new(name).side(side));
            let depth = doubts::difference(&self.estimates, f_s, f_c);
            depth.is_some_and(|(depth, error)| depth.abs() >= CLEARLY * error)
        };
        let dip = is_known("v_s") || Side::of(own.asymmetric).iter().any(is_deep);
        let damping = own.damping && (is_known("sigma1") || is_clear("sigma1"));
        let bristle = is_known("presliding") || is_clear("presliding") || damping;
        [
            (own.stribeck && !dip, AxisStructure { stribeck: false, lag: false, ..own }),
            (
                own.presliding && !bristle,
                AxisStructure { presliding: false, damping: false, lag: false, ..own },
            ),
            (own.damping && !damping, AxisStructure { damping: false, ..own }),
        ]
        .into_iter()
        .filter_map(|(unseen, without)| unseen.then_some(without))
    }
}

impl Choice {
    /// The choice among those of `scores` that have no more around rest than `most`, where its error is
    /// larger than that of the chosen one by no more than chance, and by a tenth at most, and another
    /// recording is not predicted clearly worse; what it is better than is in the ranking as before.
    pub fn among(&self, scores: &[CrossValidation], most: &AxisStructure) -> Option<Self> {
        let fits = |own: &AxisStructure| {
            (most.stribeck || !own.stribeck)
                && (most.presliding || !own.presliding)
                && (most.damping || !own.damping)
        };
        let left: Vec<usize> =
            (0..scores.len()).filter(|&index| fits(&scores[index].structure)).collect();
        let few: Vec<CrossValidation> = left.iter().map(|&index| scores[index].clone()).collect();
        let chosen = *left.get(choose(&few)?.chosen)?;
        let [own, other] = [self.chosen, chosen].map(|index| scores[index].pooled());
        let difference: Vec<f64> =
            other.blocks.iter().zip(&own.blocks).map(|(other, own)| other - own).collect();
        let own_sum: f64 = own.blocks.iter().sum();
        let chance =
            student_95_of(difference.len().saturating_sub(1) as f64) * sum_error(&difference);
        // Sums of squares: the square of the larger error.
        let most = ((1.0 + MOST).powi(2) - 1.0) * own_sum;
        // What another recording bears out is there, whatever nobody knows of it.
        let [own, other] = [self.chosen, chosen].map(|index| scores[index].elsewhere.as_ref());
        let borne_out = own
            .zip(other)
            .is_some_and(|(own, other)| other.relative_error > (1.0 + ALIKE) * own.relative_error);
        let is_as_good = difference.iter().sum::<f64>() <= chance.min(most) && !borne_out;
        let rises = scores[chosen].first_speeds != FirstSpeeds::Plausible;
        is_as_good.then(|| Self {
            chosen,
            without_rise: self.without_rise.filter(|_| rises),
            ..self.clone()
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::stribeck_axis;
    use super::super::{AxisUnits, fit_structure};
    use super::super::{Elsewhere, Shape};
    use super::*;
    use crate::conditioning::{Conditioned, Conditioning, Signals, condition};

    const DIP: AxisStructure = AxisStructure { stribeck: true, ..AxisStructure::SYMMETRIC };

    fn score(structure: AxisStructure, blocks: [f64; 4]) -> CrossValidation {
        let sum: f64 = blocks.iter().sum();
        CrossValidation {
            structure,
            shape: Shape::UNUSED,
            blocks: blocks.to_vec(),
            force_power: 1.0,
            relative_error: 100.0 * sum.sqrt(),
            standard_error: 100.0 * sum_error(&blocks) / (2.0 * sum.sqrt()),
            first_speeds: FirstSpeeds::Plausible,
            rows: 4,
            elsewhere: None,
        }
    }

    /// An axis with Coulomb and viscous friction alone, and noise of a fiftieth of its torque.
    fn plain_axis() -> Conditioned {
        use rand::{RngExt, SeedableRng};
        let mut rng = rand_pcg::Pcg64Mcg::seed_from_u64(5);
        let at = |k: u32| {
            let t = 1e-3 * f64::from(k);
            let of = |a: f64, w: f64| {
                [a * (w * t).sin(), a * w * (w * t).cos(), -a * w * w * (w * t).sin()]
            };
            let ([q1, v1, a1], [q2, v2, a2]) = (of(1.0, 2.2), of(0.4, 5.3));
            let v = v1 + v2;
            (q1 + q2, 0.05 * (a1 + a2) + 0.1 * v + 0.5 * v.signum())
        };
        let (place, force): (Vec<f64>, Vec<f64>) = (0..20_000).map(at).unzip();
        let force: Vec<f64> = force.iter().map(|f| f + 0.1 * (rng.random::<f64>() - 0.5)).collect();
        let signals = Signals {
            time_step: 1e-3,
            position: Some(&place),
            readings: None,
            velocity: None,
            force: &force,
        };
        condition(&signals, &Conditioning::for_time_step(1e-3)).unwrap()
    }

    #[test]
    fn a_dip_that_is_there_is_seen_and_one_that_is_not_is_not() {
        let without = |recording: &Conditioned, structure: &str| -> Vec<String> {
            let fit = fit_structure(recording, structure.parse().unwrap(), &AxisUnits::ROTARY);
            fit.unwrap().without_unseen().map(|without| without.to_string()).collect()
        };
        assert_eq!(without(&stribeck_axis(), "asymmetric+stribeck+delay"), [""; 0]);
        assert_eq!(without(&plain_axis(), "symmetric+stribeck"), ["symmetric"]);
        assert_eq!(without(&plain_axis(), "symmetric"), [""; 0]);
    }

    /// A stranger's stage was given a dip that took 1.5 % off the error, of a depth and a breadth that
    /// nobody knew, and predicted a slower recording five times worse than without.
    #[test]
    fn what_is_not_seen_is_left_where_it_helps_no_more_than_chance() {
        let with = [0.010, 0.020, 0.015, 0.012];
        let chosen = |plain: [f64; 4]| {
            let scores = [score(AxisStructure::SYMMETRIC, plain), score(DIP, with)];
            let choice = Choice { chosen: 1, ..choose(&scores).unwrap() };
            let simpler = choice.among(&scores, &AxisStructure::SYMMETRIC);
            simpler.map(|choice| (choice.chosen, choice.rivals().collect::<Vec<_>>()))
        };
        // Better in three blocks and worse in one; what the dip says still counts.
        assert_eq!(chosen([0.0105, 0.0208, 0.0146, 0.0123]), Some((0, vec![1])));
        assert_eq!(chosen([0.0105, 0.0210, 0.0157, 0.0126]), None, "in each by the same share");
        assert_eq!(chosen([0.010, 0.020, 0.035, 0.012]), None, "uncertain because it is large");
        let there = |structure, blocks, error: f64| {
            let elsewhere = Elsewhere {
                blocks: vec![error * error / 4.0; 4],
                force_power: 1.0,
                relative_error: 100.0 * error,
                rows: 4,
            };
            CrossValidation { elsewhere: Some(elsewhere), ..score(structure, blocks) }
        };
        let tried = |plain: f64| {
            let scores = [
                there(AxisStructure::SYMMETRIC, [0.0105, 0.0208, 0.0146, 0.0123], plain),
                there(DIP, with, 0.10),
            ];
            let choice = Choice { chosen: 1, ..choose(&scores).unwrap() };
            choice.among(&scores, &AxisStructure::SYMMETRIC).map(|choice| choice.chosen)
        };
        assert_eq!((tried(0.101), tried(0.11)), (Some(0), None), "another recording bears it out");
        let alone = [score(DIP, with)];
        let choice = choose(&alone).unwrap();
        assert_eq!(choice.among(&alone, &AxisStructure::SYMMETRIC), None, "there is no other");
    }
}
