//! What is said of a joint that was recorded while others moved.

use recording::Beside;
use report::numbers::significant;

/// Which they are, and what the recording therefore does not tell; none where none moves.
pub(super) fn note(others: &[Beside]) -> Option<String> {
    let one = |other: &Beside| format!("{} by {}", other.joint, significant(other.travel, 2));
    let all: Vec<String> = others.iter().map(one).collect();
    (!all.is_empty()).then(|| {
        format!(
            "Other joints move in this recording ({}; rad, or m of one that slides). By their weight, their place and their acceleration they act on \
             this one, and no model of one axis has that: the inertia and the load are those of this motion, and not to be trusted. The friction is. \
             To find the others too, hold the other joints still.",
            all.join(", ")
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_joints_that_move_are_named() {
        assert_eq!(note(&[]), None);
        let moves = |joint: &str, travel| Beside { joint: joint.to_owned(), travel };
        let said = note(&[moves("elbow", 1.2345), moves("wrist", 0.3)]).unwrap();
        assert!(said.contains("(elbow by 1.2, wrist by 0.30; rad"), "{said}");
    }
}
