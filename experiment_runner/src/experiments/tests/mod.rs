//! Every experiment on the simulated rig: what it finds, how it ends, how it goes on.

mod characterisation;
mod compensation;
mod provenance;
mod resume;
mod supervision;

use super::*;

/// Every file that is part of the program describes its own experiment, and is read by it.
#[test]
fn every_shipped_protocol_is_that_of_its_experiment() {
    let mut with_protocol = 0;
    for experiment in all() {
        let Some(text) = experiment.protocol() else { continue };
        assert_eq!(of_protocol(text).unwrap().name(), experiment.name());
        assert!(experiment.read(text).is_ok(), "{}", experiment.name());
        with_protocol += 1;
    }
    assert_eq!(with_protocol, 7);
}

#[test]
fn names_are_told_apart_and_unknown_ones_are_named_with_the_known() {
    let names: Vec<_> = selections().iter().map(Selection::as_str).collect();
    let mut unique = names.clone();
    unique.sort_unstable();
    unique.dedup();
    assert_eq!(unique.len(), names.len(), "{names:?}");
    let said = of_protocol("experiment: dance\n").unwrap_err().to_string();
    assert!(said.contains("dance") && said.contains("pre-sliding"), "{said}");
}
