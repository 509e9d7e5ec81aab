//! [`LuGre`](friction_model::LuGre) in lanes.

use friction_model::LuGreParameters;

use crate::block::{Block, WIDTH, each};
use crate::contact::Contact;
use crate::curve::Curve;
use crate::elementary::exp;

/// Contacts side by side; `z` is their state.
#[derive(Debug, Clone)]
pub struct LuGreLanes {
    curve: Curve,
    sigma0: Block,
    inverse_sigma0: Block,
    sigma1: Block,
    /// `v_d`; infinite where the micro-damping is constant.
    v_d: Block,
    /// Whether the micro-damping of any lane falls with speed.
    falling: bool,
    f_v: Block,
    dt: f64,
    z: Block,
}

impl LuGreLanes {
    /// At rest, with a period \[s\].
    pub fn new(of: [&LuGreParameters; WIDTH], dt: f64) -> Self {
        Self {
            curve: Curve::new(of.map(|p| [p.f_s, p.f_c, p.v_s, p.delta])),
            sigma0: of.map(|p| p.sigma0),
            inverse_sigma0: of.map(|p| 1.0 / p.sigma0),
            sigma1: of.map(|p| p.sigma1),
            v_d: of.map(|p| p.v_d.unwrap_or(f64::INFINITY)),
            falling: of.iter().any(|p| p.v_d.is_some()),
            f_v: of.map(|p| p.f_v),
            dt,
            z: [0.0; WIDTH],
        }
    }

    /// The micro-damping \[N s/m or N m s/rad\].
    #[inline(always)]
    fn damping<const FUSED: bool>(&self, velocity: f64) -> Block {
        if !self.falling {
            return self.sigma1;
        }
        each!(i => {
            let ratio = velocity / self.v_d[i];
            self.sigma1[i] * exp::<FUSED>(-ratio * ratio)
        })
    }
}

impl Contact for LuGreLanes {
    #[inline(always)]
    fn step<const FUSED: bool>(&mut self, velocity: f64) -> Block {
        let g = self.curve.level::<FUSED>(velocity);
        let damping = self.damping::<FUSED>(velocity);
        let z = self.z;
        let rate = each!(i => self.sigma0[i] * velocity.abs() / g[i]);
        self.z = each!(i => {
            let steady = (g[i] * self.inverse_sigma0[i]).copysign(velocity);
            steady + (z[i] - steady) * exp::<FUSED>(-rate[i] * self.dt)
        });
        each!(i => {
            self.sigma0[i] * z[i]
                + damping[i] * (velocity - rate[i] * z[i])
                + self.f_v[i] * velocity
        })
    }

    #[inline(always)]
    fn force<const FUSED: bool>(&self, velocity: f64) -> Block {
        let g = self.curve.level::<FUSED>(velocity);
        let damping = self.damping::<FUSED>(velocity);
        each!(i => {
            let z_rate = velocity - self.sigma0[i] * velocity.abs() * self.z[i] / g[i];
            self.sigma0[i] * self.z[i] + damping[i] * z_rate + self.f_v[i] * velocity
        })
    }
}
