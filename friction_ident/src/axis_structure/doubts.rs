//! What the fitted numbers do not say, beyond their standard errors.

use super::AxisStructure;
use crate::conditioning::Conditioned;
use crate::estimate::{Doubt, Estimate, Estimates, Verdict};
use crate::parameter_id::{ParameterId, Side};

/// Standard errors that an effect must be clear of zero by.
const CLEAR: f64 = 2.0;

/// The parts of a wave along the axis.
const WAVE: [&str; 2] = ["harmonic_cos", "harmonic_sin"];

/// Parameters of friction, which takes energy: below zero they describe something else.
const FRICTION: [&str; 4] = ["f_v", "f_c", "f_s", "sigma1"];

/// Those of steady sliding.
pub(super) const STEADY: [&str; 3] = ["f_v", "f_c", "f_s"];

/// What is told by what happens around reversals.
const AROUND_REVERSALS: [&str; 4] = ["presliding", "delay", "f_s", "v_s"];
const FASTER: &str = "reversals sampled faster, or a force that is recorded nearer to the motor";
const FINER: &str = "an encoder with finer steps, or slower reversals that are sampled faster";

/// Adds the doubts that no single parameter's error shows: a Stribeck velocity without a Stribeck
/// effect, a period without a force.
pub(super) fn judge(structure: &AxisStructure, estimates: &mut Estimates) {
    if structure.stribeck {
        let mut any = false;
        let mut largest = (0.0f64, f64::INFINITY);
        for &side in Side::of(structure.asymmetric) {
            let [f_s, f_c] = ["f_s", "f_c"].map(|name| ParameterId::new(name).side(side));
            let Some((effect, error)) = difference(estimates, f_s, f_c) else { continue };
            if effect.abs() > CLEAR * error {
                any = true;
            }
            if effect.abs() / error > largest.0.abs() / largest.1 {
                largest = (effect, error);
            }
        }
        if !any {
            let (effect, standard_error) = largest;
            let remedy = "slow motion: steady speeds below and around the dip";
            doubt(estimates, "v_s", Doubt::BelowNoise { effect, standard_error }, remedy);
        }
    }
    // A signed quantity about zero is a finding, not a failure.
    for estimate in &mut estimates.parameters {
        let about_zero = matches!(
            estimate.verdict,
            Verdict::NotIdentifiable { doubt: Doubt::LargeError { .. }, .. }
        ) && estimate.standard_error.is_some();
        if about_zero && estimate.id.is_signed() {
            estimate.verdict = Verdict::Identified;
        }
    }
    for estimate in &mut estimates.parameters {
        let friction = FRICTION.contains(&estimate.id.name);
        if friction && estimate.value < 0.0 && estimate.is_identified() {
            let doubt = Doubt::Negative { value: estimate.value };
            let remedy =
                "the axis over more of its speeds and its travel, or fit what acts beside friction";
            estimate.verdict = Verdict::NotIdentifiable { doubt, remedy };
        }
    }
    backwards(estimates);
    below(structure, estimates);
    if structure.harmonic {
        let part = |name: &'static str| {
            let estimate = estimates.get(name);
            estimate.map_or((0.0, 0.0), |e| (e.value, e.standard_error.unwrap_or(f64::INFINITY)))
        };
        let ((c, ce), (s, se)) = (part("harmonic_cos"), part("harmonic_sin"));
        let (effect, standard_error) = (c.hypot(s), ce.max(se));
        if effect < CLEAR * standard_error {
            let remedy = "slow motion over many periods of the axis";
            doubt(estimates, "period", Doubt::BelowNoise { effect, standard_error }, remedy);
        }
    }
}

/// A bristle whose damping is clearly below zero would drive the axis: what happens around a reversal
/// is then not what one bristle does, and how far it bends is not known.
fn backwards(estimates: &mut Estimates) {
    let drives = |damping: &Estimate| {
        damping.value < -CLEAR * damping.standard_error.unwrap_or(f64::INFINITY)
    };
    if estimates.get("sigma1").is_some_and(drives) {
        let why = "the damping of the bristle comes out below zero: what happens around a reversal is not what one bristle does";
        estimates.distrust_but(|id| !AROUND_REVERSALS.contains(&id.name), why, FASTER);
    }
}

