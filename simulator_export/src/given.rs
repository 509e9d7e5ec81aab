//! What is exported: the friction of one joint, and all that is known of it.

use friction_model::{AnyModel, AnyParameters, ModelName};
use sha2::{Digest, Sha256};

use crate::annotations::{Annotations, Origin};
use crate::{Axis, Refusal, Speeds, SpeedsFrom};

/// Models with pre-sliding that slide by a Stribeck curve, or by one level.
const BY_A_CURVE: [ModelName; 6] = [
    ModelName::Dahl,
    ModelName::LuGre,
    ModelName::ElastoPlastic,
    ModelName::Gms,
    ModelName::Xiong,
    ModelName::Proposed,
];
/// The parameters by which these slide; all others are of pre-sliding or of memory.
const OF_SLIDING: [&str; 5] = ["f_s", "f_c", "v_s", "delta", "f_v"];

/// Where the parameters come from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Source {
    /// The file, as it was named.
    pub name: String,
    /// SHA-256 of its text, in hexadecimal digits.
    pub sha256: String,
    /// Its first line, if that is a comment: who made it, from what.
    pub first: Option<String>,
}

/// Torque that depends on the angle, `amplitude sin(periods q + phase)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cogging {
    /// Amplitude \[N m\].
    pub amplitude: f64,
    /// Periods a revolution of the joint.
    pub periods: f64,
    /// Phase \[rad\].
    pub phase: f64,
}

/// The friction of one joint.
#[derive(Debug, Clone, PartialEq)]
pub struct Given {
    /// The friction.
    pub model: AnyModel,
    /// Where it comes from.
    pub source: Source,
    /// Whether the joint turns.
    pub axis: Axis,
    /// The speeds over which it was identified.
    pub speeds: Speeds,
    /// Whether it is in volts.
    pub volts: bool,
    /// What of it was never identified: the parameter, and what the file says.
    pub doubts: Vec<(&'static str, String)>,
    /// What was not estimated, and why that is as it should be.
    pub taken: Vec<(&'static str, String)>,
}

impl Given {
    /// The model with what the comments of its parameter file say; `name` is the file's. The speeds
    /// that are `asked` for come before those of the file.
    ///
    /// # Errors
    /// [`Refusal::Speeds`] for a line of speeds that are no range.
    pub fn new(
        model: AnyModel,
        name: &str,
        text: &str,
        asked: Option<Speeds>,
        axis: Option<Axis>,
    ) -> Result<Self, Refusal> {
        let said = Annotations::read(text)?;
        let of_file = said.speeds.map(|(low, high)| Speeds::new(low, high, SpeedsFrom::File));
        let speeds = match (asked, of_file) {
            (Some(asked), _) => asked,
            (None, Some(of_file)) => of_file?,
            (None, None) => Speeds::assumed(&model),
        };
        let digest = Sha256::digest(text.as_bytes());
        let sha256 = digest.iter().map(|byte| format!("{byte:02x}")).collect();
        let (mut doubts, mut taken) = (Vec::new(), Vec::new());
        let parameters = model.parameters();
        for row in parameters.table() {
            match said.origin(model.name().as_str(), row.name) {
                Some(Origin::Identified) => {}
                Some(Origin::Given(why)) => taken.push((row.name, why)),
                Some(Origin::Doubtful(why)) => doubts.push((row.name, why)),
                // One that the file leaves out, and the model too.
                None if row.optional => {}
                None => doubts.push((row.name, "the file does not have it".to_owned())),
            }
        }
        let source = Source { name: name.to_owned(), sha256, first: said.first };
        let axis = axis.or(said.axis).unwrap_or_default();
        Ok(Self { model, source, axis, speeds, volts: said.volts, doubts, taken })
    }

    /// The parameters in doubt that matter to a target: all of them, or those by which the contact
    /// slides. Each with what the file says.
    #[must_use]
    pub fn doubts(&self, pre_sliding: bool) -> Vec<String> {
        let all = pre_sliding || !BY_A_CURVE.contains(&self.model.name());
        self.doubts
            .iter()
            .filter(|(name, _)| all || OF_SLIDING.contains(name))
            .map(|(name, why)| {
                let why =
                    if why.is_empty() { "nothing is said of where it comes from" } else { why };
                format!("{name} ({why})")
            })
            .collect()
    }

    /// Whether each direction has its own parameters.
    #[must_use]
    pub fn is_asymmetric(&self) -> bool {
        matches!(self.model.parameters(), AnyParameters::Asymmetric(_))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_asked_for_comes_before_the_file_and_the_file_before_assumptions() {
        let model = AnyModel::test_bed(ModelName::LuGre);
        let file = "# Speeds of the recordings: 0.1 to 2.0 m/s\nlugre:\n  f_s: 0.1 # identified\n";
        let given = Given::new(model, "a.yaml", file, None, None).unwrap();
        assert_eq!((given.speeds.high(), given.axis), (2.0, Axis::Linear));
        assert_eq!(given.source.sha256.len(), 64);
        let asked = Speeds::new(0.0, 9.0, SpeedsFrom::Asked).unwrap();
        let given = Given::new(model, "a.yaml", file, Some(asked), Some(Axis::Rotary)).unwrap();
        assert_eq!((given.speeds.high(), given.axis), (9.0, Axis::Rotary));
        let given = Given::new(model, "a.yaml", "lugre: {}", None, None).unwrap();
        assert_eq!(given.speeds.from(), SpeedsFrom::Assumed);
    }

    #[test]
    fn pre_sliding_is_no_matter_to_whoever_has_none() {
        let model = AnyModel::test_bed(ModelName::LuGre);
        let said = |what: &str| {
            let names = ["f_s", "f_c", "v_s", "delta", "f_v"];
            let lines: String = names.map(|name| format!("  {name}: 1.0 # identified\n")).concat();
            let text =
                format!("lugre:\n{lines}  sigma1: 0.1 # {what}\n  sigma0: 1.0 # identified\n");
            Given::new(model, "a.yaml", &text, None, None).unwrap()
        };
        let given = said("not identifiable from these recordings");
        assert_eq!(given.doubts(false), Vec::<String>::new());
        assert_eq!(given.doubts(true).len(), 1);
        assert!(said("not estimated: from the damping ratio").doubts(true).is_empty());
    }
}
