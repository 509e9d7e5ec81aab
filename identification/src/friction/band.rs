//! Where a fitted steady-state curve lies: its 95 % band from the covariance of the parameters.

use friction_ident::free_parameters::FreeParameters;
use friction_ident::statistics::student_95;
use friction_ident::{Estimates, Identified, ParameterId, Side};
use friction_model::{AnyModel, AnyParameters};

/// The half width of the band of the friction at each of `velocities` [N or N m]; none where the
/// fit has no covariance of what matters there.
pub fn half_widths(found: &Identified, velocities: &[f64]) -> Option<Vec<f64>> {
    let estimates = covering(found)?;
    let free = FreeParameters::new(&found.model, |_| true);
    let places: Vec<(usize, ParameterId)> = estimates
        .parameters
        .iter()
        .map(|estimate| estimate.id)
        .enumerate()
        .filter(|(_, id)| free.ids().contains(id))
        .collect();
    let factor = student_95(estimates.degrees_of_freedom);
    let half = |&velocity: &f64| {
        let gradient: Vec<(usize, f64)> =
            places.iter().map(|&(row, id)| (row, slope(&found.model, id, velocity))).collect();
        let variance: f64 = gradient
            .iter()
            .flat_map(|(i, a)| gradient.iter().map(move |(j, b)| (i, j, a * b)))
            .map(|(i, j, product)| {
                product
                    * estimates
                        .covariance
                        .get(*i)
                        .and_then(|row| row.get(*j))
                        .copied()
                        .unwrap_or(0.0)
            })
            .sum();
        factor * variance.max(0.0).sqrt()
    };
    Some(velocities.iter().map(half).collect())
}

/// The last stage that estimated the level.
fn covering(found: &Identified) -> Option<&Estimates> {
    let has_level = |estimates: &&Estimates| {
        estimates.parameters.iter().any(|p| p.id.name == "f_c" && p.standard_error.is_some())
    };
    found.stages.iter().rev().map(|stage| &stage.estimates).find(has_level)
}

/// Derivative of the steady state with respect to one parameter.
fn slope(model: &AnyModel, id: ParameterId, velocity: f64) -> f64 {
    let value = |parameters: &AnyParameters| parameters.values(id.name).get(id.index()).copied();
    let moved = |up: f64| -> Option<(f64, f64)> {
        let (mut forward, mut backward) = model.parameters().sides();
        let side = if id.side == Side::Backward { &mut backward } else { &mut forward };
        let x = value(side)?;
        let x = x + up * 1e-5 * x.abs().max(1e-9);
        side.set_at(id.name, id.index(), x);
        let model: AnyModel = match id.side {
            Side::Both => forward.try_into().ok()?,
            _ => AnyParameters::asymmetric(forward, backward).ok()?.try_into().ok()?,
        };
        Some((x, model.steady_state(velocity)))
    };
    // At a limit of what the model accepts, as f_s = f_c, only one side exists.
    let own = moved(0.0);
    match (moved(1.0).or(own), moved(-1.0).or(own)) {
        (Some((x1, y1)), Some((x0, y0))) if x1 != x0 => (y1 - y0) / (x1 - x0),
        _ => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;

    use friction_ident::{
        FrictionData, StagedOptions, SteadyPoint, StribeckOptions, fit_stribeck, identify_model,
    };
    use friction_model::ModelName;

    use super::*;

    /// The same band as the one in closed form of the static curve.
    #[test]
    fn the_band_is_that_of_the_static_curve() {
        let truth = AnyModel::test_bed(ModelName::Stribeck);
        let points: Vec<SteadyPoint> = (1..60)
            .map(|i| 0.03 * f64::from(i))
            .map(|v| SteadyPoint::new(v, truth.steady_state(v) + 2e-4 * (1e4 * v).sin()))
            .collect();
        let fit = fit_stribeck(&points, &StribeckOptions::default()).unwrap();
        let data = FrictionData { points, ..FrictionData::default() };
        let go = &mut |_, _: &_| ControlFlow::Continue(());
        let found =
            identify_model(ModelName::Stribeck, &data, &StagedOptions::default(), go).unwrap();
        let velocities = [0.05, 0.1, 0.2, 0.5, 1.5];
        let halves = half_widths(&found, &velocities).unwrap();
        for (v, half) in velocities.into_iter().zip(halves) {
            let (low, high) = fit.band(v);
            // The covariance of the staged fit counts neighbours that are alike; the shape of the
            // band is the same.
            let ratio = half / (0.5 * (high - low));
            assert!((0.5..2.0).contains(&ratio), "{ratio} at {v}");
        }
    }
}
