//! Motion at zero volts is told from coasting: no friction model, however it coasts, raises the
//! alarm, and a motor that goes on does.

use friction_model::{AnyModel, ModelName};
use rig_driver::{
    Measurement, Rig, RigError, SimulationOptions,
    safety::{Fault, Request, SafetyLimits, Supervised},
};

fn activated<R: Rig>(rig: R) -> Supervised<R> {
    let limits = SafetyLimits::for_simulation(&SimulationOptions::default());
    Supervised::activated(rig, limits).expect("valid limits")
}

/// Almost the speed limit each way, a start-stop, a slow crossing of zero and steps between them,
/// then zero volts: while active, and deactivated.
#[test]
fn no_model_raises_an_alarm_when_it_coasts() {
    for name in ModelName::ALL {
        for seed in 1..=2 {
            let options = SimulationOptions { seed, ..SimulationOptions::default() };
            let mut rig = activated(options.build(AnyModel::test_bed(name)).expect("a rig"));
            let mut drive = |cycles: u32, volts: &dyn Fn(f64) -> f64| {
                for cycle in 0..cycles {
                    rig.measure();
                    rig.apply(volts(f64::from(cycle) * 1e-3))
                        .unwrap_or_else(|error| panic!("{name}: {error}"));
                }
            };
            for volts in [4.5, -4.5, 0.5, -0.5, 0.2] {
                drive(400, &|_| volts);
                drive(1200, &|_| 0.0);
            }
            drive(3000, &|time| 0.3 * (time - 1.5));
            drive(1500, &|time| if ((time * 20.0) as u32).is_multiple_of(2) { 3.0 } else { 0.0 });
            drive(400, &|_| 4.5);
            rig.request(Request::Deactivate).expect("it rests");
            for _ in 0..1500 {
                rig.measure();
                rig.apply(0.0).expect("zero volts are never refused");
            }
            assert_eq!(rig.latched_fault(), None, "{name}");
        }
    }
}

/// A driver stage that keeps its last voltage whatever it is told.
struct Stuck<R: Rig> {
    rig: R,
    stuck: Option<f64>,
    cycle: u32,
}

impl<R: Rig> Rig for Stuck<R> {
    fn period(&self) -> f64 {
        self.rig.period()
    }

    fn measure(&mut self) -> Measurement {
        self.rig.measure()
    }

    fn apply(&mut self, volts: f64) -> Result<(), RigError> {
        self.cycle += 1;
        if self.cycle == 1000 {
            self.stuck = Some(volts);
        }
        self.rig.apply(self.stuck.unwrap_or(volts))
    }
}

#[test]
fn a_driver_stage_that_keeps_its_voltage_is_found_with_every_model() {
    for name in ModelName::ALL {
        let rig = SimulationOptions::default().build(AnyModel::test_bed(name)).expect("a rig");
        let mut rig = activated(Stuck { rig, stuck: None, cycle: 0 });
        let found = (0..4000).find(|cycle| {
            rig.measure();
            let _ = rig.apply(if *cycle < 1000 { 3.0 } else { 0.0 });
            rig.latched_fault().is_some_and(|report| report.fault == Fault::MotionAtZero)
        });
        assert!(found.is_some_and(|cycle| (1600..1850).contains(&cycle)), "{name}: {found:?}");
    }
}
