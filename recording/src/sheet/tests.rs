//! Units below the names, joints, tables side by side and rows without a time.

use std::path::Path;

use crate::RecordingError;
use crate::column::Channel;
use crate::joints::JointChoice;
use crate::overview;
use crate::table::{self, Columns};

fn written(folder: &Path, name: &str, text: &str) -> std::path::PathBuf {
    let path = folder.join(name);
    std::fs::write(&path, text).unwrap();
    path
}

fn of_joint(joint: Option<&str>, period: Option<f64>) -> Columns {
    let mut columns = Columns::default();
    columns.layout.joint = joint.map(str::to_owned);
    columns.layout.period = period;
    columns
}

#[test]
fn a_row_of_units_below_the_names_is_understood() {
    let folder = tempfile::tempdir().unwrap();
    for units in ["ms,deg,mNm,-", "[ms],[deg],[mNm],", "\"ms\", deg, mNm, \"\""] {
        let text = format!("t,q,tau,note\n{units}\n0,180,1000,1\n10,90,2000,1\n20,0,3000,1\n");
        let path = written(folder.path(), "x.csv", &text);
        let found = table::read(&path, &Columns::default(), 0.05).unwrap();
        assert!((found.time_step - 0.01).abs() < 1e-12, "{units}");
        assert!((found.position.unwrap()[0] - std::f64::consts::PI).abs() < 1e-12, "{units}");
        assert_eq!(found.force, [1.0, 2.0, 3.0], "{units}");
        // A column is named with its unit, or without it.
        for name in ["tau", "tau [mNm]"] {
            let columns = Columns { force: Some(name.parse().unwrap()), ..Columns::default() };
            assert_eq!(table::read(&path, &columns, 0.05).unwrap().force[2], 3.0, "{name}");
        }
    }
    let path = written(folder.path(), "x.csv", "t,q,tau\ns,rad,cubits\n0,1,2\n1,2,3\n");
    let said = table::read(&path, &Columns::default(), 0.05).unwrap_err().to_string();
    assert!(said.contains("line 2"), "{said}");
}

#[test]
fn names_that_differ_in_a_number_are_joints() {
    let folder = tempfile::tempdir().unwrap();
    let mut text = "t,q1,q2,dq_1 [rad/s],dq_2 [rad/s],tau1_Nm,tau2_Nm\n".to_owned();
    for k in 0..20 {
        text += &format!("{},{k},{},1,2,10,20\n", f64::from(k) * 0.01, 2 * k);
    }
    let path = written(folder.path(), "arm.csv", &text);
    let found = table::read(&path, &of_joint(Some("2"), None), 0.05).unwrap();
    assert_eq!((found.position.unwrap()[3], found.force[0]), (6.0, 20.0));
    let several = table::read(&path, &Columns::default(), 0.05).unwrap_err();
    assert!(matches!(&several, RecordingError::SeveralJoints { present, .. } if present == "1, 2"));
    let seen = overview::look(&path, &Columns::default(), &JointChoice::default()).unwrap();
    assert_eq!(seen.joints, ["1", "2"]);
    assert!(seen.problems.iter().any(|said| said.contains("several joints")), "{seen:?}");
    // A number may be part of a name.
    let text = "t_s,torque,torque_2,q\n0,1,5,2\n1,1,5,3\n2,1,5,4\n";
    let path = written(folder.path(), "one.csv", text);
    assert_eq!(table::read(&path, &Columns::default(), 0.05).unwrap().force, [1.0; 3]);
}

#[test]
fn files_of_one_channel_each_are_joined_and_the_rows_get_their_times() {
    let folder = tempfile::tempdir().unwrap();
    let mut texts = ["Joint_1,Joint_2\n".to_owned(), "Joint_1,Joint_2\n".to_owned()];
    for k in 0..20 {
        texts[0] += &format!("{k},{}\n", 10 * k);
        texts[1] += &format!("1,{}\n", if k == 4 { "NaN" } else { "2" });
    }
    let position = written(folder.path(), "motor_position_rad.csv", &texts[0]);
    written(folder.path(), "motor_torque_Nm.csv", &texts[1]);
    let columns = of_joint(Some("Joint_2"), Some(0.005));
    let mut beside = columns.clone();
    beside.layout.beside = vec![folder.path().join("motor_torque_Nm.csv")];
    for (path, columns) in [(folder.path(), columns), (&position, beside)] {
        let found = table::read(path, &columns, 0.05).unwrap();
        assert!((found.time_step - 0.005).abs() < 1e-12);
        assert_eq!(found.samples(), 20, "the row without a value keeps its time");
        assert!((found.position.unwrap()[7] - 70.0).abs() < 1e-9);
        assert_eq!((found.force[7], found.irregularities.blank), (2.0, 1));
    }
    let untimed = table::read(folder.path(), &of_joint(Some("Joint_1"), None), 0.05);
    assert!(matches!(untimed, Err(RecordingError::Unrecognised { channel: Channel::Time, .. })));
    written(folder.path(), "short_Nm.csv", "Joint_1,Joint_2\n1,2\n");
    let said = table::read(folder.path(), &of_joint(Some("Joint_1"), Some(0.005)), 0.05);
    assert!(matches!(said, Err(RecordingError::Joined { rows: 1, expected: 20, .. })), "{said:?}");
}

