//! The Quanser back end against a stand-in library that records calls and fails at any of them, and
//! whose card lives in another process.
//!
//! Nothing here has seen a real card. Miri cannot call foreign functions: the pure parts (counter,
//! scaling) have tests of their own.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::OnceLock;
use std::time::{Duration, Instant};

use rig_driver::quanser::{AnalogInput, QuanserError, QuanserOptions, QuanserRig};
use rig_driver::safety::{Fault, Request, SafetyLimits, State, Supervised};
use rig_driver::{Rig, RigError};

/// Time after which a test that waits for another process gives up.
const PATIENCE: Duration = Duration::from_secs(60);

/// The stand-in library and the program of its card, built once.
fn stand_in() -> &'static (PathBuf, PathBuf) {
    static BUILT: OnceLock<(PathBuf, PathBuf)> = OnceLock::new();
    BUILT.get_or_init(|| {
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("stand_in");
        fs::create_dir_all(&folder).unwrap();
        let build = |source: &str, kind: &str, name: &str| {
            let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/stand_in").join(source);
            // Under a name of this process: two test runs may build at the same time.
            let (draft, file) =
                (folder.join(format!("{name}.{}", std::process::id())), folder.join(name));
            let status = Command::new(std::env::var_os("RUSTC").unwrap_or_else(|| "rustc".into()))
                .args(["--edition", "2024", "--crate-type", kind, "-o"])
                .args([&draft, &source])
                .status()
                .expect("rustc, which built this test, starts");
            assert!(status.success(), "the stand-in does not build");
            fs::rename(&draft, &file).unwrap();
            file
        };
        (build("hil.rs", "cdylib", "libhil_stand_in.so"), build("card.rs", "bin", "stand_in_card"))
    })
}

/// A card of the stand-in with its log.
struct Stand {
    _folder: tempfile::TempDir,
    log: PathBuf,
    options: QuanserOptions,
}

impl Stand {
    fn new(how: &str) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let log = folder.path().join("log");
        let mut card = format!("log={}", log.display());
        if !how.is_empty() {
            card += &format!(";{how}");
        }
        let options = QuanserOptions {
            library: Some(stand_in().0.clone()),
            card,
            ..QuanserOptions::default()
        };
        Self { _folder: folder, log, options }
    }

    fn calls(&self) -> Vec<String> {
        let text = fs::read_to_string(&self.log).unwrap_or_default();
        text.lines().map(str::to_owned).collect()
    }

    /// What the motor has by the calls so far: the last voltage that was taken.
    fn volts(&self) -> f64 {
        let mut volts = 0.0;
        for line in self.calls().iter().filter(|line| !line.ends_with("REFUSED")) {
            if line.starts_with("hil_write_analog") || line.starts_with("hil_read_write") {
                volts = line.split_whitespace().last().unwrap().parse().unwrap();
            } else if line.starts_with("hil_write_termination_states")
                || line.starts_with("hil_close")
            {
                volts = 0.0;
            }
        }
        volts
    }
}

fn cycles(rig: &mut impl Rig, count: u32, volts: f64) -> Result<(), RigError> {
    (0..count).try_for_each(|_| {
        rig.measure();
        rig.apply(volts)
    })
}

const OPENING: [&str; 10] = [
    "hil_open q2_usb",
    "hil_set_analog_output_ranges [0] -10 10",
    "hil_write_analog [0] 0.0",
    "hil_watchdog_set_analog_expiration_state [0] 0.0",
    "hil_set_analog_termination_state [0] 0.0",
    "hil_watchdog_clear",
    "hil_set_analog_input_ranges [0, 1] -10 10",
    "hil_set_encoder_quadrature_mode [0] 4",
    "hil_set_encoder_counts [0] 0",
    "hil_watchdog_start 0.02",
];

