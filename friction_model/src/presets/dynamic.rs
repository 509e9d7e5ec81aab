//! Sets of the models with states.

#[cfg(not(feature = "std"))]
use num_traits::Float as _;

use super::Presets;
use crate::{
    ArmstrongParameters, BlimanSorineParameters, BristleParameters, DahlParameters,
    ElastoPlasticParameters, Elements, GmsParameters, LeuvenParameters, LuGreParameters,
    ProposedParameters, ResetIntegratorParameters, WojewodaParameters, XiongParameters,
};

impl Presets for WojewodaParameters {
    /// Levels, Stribeck velocity, stiffness and viscous friction of table 4.13; the lower branch is
    /// flat.
    fn test_bed() -> Self {
        let k_t = 0.0994 * core::f64::consts::FRAC_PI_2 / 0.006;
        Self { f_s: 0.0994, f_c: 0.0925, f_d: None, v_s: 0.1407, k_t, a_0: None, f_v: 0.0403 }
    }
    /// Levels, Stribeck velocity and stiffness (2356 N/m) of the proposed model; the lower branch
    /// is flat.
    fn chapter_3() -> Self {
        let k_t = 1.5 * core::f64::consts::FRAC_PI_2 / 0.001;
        Self { f_s: 1.5, f_c: 1.0, f_d: None, v_s: 0.01, k_t, a_0: None, f_v: 0.0 }
    }
}

impl Presets for ArmstrongParameters {
    /// Levels, stiffness and viscous friction of table 4.13, the lag of table 4.8; the dwell of one
    /// second is chosen.
    fn test_bed() -> Self {
        let k_t = 0.0994 * core::f64::consts::FRAC_PI_2 / 0.006;
        Self { f_s: 0.0994, f_c: 0.0925, v_s: 0.1407, k_t, tau_l: 0.0111, gamma: 1.0, f_v: 0.0403 }
    }
    /// Levels, stiffness (2356 N/m) and lag of the proposed model; the dwell of one second is
    /// chosen.
    fn chapter_3() -> Self {
        let k_t = 1.5 * core::f64::consts::FRAC_PI_2 / 0.001;
        Self { f_s: 1.5, f_c: 1.0, v_s: 0.01, k_t, tau_l: 0.002, gamma: 1.0, f_v: 0.0 }
    }
}

impl Presets for BristleParameters {
    /// Kinetic level, stiffness from rest and viscous friction of table 4.13. The static level
    /// follows: 1.159 of the kinetic one.
    fn test_bed() -> Self {
        Self::from_levels(100, 0.0925, 0.0994 * core::f64::consts::FRAC_PI_2 / 0.006, 0.0403)
    }
    /// Kinetic level and stiffness (2356 N/m, from rest) of the proposed model.
    fn chapter_3() -> Self {
        Self::from_levels(100, 1.0, 1.5 * core::f64::consts::FRAC_PI_2 / 0.001, 0.0)
    }
}

impl Presets for ResetIntegratorParameters {
    /// Levels, stiffness, damping and viscous friction of table 4.13.
    fn test_bed() -> Self {
        Self::from_levels(
            0.0994,
            0.0925,
            0.0994 * core::f64::consts::FRAC_PI_2 / 0.006,
            0.3213,
            0.0403,
        )
    }
    /// Levels and stiffness (2356 N/m) of the proposed model; the damping is the root of the
    /// stiffness, as LuGre's is there.
    fn chapter_3() -> Self {
        Self::from_levels(1.5, 1.0, 1.5 * core::f64::consts::FRAC_PI_2 / 0.001, 48.54, 0.0)
    }
}

impl Presets for DahlParameters {
    /// Level and stiffness of LuGre's Table 4.14.
    fn test_bed() -> Self {
        Self { f_c: 0.0929, sigma0: 16.469, delta: 1.0, f_v: 0.0403 }
    }
    fn chapter_3() -> Self {
        Self { f_c: 1.0, sigma0: 1e5, delta: 1.0, f_v: 0.0 }
    }
}

impl Presets for BlimanSorineParameters {
    /// Levels, stiffness and viscous friction of table 4.13.
    fn test_bed() -> Self {
        Self::from_levels(0.0994, 0.0925, 0.0994 * core::f64::consts::FRAC_PI_2 / 0.006, 0.0403)
    }
    /// Levels and stiffness (2356 N/m) of the proposed model.
    fn chapter_3() -> Self {
        Self::from_levels(1.5, 1.0, 1.5 * core::f64::consts::FRAC_PI_2 / 0.001, 0.0)
    }
}

impl Presets for LuGreParameters {
    /// Table 4.14 with the consistent sigma_1.
    fn test_bed() -> Self {
        Self {
            f_s: 0.0994,
            f_c: 0.0929,
            v_s: 0.1407,
            delta: 2.0,
            sigma0: 16.469,
            sigma1: 0.2494,
            v_d: None,
            f_v: 0.0403,
        }
    }
    fn chapter_3() -> Self {
        let sigma1 = 1e5f64.sqrt();
        Self { f_s: 1.5, f_c: 1.0, v_s: 0.01, delta: 2.0, sigma0: 1e5, sigma1, v_d: None, f_v: 0.0 }
    }
}

