//! Jobs out of the journal, and into it.

use std::io::{Read, Seek, SeekFrom};

use serde::Serialize;
use serde::de::DeserializeOwned;

use super::line::{Done, Line, read, text_of};
use super::{Journal, now_ns};
use crate::run::RunError;
use crate::run::results::Reconnection;

impl Journal {
    /// What the next job gave in a run before this one; `None` from the first job on that was not
    /// done. A result that cannot be read counts as not done, and so does all that follows it.
    pub(in crate::run) fn replay<R: DeserializeOwned>(
        &mut self,
    ) -> Result<Option<Done<R>>, RunError> {
        let Some(place) = self.waiting.front().copied() else { return Ok(None) };
        let mut line = vec![0; place.length];
        let got = self
            .file
            .seek(SeekFrom::Start(place.offset))
            .and_then(|_| self.file.read_exact(&mut line));
        got.map_err(|source| self.unwritten(source))?;
        let Some(Line::Done(done)) = read::<R>(&line) else {
            self.forget(place.offset)?;
            return Ok(None);
        };
        self.waiting.pop_front();
        self.next += 1;
        self.last_start_ns = done.start_ns;
        self.file.seek(SeekFrom::End(0)).map_err(|source| self.unwritten(source))?;
        Ok(Some(done))
    }

    /// Start of the run that was delivered last, where a run that went on has not delivered one of
    /// its own yet.
    pub(in crate::run) fn resumed_after(&self) -> Option<u64> {
        let (_, _, jobs, _) = self.sessions.last()?;
        (self.sessions.len() > 1 && *jobs == 0).then_some(self.last_start_ns)
    }

    /// Takes the lines from `offset` on out of the file, but those of sittings.
    fn forget(&mut self, offset: u64) -> Result<(), RunError> {
        self.waiting.clear();
        self.file.set_len(offset).map_err(|source| self.unwritten(source))?;
        self.file.seek(SeekFrom::End(0)).map_err(|source| self.unwritten(source))?;
        let mut kept = Vec::new();
        for (begun, first, jobs, ended) in std::mem::take(&mut self.sessions) {
            let left = self.next.saturating_sub(first).min(jobs);
            if first > self.next {
                self.append(&Line::<()>::Session(begun.clone()))?;
            }
            kept.push((begun, first.min(self.next), left, ended.filter(|_| left > 0)));
        }
        self.sessions = kept;
        Ok(())
    }

    /// The line of the next job.
    pub(in crate::run) fn line<R: Serialize>(
        &self,
        start_ns: u64,
        result: &R,
    ) -> Result<(u64, String), RunError> {
        let finished_ns = now_ns();
        let done = Done { job: self.next, finished_ns, start_ns, result };
        text_of(&Line::Done(done)).map(|line| (finished_ns, line))
    }

    /// Writes the line of the job that was just delivered.
    pub(in crate::run) fn add(
        &mut self,
        (finished_ns, line): (u64, String),
    ) -> Result<(), RunError> {
        self.write(&line)?;
        self.note(finished_ns);
        self.next += 1;
        Ok(())
    }

    /// Keeps that the line failed and came back.
    pub(in crate::run) fn reconnected(
        &mut self,
        reconnection: &Reconnection,
    ) -> Result<(), RunError> {
        self.reconnections.push(reconnection.clone());
        self.append(&Line::<()>::Reconnection(reconnection.clone()))
    }

    /// What was repeated in all sittings.
    pub(in crate::run) fn reconnections(&self) -> Vec<Reconnection> {
        self.reconnections.clone()
    }
}