#[test]
fn calls_come_in_the_order_that_keeps_the_motor_safe() {
    let stand = Stand::new("");
    let mut rig = QuanserRig::open(stand.options.clone()).unwrap();
    cycles(&mut rig, 3, 1.5).unwrap();
    drop(rig);
    let calls = stand.calls();
    assert_eq!(calls[..10], OPENING);
    let cycle = |volts: &str| {
        [format!("hil_read_write encoder 0 output 0 {volts}"), "hil_watchdog_reload".into()]
    };
    assert_eq!(calls[10..16], [cycle("0.0"), cycle("1.5"), cycle("1.5")].concat());
    assert_eq!(
        calls[16..],
        [
            "hil_write_analog [0] 0.0",
            "hil_write_termination_states",
            "hil_watchdog_stop",
            "hil_close"
        ]
    );
}

#[test]
fn readings_are_scaled_and_the_counter_goes_on_through_its_wrap() {
    let stand = Stand::new("");
    let tachometer = Some(AnalogInput { channel: 0, scale: -0.9973, offset: 0.25, range: 10.0 });
    let options = QuanserOptions { tachometer, amplifier_gain: 3.0, ..stand.options.clone() };
    let mut rig = QuanserRig::open(options).unwrap();
    for cycle in 0..70 {
        let seen = rig.measure();
        assert_eq!(seen.encoder_counts, 1000 * cycle);
        let position = 1000.0 * cycle as f64 * std::f64::consts::TAU / 4096.0;
        assert!((seen.encoder_position - position).abs() < 1e-9);
        // Channel 0 shows 1 V, channel 1 shows 2 V.
        assert!((seen.tachometer_velocity + 0.9973 * 0.75).abs() < 1e-12);
        assert!((seen.torque - 4.6).abs() < 1e-12);
        // A voltage goes out with the next cycle's exchange, and was at the motor in the cycle
        // after.
        assert_eq!(seen.voltage_applied, if cycle < 2 { 0.0 } else { 3.0 });
        rig.apply(3.0).unwrap();
    }
    assert_eq!(stand.volts(), 1.0, "the amplifier makes 3 V of it");
    rig.apply(20.0).unwrap();
    rig.measure();
    assert_eq!(stand.volts(), 2.0, "6 V are the limit");
    rig.apply(0.0).unwrap();
    assert_eq!(stand.volts(), 0.0, "zero volts do not wait for the next cycle");
}

#[test]
fn without_any_analogue_input_the_velocity_is_the_encoders() {
    let stand = Stand::new("");
    let options = QuanserOptions { tachometer: None, torque: None, ..stand.options.clone() };
    let mut rig = QuanserRig::open(options).unwrap();
    cycles(&mut rig, 2, 0.0).unwrap();
    let seen = rig.measure();
    assert!(
        (seen.tachometer_velocity - 1000.0 * std::f64::consts::TAU / 4096.0 / 1e-3).abs() < 1e-6
    );
    assert!(!stand.calls().iter().any(|call| call.starts_with("hil_set_analog_input_ranges")));
}

#[test]
fn a_failure_of_any_call_gives_a_sentence_with_the_vendors_text_and_zero_volts() {
    let opening = [
        "hil_open",
        "hil_set_analog_output_ranges",
        "hil_write_analog",
        "hil_watchdog_set_analog_expiration_state",
        "hil_set_analog_termination_state",
        "hil_watchdog_clear",
        "hil_set_analog_input_ranges",
        "hil_set_encoder_quadrature_mode",
        "hil_set_encoder_counts",
    ];
    let told = |error: RigError, call: &str| {
        let text = error.to_string();
        assert!(
            text.contains(&format!("`{call}`: The stand-in was told to refuse {call}")),
            "{text}"
        );
        assert!(text.contains("zero volts"), "{text}");
    };
    for call in opening {
        let stand = Stand::new(&format!("fail={call}@1"));
        told(QuanserRig::open(stand.options.clone()).unwrap_err(), call);
        assert_eq!(stand.volts(), 0.0, "{call}");
        let closed = stand.calls().last().is_some_and(|line| line == "hil_close");
        assert!(closed || call == "hil_open", "{call}: {:?}", stand.calls());
    }
    for call in
        ["hil_watchdog_start@1", "hil_read_write@1", "hil_read_write@4", "hil_watchdog_reload@4"]
    {
        let stand = Stand::new(&format!("fail={call}"));
        let mut rig = QuanserRig::open(stand.options.clone()).unwrap();
        told(cycles(&mut rig, 10, 2.0).unwrap_err(), call.split('@').next().unwrap());
        assert_eq!(stand.volts(), 0.0, "{call}");
        assert!(
            rig.measure().fault && cycles(&mut rig, 1, 2.0).is_err(),
            "{call}: it stays stopped"
        );
        assert_eq!(stand.volts(), 0.0, "{call}");
    }
}