/// What the sampling does not show of a bristle: one that bends by less than the encoder's `step`, and
/// a damping that a force half a sample early or late would look like. Where the axis sticks the
/// low-pass spreads each start, which looks like a bristle with such a damping.
///
/// The friction of a bristle that comes `late` is `f_c (z - late z')`, which is a damping of
/// `-late f_c / presliding`: the stiffness times the delay.
pub(super) fn sampled(recording: &Conditioned, estimates: &mut Estimates) {
    let low =
        |estimate: &Estimate| estimate.interval.map_or(f64::NEG_INFINITY, |interval| interval.low);
    let Some(bristle) = estimates.get("presliding") else { return };
    let (bends, least) = (bristle.value, low(bristle));
    if recording.step > 0.0 && least < recording.step {
        let why = "the bristle may bend by less than one step of the encoder";
        estimates.distrust_but(|id| id.name != "presliding", why, FINER);
    }
    let known = estimates.get("presliding").is_some_and(Estimate::is_identified);
    let levels = Side::of(true).iter().chain(Side::of(false));
    let levels = levels.filter_map(|&side| estimates.value(ParameterId::new("f_c").side(side)));
    let level = levels.fold(0.0, f64::max);
    let least = recording.instant() * level / bends;
    let Some(damping) = estimates.get("sigma1") else { return };
    let clear = damping.interval.is_some_and(|interval| interval.low > least);
    if !known {
        let why = "how far the bristle bends is not known, and its damping hangs on that";
        estimates.distrust_but(|id| id.name != "sigma1", why, FASTER);
    } else if !clear && recording.sticking {
        let why =
            "the axis sticks, and a start that the low-pass spreads looks like such a bristle";
        estimates.distrust_but(|id| !["presliding", "sigma1"].contains(&id.name), why, FASTER);
    } else if !clear {
        let why = "a force half a sample early or late would look like such a damping";
        estimates.distrust_but(|id| id.name != "sigma1", why, FASTER);
    }
}

/// A level at rest that is not above the kinetic one is no level at rest: nothing is known of that. A
/// dip that one direction has and the other has not is none either.
fn below(structure: &AxisStructure, estimates: &mut Estimates) {
    let remedy = "slow motion: steady speeds below and around the dip";
    let mut none = None;
    for &side in Side::of(structure.asymmetric) {
        let [f_s, f_c] = ["f_s", "f_c"].map(|name| ParameterId::new(name).side(side));
        let Some((low, high)) = estimates.value(f_s).zip(estimates.value(f_c)) else { continue };
        if low > high {
            continue;
        }
        none = Some((f_s, f_c));
        if let Some(estimate) = estimates.get_mut(f_s).filter(|estimate| estimate.is_identified()) {
            let doubt = Doubt::NoDip { rest: f_s, kinetic: f_c };
            estimate.verdict = Verdict::NotIdentifiable { doubt, remedy };
        }
    }
    if let Some((f_s, f_c)) = none.filter(|_| structure.asymmetric) {
        let why = format!("{f_s} lies below {f_c}: one direction has no dip");
        estimates.distrust_but(|id| !["f_s", "v_s"].contains(&id.name), &why, remedy);
    }
}

/// Difference of two parameters and its standard error; none where one of them has no error.
pub(super) fn difference(
    estimates: &Estimates,
    a: ParameterId,
    b: ParameterId,
) -> Option<(f64, f64)> {
    let (i, j) = (estimates.place(a)?, estimates.place(b)?);
    let of = |i: usize, j: usize| estimates.covariance.get(i).and_then(|row| row.get(j)).copied();
    let variance = of(i, i)? + of(j, j)? - 2.0 * of(i, j)?;
    let value = estimates.parameters[i].value - estimates.parameters[j].value;
    (variance > 0.0).then(|| (value, variance.sqrt()))
}

fn doubt(estimates: &mut Estimates, name: &'static str, doubt: Doubt, remedy: &'static str) {
    if let Some(estimate) = estimates.get_mut(name)
        && estimate.verdict == Verdict::Identified
    {
        estimate.verdict = Verdict::NotIdentifiable { doubt, remedy };
    }
}

