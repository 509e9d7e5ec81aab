//! Any model, chosen while the program runs: presets, parameters by name, and both directions.

use crate::{AnyModel, AnyParameters, ModelError, ModelName};

impl AnyModel {
    /// The model of that name with the parameters of the thesis's test bed.
    ///
    /// # Panics
    /// Never: a test builds every preset.
    #[must_use]
    pub fn test_bed(name: ModelName) -> Self {
        AnyParameters::test_bed(name).try_into().expect("constants within range")
    }

    /// The model of that name with the parameters of the thesis's chapter 3 (N, m, s).
    ///
    /// # Panics
    /// Never: a test builds every preset.
    #[must_use]
    pub fn chapter_3(name: ModelName) -> Self {
        AnyParameters::chapter_3(name).try_into().expect("constants within range")
    }

    /// Its parameters.
    #[must_use]
    pub fn parameters(&self) -> AnyParameters {
        (*self).into()
    }

    /// `forward` against forward motion and `backward` against backward motion, see
    /// [`crate::Asymmetric`].
    ///
    /// # Errors
    /// [`ModelError::TwoModels`] if they are of different models, or asymmetric themselves.
    pub fn asymmetric(forward: &Self, backward: &Self) -> Result<Self, ModelError> {
        AnyParameters::asymmetric(forward.parameters(), backward.parameters())?.try_into()
    }

    /// The value of the parameter `name`, of an asymmetric contact the forward one; `None` if there
    /// is none of that name or if it is a list.
    #[must_use]
    pub fn parameter(&self, name: &str) -> Option<f64> {
        let (forward, _) = self.parameters().sides();
        let (mut value, mut count) = (None, 0);
        forward.each(name, &mut |x| (value, count) = (Some(x), count + 1));
        value.filter(|_| count == 1)
    }

    /// The same model with the parameter `name` multiplied by `factor`, in both directions. A name
    /// that the model does not have changes nothing.
    ///
    /// # Errors
    /// [`ModelError`] if the model does not accept it.
    pub fn scaled(&self, name: &str, factor: f64) -> Result<Self, ModelError> {
        let mut parameters = self.parameters();
        parameters.scale(name, factor);
        parameters.try_into()
    }
}

impl AnyParameters {
    /// The model with these parameters for its directions, which [`sides`](Self::sides) gave and
    /// something changed. `backward` counts where it is asymmetric.
    ///
    /// # Errors
    /// [`ModelError`] if the model refuses them.
    pub fn with_sides(&self, forward: Self, backward: Self) -> Result<AnyModel, ModelError> {
        match self {
            Self::Asymmetric(_) => Self::asymmetric(forward, backward)?.try_into(),
            _ => forward.try_into(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::presets::Presets;
    use crate::{FrictionModel, ModelVisitor, Proposed, ProposedParameters, Stepper, TimeStep};

    #[test]
    fn every_preset_reads_back_from_a_file() {
        for name in ModelName::ALL {
            for model in [AnyModel::test_bed(name), AnyModel::chapter_3(name)] {
                assert_eq!(model.name(), name);
                let text = serde_json::to_string(&model).unwrap();
                assert!(text.starts_with(&format!("{{\"{name}\":")), "{text}");
                assert_eq!(serde_json::from_str::<AnyModel>(&text).unwrap(), model);
            }
        }
    }

    #[test]
    fn every_model_calls_itself_as_files_do() {
        struct Name;
        impl ModelVisitor for Name {
            type Output = &'static str;
            fn visit<M: FrictionModel>(self, _: M) -> &'static str {
                M::NAME
            }
        }
        for name in ModelName::ALL {
            assert_eq!(AnyModel::test_bed(name).visit(Name), name.as_str());
        }
    }

    #[test]
    fn an_asymmetric_model_reads_back_from_a_file() {
        for name in ModelName::ALL {
            let model = AnyModel::asymmetric(&AnyModel::test_bed(name), &AnyModel::chapter_3(name))
                .unwrap();
            let text = serde_json::to_string(&model).unwrap();
            assert!(
                text.starts_with(&format!("{{\"asymmetric\":{{\"{name}\":{{\"forward\":")),
                "{text}"
            );
            assert_eq!(serde_json::from_str::<AnyModel>(&text).unwrap(), model);
            assert_eq!(model.name(), name);
            assert_eq!(model.steady_state(-0.3), AnyModel::chapter_3(name).steady_state(-0.3));
        }
        let two = [ModelName::LuGre, ModelName::Proposed].map(AnyModel::test_bed);
        assert!(AnyModel::asymmetric(&two[0], &two[1]).unwrap_err().to_string().contains("lugre"));
    }

    #[test]
    fn every_parameter_has_a_row_and_can_be_scaled() {
        for name in ModelName::ALL {
            let parameters = AnyParameters::test_bed(name);
            assert!(!parameters.table().is_empty());
            for row in parameters.table() {
                let (mut before, mut after) = (Vec::new(), Vec::new());
                parameters.each(row.name, &mut |x| before.push(x));
                let mut scaled = parameters;
                assert!(scaled.scale(row.name, 2.0), "{name}.{}", row.name);
                scaled.each(row.name, &mut |x| after.push(x));
                assert_eq!(
                    after,
                    before.iter().map(|x| 2.0 * x).collect::<Vec<_>>(),
                    "{name}.{}",
                    row.name
                );
                assert!(before.iter().all(|&x| row.range.holds(x)), "{name}.{}", row.name);
                assert!(!before.is_empty() || row.optional, "{name}.{}", row.name);
                assert!(row.meaning.len() > 10, "{name}.{}: {}", row.name, row.meaning);
            }
        }
    }

    #[test]
    fn every_number_can_be_set_by_its_place() {
        for name in ModelName::ALL {
            let before = AnyParameters::test_bed(name);
            for row in before.table() {
                for (index, value) in before.values(row.name).into_iter().enumerate() {
                    let mut after = before;
                    assert!(
                        after.set_at(row.name, index, 3.0 * value),
                        "{name}.{}[{index}]",
                        row.name
                    );
                    assert_eq!(after.values(row.name)[index], 3.0 * value);
                }
                assert!(!{ before }.set_at(row.name, 200, 1.0));
            }
        }
    }

    #[test]
    fn a_file_with_an_impossible_parameter_is_refused_with_the_reason() {
        let text =
            r#"{"lugre":{"f_s":1.0,"f_c":1.0,"v_s":0.1,"sigma0":-5.0,"sigma1":0.1,"f_v":0.0}}"#;
        let message = serde_json::from_str::<AnyModel>(text).unwrap_err().to_string();
        assert!(message.contains("lugre.sigma0") && message.contains("-5"), "{message}");
    }

    #[test]
    fn a_chosen_model_steps_as_the_model_itself() {
        let dt = TimeStep::new(1e-3).unwrap();
        let mut any = AnyModel::test_bed(ModelName::Proposed).start(dt);
        let mut own = Stepper::new(Proposed::test_bed(), dt);
        assert_eq!(*own.model().parameters(), ProposedParameters::test_bed());
        for k in 0..2000 {
            let v = 0.3 * (0.0031 * f64::from(k)).sin();
            assert_eq!(any.step(v), own.step(v));
        }
    }
}
