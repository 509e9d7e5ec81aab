//! A dip where the search from the stages found none.
//!
//! Without steady points the static characteristic comes from sliding at changing velocity, in bins,
//! and a contact that bends hides the dip there. The search then begins without one, or with one
//! narrower than any speed it slides at, and stays: no step by a little leads from there to a broad
//! dip. Where the contact bends along most of the travel, it may also end with a stiff contact that
//! carries nothing. So it begins a second time at the best of a few, and the better of both ends
//! counts.

use friction_model::{AnyModel, AnyParameters};

use super::decided::Damping;
use super::stage::Stage;
use super::work::{Watch, Work};
use crate::output_error::{Measured, OutputErrorFit, Predictor};
use crate::parameter_id::{ParameterId, Side};
use crate::statistics::{quantile, sorted};
use crate::stretch::Stretch;

/// Stribeck velocities that are tried, as shares of the largest usual speed, and the share of the
/// samples that are slower than that.
const SPEEDS: [f64; 4] = [0.02, 0.06, 0.15, 0.4];
const USUAL: f64 = 0.95;
/// Kinetic levels that are tried, as shares of the one that was found, and static levels as multiples
/// of these.
const LEVELS: [f64; 2] = [0.75, 1.0];
const DEPTHS: [f64; 2] = [1.3, 2.0];
/// Share of the largest friction below which a contact carries nothing; levels that are tried then, as
/// shares of the largest friction, and reaches, as shares of the travel.
const NOTHING: f64 = 0.03;
const OF_LARGEST: [f64; 2] = [0.3, 0.6];
const REACHES: [f64; 3] = [0.01, 0.05, 0.25];
/// Free parameters of one direction up to which the search is repeated.
const MOST_FREE: usize = 10;

impl Work<'_> {
    /// `found`, or what a search finds that begins with a dip, where `found` shows none and the
    /// other is nearer to the recordings.
    pub(super) fn with_a_dip(
        &mut self,
        found: OutputErrorFit,
        damping: Damping,
        measured: &Measured,
        watch: Watch,
    ) -> OutputErrorFit {
        if self.data.has_steady_points() || !self.may_begin_again(&found) {
            return found;
        }
        let Some(start) = best_dip(&found, measured) else { return found };
        self.better_from(&start, found, damping, measured, watch)
    }

    /// Whether a second search is worth its time: with many parameters it takes long.
    pub(super) fn may_begin_again(&self, found: &OutputErrorFit) -> bool {
        let sides = Side::of(self.options.asymmetric).len();
        !self.stopped && found.estimates.parameters.len() <= MOST_FREE * sides
    }

    /// `found`, or what a search finds that begins at `start`, where that is nearer to the recordings.
    pub(super) fn better_from(
        &mut self,
        start: &AnyModel,
        found: OutputErrorFit,
        damping: Damping,
        measured: &Measured,
        watch: Watch,
    ) -> OutputErrorFit {
        let before = (self.load, self.converged);
        let estimated = match damping {
            Damping::Computed => false,
            Damping::Estimated => true,
            Damping::Either => self.stages.iter().all(|stage| stage.stage != Stage::MicroDamping),
        };
        let other = self.refine(start, estimated, measured, watch).ok();
        match other.filter(|_| !self.stopped) {
            Some(other) if misfit(&other, measured) < misfit(&found, measured) => other,
            _ => {
                (self.load, self.converged) = before;
                found
            }
        }
    }
}

/// Whether a dip is told; none of a model that has none.
fn shows_dip(fit: &OutputErrorFit) -> Option<bool> {
    let mut any = None;
    for side in [Side::Both, Side::Forward, Side::Backward] {
        let of = |name| fit.estimates.get(ParameterId::new(name).side(side));
        if let (Some(f_s), Some(v_s)) = (of("f_s"), of("v_s")) {
            let told = f_s.is_identified() && v_s.is_identified();
            any = Some(told && any.unwrap_or(true));
        }
    }
    any
}

