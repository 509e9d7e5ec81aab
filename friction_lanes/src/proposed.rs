//! [`Proposed`](friction_model::Proposed) in lanes. All follow their branches of the hysteresis
//! together; one whose branch ends asks its own memory of reversals for the next, which happens
//! once in many samples.

use friction_model::arithmetic::relaxed;
use friction_model::{Hysteresis, ProposedParameters, Sine};

use crate::block::{Block, WIDTH, each};
use crate::contact::Contact;
use crate::curve::Curve;
use crate::elementary::{cosine, exp_m1, sine, within};

/// Contacts side by side.
#[derive(Debug, Clone)]
pub struct ProposedLanes {
    curve: Curve,
    sigma: Block,
    inverse_sigma: Block,
    f_v: Block,
    dt: f64,
    /// `exp(-dt / tau)`, and `exp(-dt / (2 tau))`.
    gamma_decay: Block,
    midway_decay: Block,
    /// `1 / (sigma + k dt)`.
    implicit_gain: Block,
    /// How far a force of one beyond the hysteresis moves `z` in a period where its slope is `k`.
    steepest_gain: Block,
    gamma: Block,
    paths: Paths,
}

/// The hysteresis of each lane.
#[derive(Debug, Clone)]
struct Paths {
    /// The virgin curve: its end, wave number and steepest slope.
    z_b: Block,
    end: Block,
    wave_number: Block,
    stiffness: Block,
    /// The present branch: direction, origin, end, and the factors of the virgin curve.
    direction: Block,
    origin_z: Block,
    origin_f: Block,
    closes_at: Block,
    stretch: Block,
    shrink: Block,
    /// Where it has been followed to.
    z: Block,
    f: Block,
    memories: [Hysteresis; WIDTH],
    virgin: [Sine; WIDTH],
}

impl Paths {
    fn new(of: [&ProposedParameters; WIDTH]) -> Self {
        let virgin = of.map(|p| Sine::new(p.f_s, p.z_b));
        let none = [0.0; WIDTH];
        Self {
            z_b: of.map(|p| p.z_b),
            end: of.map(|p| p.f_s),
            wave_number: of.map(|p| std::f64::consts::FRAC_PI_2 / p.z_b),
            stiffness: virgin.map(|curve| curve.stiffness()),
            direction: none,
            origin_z: none,
            origin_f: none,
            closes_at: none,
            stretch: none,
            shrink: none,
            z: none,
            f: none,
            memories: std::array::from_fn(|_| Hysteresis::default()),
            virgin,
        }
    }

    /// Moves to deflections.
    #[inline(always)]
    fn commit<const FUSED: bool>(&mut self, to: Block) {
        let to = each!(i => within(to[i], -self.z_b[i], self.z_b[i]));
        let f = each!(i => {
            let phase = (self.shrink[i] * self.wave_number[i]) * (to[i] - self.origin_z[i]);
            self.origin_f[i] + (self.stretch[i] * self.end[i]) * sine::<FUSED>(phase)
        });
        // One where the branch goes on to there, and one where it ends before.
        let mut ends = [0.0; WIDTH];
        for i in 0..WIDTH {
            let on = self.direction[i] * (to[i] - self.z[i]) > 0.0;
            let open = self.direction[i] * (to[i] - self.closes_at[i]) < 0.0;
            let stays = to[i] == self.z[i];
            let goes_on = on & open;
            ends[i] = if goes_on | stays { 0.0 } else { 1.0 };
            self.f[i] = if goes_on { f[i] } else { self.f[i] };
            self.z[i] = if goes_on { to[i] } else { self.z[i] };
        }
        if ends.iter().sum::<f64>() > 0.0 {
            self.turn(&ends, &to);
        }
    }

    /// The next branch of the lanes whose branch ends.
    #[inline(never)]
    fn turn(&mut self, ends: &Block, to: &Block) {
        for i in 0..WIDTH {
            if ends[i] == 0.0 {
                continue;
            }
            let memory = &mut self.memories[i];
            memory.follow(self.z[i], self.f[i]);
            self.f[i] = memory.commit(&self.virgin[i], to[i]);
            self.z[i] = memory.deflection();
            let course = memory.course();
            self.direction[i] = course.direction();
            (self.origin_z[i], self.origin_f[i]) = course.origin();
            self.closes_at[i] = course.closes_at();
            (self.stretch[i], self.shrink[i]) = course.factors();
        }
    }