/// Of a wave whose period is not known neither is how large it is: another one may be in its place.
pub(super) fn of_a_wave(estimates: &mut Estimates) {
    if estimates.get("period").is_none_or(Estimate::is_identified) {
        return;
    }
    let why = "the period is not known: how large the wave is hangs on it";
    let remedy = "motion over more periods, slowly";
    estimates.distrust_but(|id| !WAVE.contains(&id.name), why, remedy);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::{Interval, IntervalMethod};

    /// A stranger's axis without a ripple had one, its size identified, whose period was any.
    #[test]
    fn a_wave_of_unknown_period_has_no_known_size() {
        let verdicts = |period: Verdict| {
            let one = |name: &'static str| Estimate::given(ParameterId::new(name), "N m", 1.0, "");
            let mut parameters: Vec<Estimate> =
                ["inertia", "harmonic_cos", "harmonic_sin", "period"].map(one).to_vec();
            parameters.iter_mut().for_each(|estimate| estimate.verdict = Verdict::Identified);
            parameters[3].verdict = period;
            let mut estimates = Estimates { parameters, ..Estimates::default() };
            of_a_wave(&mut estimates);
            estimates.parameters.iter().map(Estimate::is_identified).collect::<Vec<_>>()
        };
        assert_eq!(verdicts(Verdict::Identified), [true; 4]);
        let unknown = Doubt::AtBound { bound: 1.0 };
        let unknown = Verdict::NotIdentifiable { doubt: unknown, remedy: "" };
        assert_eq!(verdicts(unknown), [true, false, false, false]);
    }

    /// A level at rest of 0.358 was called identified, below a kinetic level of 0.405.
    #[test]
    fn a_level_at_rest_below_the_kinetic_one_is_not_identified() {
        let structure = AxisStructure { stribeck: true, ..AxisStructure::SYMMETRIC };
        let verdict = |f_s: f64| {
            let one = |name: &'static str, value: f64| Estimate {
                id: name.into(),
                unit: "N m",
                value,
                standard_error: Some(0.03),
                interval: Some(Interval {
                    low: value - 0.06,
                    high: value + 0.06,
                    method: IntervalMethod::Robust,
                }),
                verdict: Verdict::Identified,
            };
            let parameters = vec![one("f_c", 0.405), one("f_s", f_s)];
            let mut estimates = Estimates { parameters, ..Estimates::default() };
            judge(&structure, &mut estimates);
            estimates.get("f_s").unwrap().verdict.clone()
        };
        let Verdict::NotIdentifiable { doubt, .. } = verdict(0.358) else { panic!("identified") };
        assert_eq!(doubt, Doubt::NoDip { rest: "f_s".into(), kinetic: "f_c".into() });
        assert!(doubt.to_string().starts_with("f_s lies below f_c"), "{doubt}");
        assert_eq!(verdict(0.45), Verdict::Identified);
    }

    /// Of a stranger's axis the forward level was refused so, and the backward one and v_s identified, a
    /// quarter and six times off.
    #[test]
    fn a_dip_in_one_direction_only_is_none() {
        let one = |name: &'static str, side, value| Estimate {
            verdict: Verdict::Identified,
            ..Estimate::given(ParameterId::new(name).side(side), "", value, "")
        };
        let (forward, backward) = (Side::Forward, Side::Backward);
        let parameters = vec![
            one("f_c", forward, 2.0),
            one("f_c", backward, 2.0),
            one("f_s", forward, 1.9),
            one("f_s", backward, 2.2),
            one("v_s", Side::Both, 0.1),
        ];
        let mut estimates = Estimates { parameters, ..Estimates::default() };
        let structure = AxisStructure { stribeck: true, ..AxisStructure::ASYMMETRIC };
        below(&structure, &mut estimates);
        let known = estimates.parameters.iter().map(Estimate::is_identified);
        assert_eq!(known.collect::<Vec<_>>(), [true, true, false, false, false]);
    }

    #[test]
    fn a_bristle_that_drives_the_axis_leaves_no_displacement() {
        let known = |damping: f64| {
            let one = |name: &'static str, value: f64| Estimate {
                standard_error: Some(0.1),
                verdict: Verdict::Identified,
                ..Estimate::given(name, "", value, "")
            };
            let parameters = vec![one("sigma1", damping), one("presliding", 2.0)];
            let mut estimates = Estimates { parameters, ..Estimates::default() };
            judge(&AxisStructure::SYMMETRIC, &mut estimates);
            estimates.get("presliding").unwrap().is_identified()
        };
        assert_eq!([-0.44, -0.15, 0.3].map(known), [false, true, true]);
    }

    /// Whether displacement and damping of a bristle whose level is 2 N m are identified.
    fn known_of(recording: &Conditioned, damping: f64, displacement: f64) -> [bool; 2] {
        let one = |name: &'static str, value: f64| Estimate {
            interval: Some(Interval {
                low: 0.9 * value,
                high: 1.1 * value,
                method: IntervalMethod::Robust,
            }),
            verdict: Verdict::Identified,
            ..Estimate::given(name, "", value, "")
        };
        let parameters =
            vec![one("f_c", 2.0), one("presliding", displacement), one("sigma1", damping)];
        let mut estimates = Estimates { parameters, ..Estimates::default() };
        sampled(recording, &mut estimates);
        ["presliding", "sigma1"].map(|name| estimates.get(name).unwrap().is_identified())
    }

    /// A stranger's rigid axes and bristles without damping had one "identified" at a third of a sample,
    /// and a displacement of half a step of the encoder.
    #[test]
    fn what_the_sampling_does_not_show_of_a_bristle_is_not_identified() {
        let recording =
            Conditioned { sampled: 1e-3, step: 1e-5, ..super::super::tests::damped_bristle() };
        let known = |damping, displacement| known_of(&recording, damping, displacement);
        // Half a sample is worth 0.5e-3 s * 2 N m / 1e-3 rad = 1 N m s/rad.
        assert_eq!(known(0.9, 1e-3), [true, false]);
        assert_eq!(known(1.2, 1e-3), [true, true]);
        assert_eq!(known(1e6, 0.9e-5), [false, false]);
        assert_eq!(known(1e6, 1.2e-5), [true, true]);
    }

    /// The low-pass spread the starts of rigid axes over 2.5 ms: a bristle of a few steps of the encoder,
    /// with a damping of two samples.
    #[test]
    fn where_the_axis_sticks_a_bristle_must_be_slower_than_the_low_pass() {
        let recording = Conditioned {
            sampled: 1e-3,
            spread: 2.5e-3,
            sticking: true,
            stops_to_turn: false,
            step: 1e-5,
            ..super::super::tests::damped_bristle()
        };
        assert_eq!(known_of(&recording, 4.0, 1e-3), [false, false]);
        assert_eq!(known_of(&recording, 6.0, 1e-3), [true, true]);
    }
}