/// The fitted model with the dip of those tried that is nearest to the recordings; none where it shows
/// a dip, or cannot have one.
fn best_dip(fit: &OutputErrorFit, measured: &Measured) -> Option<AnyModel> {
    let friction = measured.stretches.iter().flat_map(|stretch| &stretch.friction);
    let largest = friction.fold(0.0, |largest: f64, f| largest.max(f.abs()));
    let f_c = fit.model.parameter("f_c")?;
    let stiffness = fit.model.parameter("sigma0");
    let (levels, stiffnesses) = match stiffness {
        Some(sigma0) if f_c < NOTHING * largest => {
            let travel = measured.stretches.iter().map(Stretch::range).fold(0.0, f64::max);
            let of = |level: f64| REACHES.map(|reach| Some(level / (reach * travel) / sigma0));
            let levels = OF_LARGEST.map(|share| share * largest);
            (levels, levels.map(|level| of(level).to_vec()))
        }
        _ if shows_dip(fit) == Some(false) => {
            (LEVELS.map(|share| share * f_c), [vec![None], vec![None]])
        }
        _ => return None,
    };
    let usual = usual_speed(measured)?;
    // One that is narrower than all of them has run away from where such a one would lead to.
    let narrow = fit.model.parameter("v_s").is_some_and(|v_s| v_s < SPEEDS[0] * usual);
    let shares = if narrow { &SPEEDS[2..] } else { &SPEEDS[..] };
    let contacts = levels.into_iter().zip(&stiffnesses);
    let contacts = contacts.flat_map(|(level, all)| all.iter().map(move |one| (level, *one)));
    let tried = contacts.flat_map(|contact| with_dips(&fit.model, contact, shares, usual));
    let off = |model: &AnyModel| off(&Predictor { model: *model, load: fit.load }, measured);
    tried.min_by(|a, b| off(a).total_cmp(&off(b)))
}

/// The model with the dip of a few that is nearest to the recordings, or as it is.
pub(super) fn with_the_nearest_dip(model: AnyModel, measured: &Measured) -> AnyModel {
    let (Some(usual), Some(f_c)) = (usual_speed(measured), model.parameter("f_c")) else {
        return model;
    };
    let levels = LEVELS.into_iter().map(|share| (share * f_c, None));
    let dips = levels.flat_map(|contact| with_dips(&model, contact, &SPEEDS, usual));
    let off = |model: &AnyModel| off(&(*model).into(), measured);
    std::iter::once(model).chain(dips).min_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or(model)
}

/// The speed that most samples stay below; none without motion.
fn usual_speed(measured: &Measured) -> Option<f64> {
    let speeds = measured.stretches.iter().flat_map(|stretch| &stretch.velocity);
    quantile(&sorted(speeds.map(|v| v.abs())), USUAL).filter(|v| *v > 0.0)
}

/// The model with a contact of this kinetic level, stiffer by a factor if there is one, and each of
/// the dips whose Stribeck velocity is one of `shares` of the usual speed.
fn with_dips(
    model: &AnyModel,
    (level, stiffer): (f64, Option<f64>),
    shares: &[f64],
    usual: f64,
) -> Vec<AnyModel> {
    let parameters = model.parameters();
    let (forward, backward) = parameters.sides();
    let dips = shares.iter().flat_map(|&speed| DEPTHS.map(|depth| (speed, depth)));
    let with = |(speed, depth): (f64, f64)| {
        let dip = Dip { f_c: level, f_s: depth * level, v_s: speed * usual, stiffer };
        parameters.with_sides(dip.on(forward), dip.on(backward)).ok()
    };
    dips.filter_map(with).collect()
}

/// What is tried.
struct Dip {
    f_c: f64,
    f_s: f64,
    v_s: f64,
    /// By what the stiffness is multiplied, and the micro-damping with it.
    stiffer: Option<f64>,
}

