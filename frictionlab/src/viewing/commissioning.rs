//! A view of a commission: how it stands, the cycles of its rig, and the consent to it.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender};
use std::sync::{Arc, LazyLock, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::Duration;

use commission::Board;
use commission::board::Cycle;
use msgs::friction_msgs::ControllerState;
use msgs::std_msgs::Header;
use msgs::{cdr, topics};
use rig_driver::messages::rig_measurement;
use serde_json::{Value, json};
use view::{Access, ChannelId, Hub, Service, Steering, Token, ViewError, ViewOptions};

use super::at_work::WorkView;
use super::clock::now_ns;
use super::ending::Ending;
use super::pace::Pace;
use super::paper::Paper;
use super::shelf::{Shelf, WithShelf};
use super::topics::known;

/// The service by which a viewer says whether the shaft may turn.
const CONSENT: &str = "/commission/consent";
/// How long the thread that shows cycles waits for one before it looks whether it is over.
const WAIT: Duration = Duration::from_millis(200);

/// The commission that was asked for over ROS 2 last: one is done at a time.
pub static REQUESTED: LazyLock<Board> = LazyLock::new(Board::default);

/// How the commission stands that was asked for; nothing before the first.
#[cfg(feature = "ros")]
pub(super) fn requested() -> Option<Value> {
    let standing = REQUESTED.standing();
    let phase = match (&standing.why, &standing.worth) {
        (Some(_), _) => "ended",
        (None, Some(_)) => "done",
        (None, None) => "runs",
    };
    let paper = json!({
        "phase": phase,
        "question": null,
        "believed": [],
        "why": standing.why,
        "hint": "",
        "standing": standing,
    });
    (!standing.folder.is_empty()).then_some(paper)
}

/// A view of a commission. Dropped, it ends.
pub struct CommissionView {
    work: WorkView,
    desk: Arc<Desk>,
    shelf: Arc<Shelf>,
}

/// What the threads of a view share.
struct Desk {
    board: Board,
    state: Mutex<State>,
}

/// Where a commission is, besides what its stages write.
#[derive(Default)]
struct State {
    phase: Phase,
    /// What is believed of the rig: name and value.
    believed: Vec<(String, String)>,
    /// What to do next, where it did not come to its end.
    hint: String,
}

#[derive(Default)]
enum Phase {
    /// Nothing has moved.
    #[default]
    Before,
    /// Somebody is asked whether the shaft may turn.
    Asks(Question),
    /// The stages are underway.
    Runs,
    /// It came to its end.
    Done,
    /// It did not, and why.
    Ended(String),
}

/// Whether the shaft may turn.
struct Question {
    /// Nobody can answer a question that he has not been shown.
    id: Token,
    answer: Sender<bool>,
}

impl CommissionView {
    /// Opens a view of what is written on `board`; a viewer may set `stop`.
    ///
    /// # Errors
    /// [`ViewError`] if the port is taken or the system refuses.
    pub fn open(
        options: &ViewOptions,
        board: &Board,
        stop: &Arc<AtomicBool>,
        shelf: Arc<Shelf>,
    ) -> Result<Self, ViewError> {
        let hub = Hub::default();
        let channels: BTreeMap<String, ChannelId> = known()
            .into_iter()
            .map(|channel| (channel.topic.clone(), hub.offer(channel)))
            .collect();
        let desk = Arc::new(Desk { board: board.clone(), state: Mutex::default() });
        let ending = Arc::new(Ending::new(stop));
        let asked = Arc::new(Asked { desk: Arc::clone(&desk), ending: Arc::clone(&ending) });
        let asked = Arc::new(WithShelf { asked, shelf: Arc::clone(&shelf) });
        let mut paper = Paper::new(&hub);
        let told = Arc::clone(&desk);
        let tell = move || paper.tell(&told.document());
        let work = WorkView::open(options, &hub, (asked, ending), tell)?;
        if let Some(cycles) = board.listen() {
            let shown = Shown::new(hub, &channels);
            thread::Builder::new()
                .name("view cycles".into())
                .spawn(move || shown.all(&cycles))
                .map_err(ViewError::System)?;
        }
        Ok(Self { work, desk, shelf })
    }

    /// Where it is, in words for people.
    #[must_use]
    pub fn words(&self) -> String {
        self.work.words()
    }

    /// What is believed of the rig, before anything moves; a row a line.
    pub fn believes(&self, believed: &str) {
        let row = |line: &str| {
            let (name, value) = line.split_once("  ").unwrap_or((line, ""));
            (name.trim().to_owned(), value.trim().to_owned())
        };
        self.desk.state().believed = believed.lines().map(row).collect();
        self.work.poke();
    }

    /// Asks viewers whether the shaft may turn; the first answer goes to `answer`.
    ///
    /// # Errors
    /// If the system gives no random numbers.
    pub fn ask(&self, answer: Sender<bool>) -> std::io::Result<()> {
        self.desk.state().phase = Phase::Asks(Question { id: Token::draw()?, answer });
        self.work.poke();
        Ok(())
    }

    /// The stages begin; results go to `folder`.
    pub fn begins(&self, folder: &Path) {
        self.shelf.add(folder);
        self.desk.state().phase = Phase::Runs;
        self.work.poke();
    }

    /// What is kept, and how it goes on from there, where it does not come to its end.
    pub fn hints(&self, hint: String) {
        self.desk.state().hint = hint;
    }

    /// It is over: at its end, or for a reason.
    pub fn ends(&self, ended: Result<(), String>) {
        self.desk.state().phase = ended.map_or_else(Phase::Ended, |()| Phase::Done);
        self.work.poke();
    }

    /// Whoever looks may go on looking, until ctrl-C where somebody sits at a terminal, else until
    /// the last viewer has left.
    pub fn stay(&self, quiet: bool) {
        self.work.stay(quiet);
    }
}

impl Desk {
    fn document(&self) -> Value {
        let standing = self.board.standing();
        let state = self.state();
        let (phase, question, why) = match &state.phase {
            Phase::Before => ("before", None, None),
            Phase::Asks(question) => ("asks", Some(question.id.as_str()), None),
            Phase::Runs => ("runs", None, None),
            Phase::Done => ("done", None, None),
            Phase::Ended(why) => ("ended", None, Some(why)),
        };
        json!({
            "phase": phase,
            "question": question,
            "believed": state.believed,
            "why": why,
            "hint": state.hint,
            "standing": standing,
        })
    }

    /// A viewer's answer. The first one counts, and only one to the question that is asked.
    fn answered(&self, request: &Value) -> Result<Value, String> {
        let said = |field: &str| {
            let text = request[field].as_str();
            text.ok_or_else(|| format!("`{field}` must be a text"))
        };
        let (id, answer) = (said("question")?, said("answer")?);
        let yes = match answer {
            "yes" => true,
            "no" => false,
            other => return Err(format!("`answer` must be yes or no, but is {other:?}")),
        };
        let mut state = self.state();
        let Phase::Asks(question) = &state.phase else {
            return Ok(refused("nothing is asked now"));
        };
        if !question.id.is(id) {
            return Ok(refused("another question is asked by now: look at the page once more"));
        }
        if question.answer.send(yes).is_err() {
            return Ok(refused("somebody else has answered"));
        }
        state.phase = Phase::Before;
        let message = if yes { "the shaft may turn" } else { "nothing moves" };
        Ok(json!({ "success": true, "message": message }))
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

fn refused(why: &str) -> Value {
    json!({ "success": false, "message": why })
}

/// What viewers ask of a commission: its end, and whether it may begin.
struct Asked {
    desk: Arc<Desk>,
    ending: Arc<Ending>,
}

impl Steering for Asked {
    fn services(&self) -> Vec<Service> {
        let consent = Service {
            name: CONSENT.to_owned(),
            kind: "view/srv/Consent".to_owned(),
            request: json!({ "question": "", "answer": "" }),
            response: json!({ "success": false, "message": "" }),
            access: Access::Full,
            stops: false,
        };
        Ending::services().into_iter().chain([consent]).collect()
    }

    fn call(&self, service: &str, request: Value) -> Result<Value, String> {
        if service == CONSENT {
            return self.desk.answered(&request);
        }
        self.ending.call(service).ok_or_else(|| format!("there is no service {service}"))
    }
}

/// Shows cycles as they go by.
struct Shown {
    hub: Hub,
    measurement: Option<ChannelId>,
    controller: Option<ChannelId>,
    /// When rig time began \[ns since the epoch\].
    began: u64,
}

impl Shown {
    fn new(hub: Hub, channels: &BTreeMap<String, ChannelId>) -> Self {
        let id = |name: &str| channels.get(name).copied();
        Self {
            hub,
            measurement: id(topics::RIG_MEASUREMENT.name),
            controller: id(topics::CONTROLLER_STATE.name),
            began: now_ns(),
        }
    }

    /// All that come, until whoever tells of them has gone.
    fn all(&self, cycles: &Receiver<Cycle>) {
        let mut pace = Pace::default();
        loop {
            match cycles.recv_timeout(WAIT) {
                Ok(cycle) => self.one(&cycle, &mut pace),
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => return,
            }
        }
    }

    fn one(&self, cycle: &Cycle, pace: &mut Pace) {
        let rig_time = cycle.before + cycle.seen.time;
        let stamp = self.began + (rig_time.max(0.0) * 1e9) as u64;
        if self.hub.viewers() == 0 || !pace.shows(stamp) {
            return;
        }
        if let (Some(channel), Ok(bytes)) =
            (self.measurement, cdr::encode(&rig_measurement(stamp, &cycle.seen)))
        {
            self.hub.publish(channel, stamp, &bytes);
        }
        let Some((reference, feedback)) = cycle.followed else { return };
        let state = ControllerState {
            header: Header::at(stamp),
            mode: ControllerState::POSITION,
            reference,
            feedback,
            error: reference - feedback,
            ..ControllerState::default()
        };
        if let (Some(channel), Ok(bytes)) = (self.controller, cdr::encode(&state)) {
            self.hub.publish(channel, stamp, &bytes);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc::channel;

    use super::*;

    #[test]
    fn only_the_first_answer_to_the_question_that_is_asked_counts() {
        let desk = Desk { board: Board::default(), state: Mutex::default() };
        let asked = |id: &str, answer: &str| json!({ "question": id, "answer": answer });
        assert_eq!(desk.answered(&asked("", "yes")).unwrap()["success"], false);
        let (answer, answers) = channel();
        desk.state().phase = Phase::Asks(Question { id: Token::draw().unwrap(), answer });
        let id = desk.document()["question"].as_str().unwrap().to_owned();
        let other = Token::draw().unwrap();
        assert_eq!(desk.answered(&asked(other.as_str(), "yes")).unwrap()["success"], false);
        assert!(desk.answered(&asked(&id, "perhaps")).is_err());
        assert!(desk.answered(&json!({ "question": id })).is_err());
        assert!(answers.try_recv().is_err());
        assert_eq!(desk.answered(&asked(&id, "yes")).unwrap()["success"], true);
        assert_eq!(desk.answered(&asked(&id, "no")).unwrap()["success"], false);
        assert_eq!(answers.try_iter().collect::<Vec<_>>(), [true]);
    }

    #[test]
    fn an_answer_that_came_too_late_is_told_so() {
        let desk = Desk { board: Board::default(), state: Mutex::default() };
        let (answer, answers) = channel();
        drop(answers);
        desk.state().phase = Phase::Asks(Question { id: Token::draw().unwrap(), answer });
        let id = desk.document()["question"].as_str().unwrap().to_owned();
        let told = desk.answered(&json!({ "question": id, "answer": "yes" })).unwrap();
        assert_eq!(told["success"], false);
        assert!(told["message"].as_str().unwrap().contains("somebody else"));
    }
}
