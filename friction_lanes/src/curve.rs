//! The Stribeck curve in lanes.

use crate::block::{Block, WIDTH, each};
use crate::elementary::{exp, power};

/// What [`StribeckCurve`](friction_model::StribeckCurve) is for one set.
#[derive(Debug, Clone)]
pub struct Curve {
    f_c: Block,
    /// `F_s - F_c` \[N or N m\].
    fall: Block,
    inverse_v_s: Block,
    delta: Block,
    /// All lanes have the shape exponent 2.
    gaussian: bool,
}

impl Curve {
    /// `f_s`, `f_c`, `v_s` and `delta` of each lane.
    pub fn new(of: [[f64; 4]; WIDTH]) -> Self {
        Self {
            f_c: of.map(|[_, f_c, _, _]| f_c),
            fall: of.map(|[f_s, f_c, _, _]| f_s - f_c),
            inverse_v_s: of.map(|[_, _, v_s, _]| 1.0 / v_s),
            delta: of.map(|[_, _, _, delta]| delta),
            gaussian: of.iter().all(|[_, _, _, delta]| *delta == 2.0),
        }
    }

    /// `g(v)` \[N or N m\].
    #[inline(always)]
    pub fn level<const FUSED: bool>(&self, velocity: f64) -> Block {
        let ratio = each!(i => velocity * self.inverse_v_s[i]);
        if self.gaussian {
            each!(i => self.f_c[i] + self.fall[i] * exp::<FUSED>(-(ratio[i] * ratio[i])))
        } else {
            each!(i => {
                let general = power::<FUSED>(ratio[i].abs(), self.delta[i]);
                let square = ratio[i] * ratio[i];
                let raised = if self.delta[i] == 2.0 { square } else { general };
                self.f_c[i] + self.fall[i] * exp::<FUSED>(-raised)
            })
        }
    }
}
