//! How often a warning that others cause is told.

use std::{
    collections::BTreeMap,
    time::{Duration, Instant},
};

/// Shortest time between two warnings of one kind.
const BETWEEN: Duration = Duration::from_secs(1);
/// Kinds that are told apart; what is beyond them counts as one.
const KINDS: usize = 64;

/// What was told, by its kind: the time, and how many were not told since.
#[derive(Debug, Default)]
pub(crate) struct Repeated(BTreeMap<String, (Instant, u64)>);

impl Repeated {
    /// Whether one of `kind` may be told now; then how many were not told since the last.
    pub(crate) fn may_be_told(&mut self, kind: &str, now: Instant) -> Option<u64> {
        let kind = if self.0.len() < KINDS || self.0.contains_key(kind) { kind } else { "" };
        let Some((told, left_out)) = self.0.get_mut(kind) else {
            self.0.insert(kind.to_owned(), (now, 0));
            return Some(0);
        };
        if now.saturating_duration_since(*told) < BETWEEN {
            *left_out += 1;
            return None;
        }
        *told = now;
        Some(std::mem::take(left_out))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_a_second_of_each_kind_and_the_others_are_counted() {
        let (mut repeated, start) = (Repeated::default(), Instant::now());
        let at = |ms| start + Duration::from_millis(ms);
        assert_eq!(repeated.may_be_told("a", at(0)), Some(0));
        assert_eq!(repeated.may_be_told("b", at(1)), Some(0));
        assert_eq!(repeated.may_be_told("a", at(2)), None);
        assert_eq!(repeated.may_be_told("a", at(999)), None);
        assert_eq!(repeated.may_be_told("a", at(1000)), Some(2));
        assert_eq!(repeated.may_be_told("a", at(2500)), Some(0));
    }

    #[test]
    fn more_kinds_than_there_is_room_for_count_as_one() {
        let (mut repeated, now) = (Repeated::default(), Instant::now());
        let told =
            (0..1000).filter(|kind| repeated.may_be_told(&kind.to_string(), now).is_some()).count();
        assert_eq!(told, KINDS + 1);
    }
}
