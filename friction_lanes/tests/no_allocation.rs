//! Nothing on the step path allocates: a longer motion takes no more of the allocator.

use allocation_counter::measure;
use friction_lanes::forces;
use friction_model::{AnyModel, ModelName, Scheme, TimeStep};

#[test]
fn a_longer_motion_allocates_no_more() {
    let dt = TimeStep::new(1e-3).unwrap();
    // Trains of ever smaller swings: more reversals than a hysteresis can remember.
    let velocity: Vec<f64> = (0..5000)
        .map(|k| {
            let sign = if k % 2 == 0 { 1.0 } else { -1.0 };
            sign * 2.0 * 0.99f64.powf(f64::from(k % 1000))
        })
        .collect();
    for name in [ModelName::LuGre, ModelName::Gms, ModelName::Xiong, ModelName::Proposed] {
        let models = [AnyModel::test_bed(name); 20];
        let mut rows = vec![0.0; models.len() * velocity.len()];
        for scheme in [Scheme::Held, Scheme::Mean] {
            let mut count = |samples: usize| {
                let velocity = &velocity[..samples];
                measure(|| forces(&models, velocity, (dt, scheme), &mut rows, || false)).count_total
            };
            assert_eq!(count(5000), count(10), "{name}");
        }
    }
}