#[test]
fn a_period_beside_a_time_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = written(folder.path(), "x.csv", "t,q,tau\n0,1,2\n1,2,3\n2,3,4\n");
    let said = table::read(&path, &of_joint(None, Some(0.1)), 0.05).unwrap_err();
    assert!(matches!(said, RecordingError::TimeTwice { .. }));
    let said = table::read(&path, &of_joint(Some("3"), None), 0.05).unwrap_err().to_string();
    assert!(said.contains("none, as no column"), "{said}");
}

/// What `table::read` makes of bytes.
fn read(bytes: &[u8]) -> Result<crate::Recording, RecordingError> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.csv");
    std::fs::write(&path, bytes).unwrap();
    table::read(&path, &Columns::default(), 0.05)
}

#[test]
fn texts_of_spreadsheets_and_of_measuring_programs_are_read() {
    let text = "t,q [°],tau\n0,180,1\n0.01,90,2\n0.02,0,3\n";
    let utf16 = |order: fn(u16) -> [u8; 2], mark: bool| -> Vec<u8> {
        let mark = mark.then_some(0xfeff);
        mark.into_iter().chain(text.encode_utf16()).flat_map(order).collect()
    };
    let latin: Vec<u8> = text.chars().map(|c| c as u8).collect();
    for bytes in [
        text.as_bytes().to_vec(),
        latin,
        utf16(u16::to_le_bytes, true),
        utf16(u16::to_be_bytes, true),
        utf16(u16::to_le_bytes, false),
    ] {
        let found = read(&bytes).unwrap();
        assert!((found.position.unwrap()[0] - std::f64::consts::PI).abs() < 1e-12);
        assert_eq!(found.force, [1.0, 2.0, 3.0]);
    }
    // Bytes of control are no text in any code page.
    let said = read(b"t,q,tau\n0,1,\xff\x01\n").unwrap_err().to_string();
    assert!(said.contains("UTF-8"), "{said}");
}

#[test]
fn a_current_in_place_of_a_torque_is_told_with_what_makes_it_one() {
    let rows: String = (0..40).map(|k| format!("{},{k},1\n", f64::from(k) * 0.01)).collect();
    let said = read(format!("t,q,i_A\n{rows}").as_bytes()).unwrap_err().to_string();
    assert!(said.contains("--force-column 'i_A:KT'"), "{said}");
    let said = read(format!("t,q,other\n{rows}").as_bytes()).unwrap_err().to_string();
    assert!(!said.contains("KT"), "{said}");
}

#[test]
fn times_written_as_dates_are_read() {
    let text = |stamp: &dyn Fn(u32) -> String| {
        let rows = (0..40).map(|k| format!("{},{k},1\n", stamp(k)));
        format!("time,q,tau\n{}", rows.collect::<String>())
    };
    let day = |k: u32| format!("2024-03-01T12:00:59.{:03}Z", 900 + k);
    let found = read(text(&day).as_bytes()).unwrap();
    assert!((found.time_step - 1e-3).abs() < 1e-9, "{}", found.time_step);
    // A second apart they are seconds, as their form says.
    let slow = |k: u32| format!("12:00:{k:02}");
    assert!((read(text(&slow).as_bytes()).unwrap().time_step - 1.0).abs() < 1e-9);
    for odd in ["01.03.24 12:00:00", "0.5"] {
        let mixed = |k: u32| if k == 20 { odd.to_owned() } else { day(k) };
        let said = read(text(&mixed).as_bytes()).unwrap_err().to_string();
        assert!(said.contains("line 22") && said.contains("2024-03-01T"), "{said}");
    }
}

