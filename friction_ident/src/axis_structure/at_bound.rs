//! What helps where a nonlinear parameter lies at a bound: the lower one and the upper one ask for
//! the opposite. And what that does to the others.

use super::naming::SLOW;
use super::shape::{Limits, Shape, ShapeTerm};
use crate::estimate::{Doubt, Estimate, Estimates, Verdict};
use crate::parameter_id::ParameterId;

const BROAD: &str = "faster motion: the dip is as broad as the search allows, half of the fastest speed, and what lies beyond it hardly shows";
const LAGS: &str = "a force that is recorded nearer to the motor: the motion follows it later than the search allows, ten samples, as behind a low-pass or a slow bus";
const COMES_LATE: &str = "a force that is recorded earlier in its chain, before a low-pass or a slow bus: it comes later than the motion by more than the search allows, ten samples";
const GRADUAL: &str = "motion over more of the travel: friction rises over as much of it as the search allows, a tenth";
const FINE: &str = "slow motion over less of the travel: the force repeats after less than the search allows, a two-hundredth of it";
const LONG: &str = "motion over more of the travel: the force repeats over more of it than the search allows, if it repeats at all";

/// Puts that beside each of `estimates`, those of `terms`, whose best value is a bound itself.
pub(super) fn remedies(terms: &[ShapeTerm], limits: &Limits, estimates: &mut [Estimate]) {
    for (term, estimate) in terms.iter().zip(estimates) {
        if let Verdict::NotIdentifiable { doubt: Doubt::AtBound { bound }, remedy } =
            &mut estimate.verdict
            && let Some(better) = at(*term, limits, *bound)
        {
            *remedy = better;
        }
    }
}

/// Share of a bound within which a parameter lies at it.
const AT: f64 = 1e-6;
/// What goes into one another where a dip has no end.
const CURVE: [&str; 3] = ["f_v", "f_c", "f_s"];

/// What a wave that is half a bow takes of, beside the forces along the axis.
const LEVELS: [&str; 2] = ["f_c", "f_s"];

/// Says of the other parameters that they take what a parameter at its bound leaves over: inertia
/// and friction that of a force that comes later still, the friction curve that of a broader dip, the
/// level at rest that of a narrower one, the forces along the axis that of a longer wave.
pub(super) fn distrust(
    terms: &[ShapeTerm],
    limits: &Limits,
    shape: &Shape,
    estimates: &mut Estimates,
) {
    for term in terms {
        let value = term.value(shape);
        let upper = value >= (1.0 - AT) * term.value(&limits.high);
        // No delay at all is a bound too, and takes nothing from the others.
        let late = value < 0.0 && value <= (1.0 - AT) * term.value(&limits.low);
        match term {
            ShapeTerm::Delay if upper || late => {
                // A load does not change with the time between force and motion.
                let load = |id: ParameterId| id.is_signed() || id.name == "delay";
                let why = "the delay is as long as the search allows, ten samples: force and motion are further apart, as behind a low-pass, \
                           and inertia and friction take what the delay leaves over";
                estimates.distrust_but(load, why, if value > 0.0 { LAGS } else { COMES_LATE });
            }
            ShapeTerm::StribeckVelocity if upper => {
                let other = |id: ParameterId| !CURVE.contains(&id.name);
                let why = "the dip is as broad as the search allows: the levels and the viscous friction take of one another";
                estimates.distrust_but(other, why, BROAD);
            }
            ShapeTerm::Period if upper => {
                let load = |id: ParameterId| id.is_signed() || LEVELS.contains(&id.name);
                let why = "the wave is as long as the search allows, twice the travel: it, a weight, a spring, a constant force and friction \
                           that changes along the axis go into one another";
                estimates.distrust_but(|id| !load(id), why, LONG);
            }
            // How deep a narrow dip is, and how narrow, go into one another.
            ShapeTerm::StribeckVelocity
                if narrowest(estimates, value) <= (1.0 + AT) * limits.low.v_s =>
            {
                let why = "the dip may be as narrow as the search allows, and is as much deeper then: how deep it is is not known";
                estimates.distrust_but(|id| id.name != "f_s", why, SLOW);
            }
            _ => {}
        }
    }
}

/// The narrowest dip that the interval of the Stribeck velocity has; `value` where it has none.
fn narrowest(estimates: &Estimates, value: f64) -> f64 {
    estimates.get("v_s").and_then(|v_s| v_s.interval).map_or(value, |interval| interval.low)
}

