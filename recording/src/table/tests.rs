use super::*;
use proptest::prelude::*;

fn parsed(text: &str) -> Result<Recording, RecordingError> {
    parse(Path::new("x.csv"), text.as_bytes(), &Columns::default(), 0.05)
}

fn message(text: &str) -> String {
    parsed(text).unwrap_err().to_string()
}

#[test]
fn reads_what_the_names_say() {
    let text = "t_s,position_m,force_N\n0,1,2\n0.1,1.5,-3e1\n0.2,2,4\n";
    let recording = parsed(text).unwrap();
    assert!((recording.time_step - 0.1).abs() < 1e-15);
    assert_eq!(recording.position, Some(vec![1.0, 1.5, 2.0]));
    assert_eq!(recording.velocity, None);
    assert_eq!(recording.force, [2.0, -30.0, 4.0]);
    assert_eq!(recording.axis, Some(AxisKind::Linear));
}

#[test]
fn joints_that_move_beside_the_one_that_was_chosen_are_told() {
    let text = "t_s,q1_rad,tau1_Nm,q2_deg,tau2_Nm,q3_rad,tau3_Nm\n\
                0,0.1,1,0,5,1.00,7\n0.1,0.2,2,,5,1.01,7\n0.2,0.4,3,90,5,1.00,7\n";
    let layout = Layout { joint: Some("1".to_owned()), ..Layout::default() };
    let columns = Columns { layout, ..Columns::default() };
    let found = parse(Path::new("x.csv"), text.as_bytes(), &columns, 0.05).unwrap();
    assert_eq!(found.force, [1.0, 2.0, 3.0], "a gap of another joint takes no row away");
    let [second] = &found.beside[..] else { panic!("{:?}", found.beside) };
    assert_eq!(second.joint, "2");
    assert!((second.travel - std::f64::consts::FRAC_PI_2).abs() < 1e-12);
}

#[test]
fn joints_that_move_are_told_where_columns_are_named_and_a_second_encoder_is_none() {
    let column = |text: &str| Some(text.parse::<Column>().unwrap());
    let columns = Columns { position: column("q2"), force: column("tau2"), ..Columns::default() };
    let found = |text: &str| {
        let found = parse(Path::new("x.csv"), text.as_bytes(), &columns, 0.05).unwrap();
        found.beside.into_iter().map(|other| other.joint).collect::<Vec<_>>()
    };
    let arm = "t_s,q1,q2,tau1,tau2\n0,0.1,1,0,5\n0.1,0.2,2,0,5\n0.2,0.4,3,0,5\n";
    assert_eq!(found(arm), ["1"]);
    let encoders = "t_s,q1,q2,tau2\n0,0.1,1,5\n0.1,0.2,2,5\n0.2,0.4,3,5\n";
    assert!(found(encoders).is_empty());
}

#[test]
fn blanks_semicolons_marks_and_units_are_understood() {
    let text = "\u{feff}time_ms ; Position_deg ;torque_Nm\r\n0; 180;1\r\n 10;90 ;2\r\n20;0;3\r\n";
    let recording = parsed(text).unwrap();
    assert!((recording.time_step - 0.01).abs() < 1e-15);
    assert!((recording.position.unwrap()[0] - std::f64::consts::PI).abs() < 1e-15);
    assert_eq!(recording.axis, Some(AxisKind::Rotary));
}

