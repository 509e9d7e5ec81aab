//! Two nodes of one name: the one that was there first stays, the other refuses to work.

use std::{cmp::Ordering, fmt};

use crate::{Graph, graph::ParticipantId, one_writer::WriterId};

/// Two that began within this time of each other may each have heard of the other too late to know
/// who was first \[ns\].
const AT_ONCE: u64 = 1_000_000_000;

/// Looks for other nodes of this node's name.
#[derive(Debug, Clone)]
pub(crate) struct Twins {
    pub(crate) graph: Graph,
    /// Namespace and name.
    pub(crate) name: String,
    pub(crate) own: ParticipantId,
    /// When this node began \[ns since the epoch\].
    pub(crate) began: u64,
}

/// Another node of the same name.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Twin {
    name: String,
    participant: ParticipantId,
    /// The other one was there first.
    pub elder: bool,
}

impl fmt::Display for Twin {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { name, participant, elder } = self;
        let other = WriterId(*participant);
        if *elder {
            write!(
                f,
                "another node {name} was there before (participant {other}); this one does not work beside it: end one of them, or give this one another name or namespace (-r __node:=, -r __ns:=)"
            )
        } else {
            write!(
                f,
                "a second node {name} has come (participant {other}); end it, or give it another name or namespace"
            )
        }
    }
}

impl Twins {
    /// One that was there before, or else any other.
    pub(crate) fn found(&self) -> Option<Twin> {
        let all = self.graph.namesakes(&self.name, self.own);
        let twins = all.into_iter().map(|(participant, since)| Twin {
            name: self.name.clone(),
            participant,
            elder: is_elder((participant, since), (self.own, self.began)),
        });
        twins.max_by_key(|twin| twin.elder)
    }
}

/// Whether the other one was there first. Of two that began at once both say the same, by their
/// identifiers.
fn is_elder(
    (other, since): (ParticipantId, Option<u64>),
    (own, began): (ParticipantId, u64),
) -> bool {
    match since {
        Some(since) if since < began => true,
        Some(since) if since - began > AT_ONCE => false,
        // One that does not tell its time is no node of this laboratory: this one keeps away from
        // it.
        None => true,
        Some(_) => other.cmp(&own) == Ordering::Less,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const A: ParticipantId = [1; 16];
    const B: ParticipantId = [2; 16];
    const S: u64 = 1_000_000_000;

    #[test]
    fn of_two_the_later_one_gives_way_whoever_has_the_lower_identifier() {
        for (first, second) in [(A, B), (B, A)] {
            // The first began at 100 s and told of itself for 0.3 s.
            assert!(is_elder((first, Some(100 * S + S / 3)), (second, 110 * S)));
            assert!(!is_elder((second, Some(110 * S)), (first, 100 * S)));
        }
    }

    /// However close they begin, and whichever of their words is heard, never do both go on.
    #[test]
    fn two_never_both_believe_that_they_were_first() {
        let telling = S / 2;
        for (one, other) in [(A, B), (B, A)] {
            for apart in (0..3 * S).step_by(50_000_000) {
                let (began, later) = (100 * S, 100 * S + apart);
                for heard in [0, telling / 2, telling] {
                    for heard_later in [0, telling / 2, telling] {
                        let first_yields =
                            is_elder((other, Some(later + heard_later)), (one, began));
                        let second_yields = is_elder((one, Some(began + heard)), (other, later));
                        assert!(first_yields || second_yields, "{apart} ns apart");
                    }
                }
            }
        }
    }
}
