//! A managed node with parameters. They are declared once, and `ros2 param` and `ros2 lifecycle`
//! know them while it runs:
//!
//! ```text
//! managed --ros-args -p rate:=5.0 -p word:=hello &
//! ros2 param describe /managed rate
//! ros2 lifecycle set /managed configure
//! ```
//!
//! With the argument `--once` it activates itself, and ends.

use std::{
    process::ExitCode,
    sync::{Arc, Mutex, PoisonError},
    time::Duration,
};

use ::parameters::{Declared, ValueRange, parameters};
use ros_node::{
    Participant, RosNodeError, Stop,
    lifecycle::{CallbackError, Lifecycle, Managed, Requested},
    parameters::{ParameterError, Parameters},
};

parameters! {
    /// Parameters of the node.
    #[derive(Debug, Clone, PartialEq)]
    pub struct Talking {
        rate: f64 = 10.0, "How often it talks", unit("Hz"), range(ValueRange::POSITIVE);
        word: String = "nothing".to_owned(), "What it says";
    }
}

/// What the node does on its way between states.
struct Talker(Arc<Mutex<Talking>>);

impl Managed for Talker {
    fn activate(&mut self) -> Result<(), CallbackError> {
        let Talking { rate, word } = &*self.0.lock().unwrap_or_else(PoisonError::into_inner);
        println!("says {word} at {rate} Hz");
        Ok(())
    }
}

fn talk(participant: &Participant, stop: &Stop, once: bool) -> Result<(), RosNodeError> {
    let node = participant.node("managed")?;
    let now = Arc::new(Mutex::new(Talking::default()));
    let judged = Arc::clone(&now);
    let _parameters =
        Parameters::declare(&node, Talking::default().declarations(), move |values, _| {
            let wanted = Talking::default().with(values);
            if wanted.word.is_empty() {
                return Err(ParameterError::refused("word must not be empty"));
            }
            *judged.lock().unwrap_or_else(PoisonError::into_inner) = wanted;
            Ok(())
        })?;
    let lifecycle = Lifecycle::start(&node, Box::new(Talker(now)))?;
    if once {
        for requested in [Requested::Configure, Requested::Activate] {
            if let Err(reason) = lifecycle.request(requested) {
                node.logger().error(&reason.to_string());
            }
        }
        return Ok(());
    }
    while !stop.wait(Duration::from_secs(1)) {}
    Ok(())
}

fn main() -> ExitCode {
    let mut given = ros_node::command_line();
    let once = given.iter().any(|word| word == "--once");
    given.retain(|word| word != "--once");
    let about = "A managed node with parameters, as an example.";
    ros_node::run("managed", env!("CARGO_PKG_VERSION"), about, given, |participant, stop| {
        talk(participant, stop, once)
    })
}