#[test]
fn decimal_commas_tabs_blanks_and_remarks_are_understood() {
    let plain = parsed("t_s,position_m,force_N\n0,1,2\n0.5,1.5,-3\n1,2,4\n").unwrap();
    for text in [
        "t_s;position_m;force_N\n0;1;2\n0,5;1,5;-3e0\n1,0;2,0;4\n",
        "t_s\tposition_m\tforce_N\n0\t1\t2\n0,5\t1,5\t-3\n1\t2\t4\n",
        "# a rig\n% of ours\nt_s,position_m,force_N\n0,1,2\n# here it was hit\n0.5,1.5,-3\n1,2,4\n",
        "# made by numpy\n# t_s position_m force_N\n0.0 1.0 2.0\n0.5  1.5 -3.0\n1.0 2.0 4.0\n",
        "t_s position_m force_N\n  0,0 1,0  2,0\n  0,5 1,5 -3,0\n  1,0 2,0  4,0\n",
        "t [s],position (mm),force [kN]\n0,1000,.002\n0.5,1500,-.003\n1,2000,.004\n",
    ] {
        let found = parsed(text).unwrap_or_else(|error| panic!("{text:?}: {error}"));
        assert_eq!(found.position, plain.position, "{text:?}");
        assert_eq!((found.force, found.time_step), (plain.force.clone(), 0.5), "{text:?}");
    }
    let commas = parsed("t_s;q_m;force_N\n0;1;2\n0,5;1,5;3\n1,0;2,0;4\n").unwrap();
    assert!(commas.irregularities.describe().unwrap().contains("comma"));
    assert_eq!(plain.irregularities.describe(), None);
}

#[test]
fn columns_of_a_table_without_names_are_counted() {
    let column = |text: &str| Some(text.parse::<Column>().unwrap());
    let named = Columns {
        time: column("1"),
        velocity: column("3"),
        force: column("2:0.5"),
        ..Columns::default()
    };
    let text = b"0,2,5\n0.1,4,6\n0.2,6,7\n";
    let found = parse(Path::new("x.csv"), text, &named, 0.05).unwrap();
    assert_eq!(found.force, [1.0, 2.0, 3.0]);
    assert_eq!(found.velocity, Some(vec![5.0, 6.0, 7.0]));
    let beyond = Columns { velocity: column("4"), ..named };
    let error = parse(Path::new("x.csv"), text, &beyond, 0.05).unwrap_err().to_string();
    assert!(error.contains("no column `4`") && error.contains("1, 2, 3"), "{error}");
}

#[test]
fn rows_without_a_value_are_left_out_and_counted() {
    let mut text = "t_s,position_m,other,force_N\n".to_owned();
    for k in 0..30 {
        let force = if k == 12 { "NaN".to_owned() } else { format!("{}", 2 * k) };
        text += &format!("{},{k},,{force}\n", 0.1 * f64::from(k));
    }
    let found = parsed(&text).unwrap();
    assert_eq!((found.samples(), found.irregularities.blank), (30, 1));
    assert!((found.force[12] - 24.0).abs() < 1e-9, "read between the neighbours");
    let said = found.irregularities.describe().unwrap();
    assert!(said.contains("1 row without a value"), "{said}");
}

#[test]
fn a_velocity_is_used_when_named_or_alone() {
    let both = "t_s,position_m,velocity_m_s,force_N\n0,1,5,2\n1,1,6,2\n2,1,7,2\n";
    assert_eq!(parsed(both).unwrap().velocity, None);
    let named = Columns { velocity: Some("velocity_m_s".parse().unwrap()), ..Columns::default() };
    let recording = parse(Path::new("x.csv"), both.as_bytes(), &named, 0.05).unwrap();
    assert_eq!(recording.velocity, Some(vec![5.0, 6.0, 7.0]));
    let alone = "t_s,velocity_m_s,force_N\n0,5,2\n1,6,2\n2,7,2\n";
    assert_eq!(parsed(alone).unwrap().velocity, Some(vec![5.0, 6.0, 7.0]));
}

/// A reference was taken for the torque, and a load cell for the force, without a word.
#[test]
fn a_column_that_does_not_say_what_it_is_is_told() {
    let said = |header: &str| {
        let rows = (0..30).map(|k| format!("{},{},{}\n", 0.1 * f64::from(k), k * k, k % 4));
        let found = parsed(&format!("{header}\n{}", rows.collect::<String>())).unwrap();
        found.irregularities.describe().unwrap_or_default()
    };
    let cell = said("t_s,table_mm,cell [N]");
    for part in ["`table_mm` is taken for the position", "`cell [N]` is", "--force-column"] {
        assert!(cell.contains(part), "{cell}");
    }
    let wanted = said("t_s,q_rad,tau_ref_Nm");
    assert!(wanted.contains("`tau_ref_Nm`") && wanted.contains("commanded"), "{wanted}");
    assert_eq!(said("t_s,Winkel (rad),Drehmoment (Nm)"), "");
}

