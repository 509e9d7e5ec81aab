//! Where the dynamic stages begin: from the specialised fits, which scan and need no start
//! themselves.

use friction_model::{AnyModel, AnyParameters, ModelName};

use super::dips::with_the_nearest_dip;
use super::stage::PRE_SLIDING;
use super::work::Work;
use crate::frictional_lag::{LagOptions, LagRecording, fit_lag};
use crate::output_error::{Measured, Predictor, prediction_rms};
use crate::pre_sliding::{PreSlidingModel, PreSlidingPath, fit_pre_sliding};
use crate::starting_model::{bent_by, breakaway_reach, scaled_to};
use crate::static_curve::StribeckValues;
use crate::stretch::Stretch;

/// Coulomb levels that are tried where the static characteristic has none, as shares of the largest
/// friction.
const LEVELS: [f64; 5] = [0.03, 0.1, 0.3, 0.6, 0.9];

/// Reaches that are tried where no recording stays within pre-sliding, as shares of the travel.
const REACHES: [f64; 9] = [1e-5, 1e-4, 3e-4, 1e-3, 3e-3, 0.01, 0.03, 0.1, 0.3];

impl Work<'_> {
    /// The model with a Coulomb level, where the static characteristic has none to speak of. A
    /// contact that bends for as long as it slides shows none in bins of the speed, and what is
    /// nearly zero is left by factors only: the search that follows begins at the best of a few
    /// levels.
    pub(super) fn with_a_level(&self, model: AnyModel) -> AnyModel {
        let stretches =
            || [&self.data.pre_sliding, &self.data.lag, &self.data.mixed].into_iter().flatten();
        let friction = stretches().flat_map(|stretch| &stretch.friction);
        let largest = friction.fold(0.0, |largest: f64, f| largest.max(f.abs()));
        let parameters = model.parameters();
        let (forward, backward) = parameters.sides();
        let has_one = |side: &AnyParameters| {
            side.values("f_c").first().is_none_or(|f_c| *f_c >= LEVELS[0] * largest)
        };
        if has_one(&forward) && has_one(&backward) {
            return model;
        }
        let raised = |mut side: AnyParameters, level: f64| {
            for (name, at_least) in [("f_s", 1.001 * level), ("f_c", level)] {
                if let Some(now) = side.values(name).first() {
                    side.set(name, now.max(at_least));
                }
            }
            side
        };
        let tried = LEVELS.into_iter().filter_map(|share| {
            let level = share * largest;
            parameters.with_sides(raised(forward, level), raised(backward, level)).ok()
        });
        let stretches: Vec<Stretch> = stretches().cloned().collect();
        let measured = Measured { stretches: &stretches, ..Measured::default() };
        tried.min_by(|a, b| error(a, &measured).total_cmp(&error(b, &measured))).unwrap_or(model)
    }

    /// The model with the reach that is nearest to the recordings, of a few over all decades of the
    /// travel, where no recording stays within pre-sliding and tells it. A model knows the reach of
    /// the test bed only, and from that of a stage in micrometres or of a soft gearbox no search leads
    /// to the other. Without steady points the level is tried with it: bins of the speed show that of
    /// a contact that bends too low. None where nothing is nearer than the model is.
    pub(super) fn with_a_reach(&self, model: &AnyModel) -> Option<AnyModel> {
        let data = &self.data;
        let stretches: Vec<Stretch> =
            [&data.lag, &data.mixed].into_iter().flatten().cloned().collect();
        let travel = stretches.iter().map(Stretch::range).fold(0.0, f64::max);
        let bends = breakaway_reach(model).is_some();
        if !data.pre_sliding.is_empty() || !bends || travel <= 0.0 {
            return None;
        }
        let forces = stretches.iter().flat_map(|stretch| &stretch.friction);
        let largest = forces.fold(0.0, |largest: f64, f| largest.max(f.abs()));
        let measured = Measured { stretches: &stretches, ..Measured::default() };
        let parameters = model.parameters();
        let (forward, backward) = parameters.sides();
        let with = |side: AnyParameters, level: Option<f64>, reach: f64| {
            let side: AnyModel = side.try_into().ok()?;
            let side = match level {
                Some(level) => scaled_to(
                    &side,
                    &StribeckValues { f_s: 1.001 * level, f_c: level, ..slope(&side) },
                    None,
                )
                .ok()?,
                None => side,
            };
            let old = breakaway_reach(&side).filter(|old| *old > 0.0)?;
            Some(bent_by(&side, reach / old))
        };
        let levels = LEVELS.map(|share| Some(share * largest));
        let levels = if data.has_steady_points() { &levels[..0] } else { &levels[..] };
        let tried =
            [None].iter().chain(levels).flat_map(|level| REACHES.map(|reach| (*level, reach)));
        let tried = tried.filter_map(|(level, share)| {
            let reach = share * travel;
            let sides = (with(forward, level, reach)?, with(backward, level, reach)?);
            let tried: AnyModel = parameters.with_sides(sides.0, sides.1).ok()?;
            Some((error(&tried, &measured), tried))
        });
        let (off, best) = tried.min_by(|a, b| a.0.total_cmp(&b.0))?;
        (off < error(model, &measured)).then(|| with_the_nearest_dip(best, &measured))
    }

    /// The model with the lengths, stiffnesses and shares of the best hysteresis operator, found by
    /// a scan over all of them, where that is nearer to the recordings. A path that cannot be
    /// fitted so leaves the model as it is: the search that follows may still do better.
    pub(super) fn best_operator(&self, model: AnyModel) -> AnyModel {
        let operator = match self.name {
            ModelName::Proposed => PreSlidingModel::Proposed,
            ModelName::LuGre => PreSlidingModel::LuGre,
            ModelName::Dahl => {
                PreSlidingModel::Dahl { delta: model.parameter("delta").unwrap_or(1.0) }
            }
            ModelName::ElastoPlastic => PreSlidingModel::ElastoPlastic,
            ModelName::Gms => PreSlidingModel::Gms { elements: self.options.elements },
            ModelName::Xiong => PreSlidingModel::Xiong { elements: self.options.elements },
            _ => return model,
        };
        let travels: Vec<Vec<f64>> = self
            .data
            .pre_sliding
            .iter()
            .map(|stretch| {
                let travel = stretch.travel();
                let start = travel.first().copied().unwrap_or(0.0);
                travel.into_iter().map(|x| x - start).collect()
            })
            .collect();
        let paths: Vec<PreSlidingPath> = travels
            .iter()
            .zip(&self.data.pre_sliding)
            .map(|(displacement, stretch)| PreSlidingPath {
                displacement,
                torque: &stretch.friction,
            })
            .collect();
        let Ok(found) = fit_pre_sliding(&paths, operator) else { return model };
        let mut parameters = model.parameters();
        for estimate in &found.estimates.parameters {
            if PRE_SLIDING.contains(&estimate.id.name) {
                parameters.set_at(estimate.id.name, estimate.id.index(), estimate.value);
            }
        }
        // An element that never slipped on these paths is as soft as the fit likes: no softer than
        // one that slips at eight times their end.
        let level = model.parameter("f_s").unwrap_or(f64::INFINITY);
        for (share, stiffness) in [("alpha", "sigma0"), ("lambda", "k")] {
            let softest = level / (8.0 * self.reach().unwrap_or(f64::INFINITY));
            let pairs = parameters.values(share).into_iter().zip(parameters.values(stiffness));
            for (element, (share, k)) in pairs.enumerate() {
                parameters.set_at(stiffness, element, k.max(share * softest));
            }
        }
        let measured = Measured { stretches: &self.data.pre_sliding, ..Measured::default() };
        let nearer = |other: &AnyModel| error(other, &measured) < error(&model, &measured);
        parameters.try_into().ok().filter(nearer).unwrap_or(model)
    }

    /// The model with the time constant of the lag stage's own fit, which scans all of them and
    /// needs no start, where that is nearer to the recordings.
    pub(super) fn best_lag(&self, model: AnyModel) -> AnyModel {
        let recordings: Vec<LagRecording> = self
            .data
            .lag
            .iter()
            .map(|stretch| LagRecording {
                velocity: &stretch.velocity,
                torque: &stretch.friction,
                dt: stretch.time_step,
            })
            .collect();
        // A velocity that noise turns round is left to the search that follows.
        let Ok(found) = fit_lag(&recordings, &LagOptions::default()) else { return model };
        let mut parameters = model.parameters();
        parameters.set("tau", found.values.tau);
        let measured = Measured { stretches: &self.data.lag, ..Measured::default() };
        let nearer = |other: &AnyModel| error(other, &measured) < error(&model, &measured);
        parameters.try_into().ok().filter(nearer).unwrap_or(model)
    }
}

/// The static values of one direction without viscous friction: in the bins it has taken what the
/// level lacks there.
fn slope(side: &AnyModel) -> StribeckValues {
    let of = |name: &str| side.parameter(name);
    let (f_c, v_s) = (of("f_c").unwrap_or(1.0), of("v_s").unwrap_or(1.0));
    StribeckValues { f_s: f_c, f_c, v_s, f_v: 0.0, delta: of("delta").unwrap_or(2.0) }
}

fn error(model: &AnyModel, measured: &Measured) -> f64 {
    prediction_rms(&Predictor::from(*model), measured)
}
