use std::ops::ControlFlow;

use friction_model::{AnyModel, AnyParameters, ModelName};
use rand::{RngExt, SeedableRng};
use rand_distr::StandardNormal;

use super::{FrictionData, StagedOptions, choose_position_load, identify_model};
use crate::output_error::predict;
use crate::place::Place;
use crate::position_load::LoadShape;
use crate::rigid_axis::Load;
use crate::steady_point::SteadyPoint;
use crate::stretch::Stretch;

const DT: f64 = 2e-3;

fn lugre() -> AnyModel {
    let mut parameters = AnyParameters::test_bed(ModelName::LuGre);
    let values = [("f_s", 1.4), ("f_c", 1.0), ("v_s", 0.05), ("f_v", 0.5), ("sigma0", 100.0)];
    for (name, value) in values {
        parameters.set(name, value);
    }
    parameters.try_into().unwrap()
}

/// A joint that reverses at ever other places, with LuGre's friction and `load`.
fn recording(seconds: f64, reach: f64, load: impl Fn(f64) -> f64, seed: u64) -> Stretch {
    let mut rng = rand_pcg::Pcg64Mcg::seed_from_u64(seed);
    let phase = rng.random::<f64>();
    let waves = [(0.6, 0.7), (0.35, 1.63), (0.1, 3.9)];
    let sum = |t: f64, of: fn(f64, f64, f64) -> f64| -> f64 {
        waves.iter().map(|&(a, w)| reach * of(a, w, t + phase)).sum()
    };
    let n = (seconds / DT) as usize;
    let time = || (0..n).map(|k| k as f64 * DT);
    let position: Vec<f64> = time().map(|t| sum(t, |a, w, t| a * (w * t).sin())).collect();
    let velocity: Vec<f64> = time().map(|t| sum(t, |a, w, t| a * w * (w * t).cos())).collect();
    let mut stretch = Stretch::new(DT, velocity, Some(position), vec![0.0; n]).unwrap();
    stretch.friction = predict(&lugre(), &stretch);
    for (friction, &q) in stretch.friction.iter_mut().zip(stretch.position.iter().flatten()) {
        *friction += load(q) + 0.02 * rng.sample::<f64, _>(StandardNormal);
    }
    stretch
}

fn data(load: impl Fn(f64) -> f64 + Copy, reach: f64) -> FrictionData {
    let stretches = vec![recording(20.0, reach, load, 1), recording(20.0, reach, load, 2)];
    FrictionData::sort(Vec::new(), stretches, None)
}

fn chosen(data: &FrictionData) -> LoadShape {
    choose_position_load(data, true, false).chosen
}

const OFFSET: LoadShape = LoadShape { offset: true, position: Load::None };

#[test]
fn what_acts_beside_friction_is_told_from_friction() {
    assert_eq!(chosen(&data(|_| 0.0, 1.3)), LoadShape::NONE);
    assert_eq!(chosen(&data(|_| 0.3, 1.3)), OFFSET);
    let spring = LoadShape { position: Load::Spring, ..OFFSET };
    assert_eq!(chosen(&data(|q| 0.3 + 2.0 * q, 0.2)), spring);
    let gravity = LoadShape { position: Load::Gravity, ..OFFSET };
    assert_eq!(chosen(&data(|q| 4.0 * (q + 0.4).cos(), 1.3)), gravity);
    // The bristles of small motion are springs, too; friction alone explains them.
    assert_eq!(chosen(&data(|_| 0.0, 0.05)), LoadShape::NONE);
}

/// Back and forth, faster and faster: the spring pulls in the last blocks most of all.
#[test]
fn a_spring_is_found_where_only_the_end_of_a_recording_goes_far() {
    let mut rng = rand_pcg::Pcg64Mcg::seed_from_u64(4);
    let speeds = [0.05, 0.1, 0.2, 0.4, 0.8, 1.6, 3.2].into_iter().flat_map(|v| [v, -v]);
    let velocity: Vec<f64> = speeds.flat_map(|v| [v; 750]).collect();
    let position = velocity.iter().scan(0.0, |x, v| {
        *x += v * DT;
        Some(*x)
    });
    let position: Vec<f64> = position.collect();
    let of = |(&v, q): (&f64, &f64)| {
        0.12 * v.signum() + 0.04 * v + 0.155 * q + 1e-3 * rng.sample::<f64, _>(StandardNormal)
    };
    let friction = velocity.iter().zip(&position).map(of).collect();
    let stretch = Stretch::new(DT, velocity, Some(position), friction).unwrap();
    let data = FrictionData::sort(Vec::new(), vec![stretch], None);
    let choice = choose_position_load(&data, true, false);
    assert_eq!(choice.chosen.position, Load::Spring, "{:?}", choice.compared);
}

