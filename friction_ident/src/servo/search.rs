//! Search for the parameters with the least mean position error.

use std::ops::ControlFlow;

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use super::lanes::Lanes;
use super::parameter::ServoParameter;
use super::physics::Physics;
use super::space::Free;
use crate::cma_es::CmaEs;

/// How long to search.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Effort {
    /// Simulations of all logs at most.
    pub evaluations: usize,
    /// Give up candidates early that cannot be among the best half of a generation.
    pub abandon: bool,
    /// Share by which friction may differ from one recording to the next, zero or more. A candidate
    /// is judged by its mean error with so much less, with as much and with so much more friction:
    /// where a servo comes to rest hangs on little, and a candidate that is right with one value
    /// alone is right by chance. Zero judges it by its own friction, as the peer does.
    pub friction_varies: f64,
}

impl Effort {
    /// Factors of the friction that a candidate is judged with.
    fn factors(&self) -> impl Iterator<Item = f64> + '_ {
        let share = self.friction_varies;
        let all = [1.0, 1.0 - share, 1.0 + share];
        all.into_iter().take(if share > 0.0 { 3 } else { 1 })
    }

    /// The mean errors of candidates; infinite where one must exceed `limit`.
    fn judge(&self, lanes: &Lanes, candidates: &[Physics], limit: f64) -> Vec<f64> {
        let times = self.factors().count() as f64;
        let mut sums = vec![0.0; candidates.len()];
        for factor in self.factors() {
            let some: Vec<Physics> =
                candidates.iter().map(|physics| physics.with_friction(factor)).collect();
            // What the best of them may still have before all exceed the limit.
            let least = sums.iter().copied().fold(f64::INFINITY, f64::min);
            let errors = lanes.errors_of(&some, times * limit - least);
            sums.iter_mut().zip(errors).for_each(|(sum, error)| *sum += error);
        }
        sums.iter().map(|sum| sum / times).collect()
    }
}

/// What a search found.
#[derive(Debug, Clone, PartialEq)]
pub struct Found {
    /// The parameters, in the order asked for.
    pub values: Vec<f64>,
    /// Mean position error with the friction of these parameters \[rad\].
    pub error: f64,
    /// Simulations done.
    pub evaluations: usize,
}

/// Searches from a seed.
pub fn search(
    lanes: &Lanes,
    free: &[Free],
    seed: u64,
    effort: &Effort,
    watch: &mut dyn FnMut(usize, f64) -> ControlFlow<()>,
) -> Found {
    search_from(lanes, free, None, seed, effort, watch)
}

/// The same, with the first values to look around, where some are known.
pub fn search_from(
    lanes: &Lanes,
    free: &[Free],
    first: Option<&[f64]>,
    seed: u64,
    effort: &Effort,
    watch: &mut dyn FnMut(usize, f64) -> ControlFlow<()>,
) -> Found {
    let n = free.len();
    let parameters: Vec<ServoParameter> = free.iter().map(|free| free.parameter).collect();
    let first: Option<Vec<f64>> =
        first.map(|values| free.iter().zip(values).map(|(free, &v)| free.place_of(v)).collect());
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    let mut best = (f64::INFINITY, vec![0.5; n]);
    let mut evaluations = 0;
    let physics = |x: &[f64]| {
        let values: Vec<f64> = free.iter().zip(x).map(|(free, &x)| free.value_at(x)).collect();
        Physics::new(&parameters, &values)
    };
    let usual = CmaEs::usual_population(n);
    let simulations = effort.factors().count();
    let mut restart = 0;
    'search: while evaluations < effort.evaluations {
        // Restarts alternate: larger and larger populations from anywhere, small ones around the
        // best.
        let (start, sigma, population) = if let (0, Some(first)) = (restart, &first) {
            (first.clone(), 0.1, usual * 2)
        } else if restart % 2 == 0 {
            let start: Vec<f64> = (0..n).map(|_| rng.random_range(0.1..0.9)).collect();
            (start, 0.3, (usual * 2) << (restart / 2).min(3))
        } else {
            (best.1.clone(), 0.05, usual * 2)
        };
        restart += 1;
        let mut cma = CmaEs::new(&start, sigma, population);
        let mut recent = std::collections::VecDeque::new();
        loop {
            let generation = cma.ask(&mut rng);
            let mut values: Vec<f64> = Vec::with_capacity(generation.len());
            let mut sorted: Vec<f64> = Vec::new();
            for few in generation.chunks(lanes.at_once()) {
                let limit = match (effort.abandon, sorted.get(population / 2)) {
                    (true, Some(&limit)) => limit,
                    _ => f64::INFINITY,
                };
                let candidates: Vec<Physics> = few.iter().map(|one| physics(&one.x)).collect();
                for (candidate, value) in few.iter().zip(effort.judge(lanes, &candidates, limit)) {
                    evaluations += simulations;
                    let at = sorted.partition_point(|&other| other <= value);
                    sorted.insert(at, value);
                    if value < best.0 {
                        best = (value, candidate.x.clone());
                    }
                    values.push(value);
                }
            }
            cma.tell(&generation, &values);
            if watch(evaluations, best.0).is_break() {
                break 'search;
            }
            recent.push_back(sorted[0]);
            let window = 20 + 30 * n / population;
            let mut flat = false;
            if recent.len() > window {
                recent.pop_front();
                let (low, high) =
                    recent.iter().fold((f64::INFINITY, 0.0f64), |(l, h), &v| (l.min(v), h.max(v)));
                flat = high - low < 1e-5 * low;
            }
            if flat
                || cma.spread() < 1e-7
                || cma.condition() > 1e7
                || evaluations >= effort.evaluations
            {
                break;
            }
        }
    }
    let values: Vec<f64> = free.iter().zip(&best.1).map(|(free, &x)| free.value_at(x)).collect();
    let error =
        if simulations == 1 { best.0 } else { lanes.error(&physics(&best.1), f64::INFINITY) };
    Found { values, error, evaluations }
}
