//! After creation nothing allocates: over all models, in every call that may be made in real time.

// It calls what C calls.
#![allow(unsafe_code)]

use std::ffi::CString;
use std::ptr::{null, null_mut};

use allocation_counter::measure;
use friction::*;
use friction_model::{AnyParameters, ModelName};

/// A model's parameters of the test bed, as C hands them over.
fn values(name: ModelName) -> Vec<(CString, f64)> {
    let parameters = AnyParameters::test_bed(name);
    let rows = parameters.table().iter();
    rows.flat_map(|row| parameters.values(row.name).into_iter().map(|value| (row.name, value)))
        .map(|(name, value)| (CString::new(name).unwrap(), value))
        .collect()
}

#[test]
fn no_call_after_creation_allocates() {
    for name in ModelName::ALL {
        let of = CString::new(name.as_str()).unwrap();
        let values = values(name);
        let values: Vec<FrictionValue> = values
            .iter()
            .map(|(name, value)| FrictionValue { name: name.as_ptr(), value: *value })
            .collect();
        let (mut model, mut observer, mut other) = (null_mut(), null_mut(), null_mut());
        let (first, count) = (values.as_ptr(), values.len());
        // SAFETY: texts and values live to the end of the loop, places are what their types say.
        unsafe {
            let of = of.as_ptr();
            let made =
                friction_model_create(of, first, count, 1e-3, 1, null_mut(), 0, &raw mut model);
            assert_eq!(made, FrictionCode::Ok, "{name}");
            for into in [&raw mut observer, &raw mut other] {
                let made = friction_observer_create(of, first, count, 1e-3, 0, null_mut(), 0, into);
                assert_eq!(made, FrictionCode::Ok, "{name}");
            }
            let counted = measure(|| {
                for k in 0..500 {
                    let velocity =
                        if k % 101 == 100 { f64::NAN } else { (0.05 * f64::from(k)).sin() };
                    let (mut friction, mut state) = (1.0, std::mem::zeroed());
                    let mut estimate = std::mem::zeroed();
                    let now = FrictionSeen { velocity, ..std::mem::zeroed() };
                    let codes = [
                        friction_model_step(model, velocity, &raw mut friction),
                        friction_model_state(model, velocity, &raw mut state),
                        friction_model_steady_state(model, velocity, &raw mut friction),
                        friction_observer_step(observer, &raw const now, &raw mut estimate),
                    ];
                    let expected =
                        if velocity.is_nan() { FrictionCode::NotFinite } else { FrictionCode::Ok };
                    assert_eq!(codes, [expected; 4], "{name}");
                    if k == 250 {
                        assert_eq!(friction_observer_change(observer, other), FrictionCode::Ok);
                    }
                }
                assert_eq!(friction_model_reset(model), FrictionCode::Ok);
                assert_eq!(friction_observer_reset(observer), FrictionCode::Ok);
                assert_eq!(friction_observer_period(observer), 1e-3);
                assert_ne!(friction_observer_model(observer), null());
            });
            assert_eq!(counted.count_total, 0, "{name}");
            friction_model_free(model);
            friction_observer_free(observer);
            friction_observer_free(other);
        }
    }
}
