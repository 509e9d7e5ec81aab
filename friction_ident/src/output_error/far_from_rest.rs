//! What sliding far from rest says by itself.
//!
//! Where a model lacks something near rest, what it leaves there is not all that it lacks: the level
//! and the slope of sliding have taken up part of it. Fitted to the faster half of the motion, with all
//! that acts near rest kept as it was found, they go where that wants them. How far that is, is by how
//! much what is missing may have moved them. A dip ends nowhere: just beyond the speeds at which it
//! shows it still takes most of what it took.

use crate::bounded::Minimum;
use crate::estimate::Estimates;
use crate::least_squares::solve;
use crate::near_rest::{LeftNearRest, NearRest};
use crate::parameter_id::ParameterId;
use crate::statistics::{quantile, sorted};

/// Parameters of sliding at speed, and of what acts beside friction. All others act near rest.
const FAR_FROM_REST: [&str; 6] = ["f_c", "f_v", "offset", "spring", "gravity_sin", "gravity_cos"];
/// Share of the largest usual speed from which sliding is fast, and the share of the rows that are
/// slower than that speed.
const FAST: f64 = 0.5;
const USUAL: f64 = 0.95;
/// Rows for each parameter that the fit needs.
const ROWS_EACH: usize = 10;
/// What to measure where that moves a parameter far.
const REMEDY: &str = "a model that has it, or motion that slides for longer at several speeds";

/// Whether a parameter describes sliding at speed, or what acts beside friction.
pub(super) fn is_far_from_rest(id: ParameterId) -> bool {
    FAR_FROM_REST.contains(&id.name)
}

/// Widens the intervals of the parameters of sliding to what the faster half says, beyond the way
/// along which something is `left`. `motion` has velocity, acceleration and way of every row.
pub(super) fn heed_sliding(
    minimum: &Minimum,
    motion: &[Vec<f64>],
    left: &LeftNearRest,
    estimates: &mut Estimates,
) {
    let (Some(velocity), Some(way)) = (motion.first(), motion.get(2)) else { return };
    let speed: Vec<f64> = velocity.iter().map(|v| v.abs()).collect();
    let Some(usual) = quantile(&sorted(speed.iter().copied()), USUAL) else { return };
    let along = if left.with == NearRest::Way { left.up_to } else { 0.0 };
    let beyond: Vec<usize> =
        (0..speed.len()).filter(|&k| speed[k] >= FAST * usual && way[k] >= along).collect();
    // One that a bound holds, such as a slope of zero under a dip, need not be there in this half.
    let acts = |j: usize| minimum.jacobian.column(j).norm_squared() > 0.0;
    let ids = estimates.parameters.iter().map(|estimate| estimate.id).enumerate();
    let free: Vec<usize> =
        ids.filter(|&(j, id)| is_far_from_rest(id) && acts(j)).map(|(j, _)| j).collect();
    if free.is_empty() || beyond.len() < ROWS_EACH * free.len() {
        return;
    }
    let jacobian = minimum.jacobian.select_columns(&free).select_rows(&beyond);
    let residuals = minimum.residuals.select_rows(&beyond);
    let Ok(moves) = solve(&jacobian, &residuals) else { return };
    for (&j, &moved) in free.iter().zip(&moves.x) {
        if let Some(estimate) = estimates.parameters.get_mut(j) {
            estimate.reach_around([estimate.value - moved], REMEDY);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;

    use friction_model::{AnyModel, AnyParameters, ModelName};
    use rand::{RngExt, SeedableRng};
    use rand_distr::StandardNormal;

    use crate::free_parameters::FreeParameters;
    use crate::output_error::{Measured, OutputErrorOptions, fit_output_error};
    use crate::stretch::Stretch;

    /// Friction with a broad dip, fitted by a model without one: the kinetic level came out a tenth
    /// too high, within 1 %.
    #[test]
    fn the_level_of_a_model_without_a_dip_reaches_to_what_sliding_at_speed_says() {
        let mut parameters = AnyParameters::test_bed(ModelName::Stribeck);
        for (name, value) in
            [("f_s", 1.6), ("f_c", 1.0), ("v_s", 0.1), ("delta", 2.0), ("f_v", 0.2)]
        {
            assert!(parameters.set(name, value));
        }
        let truth: AnyModel = parameters.try_into().unwrap();
        let mut rng = rand_pcg::Pcg64Mcg::seed_from_u64(3);
        let velocity: Vec<f64> = (0..20_000)
            .map(|k| (5e-3 * f64::from(k)).sin() * (0.7 + 0.3 * (3.1e-3 * f64::from(k)).cos()))
            .collect();
        let friction = velocity
            .iter()
            .map(|&v| truth.steady_state(v) + 0.02 * rng.sample::<f64, _>(StandardNormal))
            .collect();
        let stretch = Stretch::new(1e-3, velocity, None, friction).unwrap();
        let model = AnyModel::test_bed(ModelName::CoulombViscous);
        let free = FreeParameters::new(&model, |_| true);
        let data = Measured { stretches: std::slice::from_ref(&stretch), ..Measured::default() };
        let options = OutputErrorOptions::default();
        let found =
            fit_output_error(&free, &data, &[], &options, &mut |_| ControlFlow::Continue(()))
                .unwrap();
        assert!(found.left.is_some());
        let level = found.estimates.get("f_c").unwrap();
        assert!((level.value - 1.0).abs() > 0.05, "{level:?}");
        assert!(level.interval.unwrap().contains(1.0) && level.is_identified(), "{level:?}");
    }
}