/// Two phases were taken for a current in amperes, a motor and its load for metres.
#[test]
fn a_letter_that_tells_columns_apart_is_no_unit() {
    let said = |header: &str| {
        let columns = Columns { measured: table::Measured::Current, ..Columns::default() };
        let folder = tempfile::tempdir().unwrap();
        let path =
            written(folder.path(), "x.csv", &format!("{header}\n0,1,2,3\n0.1,2,3,4\n0.2,3,4,5\n"));
        table::read(&path, &columns, 0.05)
    };
    assert_eq!(said("t,q,i_A,i_ref").unwrap().force, [2.0, 3.0, 4.0]);
    let phases = said("t,q,i_a,i_b").unwrap_err().to_string();
    assert!(phases.contains("recognised as the current"), "{phases}");
    let two = said("t,q_m,q_l,i").unwrap_err().to_string();
    assert!(two.contains("recognised as the position"), "{two}");
    assert_eq!(said("t,q_m,q_ref,i").unwrap().position, Some(vec![1.0, 2.0, 3.0]));
    assert!(said("t,q_rad,force_V,i").is_ok());
}

/// The inertia of a slide in metres moved by newton metres was shown in kilograms.
#[test]
fn a_motion_and_a_force_of_two_kinds_of_axis_are_refused() {
    let read_as = |header: &str, force: Option<&str>| {
        let folder = tempfile::tempdir().unwrap();
        let path = written(folder.path(), "x.csv", &format!("{header}\n0,1,2\n0.1,2,3\n0.2,3,4\n"));
        let force = force.map(|name| name.parse().unwrap());
        table::read(&path, &Columns { force, ..Columns::default() }, 0.05)
    };
    for header in ["t,q [mm],tau [Nm]", "t,pos_deg,force_N"] {
        let said = read_as(header, None).unwrap_err().to_string();
        assert!(said.contains("two kinds of axis") && said.contains(":FACTOR"), "{said}");
    }
    let found = read_as("t,q [mm],tau [Nm]", Some("tau [Nm]:314")).unwrap();
    assert_eq!((found.axis, found.force[0]), (Some(crate::AxisKind::Linear), 628.0));
    assert!(read_as("t,q [mm],force [N]", None).is_ok());
    assert!(read_as("t,q [mm],effort", None).is_ok());
}

#[test]
fn tables_as_other_programs_write_them_are_read() {
    let plain = read(b"t,q,tau\n0,1,2\n0.5,1.5,-3\n1,2,4\n").unwrap();
    for text in [
        "sep=;\nt;q;tau\n0;1;2\n0,5;1,5;-3\n1;2;4\n",
        "t,q,tau\n0,1,2\n   \n0.5,1.5,-3\n\t\n1,2,4\n",
        "t,q,tau\n\"0\",\"1\",\"2\"\n\"0,5\",\"1,5\",\"-3\"\n\"1\",\"2\",\"4\"\n",
        "\"t\",\"q, motor\",\"q\",\"tau\"\n0,7,1,2\n0.5,7,1.5,-3\n1,7,2,4\n",
        "t [s]  q [rad]  tau [N m]\n0.0  1  2\n0.5  1.5  -3\n1.0  2  4\n",
        "# t [s]  q [rad]  tau [N m]\n0.0 1 2\n0.5 1.5 -3\n1.0 2 4\n",
        ",t,q,tau\n0,0,1,2\n1,0.5,1.5,-3\n2,1,2,4\n",
    ] {
        let found = read(text.as_bytes()).unwrap_or_else(|error| panic!("{text:?}: {error}"));
        assert_eq!((found.position, found.force), (plain.position.clone(), plain.force.clone()));
    }
}

#[test]
fn what_is_read_wrongly_elsewhere_is_refused_with_the_way_out() {
    let rows = |line: &dyn Fn(u32) -> String| (0..40).map(line).collect::<String>();
    let coarse = format!("t,q,tau\n{}", rows(&|k| format!("{},{k},1\n", k / 10)));
    let thousands = format!("t,q,tau\n{}", rows(&|k| format!("{k},\"{},234\",1\n", k + 1)));
    for (text, parts) in [
        // Thousands were no decimals.
        (thousands.as_str(), &["1,234"][..]),
        ("t,q,q,tau\n0,1,2,3\n", &["2 columns named `q`", "number 2 and 3"]),
        (&coarse, &["36 of the 40 times", "too coarsely"]),
    ] {
        let said = read(text.as_bytes()).unwrap_err().to_string();
        assert!(parts.iter().all(|part| said.contains(part)), "{text:?}: {said}");
    }
}

#[test]
fn lines_above_the_names_are_none_of_the_table() {
    let rows: String = (0..30).map(|k| format!("{},{k},1\n", 0.1 * f64::from(k))).collect();
    for above in ["Recorder,v2\nrig,3\n", "Experiment 7\n\nOperator: Bob, Alice\n", "# x\nrig\n"] {
        let text = format!("{above}t,q,tau\n{rows}");
        assert_eq!(read(text.as_bytes()).unwrap().samples(), 30, "{above:?}");
        let folder = tempfile::tempdir().unwrap();
        let path = written(folder.path(), "x.csv", &text);
        let seen = overview::look(&path, &Columns::default(), &JointChoice::default()).unwrap();
        assert_eq!(seen.dialect.unwrap().above, above.lines().count());
    }
    // The lines keep their numbers.
    let said = read(format!("Rig\nof ours\nt,q,tau\n{rows}9,oops,1\n").as_bytes()).unwrap_err();
    assert!(said.to_string().contains("line 34"), "{said}");
}

