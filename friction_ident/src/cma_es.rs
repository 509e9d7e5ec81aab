//! Search without derivatives: evolution of a normal distribution by its covariance matrix
//! (CMA-ES).
//!
//! After Hansen, "The CMA Evolution Strategy: A Tutorial" (2016, arXiv 1604.00772), with its
//! default constants: weighted recombination (equations 41 to 53), cumulation of the step size and
//! of the covariance, rank-one and rank-mu updates with negative weights left out. It suits
//! functions with kinks and many local minima, where gradients mislead.
//!
//! The unknowns live in the unit cube: a point outside is folded back at the faces (the
//! distribution itself is not cut), which keeps bounds without any penalty.

use nalgebra::{DMatrix, DVector};
use rand::{Rng, RngExt};
use rand_distr::StandardNormal;

use crate::finite::symmetric_eigen;

/// A distribution that searches.
#[derive(Debug, Clone)]
pub struct CmaEs {
    mean: DVector<f64>,
    sigma: f64,
    covariance: DMatrix<f64>,
    path_sigma: DVector<f64>,
    path_c: DVector<f64>,
    axes: DMatrix<f64>,
    roots: DVector<f64>,
    weights: Vec<f64>,
    mu_eff: f64,
    generation: usize,
    decomposed: usize,
    population: usize,
}

/// A point with the steps that led to it.
#[derive(Debug, Clone)]
pub struct Candidate {
    /// The point in the unit cube.
    pub x: Vec<f64>,
    /// Standardised step from the mean, before folding.
    step: DVector<f64>,
}

/// The point of the unit interval that an outer point folds back to.
fn fold(value: f64) -> f64 {
    let turned = value.rem_euclid(2.0);
    if turned > 1.0 { 2.0 - turned } else { turned }
}

impl CmaEs {
    /// A distribution around `start` (in the unit cube) with the given deviation in every
    /// direction; at least four candidates a generation.
    pub fn new(start: &[f64], sigma: f64, population: usize) -> Self {
        let n = start.len();
        let population = population.max(4);
        let half = population / 2;
        let raw: Vec<f64> =
            (1..=half).map(|i| (0.5 * (population as f64 + 1.0)).ln() - (i as f64).ln()).collect();
        let sum: f64 = raw.iter().sum();
        let weights: Vec<f64> = raw.iter().map(|weight| weight / sum).collect();
        let mu_eff = 1.0 / weights.iter().map(|weight| weight * weight).sum::<f64>();
        Self {
            mean: DVector::from_column_slice(start),
            sigma,
            covariance: DMatrix::identity(n, n),
            path_sigma: DVector::zeros(n),
            path_c: DVector::zeros(n),
            axes: DMatrix::identity(n, n),
            roots: DVector::from_element(n, 1.0),
            weights,
            mu_eff,
            generation: 0,
            decomposed: 0,
            population,
        }
    }

    /// The tutorial's population for `n` unknowns: 4 + 3 ln n.
    pub fn usual_population(n: usize) -> usize {
        4 + (3.0 * (n.max(1) as f64).ln()) as usize
    }

    /// Candidates a generation.
    pub fn population(&self) -> usize {
        self.population
    }

    /// The next generation.
    pub fn ask(&self, rng: &mut impl Rng) -> Vec<Candidate> {
        let n = self.mean.len();
        (0..self.population)
            .map(|_| {
                let z = DVector::from_fn(n, |_, _| rng.sample::<f64, _>(StandardNormal));
                let step = &self.axes * z.component_mul(&self.roots);
                let x = (0..n).map(|j| fold(self.mean[j] + self.sigma * step[j])).collect();
                Candidate { x, step }
            })
            .collect()
    }

    /// Learns from the values of a generation; what is not finite counts as worst.
    pub fn tell(&mut self, generation: &[Candidate], values: &[f64]) {
        let n = self.mean.len() as f64;
        let mut order: Vec<usize> = (0..generation.len().min(values.len())).collect();
        order.sort_by(|&a, &b| values[a].total_cmp(&values[b]));
        if order.len() < self.weights.len() {
            return;
        }
        let c_sigma = (self.mu_eff + 2.0) / (n + self.mu_eff + 5.0);
        let d_sigma =
            1.0 + 2.0 * (((self.mu_eff - 1.0) / (n + 1.0)).sqrt() - 1.0).max(0.0) + c_sigma;
        let c_c = (4.0 + self.mu_eff / n) / (n + 4.0 + 2.0 * self.mu_eff / n);
        let c_1 = 2.0 / ((n + 1.3).powi(2) + self.mu_eff);
        let c_mu = (1.0 - c_1)
            .min(2.0 * (self.mu_eff - 2.0 + 1.0 / self.mu_eff) / ((n + 2.0).powi(2) + self.mu_eff));
        let chi = n.sqrt() * (1.0 - 1.0 / (4.0 * n) + 1.0 / (21.0 * n * n));

        let mut step = DVector::zeros(self.mean.len());
        for (&index, &weight) in order.iter().zip(&self.weights) {
            step.axpy(weight, &generation[index].step, 1.0);
        }
        self.mean.axpy(self.sigma, &step, 1.0);
        // Whitened by the covariance's root.
        let whitened = &self.axes * (self.axes.tr_mul(&step)).component_div(&self.roots);
        self.path_sigma = &self.path_sigma * (1.0 - c_sigma)
            + whitened * (c_sigma * (2.0 - c_sigma) * self.mu_eff).sqrt();
        self.generation += 1;
        let length = self.path_sigma.norm();
        let settled = 1.0 - (1.0 - c_sigma).powi(2 * self.generation.min(10_000) as i32);
        let stalled = length / settled.sqrt() >= (1.4 + 2.0 / (n + 1.0)) * chi;
        let h = if stalled { 0.0 } else { 1.0 };
        self.path_c =
            &self.path_c * (1.0 - c_c) + &step * (h * (c_c * (2.0 - c_c) * self.mu_eff).sqrt());
        let keep = 1.0 - c_1 - c_mu + (1.0 - h) * c_1 * c_c * (2.0 - c_c);
        self.covariance *= keep;
        self.covariance.ger(c_1, &self.path_c, &self.path_c, 1.0);
        for (&index, &weight) in order.iter().zip(&self.weights) {
            let step = &generation[index].step;
            self.covariance.ger(c_mu * weight, step, step, 1.0);
        }
        self.sigma *= ((c_sigma / d_sigma) * (length / chi - 1.0)).min(1.0).exp();
        let every = (1.0 / ((c_1 + c_mu) * n * 10.0)).max(1.0) as usize;
        if self.generation - self.decomposed >= every {
            self.decompose();
        }
    }

