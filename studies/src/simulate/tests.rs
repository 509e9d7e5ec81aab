//! What a simulation must keep to.

use friction_model::{Asymmetric, LoadDependent, ModelName, Proposed, Regime, Stepper, Viscous};

use super::*;
use recording::AxisKind;

/// A motion in memory.
#[derive(Debug, Clone)]
pub(super) struct Trajectory {
    pub time: Vec<f64>,
    pub velocity: Vec<f64>,
    pub load: Option<Vec<f64>>,
    pub axis: AxisKind,
}

impl Trajectory {
    fn motion(&self) -> Motion<impl Iterator<Item = Result<Point, RecordingError>>> {
        let load = |k| self.load.as_ref().map_or(0.0, |load| load[k]);
        let point =
            move |k| Point { time: self.time[k], velocity: self.velocity[k], load: load(k) };
        let points = (0..self.time.len()).map(move |k| Ok(point(k)));
        Motion { axis: self.axis, loaded: self.load.is_some(), points }
    }
}

fn motion(load: Option<f64>) -> Trajectory {
    let time: Vec<f64> = (0..2000).map(|k| f64::from(k) * 1e-3).collect();
    let velocity: Vec<f64> = time.iter().map(|t| 0.3 * (5.0 * t).sin()).collect();
    let load = load.map(|load| vec![load; time.len()]);
    Trajectory { time, velocity, load, axis: AxisKind::Rotary }
}

type Rows = Vec<Vec<String>>;

fn done(model: &AnyModel, motion: &Trajectory, settings: &Settings) -> (Rows, Done) {
    let mut text = Vec::new();
    let done = simulate(model, motion.motion(), settings, &mut text).unwrap();
    let text = String::from_utf8(text).unwrap();
    (text.lines().map(|line| line.split(',').map(str::to_owned).collect()).collect(), done)
}

fn run(model: &AnyModel, motion: &Trajectory, settings: &Settings) -> Rows {
    done(model, motion, settings).0
}

/// The forces along a motion, or what stopped them.
pub(super) fn forces(
    model: &AnyModel,
    motion: &Trajectory,
    settings: &Settings,
) -> Result<Vec<f64>, Stopped> {
    let mut text = Vec::new();
    simulate(model, motion.motion(), settings, &mut text)?;
    let text = String::from_utf8(text).unwrap();
    let rows: Rows = text.lines().map(|l| l.split(',').map(str::to_owned).collect()).collect();
    Ok(column(&rows, "torque_Nm"))
}

fn refused(model: &AnyModel, motion: &Trajectory, settings: &Settings) -> SimulateError {
    match simulate(model, motion.motion(), settings, &mut std::io::sink()) {
        Err(Stopped::Refused(error)) => error,
        other => panic!("{other:?}"),
    }
}

fn column(rows: &[Vec<String>], name: &str) -> Vec<f64> {
    let index = rows[0].iter().position(|head| head == name).unwrap();
    rows[1..].iter().map(|row| row[index].parse().unwrap()).collect()
}

pub(super) const HELD: Settings =
    Settings { scheme: Scheme::Held, dt: 1e-3, tolerance: 1e-6, load_gain: None };

/// With one step a row the result is what an observer at that rate would have said.
#[test]
fn the_held_scheme_is_the_real_time_observer() {
    let model = AnyModel::test_bed(ModelName::Proposed);
    let motion = motion(None);
    let rows = run(&model, &motion, &HELD);
    let head = "t_s,velocity_rad_s,torque_Nm,deflection_rad,gamma_Nm,regime,stored_energy_J,state_1,state_2";
    assert_eq!(rows[0].join(","), head);
    assert_eq!(rows.len(), 2001);
    let mut stepper = Stepper::new(Proposed::test_bed(), TimeStep::new(1e-3).unwrap());
    let (forces, gammas, deflections, regimes) = (
        column(&rows, "torque_Nm"),
        column(&rows, "gamma_Nm"),
        column(&rows, "state_2"),
        rows[1..].iter().map(|row| row[5].as_str()),
    );
    let mut slipped = 0;
    for (((v, force), (gamma, z)), regime) in
        motion.velocity.iter().zip(forces).zip(gammas.iter().zip(deflections)).zip(regimes)
    {
        let before = stepper.internals(*v);
        assert!((before.gamma - gamma).abs() < 1e-12 && (before.deflection - z).abs() < 1e-12);
        assert_eq!(regime == "slip", before.regime == Regime::Slip);
        slipped += usize::from(regime == "slip");
        assert!((stepper.step(*v) - force).abs() < 1e-12);
    }
    assert!(slipped > 100 && slipped < 1900);
}

