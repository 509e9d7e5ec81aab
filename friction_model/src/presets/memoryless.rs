//! Sets of the models without states.

use super::Presets;
use crate::{
    BengisuAkayParameters, CoulombParameters, CoulombViscousParameters, Elements,
    KarnoppParameters, RateDependentStictionParameters, RbfNetworkParameters, StictionParameters,
    StribeckParameters, TwoLineParameters, ViscousParameters,
};

impl Presets for CoulombParameters {
    fn test_bed() -> Self {
        Self { f_c: 0.0925 }
    }
    fn chapter_3() -> Self {
        Self { f_c: 1.0 }
    }
}

impl Presets for ViscousParameters {
    fn test_bed() -> Self {
        Self { f_v: 0.0403 }
    }
    /// The viscous coefficient of the thesis's velocity example (section 5.4): chapter 3 has none.
    fn chapter_3() -> Self {
        Self { f_v: 0.0176 }
    }
}

impl Presets for CoulombViscousParameters {
    fn test_bed() -> Self {
        Self { f_c: 0.0925, f_v: 0.0403 }
    }
    fn chapter_3() -> Self {
        Self { f_c: 1.0, f_v: 0.0 }
    }
}

impl Presets for StictionParameters {
    fn test_bed() -> Self {
        Self { f_s: 0.0994, f_c: 0.0925, f_v: 0.0403 }
    }
    fn chapter_3() -> Self {
        Self { f_s: 1.5, f_c: 1.0, f_v: 0.0 }
    }
}

impl Presets for StribeckParameters {
    fn test_bed() -> Self {
        Self { f_s: 0.0994, f_c: 0.0925, v_s: 0.1407, delta: 2.0, f_v: 0.0403 }
    }
    fn chapter_3() -> Self {
        Self { f_s: 1.5, f_c: 1.0, v_s: 0.01, delta: 2.0, f_v: 0.0 }
    }
}

impl Presets for RateDependentStictionParameters {
    /// The thesis gives no `t_s`: that of chapter 3 in proportion to `f_s`.
    fn test_bed() -> Self {
        Self { f_s: 0.0994, f_c: 0.0925, t_s: 0.0066, delta_t: 1.0, f_v: 0.0403 }
    }
    /// The thesis gives no `t_s`: the middle of the ramps of its breakaway experiment (0.05, 0.1
    /// and 0.2 N/s).
    fn chapter_3() -> Self {
        Self { f_s: 1.5, f_c: 1.0, t_s: 0.1, delta_t: 1.0, f_v: 0.0 }
    }
}

impl Presets for KarnoppParameters {
    /// The levels of table 4.13. The drop of the friction accelerates the bed's inertia of 0.0026
    /// kg m^2 by 2.7 rad/s^2: the band fits steps up to 0.3 ms.
    fn test_bed() -> Self {
        Self { f_s: 0.0994, f_c: 0.0925, v_s: 0.1407, delta: 2.0, d_v: 1e-3, f_v: 0.0403 }
    }
    /// The drop of the friction accelerates 1 kg by 0.5 m/s^2: the band fits steps up to 0.2 ms.
    fn chapter_3() -> Self {
        Self { f_s: 1.5, f_c: 1.0, v_s: 0.01, delta: 2.0, d_v: 1e-4, f_v: 0.0 }
    }
}

impl Presets for TwoLineParameters {
    /// The tangents of the Tustin curve with table 4.13's parameters at standstill and at 4 rad/s.
    fn test_bed() -> Self {
        Self { a1: 0.0994, b1: 0.0403 - 0.0069 / 0.1407, a2: 0.0925, b2: 0.0403 }
    }
    /// The same with `v_s = 0.01 m/s` and at high speed.
    fn chapter_3() -> Self {
        Self { a1: 1.5, b1: -50.0, a2: 1.0, b2: 0.0 }
    }
}

#[rustfmt::skip]
impl Presets for RbfNetworkParameters {
    /// Ten bells trained on the Stribeck curve of table 4.13, at the breakaway level just above
    /// standstill and at the thesis's 80 speeds of 0.03 to 4 rad/s: the rms error is 7.3e-4 N m
    /// there, and `F(0+)` 0.1016 N m. From 5 rad/s on the true friction is higher.
    fn test_bed() -> Self {
        Self {
            w0: 0.291279804329,
            weights: Elements::from([
                -0.112960839812, 0.017753751056, -0.043246133603, -0.0442151002617, -0.0515929315715,
                -0.0528600634885, -0.060075609887, -0.0564031150168, -0.0789119771417,
                -0.00334031266961,
            ]),
            centres: Elements::from([
                0.0, 0.05, 0.0864681670102, 0.149534878122, 0.258600136306, 0.4472135955,
                0.773394797299, 1.33748060995, 2.31298993509, 4.0,
            ]),
            widths: Elements::from([
                0.05, 0.0432340835051, 0.0497674390611, 0.086065984648, 0.148839358689, 0.257397330496,
                0.445133507226, 0.769797568894, 1.33125969502, 1.68701006491,
            ]),
        }
    }
    /// Ten bells trained on chapter 3's Stribeck curve every 0.001 m/s from standstill to 0.1 m/s:
    /// the rms error is 6.8e-4 N, and `F(0+)` 1.498 N. Beyond, the curve is flat, and `w_0` is its
    /// level.
    fn chapter_3() -> Self {
        Self {
            w0: 1.00000170386,
            weights: Elements::from([
                0.468827273315, 0.00333533219587, 0.0927414779034, 0.163389198338, 0.164569790741,
                0.0984312484219, 0.0047456432803, -0.00019261592281, -3.36846558e-7, 3.775589783e-6,
            ]),
            centres: Elements::from([
                0.0, 0.002, 0.00299069756244, 0.004472135955, 0.00668740304976, 0.01, 0.0149534878122,
                0.022360679775, 0.0334370152488, 0.05,
            ]),
            widths: Elements::from([
                0.002, 0.00149534878122, 0.0012360679775, 0.00184835274366, 0.0027639320225,
                0.00413304238122, 0.0061803398875, 0.0092417637183, 0.0138196601125, 0.0165629847512,
            ]),
        }
    }
}

impl Presets for BengisuAkayParameters {
    /// The levels and the Stribeck velocity of table 4.13: `xi = 1 / v_s`, and the top at a tenth
    /// of `v_s`.
    fn test_bed() -> Self {
        Self { f_s: 0.0994, f_c: 0.0925, v_0: 0.01407, xi: 1.0 / 0.1407, f_v: 0.0403 }
    }
    /// Likewise.
    fn chapter_3() -> Self {
        Self { f_s: 1.5, f_c: 1.0, v_0: 0.001, xi: 100.0, f_v: 0.0 }
    }
}
