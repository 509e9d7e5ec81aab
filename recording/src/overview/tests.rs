use super::*;

fn looked(text: &str) -> Overview {
    table(Path::new("x.csv"), text.as_bytes(), &Columns::default()).unwrap()
}

#[test]
fn what_was_understood_is_told() {
    let mut text = "t [ms];pos [deg];vel [furlongs];tau [mNm];note\n".to_owned();
    for k in 0..200 {
        // It rests, goes forth, and comes back.
        let position = match k {
            0..100 => 0.0,
            100..150 => f64::from(k - 100),
            _ => f64::from(200 - k),
        };
        let time = f64::from(k) + if k > 120 { 50.0 } else { 0.0 };
        let torque = if k == 7 { "NaN".to_owned() } else { format!("{k},5") };
        text += &format!("{time};{position},0;1;{torque};x\n");
    }
    let found = looked(&text);
    assert_eq!((found.samples, found.blank), (199, 1));
    assert!(found.dialect.unwrap().decimal_comma);
    let times = found.times.as_ref().unwrap();
    assert!((times.rate - 1000.0).abs() < 1e-6 && times.gaps == 1, "{times:?}");
    assert_eq!(times.resample_to, None);
    let torque = found.channel(Channel::Force).unwrap();
    assert_eq!((torque.unit.as_deref(), torque.greatest), (Some("mNm"), 0.1995));
    assert!(found.problems[0].contains("furlongs"), "{:?}", found.problems);
    let motion = found.motion.unwrap();
    assert!((0.4..0.6).contains(&motion.rest) && motion.reversals == 1, "{motion:?}");
}

/// What was done to the values and what looks wrong is told before a fit.
#[test]
fn remarks_on_the_values_are_told_and_columns_are_guessed() {
    let mut text = "Zeit (s);Winkel (°);Drehmoment\n".to_owned();
    for k in 0..400 {
        let time = format!("{:.2}", 0.01 * f64::from(k)).replace('.', ",");
        let torque = if k == 50 { 900 } else { k % 7 };
        text += &format!("{time};{};{torque}\n", (5 * k) % 360);
    }
    let found = looked(&text);
    assert!(
        (found.channel(Channel::Position).unwrap().greatest - 1995f64.to_radians()).abs() < 1e-9
    );
    assert_eq!(found.channel(Channel::Force).unwrap().name, "Drehmoment");
    let [wraps, spikes] = &found.problems[..] else { panic!("{:?}", found.problems) };
    assert!(wraps.contains("wraps 5 times by one turn"), "{wraps}");
    assert!(spikes.contains("900 N m") && spikes.ends_with('.'), "{spikes}");
    assert!(found.motion.unwrap().backwards == 0.0);
}

#[test]
fn a_table_without_names_and_irregular_times_are_told() {
    let found = looked("0,1,2\n1,2,3\n");
    assert!(found.channels.is_empty() && found.problems[0].contains("numbers of its 3"));
    let mut text = "t,q,tau\n".to_owned();
    // 100 steps of 0.011 s on average: 90.9 Hz.
    for k in 0..101 {
        text += &format!("{},{k},1\n", f64::from(k / 2) * 0.022 + f64::from(k % 2) * 0.01);
    }
    assert_eq!(looked(&text).times.unwrap().resample_to, Some(90.0));
}

#[test]
fn a_time_written_as_dates_has_no_unit_that_was_guessed() {
    let row = |k: u32| format!("2026-02-03,12:00:00.{:03},{k},1\n", 10 * k);
    let text = format!("date,time,q,tau\n{}", (0..50).map(row).collect::<String>());
    let found = looked(&text);
    let time = found.channel(Channel::Time).unwrap();
    assert!(time.dated && time.name == "date and time", "{time:?}");
    assert!((found.times.as_ref().unwrap().rate - 100.0).abs() < 1e-6);
    assert!(!found.channel(Channel::Position).unwrap().dated);
}
