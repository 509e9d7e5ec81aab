//! Whatever a file, a line or a network says: an answer or a refusal, never a panic, and nothing
//! that is not a number.
//!
//! Each target reads valid inputs that were damaged at random: bytes flipped, cut, repeated and
//! moved, numbers replaced by extreme ones. A few thousand of each; with `FRICTION_FULL` a million
//! (200 000 tables and 50 000 bags, which are files). The seed of a failure is the number in its
//! message.

use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use experiment_runner::experiments;
use experiment_runner::models::Preset;
use experiment_runner::models::file;
use experiment_runner::run::read_parameter_file;
use friction_ident::{
    AxisModel, Conditioning, RbfOptions, Signals, SteadyPoint, StribeckOptions, StribeckValues,
    condition, fit_axis, fit_stribeck, fit_two_line, train_rbf_network,
};
use friction_model::ModelName;
use identification::drive::parameters::read_motor;
use msgs::friction_msgs::{ControllerState, ExperimentStatus, FrictionEstimate, RigMeasurement};
use msgs::sensor_msgs::JointState;
use msgs::std_msgs::Header;
use msgs::{RosMessage, cdr};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use recording::bag::{BagOptions, BagReader, BagWriter};
use recording::{driven, table, trajectory};
use rig_protocol::{Decoder, DeviceMessage, HostMessage, Message, Origin, Session, VoltageCommand};
use rig_setup::read_calibration;

/// Numbers and words that parsers stumble over.
const EXTREME: [&str; 19] = [
    "nan",
    ".inf",
    "-0",
    "-0.0",
    "1e309",
    "1e308",
    "-1e308",
    "1e160",
    "1e-160",
    "1e-320",
    "-1e-320",
    "5e-324",
    "99999999999999999999",
    "0x10",
    "~",
    "{}",
    "[]",
    "!!binary aGk=",
    "1 rad",
];

fn rounds(full: u64) -> u64 {
    if std::env::var_os("FRICTION_FULL").is_some() { full } else { 3000 }
}

/// `valid` with one to six things wrong.
fn damaged(valid: &[u8], random: &mut Pcg64Mcg) -> Vec<u8> {
    let mut bytes = valid.to_vec();
    for _ in 0..random.random_range(1..=6) {
        let at = random.random_range(0..=bytes.len());
        let to = random.random_range(at..=bytes.len().min(at + 40));
        match random.random_range(0..7) {
            0 if at < bytes.len() => bytes[at] ^= 1 << random.random_range(0..8),
            1 => drop(bytes.drain(at..to)),
            2 => bytes.truncate(at),
            3 => {
                let again = bytes[at..to].to_vec();
                let place = random.random_range(0..=bytes.len());
                bytes.splice(place..place, again);
            }
            4 => bytes.insert(at, random.random()),
            _ => {
                // A number, if one begins near here, else whatever stands there.
                let start =
                    bytes[at..].iter().position(u8::is_ascii_digit).map_or(at, |digit| at + digit);
                let length = bytes[start..].iter().take_while(|byte| byte.is_ascii_digit()).count();
                let word = EXTREME[random.random_range(0..EXTREME.len())];
                bytes.splice(start..start + length, word.bytes());
            }
        }
    }
    bytes
}

/// Gives `read` damaged versions of the valid inputs.
fn fuzz(full: u64, valid: &[Vec<u8>], mut read: impl FnMut(&[u8])) {
    for valid in valid {
        read(valid);
    }
    for seed in 0..rounds(full) {
        let mut random = Pcg64Mcg::seed_from_u64(seed);
        let valid = &valid[random.random_range(0..valid.len())];
        let bytes = damaged(valid, &mut random);
        if catch_unwind(AssertUnwindSafe(|| read(&bytes))).is_err() {
            panic!("seed {seed}: {:?}", String::from_utf8_lossy(&bytes));
        }
    }
}