/// A tester's angle of an encoder was read as one that flies back.
#[test]
fn an_angle_that_wraps_goes_on_and_is_told() {
    let row = |k: i32| {
        let angle = (4 * k + 180).rem_euclid(360) - 180;
        format!("{},{angle},1\n", 0.01 * f64::from(k))
    };
    let text = format!("t_s,angle_deg,tau_Nm\n{}", (0..200).map(row).collect::<String>());
    let found = parsed(&text).unwrap();
    let position = found.position.as_ref().unwrap();
    assert!((position[199] - 796f64.to_radians()).abs() < 1e-9, "{}", position[199]);
    let said = found.irregularities.describe().unwrap();
    assert!(said.contains("wraps 2 times by one turn"), "{said}");
}

/// A tester's position stood behind a gear, and the velocity before it.
#[test]
fn a_velocity_that_contradicts_the_position_and_a_scale_beside_a_unit_are_told() {
    let mut text = "t_s,position_deg,velocity_rpm,current_mA\n".to_owned();
    for k in 0..500 {
        let t = 0.01 * f64::from(k);
        let speed = if k == 7 { String::new() } else { format!("{}", 500.0 * (3.0 * t).cos()) };
        text += &format!("{t},{},{speed},{}\n", 20.0 * (3.0 * t).sin(), (2.0 * t).sin());
    }
    let force: Column = "current_mA:0.061".parse().unwrap();
    let columns = Columns { force: Some(force), ..Columns::default() };
    let read = |columns: &Columns| {
        let found = parse(Path::new("x.csv"), text.as_bytes(), columns, 0.05).unwrap();
        assert_eq!(found.irregularities.blank, usize::from(found.velocity.is_some()));
        let doubts = found.irregularities.doubts();
        assert_eq!(doubts.len(), 1, "{doubts:?}");
        (doubts[0].clone(), found.irregularities.describe().unwrap())
    };
    let (doubt, said) = read(&columns);
    assert!(doubt.contains("`velocity_rpm` is 50") && doubt.contains("The position is used"));
    assert!(said.contains("0.000061") && said.contains("the mA of its"), "{said}");
    let velocity = Some("velocity_rpm".parse().unwrap());
    let (doubt, _) = read(&Columns { velocity, ..columns });
    assert!(doubt.contains("The velocity is used. If the position is right"), "{doubt}");
}

#[test]
fn spikes_and_flat_tops_are_told_and_no_sample_is_changed() {
    let mut text = "t_s,q_rad,tau_Nm\n".to_owned();
    for k in 0..1000 {
        let t = 0.01 * f64::from(k);
        let torque = (2.0 * (3.0 * t).sin() + (1.7 * t).cos()).clamp(-1.5, 1.5);
        let torque = if k == 500 { 999.0 } else { torque };
        let position = if k == 300 { -80.0 } else { (2.0 * t).sin() };
        text += &format!("{t},{position},{torque}\n");
    }
    let spiked = parsed(&text).unwrap();
    assert_eq!(spiked.force[500], 999.0);
    let said = spiked.irregularities.describe().unwrap();
    assert!(said.contains("1 sample of `tau_Nm`") && said.contains("999 N m"), "{said}");
    assert!(said.contains("1 sample of `q_rad`") && said.contains("the first at 3 s"), "{said}");
    // That is no remark by the way: no number of such a recording is to be trusted.
    let said = parsed(&text.replace(",999\n", ",0\n")).unwrap().irregularities.doubts();
    assert!(said[0].contains("`tau_Nm` is cut at -1.5 and 1.5 N m"), "{said:?}");
}

