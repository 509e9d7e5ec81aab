//! The short form of `cargo xtask bench-live`: both loops run and are compared. What comes out is
//! not judged here.

#[test]
fn the_bench_of_the_live_loop_prints_a_ratio_for_each_block() {
    let output = tests::xtask()
        .args(["bench-live", "--blocks", "2", "--seconds", "2", "--report-only", "--program"])
        .arg(tests::frictionlab().get_program())
        .current_dir(tests::checkout())
        .output()
        .expect("it starts");
    let (told, said) =
        (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    if said.contains("too busy to measure") {
        tests::leave_out("the machine is too busy for the bench");
        return;
    }
    assert!(output.status.success(), "{told}\n{said}");
    let rows: Vec<Vec<f64>> = told
        .lines()
        .filter_map(|line| {
            line.split_whitespace().map(|word| word.parse().ok()).collect::<Option<Vec<f64>>>()
        })
        .filter(|row| row.len() == 6)
        .collect();
    assert_eq!(rows.len(), 2, "{told}");
    for row in &rows {
        let [_, live_p50, live_p99, bare_p50, bare_p99, ratio] = row[..] else { panic!("{told}") };
        assert!(live_p50 <= live_p99 && bare_p50 <= bare_p99, "{told}");
        // All three are printed rounded.
        let rounding = 0.0051 + 0.05 * (1.0 + ratio) / bare_p99.max(0.05);
        assert!((ratio - live_p99 / bare_p99).abs() < rounding, "{told}");
    }
    assert!(told.contains("median ratio of the p99 period errors"), "{told}");
}

#[test]
fn the_bench_holds_the_loop_with_viewers_against_the_loop_without() {
    let output = tests::xtask()
        .args(["bench-live", "--blocks", "1", "--seconds", "2", "--report-only"])
        .args(["--viewers", "3", "--program"])
        .arg(tests::frictionlab().get_program())
        .current_dir(tests::checkout())
        .output()
        .expect("it starts");
    let (told, said) =
        (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    if said.contains("too busy to measure") {
        tests::leave_out("the machine is too busy for the bench");
        return;
    }
    assert!(output.status.success(), "{told}\n{said}");
    assert!(told.contains("with 3 viewers: median ratio of the p99 period errors"), "{told}");
    let row: Vec<f64> = told
        .lines()
        .filter_map(|line| line.split_whitespace().map(|word| word.parse().ok()).collect())
        .find(|row: &Vec<f64>| row.len() == 12)
        .unwrap_or_else(|| panic!("no row: {told}"));
    // Late cycles without, with, and what they differ by.
    assert_eq!(row[11], row[9] - row[6], "{told}");
}