    fn decompose(&mut self) {
        self.decomposed = self.generation;
        let symmetric = (&self.covariance + self.covariance.transpose()) * 0.5;
        self.covariance.copy_from(&symmetric);
        let Some(eigen) = symmetric_eigen(symmetric) else { return };
        let largest = eigen.eigenvalues.max();
        if !(largest.is_finite() && largest > 0.0) {
            return;
        }
        self.roots = eigen.eigenvalues.map(|value| value.max(1e-14 * largest).sqrt());
        self.axes = eigen.eigenvectors;
    }

    /// Largest standard deviation in any direction of the cube.
    pub fn spread(&self) -> f64 {
        self.sigma * self.roots.max()
    }

    /// Ratio of the longest to the shortest axis.
    pub fn condition(&self) -> f64 {
        self.roots.max() / self.roots.min()
    }

    /// The mean, folded into the cube.
    pub fn mean(&self) -> Vec<f64> {
        self.mean.iter().map(|&value| fold(value)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;

    /// Least value after `generations`, from a corner of the cube.
    fn search(n: usize, generations: usize, f: impl Fn(&[f64]) -> f64) -> (f64, CmaEs) {
        let mut rng = rand_pcg::Pcg64Mcg::seed_from_u64(1);
        let mut cma = CmaEs::new(&vec![0.1; n], 0.3, CmaEs::usual_population(n));
        let mut best = f64::INFINITY;
        for _ in 0..generations {
            let generation = cma.ask(&mut rng);
            let values: Vec<f64> = generation.iter().map(|candidate| f(&candidate.x)).collect();
            best = values.iter().fold(best, |least, &value| least.min(value));
            cma.tell(&generation, &values);
        }
        (best, cma)
    }

    /// Hansen's figure: an ellipsoid of condition 10^6 in ten dimensions takes about 6000
    /// evaluations to 1e-9.
    #[test]
    fn an_ellipsoid_is_learnt() {
        let ellipsoid = |x: &[f64]| {
            x.iter()
                .enumerate()
                .map(|(i, x)| 1e6f64.powf(i as f64 / 9.0) * (x - 0.6).powi(2))
                .sum::<f64>()
        };
        let (best, cma) = search(10, 800, ellipsoid);
        assert!(best < 1e-9, "{best}");
        assert!((100.0..10_000.0).contains(&cma.condition()), "{}", cma.condition());
        assert!(cma.mean().iter().all(|x| (x - 0.6).abs() < 1e-4), "{:?}", cma.mean());
    }

    #[test]
    fn the_bent_valley_of_rosenbrock_is_followed() {
        let rosenbrock = |x: &[f64]| {
            let x: Vec<f64> = x.iter().map(|x| 4.0 * x - 2.0).collect();
            x.windows(2)
                .map(|p| 100.0 * (p[1] - p[0] * p[0]).powi(2) + (1.0 - p[0]).powi(2))
                .sum::<f64>()
        };
        let (best, _) = search(3, 500, rosenbrock);
        assert!(best < 1e-9, "{best}");
    }

    #[test]
    fn a_minimum_at_a_face_of_the_cube_is_reached() {
        let (best, cma) = search(6, 400, |x| x.iter().map(|x| x * x).sum());
        assert!(best < 1e-10, "{best}");
        assert!(cma.mean().iter().all(|x| (0.0..1e-3).contains(x)), "{:?}", cma.mean());
    }

    #[test]
    fn values_that_are_no_numbers_do_not_stop_the_search() {
        let (best, _) = search(4, 300, |x| {
            if x[0] < 0.05 { f64::NAN } else { x.iter().map(|x| (x - 0.5).powi(2)).sum() }
        });
        assert!(best < 1e-10, "{best}");
    }
}