/// The text that the bytes are, as a program that reads a file gets it.
fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

#[test]
fn parameter_files() {
    let mut valid: Vec<Vec<u8>> = ModelName::ALL
        .into_iter()
        .map(|name| file::example(name, Preset::TestBed).into_bytes())
        .collect();
    valid.push(
        b"/rig_driver:\n  ros__parameters:\n    drive:\n      motor_constant: 0.00767\n      gear_ratio: 70.0\n      armature_resistance: 2.6\n      inertia: 0.0026\n"
            .to_vec(),
    );
    valid.push(
        b"/friction_observer:\n  ros__parameters:\n    model: lugre\n    lugre:\n      f_s: 0.0994\n      f_c: 0.0925\n      v_s: 0.1407\n      f_v: 0.0403\n"
            .to_vec(),
    );
    valid.push(
        b"/controller:\n  ros__parameters:\n    pid:\n      k_p: 5.7517\n      k_i: 10.0\n      k_d: 0.0768\n".to_vec(),
    );
    valid.push(
        b"/rig_driver:\n  ros__parameters:\n    calibration:\n      encoder_sign: forward\n      tachometer_gain: 1.1\n".to_vec(),
    );
    fuzz(1_000_000, &valid, |bytes| {
        let text = text(bytes);
        let _ = (read_parameter_file(&text), read_calibration(&text));
        let _ = (read_motor(&text), file::read(&text, None));
    });
}

#[test]
fn protocols() {
    let folder = tests::checkout().join("experiment_runner/protocols");
    let valid: Vec<Vec<u8>> = fs::read_dir(folder)
        .expect("protocols")
        .map(|entry| fs::read(entry.expect("a protocol").path()).expect("its text"))
        .collect();
    assert!(valid.len() >= 6);
    fuzz(1_000_000, &valid, |bytes| {
        let text = text(bytes);
        if let Ok(experiment) = experiments::of_protocol(&text) {
            let _ = experiment.read(&text);
        }
    });
}

/// A table of motion as people record it.
fn motion(header: &str, separator: &str) -> Vec<u8> {
    let mut text = header.replace(',', separator) + "\n";
    for k in 0..40 {
        let t = 0.01 * f64::from(k);
        let row = [t, t.sin(), t.cos(), 2.0 * t, 0.1].map(|value| format!("{value:.6}"));
        text += &(row.join(separator) + "\n");
    }
    text.into_bytes()
}

#[test]
fn tables() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("recording.csv");
    let valid = [
        motion("t_s,position_rad,velocity_rad_s,voltage_V,torque_Nm", ","),
        motion("time,position_m,velocity_m_s,voltage,force_N", ";"),
        motion("t,q,dq,u,tau", "\t"),
    ];
    let finite = |values: &[f64]| values.iter().all(|value| value.is_finite());
    fuzz(200_000, &valid, |bytes| {
        fs::write(&path, bytes).expect("the file is written");
        if let Ok(read) = table::read(&path, &table::Columns::default(), 0.1) {
            assert!(
                read.time_step > 0.0
                    && finite(&read.force)
                    && read.position.iter().all(|p| finite(p))
            );
        }
        if let Ok(read) = driven::read(&path, &driven::DrivenColumns::default(), 0.1) {
            assert!(
                read.time_step > 0.0
                    && finite(&read.voltage)
                    && read.friction.iter().all(|f| finite(f))
            );
        }
        let read = trajectory::open(&path).and_then(Iterator::collect::<Result<Vec<_>, _>>);
        if let Ok(read) = read {
            assert!(read.windows(2).all(|pair| pair[0].time < pair[1].time));
            assert!(read.iter().all(|point| point.velocity.is_finite()));
        }
    });
}

/// Numbers that arithmetic stumbles over: beyond squares, below them, and without a sign to trust.
const NUMBERS: [f64; 12] =
    [0.0, -0.0, 5e-324, 1e-320, -1e-320, 1e-308, 1e-160, -1e-60, 1e60, -1e160, 1e308, f64::NAN];

