//! Servos other than the first: a joint whose loop runs in current, an arm with a mass, a goal that
//! moves no faster than the servo lets it.

use friction_ident::servo::ServoParameter::{self, *};
use friction_ident::servo::{Control, Drive, Lanes, Physics, RawServoLog, ServoLog, TIME_STEP};

const JOINT: Drive = Drive { control: Control::Current, per_gain: 1.0, full_scale: 12.0 };

const VALUES: [(ServoParameter, f64); 8] = [
    (TorqueConstant, 4.5),
    (Resistance, 2.5),
    (Armature, 0.33),
    (PositionOffset, 0.02),
    (Coulomb, 4.0),
    (Viscous, 1.3),
    (GainScale, 0.8),
    (GoalSpeed, 2.0),
];

fn raw() -> RawServoLog {
    let time: Vec<f64> = (0..800).map(|k| TIME_STEP * f64::from(k)).collect();
    RawServoLog {
        mass: 8.0,
        length: 0.5,
        gain: 50.0,
        supply: 24.0,
        arm_mass: 1.5,
        damping: 2.0 * 50.0f64.sqrt(),
        position: vec![0.1; 800],
        speed: vec![0.0; 800],
        goal: time
            .iter()
            .map(|t| if *t < 1.0 { 0.1 } else { 0.1 + 1.5 * (2.0 * t).sin() })
            .collect(),
        enabled: time.iter().map(|t| *t < 3.0).collect(),
        time,
    }
}

/// The equations one after the other, with the standard library's functions.
fn plain(raw: &RawServoLog) -> Vec<f64> {
    plain_with(raw, |_| 0.0)
}

/// The same with more friction, as it depends on the speed.
fn plain_with(raw: &RawServoLog, more: impl Fn(f64) -> f64) -> Vec<f64> {
    let of = |wanted| VALUES.iter().find(|(name, _)| *name == wanted).map_or(f64::NAN, |v| v.1);
    let (k_t, r) = (of(TorqueConstant), of(Resistance));
    let inertia = (raw.mass + raw.arm_mass / 3.0) * raw.length.powi(2) + of(Armature);
    let moment = (raw.mass + raw.arm_mass / 2.0) * 9.80665 * raw.length;
    let (mut q, mut w, mut goal) = (raw.position[0], raw.speed[0], raw.goal[0]);
    let mut out = Vec::new();
    // The grid ends below the last time stamp.
    for k in 0..raw.time.len() - 1 {
        out.push(q);
        let most = of(GoalSpeed) * TIME_STEP;
        goal += (raw.goal[k] - goal).clamp(-most, most);
        let current = ((goal - q) * raw.gain * of(GainScale) - raw.damping * w).clamp(-12.0, 12.0);
        let (most, back) = (k_t * raw.supply / r, k_t * k_t * w / r);
        let on = if raw.enabled[k] { 1.0 } else { 0.0 };
        let motor = on * (k_t * current).clamp(-most - back, most - back);
        let external = -moment * (q + of(PositionOffset)).sin();
        let stop = inertia * w / TIME_STEP + motor + external;
        let level = of(Coulomb) + more(w.abs()) + of(Viscous) * w.abs();
        let friction = -stop.clamp(-level, level);
        let a = (motor + external + friction) / inertia;
        w += a * TIME_STEP;
        q += w * TIME_STEP + 0.5 * a * TIME_STEP * TIME_STEP;
    }
    out
}

#[test]
fn a_joint_in_current_with_a_heavy_arm_moves_as_its_equations_say() {
    let raw = raw();
    let log = ServoLog::new(&raw).unwrap();
    let (names, values): (Vec<_>, Vec<_>) = VALUES.into_iter().unzip();
    let physics = Physics::new(&names, &values);
    let found = Lanes::new(&[&log], &JOINT).positions(&physics).remove(0);
    let plain = plain(&raw);
    assert_eq!(found.len(), log.samples());
    let off = found.iter().zip(&plain).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(off < 1e-6, "{off}");
    // It moves, so that the agreement says something.
    let spread = plain.iter().fold(0.0f64, |most, q| most.max((q - 0.1).abs()));
    assert!(spread > 0.3, "{spread}");
}

#[test]
fn a_given_delay_is_that_of_the_goal() {
    let raw = raw();
    let log = ServoLog::new(&raw).unwrap();
    let (mut names, mut values): (Vec<_>, Vec<_>) = VALUES.into_iter().unzip();
    let mut given = Lanes::new(&[&log], &JOINT);
    given.set_goal_delay(Some(0.012));
    let by_lanes = given.positions(&Physics::new(&names, &values));
    names.push(Delay);
    values.push(0.012);
    let by_parameter = Lanes::new(&[&log], &JOINT).positions(&Physics::new(&names, &values));
    assert_eq!(by_lanes, by_parameter);
}

