use friction_model::{AnyModel, ModelName};

use super::*;
use crate::estimate::{Doubt, Estimate, Estimates, Verdict};
use crate::information::{Difference, Information};
use crate::position_load::PositionLoad;
use crate::staged::Identified;

fn candidate(mean_square: f64, standard_error: f64, free_parameters: usize) -> Candidate {
    let ln_ratio = Difference { mean: 0.0, standard_error: 0.1 };
    Candidate { mean_square, standard_error, free_parameters, ln_ratio, fit: true }
}

/// "Worse: 6.98 times the mean square in the usual block (2.41 to 20.2)", and chosen: a few breakaways
/// that no model predicts made one standard error that wide.
#[test]
fn what_is_clearly_worse_in_the_usual_block_is_not_chosen_for_being_simple() {
    let best = candidate(1.0, 0.5, 6);
    let plain = |mean: f64, standard_error: f64| Candidate {
        ln_ratio: Difference { mean, standard_error },
        ..candidate(1.1, 0.5, 2)
    };
    assert_eq!(choose(&[best, plain(7f64.ln(), 0.5)]), Some(0));
    // By little, or by chance, is no reason.
    assert_eq!(choose(&[best, plain(1.2f64.ln(), 0.01)]), Some(1));
    assert_eq!(choose(&[best, plain(7f64.ln(), 1.2)]), Some(1));
}

/// A fit that ran away has no identified parameter, and was once taken for the simplest model.
#[test]
fn a_fit_that_cannot_be_trusted_is_never_chosen() {
    let diverged = Candidate { fit: false, ..candidate(1.0, 0.5, 0) };
    assert_eq!(choose(&[diverged, candidate(1.1, 0.01, 6)]), Some(1));
    assert_eq!(choose(&[diverged]), None);
    assert_eq!(choose(&[candidate(f64::NAN, 0.1, 1), candidate(1.0, 0.1, 6)]), Some(1));
}

/// It is the best model's error that gives the leave, not that of the comparison: a model that does
/// badly in one block would else be chosen because its own excess is uncertain.
#[test]
fn only_the_error_of_the_best_gives_leave_to_be_simpler() {
    let best = candidate(1.0, 0.1, 6);
    assert_eq!(choose(&[best, candidate(1.09, 5.0, 2)]), Some(1));
    assert_eq!(choose(&[best, candidate(1.11, 5.0, 2)]), Some(0));
    // Of two alike the better one.
    assert_eq!(choose(&[candidate(1.05, 0.1, 2), candidate(1.02, 0.1, 2), best]), Some(1));
    // Where nothing is known of the error there is no leave.
    assert_eq!(choose(&[candidate(1.0, f64::INFINITY, 6), candidate(1.001, 0.1, 2)]), Some(0));
    // However uncertain the best is: a fifth more error is noticed.
    assert_eq!(choose(&[candidate(1.0, 1.0, 6), candidate(1.5, 1.0, 2)]), Some(0));
}

#[test]
fn what_kinds_of_recording_differ_by_is_no_scatter() {
    let even = |size: f64| vec![size; 100];
    assert!(standard_error(&[even(1.0), even(3.0)], 20) < 1e-12);
    assert!(standard_error(&[vec![1.0]], 20).is_infinite());
    // Blocks of 1 and 4 by turns: a standard deviation of the mean of 1.5 sqrt(2 / 4) / sqrt(2)
    // and so on; four blocks of mean squares 1, 4, 1, 4 have a variance of 3.
    let blocks: Vec<f64> = (0..40).map(|k| if k / 10 % 2 == 0 { 1.0 } else { 2.0 }).collect();
    assert!((standard_error(&[blocks], 4) - (3.0f64 / 4.0).sqrt()).abs() < 1e-12);
}

fn found(estimates: Vec<Estimate>) -> Identified {
    Identified {
        load: PositionLoad::default(),
        name: ModelName::Stribeck,
        model: AnyModel::test_bed(ModelName::Stribeck),
        stages: Vec::new(),
        estimates: Estimates { parameters: estimates, ..Estimates::default() },
        information: Information::new(1.0, 100, 1.0, 4),
        stopped: false,
        converged: true,
        free_parameters: 4,
        notes: Vec::new(),
    }
}

fn estimate(name: &'static str, value: f64, doubt: Option<Doubt>) -> Estimate {
    let verdict = match doubt {
        None => Verdict::Identified,
        Some(doubt) => Verdict::NotIdentifiable { doubt, remedy: "more" },
    };
    let standard_error = (verdict == Verdict::Identified).then_some(0.01);
    Estimate { id: name.into(), unit: "N m", value, standard_error, interval: None, verdict }
}

#[test]
fn a_fit_that_ran_away_says_so() {
    let infinite = || Some(Doubt::LargeError { relative_error: f64::INFINITY });
    let far = found(vec![estimate("f_c", 2.0, None), estimate("f_s", 1166.0, infinite())]);
    let said = unfit(&far, 4.0).unwrap().to_string();
    assert!(said.contains("diverged") && said.contains("f_s is 1.166e3"), "{said}");
    let blind = found(vec![estimate("f_c", 2.0, infinite()), estimate("f_s", 2.5, infinite())]);
    let said = unfit(&blind, 4.0).unwrap().to_string();
    assert!(said.contains("the errors of f_c, f_s are infinite"), "{said}");
    let broken = found(vec![estimate("f_c", f64::NAN, None)]);
    assert!(matches!(unfit(&broken, 4.0), Some(Unfit::NotFinite(_))));
    let early = Identified { converged: false, ..found(vec![estimate("f_c", 2.0, None)]) };
    assert_eq!(unfit(&early, 4.0), Some(Unfit::NotConverged));
    assert_eq!(unfit(&found(vec![estimate("f_c", 2.0, None)]), 4.0), None);
}

/// The limits of a search are no result; an effect that is not there is one.
#[test]
fn a_bound_is_told_from_an_absent_effect() {
    let at = |name, value| estimate(name, value, Some(Doubt::AtBound { bound: value }));
    let stuck = found(vec![estimate("f_c", 2.0, None), at("v_s", 1e-4)]);
    assert!(unfit(&stuck, 4.0).unwrap().to_string().contains("bound: v_s is"));
    let plain = found(vec![estimate("f_c", 2.0, None), at("f_s", 2.0), at("f_v", 0.0)]);
    assert_eq!(unfit(&plain, 4.0), None);
}