#[test]
fn an_axis_that_goes_one_way_does_not_tell_an_offset_from_its_friction() {
    let mut recorded = recording(20.0, 1.3, |_| 0.3, 3);
    let forwards = recorded.velocity.iter().map(|&v| (v + 2.5).max(0.0)).collect();
    let friction = recorded.velocity.iter().map(|&v| if v < 0.0 { 1.0 } else { 1.3 }).collect();
    (recorded.velocity, recorded.friction, recorded.position) = (forwards, friction, None);
    let points = vec![SteadyPoint::new(0.5, 1.2), SteadyPoint::new(1.0, 1.3)];
    let data = FrictionData::sort(points, vec![recorded], None);
    let choice = choose_position_load(&data, true, false);
    assert!(choice.chosen == LoadShape::NONE && !choice.compared.is_empty(), "{choice:?}");
    assert!(choice.compared.iter().all(|(shape, _)| !shape.offset));
}

#[test]
fn without_a_position_only_an_offset_is_offered() {
    let mut data = data(|q| 4.0 * q, 1.3);
    data.mixed.iter_mut().for_each(|stretch| stretch.position = None);
    let choice = choose_position_load(&data, true, false);
    assert!(choice.compared.iter().all(|(shape, _)| shape.position == Load::None));
    let empty = choose_position_load(&FrictionData::default(), true, false);
    assert!(empty.chosen == LoadShape::NONE && empty.compared.is_empty());
}

fn error_of(beside: LoadShape, model: ModelName, data: &FrictionData) -> Vec<(String, f64, f64)> {
    let options = StagedOptions { beside, ..StagedOptions::default() };
    let go = &mut |_, _: &_| ControlFlow::Continue(());
    let found = identify_model(model, data, &options, go).unwrap();
    let off = |estimate: &crate::Estimate| {
        let id = estimate.id.to_string();
        (id, estimate.value, estimate.standard_error.unwrap_or(f64::NAN))
    };
    found.estimates.parameters.iter().map(off).collect()
}

/// A joint under gravity whose friction is fitted without it has parameters that are far off.
#[test]
fn parameters_are_those_of_the_friction_whatever_acts_beside_it() {
    let data = data(|q| 0.2 + 4.0 * (q + 0.4).cos(), 1.3);
    let value = |found: &[(String, f64, f64)], name: &str| {
        found.iter().find(|(id, ..)| id == name).map_or(f64::NAN, |(_, value, _)| *value)
    };
    let alone = error_of(LoadShape::NONE, ModelName::LuGre, &data);
    let together = error_of(chosen(&data), ModelName::LuGre, &data);
    let truth = [
        ("f_c", 1.0),
        ("f_v", 0.5),
        ("f_s", 1.4),
        ("sigma0", 100.0),
        ("offset", 0.2),
        ("gravity_sin", -4.0 * 0.4f64.sin()),
        ("gravity_cos", 4.0 * 0.4f64.cos()),
    ];
    for (name, value) in truth {
        let (_, found, error) = together.iter().find(|(id, ..)| id == name).unwrap();
        assert!((found - value).abs() < 4.0 * error, "{name}: {found} +- {error}, not {value}");
        assert!(error < &(0.1 * value.abs()), "{name}: {found} +- {error}");
    }
    assert!((value(&alone, "f_c") - 1.0).abs() > 0.3, "{alone:?}");
}

/// Steady points know where they were measured only as means.
#[test]
fn steady_points_show_an_offset_and_where_they_know_their_place_gravity() {
    let gravity = |q: f64| 0.8 * q.cos();
    let model = lugre();
    let point = |k: i32, placed: bool| {
        let v = 0.01 * f64::from(k - 60);
        let q = 1.4 * f64::from(k * 7 % 13) / 13.0 - 0.7;
        let noise = 1e-3 * (f64::from(k * 7919 % 101) / 50.0 - 1.0);
        let load = if placed { gravity(q) } else { 0.3 };
        let point = SteadyPoint::new(v, model.steady_state(v) + load + noise);
        SteadyPoint { place: placed.then(|| Place::at(q)), ..point }
    };
    let points = |placed| (0..121).filter(|k| *k != 60).map(|k| point(k, placed)).collect();
    let data = FrictionData { points: points(false), ..FrictionData::default() };
    assert_eq!(chosen(&data), OFFSET);
    let found = error_of(OFFSET, ModelName::Stribeck, &data);
    let (_, offset, _) = found.iter().find(|(id, ..)| id == "offset").unwrap();
    assert!((offset - 0.3).abs() < 1e-3, "{found:?}");
    let data = FrictionData { points: points(true), ..FrictionData::default() };
    assert_eq!(chosen(&data).position, Load::Gravity);
}

/// A contact that bends by a good part of the way is no spring beside friction.
#[test]
fn a_contact_that_hardly_slides_is_no_spring() {
    // It bends by 0.01 before it slides.
    for reach in [0.01, 0.02, 0.05] {
        let without = chosen(&data(|_| 0.0, reach));
        assert_eq!(without.position, Load::None, "{reach}");
    }
    let stiff = |q: f64| 10.0 * q;
    assert_eq!(chosen(&data(stiff, 0.1)).position, Load::Spring);
}
