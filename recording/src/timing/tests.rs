use proptest::prelude::*;

use super::*;

fn step(time: &[f64]) -> Result<f64, RecordingError> {
    even_step(Path::new("x.csv"), time, 0.05, |index| format!("line {}", index + 2))
}

fn timing(time: &[f64]) -> Timing {
    Timing::of(Path::new("x.csv"), time, TOLERANCE, |index| format!("line {}", index + 2)).unwrap()
}

/// Times one millisecond apart.
fn cycles(count: usize) -> Vec<f64> {
    (0..count).map(|k| k as f64 * 1e-3).collect()
}

/// What a straight line in time becomes.
fn line(stretch: &EvenStretch, time: &[f64]) -> Vec<f64> {
    stretch.channel(time, None)
}

#[test]
fn rounding_of_printed_times_is_averaged_out() {
    let time: Vec<_> = (0..1000).map(|i| (i as f64 * 0.012345 * 1e3).round() / 1e3).collect();
    let even = even_step(Path::new("x.csv"), &time, 0.1, |_| String::new()).unwrap();
    assert!((even - 0.012345).abs() < 1e-6);
    let found = Timing::of(Path::new("x.csv"), &time, 0.1, |_| String::new()).unwrap();
    assert_eq!((found.stretches.len(), found.stretches[0].time_step), (1, even));
    assert_eq!(found.irregularities.describe(), None);
}

#[test]
fn gaps_and_reversals_are_placed_where_nothing_else_is_accepted() {
    let gap = step(&[0.0, 0.1, 0.2, 0.4, 0.5]).unwrap_err().to_string();
    assert!(gap.contains("line 5") && gap.contains("0.2 s") && gap.contains("5 %"), "{gap}");
    assert!(!gap.contains("resample"), "no command does that: {gap}");
    let back = step(&[0.0, 0.1, 0.2, 0.15, 0.3]).unwrap_err().to_string();
    assert!(back.contains("line 5") && back.contains("0.15"), "{back}");
    assert!(matches!(step(&[0.0, 0.1, 0.1]), Err(RecordingError::TimeOrder { .. })));
    assert!(matches!(step(&[0.0, 0.1]), Err(RecordingError::TooShort { found: 2, .. })));
}

#[test]
fn an_even_recording_comes_out_as_it_is() {
    let time = cycles(500);
    let found = timing(&time);
    let [stretch] = &found.stretches[..] else { panic!("{found:?}") };
    assert_eq!(stretch.time_step, step(&time).unwrap());
    assert_eq!(line(stretch, &time), time);
    assert_eq!(found.irregularities, Irregularities { stretches: 1, ..Irregularities::default() });
}

#[test]
fn one_late_cycle_is_put_in_its_place() {
    let mut time = cycles(500);
    time[200] += 4e-4;
    let found = timing(&time);
    let [stretch] = &found.stretches[..] else { panic!("{found:?}") };
    assert_eq!(
        (stretch.len(), found.irregularities.moved, found.irregularities.filled),
        (500, 1, 0)
    );
    for (k, t) in line(stretch, &time).into_iter().enumerate() {
        assert!((t - k as f64 * 1e-3).abs() < 1e-12, "{k}: {t}");
    }
    assert!(found.irregularities.describe().unwrap().contains("1 sample came late or early"));
}

#[test]
fn a_cycle_that_came_late_with_the_next_ones_at_its_heels_is_put_in_its_place() {
    let mut time = cycles(500);
    // Cycles 200 to 202 run when 202 is due.
    (time[200], time[201], time[202]) = (0.202, 0.20201, 0.20202);
    let found = timing(&time);
    let [stretch] = &found.stretches[..] else { panic!("{found:?}") };
    assert_eq!((stretch.len(), found.irregularities.moved), (500, 2));
}

#[test]
fn up_to_two_missing_samples_are_filled_in() {
    for missing in [1, 2] {
        let mut time = cycles(500);
        time.drain(200..200 + missing);
        let found = timing(&time);
        let [stretch] = &found.stretches[..] else { panic!("{found:?}") };
        assert_eq!((stretch.len(), found.irregularities.filled), (500, missing));
        assert!((stretch.time_step - 1e-3).abs() < 1e-12);
        for (k, t) in line(stretch, &time).into_iter().enumerate() {
            assert!((t - k as f64 * 1e-3).abs() < 1e-12, "{k}: {t}");
        }
    }
}

