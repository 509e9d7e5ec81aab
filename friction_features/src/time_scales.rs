//! How fast a contact can change, and with that the step that its integration starts with.
//!
//! A Runge-Kutta step must be shorter than 2.78 times the shortest time constant, and a fraction of
//! it to be accurate. LuGre with stiff bristles is the warning: just beyond the limit it does not
//! blow up, it gives a wrong period of stick-slip. So the time constants are taken from the model
//! itself, and [`crate::settle`] then halves the step until the figures hold.
//!
//! Stiffness `k` and damping `d` are measured, not looked up: the force's slope along an
//! infinitesimal motion from rest, and its ratio to the velocity at the motion's start. So the rule
//! needs no list of models and their parameters' names:
//!
//! | time constant | what relaxes with it |
//! |---|---|
//! | `d / k` | bristles that slip, where the model has a parameter `sigma` (Xiong and the proposed model) |
//! | `g_min / (k v_max)` | bristles that slide in all other models, LuGre's `g / (sigma0 abs(v))` |
//! | `m / d` | velocity of the body against the damping of its bristles |
//! | `sqrt(m / k)` | oscillation of the body on its bristles, divided by 2 pi |
//! | `tau` | sliding level, where the model has a parameter of that name |

use crate::Contact;

/// Velocity \[m/s or rad/s\] and duration \[s\] of the infinitesimal motion: a deflection of 1e-15,
/// far below every breakaway.
const PROBE: (f64, f64) = (1e-9, 1e-6);

/// No time constant counts as shorter than this \[s\]: an experiment of a minute would take too
/// many steps. Where that is too long for a model, the evidence says that its figures do not hold.
const SHORTEST: f64 = 1e-6;

/// The quantities that make up a contact's time constants.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TimeScales {
    /// Stiffness of the bristles at rest \[N/m or N m/rad\]; zero for models without pre-sliding.
    pub stiffness: f64,
    /// Damping of the bristles at rest, with the viscous part \[N s/m or N m s/rad\].
    pub damping: f64,
    /// Largest level at which the contact slides without its viscous part, or holds, F_s
    /// \[N or N m\].
    pub highest_level: f64,
    /// Smallest level at which it slides at higher speeds than where it is largest, F_c \[N or N
    /// m\].
    pub lowest_level: f64,
    /// Time constant of the sliding level \[s\]; infinite where there is none.
    pub lag: f64,
    /// Time constant of slipping bristles \[s\]; infinite where there is none.
    pub slip: f64,
}

impl TimeScales {
    /// Measures `contact`, in the direction in which it is stiffer.
    #[must_use]
    pub fn of(contact: &Contact) -> Self {
        let (velocity, duration) = PROBE;
        let (mut stiffness, mut damping) = (0.0f64, 0.0f64);
        if contact.holding(0.0).is_none() {
            for v in [velocity, -velocity] {
                let mut motion = contact.prescribed();
                let start = motion.force(v);
                let end = motion.step([v; 3], duration);
                stiffness = stiffness.max((end - start) / (v * duration));
                damping = damping.max(start / v);
            }
        }
        let (mut highest, mut lowest) = (0.0f64, f64::INFINITY);
        for direction in [1.0, -1.0] {
            let (mut top, mut after) = (0.0, f64::INFINITY);
            // Forty speeds a decade from 1e-9 to 1e3.
            for k in -360..=120 {
                let v = direction * 10f64.powf(f64::from(k) / 40.0);
                let level = (contact.steady_state(v) - contact.viscous(v)).abs();
                if level > top {
                    (top, after) = (level, level);
                }
                after = after.min(level);
            }
            (highest, lowest) = (highest.max(top), lowest.min(after));
        }
        // A contact without friction but viscous has the level zero.
        let lowest = if lowest.is_finite() { lowest } else { 0.0 };
        let held =
            contact.holding(0.0).map_or(0.0, |holding| holding.forward.max(holding.backward));
        let highest = highest.max(held);
        let lag = contact.shortest_lag();
        let slip =
            if contact.slips() && stiffness > 0.0 { damping / stiffness } else { f64::INFINITY };
        Self { stiffness, damping, highest_level: highest, lowest_level: lowest, lag, slip }
    }

