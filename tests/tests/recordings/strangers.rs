//! `cargo xtask strangers --real` on one small recording, and `--mujoco` on two axes: the command runs,
//! both halves tell the same, and what MuJoCo moves is judged. What comes of all of them stands in
//! `docs/explanation/strangers.md`.

use std::path::Path;

fn strangers(data: &Path, more: &[&str]) -> String {
    let output = tests::xtask()
        .args(["strangers", "--real", "--alone", "--data"])
        .arg(data)
        .args(more)
        .arg("--program")
        .arg(tests::frictionlab().get_program())
        .current_dir(tests::checkout())
        .output()
        .expect("it starts");
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{said}");
    String::from_utf8(output.stdout).expect("it tells in UTF-8")
}

#[tests::needs(emps)]
#[test]
fn halves_of_a_real_recording_tell_the_same() {
    let plain = ["--only", "emps validation", "--with=--order=4"];
    let told = strangers(&tests::shared_data(), &plain);
    assert!(
        told.contains("| emps validation | first and second half | symmetric; symmetric |"),
        "{told}"
    );
    let pairs = told.lines().find(|line| line.starts_with("identified by both halves"));
    assert!(pairs.is_some_and(|line| line.contains("(100 %) agree")), "{told}");
    assert!(!told.contains("tx40"), "{told}");
}

#[test]
fn a_folder_without_recordings_is_said_to_have_none() {
    let empty = tempfile::tempdir().unwrap();
    let told = strangers(empty.path(), &[]);
    assert!(told.starts_with("skipped: ") && told.contains("no recording"), "{told}");
}

#[tests::needs(mujoco)]
#[test]
fn axes_that_mujoco_moves_are_judged() {
    let out = tempfile::tempdir().unwrap();
    let output = tests::xtask()
        .args(["strangers", "--mujoco", "--machines", "2", "--first", "1", "--alone", "--out"])
        .arg(out.path())
        .arg("--program")
        .arg(tests::frictionlab().get_program())
        .current_dir(tests::checkout())
        .output()
        .expect("it starts");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let told = String::from_utf8(output.stdout).expect("it tells in UTF-8");
    for row in ["| 1 | mujoco | 100 | moves |", "| 2 | mujoco | 1000 | triangle, gravity |"] {
        assert!(told.contains(row), "{told}");
    }
    assert!(told.contains("2 machines, 0 refused"), "{told}");
}