#[test]
fn a_longer_gap_cuts_the_recording_and_is_counted() {
    let mut time = cycles(1000);
    time.drain(700..709);
    time.drain(200..203);
    let found = timing(&time);
    assert_eq!(found.stretches.iter().map(EvenStretch::len).collect::<Vec<_>>(), [200, 497, 291]);
    assert_eq!(
        found.stretches.iter().map(|s| s.after_gap).collect::<Vec<_>>(),
        [false, true, true]
    );
    let said = found.irregularities.describe().unwrap();
    assert!(said.contains("2 gaps, 12 samples missing; split into 3 stretches"), "{said}");
}

#[test]
fn a_pause_is_no_loss() {
    let time: Vec<f64> =
        cycles(300).into_iter().chain(cycles(300).iter().map(|t| t + 5.0)).collect();
    let found = timing(&time);
    assert_eq!(
        (found.stretches.len(), found.irregularities.pauses, found.irregularities.gaps),
        (2, 1, 0)
    );
    assert!(!found.stretches[1].after_gap);
    assert_eq!(
        found.irregularities.describe(),
        None,
        "runs with pauses between them are as they should be"
    );
}

#[test]
fn repeated_stamps_are_dropped_and_counted() {
    let mut time = cycles(100);
    time.insert(50, time[49]);
    time.insert(50, time[49]);
    let found = timing(&time);
    assert_eq!(
        (found.stretches.len(), found.stretches[0].len(), found.irregularities.repeated),
        (1, 100, 2)
    );
    assert!(found.irregularities.describe().unwrap().contains("2 repeated samples"));
}

#[test]
fn a_change_of_the_rate_tells_parts_apart() {
    let mut time = vec![0.0];
    for (count, step) in [(100, 0.02), (400, 0.001), (50, 0.01), (300, 0.001), (50, 0.0015)] {
        for _ in 0..count {
            time.push(time.last().unwrap() + step);
        }
    }
    let found = timing(&time);
    let steps: Vec<f64> =
        found.stretches.iter().map(|s| (s.time_step * 1e5).round() / 1e5).collect();
    assert_eq!(steps, [0.02, 0.001, 0.01, 0.001, 0.0015], "{:?}", found.irregularities);
    let fast = found.of_one_rate();
    assert_eq!(fast.stretches.len(), 2);
    assert_eq!(fast.irregularities.other_rate, 3);
    assert!((fast.stretches[1].time_step - 1e-3).abs() < 1e-9);
    assert!(fast.irregularities.describe().unwrap().contains("at another rate"));
}

#[test]
fn short_stretches_are_left_out_and_counted() {
    let mut time = cycles(300);
    time.drain(110..120);
    time.drain(90..100);
    let found = timing(&time).longer_than(Path::new("x.csv"), 12).unwrap();
    assert_eq!(found.stretches.len(), 2);
    assert_eq!((found.irregularities.too_short, found.irregularities.too_short_samples), (1, 10));
    let error = timing(&cycles(8)).longer_than(Path::new("x.csv"), 12).unwrap_err();
    assert!(matches!(error, RecordingError::TooShort { found: 8, needed: 12, .. }));
}

#[test]
fn what_is_read_between_two_counts_of_an_encoder_is_a_count() {
    let mut time = cycles(100);
    let counts: Vec<f64> = (0..100).map(|k| f64::from(k / 7) * 0.25).collect();
    let mut recorded = counts.clone();
    time.remove(50);
    recorded.remove(50);
    let found = timing(&time);
    let read = found.stretches[0].channel(&recorded, Some(0.25));
    assert!(read.iter().all(|x| (x / 0.25).fract() == 0.0), "{read:?}");
}

#[test]
fn the_tolerance_has_a_sane_range() {
    assert_eq!(tolerance("0.1"), Ok(0.1));
    for wrong in ["-0.1", "0.6", "nan", "x"] {
        assert!(tolerance(wrong).unwrap_err().to_string().contains("from 0 to 0.5"), "{wrong}");
    }
}

/// Ten and twelve milliseconds in turn.
fn alternating(count: usize) -> Vec<f64> {
    (0..count).map(|k| 0.022 * (k / 2) as f64 + 0.010 * (k % 2) as f64).collect()
}

