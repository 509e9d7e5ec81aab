//! Some viscous friction to begin a search with.

use friction_model::{AnyModel, AnyParameters};

use crate::output_error::Measured;

/// Share of the largest friction that viscous friction has at the fastest motion, at least, where a
/// search begins. From none at all it would begin with a bound of one newton second per metre, which
/// is nothing to a stage that has thirty of them.
const SOME: f64 = 1e-3;

/// The model with some viscous friction to begin with, in the units of these recordings.
pub(super) fn with_some_viscosity(model: &AnyModel, measured: &Measured) -> AnyModel {
    let stretches = measured.stretches.iter();
    let forces = stretches.clone().flat_map(|stretch| &stretch.friction);
    let forces = forces.copied().chain(measured.points.iter().map(|point| point.torque));
    let speeds = stretches.flat_map(|stretch| &stretch.velocity);
    let speeds = speeds.copied().chain(measured.points.iter().map(|point| point.velocity));
    let largest = |values: &mut dyn Iterator<Item = f64>| values.map(f64::abs).fold(0.0, f64::max);
    let (force, fastest) = (largest(&mut { forces }), largest(&mut { speeds }));
    let least = SOME * force / fastest;
    if !(fastest > 0.0 && least.is_finite()) {
        return *model;
    }
    let with = |mut side: AnyParameters| {
        if side.values("f_v").first().is_some_and(|f_v| *f_v < least) {
            side.set("f_v", least);
        }
        side
    };
    let parameters = model.parameters();
    let (forward, backward) = parameters.sides();
    parameters.with_sides(with(forward), with(backward)).unwrap_or(*model)
}

#[cfg(test)]
mod tests {
    use friction_model::ModelName;

    use super::*;
    use crate::steady_point::SteadyPoint;

    /// In newton seconds per metre a stage of 300 N at 0.1 m/s may have hundreds; a search from zero
    /// had a bound of one.
    #[test]
    fn it_is_as_large_as_the_recordings_are_and_never_less_than_it_was() {
        let points: Vec<SteadyPoint> =
            [-0.1, 0.05, 0.1].map(|v: f64| SteadyPoint::new(v, 300.0 * v.signum())).to_vec();
        let measured = Measured { points: &points, ..Measured::default() };
        let begun = |f_v: f64| {
            let mut parameters = AnyModel::test_bed(ModelName::CoulombViscous).parameters();
            assert!(parameters.set("f_v", f_v));
            let model: AnyModel = parameters.try_into().unwrap();
            with_some_viscosity(&model, &measured).parameter("f_v").unwrap()
        };
        assert!((begun(0.0) - 3.0).abs() < 1e-9, "{}", begun(0.0));
        assert_eq!(begun(50.0), 50.0);
    }
}
