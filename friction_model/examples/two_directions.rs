//! A gearbox: friction that differs between the two directions, and grows with the load.

use friction_model::{
    Asymmetric, FrictionModel, LoadDependent, ModelError, Proposed, ProposedParameters, TimeStep,
};

fn main() -> Result<(), ModelError> {
    let forward = Proposed::test_bed();
    let weaker = ProposedParameters { f_s: 0.07, f_c: 0.06, ..*forward.parameters() };
    let gear = Asymmetric { forward, backward: Proposed::try_from(weaker)? };

    // Its levels rise by half of themselves for each N m that it transmits.
    let mut contact = LoadDependent::new(gear, 0.5, TimeStep::new(1e-3)?)?;
    let mut settled = |velocity, load| (0..5000).fold(0.0, |_, _| contact.step(velocity, load));
    for load in [0.0, 1.0] {
        let (there, back) = (settled(2.0, load), settled(-2.0, load));
        println!("under {load} N m: {there:.4} N m forwards, {back:.4} N m backwards");
        let viscous = 0.0403 * 2.0;
        assert!((there - (0.0925 * (1.0 + 0.5 * load) + viscous)).abs() < 1e-6);
        assert!((back + 0.06 * (1.0 + 0.5 * load) + viscous).abs() < 1e-6);
    }
    Ok(())
}

#[test]
fn it_runs() -> Result<(), ModelError> {
    main()
}