impl Dip {
    /// One direction with it; what the model does not have stays away.
    fn on(&self, mut side: AnyParameters) -> AnyParameters {
        for (name, value) in [("f_c", self.f_c), ("f_s", self.f_s), ("v_s", self.v_s)] {
            side.set(name, value);
        }
        if let Some(factor) = self.stiffer {
            side.scale("sigma0", factor);
            side.scale("sigma1", factor);
        }
        side
    }
}

fn misfit(fit: &OutputErrorFit, measured: &Measured) -> f64 {
    off(&Predictor { model: fit.model, load: fit.load }, measured)
}

/// Sum of the squares by which a prediction is off, in standard deviations.
fn off(by: &Predictor, measured: &Measured) -> f64 {
    let square = |off: f64, deviation: Option<f64>| (off / deviation.unwrap_or(1.0)).powi(2);
    let points = measured.points.iter();
    let points = points.map(|point| square(by.steady(point) - point.torque, point.deviation));
    let stretches = measured.stretches.iter().map(|stretch| {
        let predicted = by.along(stretch);
        let all = predicted.iter().zip(&stretch.friction);
        all.map(|(p, f)| square(p - f, stretch.deviation)).sum::<f64>()
    });
    let sum: f64 = points.chain(stretches).sum();
    if sum.is_finite() { sum } else { f64::INFINITY }
}

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;

    use friction_model::ModelName;
    use rand::{RngExt, SeedableRng};
    use rand_distr::StandardNormal;

    use super::*;
    use crate::output_error::predict;
    use crate::staged::{FrictionData, StagedOptions, identify_model};
    use crate::stretch::Stretch;

    /// A soft contact that slides to and fro without steady points: the fit ended without a dip, or
    /// with a contact of no friction and endless stiffness, and left a third of the force.
    #[test]
    fn a_dip_that_a_soft_contact_hides_is_found() {
        let swing = |t: f64| (9.0 * t).sin();
        let sweep = |t: f64| (3.0 * t * (1.0 + t)).sin();
        let places = |t: f64| (2.5 * t).sin().powi(3);
        finds([2.0, 1.0, 0.5, 20.0, 0.3, 0.1], swing);
        finds([2.0, 1.0, 0.5, 20.0, 0.3, 0.1], sweep);
        finds([1.5, 1.0, 0.2, 10.0, 0.3, 0.1], swing);
        finds([1.5, 1.0, 0.2, 10.0, 0.3, 0.1], places);
    }

    fn finds(values: [f64; 6], velocity: impl Fn(f64) -> f64) {
        const NOISE: f64 = 0.02;
        let mut parameters = AnyParameters::test_bed(ModelName::LuGre);
        for (name, value) in ["f_s", "f_c", "v_s", "sigma0", "sigma1", "f_v"].iter().zip(values) {
            assert!(parameters.set(name, value), "{name}");
        }
        let truth: AnyModel = parameters.try_into().unwrap();
        let mut rng = rand_pcg::Pcg64Mcg::seed_from_u64(3);
        let velocity: Vec<f64> = (0..8000).map(|k| velocity(1e-3 * f64::from(k))).collect();
        let mut stretch = Stretch::new(1e-3, velocity.clone(), None, velocity).unwrap();
        let noise = || NOISE * rng.sample::<f64, _>(StandardNormal);
        stretch.friction = predict(&truth, &stretch);
        stretch.friction.iter_mut().zip(std::iter::repeat_with(noise)).for_each(|(f, e)| *f += e);
        let data = FrictionData::sort(Vec::new(), vec![stretch], None);
        let mut watch = |_, _: &_| ControlFlow::Continue(());
        let options = StagedOptions::default();
        let found = identify_model(ModelName::LuGre, &data, &options, &mut watch).unwrap();
        let rms = found.stages.last().unwrap().rms;
        assert!(rms < 1.05 * NOISE, "{rms}");
        for (name, within) in [("f_c", 0.01), ("v_s", 0.1), ("sigma0", 0.02), ("sigma1", 0.05)] {
            let ratio = found.model.parameter(name).unwrap() / truth.parameter(name).unwrap();
            assert!((ratio - 1.0).abs() < within, "{name}: {ratio}");
        }
    }
}
