//! [`Gms`](friction_model::Gms) in lanes: where an element sticks in one lane and slips in another,
//! both are computed and a mask chooses.

use friction_model::GmsParameters;
use friction_model::arithmetic::sign;

use crate::block::{Block, WIDTH, each};
use crate::contact::Contact;
use crate::curve::Curve;
use crate::elementary::exp;

/// Contacts side by side with the same number of elements.
#[derive(Debug, Clone)]
pub struct GmsLanes {
    curve: Curve,
    f_v: Block,
    dt: f64,
    elements: Vec<Element>,
}

/// One element of each lane, with its state: deflection, and the direction in which it slips.
#[derive(Debug, Clone)]
struct Element {
    sigma0: Block,
    sigma1: Block,
    /// `alpha / sigma0`, and its inverse.
    width: Block,
    inverse_width: Block,
    c: Block,
    z: Block,
    slips: Block,
}

impl GmsLanes {
    /// At rest, with a period \[s\]. All have as many elements as the first.
    pub fn new(of: [&GmsParameters; WIDTH], dt: f64) -> Self {
        let elements = (0..of[0].alpha.len()).map(|k| {
            let sigma0 = of.map(|p| p.sigma0[k]);
            let alpha = of.map(|p| p.alpha[k]);
            Element {
                sigma0,
                sigma1: of.map(|p| p.sigma1[k]),
                width: each!(i => alpha[i] / sigma0[i]),
                inverse_width: each!(i => sigma0[i] / alpha[i]),
                c: of.map(|p| p.c[k]),
                z: [0.0; WIDTH],
                slips: [0.0; WIDTH],
            }
        });
        Self {
            elements: elements.collect(),
            curve: Curve::new(of.map(|p| [p.f_s, p.f_c, p.v_s, p.delta])),
            f_v: of.map(|p| p.f_v),
            dt,
        }
    }
}

impl Contact for GmsLanes {
    #[inline(always)]
    fn step<const FUSED: bool>(&mut self, velocity: f64) -> Block {
        let g = self.curve.level::<FUSED>(velocity);
        let inverse_g = each!(i => 1.0 / g[i]);
        let direction = sign(velocity);
        let moves = direction != 0.0;
        let moved = velocity * self.dt;
        let mut force = each!(i => self.f_v[i] * velocity);
        for element in &mut self.elements {
            let (z, slips) = (element.z, element.slips);
            let relaxation = each!(i => element.c[i] * element.inverse_width[i] * inverse_g[i]);
            let decay = each!(i => exp::<FUSED>(-relaxation[i] * self.dt));
            for i in 0..WIDTH {
                let in_slip = slips[i] * direction > 0.0;
                let width = element.width[i] * g[i];
                let rest = direction * width;
                let pulled = element.c[i] * direction - relaxation[i] * z[i];
                let rate = if in_slip { pulled } else { velocity };
                force[i] += element.sigma0[i] * z[i] + element.sigma1[i] * rate;
                let stuck = z[i] + moved;
                let slides = moves & (direction * stuck >= width);
                let relaxed = rest + (z[i] - rest) * decay[i];
                let begun = if slides { rest } else { stuck };
                element.z[i] = if in_slip { relaxed } else { begun };
                element.slips[i] = if in_slip | slides { direction } else { 0.0 };
            }
        }
        force
    }

    #[inline(always)]
    fn force<const FUSED: bool>(&self, velocity: f64) -> Block {
        let g = self.curve.level::<FUSED>(velocity);
        let inverse_g = each!(i => 1.0 / g[i]);
        let direction = sign(velocity);
        let mut force = each!(i => self.f_v[i] * velocity);
        for element in &self.elements {
            for i in 0..WIDTH {
                let pulled = element.c[i]
                    * (direction - element.z[i] * element.inverse_width[i] * inverse_g[i]);
                let rate = if element.slips[i] * direction > 0.0 { pulled } else { velocity };
                force[i] += element.sigma0[i] * element.z[i] + element.sigma1[i] * rate;
            }
        }
        force
    }
}