#[test]
fn a_time_in_two_columns_is_one() {
    let read_as = |names: &str, tick: i64| {
        let row = |k: i64| {
            let now = 1_771_000_000_987_654_000 + k * 2_000_000;
            format!("{},{},{k},1\n", now / 1_000_000_000, now % 1_000_000_000 / tick)
        };
        read(format!("{names},q,tau\n{}", (0..40).map(row).collect::<String>()).as_bytes())
    };
    for (names, tick) in [
        ("sec,nanosec", 1),
        ("secs,nsecs", 1),
        ("header.stamp.sec,header.stamp.nanosec", 1),
        ("/joint_states/header/stamp/sec,/joint_states/header/stamp/nanosec", 1),
        ("tv_sec,tv_usec", 1000),
    ] {
        let found = read_as(names, tick).unwrap();
        assert!((found.time_step - 2e-3).abs() < 1e-12, "{names}: {}", found.time_step);
    }
    let said = read(b"sec,nanosec,q,tau\n1,2,3,4\n1,x,3,4\n").unwrap_err().to_string();
    assert!(said.contains("line 3") && said.contains("whole seconds"), "{said}");
    // A time of its own comes first.
    let found = read(b"t,sec,nanosec,q,tau\n0,5,0,1,1\n0.1,5,1,1,2\n0.2,5,2,1,3\n").unwrap();
    assert!((found.time_step - 0.1).abs() < 1e-12);
}

#[test]
fn dates_that_begin_with_the_day_are_read_and_unsure_ones_refused_past_midnight() {
    let text = |stamp: &dyn Fn(u32) -> String| {
        let rows = (0..50).map(|k| format!("{};{k};1\n", stamp(k)));
        format!("time;q;tau\n{}", rows.collect::<String>())
    };
    for date in ["13.02.2026", "03.02.2026", "13/02/2026", "02/13/2026", "03/02/2026"] {
        let found = read(text(&|k| format!("{date} 10:11:12.{:03}", 2 * k)).as_bytes()).unwrap();
        assert!((found.time_step - 2e-3).abs() < 1e-9, "{date}");
    }
    let past = |sep: char| {
        let text = text(&|k| match k {
            0..25 => format!("03{sep}02{sep}2026 23:59:59.{:03}", 975 + k),
            _ => format!("04{sep}02{sep}2026 00:00:00.{:03}", k - 25),
        });
        read(text.as_bytes())
    };
    assert!((past('.').unwrap().time_step - 1e-3).abs() < 1e-9);
    let said = past('/').unwrap_err().to_string();
    assert!(said.contains("line 27") && said.contains("told apart"), "{said}");
}

#[test]
fn a_date_and_a_time_of_day_in_two_columns_are_one_time() {
    let text = |names: &str, date: &dyn Fn(u32) -> String| {
        let clock = |k: u32| match k {
            0..25 => format!("23:59:59.{:03}", 950 + 2 * k),
            _ => format!("00:00:00.{:03}", 2 * (k - 25)),
        };
        let rows = (0..50).map(|k| format!("{};{};{k};1\n", date(k), clock(k)));
        format!("{names};q;tau\n{}", rows.collect::<String>())
    };
    let day = |k: u32| if k < 25 { 3 } else { 4 };
    for (names, form) in [
        ("Date;Time", "2026-02-0D"),
        ("date;time_of_day", "2026/02/0D"),
        ("log.date;log.time", "0D.02.2026"),
    ] {
        let text = text(names, &|k| form.replace('D', &day(k).to_string()));
        let found = read(text.as_bytes()).unwrap();
        assert!((found.time_step - 2e-3).abs() < 1e-9, "{names}: {}", found.time_step);
        assert_eq!(found.force.len(), 50);
    }
    // Which is the day and which the month is not known, and it is past midnight.
    let unsure = text("date;time", &|k| format!("0{}/02/2026", day(k)));
    let said = read(unsure.as_bytes()).unwrap_err().to_string();
    assert!(said.contains("line 27") && said.contains("told apart"), "{said}");
    // Beside seconds a date says nothing.
    let seconds = "date,time,q,tau\n2026-02-03,0.1,1,1\n2026-02-03,0.2,1,2\n2026-02-03,0.3,1,3\n";
    assert!((read(seconds.as_bytes()).unwrap().time_step - 0.1).abs() < 1e-9);
}
