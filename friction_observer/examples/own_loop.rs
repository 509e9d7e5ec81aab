//! An observer in a loop of one's own: the LuGre model estimates the friction torque from the
//! measured velocity, once a millisecond.

use friction_model::{AnyModel, ModelName, TimeStep};
use friction_observer::{EstimatorOptions, FrictionEstimator, Seen};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let dt = TimeStep::new(1e-3)?;
    let model = AnyModel::test_bed(ModelName::LuGre);
    let mut estimator = FrictionEstimator::new(&model, EstimatorOptions::default(), dt)?;

    let mut torque = 0.0;
    for cycle in 0..2000 {
        let t = 1e-3 * f64::from(cycle);
        // Yours: what the sensors say, and what the controller wants.
        let (position, velocity) = (0.5 * t * t, t);
        let seen = Seen { position, velocity, reference_velocity: velocity, ..Seen::default() };
        torque = estimator.estimate(&seen).torque;
        if cycle % 500 == 0 {
            println!("{t:.1} s: {velocity:.2} rad/s, friction {torque:.4} N m");
        }
    }
    // Sliding steadily, the estimate is the model's steady friction, f_c + f_v v and a little.
    assert!((torque - model.steady_state(2.0)).abs() < 0.01);
    Ok(())
}

#[test]
fn it_runs() {
    main().unwrap();
}
