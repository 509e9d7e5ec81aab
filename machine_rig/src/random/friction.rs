//! Friction drawn at random: the thesis's test bed in other units.
//!
//! A friction model stays itself if forces, speeds and deflections are multiplied, each by a factor
//! of its own; times follow. So every model becomes that of another machine without losing what
//! makes it sound.

use friction_model::{AnyModel, AnyParameters, ModelName, Unit};

use super::{Draw, MODELS};

/// Sizes of the friction to be drawn.
pub(super) struct Scale {
    /// Kinetic level [N m].
    pub level: f64,
    /// Stribeck velocity [rad/s].
    pub speed: f64,
    /// Deflection before sliding \[rad\].
    pub deflection: f64,
    /// Viscous coefficient [N m s/rad].
    pub damping: f64,
    /// Static over kinetic level.
    pub static_over_kinetic: f64,
}

/// Sizes of the test bed's friction, of the thesis's table 4.13.
const LEVEL: f64 = 0.0925;
const SPEED: f64 = 0.1407;
const DEFLECTION: f64 = 0.006;

/// A model and its parameters.
pub(super) fn drawn(draw: &mut Draw, scale: &Scale) -> AnyModel {
    loop {
        let name = draw.some(&MODELS);
        // Not every shape suits every model.
        if let Some(model) = sized(draw, name, scale) {
            return model;
        }
    }
}

fn sized(draw: &mut Draw, name: ModelName, scale: &Scale) -> Option<AnyModel> {
    let mut parameters = AnyParameters::test_bed(name);
    let (force, speed) = (scale.level / LEVEL, scale.speed / SPEED);
    let deflection = scale.deflection / DEFLECTION;
    for row in parameters.table() {
        let factor = match row.unit {
            Unit::Force => force,
            Unit::Stiffness => force / deflection,
            Unit::Damping => force / speed,
            Unit::Deflection => deflection,
            Unit::Speed => speed,
            Unit::PerSpeed => 1.0 / speed,
            Unit::Acceleration => speed * speed / deflection,
            Unit::ForceRate => force * speed / deflection,
            Unit::Time => deflection / speed,
            Unit::None => 1.0,
        };
        parameters.scale(row.name, factor);
    }
    let plain = AnyModel::try_from(parameters).ok()?;
    let mut parameters = plain.parameters();
    if let Some(before) = plain.parameter("f_v").filter(|f_v| *f_v > 0.0) {
        parameters.scale("f_v", scale.damping / before);
    }
    if let (Some(f_s), Some(f_c)) = (plain.parameter("f_s"), plain.parameter("f_c")) {
        parameters.scale("f_s", scale.static_over_kinetic * f_c / f_s);
    }
    if plain.parameter("delta").is_some() && name == ModelName::Stribeck {
        let delta = draw.some(&[0.7, 1.0, 2.0]);
        parameters.scale("delta", delta / plain.parameter("delta")?);
    }
    AnyModel::try_from(parameters).ok()
}