impl Presets for ElastoPlasticParameters {
    /// LuGre's Table 4.14 with `z_ba = 0.7 F_c / sigma0`.
    fn test_bed() -> Self {
        Self {
            f_s: 0.0994,
            f_c: 0.0929,
            v_s: 0.1407,
            delta: 2.0,
            sigma0: 16.469,
            sigma1: 0.2494,
            z_ba: 0.7 * 0.0929 / 16.469,
            f_v: 0.0403,
        }
    }
    fn chapter_3() -> Self {
        let sigma1 = 1e5f64.sqrt();
        Self {
            f_s: 1.5,
            f_c: 1.0,
            v_s: 0.01,
            delta: 2.0,
            sigma0: 1e5,
            sigma1,
            z_ba: 0.7e-5,
            f_v: 0.0,
        }
    }
}

impl Presets for LeuvenParameters {
    /// The virgin curve and levels of the proposed model's Table 4.13.
    fn test_bed() -> Self {
        Self {
            f_s: 0.0994,
            f_c: 0.0925,
            v_s: 0.1407,
            delta: 2.0,
            f_h: 0.0994,
            z_b: 0.006,
            n: 2.0,
            sigma1: 0.3213,
            f_v: 0.0403,
        }
    }
    fn chapter_3() -> Self {
        let sigma1 = 1e5f64.sqrt();
        Self {
            f_s: 1.5,
            f_c: 1.0,
            v_s: 0.01,
            delta: 2.0,
            f_h: 1.5,
            z_b: 0.001,
            n: 2.0,
            sigma1,
            f_v: 0.0,
        }
    }
}

impl Presets for GmsParameters {
    /// Table 4.15, shares made to sum to 1, with the viscous coefficient of the other models.
    fn test_bed() -> Self {
        let sum = 0.2841 + 3.0 * 0.2341;
        Self {
            f_s: 0.1035,
            f_c: 0.0921,
            v_s: 0.1,
            delta: 2.0,
            alpha: [0.2841, 0.2341, 0.2341, 0.2341].map(|share| share / sum).into(),
            sigma0: [7.9605, 4.8757, 2.6039, 1.0290].into(),
            sigma1: [0.1611, 0.1173, 0.0749, 0.0321].into(),
            c: [0.2998; 4].into(),
            f_v: 0.0403,
        }
    }

    /// Ten elements.
    fn chapter_3() -> Self {
        let alpha = |i| 0.0955 + 0.001 * i as f64;
        Self {
            f_s: 1.5,
            f_c: 1.0,
            v_s: 0.01,
            delta: 2.0,
            alpha: Elements::from_fn(10, alpha),
            sigma0: Elements::from_fn(10, |i| 10.0 + 8.0 * i as f64),
            sigma1: Elements::from_fn(10, |i| 10.0 + 5.0 * i as f64),
            c: Elements::from_fn(10, |i| 0.1 * alpha(i)),
            f_v: 0.0,
        }
    }
}

impl Presets for XiongParameters {
    /// Table 4.16 with the consistent `F_s`, `lambda_4` and `f_v`.
    fn test_bed() -> Self {
        let sum = 3.0 * 0.2998 + 0.1005;
        Self {
            f_s: 0.10057,
            f_c: 0.0924,
            v_s: 0.13121,
            delta: 2.0,
            tau: 0.0124,
            lambda: [0.2998, 0.2998, 0.2998, 0.1005].map(|share| share / sum).into(),
            k: [10.9915, 2.7836, 1.9866, 0.7792].into(),
            sigma: [0.1964, 0.0788, 0.0603, 0.0227].into(),
            f_v: 0.0403,
        }
    }

    /// Ten elements.
    fn chapter_3() -> Self {
        Self {
            f_s: 1.5,
            f_c: 1.0,
            v_s: 0.01,
            delta: 2.0,
            tau: 0.002,
            lambda: Elements::from_fn(10, |i| 0.0955 + 0.001 * i as f64),
            k: Elements::from_fn(10, |i| 1000.0 + 800.0 * i as f64),
            sigma: Elements::from_fn(10, |i| 5.0 + 2.5 * i as f64),
            f_v: 0.0,
        }
    }
}

impl Presets for ProposedParameters {
    /// Table 4.13 with the consistent sigma.
    fn test_bed() -> Self {
        Self {
            f_s: 0.0994,
            f_c: 0.0925,
            v_s: 0.1407,
            delta: 2.0,
            sigma: 0.3213,
            tau: 0.0011,
            z_b: 0.006,
            f_v: 0.0403,
        }
    }
    fn chapter_3() -> Self {
        let sigma = 1e5f64.sqrt();
        Self { f_s: 1.5, f_c: 1.0, v_s: 0.01, delta: 2.0, sigma, tau: 0.002, z_b: 0.001, f_v: 0.0 }
    }
}