/// `valid` with a few extreme numbers, or a column on quite another scale.
fn stretched(valid: &[[f64; 3]], random: &mut Pcg64Mcg) -> Vec<[f64; 3]> {
    let mut rows = valid.to_vec();
    for _ in 0..random.random_range(1..=4) {
        let (column, extreme) =
            (random.random_range(0..3), NUMBERS[random.random_range(0..NUMBERS.len())]);
        match random.random_range(0..3) {
            0 => rows.iter_mut().for_each(|row| row[column] *= extreme),
            1 => rows.iter_mut().for_each(|row| row[column] = extreme),
            _ => {
                let row = random.random_range(0..rows.len());
                rows[row][column] = extreme;
            }
        }
    }
    rows
}

/// Whatever a recording says, a fit is an answer of numbers or a refusal.
#[test]
fn identifications() {
    let points: Vec<[f64; 3]> = (1..=24)
        .map(|k| {
            let v = 0.05 * f64::from(k);
            let wobble = 1e-4 * (7.0 * v).sin();
            [
                v,
                0.0925 + 0.0069 * (-(v / 0.1407_f64).powi(2)).exp() + 0.0403 * v + wobble,
                1e-3 * (1.0 + v),
            ]
        })
        .collect();
    // Position, velocity and force of an axis with inertia and friction.
    let motion: Vec<[f64; 3]> = (0..400)
        .map(|k| {
            let t = 0.02 * f64::from(k);
            let (x, v, a) = (
                -t.cos() - 0.1 * (3.0 * t).cos(),
                t.sin() + 0.3 * (3.0 * t).sin(),
                t.cos() + 0.9 * (3.0 * t).cos(),
            );
            [x, v, 2.0 * a + 0.5 * v + v.signum()]
        })
        .collect();
    with_points(&points, true);
    with_motion(&motion, 0);
    let seeds = if std::env::var_os("FRICTION_FULL").is_some() { 100_000 } else { 600 };
    for seed in 1..seeds {
        let mut random = Pcg64Mcg::seed_from_u64(seed);
        let (points, motion) = (stretched(&points, &mut random), stretched(&motion, &mut random));
        let fits = || {
            with_points(&points, seed % 2 == 0);
            with_motion(&motion, seed);
        };
        if catch_unwind(AssertUnwindSafe(fits)).is_err() {
            panic!("seed {seed}: {points:?} {motion:?}");
        }
    }
}

fn with_points(rows: &[[f64; 3]], weighted: bool) {
    let points: Vec<SteadyPoint> = rows
        .iter()
        .map(|&[velocity, torque, deviation]| SteadyPoint {
            velocity,
            torque,
            deviation: weighted.then_some(deviation),
            place: None,
        })
        .collect();
    if let Ok(fit) = fit_stribeck(&points, &StribeckOptions::default()) {
        let StribeckValues { f_s, f_c, v_s, f_v, .. } = fit.parameters;
        assert!([f_s, f_c, v_s, f_v].iter().all(|value| value.is_finite()), "{fit:?}");
    }
    if let Ok(fit) = fit_two_line(&points) {
        assert!(fit.mse.is_finite(), "{fit:?}");
    }
    if let Ok(fit) = train_rbf_network(&points, &RbfOptions::default()) {
        assert!(fit.mse.is_finite(), "{fit:?}");
    }
}

