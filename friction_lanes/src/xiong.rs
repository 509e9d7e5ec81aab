//! [`Xiong`](friction_model::Xiong) in lanes.

use friction_model::XiongParameters;
use friction_model::arithmetic::relaxed;

use crate::block::{Block, WIDTH, each};
use crate::contact::Contact;
use crate::curve::Curve;
use crate::elementary::within;

/// Contacts side by side with the same number of elements.
#[derive(Debug, Clone)]
pub struct XiongLanes {
    curve: Curve,
    f_v: Block,
    dt: f64,
    /// `exp(-dt / tau)`, and `exp(-dt / (2 tau))`.
    gamma_decay: Block,
    midway_decay: Block,
    gamma: Block,
    elements: Vec<Element>,
}

/// One element of each lane, with its deflection.
#[derive(Debug, Clone)]
struct Element {
    lambda: Block,
    k: Block,
    sigma: Block,
    /// How far a force of one beyond the spring moves it in a period.
    gain: Block,
    /// `1 / (sigma + k dt)`.
    implicit_gain: Block,
    z: Block,
}

impl XiongLanes {
    /// At rest, with a period \[s\]. All have as many elements as the first.
    pub fn new(of: [&XiongParameters; WIDTH], dt: f64) -> Self {
        let elements = (0..of[0].lambda.len()).map(|at| {
            let (k, sigma) = (of.map(|p| p.k[at]), of.map(|p| p.sigma[at]));
            Element {
                lambda: of.map(|p| p.lambda[at]),
                k,
                sigma,
                gain: each!(i => {
                    let inverse = 1.0 / sigma[i];
                    relaxed(k[i] * inverse, dt) * inverse
                }),
                implicit_gain: each!(i => 1.0 / (sigma[i] + k[i] * dt)),
                z: [0.0; WIDTH],
            }
        });
        Self {
            elements: elements.collect(),
            curve: Curve::new(of.map(|p| [p.f_s, p.f_c, p.v_s, p.delta])),
            f_v: of.map(|p| p.f_v),
            dt,
            gamma_decay: of.map(|p| (-dt / p.tau).exp()),
            midway_decay: of.map(|p| (-0.5 * dt / p.tau).exp()),
            gamma: of.map(|p| p.f_s),
        }
    }

    /// Lets the level follow the Stribeck curve for a period.
    #[inline(always)]
    fn relax(&mut self, g: &Block) {
        self.gamma = each!(i => g[i] + (self.gamma[i] - g[i]) * self.gamma_decay[i]);
    }
}

impl Contact for XiongLanes {
    #[inline(always)]
    fn step<const FUSED: bool>(&mut self, velocity: f64) -> Block {
        let g = self.curve.level::<FUSED>(velocity);
        let mut force = each!(i => self.f_v[i] * velocity);
        for element in &mut self.elements {
            for (i, force) in force.iter_mut().enumerate() {
                let level = element.lambda[i] * self.gamma[i];
                let elastic = element.k[i] * element.z[i];
                let gain = element.implicit_gain[i];
                *force += within(elastic + element.sigma[i] * velocity, -level, level);
                let slowest = (-level - elastic) * gain;
                element.z[i] += self.dt * within(velocity, slowest, (level - elastic) * gain);
            }
        }
        self.relax(&g);
        force
    }

    #[inline(always)]
    fn advance<const FUSED: bool>(&mut self, mean: f64) {
        let g = self.curve.level::<FUSED>(mean);
        let midway = each!(i => g[i] + (self.gamma[i] - g[i]) * self.midway_decay[i]);
        let stuck = mean * self.dt;
        for element in &mut self.elements {
            for (i, midway) in midway.iter().enumerate() {
                let level = element.lambda[i] * midway;
                let elastic = element.k[i] * element.z[i];
                let gain = element.gain[i];
                let slowest = (-level - elastic) * gain;
                element.z[i] += within(stuck, slowest, (level - elastic) * gain);
            }
        }
        self.relax(&g);
    }

    #[inline(always)]
    fn force<const FUSED: bool>(&self, velocity: f64) -> Block {
        let mut force = each!(i => self.f_v[i] * velocity);
        for element in &self.elements {
            for (i, force) in force.iter_mut().enumerate() {
                let level = element.lambda[i] * self.gamma[i];
                let elastic = element.k[i] * element.z[i];
                *force += within(elastic + element.sigma[i] * velocity, -level, level);
            }
        }
        force
    }
}