#[test]
fn failures_on_the_way_out_leave_zero_volts_too() {
    for (call, stopped) in [
        // The second writing of zero volts is the last one: the watchdog goes on and expires.
        ("hil_write_analog@2", false),
        ("hil_write_termination_states@1", false),
        ("hil_watchdog_stop@1", true),
        ("hil_close@1", true),
    ] {
        let stand = Stand::new(&format!("fail={call}"));
        let mut rig = QuanserRig::open(stand.options.clone()).unwrap();
        cycles(&mut rig, 3, 2.0).unwrap();
        drop(rig);
        assert_eq!(stand.volts(), 0.0, "{call}");
        let asked_to_stop = stand.calls().iter().any(|line| line.starts_with("hil_watchdog_stop"));
        assert_eq!(asked_to_stop, stopped, "{call}: {:?}", stand.calls());
    }
}

#[test]
fn an_expired_watchdog_stops_the_motor_until_it_is_cleared_and_activated() {
    let stand = Stand::new("expired=5");
    let rig = QuanserRig::open(stand.options.clone()).unwrap();
    let mut limits = SafetyLimits::default().before_calibration();
    // The stand-in's readings never change, and its shaft is very fast.
    (limits.sensors.frozen_cycles, limits.velocity) = (None, 1e6);
    let mut rig = Supervised::activated(rig, limits).unwrap();
    cycles(&mut rig, 4, 1.0).unwrap();
    let seen = rig.measure();
    assert!(seen.fault && seen.watchdog_expired, "{seen:?}");
    let text = rig.apply(1.0).unwrap_err().to_string();
    assert!(text.contains("watchdog expired") && text.contains("clear and activate"), "{text}");
    assert_eq!(rig.supervisor().latched().map(|report| report.fault), Some(Fault::BackEnd));
    assert_eq!(stand.volts(), 0.0);
    assert_eq!(rig.request(Request::Clear), Ok(State::Inactive));
    rig.request(Request::Activate).unwrap();
    cycles(&mut rig, 3, 1.0).unwrap();
    assert_eq!(stand.volts(), 1.0);
    let calls = stand.calls();
    let cleared = calls.iter().rposition(|line| line == "hil_watchdog_clear").unwrap();
    let started = calls.iter().rposition(|line| line == "hil_watchdog_start 0.02").unwrap();
    assert!(started > cleared, "cleared before it is used again");
}

#[test]
fn a_panic_leaves_zero_volts_and_an_orderly_end() {
    let stand = Stand::new("");
    let options = stand.options.clone();
    let ended = std::thread::spawn(move || {
        let mut rig = QuanserRig::open(options).unwrap();
        cycles(&mut rig, 3, 2.5).unwrap();
        std::panic::panic_any("a controller with a mistake");
    })
    .join();
    assert!(ended.is_err());
    assert_eq!(stand.volts(), 0.0);
    assert_eq!(
        stand.calls()[16..],
        [
            "hil_write_analog [0] 0.0",
            "hil_write_termination_states",
            "hil_watchdog_stop",
            "hil_close"
        ]
    );
}