#[test]
fn the_schemes_agree_and_finer_steps_do_not_change_the_rows() {
    let motion = motion(None);
    for name in ModelName::ALL {
        let model = AnyModel::test_bed(name);
        let forces = |scheme, dt| {
            let rows = run(&model, &motion, &Settings { scheme, dt, ..HELD });
            assert_eq!(column(&rows, "t_s"), motion.time);
            column(&rows, "torque_Nm")
        };
        let (exact, rk4) = (forces(Scheme::Held, 1e-5), forces(Scheme::Rk4, 1e-5));
        let largest = rk4.iter().fold(0.0f64, |most, force| most.max(force.abs()));
        // One sample may fall on either side of a switch; the mean may not differ.
        let mean =
            exact.iter().zip(&rk4).map(|(a, b)| (a - b).abs()).sum::<f64>() / exact.len() as f64;
        assert!(mean < 2e-3 * largest, "{name}: {mean} N m apart on the mean");
    }
}

#[test]
fn the_load_raises_the_contact_only() {
    let settings = Settings { load_gain: Some(0.5), ..HELD };
    let motion = motion(Some(-0.8));
    let rows = run(&AnyModel::test_bed(ModelName::Proposed), &motion, &settings);
    assert_eq!(rows[0][..4].join(","), "t_s,velocity_rad_s,load_Nm,torque_Nm");
    let dt = TimeStep::new(1e-3).unwrap();
    let mut contact = LoadDependent::new(Proposed::test_bed(), 0.5, dt).unwrap();
    for (v, force) in motion.velocity.iter().zip(column(&rows, "torque_Nm")) {
        assert!((contact.step(*v, -0.8) - force).abs() < 1e-12);
    }
    let viscous = AnyModel::test_bed(ModelName::Viscous);
    assert_eq!(
        column(&run(&viscous, &motion, &settings), "torque_Nm"),
        column(&run(&viscous, &motion, &HELD), "torque_Nm")
    );
}

#[test]
fn asymmetric_contacts_and_single_rows_can_be_simulated() {
    let [forward, backward] =
        [AnyModel::test_bed, AnyModel::chapter_3].map(|set| set(ModelName::Viscous));
    let model = AnyModel::asymmetric(&forward, &backward).unwrap();
    let rows = run(&model, &motion(None), &HELD);
    let both = Asymmetric { forward: Viscous::test_bed(), backward: Viscous::chapter_3() };
    for (v, force) in column(&rows, "velocity_rad_s").iter().zip(column(&rows, "torque_Nm")) {
        assert_eq!(force, both.steady_state(*v));
    }
    let one =
        Trajectory { time: vec![3.0], velocity: vec![0.1], load: None, axis: AxisKind::Linear };
    for scheme in [Scheme::Held, Scheme::Rk4] {
        let rows = run(&AnyModel::test_bed(ModelName::LuGre), &one, &Settings { scheme, ..HELD });
        assert_eq!(rows[0][..4].join(","), "t_s,velocity_m_s,force_N,deflection_m");
        assert_eq!(rows.len(), 2);
    }
}

/// Neither the motion nor the result stands in memory: what is written is written while the motion
/// is still being read.
#[test]
fn a_motion_without_an_end_is_simulated_as_it_comes() {
    let written = std::cell::Cell::new(0);
    struct Count<'a>(&'a std::cell::Cell<usize>);
    impl Write for Count<'_> {
        fn write(&mut self, text: &[u8]) -> std::io::Result<usize> {
            self.0.set(self.0.get() + text.len());
            Ok(text.len())
        }
        fn flush(&mut self) -> std::io::Result<()> {
            Ok(())
        }
    }
    let mut seen = 0;
    let endless = (0..).map(|k| {
        seen = k;
        assert!(k < 10_000_000, "nothing is written");
        // The reader has seen enough, or the motion would not end.
        let enough = written.get() > 10_000_000;
        let time = if enough { 0.0 } else { f64::from(k) * 1e-3 };
        let end = |_| RecordingError::HeaderOnly { path: "x.csv".into() };
        (!enough).then_some(Point { time, velocity: 0.1, load: 0.0 }).ok_or(()).map_err(end)
    });
    let motion = Motion { axis: AxisKind::Rotary, loaded: false, points: endless };
    let model = AnyModel::test_bed(ModelName::Coulomb);
    let stopped = simulate(&model, motion, &HELD, &mut Count(&written)).unwrap_err();
    assert!(matches!(stopped, Stopped::Motion(_)), "{stopped:?}");
    assert!(seen < 2_000_000);
}

