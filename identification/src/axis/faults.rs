//! What a plain model is warned of, and how that is said beside a structure that was chosen.

use std::mem::discriminant;

use friction_ident::adequacy::FitDoubt;

use super::structure::Structured;
use super::{Identification, ModelResult};

/// A fault of a plain model.
#[derive(Debug, Clone, PartialEq)]
pub struct Fault {
    /// What it is; none for a model that cannot be.
    pub doubt: Option<FitDoubt>,
    /// The sentence.
    pub said: String,
}

impl Fault {
    /// Adds whether the structure that was chosen has it too: what concerns a model that was not
    /// chosen is no warning of the result.
    fn stand_beside(&mut self, chosen: &Structured) {
        let name = chosen.fit.structure;
        let shared = self.doubt.is_some_and(|own| chosen.doubts.iter().any(|of| alike(own, *of)));
        self.said.push_str(&if shared {
            format!(" The structure that was chosen, {name}, has this fault too.")
        } else {
            format!(
                " That is about this model alone: the structure that was chosen, {name}, does not have this fault."
            )
        });
    }
}

impl Identification {
    /// The plain models.
    pub fn plain(&self) -> impl Iterator<Item = &ModelResult> {
        std::iter::once(&self.symmetric).chain(&self.asymmetric)
    }

    /// What a plain model is warned of beside the structure that was chosen; nothing where none was,
    /// and the warnings have it.
    pub fn beside(&self, model: &ModelResult) -> Vec<String> {
        let faults = model.faults.iter().map(|fault| &fault.said);
        faults.filter(|said| !self.warnings.contains(said)).cloned().collect()
    }

    /// Puts the chosen structure's warnings first; those of the plain models go to these.
    pub(crate) fn stand_beside(&mut self, chosen: &Structured) {
        for model in std::iter::once(&mut self.symmetric).chain(&mut self.asymmetric) {
            self.warnings.retain(|said| model.faults.iter().all(|fault| fault.said != *said));
            // It is of the recording: the chosen structure has said it.
            let told = |own: FitDoubt| {
                own.is_of_the_recording() && chosen.doubts.iter().any(|of| alike(own, *of))
            };
            let again = |fault: &Fault| fault.doubt.is_some_and(told);
            model.faults.retain(|fault| !again(fault));
            model.faults.iter_mut().for_each(|fault| fault.stand_beside(chosen));
        }
        if let Some((found, inertia)) = self.one_speed.as_mut().zip(chosen.ramps) {
            let before = found.said.clone();
            found.tell(inertia, &self.symmetric.fit, self.settings.axis);
            for warning in self.warnings.iter_mut().filter(|warning| **warning == before) {
                warning.clone_from(&found.said);
            }
        }
        self.warnings.splice(0..0, chosen.warnings.iter().cloned());
    }
}

/// Whether both are of one kind, whatever the numbers.
pub(super) fn alike(one: FitDoubt, other: FitDoubt) -> bool {
    match (one, other) {
        (FitDoubt::Pattern { quantity: one, .. }, FitDoubt::Pattern { quantity: other, .. }) => {
            one == other
        }
        _ => discriminant(&one) == discriminant(&other),
    }
}

#[cfg(test)]
mod tests {
    use friction_ident::adequacy::Quantity;

    use super::*;

    #[test]
    fn faults_are_compared_by_kind() {
        let pattern = |quantity, share| FitDoubt::Pattern { quantity, share };
        assert!(alike(pattern(Quantity::Velocity, 0.2), pattern(Quantity::Velocity, 0.6)));
        assert!(!alike(pattern(Quantity::Velocity, 0.2), pattern(Quantity::Position, 0.2)));
        let unexplained = FitDoubt::Unexplained { explained: 0.5 };
        assert!(!alike(unexplained, FitDoubt::Drifts { change: 0.5 }));
        assert!(alike(unexplained, FitDoubt::Unexplained { explained: 0.8 }));
    }
}
