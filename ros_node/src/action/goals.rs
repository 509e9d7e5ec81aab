//! The goals a server knows, and what rcl says about them.

use std::collections::BTreeMap;

use ros2_client::{
    RmwRequestId,
    action::{
        CancelGoalResponse, GetResultResponse, GoalEndStatus, GoalId, GoalInfo, GoalStatusEnum,
    },
    action_msgs::{CancelGoalResponseEnum, GoalStatus, GoalStatusArray},
    builtin_interfaces::Time,
};
use serde::Deserialize;

/// Finished goals whose results are kept.
const KEPT: usize = 32;

/// What a cancel request asks for: a goal, everything up to a time, both, or everything.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub(super) struct Wanted {
    /// The goal; zero for none in particular.
    pub(super) goal_id: GoalId,
    /// Goals accepted up to then; zero for none.
    pub(super) stamp: Time,
}

impl Wanted {
    fn matches(&self, id: GoalId, accepted: Time) -> bool {
        match (self.goal_id == GoalId::ZERO, self.stamp == Time::ZERO) {
            (true, true) => true,
            (_, false) => id == self.goal_id || accepted <= self.stamp,
            (false, true) => id == self.goal_id,
        }
    }
}

struct Record<R> {
    status: GoalStatusEnum,
    accepted: Time,
    /// Number of the goal in order of acceptance.
    number: u64,
    waiting: Vec<RmwRequestId>,
    result: Option<R>,
}

/// All goals since the start, apart from finished ones that were pushed out by later ones.
pub(super) struct Goals<R> {
    records: BTreeMap<GoalId, Record<R>>,
    next: u64,
}

impl<R: Clone + Default> Goals<R> {
    pub(super) const fn new() -> Self {
        Self { records: BTreeMap::new(), next: 0 }
    }

    /// Takes a goal in, which is executed from now on; false if there is one of that name already.
    pub(super) fn accept(&mut self, id: GoalId, now: Time) -> bool {
        if self.records.contains_key(&id) {
            return false;
        }
        let record = Record {
            status: GoalStatusEnum::Executing,
            accepted: now,
            number: self.next,
            waiting: Vec::new(),
            result: None,
        };
        self.next += 1;
        self.records.insert(id, record);
        let finished = self.records.iter().filter(|(_, record)| record.result.is_some());
        if finished.clone().count() > KEPT
            && let Some(oldest) =
                finished.min_by_key(|(_, record)| record.number).map(|(id, _)| *id)
        {
            self.records.remove(&oldest);
        }
        true
    }

    /// Unfinished goals that a cancel request means.
    pub(super) fn matching(&self, wanted: &Wanted) -> Vec<GoalId> {
        self.records
            .iter()
            .filter(|(id, record)| record.result.is_none() && wanted.matches(**id, record.accepted))
            .map(|(id, _)| *id)
            .collect()
    }

    /// Notes which goals are being cancelled, and words the answer.
    pub(super) fn cancel(&mut self, wanted: &Wanted, granted: &[GoalId]) -> CancelGoalResponse {
        let mut goals_canceling = Vec::new();
        for id in granted {
            if let Some(record) = self.records.get_mut(id) {
                // One that finished meanwhile keeps its end.
                if record.result.is_none() {
                    record.status = GoalStatusEnum::Canceling;
                }
                goals_canceling.push(GoalInfo { goal_id: *id, stamp: record.accepted });
            }
        }
        let return_code = match self.records.get(&wanted.goal_id) {
            _ if !goals_canceling.is_empty() => CancelGoalResponseEnum::None,
            Some(record) if record.result.is_some() => CancelGoalResponseEnum::GoalTerminated,
            None if wanted.goal_id != GoalId::ZERO => CancelGoalResponseEnum::UnknownGoal,
            _ => CancelGoalResponseEnum::Rejected,
        };
        CancelGoalResponse { return_code, goals_canceling }
    }

    /// The result for whoever asks; none yet if the goal is not finished, then the answer comes
    /// with [`finish`](Self::finish).
    pub(super) fn result(&mut self, id: GoalId, to: RmwRequestId) -> Option<GetResultResponse<R>> {
        let Some(record) = self.records.get_mut(&id) else {
            return Some(GetResultResponse {
                status: GoalStatusEnum::Unknown,
                result: R::default(),
            });
        };
        match &record.result {
            Some(result) => {
                Some(GetResultResponse { status: record.status, result: result.clone() })
            }
            None => {
                record.waiting.push(to);
                None
            }
        }
    }

