//! Three models under the same experiments: which sticks and slips, which creeps away under a small
//! oscillating load, and whose inner loops close.

use friction_features::{
    Contact, NonDriftSettings, NonLocalMemorySettings, StickSlipSettings, non_drift,
    non_local_memory, stick_slip,
};
use friction_model::{AnyModel, ModelName};

fn main() {
    for name in [ModelName::Dahl, ModelName::LuGre, ModelName::Proposed] {
        let contact = Contact::new(&AnyModel::chapter_3(name));
        let pulled = stick_slip(&contact, &StickSlipSettings::default());
        let shaken = non_drift(&contact, &NonDriftSettings::default());
        let loops = non_local_memory(&contact, &NonLocalMemorySettings::chapter_3(name));
        println!(
            "{:10} {:?}, {:.2e} m of drift a cycle",
            contact.name(),
            pulled.motion,
            shaken.drift_per_cycle
        );
        // A model that has no memory of its own says so.
        if let Some(loops) = loops {
            println!("{:10} inner loop open by {:.2} %", "", 100.0 * loops.closure_gap);
        }
        // The proposed model is made so that it does not drift.
        assert_eq!(shaken.drift_per_cycle.abs() < 1e-9, name == ModelName::Proposed);
    }
}

#[test]
fn it_runs() {
    main();
}