fn with_motion(rows: &[[f64; 3]], seed: u64) {
    let [position, velocity, force] =
        [0, 1, 2].map(|column| rows.iter().map(|row| row[column]).collect::<Vec<_>>());
    let by_velocity = seed % 2 == 1;
    let signals = Signals {
        time_step: if seed % 7 == 6 { NUMBERS[seed as usize % NUMBERS.len()] } else { 0.02 },
        position: (!by_velocity).then_some(&position),
        readings: None,
        velocity: by_velocity.then_some(&velocity),
        force: &force,
    };
    let how = Conditioning { trim: 20, ..Conditioning::for_time_step(0.02) };
    let Ok(recording) = condition(&signals, &how) else {
        assert_ne!(seed, 0, "the recording itself is sound");
        return;
    };
    for model in [AxisModel::SYMMETRIC, AxisModel::ASYMMETRIC] {
        if let Ok(fit) = fit_axis(&recording, model) {
            assert!(fit.terms.iter().all(|term| term.value.is_finite()), "{fit:?}");
        }
    }
}

fn bag(folder: &Path) -> Vec<u8> {
    let mut bag = BagWriter::create(folder, BagOptions::default()).expect("a bag");
    bag.topic::<JointState>("/joint_states").expect("a topic");
    for k in 0..50u64 {
        let message =
            JointState { header: Header::at(k), position: vec![1.0], ..Default::default() };
        bag.write("/joint_states", k, &message).expect("a message");
    }
    bag.attach("protocol.yaml", "application/yaml", b"experiment: sequence")
        .expect("an attachment");
    let summary = bag.finish().expect("the bag is closed");
    let name = fs::read_dir(&summary.dir)
        .expect("the folder")
        .map(|entry| entry.expect("a file").path())
        .find(|path| path.extension().is_some_and(|end| end == "mcap"));
    fs::read(name.expect("an MCAP file")).expect("its bytes")
}

#[test]
fn bags() {
    let folder = tempfile::tempdir().expect("a folder");
    let valid = [bag(&folder.path().join("whole"))];
    let path = folder.path().join("damaged.mcap");
    fuzz(50_000, &valid, |bytes| {
        fs::write(&path, bytes).expect("the file is written");
        if let Ok(bag) = BagReader::open(&path) {
            let _ = bag.messages::<JointState>("/joint_states");
            let _ = (bag.metadata("frictionlab"), bag.attachment("protocol.yaml"));
        }
    });
}

#[test]
fn messages_of_strangers() {
    fn encoded<M: RosMessage + Default>() -> Vec<u8> {
        cdr::encode(&M::default()).expect("it encodes")
    }
    let joint = JointState {
        name: vec!["load_shaft".into()],
        position: vec![1.0, 2.0],
        ..Default::default()
    };
    let valid = [
        cdr::encode(&joint).expect("it encodes"),
        encoded::<RigMeasurement>(),
        encoded::<FrictionEstimate>(),
        encoded::<ControllerState>(),
        encoded::<ExperimentStatus>(),
    ];
    fuzz(1_000_000, &valid, |bytes| {
        let _ = (cdr::decode::<JointState>(bytes), cdr::decode::<RigMeasurement>(bytes));
        let _ = (cdr::decode::<FrictionEstimate>(bytes), cdr::decode::<ControllerState>(bytes));
        let _ = cdr::decode::<ExperimentStatus>(bytes);
    });
}

#[test]
fn frames_of_a_line() {
    let session = Session::new(7).expect("a session");
    let origin = Origin { session, sequence: 1 };
    let valid: Vec<Vec<u8>> = [
        HostMessage::Hello { number: session },
        HostMessage::Activate(origin),
        HostMessage::EmergencyStop,
        HostMessage::Heartbeat(origin),
        HostMessage::Voltage(VoltageCommand {
            origin,
            answers: 1,
            voltage: 500,
            validity_us: 20_000,
        }),
        HostMessage::Close(origin),
    ]
    .iter()
    .map(|message| message.frame().as_bytes().repeat(3))
    .collect();
    fuzz(1_000_000, &valid, |bytes| {
        let (mut host, mut device) =
            (Decoder::<HostMessage>::new(), Decoder::<DeviceMessage>::new());
        for &byte in bytes {
            let _ = (host.push(byte), device.push(byte));
        }
    });
}
