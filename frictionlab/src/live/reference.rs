//! The node that says the reference of a live run: its parameters change the reference while it
//! runs.

use std::sync::{Arc, Mutex, PoisonError};

use ::parameters::{Declared, ParameterError, ValueRange, choices, parameters};
use experiment_runner::waveform::Waveform;
use ros_node::parameters::Parameters;
use ros_node::queue::{Receiver, Waker, queue};
use ros_node::{Participant, RosNode};

use super::LiveError;
use super::shape::{Kind, Shape};

/// Name of the node.
pub(super) const NAME: &str = "reference";
/// Shapes that wait for the control thread.
const WAITING: usize = 16;
/// Largest amplitude and offset [rad/s] or \[rad\].
const LARGEST: f64 = 50.0;
/// Smallest and largest angular frequency of a loop at 1 kHz [rad/s].
const FREQUENCIES: (f64, f64) = (1e-3, 500.0);

choices!(Kind);

parameters! {
    /// Parameters of the node `reference`.
    #[derive(Debug, Clone, Copy, PartialEq)]
    pub(super) struct ReferenceParameters {
        kind: Kind = Kind::VelocitySine, "Shape of the reference; a change is blended in";
        amplitude: f64 = 0.3, "Amplitude of the sine",
            unit("rad/s of a velocity, rad of a position"),
            range(ValueRange::Double(-LARGEST, LARGEST));
        frequency: f64 = 0.107, "Angular frequency of the sine", unit("rad/s"),
            range(ValueRange::Double(FREQUENCIES.0, FREQUENCIES.1));
        offset: f64 = 0.0, "What the sine is about, or the constant velocity",
            unit("rad/s of a velocity, rad of a position"),
            range(ValueRange::Double(-LARGEST, LARGEST));
    }
}

impl ReferenceParameters {
    fn shape(self) -> Shape {
        let Self { kind, amplitude, frequency, offset } = self;
        Shape { kind, amplitude, frequency, offset }
    }
}

/// The shape of a waveform that a live run begins with.
pub(super) fn shape(waveform: &Waveform) -> Shape {
    let usual = ReferenceParameters::default().shape();
    match *waveform {
        Waveform::SineVelocity { amplitude, angular_frequency } => {
            Shape { kind: Kind::VelocitySine, amplitude, frequency: angular_frequency, offset: 0.0 }
        }
        Waveform::SinePosition { amplitude, angular_frequency } => {
            Shape { kind: Kind::PositionSine, amplitude, frequency: angular_frequency, offset: 0.0 }
        }
        Waveform::ConstantVelocity { velocity } => {
            Shape { kind: Kind::ConstantVelocity, offset: velocity, ..usual }
        }
        // No option of `live` says any other.
        Waveform::StepVelocity { .. }
        | Waveform::StepPosition { .. }
        | Waveform::MovePosition { .. } => usual,
    }
}

/// The node, for as long as the run. Dropped, it leaves.
pub(super) struct ReferenceNode {
    _parameters: Parameters,
    _node: RosNode,
}

impl ReferenceNode {
    /// Joins the participant; shapes go to the control thread. A shape that is faster than `limit`
    /// [rad/s] is refused.
    ///
    /// # Errors
    /// [`LiveError`] if the middleware refuses.
    pub(super) fn new(
        participant: &Participant,
        begun: Shape,
        limit: Option<f64>,
    ) -> Result<(Self, Receiver<Shape>), LiveError> {
        let node = participant.node(NAME)?;
        let Shape { kind, amplitude, frequency, offset } = begun;
        let usual = ReferenceParameters { kind, amplitude, frequency, offset };
        let (shapes, for_loop) = queue(WAITING, &Waker::default());
        let shapes = Arc::new(Mutex::new(shapes));
        let mut first = true;
        let parameters = Parameters::declare(&node, usual.declarations(), move |values, _| {
            let shape = usual.with(values).shape();
            // What the run begins with is the loop's own.
            if std::mem::take(&mut first) && shape == begun {
                return Ok(());
            }
            held_to(&shape, limit)?;
            let mut shapes = shapes.lock().unwrap_or_else(PoisonError::into_inner);
            if shapes.send(shape) {
                Ok(())
            } else {
                Err(ParameterError::refused("too many requests at once; try again"))
            }
        })?;
        Ok((Self { _parameters: parameters, _node: node }, for_loop))
    }
}

/// Refuses what the rig's own limit would end.
fn held_to(shape: &Shape, limit: Option<f64>) -> Result<(), ParameterError> {
    let fastest = shape.fastest();
    match limit.filter(|limit| fastest > *limit) {
        None => Ok(()),
        Some(limit) => Err(ParameterError::refused(format!(
            "the reference would be as fast as {fastest:.3} rad/s, and the rig is held to {limit:.3} rad/s: a lower amplitude, frequency or offset does it"
        ))),
    }
}
