//! What the structures say that predict as well as the chosen one.
//!
//! The errors of a chosen structure are those of one that was known beforehand. Where another
//! predicts as well and puts a parameter elsewhere, the recording does not tell which is right, and
//! an interval that leaves the other out is too narrow (Chatfield 1995; Buckland, Burnham and
//! Augustin 1997, Biometrics 53).

use super::fit::StructureFit;
use super::naming::SPEEDS;
use super::said::Said;
use super::{Choice, CrossValidation, Ranked, curved, doubts, sliding};
use crate::conditioning::Conditioned;
use crate::estimate::Estimate;
use crate::parameter_id::{ParameterId, Side};

/// What to measure where structures disagree.
const TELLS_APART: &str =
    "a recording that tells the structures apart: more speeds, more reversals, more of the travel";

/// What a straight line over the speeds and a dip at its beginning are made of.
const STRAIGHT: [&str; 4] = ["f_v", "f_c", "f_s", "v_s"];
const CURVED: &str =
    "friction is no straight line over these speeds, and a fit that lets it bend puts it elsewhere";

impl Choice {
    /// Places in the given list of those that predict as well as the chosen one, all that the rule
    /// of one standard error lets in; and of the best without a rise over the first speeds, where the
    /// chosen one has such a rise.
    pub fn rivals(&self) -> impl Iterator<Item = usize> {
        let others = self.ranking.iter().filter(|ranked| ranked.index != self.chosen);
        let rival = |ranked: &&Ranked| ranked.within || self.without_rise == Some(ranked.index);
        others.filter(rival).map(|ranked| ranked.index)
    }
}

impl StructureFit {
    /// Widens each interval to what `rivals` say of the parameter when they are fitted to the same
    /// recording, to what its sliding alone says, and to what a fit says that lets viscous friction
    /// bend: each counts as unsure as the chosen one is. Rivals that cannot be fitted say nothing. The
    /// interval of a bristle's displacement reaches as far as it does beside a damping.
    pub fn heed(&mut self, recording: &Conditioned, rivals: &[CrossValidation]) {
        let (own, scale) = (self.structure, self.position_scale);
        let rivals = rivals.iter().filter_map(|rival| Said::of(recording, rival, scale));
        let mut all: Vec<Said> = rivals.collect();
        if let Some(curved) = curved::said(self, recording) {
            self.curved = self.outside(&curved);
            all.push(curved);
        }
        if let Some(sliding) = sliding::said(recording, own, &self.shape, scale, &self.estimates) {
            self.sliding = self.outside(&sliding);
            if !own.delay {
                self.sliding
                    .extend(sliding.value("delay".into(), own).map(|late| ("delay".into(), late)));
            }
            all.push(sliding);
        }
        self.widen(&all);
        let beside = self.displacement_beside_damping(recording);
        if let Some((own, beside)) = self.estimates.get_mut("presliding").zip(beside) {
            own.reach(beside.low, beside.high, TELLS_APART);
        }
        self.heed_lag();
        doubts::sampled(recording, &mut self.estimates);
        let listed = |id: ParameterId| self.curved.iter().any(|(own, _)| *own == id);
        let straight = |id: ParameterId| STRAIGHT.contains(&id.name) && listed(id);
        self.estimates.distrust_but(|id| !straight(id), CURVED, SPEEDS);
        doubts::of_a_wave(&mut self.estimates);
    }

