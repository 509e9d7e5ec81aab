//! What viewers ask for, and whoever does it.

use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::Access;

/// A parameter as the protocol has it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Parameter {
    /// Node and name with a dot between, as in `/controller.pid.k_p`.
    pub name: String,
    /// Its value; null for one that is not set.
    #[serde(default)]
    pub value: Value,
    /// `float64` where a number without a fraction would else look like an integer.
    #[serde(rename = "type", default, skip_serializing_if = "Option::is_none")]
    pub kind: Option<String>,
}

/// A service that is offered.
#[derive(Debug, Clone, PartialEq)]
pub struct Service {
    /// Its absolute name.
    pub name: String,
    /// Its type, as in `std_srvs/srv/Trigger`.
    pub kind: String,
    /// A request as JSON with its default values.
    pub request: Value,
    /// An answer as JSON with its default values.
    pub response: Value,
    /// Who may call it.
    pub access: Access,
    /// It stops the motor: it comes before all else, and never waits for another call.
    pub stops: bool,
}

/// What a viewer asks of a recording.
#[derive(Debug, Clone, PartialEq)]
pub struct PlaybackRequest {
    /// Play, or pause.
    pub play: bool,
    /// Times real time.
    pub speed: f32,
    /// Where to go first \[ns since the epoch\].
    pub seek: Option<u64>,
    /// What the answer is to repeat.
    pub id: String,
}

/// Whether a recording goes on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PlaybackStatus {
    /// It does.
    Playing = 0,
    /// It waits for somebody.
    Paused = 1,
    /// It waits for the disk.
    Buffering = 2,
    /// It is over.
    Ended = 3,
}

/// How a recording is played.
#[derive(Debug, Clone, PartialEq)]
pub struct Playback {
    /// Whether it goes on.
    pub status: PlaybackStatus,
    /// Where it is \[ns since the epoch\].
    pub now: u64,
    /// Times real time.
    pub speed: f32,
    /// It jumped.
    pub sought: bool,
    /// The request that this answers, if any.
    pub id: String,
}

/// A file that is shown beside the page.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Shown {
    /// What it is, for the browser, as in `text/html; charset=utf-8`.
    pub kind: &'static str,
    /// All of it.
    pub bytes: Vec<u8>,
}

/// Does what viewers ask for. Every call is made on a thread of the view that may wait, several at
/// once. What comes is from strangers: it may be anything.
pub trait Steering: Send + Sync + 'static {
    /// The services, each with its name. Their places in the list are what viewers call them by, so
    /// it must stay as it is.
    fn services(&self) -> Vec<Service> {
        Vec::new()
    }

    /// Calls a service of that list.
    ///
    /// # Errors
    /// Why it cannot be called, for people.
    fn call(&self, service: &str, request: Value) -> Result<Value, String> {
        let _ = request;
        Err(format!("there is no service {service}"))
    }

    /// Values of parameters; of all that there are if no name is given.
    ///
    /// # Errors
    /// Why there are none, for people.
    fn parameters(&self, names: &[String]) -> Result<Vec<Parameter>, String> {
        let _ = names;
        Ok(Vec::new())
    }

    /// Sets parameters.
    ///
    /// # Errors
    /// Why they stay as they are, for people.
    fn set_parameters(&self, parameters: Vec<Parameter>) -> Result<(), String> {
        let _ = parameters;
        Err("there are no parameters".to_owned())
    }

    /// Takes a message of a viewer's own.
    ///
    /// # Errors
    /// Why it is not taken, for people.
    fn publish(&self, topic: &str, message: Value) -> Result<(), String> {
        let _ = message;
        Err(format!("nobody takes messages on {topic}"))
    }

    /// A file by the number of its folder and its name. Whoever is let in may see it. A browser
    /// keeps what it shows apart from the page: it has an origin of its own and reaches nobody.
    fn file(&self, folder: u32, name: &str) -> Option<Shown> {
        let _ = (folder, name);
        None
    }

    /// First and last moment of the recording \[ns since the epoch\], where one is played.
    fn recording(&self) -> Option<(u64, u64)> {
        None
    }

    /// Plays, pauses or seeks.
    fn play(&self, request: &PlaybackRequest) -> Option<Playback> {
        let _ = request;
        None
    }
}