/// Logs of different lengths, and candidates that differ in all that chooses another loop.
#[test]
fn a_candidate_has_the_error_that_it_has_alone() {
    let mut raws = [raw(), raw(), raw()];
    raws[1].gain = 20.0;
    raws[1].mass = 4.0;
    for raw in &mut raws[2..] {
        raw.time.truncate(301);
        for channel in [&mut raw.position, &mut raw.speed, &mut raw.goal] {
            channel.truncate(301);
        }
        raw.enabled.truncate(301);
    }
    let logs: Vec<ServoLog> = raws.iter().map(|raw| ServoLog::new(raw).unwrap()).collect();
    let extra: [&[(ServoParameter, f64)]; 6] = [
        &[],
        &[(Delay, 0.023)],
        &[(Delay, -0.011), (StribeckCoulomb, 1.5), (StribeckExponent, 1.7)],
        &[(QuadraticMotor, 0.01), (QuadraticExternal, 0.02), (StribeckVelocity, 0.3)],
        &[(RippleSine, 0.1), (RippleCosine, -0.2), (RippleCount, 40.0)],
        &[(LoadSquared, 0.01), (Load, 0.1), (StribeckLoad, 0.1)],
    ];
    let candidates: Vec<Physics> = (0..19)
        .map(|k| {
            let mut all = VALUES.to_vec();
            all[2].1 *= 1.0 + 0.05 * f64::from(k);
            all.extend(extra[k as usize % extra.len()]);
            let (names, values): (Vec<_>, Vec<_>) = all.into_iter().unzip();
            Physics::new(&names, &values)
        })
        .collect();
    for drive in [JOINT, Drive { control: Control::Voltage, per_gain: 0.05, full_scale: 1.0 }] {
        for count in 1..=logs.len() {
            let lanes = Lanes::new(&logs[..count].iter().collect::<Vec<_>>(), &drive);
            let alone: Vec<f64> =
                candidates.iter().map(|physics| lanes.error(physics, f64::INFINITY)).collect();
            assert_eq!(lanes.errors_of(&candidates, f64::INFINITY), alone);
            assert!(alone.iter().all(|error| error.is_finite() && *error > 0.0), "{alone:?}");
            assert!(alone.windows(2).all(|pair| pair[0] != pair[1]), "{alone:?}");
            // A mean over all samples is that of the means of the logs.
            let each = lanes.errors(&candidates[2]);
            let samples = logs[..count].iter().map(|log| log.samples() as f64);
            let (sum, total) = each
                .iter()
                .zip(samples)
                .fold((0.0, 0.0), |(sum, total), (error, n)| (sum + error * n, total + n));
            assert!((sum / total - alone[2]).abs() < 1e-12 * alone[2]);
            // One that is beaten may be given up; one that is not has its error.
            let mut sorted = alone.clone();
            sorted.sort_by(f64::total_cmp);
            let limit = sorted[sorted.len() / 2];
            for (limited, alone) in lanes.errors_of(&candidates, limit).iter().zip(&alone) {
                assert!(limited == alone || (*alone > limit && limited.is_infinite()));
            }
        }
    }
}

#[test]
fn a_stribeck_curve_is_that_of_the_standard_library() {
    let raw = raw();
    let log = ServoLog::new(&raw).unwrap();
    let mut all = VALUES.to_vec();
    let stribeck = [(StribeckCoulomb, 1.5), (StribeckVelocity, 0.7), (StribeckExponent, 1.7)];
    all.extend(stribeck);
    let (names, values): (Vec<_>, Vec<_>) = all.into_iter().unzip();
    let found = Lanes::new(&[&log], &JOINT).positions(&Physics::new(&names, &values)).remove(0);
    let plain = plain_with(&raw, |speed| 1.5 * (-(speed / 0.7).powf(1.7)).exp());
    let off = found.iter().zip(&plain).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(off < 1e-6, "{off}");
}

#[test]
fn a_header_that_no_servo_has_is_refused() {
    for value in [-1.0, f64::NAN, f64::INFINITY, 1e300] {
        let change: [fn(&mut RawServoLog, f64); 6] = [
            |raw, value| raw.mass = value,
            |raw, value| raw.length = value,
            |raw, value| raw.gain = value,
            |raw, value| raw.supply = value,
            |raw, value| raw.arm_mass = value,
            |raw, value| raw.damping = value,
        ];
        for change in change {
            let mut raw = raw();
            change(&mut raw, value);
            assert!(ServoLog::new(&raw).is_err(), "{value}: {raw:?}");
        }
    }
    let mut raw = raw();
    (raw.arm_mass, raw.damping) = (0.0, 0.0);
    assert!(ServoLog::new(&raw).is_ok());
}
