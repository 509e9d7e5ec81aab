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