    /// Ends a goal; the answers to those who wait for its result.
    pub(super) fn finish(
        &mut self,
        id: GoalId,
        end: GoalEndStatus,
        result: R,
    ) -> Vec<(RmwRequestId, GetResultResponse<R>)> {
        let Some(record) = self.records.get_mut(&id) else { return Vec::new() };
        record.status = match end {
            GoalEndStatus::Succeeded => GoalStatusEnum::Succeeded,
            GoalEndStatus::Aborted => GoalStatusEnum::Aborted,
            GoalEndStatus::Canceled => GoalStatusEnum::Canceled,
        };
        let status = record.status;
        let waiting = std::mem::take(&mut record.waiting);
        record.result = Some(result.clone());
        let answer = |to| (to, GetResultResponse { status, result: result.clone() });
        waiting.into_iter().map(answer).collect()
    }

    /// The message of the status topic.
    pub(super) fn statuses(&self) -> GoalStatusArray {
        let mut records: Vec<_> = self.records.iter().collect();
        records.sort_by_key(|(_, record)| record.number);
        let status = |(id, record): (&GoalId, &Record<R>)| GoalStatus {
            goal_info: GoalInfo { goal_id: *id, stamp: record.accepted },
            status: record.status,
        };
        GoalStatusArray { status_list: records.into_iter().map(status).collect() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn goals() -> (Goals<u32>, GoalId, GoalId) {
        let mut goals = Goals::new();
        let (first, second) = (GoalId::new_random(), GoalId::new_random());
        assert!(goals.accept(first, Time::from_nanos(10)));
        assert!(goals.accept(second, Time::from_nanos(20)));
        (goals, first, second)
    }

    #[test]
    fn a_result_is_given_to_all_who_ask_before_and_after() {
        let (mut goals, first, _) = goals();
        let asker = |sequence_number| RmwRequestId { sequence_number, ..RmwRequestId::default() };
        assert!(goals.result(first, asker(1)).is_none());
        assert!(goals.result(first, asker(2)).is_none());
        let answers = goals.finish(first, GoalEndStatus::Succeeded, 7);
        assert_eq!(answers.iter().map(|(to, _)| to.sequence_number).collect::<Vec<_>>(), [1, 2]);
        assert!(answers.iter().all(|(_, answer)| answer.result == 7));
        for sequence_number in 3..5 {
            let late = goals.result(first, asker(sequence_number)).unwrap();
            assert_eq!((late.status, late.result), (GoalStatusEnum::Succeeded, 7));
        }
        let nobody = goals.result(GoalId::new_random(), asker(9)).unwrap();
        assert_eq!(nobody.status, GoalStatusEnum::Unknown);
    }

    #[test]
    fn a_goal_has_one_name() {
        let (mut goals, first, _) = goals();
        assert!(!goals.accept(first, Time::from_nanos(30)));
    }

    #[test]
    fn cancel_requests_mean_what_rcl_says() {
        let (goals, first, second) = goals();
        let asks =
            |goal_id, nanos| goals.matching(&Wanted { goal_id, stamp: Time::from_nanos(nanos) });
        assert_eq!(asks(GoalId::ZERO, 0).len(), 2, "everything");
        assert_eq!(asks(GoalId::ZERO, 10), [first], "everything up to then");
        assert_eq!(asks(second, 0), [second], "one");
        assert_eq!(asks(second, 10).len(), 2, "one, and everything up to then");
        assert!(asks(GoalId::new_random(), 0).is_empty());
    }

    #[test]
    fn cancel_answers_have_the_codes_of_ros() {
        let (mut goals, first, second) = goals();
        let one = |goal_id| Wanted { goal_id, stamp: Time::ZERO };
        let answer = goals.cancel(&one(first), &[first]);
        assert_eq!(answer.return_code, CancelGoalResponseEnum::None);
        assert_eq!(answer.goals_canceling.len(), 1);
        assert_eq!(goals.statuses().status_list[0].status, GoalStatusEnum::Canceling);
        assert_eq!(goals.cancel(&one(second), &[]).return_code, CancelGoalResponseEnum::Rejected);
        goals.finish(first, GoalEndStatus::Canceled, 0);
        assert_eq!(
            goals.cancel(&one(first), &[]).return_code,
            CancelGoalResponseEnum::GoalTerminated
        );
        let unknown = one(GoalId::new_random());
        assert_eq!(goals.cancel(&unknown, &[]).return_code, CancelGoalResponseEnum::UnknownGoal);
    }

    #[test]
    fn old_results_make_room_and_running_goals_stay() {
        let mut goals: Goals<u32> = Goals::new();
        let running = GoalId::new_random();
        goals.accept(running, Time::from_nanos(1));
        for number in 0..100 {
            let id = GoalId::new_random();
            goals.accept(id, Time::from_nanos(number + 2));
            goals.finish(id, GoalEndStatus::Succeeded, 0);
        }
        assert!(goals.records.len() <= KEPT + 2, "{}", goals.records.len());
        assert!(goals.records.contains_key(&running));
    }
}
