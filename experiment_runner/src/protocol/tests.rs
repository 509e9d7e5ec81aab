use super::*;

#[test]
fn every_file_that_is_shipped_reads_as_its_own_kind() {
    for kind in Kind::ALL {
        let protocol = Protocol::read(kind.text()).unwrap();
        assert_eq!(protocol.kind(), kind);
    }
}

#[test]
fn the_shipped_constant_velocities_are_the_thesis_protocol() {
    let read = Protocol::read(Kind::ConstantVelocity.text()).unwrap();
    assert_eq!(read, Protocol::ConstantVelocity(ConstantVelocityProtocol::default()));
}

#[test]
fn the_shipped_chirp_has_9425_samples_and_reaches_10_rad_per_second() {
    let Ok(Protocol::VaryingVelocity(protocol)) = Protocol::read(Kind::VaryingVelocity.text())
    else {
        panic!()
    };
    assert_eq!((protocol.chirp_duration * 1e3).round() as u32 + 1, 9425);
    // At the end the rate is at most amplitude times 10 rad/s; the velocity never falls below bias
    // - amplitude.
    let chirp = protocol.chirp();
    let slowest =
        (0..12_424).map(|i| chirp.at(f64::from(i) * 1e-3).0).fold(f64::INFINITY, f64::min);
    assert!((slowest - 0.05).abs() < 1e-9, "{slowest}");
}

#[test]
fn the_shipped_path_has_15_turns_and_4000_samples() {
    let Ok(Protocol::PreSliding(protocol)) = Protocol::read(Kind::PreSliding.text()) else {
        panic!()
    };
    assert_eq!((protocol.turns.len(), protocol.samples), (15, 4000));
}

/// Every mistake gets a sentence with the key, what came, and what was expected.
#[test]
fn every_mistake_gets_its_sentence() {
    for (kind, from, to, said) in [
        (
            Kind::ConstantVelocity,
            "duration: 15 s",
            "duration: 15 rad",
            "`duration` must be a time from 0.1 to 3600 s, but is 15 rad",
        ),
        (Kind::ConstantVelocity, "duration: 15 s", "duration: 15", "not a number with its unit"),
        (
            Kind::ConstantVelocity,
            "duration: 15 s",
            "duration: 4 s",
            "longer by 0.05 s or more than what is dropped",
        ),
        (
            Kind::ConstantVelocity,
            "to: 0.5 rad/s",
            "to: 0.01 rad/s",
            "`velocities[0].to` must be above 0.03 rad/s",
        ),
        (Kind::ConstantVelocity, "from: 0.55", "from: 0.45", "each above the one before"),
        (
            Kind::ConstantVelocity,
            "points: 30",
            "points: 0",
            "`velocities[0].points` must be a whole number from 2 to 1000, but is 0",
        ),
        (
            Kind::ConstantVelocity,
            "repetitions: 10",
            "repetitions: 0",
            "`repetitions` must be a whole number",
        ),
        (Kind::ConstantVelocity, "sets: 2", "sets: two", "line"),
        (Kind::ConstantVelocity, "sets: 2", "", "sets"),
        (Kind::VaryingVelocity, "amplitude: 0.95", "amplitude: 1.05", "below the bias 1 rad/s"),
        (Kind::VaryingVelocity, "[2 rad/s", "[2 furlongs", "`furlongs` is not known"),
        (Kind::VaryingVelocity, "[2 rad/s", "[0.05 rad/s", "`frequencies[0]` must be so high"),
        (
            Kind::VaryingVelocity,
            "up_to: 10 rad/s",
            "up_to: 10 s",
            "`chirp.up_to` must be an angular velocity",
        ),
        (Kind::VaryingVelocity, "feed_forward: true", "feedforward: true", "feedforward"),
        (
            Kind::PreSliding,
            "rate: 0.02 N m/s",
            "rate: 0 N m/s",
            "`ramps.rate` must be a rate of torque",
        ),
        (
            Kind::PreSliding,
            "turns: [0.085 N m,",
            "turns: [0 N m,",
            "`path.turns[0]` must be another level",
        ),
        (
            Kind::PreSliding,
            "ratio: 2.5",
            "ratio: 0.5",
            "`onset.ratio` must be a number from 1 to 100",
        ),
        (Kind::PreSliding, "displacement: potentiometer", "displacement: ruler", "ruler"),
        (
            Kind::BreakawayRate,
            "rates: [0.01 N m/s",
            "rates: [0.01 V",
            "`ramps.rates[0]` must be a rate of torque",
        ),
        (Kind::Sequence, "name: stairs", "name: ../stairs", "a name of up to 60 letters"),
        (
            Kind::Sequence,
            "drive: velocity",
            "drive: torque",
            "`segments[0].to` must be a torque from -10 to 10 N m, but is 0.5 rad/s",
        ),
        (Kind::Sequence, "drive: velocity", "drive: hope", "hope"),
        (Kind::Sequence, "experiment: sequence", "experiment: dance", "dance"),
    ] {
        let text = kind.text();
        assert!(text.contains(from), "{from} is not in the shipped file");
        let message = Protocol::read(&text.replacen(from, to, 1)).unwrap_err().to_string();
        assert!(message.contains(said), "{from} -> {to}: {message}");
    }
}

#[test]
fn what_is_no_yaml_is_told_with_a_protocol_to_start_from() {
    for text in ["", "experiment: [", "[1, 2]", "experiment: pre-sliding"] {
        let message = Protocol::read(text).unwrap_err().to_string();
        assert!(message.contains("frictionlab protocols"), "{message}");
    }
}