/// Steps of one to eight milliseconds, without an order.
fn jittered(count: usize) -> Vec<f64> {
    let mut time = vec![0.0];
    let mut state = 7u64;
    for _ in 1..count {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let part = (state >> 33) as f64 / (1u64 << 31) as f64;
        time.push(time.last().unwrap() + 1e-3 + 7e-3 * part);
    }
    time
}

fn at_rate(time: &[f64], rate: f64) -> Timing {
    let steps = Steps { tolerance: TOLERANCE, resample: Some(rate) };
    Timing::of(Path::new("x.csv"), time, steps, |_| String::new()).unwrap()
}

#[test]
fn irregular_times_are_refused_with_a_rate_that_would_do() {
    for (time, rate) in [(alternating(400), 90.0), (jittered(2000), 220.0)] {
        let error =
            Timing::of(Path::new("x.csv"), &time, TOLERANCE, |_| String::new()).unwrap_err();
        let RecordingError::Irregular { rate: offered, .. } = error else { panic!("{error}") };
        assert!((offered - rate).abs() < 0.03 * rate, "{error}");
    }
    // Whose mean is a little below a round rate, of which the next lower one was offered.
    let at = |k: u32| 5.0001e-4 * f64::from(k) + 1e-4 * f64::from(k % 2);
    let time: Vec<f64> = (0..2000).map(at).collect();
    let error = Timing::of(Path::new("x.csv"), &time, TOLERANCE, |_| String::new()).unwrap_err();
    assert!(error.to_string().contains("2000 Hz"), "{error}");
    // A cycle that comes late now and then is no such thing.
    let mut time = cycles(500);
    (0..500).step_by(10).for_each(|k| time[k] += 3e-4);
    assert!(Timing::of(Path::new("x.csv"), &time, TOLERANCE, |_| String::new()).is_ok());
}

#[test]
fn irregular_samples_of_a_motion_are_brought_to_an_even_rate() {
    let tone = |t: f64| (std::f64::consts::TAU * 1.5 * t).sin();
    for (time, rate) in
        [(alternating(1000), 90.0), (jittered(3000), 200.0), (jittered(3000), 1000.0)]
    {
        let found = at_rate(&time, rate);
        let [stretch] = &found.stretches[..] else { panic!("{found:?}") };
        assert_eq!(stretch.time_step, 1.0 / rate);
        let recorded: Vec<f64> = time.iter().map(|&t| tone(t)).collect();
        let even = stretch.channel(&recorded, None);
        assert_eq!(even.len(), stretch.len());
        let n = even.len();
        for (k, value) in even.iter().enumerate().take(n - n / 20).skip(n / 20) {
            let truth = tone(k as f64 / rate);
            assert!((value - truth).abs() < 0.008, "{rate} Hz, {k}: {value} and not {truth}");
        }
    }
}

#[test]
fn what_the_new_rate_cannot_hold_is_filtered_and_said() {
    // 30 Hz, which samples at 40 Hz would show as 10 Hz.
    let time = jittered(4000);
    let recorded: Vec<f64> =
        time.iter().map(|t| (std::f64::consts::TAU * 30.0 * t).sin()).collect();
    let found = at_rate(&time, 40.0);
    let even = found.stretches[0].channel(&recorded, None);
    let rms = (even.iter().map(|v| v * v).sum::<f64>() / even.len() as f64).sqrt();
    assert!(rms < 0.15, "{rms}");
    let resampled = found.irregularities.resampled.unwrap();
    assert_eq!(resampled.low_pass, Some(16.0));
    assert!((0.2..0.6).contains(&resampled.noise), "{resampled:?}");
    let said = found.irregularities.describe().unwrap();
    assert!(said.contains("brought to 40 Hz") && said.contains("ends at 16 Hz"), "{said}");
}

