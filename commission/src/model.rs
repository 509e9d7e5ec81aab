//! Model: which curve predicts a block that no fit has seen.

use friction_ident::statistics::root_mean_square;
use serde::{Deserialize, Serialize};

use crate::axis::{Axis, Known};
use crate::drive::Drive;
use crate::friction::{Curve, Friction, HELD_BACK, Point, Trail, between, blocks};
use crate::meet::Met;
use crate::structure::{Structure, structure};
use crate::{CommissionError, Stage};

/// Neighbours of the menu between which the held back speeds lie.
const BETWEEN: [usize; HELD_BACK] = [0, 2, 5, 8];
/// The richer curve has to predict better by this share.
const CLEARLY: f64 = 0.05;

/// A curve that is offered.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, strum::Display)]
#[serde(rename_all = "kebab-case")]
#[strum(serialize_all = "kebab-case")]
pub enum CurveKind {
    /// Coulomb and viscous friction.
    CoulombViscous,
    /// With a dip at low speed.
    Stribeck,
}

/// What was found.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Chosen {
    /// The curve that predicts best; of two alike the simpler one.
    pub kind: CurveKind,
    /// The curve itself.
    pub curve: Curve,
    /// Root mean square error on the held back block, of the simpler and the richer curve \[V\].
    pub errors: (f64, f64),
    /// The block that was held back.
    pub held_back: Vec<Point>,
    /// What depends on place and direction.
    #[serde(default)]
    pub structure: Option<Structure>,
}

/// Does the stage.
///
/// # Errors
/// [`CommissionError`] if the rig refuses, the time is up, or nothing moved steadily.
pub fn model(
    axis: &mut Axis<'_>,
    (known, met, drive): (&Known, &Met, &Drive),
    friction: &Friction,
) -> Result<Chosen, CommissionError> {
    let menu = between(friction.speeds.0, friction.speeds.1);
    let bench = axis.bench()?;
    let blocks = blocks(known, (met, drive), &friction.followed_by, axis.reach());
    let (mut held_back, mut trails) = (Vec::new(), Vec::<Trail>::new());
    for place in BETWEEN {
        let velocity = (menu[place] * menu[place + 1]).sqrt();
        axis.say(Stage::Model, &format!("held back, {velocity:.2} rad/s"));
        if let Some((point, trail)) = blocks.measure(axis, &bench, Stage::Model, velocity)? {
            held_back.push(point);
            trails.extend(trail);
        }
    }
    let chosen = choose(friction, held_back)?;
    let structure = structure(&friction.trails, &trails, &chosen.curve, drive);
    Ok(Chosen { structure: Some(structure), ..chosen })
}

fn choose(friction: &Friction, held_back: Vec<Point>) -> Result<Chosen, CommissionError> {
    let unusable = || {
        CommissionError::Unusable {
        stage: Stage::Model,
        why: "no speed between those that were measured was steady: the shaft sticks and slips; `frictionlab identify-stiction` tells friction from that".to_owned(),
    }
    };
    let straight = if friction.curve.dips {
        Curve::straight(&friction.points).ok_or_else(unusable)?
    } else {
        friction.curve
    };
    if held_back.is_empty() {
        return Err(unusable());
    }
    let error = |curve: &Curve| {
        let missed: Vec<f64> =
            held_back.iter().map(|point| point.volts - curve.volts(point.velocity)).collect();
        root_mean_square(&missed)
    };
    let errors = (error(&straight), error(&friction.curve));
    let dips = friction.curve.dips && errors.1 < (1.0 - CLEARLY) * errors.0;
    let (kind, curve) = if dips {
        (CurveKind::Stribeck, friction.curve)
    } else {
        (CurveKind::CoulombViscous, straight)
    };
    Ok(Chosen { kind, curve, errors, held_back, structure: None })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::friction::Ending;
    use crate::loop_design::LoopDesign;
    use controller::PidGains;

    fn friction(dip: f64) -> (Friction, Vec<Point>) {
        let volts = |v: f64| 0.45 + dip * (-(v / 0.14_f64).powi(2)).exp() + 0.7 * v;
        // A little scatter, the same each time.
        let point = |(i, velocity): (usize, f64)| Point {
            velocity,
            volts: volts(velocity) + 1e-3 * (i as f64 * 2.4).sin(),
            one_way: 0.0,
            uneven: 0.0,
            time: 0.0,
        };
        let speeds = [0.02, 0.05, 0.1, 0.2, 0.4, 0.8, 1.6, 3.2];
        let points: Vec<Point> =
            speeds.iter().cycle().take(48).copied().enumerate().map(point).collect();
        let held_back = [0.03, 0.07, 0.3, 2.0].iter().copied().enumerate().map(point).collect();
        let followed_by = LoopDesign {
            gains: PidGains { k_p: 1.0, k_i: 0.0, k_d: 0.0 },
            filter: 0.0,
            natural_frequency: 1.0,
            sensitivity_peak: 1.0,
            noise: 0.0,
        };
        let curve = Curve::of(&points, 0.0).unwrap();
        let friction = Friction {
            curve,
            ending: Ending::Met,
            blocks: Vec::new(),
            points,
            trails: Vec::new(),
            change: None,
            speeds: (0.02, 3.2),
            kept_from: None,
            followed_by,
        };
        (friction, held_back)
    }

    #[test]
    fn a_dip_is_chosen_where_there_is_one_and_not_elsewhere() {
        for (dip, kind) in [(0.05, CurveKind::Stribeck), (0.0, CurveKind::CoulombViscous)] {
            let (friction, held_back) = friction(dip);
            assert_eq!(choose(&friction, held_back).unwrap().kind, kind);
        }
        assert!(choose(&friction(0.05).0, Vec::new()).is_err());
    }
}
