//! A friction model from outside the suite, in the suite's observer, experiments and least squares.

mod jenkins;

use std::error::Error;
use std::ops::ControlFlow;

use friction_features::{Contact, Motion, StickSlipSettings, stick_slip};
use friction_ident::bounded::{Bound, Patience, Residuals, minimise};
use friction_model::{Stepper, TimeStep};
use friction_observer::FrictionObserver;
use jenkins::{Jenkins, JenkinsParameters};

/// A slow motion with reversals \[rad/s\].
fn velocity(k: usize) -> f64 {
    let t = 1e-3 * k as f64;
    0.2 * (4.0 * t).sin() + 0.05 * (23.0 * t).sin()
}

/// Friction that was measured along the motion, and what a set of parameters makes of it.
struct Fit {
    measured: Vec<f64>,
    dt: TimeStep,
}

impl Fit {
    fn model(&self, x: &[f64]) -> Option<Jenkins> {
        let &[f_c, k, f_v] = x else { return None };
        Jenkins::try_from(JenkinsParameters { f_c, k, f_v }).ok()
    }
}

impl Residuals for Fit {
    fn len(&self) -> usize {
        self.measured.len()
    }

    fn residuals(&mut self, x: &[f64], out: &mut [f64]) -> bool {
        let Some(model) = self.model(x) else { return false };
        let mut contact = Stepper::new(model, self.dt);
        for (k, (out, measured)) in out.iter_mut().zip(&self.measured).enumerate() {
            *out = contact.step(velocity(k)) - measured;
        }
        true
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let dt = TimeStep::new(1e-3)?;
    let truth = JenkinsParameters { f_c: 0.095, k: 16.0, f_v: 0.04 };

    // The suite's observer, over a model that the suite does not know.
    let mut observer = FrictionObserver::over(Stepper::new(Jenkins::try_from(truth)?, dt));
    let measured: Vec<f64> =
        (0..4000).map(|k| observer.observe(velocity(k), None).torque).collect();
    let estimate = observer.observe(0.2, None);
    println!("{}: {:.4} N m, {:?}", estimate.source.as_str(), estimate.torque, estimate.regime);
    assert_eq!(estimate.source.as_str(), "jenkins");

    // Its experiments: pulled by a spring it does not stick and slip, as its levels do not differ.
    let pulled = stick_slip(&Contact::of(Jenkins::try_from(truth)?), &StickSlipSettings::default());
    println!("pulled by a spring: {:?}", pulled.motion);
    assert_ne!(pulled.motion, Motion::StickSlip);

    // The suite's least squares, from a start that is far off.
    let mut fit = Fit { measured, dt };
    let bounds = [0.1, 10.0, 0.01].map(|scale| Bound::within(0.0, f64::INFINITY, scale));
    let watch = &mut |_: &_| ControlFlow::Continue(());
    let found = minimise(&mut fit, &[0.2, 8.0, 0.0], &bounds, &Patience::default(), watch)
        .ok_or("the start is no model")?;
    let [f_c, k, f_v] = found.x[..] else { return Err("three parameters".into()) };
    println!("f_c {f_c:.6} N m, k {k:.4} N m/rad, f_v {f_v:.6} N m s/rad");
    for (found, true_value) in [(f_c, truth.f_c), (k, truth.k), (f_v, truth.f_v)] {
        assert!((found / true_value - 1.0).abs() < 1e-6, "{found} is not {true_value}");
    }
    Ok(())
}

#[test]
fn it_runs() -> Result<(), Box<dyn Error>> {
    main()
}