    /// Widens the interval of the displacement to what it would be where the bristle's limit lags: the
    /// stiffness at a reversal is then the kinetic level over it, and not the level at rest. Which of
    /// both it is shows in the choice of the structure only.
    fn heed_lag(&mut self) {
        if !self.structure.stribeck || !self.structure.presliding || self.structure.lag {
            return;
        }
        let sum = |name: &'static str| {
            let sides = Side::of(self.structure.asymmetric).iter();
            sides.filter_map(|&side| self.estimates.value(ParameterId::new(name).side(side))).sum()
        };
        let (f_s, f_c): (f64, f64) = (sum("f_s"), sum("f_c"));
        let share = f_c / f_s;
        let Some(own) = self.estimates.get_mut("presliding") else { return };
        if let Some(interval) = own.interval
            && share > 0.0
        {
            own.reach(share * interval.low, share * interval.high, TELLS_APART);
        }
    }

    /// What another fit says of the parameters whose intervals do not hold that.
    fn outside(&self, said: &Said) -> Vec<(ParameterId, f64)> {
        let outside = |estimate: &Estimate| {
            let value = said.value(estimate.id, self.structure)?;
            let inside = estimate.interval.is_none_or(|interval| interval.contains(value));
            (!inside).then_some((estimate.id, value))
        };
        self.estimates.parameters.iter().filter_map(outside).collect()
    }

    fn widen(&mut self, all: &[Said]) {
        for estimate in &mut self.estimates.parameters {
            let (id, own) = (estimate.id, self.structure);
            let values = all.iter().filter_map(|said| said.value(id, own));
            estimate.reach_around(values, TELLS_APART);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::naming::AxisUnits;
    use super::super::tests::three_tones;
    use super::super::{AxisStructure, PositionScale, cross_validate, fit_structure};
    use super::*;
    use crate::estimate::IntervalMethod;
    use rand::{RngExt, SeedableRng};
    use rand_distr::StandardNormal;

    const OFFSET: f64 = 0.2;

    /// An axis with a constant force, in steps of the encoder, and noise.
    fn axis() -> Conditioned {
        let mut rng = rand_pcg::Pcg64Mcg::seed_from_u64(5);
        three_tones(20_000, |_, v, a| {
            let noise = rng.sample::<f64, _>(StandardNormal);
            0.3 * a + 0.2 * v + 0.5 * v.signum() + OFFSET + 0.05 * noise
        })
    }

    #[test]
    fn both_symmetries_are_read_in_terms_of_each_other() {
        let recording = axis();
        let scale = PositionScale::of(&recording);
        let score = |structure| cross_validate(&recording, structure, 8).unwrap();
        let [symmetric, asymmetric] = [AxisStructure::SYMMETRIC, AxisStructure::ASYMMETRIC];
        let one = Said::of(&recording, &score(symmetric), scale).unwrap();
        let two = Said::of(&recording, &score(asymmetric), scale).unwrap();
        let near = |found: Option<f64>, truth: f64| {
            assert!(found.is_some_and(|found| (found - truth).abs() < 0.02), "{found:?} {truth}");
        };
        let side = |name, side| ParameterId::new(name).side(side);
        near(one.value(side("f_c", Side::Forward), asymmetric), 0.5 + OFFSET);
        near(one.value(side("f_c", Side::Backward), asymmetric), 0.5 - OFFSET);
        near(one.value(side("f_v", Side::Forward), asymmetric), 0.2);
        near(two.value("f_c".into(), symmetric), 0.5);
        near(two.value("offset".into(), symmetric), OFFSET);
        near(two.value("inertia".into(), symmetric), 0.3);
        let along = AxisStructure { position: true, ..symmetric };
        assert_eq!(two.value("f_c".into(), along), None);
    }

    #[test]
    fn an_interval_reaches_to_what_the_rivals_say() {
        let recording = axis();
        let units = &AxisUnits::ROTARY;
        let mut fit = fit_structure(&recording, AxisStructure::SYMMETRIC, units).unwrap();
        let before = fit.clone();
        let rival = AxisStructure { stribeck: true, ..AxisStructure::SYMMETRIC };
        let rival = cross_validate(&recording, rival, 8).unwrap();
        let said = Said::of(&recording, &rival, fit.position_scale).unwrap();
        fit.widen(std::slice::from_ref(&said));
        for (estimate, before) in fit.estimates.parameters.iter().zip(&before.estimates.parameters)
        {
            let value = said.value(estimate.id, AxisStructure::SYMMETRIC).unwrap();
            let (now, then) = (estimate.interval.unwrap(), before.interval.unwrap());
            assert!(now.contains(value), "{}", estimate.id);
            // The rival's value stands in an interval as wide as that of the chosen one.
            let moved = value - estimate.value;
            let (low, high) = (then.low.min(then.low + moved), then.high.max(then.high + moved));
            let near = |a: f64, b: f64| (a - b).abs() < 1e-9 * (then.high - then.low);
            assert!(near(now.low, low) && near(now.high, high), "{now:?} {low} {high}");
            assert_eq!(now.method, IntervalMethod::Rivals);
        }
    }
}
