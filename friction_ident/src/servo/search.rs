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
}

/// What a search found.
#[derive(Debug, Clone, PartialEq)]
pub struct Found {
    /// The parameters, in the order asked for.
    pub values: Vec<f64>,
    /// Mean position error \[rad\].
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
                for (candidate, value) in few.iter().zip(lanes.errors_of(&candidates, limit)) {
                    evaluations += 1;
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
    let values = free.iter().zip(&best.1).map(|(free, &x)| free.value_at(x)).collect();
    Found { values, error: best.0, evaluations }
}