/// A stranger's encoder was read unevenly. Behind the low-pass no reading stayed where it was:
/// none of its sticks was seen, and their samples held three quarters of the residual.
#[test]
fn what_stays_goes_on_to_stay_before_the_low_pass() {
    const COUNT: f64 = 1e-3;
    let time = jittered(2000);
    // A step every second, within 0.6 s.
    let at = |t: f64| t.floor() + (t.fract() / 0.6).min(1.0);
    let read: Vec<f64> = time.iter().map(|t| (at(*t) / COUNT).floor() * COUNT).collect();
    let found = at_rate(&time, 100.0);
    let stretch = &found.stretches[0];
    let nearest = stretch.nearest(&read).unwrap();
    assert_eq!(nearest.len(), stretch.len());
    let stays = |channel: &[f64]| channel.windows(2).filter(|pair| pair[0] == pair[1]).count();
    let of = stretch.len() as f64;
    let (raw, filtered) = (stays(&nearest) as f64, stays(&stretch.channel(&read, Some(COUNT))));
    assert!((0.33..0.45).contains(&(raw / of)), "{raw} of {of}");
    assert!((filtered as f64) < 0.05 * of, "{filtered} of {of}");
    assert_eq!(timing(&cycles(50)).stretches[0].nearest(&read), None);
    // A file has few digits: a reading between two others would be off by their rounding, which is no
    // step of an encoder.
    let printed: Vec<f64> = read.iter().map(|x| (1.234_567 * x * 1e7).round() * 1e-7).collect();
    let nearest = stretch.nearest(&printed).unwrap();
    assert!(nearest.iter().all(|x| printed.contains(x)), "readings");
}

#[test]
fn gaps_split_what_is_resampled_and_rates_out_of_range_are_refused() {
    let mut time = jittered(1000);
    time.iter_mut().skip(500).for_each(|t| *t += 0.1);
    let found = at_rate(&time, 200.0);
    assert_eq!((found.stretches.len(), found.irregularities.gaps), (2, 1));
    assert!(found.stretches[1].after_gap);
    for rate in [1e6, 1e-3] {
        let steps = Steps { tolerance: TOLERANCE, resample: Some(rate) };
        let error = Timing::of(Path::new("x.csv"), &time, steps, |_| String::new()).unwrap_err();
        assert!(matches!(error, RecordingError::ResampleRate { .. }), "{error}");
    }
    assert!(rate("0").is_err() && rate("x").is_err() && rate("inf").is_err());
    assert_eq!(rate("100"), Ok(100.0));
}

proptest! {
    /// Whatever the steps are: nothing panics, every stretch is even, a straight line stays one,
    /// and its samples lie within the recording.
    #[test]
    fn any_steps_become_even_stretches(steps in proptest::collection::vec(0u32..2000, 3..300)) {
        let mut time = vec![0.0];
        for step in steps {
            // Mostly one step of a millisecond, with whatever else between.
            let step = if step < 1500 { 1e-3 } else { f64::from(step - 1500) * 2e-5 };
            time.push(time.last().unwrap() + step);
        }
        if let Ok(found) = Timing::of(Path::new("x.csv"), &time, TOLERANCE, |_| String::new()) {
            for stretch in &found.stretches {
                let even = stretch.channel(&time, None);
                prop_assert!(stretch.time_step > 0.0);
                for pair in even.windows(2) {
                    prop_assert!((pair[1] - pair[0] - stretch.time_step).abs() <= 0.11 * stretch.time_step, "{pair:?}");
                }
                prop_assert!(even.iter().all(|t| *t >= 0.0 && t <= time.last().unwrap()));
            }
            let _ = found.of_one_rate();
        }
    }
}

/// Steps of 10 and 12 ms were taken as even from a tolerance of 0.2 on.
#[test]
fn no_tolerance_makes_alternating_steps_even() {
    let alternating: Vec<f64> =
        (0..200).map(|k| f64::from(k / 2) * 0.022 + f64::from(k % 2) * 0.01).collect();
    for tolerance in [0.05, 0.2, 0.3, 0.5] {
        let found = Timing::of(Path::new("x.csv"), &alternating, tolerance, |k| k.to_string());
        assert!(matches!(found, Err(RecordingError::Irregular { .. })), "{tolerance}: {found:?}");
    }
}

/// Every sixth step is 1.2 times as long: the samples are read on an even grid, whatever is
/// tolerated, and not counted off by the mean step.
#[test]
fn where_much_is_tolerated_the_values_still_stand_at_their_times() {
    let mut now = 0.0;
    let mut time = Vec::new();
    for k in 0..300 {
        time.push(now);
        // The long ones come in the first half.
        now += if k < 150 && k % 6 == 5 { 0.012 } else { 0.01 };
    }
    let found = Timing::of(Path::new("x.csv"), &time, 0.3, |k| k.to_string()).unwrap();
    for stretch in &found.stretches {
        let read = stretch.channel(&time, None);
        for (k, value) in read.iter().enumerate() {
            let due = stretch.start + stretch.time_step * k as f64;
            assert!((value - due).abs() < 1.5e-3, "sample {k}: {value} at {due}");
        }
    }
}
