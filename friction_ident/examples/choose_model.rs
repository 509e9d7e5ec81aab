//! Which friction model? Each is identified from one recording and tried on another, which it has
//! not seen: what predicts best there is kept, and what cannot be told from it is named.
//!
//! `cargo run -p friction_ident --example choose_model`

use std::ops::ControlFlow;

use friction_ident::output_error::predict;
use friction_ident::staged::{difference, residuals};
use friction_ident::statistics::root_mean_square;
use friction_ident::{FrictionData, IdentError, StagedOptions, Stretch, identify_model};
use friction_model::{AnyModel, AnyParameters, LuGreParameters, ModelName};

/// Sampling period \[s\].
const TIME_STEP: f64 = 1e-3;

/// Friction along a velocity \[rad/s\], as a recording would have it.
fn record(
    contact: &AnyModel,
    seconds: f64,
    velocity: fn(f64) -> f64,
) -> Result<Stretch, IdentError> {
    let samples = (seconds / TIME_STEP) as usize;
    let velocity: Vec<f64> = (0..samples).map(|k| velocity(k as f64 * TIME_STEP)).collect();
    let mut stretch = Stretch::new(TIME_STEP, velocity, None, vec![0.0; samples])?;
    stretch.friction = predict(contact, &stretch);
    // A torque sensor that resolves 0.5 mN m.
    stretch.friction.iter_mut().for_each(|torque| *torque = (*torque / 5e-4).round() * 5e-4);
    Ok(stretch)
}

/// Slow and fast motion, and reversals: what a model is told apart by.
fn recordings(
    contact: &AnyModel,
    motions: [fn(f64) -> f64; 2],
) -> Result<FrictionData, IdentError> {
    let steady = [0.03, 0.06, 0.1, 0.15, 0.2, 0.4, 0.8, 1.5]
        .into_iter()
        .flat_map(|speed| [speed, -speed])
        .map(|velocity| friction_ident::SteadyPoint::new(velocity, contact.steady_state(velocity)))
        .collect();
    let stretches = motions
        .into_iter()
        .map(|motion| record(contact, 6.0, motion))
        .collect::<Result<Vec<_>, _>>()?;
    // Bristles bend by about 0.006 rad here: motion within that is pre-sliding.
    Ok(FrictionData::sort(steady, stretches, Some(0.006)))
}

/// Ranks three models.
///
/// # Errors
/// [`IdentError`] says what the recordings lack.
pub fn main() -> Result<(), IdentError> {
    // The friction that nobody knows.
    let contact: AnyModel = AnyParameters::LuGre(LuGreParameters {
        f_s: 0.0994,
        f_c: 0.0925,
        v_s: 0.14,
        delta: 2.0,
        sigma0: 16.0,
        sigma1: 0.2,
        v_d: None,
        f_v: 0.04,
    })
    .try_into()?;
    let known = recordings(
        &contact,
        [
            |t| 0.01 * (5.0 * t).cos() + 0.008 * (2.0 * t).cos(),
            |t| 0.4 * (1.3 * t).sin() * (0.4 * t).cos(),
        ],
    )?;
    let unseen = recordings(
        &contact,
        [
            |t| 0.012 * (4.0 * t).cos() + 0.004 * (1.5 * t).cos(),
            |t| 0.3 * (0.9 * t).sin() + 0.05 * (7.0 * t).sin(),
        ],
    )?;

    let mut tried = Vec::new();
    for name in [ModelName::Stribeck, ModelName::Dahl, ModelName::LuGre] {
        let go = &mut |_, _: &_| ControlFlow::Continue(());
        let found = identify_model(name, &known, &StagedOptions::default(), go)?;
        let error = root_mean_square(&residuals(&found.predictor(), &unseen));
        tried.push((name, found.predictor(), error));
    }
    tried.sort_by(|a, b| a.2.total_cmp(&b.2));
    let best = tried[0].1;
    for (name, predictor, error) in &tried {
        let behind = difference(predictor, &best, &unseen);
        let note = if behind.is_tie() { "best, or not to be told from it" } else { "worse" };
        println!("{:<10} {:5.2} mN m on what it has not seen: {note}", name.as_str(), 1e3 * error);
    }
    assert_eq!(tried[0].0, ModelName::LuGre);
    Ok(())
}
