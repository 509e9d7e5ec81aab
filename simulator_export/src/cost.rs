//! What a conversion costs: the torque of the identified model and that of the target along one
//! trajectory.

use friction_model::{AnyModel, Scheme, TimeStep};

use crate::shown::Shown;
use crate::{Axis, Refusal, Speeds};

/// Steady speeds each way.
pub const STEADY: u32 = 24;
/// Swings of the second part.
const SWINGS: u32 = 3;
/// Period of a swing \[s\].
const PERIOD: f64 = 2.0;
/// Step along the swings \[s\].
const STEP: f64 = 1e-4;

/// How far the target's torque is from the identified one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Errors {
    /// Root mean square \[N m or N\].
    pub rms: f64,
    /// The largest \[N m or N\].
    pub worst: f64,
    /// The speed at which that is \[rad/s or m/s\].
    pub worst_at: f64,
}

impl Errors {
    fn of(pairs: impl Iterator<Item = (f64, f64)>) -> Self {
        let (mut sum, mut count, mut worst, mut worst_at) = (0.0, 0.0, 0.0, 0.0);
        for (velocity, error) in pairs {
            sum += error * error;
            count += 1.0;
            if error.abs() > worst {
                (worst, worst_at) = (error.abs(), velocity);
            }
        }
        Self { rms: (sum / f64::max(count, 1.0)).sqrt(), worst, worst_at }
    }
}

/// What a conversion costs over the identified range of speeds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cost {
    /// In steady sliding: [`STEADY`] speeds each way, even in their logarithm.
    pub sliding: Errors,
    /// Along three swings of the velocity with a period of 2 s and the highest speed as their peak,
    /// from rest.
    pub swings: Errors,
    /// The Coulomb level to which errors are compared \[N m or N\]; without one, the largest
    /// friction in the range.
    pub level: f64,
}

impl Cost {
    /// Plays the trajectory through both.
    ///
    /// # Errors
    /// [`Refusal::NotFinite`] where the identified model gives no number.
    pub fn of(own: &AnyModel, target: &AnyModel, speeds: &Speeds) -> Result<Self, Refusal> {
        let level = level(own, speeds)?;
        let steady = both_ways(speeds).map(|v| (v, target.steady_state(v) - own.steady_state(v)));
        let sliding = Errors::of(steady);
        let mut worst_number = Ok(());
        let swings =
            Errors::of(swings(own, target, speeds.high())?.inspect(|(velocity, error)| {
                if !error.is_finite() {
                    worst_number = Err(Refusal::NotFinite { velocity: *velocity });
                }
            }));
        worst_number?;
        Ok(Self { sliding, swings, level })
    }

    /// An error as a share of the Coulomb level \[%\].
    #[must_use]
    pub fn percent(&self, error: f64) -> f64 {
        100.0 * error / self.level
    }

    /// The trajectory and what came of it, a line each.
    #[must_use]
    pub fn told(&self, speeds: &Speeds, axis: Axis) -> [String; 2] {
        // A reversal is at no speed, but for rounding.
        let at = |speed: f64| if speed.abs() < 1e-9 * speeds.high() { 0.0 } else { speed };
        let one = |errors: &Errors| {
            let (effort, speed) = (axis.effort(), axis.speed());
            format!(
                "rms {} {effort} ({} % of the Coulomb level {} {effort}), worst {} {effort} ({} %) at {} {speed}",
                Shown(errors.rms),
                Shown(self.percent(errors.rms)),
                Shown(self.level),
                Shown(errors.worst),
                Shown(self.percent(errors.worst)),
                Shown(at(errors.worst_at)),
            )
        };
        let (low, high) = (Shown(speeds.lowest()), Shown(speeds.high()));
        let speed = axis.speed();
        [
            format!(
                "sliding steadily at {STEADY} speeds from {low} to {high} {speed}, both ways: {}",
                one(&self.sliding)
            ),
            format!(
                "along {SWINGS} swings of the velocity of {PERIOD} s with a peak of {high} {speed}, from rest: {}",
                one(&self.swings)
            ),
        ]
    }
}