#[test]
fn impossible_settings_and_diverging_steps_are_refused() {
    let (model, motion) = (AnyModel::chapter_3(ModelName::LuGre), motion(Some(1.0)));
    let refusal = |settings: Settings| refused(&model, &motion, &settings);
    for dt in [0.0, -1.0, 0.02, f64::NAN, f64::INFINITY] {
        assert!(
            refusal(Settings { dt, ..HELD })
                .to_string()
                .contains("--dt must be above 0 and at most")
        );
    }
    for dt in [0.0, f64::NAN] {
        let error = refusal(Settings { dt, scheme: Scheme::Rk4, ..HELD });
        assert!(error.to_string().contains("--dt must be a finite number above zero"));
    }
    assert_eq!(refusal(Settings { load_gain: Some(-1.0), ..HELD }), SimulateError::LoadGain(-1.0));
    assert!(matches!(refusal(Settings { dt: 1e-13, ..HELD }), SimulateError::TooLong { .. }));
    for tolerance in [0.0, 0.2, f64::NAN] {
        let error = refusal(Settings { tolerance, ..HELD });
        assert!(error.to_string().contains("--tolerance must lie between"), "{error}");
    }
    let unloaded = Trajectory { load: None, ..motion.clone() };
    let settings = Settings { load_gain: Some(1.0), ..HELD };
    assert_eq!(refused(&model, &unloaded, &settings), SimulateError::NoLoad);
}

/// Chapter 3's LuGre relaxes at up to 90 000 1/s: steps of 1 ms are far too long for Runge and
/// Kutta, who used to write numbers that looked like friction.
#[test]
fn steps_that_are_too_long_for_runge_and_kutta_are_halved_until_they_hold() {
    let motion = motion(None);
    // The bristles' bonds are drawn anew at every step.
    for name in ModelName::ALL.into_iter().filter(|name| *name != ModelName::Bristle) {
        let model = AnyModel::chapter_3(name);
        let forces = |dt, tolerance| {
            let settings = Settings { scheme: Scheme::Rk4, dt, tolerance, load_gain: None };
            let (rows, done) = done(&model, &motion, &settings);
            (column(&rows, "torque_Nm"), done.halvings)
        };
        let ((coarse, halvings), (fine, _)) = (forces(1e-3, 1e-6), forces(1e-5, 1e-9));
        let largest = fine.iter().fold(0.0f64, |most, force| most.max(force.abs()));
        let sum: f64 = coarse.iter().zip(&fine).map(|(a, b)| (a - b).abs()).sum();
        let share = sum / coarse.len() as f64 / largest;
        let bar = 1e-5;
        assert!(share < bar, "{name}: {share} of the largest force apart");
        if name == ModelName::LuGre {
            assert!(halvings.halved > 100 && halvings.most >= 3, "{halvings:?}");
        }
    }
}

#[test]
fn a_model_too_stiff_for_any_step_is_told_with_the_way_out() {
    let mut parameters = AnyModel::chapter_3(ModelName::LuGre).parameters();
    assert!(parameters.set("sigma0", 1e14));
    let model = AnyModel::try_from(parameters).unwrap();
    let settings = Settings { scheme: Scheme::Rk4, ..HELD };
    let said = refused(&model, &motion(None), &settings).to_string();
    for part in ["--scheme mean", "--tolerance", "halved", "8192"] {
        assert!(said.contains(part), "{said}");
    }
    let settings = Settings { scheme: Scheme::Mean, ..HELD };
    run(&model, &motion(None), &settings);
}

/// In the band the force is what is applied, which a motion does not tell.
#[test]
fn karnopp_says_the_same_in_its_band_with_every_scheme() {
    let model = AnyModel::test_bed(ModelName::Karnopp);
    let velocity = vec![0.0, 5e-4, -5e-4, 0.3, 5e-4];
    let time = vec![0.0, 0.1, 0.2, 0.3, 0.4];
    let motion = Trajectory { time, velocity, load: None, axis: AxisKind::Rotary };
    for scheme in [Scheme::Held, Scheme::Mean, Scheme::Rk4] {
        let settings = Settings { scheme, ..HELD };
        let (rows, done) = done(&model, &motion, &settings);
        assert_eq!(done.held, 4, "{scheme:?}");
        let forces = column(&rows, "torque_Nm");
        assert_eq!([forces[0], forces[1], forces[2], forces[4]], [0.0; 4], "{scheme:?}");
        assert!(forces[3] > 0.09);
    }
}

#[test]
fn velocities_that_no_model_knows_are_refused() {
    let model = AnyModel::test_bed(ModelName::LuGre);
    let mut motion = motion(None);
    motion.velocity[1000] = -2e6;
    for scheme in [Scheme::Held, Scheme::Mean, Scheme::Rk4] {
        let settings = Settings { scheme, ..HELD };
        let error = refused(&model, &motion, &settings);
        assert_eq!(error, SimulateError::TooFast { time: 1.0, velocity: -2e6 });
        assert!(error.to_string().contains("1e6"), "{error}");
    }
}