    /// The slope where the branch has been followed to.
    #[inline(always)]
    fn slope<const FUSED: bool>(&self) -> Block {
        each!(i => {
            let z = self.shrink[i] * (self.z[i] - self.origin_z[i]);
            let slope = self.stiffness[i] * cosine::<FUSED>(self.wave_number[i] * z);
            if z.abs() >= self.z_b[i] { 0.0 } else { slope }
        })
    }
}

impl ProposedLanes {
    /// At rest, with a period \[s\].
    pub fn new(of: [&ProposedParameters; WIDTH], dt: f64) -> Self {
        let paths = Paths::new(of);
        let (sigma, k) = (of.map(|p| p.sigma), paths.stiffness);
        let inverse_sigma = sigma.map(|sigma| 1.0 / sigma);
        Self {
            curve: Curve::new(of.map(|p| [p.f_s, p.f_c, p.v_s, p.delta])),
            sigma,
            inverse_sigma,
            f_v: of.map(|p| p.f_v),
            dt,
            gamma_decay: of.map(|p| (-dt / p.tau).exp()),
            midway_decay: of.map(|p| (-0.5 * dt / p.tau).exp()),
            implicit_gain: each!(i => 1.0 / (sigma[i] + k[i] * dt)),
            steepest_gain: each!(i => relaxed(k[i] * inverse_sigma[i], dt) * inverse_sigma[i]),
            gamma: of.map(|p| p.f_s),
            paths,
        }
    }
}

impl Contact for ProposedLanes {
    #[inline(always)]
    fn step<const FUSED: bool>(&mut self, velocity: f64) -> Block {
        let force = self.force::<FUSED>(velocity);
        let g = self.curve.level::<FUSED>(velocity);
        let to = each!(i => {
            let (gamma, f, gain) = (self.gamma[i], self.paths.f[i], self.implicit_gain[i]);
            let rate = within(velocity, (-gamma - f) * gain, (gamma - f) * gain);
            self.paths.z[i] + self.dt * rate
        });
        self.paths.commit::<FUSED>(to);
        self.gamma = each!(i => g[i] + (self.gamma[i] - g[i]) * self.gamma_decay[i]);
        force
    }

    #[inline(always)]
    fn advance<const FUSED: bool>(&mut self, mean: f64) {
        let g = self.curve.level::<FUSED>(mean);
        let stuck = mean * self.dt;
        let slope = self.paths.slope::<FUSED>();
        // How far a force of one moves `z` with that slope: `arithmetic::relaxed` in lanes.
        let gain = each!(i => {
            let rate = slope[i] * self.inverse_sigma[i];
            let left = -exp_m1::<FUSED>(-(rate * self.dt)) / rate;
            (if rate * self.dt < 1e-8 { self.dt } else { left }) * self.inverse_sigma[i]
        });
        let to = each!(i => {
            let (f, direction) = (self.paths.f[i], self.paths.direction[i]);
            let level = g[i] + (self.gamma[i] - g[i]) * self.midway_decay[i];
            let (below, above) = (-level - f, level - f);
            // The steepest slope holds against the branch, and where the step does not get beyond.
            let (least, greatest) = (below * self.steepest_gain[i], above * self.steepest_gain[i]);
            let gentler = (direction * below > 0.0) & (stuck < least);
            let least = if gentler { below * gain[i] } else { least };
            let gentler = (direction * above > 0.0) & (stuck > greatest);
            let greatest = if gentler { above * gain[i] } else { greatest };
            self.paths.z[i] + within(stuck, least, greatest)
        });
        self.paths.commit::<FUSED>(to);
        self.gamma = each!(i => g[i] + (self.gamma[i] - g[i]) * self.gamma_decay[i]);
    }

    #[inline(always)]
    fn force<const FUSED: bool>(&self, velocity: f64) -> Block {
        each!(i => {
            let (gamma, f) = (self.gamma[i], self.paths.f[i]);
            within(f + self.sigma[i] * velocity, -gamma, gamma) + self.f_v[i] * velocity
        })
    }
}