    /// Shortest time constant, at least 1 us, under a prescribed velocity of at most `speed`
    /// \[m/s or rad/s\]; infinite for static models.
    #[must_use]
    pub fn prescribed(&self, speed: f64) -> f64 {
        let slips = self.slip < f64::INFINITY;
        let bristles = if !slips && self.stiffness > 0.0 && self.lowest_level > 0.0 {
            self.lowest_level / (self.stiffness * speed)
        } else {
            self.slip
        };
        bristles.min(self.lag).max(SHORTEST)
    }

    /// Shortest time constant, at least 1 us, of a body of `inertia` \[kg or kg m^2\] that moves at
    /// most at `speed` \[m/s or rad/s\].
    #[must_use]
    pub fn body(&self, inertia: f64, speed: f64) -> f64 {
        let damped = if self.damping > 0.0 { inertia / self.damping } else { f64::INFINITY };
        let swinging =
            if self.stiffness > 0.0 { (inertia / self.stiffness).sqrt() } else { f64::INFINITY };
        self.prescribed(speed).min(damped).min(swinging).max(SHORTEST)
    }
}

#[cfg(test)]
mod tests {
    use friction_model::{AnyModel, AnyParameters, ModelName};

    use super::*;

    fn chapter_3(name: ModelName) -> TimeScales {
        TimeScales::of(&Contact::new(&AnyModel::chapter_3(name)))
    }

    fn close(a: f64, b: f64) -> bool {
        (a - b).abs() <= 1e-6 * b.abs()
    }

    #[test]
    fn stiffness_damping_and_levels_are_those_of_the_parameters() {
        let sigma = 1e5f64.sqrt();
        let lugre = chapter_3(ModelName::LuGre);
        assert!(close(lugre.stiffness, 1e5) && close(lugre.damping, sigma), "{lugre:?}");
        assert!(close(lugre.highest_level, 1.5) && close(lugre.lowest_level, 1.0), "{lugre:?}");
        // dt < 2.78 g / (s0 |v|): at 0.487 m/s 5.7e-5 s.
        assert!(close(2.78 * lugre.body(1.0, 0.487), 2.78 / (1e5 * 0.487)), "{lugre:?}");

        let proposed = chapter_3(ModelName::Proposed);
        let k = 1.5 * std::f64::consts::PI / 0.002;
        assert!(close(proposed.stiffness, k) && close(proposed.damping, sigma), "{proposed:?}");
        assert!(close(proposed.slip, sigma / k) && proposed.lag == 0.002, "{proposed:?}");
        // dt < 2.78 m / sigma while it hardly moves, were it not for tau: 2 ms are shorter than 3.2
        // ms.
        assert_eq!(proposed.body(1.0, 1e-3), 0.002);
        assert!(close(proposed.body(0.1, 1e-3), 0.1 / sigma));
    }

    #[test]
    fn extremely_stiff_bristles_do_not_take_for_ever() {
        let mut parameters = AnyParameters::chapter_3(ModelName::Proposed);
        assert!(parameters.set("sigma", 1e-6) && parameters.set("z_b", 1e-9));
        let contact = Contact::new(&AnyModel::try_from(parameters).unwrap());
        assert_eq!(TimeScales::of(&contact).body(1.0, 0.5), 1e-6);
    }

    #[test]
    fn levels_are_found_where_they_are() {
        // The static level of stiction is one at rest alone; Karnopp's band and Bengisu and Akay's
        // curve start from zero.
        for name in [ModelName::Stiction, ModelName::Karnopp, ModelName::BengisuAkay] {
            let scales = chapter_3(name);
            assert!((scales.highest_level - 1.5).abs() < 1e-4, "{name}: {scales:?}");
            assert!((scales.lowest_level - 1.0).abs() < 1e-3, "{name}: {scales:?}");
        }
    }

    #[test]
    fn static_models_have_no_time_constants_but_their_viscosity() {
        for name in [ModelName::Coulomb, ModelName::Stribeck] {
            assert_eq!(chapter_3(name).body(1.0, 1.0), f64::INFINITY, "{name}");
        }
        let viscous = chapter_3(ModelName::Viscous);
        assert_eq!((viscous.stiffness, viscous.highest_level), (0.0, 0.0));
        let f_v = AnyModel::chapter_3(ModelName::Viscous).parameter("f_v").unwrap();
        assert!(close(viscous.body(2.0, 1.0), 2.0 / f_v));
    }
}