/// The remedy at a bound; none where the usual one helps.
fn at(term: ShapeTerm, limits: &Limits, bound: f64) -> Option<&'static str> {
    let [low, high] = [&limits.low, &limits.high].map(|end| term.unknown(term.value(end)));
    let upper = term.unknown(bound) > 0.5 * (low + high);
    match term {
        ShapeTerm::Delay if bound > 0.0 => Some(LAGS),
        // No delay at all is a bound too where a late force is not believed.
        ShapeTerm::Delay if bound < 0.0 => Some(COMES_LATE),
        ShapeTerm::StribeckVelocity if upper => Some(BROAD),
        ShapeTerm::Displacement if upper => Some(GRADUAL),
        ShapeTerm::Period if !upper => Some(FINE),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::super::naming::{AxisUnits, unknowns};
    use super::super::tests::stribeck_axis;
    use super::*;

    /// Of a dip that is broader than the search goes the levels were told with narrow intervals, and of
    /// one that is narrower the level at rest, up to four times the true one.
    #[test]
    fn a_dip_at_a_bound_leaves_no_levels() {
        let limits = Limits::of(&stribeck_axis());
        let structure = "symmetric+stribeck".parse().unwrap();
        let terms = ShapeTerm::of(&structure);
        let identified = |shape: Shape| {
            let names = unknowns(&structure, &AxisUnits::LINEAR);
            let of = |id: ParameterId, unit| Estimate::given(id, unit, 1.0, "");
            let mut parameters: Vec<Estimate> =
                names.iter().map(|unknown| of(unknown.id, unknown.unit)).collect();
            parameters.iter_mut().for_each(|estimate| estimate.verdict = Verdict::Identified);
            let mut estimates = Estimates { parameters, ..Estimates::default() };
            distrust(&terms, &limits, &shape, &mut estimates);
            let left = estimates.parameters.iter().filter(|estimate| estimate.is_identified());
            left.map(|estimate| estimate.id.name).collect::<Vec<_>>()
        };
        assert_eq!(identified(limits.high), ["inertia", "offset", "v_s"]);
        assert_eq!(identified(limits.low), ["inertia", "f_v", "offset", "f_c", "v_s"]);
    }

    /// A stranger's weak spring came out as a wave of half a turn, a weight, a spring of 85 times its
    /// size and friction of each direction, all identified.
    #[test]
    fn a_wave_as_long_as_the_search_allows_leaves_no_forces_along_the_axis() {
        let limits = Limits::of(&stribeck_axis());
        let structure = "asymmetric+gravity+position+harmonic".parse().unwrap();
        let names = unknowns(&structure, &AxisUnits::ROTARY);
        let identified = |shape: Shape| {
            let of = |id: ParameterId, unit| Estimate::given(id, unit, 1.0, "");
            let mut parameters: Vec<Estimate> =
                names.iter().map(|unknown| of(unknown.id, unknown.unit)).collect();
            parameters.iter_mut().for_each(|estimate| estimate.verdict = Verdict::Identified);
            let mut estimates = Estimates { parameters, ..Estimates::default() };
            distrust(&ShapeTerm::of(&structure), &limits, &shape, &mut estimates);
            let left = estimates.parameters.into_iter().filter(Estimate::is_identified);
            left.map(|estimate| estimate.id.name).collect::<Vec<_>>()
        };
        assert_eq!(identified(limits.high), ["inertia", "f_v", "f_v", "period"]);
        assert_eq!(identified(limits.start()).len(), names.len());
    }

    /// A dip that is too broad was told to move slowly, and a force that lags to be sampled faster.
    #[test]
    fn each_bound_has_its_own_remedy() {
        let limits = Limits::of(&stribeck_axis());
        let structure = "symmetric+stribeck+presliding+delay+harmonic".parse().unwrap();
        let terms = ShapeTerm::of(&structure);
        let usual = unknowns(&structure, &AxisUnits::LINEAR);
        let usual = &usual[usual.len() - terms.len()..];
        let remedy = |term: ShapeTerm, bound: f64| {
            let place = terms.iter().position(|other| *other == term).unwrap();
            let mut all: Vec<Estimate> = usual
                .iter()
                .map(|unknown| Estimate::given(unknown.id, unknown.unit, bound, ""))
                .collect();
            let doubt = Doubt::AtBound { bound };
            let remedy = usual[place].remedy;
            all[place].verdict = Verdict::NotIdentifiable { doubt, remedy };
            remedies(&terms, &limits, &mut all);
            match all[place].verdict {
                Verdict::NotIdentifiable { remedy, .. } => remedy,
                _ => "",
            }
        };
        let velocity = ShapeTerm::StribeckVelocity;
        assert!(remedy(velocity, limits.high.v_s).starts_with("faster motion"));
        assert!(remedy(velocity, limits.low.v_s).starts_with("slow motion"));
        assert!(remedy(ShapeTerm::Delay, limits.high.delay).contains("nearer to the motor"));
        assert!(remedy(ShapeTerm::Delay, limits.low.delay).contains("earlier in its chain"));
        assert!(remedy(ShapeTerm::Delay, 0.0).contains("sampled faster"));
        let displacement = ShapeTerm::Displacement;
        assert!(remedy(displacement, limits.high.displacement).contains("more of the travel"));
        assert!(remedy(displacement, limits.low.displacement).contains("small oscillations"));
        assert!(remedy(ShapeTerm::Period, limits.low.period).contains("less of the travel"));
        assert!(remedy(ShapeTerm::Period, limits.high.period).contains("whole axis"));
    }
}
