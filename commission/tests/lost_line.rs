//! A line that is lost and comes back costs the block at hand, and nothing else is repeated.

use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicI64, Ordering};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use commission::travel::TravelAsked;
use commission::{Asked, CommissionError, Dossier, Outcome, Stage, run};
use rig_driver::back_end::{BackEnd, Listed, Place};
use rig_driver::registry::RigDescription;
use rig_driver::safety::SafetyLimits;
use rig_driver::{Measurement, Rig, RigError, RigFactory, RigRegistry, RigSetup};
use rig_setup::RigChoice;
use work::progress::Progress;

/// What the motor has, in microvolts.
static ON_THE_MOTOR: AtomicI64 = AtomicI64::new(0);
static STOP: OnceLock<Arc<AtomicBool>> = OnceLock::new();
/// What happens to the rig, and when.
static FATE: Mutex<Fate> = Mutex::new(Fate::NONE);

#[derive(Debug, Clone)]
struct Fate {
    /// Voltages that were put out.
    applied: u64,
    /// How often it was opened.
    opened: u32,
    /// After so many voltages the line is lost, until the rig is opened anew.
    lost_after: Vec<u64>,
    /// From the loss on the line is lost again so many voltages after each opening.
    again_after: Option<u64>,
    /// Openings that nobody answers once the line was lost.
    deaf: u32,
    /// Whether another device is there after a loss.
    replaced: bool,
    /// After so many voltages somebody presses the emergency stop at the device.
    pressed_after: Option<u64>,
    /// After so many voltages the user presses ctrl-C, at the loss of the line.
    stopped_after: Option<u64>,
    lost: bool,
    /// How long the device says that it has run.
    powered: Option<f64>,
}

impl Fate {
    const NONE: Self = Self {
        applied: 0,
        opened: 0,
        lost_after: Vec::new(),
        again_after: None,
        deaf: 0,
        replaced: false,
        pressed_after: None,
        stopped_after: None,
        lost: false,
        powered: None,
    };
}

fn fate<T>(with: impl FnOnce(&mut Fate) -> T) -> T {
    with(&mut FATE.lock().unwrap_or_else(PoisonError::into_inner))
}

/// The simulated rig behind a line.
struct Lined {
    rig: Box<dyn Rig + Send>,
    gone: bool,
    since_opened: u64,
}

impl Rig for Lined {
    fn beneath(&self) -> Option<&dyn Rig> {
        Some(&*self.rig)
    }

    fn beneath_mut(&mut self) -> Option<&mut dyn Rig> {
        Some(&mut *self.rig)
    }

    fn period(&self) -> f64 {
        self.rig.period()
    }

    fn measure(&mut self) -> Measurement {
        let fault = self.held_by().is_some();
        Measurement { fault, ..self.rig.measure() }
    }

    fn held_by(&self) -> Option<RigError> {
        let pressed = fate(|fate| fate.pressed_after.is_some_and(|after| fate.applied >= after));
        pressed.then(|| RigError::Elsewhere("the emergency stop was pressed".to_owned()))
    }

    fn powered_for(&self) -> Option<f64> {
        fate(|fate| fate.powered)
    }

    fn apply(&mut self, volts: f64) -> Result<(), RigError> {
        self.since_opened += 1;
        self.gone |= fate(|fate| {
            fate.applied += 1;
            let again = fate.lost && fate.again_after == Some(self.since_opened);
            let lost = fate.lost_after.contains(&fate.applied) || again;
            fate.lost |= lost;
            if fate.stopped_after == Some(fate.applied) {
                STOP.get().unwrap().store(true, Ordering::Relaxed);
            }
            lost
        });
        if self.gone {
            // The device is at zero volts once nobody tells it otherwise.
            ON_THE_MOTOR.store(0, Ordering::Relaxed);
            return Err(RigError::LineGone);
        }
        ON_THE_MOTOR.store((1e6 * volts) as i64, Ordering::Relaxed);
        self.rig.apply(volts)
    }

    fn halt(&mut self) -> Result<(), RigError> {
        ON_THE_MOTOR.store(0, Ordering::Relaxed);
        self.rig.halt()
    }
}

#[derive(Debug)]
struct LinedFactory;

impl RigFactory for LinedFactory {
    fn name(&self) -> &'static str {
        "lined"
    }

    fn about(&self) -> &'static str {
        "the test bed behind a line"
    }

    fn place(&self) -> Place {
        Place::None
    }

    fn is_simulated(&self) -> bool {
        true
    }

    fn comes_back(&self) -> bool {
        true
    }

    fn listed(&self) -> Vec<Listed> {
        Vec::new()
    }

    fn open(&self, _: Option<&str>, setup: &RigSetup) -> Result<BackEnd, RigError> {
        assert_eq!(ON_THE_MOTOR.load(Ordering::Relaxed), 0, "opened while the motor has volts");
        let replaced = fate(|fate| {
            fate.opened += 1;
            if fate.lost && fate.deaf > 0 {
                fate.deaf -= 1;
                return Err(RigError::LineGone);
            }
            Ok(fate.lost && fate.replaced)
        })?;
        let rig = setup.simulation.build(setup.friction)?;
        let description = RigDescription {
            name: if replaced { "another" } else { "the one" }.to_owned(),
            firmware: None,
            period: rig.period(),
            voltage_range: rig.voltage_range(),
            counts_per_turn: 4096.0,
            scales: None,
        };
        Ok(BackEnd {
            rig: Box::new(Lined { rig, gone: false, since_opened: 0 }),
            limits: SafetyLimits::for_simulation(&setup.simulation),
            sensors: rig_setup::SensorsPresent { torque: true, current: true },
            about: None,
            description: Some(description),
        })
    }
}

