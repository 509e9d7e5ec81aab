//! The proposed model with straight branches, as the thesis's listing B.2 is printed: why it must
//! not be copied.
//!
//! ```text
//! F_hyst : virgin curve F_s z / Z_b, |z| <= Z_b, with the memory of [`crate::Hysteresis`]; all else as in the proposed model
//! ```
//!
//! The doubling of a straight line is the same straight line,
//! `f_r + 2 s f(s (z - z_r) / 2) = f_r + (F_s / Z_b) (z - z_r)`. Every branch therefore lies on the
//! virgin line, every loop inside `+-Z_b` has the area zero, and all that is left of the hysteresis
//! is a spring: in pre-sliding it stores what it is given and gives it back. (In Prandtl and
//! Ishlinskii's terms the weight `w = -f''` vanishes; only the stop at `Z_b` remains.) What it
//! dissipates there is the work of `sigma` alone, which vanishes with the speed; with the sine, a
//! loop of amplitude `Z_b` dissipates 1.0930 `F_s Z_b` at any speed.
//!
//! Parameters, steady state, lag and bounds are those of [`crate::Proposed`]. In sliding the two
//! differ little. Use it to see what the curvature of the virgin curve is worth, or where a contact
//! is known to be elastic up to its breakaway.

use crate::virgin_curve::Line;
use crate::{Branch, NonDrift, Real};

/// The proposed model with straight branches.
pub type ProposedLinear<T = f64> = NonDrift<Line<T>, T>;

impl<T: Real> Branch<T> for Line<T> {
    const NAME: &'static str = "proposed_linear";
    fn new(f_s: T, z_b: T) -> Self {
        Self::new(f_s, z_b)
    }
    #[inline]
    fn stiffness(&self) -> T {
        self.stiffness()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{FrictionModel, Hysteresis, Proposed};

    /// Work of the hysteresis force over one loop of amplitude `a Z_b`, in units of `F_s Z_b`,
    /// exactly integrated along fine steps.
    fn loop_area<C: Branch>(model: &NonDrift<C>, a: f64) -> f64 {
        let p = *model.parameters();
        let mut memory = Hysteresis::default();
        let mut before = (a * p.z_b, model.hysteresis_force(&mut memory, a * p.z_b));
        let mut area = 0.0;
        let n = 20_000;
        for k in 1..=2 * n {
            let phase = f64::from(k) / f64::from(n);
            let z = a * p.z_b * if phase <= 1.0 { 1.0 - 2.0 * phase } else { 2.0 * phase - 3.0 };
            let f = model.hysteresis_force(&mut memory, z);
            area += 0.5 * (f + before.1) * (z - before.0);
            before = (z, f);
        }
        area / (p.f_s * p.z_b)
    }

    #[test]
    fn straight_branches_dissipate_nothing_in_pre_sliding() {
        let (line, sine) = (ProposedLinear::chapter_3(), Proposed::chapter_3());
        for (a, with_the_sine) in [(0.25, 0.004_994_9), (0.5, 0.077_479_4), (1.0, 1.092_958_2)] {
            assert!(loop_area(&line, a).abs() < 1e-12, "amplitude {a}: {}", loop_area(&line, a));
            assert!((loop_area(&sine, a) - with_the_sine).abs() < 1e-7, "amplitude {a}");
        }
    }

    #[test]
    fn what_is_stored_comes_back() {
        let model = ProposedLinear::chapter_3();
        let p = *model.parameters();
        let mut state = model.rest();
        for z in [0.7, -0.3, 0.5, 0.1, 0.9] {
            state.continuous[1] = z * p.z_b;
            model.commit(&mut state, 0.0, 1e-3);
            let spring = 0.5 * (p.f_s / p.z_b) * (z * p.z_b) * (z * p.z_b);
            assert!((model.stored_energy(&state).unwrap() - spring).abs() < 1e-15);
        }
    }
}
