//! The models that compensate, with the parameters they are given.

use std::collections::BTreeMap;

use friction_ident::StribeckValues;
use friction_model::{AnyModel, ModelError, ModelName};
use serde::Serialize;

/// One parameter set for each model.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(transparent)]
pub struct Compensators(BTreeMap<ModelName, AnyModel>);

impl Default for Compensators {
    /// The thesis's test bed.
    fn default() -> Self {
        Self(ModelName::ALL.map(|name| (name, AnyModel::test_bed(name))).into())
    }
}

impl Compensators {
    /// The model of that name.
    #[must_use]
    pub fn get(&self, name: ModelName) -> AnyModel {
        self.0.get(&name).copied().unwrap_or_else(|| AnyModel::test_bed(name))
    }

    /// Takes `model` in, in place of the one of the same name.
    pub fn set(&mut self, model: AnyModel) {
        self.0.insert(model.name(), model);
    }

    /// The same models with the identified static parameters; stiffness, damping and lag stay as
    /// they were.
    ///
    /// # Errors
    /// [`ModelError`] if a model does not accept them.
    pub fn with_static(&self, found: &StribeckValues) -> Result<Self, ModelError> {
        let StribeckValues { f_s, f_c, v_s, f_v, delta } = *found;
        let models = self.0.iter().map(|(name, model)| {
            let mut parameters = model.parameters();
            // What must keep its place between the levels moves with them.
            for (level, found, tied) in [("f_s", f_s, "f_h"), ("f_c", f_c, "z_ba")] {
                if let Some(before) = model.parameter(level) {
                    // Not below by a rounding.
                    parameters.scale(tied, found / before * (1.0 + 1e-12));
                }
            }
            for (parameter, value) in
                [("f_s", f_s), ("f_c", f_c), ("v_s", v_s), ("f_v", f_v), ("delta", delta)]
            {
                parameters.set(parameter, value);
            }
            Ok((*name, parameters.try_into()?))
        });
        models.collect::<Result<_, _>>().map(Self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn identified_levels_replace_the_static_parameters_only() {
        let found = StribeckValues { f_s: 0.2, f_c: 0.1, v_s: 0.3, f_v: 0.05, delta: 2.0 };
        let models = Compensators::default().with_static(&found).unwrap();
        for name in [ModelName::Stribeck, ModelName::LuGre, ModelName::Proposed] {
            let expected = found.torque(0.2);
            assert!((models.get(name).steady_state(0.2) - expected).abs() < 1e-15, "{name}");
        }
        let model = models.get(ModelName::Proposed);
        assert_eq!((model.parameter("sigma"), model.parameter("z_b")), (Some(0.3213), Some(0.006)));
    }
}
