//! Disjoint halves of the recordings: balanced half samples (McCarthy 1969, Review of the
//! International Statistical Institute 37, 239).
//!
//! Each split fits both halves by themselves. Half the difference of the two estimates the standard
//! error of the fit to all, whatever the noise, the model's errors and the minima of the search
//! are; and where the halves disagree, no interval from all of them together is to be believed.

/// Splits of `logs` recordings into two disjoint halves, at most `splits` of them, each once.
///
/// The recordings are taken in pairs in their order, one of each pair to either half, so that alike
/// neighbours stand against each other. Empty for a single recording.
pub fn half_samples(logs: usize, splits: usize) -> Vec<[Vec<usize>; 2]> {
    let mut all: Vec<[Vec<usize>; 2]> = Vec::new();
    if logs < 2 {
        return all;
    }
    // Rows of a Hadamard matrix, after Sylvester: their signs are those of the common bits.
    let rows = (logs.div_ceil(2) + 1).next_power_of_two();
    for row in 0..rows {
        let swapped = |pair: usize| (row & (pair + 1)).count_ones() % 2 == 1;
        let side = |log: usize| usize::from((log % 2 == 1) != swapped(log / 2));
        let mut halves = [Vec::new(), Vec::new()];
        for log in 0..logs {
            halves[side(log)].push(log);
        }
        if halves[0].first() != Some(&0) {
            halves.swap(0, 1);
        }
        if halves.iter().all(|half| !half.is_empty()) && !all.contains(&halves) {
            all.push(halves);
        }
        if all.len() == splits {
            break;
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn halves_are_disjoint_whole_and_never_the_same_twice() {
        assert!(half_samples(1, 4).is_empty());
        assert_eq!(half_samples(2, 4), [[vec![0], vec![1]]]);
        for logs in 2..20 {
            let splits = half_samples(logs, 4);
            for [a, b] in &splits {
                let mut both: Vec<usize> = a.iter().chain(b).copied().collect();
                both.sort_unstable();
                assert_eq!(both, (0..logs).collect::<Vec<_>>());
                assert!(a.len().abs_diff(b.len()) <= 1);
            }
            assert!(splits.len() >= 2 || logs == 2, "{logs}: {splits:?}");
        }
        assert_eq!(half_samples(12, 4).len(), 4);
    }
}
