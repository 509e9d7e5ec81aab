use super::*;

#[test]
fn the_shipped_constant_velocities_are_the_thesis_protocol() {
    let read = ConstantVelocityProtocol::shipped().unwrap();
    assert_eq!(read, ConstantVelocityProtocol::default());
}

#[test]
fn the_shipped_chirp_has_9425_samples_and_reaches_10_rad_per_second() {
    let protocol = VaryingVelocityProtocol::shipped().unwrap();
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
    let protocol = PreSlidingProtocol::shipped().unwrap();
    assert_eq!((protocol.turns.len(), protocol.samples), (15, 4000));
}

/// What is said of the shipped file with one thing in it changed.
fn wrong<P: ProtocolFile + std::fmt::Debug>(from: &str, to: &str) -> String {
    assert!(P::TEXT.contains(from), "{from} is not in the shipped file");
    P::read(&P::TEXT.replacen(from, to, 1)).unwrap_err().to_string()
}

type Wrong = fn(&str, &str) -> String;

/// Every mistake gets a sentence with the key, what came, and what was expected.
#[test]
fn every_mistake_gets_its_sentence() {
    let mistakes: [(Wrong, &str, &str, &str); 22] = [
        (
            wrong::<ConstantVelocityProtocol>,
            "duration: 15 s",
            "duration: 15 rad",
            "`duration` must be a time from 0.1 to 3600 s, but is 15 rad",
        ),
        (
            wrong::<ConstantVelocityProtocol>,
            "duration: 15 s",
            "duration: 15",
            "not a number with its unit",
        ),
        (
            wrong::<ConstantVelocityProtocol>,
            "duration: 15 s",
            "duration: 4 s",
            "longer by 0.05 s or more than what is dropped",
        ),
        (
            wrong::<ConstantVelocityProtocol>,
            "to: 0.5 rad/s",
            "to: 0.01 rad/s",
            "`velocities[0].to` must be above 0.03 rad/s",
        ),
        (
            wrong::<ConstantVelocityProtocol>,
            "from: 0.55",
            "from: 0.45",
            "each above the one before",
        ),
        (
            wrong::<ConstantVelocityProtocol>,
            "points: 30",
            "points: 0",
            "`velocities[0].points` must be a whole number from 2 to 1000, but is 0",
        ),
        (
            wrong::<ConstantVelocityProtocol>,
            "repetitions: 10",
            "repetitions: 0",
            "`repetitions` must be a whole number",
        ),
        (wrong::<ConstantVelocityProtocol>, "sets: 2", "sets: two", "line"),
        (wrong::<ConstantVelocityProtocol>, "sets: 2", "", "sets"),
        (
            wrong::<VaryingVelocityProtocol>,
            "amplitude: 0.95",
            "amplitude: 1.05",
            "below the bias 1 rad/s",
        ),
        (wrong::<VaryingVelocityProtocol>, "[2 rad/s", "[2 furlongs", "`furlongs` is not known"),
        (
            wrong::<VaryingVelocityProtocol>,
            "[2 rad/s",
            "[0.05 rad/s",
            "`frequencies[0]` must be so high",
        ),
        (
            wrong::<VaryingVelocityProtocol>,
            "up_to: 10 rad/s",
            "up_to: 10 s",
            "`chirp.up_to` must be an angular velocity",
        ),
        (
            wrong::<VaryingVelocityProtocol>,
            "feed_forward: true",
            "feedforward: true",
            "feedforward",
        ),
        (
            wrong::<PreSlidingProtocol>,
            "rate: 0.02 N m/s",
            "rate: 0 N m/s",
            "`ramps.rate` must be a rate of torque",
        ),
        (
            wrong::<PreSlidingProtocol>,
            "turns: [0.085 N m,",
            "turns: [0 N m,",
            "`path.turns[0]` must be another level",
        ),
        (
            wrong::<PreSlidingProtocol>,
            "ratio: 2.5",
            "ratio: 0.5",
            "`onset.ratio` must be a number from 1 to 100",
        ),
        (
            wrong::<PreSlidingProtocol>,
            "displacement: potentiometer",
            "displacement: ruler",
            "ruler",
        ),
        (
            wrong::<BreakawayRateProtocol>,
            "rates: [0.01 N m/s",
            "rates: [0.01 V",
            "`ramps.rates[0]` must be a rate of torque",
        ),
        (
            wrong::<SequenceProtocol>,
            "name: stairs",
            "name: ../stairs",
            "a name of up to 60 letters",
        ),
        (
            wrong::<SequenceProtocol>,
            "drive: velocity",
            "drive: torque",
            "`segments[0].to` must be a torque from -10 to 10 N m, but is 0.5 rad/s",
        ),
        (wrong::<SequenceProtocol>, "drive: velocity", "drive: hope", "hope"),
    ];
    for (wrong, from, to, said) in mistakes {
        let message = wrong(from, to);
        assert!(message.contains(said), "{from} -> {to}: {message}");
    }
}

#[test]
fn what_is_no_yaml_is_told_with_a_protocol_to_start_from() {
    for text in ["", "experiment: [", "[1, 2]", "experiment: pre-sliding"] {
        let message = PreSlidingProtocol::read(text).unwrap_err().to_string();
        assert!(message.contains("frictionlab protocols"), "{message}");
    }
}
