//! The export itself: what a target holds of the friction, what that costs, and the file.

use crate::contact::Contact;
use crate::cost::Cost;
use crate::formats::{self, Drive};
use crate::lost::lost;
use crate::options::Options;
use crate::{Given, Holds, Refusal, Release, Target, Version, choice, fit, head};

/// The largest root mean square error in steady sliding that is exported unasked \[% of the Coulomb
/// level\].
pub const SLIDING_BAR: f64 = 10.0;
/// The same along the swings, where reversals count.
pub const SWINGS_BAR: f64 = 50.0;

/// A file for a target.
#[derive(Debug, Clone, PartialEq)]
pub struct Exported {
    /// The file.
    pub text: String,
    /// What it is for.
    pub target: Target,
    /// Which version.
    pub version: Version,
    /// The friction that the target computes.
    pub contact: Contact,
    /// What it costs.
    pub cost: Cost,
    /// What the target cannot hold.
    pub lost: Vec<String>,
    /// What was accepted although it is refused unasked.
    pub accepted: Vec<String>,
}

/// Writes the friction of a joint for a target; `version` is its newest if none is given.
///
/// # Errors
/// [`Refusal`] for what would mislead, and for what the target cannot take; nothing of it is
/// written then.
pub fn export(
    given: &Given,
    target: Target,
    version: Option<Version>,
    options: &Options,
) -> Result<Exported, Refusal> {
    options.check(target)?;
    let version = version.unwrap_or(target.facts().newest);
    let release = choice::release(target, version)?;
    if given.volts && target != Target::KsKvKa {
        return Err(Refusal::Volts { target });
    }
    // Friction that drives is refused before anything is fitted to it.
    Cost::of(&given.model, &given.model, &given.speeds)?;
    let contact = held(given, (target, version, release))?;
    let mut accepted = Vec::new();
    let pre_sliding = matches!(contact, Contact::LuGre(_) | Contact::Own(_));
    let doubts = given.doubts(pre_sliding);
    if !doubts.is_empty() {
        if !options.accept_unidentified {
            return Err(Refusal::Unidentified { doubts });
        }
        accepted.push(format!("nobody identified {}", doubts.join(", ")));
    }
    let cost = Cost::of(&given.model, &contact.model()?, &given.speeds)?;
    let lost = lost(given, &contact);
    for (errors, bar, part) in [
        (&cost.sliding, SLIDING_BAR, "in steady sliding"),
        (&cost.swings, SWINGS_BAR, "along swings with reversals"),
    ] {
        let percent = cost.percent(errors.rms);
        if percent <= bar {
            continue;
        }
        if !options.accept_error {
            let lost = if lost.is_empty() { "it".to_owned() } else { lost.join("; ") };
            return Err(Refusal::Misleading { target, version, percent, bar, part, lost });
        }
        accepted.push(format!("the error {part} is beyond {bar} % of the Coulomb level"));
    }
    let joint = options.joint.as_str();
    let head = head::lines(given, (target, version, release), &cost, &lost, &accepted, joint);
    let drive = Drive { contact, given, version, options, head, cost };
    let text = formats::render(target, &drive)?;
    Ok(Exported { text, target, version, contact, cost, lost, accepted })
}

/// The nearest that the target holds.
fn held(
    given: &Given,
    (target, version, release): (Target, Version, &Release),
) -> Result<Contact, Refusal> {
    let Given { model, speeds, .. } = given;
    let coulomb_viscous = || {
        let (f_c, f_v) = fit::coulomb_viscous(model, speeds);
        Contact::CoulombViscous { f_c, f_v }
    };
    let lugre = || exact_lugre(given).or_else(|| fit::lugre(model, speeds).map(Contact::LuGre));
    Ok(match release.holds {
        Holds::Nothing(why) => return Err(Refusal::NoFriction { target, version, why }),
        Holds::CoulombViscous => coulomb_viscous(),
        Holds::StaticDynamicViscous => {
            let (f_d, f_v) = fit::coulomb_viscous(model, speeds);
            Contact::StaticDynamicViscous {
                f_s: fit::level_at_rest(model, speeds).max(f_d),
                f_d,
                f_v,
            }
        }
        Holds::Stribeck => stribeck(given),
        Holds::LuGre => lugre().unwrap_or_else(coulomb_viscous),
        Holds::Step if formats::has_step(model) => Contact::Own(*model),
        Holds::Step => lugre().unwrap_or_else(|| stribeck(given)),
    })
}

fn stribeck(given: &Given) -> Contact {
    match given.model {
        friction_model::AnyModel::Stribeck(model) => {
            Contact::Stribeck(*friction_model::FrictionModel::<f64>::parameters(&model))
        }
        _ => Contact::Stribeck(fit::stribeck(&given.model, &given.speeds)),
    }
}

/// LuGre as it is, where the model is LuGre with exponent 2 and constant micro-damping.
fn exact_lugre(given: &Given) -> Option<Contact> {
    let friction_model::AnyModel::LuGre(model) = given.model else { return None };
    let parameters = *friction_model::FrictionModel::<f64>::parameters(&model);
    (parameters.delta == 2.0 && parameters.v_d.is_none()).then_some(Contact::LuGre(parameters))
}
