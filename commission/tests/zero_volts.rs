//! The motor is at zero volts at the end, whichever way a commission ends.

use std::sync::atomic::{AtomicBool, AtomicI64, AtomicU64, Ordering};
use std::sync::{Arc, OnceLock};

use commission::{Asked, Dossier, run};
use rig_driver::back_end::{BackEnd, Listed, Place};
use rig_driver::safety::SafetyLimits;
use rig_driver::{Measurement, Rig, RigError, RigFactory, RigRegistry, RigSetup};
use rig_setup::RigChoice;
use work::progress::Progress;

/// What the motor has, in microvolts.
static ON_THE_MOTOR: AtomicI64 = AtomicI64::new(i64::MAX);
/// Voltages that were put out.
static APPLIED: AtomicU64 = AtomicU64::new(0);
/// After so many of them the user presses ctrl-C.
static STOP_AFTER: AtomicU64 = AtomicU64::new(u64::MAX);
static STOP: OnceLock<Arc<AtomicBool>> = OnceLock::new();

/// The simulated rig, watched below the safety layer.
struct Watched(Box<dyn Rig + Send>);

impl Rig for Watched {
    fn beneath(&self) -> Option<&dyn Rig> {
        Some(&*self.0)
    }

    fn beneath_mut(&mut self) -> Option<&mut dyn Rig> {
        Some(&mut *self.0)
    }

    fn period(&self) -> f64 {
        self.0.period()
    }

    fn measure(&mut self) -> Measurement {
        self.0.measure()
    }

    fn apply(&mut self, volts: f64) -> Result<(), RigError> {
        ON_THE_MOTOR.store((1e6 * volts) as i64, Ordering::Relaxed);
        if APPLIED.fetch_add(1, Ordering::Relaxed) == STOP_AFTER.load(Ordering::Relaxed) {
            STOP.get().unwrap().store(true, Ordering::Relaxed);
        }
        self.0.apply(volts)
    }

    fn halt(&mut self) -> Result<(), RigError> {
        ON_THE_MOTOR.store(0, Ordering::Relaxed);
        self.0.halt()
    }
}

#[derive(Debug)]
struct WatchedFactory;

impl RigFactory for WatchedFactory {
    fn name(&self) -> &'static str {
        "watched"
    }

    fn about(&self) -> &'static str {
        "the test bed, watched"
    }

    fn place(&self) -> Place {
        Place::None
    }

    fn is_simulated(&self) -> bool {
        true
    }

    fn listed(&self) -> Vec<Listed> {
        Vec::new()
    }

    fn open(&self, _: Option<&str>, setup: &RigSetup) -> Result<BackEnd, RigError> {
        Ok(BackEnd {
            rig: Box::new(Watched(setup.simulation.build(setup.friction)?)),
            limits: SafetyLimits::for_simulation(&setup.simulation),
            sensors: rig_setup::SensorsPresent { torque: true, current: true },
            about: None,
            description: None,
        })
    }
}

#[test]
fn a_commission_ends_at_zero_volts_wherever_it_is_stopped_and_goes_on_from_there() {
    RigRegistry::standard().with(WatchedFactory).install().unwrap();
    let stop = STOP.get_or_init(Arc::default);
    let rig: RigChoice = "watched".parse().unwrap();
    let asked = Asked {
        rig,
        setup: RigSetup::default(),
        wanted: commission::friction::wanted::Wanted::default(),
        travel: None,
        allowed: 3600.0,
    };
    let folder = tempfile::tempdir().unwrap();
    let known = commission::run::look(&asked).unwrap();
    let identity = commission::run::identity(&asked, Some(&known), None);
    let dossier = Dossier::begin(folder.path(), &identity).unwrap();
    let progress = Progress::new(3600.0, true);

    let mut stages = Vec::new();
    // Again and again, wherever that is: in the ramps, the tones, blocks, the arms and the proof. Each
    // time a little later, so that no stage is too long to end.
    let mut cycles = 130_000;
    loop {
        stop.store(false, Ordering::Relaxed);
        STOP_AFTER.store(APPLIED.load(Ordering::Relaxed) + cycles, Ordering::Relaxed);
        cycles += cycles / 10;
        let Err(error) = run(&asked, &known, &dossier, stop, &progress) else { break };
        assert!(error.is_stopped(), "{error}");
        assert_eq!(ON_THE_MOTOR.load(Ordering::Relaxed), 0, "after {:?}", dossier.done());
        stages.push(dossier.done().len());
    }
    stages.dedup();
    assert!(stages.is_sorted() && stages.len() >= 3, "{stages:?}");
    assert_eq!(ON_THE_MOTOR.load(Ordering::Relaxed), 0);
}