#[test]
fn without_a_library_it_says_what_to_install_and_with_a_wrong_one_what_it_lacks() {
    let missing =
        QuanserOptions { library: Some("/nowhere/libhil.so".into()), ..Default::default() };
    let text = QuanserRig::open(missing).unwrap_err().to_string();
    for said in ["/nowhere/libhil.so", "HIL SDK", "install", "simulated rig"] {
        assert!(text.contains(said), "{text}");
    }
    let wrong = QuanserOptions { library: Some("libc.so.6".into()), ..Default::default() };
    match QuanserRig::open(wrong).unwrap_err() {
        RigError::Quanser(QuanserError::NoFunction { function, .. }) => {
            assert_eq!(function, "hil_open")
        }
        other => panic!("{other}"),
    }
    let zero = QuanserOptions { card: "0\0".into(), ..Default::default() };
    assert!(QuanserRig::open(zero).unwrap_err().to_string().contains("`card`"));
}

/// Not a test of its own: the driver that the tests below end by force. It runs until then.
#[test]
#[ignore = "ended by force: run by the tests below"]
fn driver_to_be_killed() {
    let card = std::env::var_os("STAND_IN_CARD").expect("a card");
    let options = QuanserOptions {
        library: std::env::var_os("STAND_IN_LIBRARY").map(PathBuf::from),
        card: card.into_string().unwrap(),
        // Long enough for a busy machine, far shorter than a test waits.
        watchdog_timeout: 2.0,
        ..QuanserOptions::default()
    };
    let mut rig = QuanserRig::open(options).unwrap();
    loop {
        rig.measure();
        if let Err(error) = rig.apply(2.0) {
            fs::write(std::env::var_os("STAND_IN_SAID").unwrap(), error.to_string()).unwrap();
            return;
        }
        std::thread::sleep(Duration::from_millis(1));
    }
}

/// Starts the driver in another process and waits until its motor turns.
fn driver(stand: &Stand, said: &Path) -> std::process::Child {
    let card = format!("{};card={}", stand.options.card, stand_in().1.display());
    let child = Command::new(std::env::current_exe().unwrap())
        .args(["driver_to_be_killed", "--exact", "--ignored"])
        .env("STAND_IN_CARD", card)
        .env("STAND_IN_LIBRARY", &stand_in().0)
        .env("STAND_IN_SAID", said)
        .stdout(Stdio::null())
        .spawn()
        .unwrap();
    wait_for(stand, "card 2.0 written");
    child
}

fn wait_for(stand: &Stand, line: &str) {
    let started = Instant::now();
    while !stand.calls().iter().any(|call| call == line) {
        assert!(started.elapsed() < PATIENCE, "no `{line}` in {:?}", stand.calls().last());
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// What the card itself put out last.
fn at_the_motor(stand: &Stand) -> String {
    stand.calls().iter().rfind(|line| line.starts_with("card")).unwrap().clone()
}

#[cfg(unix)]
fn signal(child: &std::process::Child, name: &str) {
    let status = Command::new("kill").args([name, &child.id().to_string()]).status().unwrap();
    assert!(status.success());
}

#[cfg(unix)]
#[test]
fn killed_with_no_chance_to_react_the_cards_watchdog_puts_the_motor_at_zero_volts() {
    let stand = Stand::new("");
    let mut child = driver(&stand, Path::new("/dev/null"));
    signal(&child, "-KILL");
    child.wait().unwrap();
    wait_for(&stand, "card 0.0 watchdog");
    assert_eq!(at_the_motor(&stand), "card 0.0 watchdog");
    assert!(!stand.calls().iter().any(|line| line == "hil_close"), "nobody closed the card");
}

#[cfg(unix)]
#[test]
fn a_driver_that_was_stopped_and_goes_on_finds_the_watchdog_expired_and_does_not_move_the_motor_again()
 {
    let stand = Stand::new("");
    let said = stand.log.with_file_name("said");
    let mut child = driver(&stand, &said);
    signal(&child, "-STOP");
    wait_for(&stand, "card 0.0 watchdog");
    let moved = |calls: &[String]| calls.iter().filter(|line| *line == "card 2.0 written").count();
    let before = moved(&stand.calls());
    signal(&child, "-CONT");
    assert!(child.wait().unwrap().success());
    let text = fs::read_to_string(said).unwrap();
    assert!(text.contains("watchdog expired"), "{text}");
    assert_eq!(moved(&stand.calls()), before);
    assert!(at_the_motor(&stand).starts_with("card 0.0"));
}