#[test]
fn says_what_is_wrong_and_where() {
    for (text, parts) in [
        ("", &["x.csv", "empty"][..]),
        ("  \n\n", &["empty"]),
        ("t_s,position_m,force_N\n", &["no samples"]),
        ("0,1,2\n1,2,3\n", &["line 1", "header", "3 columns", "number"]),
        ("t_s,position_m,u\n0,1,2\n", &["t_s, position_m, u", "force or torque", "N or N m"]),
        ("t_s,r,force_N\n0,1,2\n", &["recognised as the position"]),
        ("a,position_m,force_N\n0,1,2\n", &["recognised as the time"]),
        ("t_s,position_m,force_N\n0,1,2\n1,oops,2\n", &["line 3", "position_m", "oops"]),
        ("t_s,position_m,force_N\n0,1,NaN\n", &["`force_N`", "no value", "1 rows"]),
        ("t_s,position_m,force_N\n0,1,inf\n", &["line 2", "inf"]),
        ("t_s,position_m,force_N\n0,1,\n", &["`force_N`", "no value"]),
        ("t_s,position_m,force_N\n0,0,1,5,2,0\n", &["line 2", "6 fields", "semicolons"]),
        ("t_s,position_m,force_N\n0,1,2\n1,2,3,4\n", &["line 3", "4 fields", "header has 3"]),
        ("t_s;position_m;force_N\n0;1,5;2\n1;1.5;2\n", &["line 3", "position_m", "1.5"]),
        ("t_s,position [ells],force_N\n0,1,2\n", &["`position [ells]`", "`ells`", "mm"]),
        ("t_s,position_m,force [%]\n0,1,2\n", &["`force [%]`", "Nm"]),
        ("t_s,position_m,force_N\n0,1,2\n1,2\n", &["line 3", "2 fields", "3"]),
        ("t_s,force_N,force_N,position_m\n0,1,2,3\n", &["2 columns", "force_N"]),
        ("t_s,position_m,force_N\n0,1,2\n2,1,2\n1,1,2\n", &["line 4", "does not increase"]),
        ("t_s,position_m,force_N\n0,1,2\n", &["1 samples"]),
    ] {
        let message = message(text);
        for part in parts {
            assert!(message.contains(part), "{text:?} gave {message:?} without {part:?}");
        }
    }
    let named = Columns { force: Some("farce".parse().unwrap()), ..Columns::default() };
    let error =
        parse(Path::new("x.csv"), b"t_s,position_m,force_N\n0,1,2\n", &named, 0.05).unwrap_err();
    assert!(error.to_string().contains("no column `farce`"));
    let latin =
        parse(Path::new("x.csv"), b"t_s,position_m,force_N\n0,1,\xff\n", &Columns::default(), 0.05);
    assert!(latin.unwrap_err().to_string().contains("line 2"));
}

/// Nanoseconds since the epoch, milliseconds and numbers of samples were taken for seconds.
#[test]
fn times_that_are_no_seconds_are_refused_unless_their_unit_is_known() {
    let text = |name: &str, step: f64| {
        let rows = (0..20).map(|k| format!("{},{k},1\n", 1.6e3 * step + f64::from(k) * step));
        format!("{name},position_rad,torque_Nm\n{}", rows.collect::<String>())
    };
    for (step, scale) in [(2e6, "1e-9"), (2e3, "1e-6"), (2.0, "1e-3")] {
        let said = message(&text("timestamp", step));
        assert!(said.contains(&format!("`timestamp:{scale}`")), "{said}");
        let column = format!("timestamp:{scale}").parse().ok();
        let named = Columns { time: column, ..Columns::default() };
        let text = text("timestamp", step);
        let found = parse(Path::new("x.csv"), text.as_bytes(), &named, 0.05).unwrap();
        assert!((found.time_step / 2e-3 - 1.0).abs() < 1e-6, "{}", found.time_step);
    }
    assert!((parsed(&text("t [s]", 2.0)).unwrap().time_step - 2.0).abs() < 1e-9);
    assert!((parsed(&text("t", 0.1)).unwrap().time_step - 0.1).abs() < 1e-9);
}

proptest! {
    #[test]
    fn never_panics(bytes in proptest::collection::vec(any::<u8>(), 0..200)) {
        let _ = parse(Path::new("x.csv"), &bytes[..], &Columns::default(), 0.05);
    }

    #[test]
    fn never_panics_on_near_tables(rows in "(t_s,position_m,force_N\n)([0-9.,;\n\" a-]{0,80})") {
        let _ = parsed(&rows);
    }
}