/// A commission into `folder`, from where it is, of a rig that meets `with`.
fn commissioned(folder: &Path, with: Fate) -> (Result<Outcome, CommissionError>, Dossier) {
    within(folder, with, None)
}

/// The same within a travel.
fn within(
    folder: &Path,
    with: Fate,
    travel: Option<TravelAsked>,
) -> (Result<Outcome, CommissionError>, Dossier) {
    let rig: RigChoice = "lined".parse().unwrap();
    let asked = Asked {
        rig,
        setup: RigSetup::default(),
        wanted: commission::friction::wanted::Wanted::default(),
        travel,
        allowed: 3600.0,
    };
    fate(|fate| *fate = Fate::NONE);
    let known = run::look(&asked).unwrap();
    let identity = run::identity(&asked, Some(&known), None);
    let dossier = match Dossier::open(folder) {
        Ok((dossier, _)) => dossier,
        Err(_) => Dossier::begin(folder, &identity).unwrap(),
    };
    fate(|fate| *fate = with);
    let stop = STOP.get_or_init(Arc::default);
    stop.store(false, Ordering::Relaxed);
    let outcome = commission::run(&asked, &known, &dossier, stop, &Progress::new(3600.0, true));
    assert_eq!(ON_THE_MOTOR.load(Ordering::Relaxed), 0);
    (outcome, dossier)
}

#[test]
fn a_lost_line_costs_the_block_at_hand_and_a_few_times_only() {
    RigRegistry::standard().with(LinedFactory).install().unwrap();
    let folder = tempfile::tempdir().unwrap();
    let whole = folder.path().join("whole");
    std::fs::create_dir(&whole).unwrap();
    // In the ramps, and in blocks, tones and arms.
    let lost_after = vec![20_000, 90_000, 130_000, 131_500, 180_000, 230_000];
    let (outcome, _) =
        commissioned(&whole, Fate { lost_after: lost_after.clone(), deaf: 2, ..Fate::NONE });
    outcome.unwrap();
    let met = fate(|fate| lost_after.iter().filter(|after| **after <= fate.applied).count());
    assert!(met >= 4, "the line was lost {met} times only");

    // A line that fails for good ends it, with what to do, and what is done is kept.
    let begun = folder.path().join("begun");
    std::fs::create_dir(&begun).unwrap();
    let failing = Fate { lost_after: vec![130_000], again_after: Some(1_500), ..Fate::NONE };
    let (outcome, dossier) = commissioned(&begun, failing);
    let said = outcome.unwrap_err().to_string();
    for part in ["the line to the rig is gone", "3 times", "cable", "--resume FOLDER"] {
        assert!(said.contains(part), "{part}: {said}");
    }
    assert!(dossier.done().contains(&Stage::Meet), "{:?}", dossier.done());
    // It was opened once more for each repeat, and not again.
    let done = dossier.done().len() as u32;
    assert_eq!(fate(|fate| fate.opened), done + 1 + 3, "{:?}", dossier.done());

    // Another device is not driven.
    let (outcome, _) = commissioned(
        &begun,
        Fate { lost_after: vec![1_500], replaced: true, deaf: 1, ..Fate::NONE },
    );
    let said = outcome.unwrap_err().to_string();
    assert!(said.contains("another") && said.contains("--resume FOLDER"), "{said}");

    // What is about the motor is told in the device's words, and never repeated; nor is what the
    // user stopped.
    let pressed = Fate { pressed_after: Some(1_500), ..Fate::NONE };
    let (outcome, _) = commissioned(&begun, pressed);
    let error = outcome.unwrap_err();
    assert_eq!(error.to_string(), "the emergency stop was pressed");
    assert_eq!(fate(|fate| fate.opened), 1);
    let stopped = Fate { lost_after: vec![1_500], stopped_after: Some(1_500), ..Fate::NONE };
    let (outcome, _) = commissioned(&begun, stopped);
    assert!(fate(|fate| fate.lost && fate.opened == 1));
    let error = outcome.unwrap_err();
    assert!(error.is_stopped(), "{error}");

    // The line is mended: it goes on where it was.
    let (outcome, _) = commissioned(&begun, Fate::NONE);
    outcome.unwrap();

    // A limited travel goes on where the device says that it has run on, and not where it has not.
    let limited = Some(TravelAsked::Around(-3.0, 3.0));
    for (name, powered, words) in [
        ("on", Some(1e5), None),
        ("anew", Some(0.0), Some("started anew")),
        ("silent", None, Some("nobody knows whether its encoder counted on")),
    ] {
        let place = folder.path().join(name);
        std::fs::create_dir(&place).unwrap();
        let lost_after = vec![5_000, 60_000];
        let (outcome, dossier) =
            within(&place, Fate { lost_after, powered, ..Fate::NONE }, limited);
        match words {
            None => {
                outcome.unwrap();
            }
            Some(words) => {
                let said = outcome.unwrap_err().to_string();
                assert!(said.contains(words), "{said}");
                assert!(dossier.travel().unwrap().is_some() && dossier.done().is_empty());
            }
        }
    }
}
