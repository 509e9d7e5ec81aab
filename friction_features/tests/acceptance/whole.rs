//! All features at once.

use friction_features::{FeatureSettings, features};
use friction_model::{AnyModel, ModelName};

#[test]
fn every_figure_is_finite_and_has_a_name_of_its_own() {
    for name in [ModelName::Viscous, ModelName::Stribeck, ModelName::Proposed] {
        let all = features(
            &AnyModel::chapter_3(name),
            &AnyModel::test_bed(name),
            &FeatureSettings::default(),
        );
        let figures = all.figures();
        assert!(figures.len() > 30, "{name}");
        for (i, figure) in figures.iter().enumerate() {
            assert!(figure.value.is_none_or(f64::is_finite), "{name}: {figure:?}");
            assert!(
                figures[..i].iter().all(|other| other.figure != figure.figure),
                "{name}: {figure:?}"
            );
        }
        // Files carry all of it: what is not finite would come out as null and not be read back.
        let text = serde_json::to_string(&all).unwrap();
        let back: friction_features::Features = serde_json::from_str(&text).unwrap();
        assert_eq!(back.figures().len(), figures.len());
    }
}

#[test]
fn settings_may_be_given_in_part() {
    let settings: FeatureSettings =
        serde_json::from_str(r#"{"stick_slip": {"speed": 0.2}}"#).unwrap();
    assert_eq!(settings.stick_slip.speed, 0.2);
    assert_eq!(settings.non_drift, FeatureSettings::default().non_drift);
    let message =
        serde_json::from_str::<FeatureSettings>(r#"{"stick_slip": {"sped": 0.2}}"#).unwrap_err();
    assert!(message.to_string().contains("sped"), "{message}");
}