/// Every steady speed, both ways.
pub(crate) fn both_ways(speeds: &Speeds) -> impl Iterator<Item = f64> {
    speeds.spread(STEADY).into_iter().flat_map(|v| [v, -v])
}

/// The friction's level without its viscous part at the highest speed, the mean of both ways; where
/// there is none, the largest friction. Friction that drives, and no number, are refused.
fn level(own: &AnyModel, speeds: &Speeds) -> Result<f64, Refusal> {
    let mut most: f64 = 0.0;
    for velocity in both_ways(speeds) {
        let friction = own.steady_state(velocity);
        if !friction.is_finite() {
            return Err(Refusal::NotFinite { velocity });
        }
        if friction * velocity < 0.0 {
            return Err(Refusal::Negative { velocity, friction });
        }
        most = most.max(friction.abs());
    }
    let stepper = own.start(TimeStep::new(STEP)?);
    let contact = |v: f64| (own.steady_state(v) - stepper.viscous(v)).abs();
    let level = 0.5 * (contact(speeds.high()) + contact(-speeds.high()));
    Ok(if level > 1e-6 * most { level } else { most.max(f64::MIN_POSITIVE) })
}

/// The target's torque less the identified one along the swings.
fn swings(
    own: &AnyModel,
    target: &AnyModel,
    peak: f64,
) -> Result<impl Iterator<Item = (f64, f64)>, Refusal> {
    let dt = TimeStep::new(STEP)?;
    let mut own = own.start_by(Scheme::Mean, dt);
    let mut target = target.start_by(Scheme::Mean, dt);
    let steps = (f64::from(SWINGS) * PERIOD / STEP).round() as u32;
    Ok((0..=steps).map(move |k| {
        let velocity = peak * (std::f64::consts::TAU * f64::from(k) * STEP / PERIOD).sin();
        (velocity, target.step(velocity) - own.step(velocity))
    }))
}

#[cfg(test)]
mod tests {
    use friction_model::{CoulombViscous, CoulombViscousParameters, ModelName};

    use super::*;
    use crate::SpeedsFrom;

    fn range() -> Speeds {
        Speeds::new(0.05, 3.0, SpeedsFrom::Asked).unwrap()
    }

    #[test]
    fn a_model_costs_nothing_against_itself() {
        for name in ModelName::ALL.into_iter().filter(|name| *name != ModelName::Bristle) {
            let model = AnyModel::test_bed(name);
            let cost = Cost::of(&model, &model, &range()).unwrap();
            assert_eq!((cost.sliding.rms, cost.swings.worst), (0.0, 0.0), "{name}");
            assert!(cost.level > 0.0, "{name}");
        }
    }

    #[test]
    fn a_wrong_level_costs_the_difference() {
        let of = |f_c, f_v| {
            let parameters = CoulombViscousParameters { f_c, f_v };
            AnyModel::CoulombViscous(CoulombViscous::try_from(parameters).unwrap())
        };
        let cost = Cost::of(&of(0.10, 0.04), &of(0.11, 0.04), &range()).unwrap();
        assert!((cost.sliding.rms - 0.01).abs() < 1e-12 && (cost.level - 0.1).abs() < 1e-12);
        assert!((cost.percent(cost.sliding.worst) - 10.0).abs() < 1e-9);
        let [steady, swings] = cost.told(&range(), Axis::Rotary);
        assert!(
            steady.contains("24 speeds from 0.05 to 3 rad/s") && steady.contains("(10 % of"),
            "{steady}"
        );
        assert!(swings.contains("3 swings"), "{swings}");
    }

    /// Presliding is lost: at a reversal the static contact is wrong by nearly twice the level.
    #[test]
    fn without_pre_sliding_reversals_cost() {
        let lugre = AnyModel::test_bed(ModelName::LuGre);
        let p = CoulombViscousParameters { f_c: 0.0925, f_v: 0.0403 };
        let flat = AnyModel::CoulombViscous(CoulombViscous::try_from(p).unwrap());
        let cost = Cost::of(&lugre, &flat, &range()).unwrap();
        assert!(cost.percent(cost.swings.worst) > 150.0, "{cost:?}");
        assert!(cost.percent(cost.sliding.worst) < 8.0, "{cost:?}");
    }
}
