//! The shaft: motor, friction, load and everything else that acts on it.

use friction_model::{Body, FrictionModel, Moment, Motor};
use rig_driver::Truth;

use crate::backlash::Load;
use crate::{Backlash, Break, Forces, Machine, Stops, Warming};

/// What is left of inertia and friction once the load is torn off.
const LEFT: f64 = 0.02;

/// Something that a voltage turns.
pub(crate) trait Turning: Send {
    /// Where it is while `volts` are applied.
    fn truth(&self, volts: f64) -> Truth;
    /// Goes on for `h` \[s\] with `volts` held.
    fn advance(&mut self, volts: f64, h: f64);
    /// Something broke.
    fn break_down(&mut self, what: Break);
}

/// The shaft under the friction of `M`.
pub(crate) struct Shaft<M: FrictionModel> {
    body: Body<M>,
    motor: Motor,
    forces: Forces,
    stickier: f64,
    /// Speed at which one direction is stickier than the other [rad/s].
    turning: f64,
    warming: Option<Warming>,
    play: Option<Backlash>,
    load: Load,
    stops: Option<Stops>,
    /// Time \[s\].
    time: f64,
    factor: f64,
    blocked: bool,
    left: f64,
}

impl<M: FrictionModel> Shaft<M> {
    /// At rest at zero.
    pub(crate) fn new(machine: &Machine, model: M) -> Self {
        Self {
            body: Body::new(model, machine.motor.inertia),
            motor: machine.motor,
            forces: machine.forces.clone(),
            stickier: machine.stickier,
            turning: 1e-3 * machine.motor.gain() * machine.voltage_range,
            warming: machine.warming,
            play: machine.backlash,
            load: Load::default(),
            stops: machine.stops,
            time: 0.0,
            factor: 1.0,
            blocked: false,
            left: 1.0,
        }
    }

    /// Torque of everything but the friction [N m].
    fn driving(&self, volts: f64, at: &Moment, taken: f64) -> f64 {
        self.motor.driving_torque(volts, at.velocity) + self.forces.torque(at.position) - taken
            + self.stopped(at)
    }

    /// What a stop gives [N m].
    fn stopped(&self, at: &Moment) -> f64 {
        let inertia = self.left * self.motor.inertia;
        self.stops.map_or(0.0, |stops| stops.torque(inertia, at.position, at.velocity))
    }

    /// Friction over the model's, now.
    fn factor_now(&self) -> f64 {
        let warm = self
            .warming
            .map_or(1.0, |w| 1.0 + w.change * (1.0 - (-self.time / w.time_constant).exp()));
        let velocity = self.body.moment().velocity;
        self.left * warm * (1.0 + self.stickier * (velocity / self.turning).tanh())
    }

    fn taken(&self) -> f64 {
        let &Moment { position, velocity, .. } = self.body.moment();
        self.play.map_or(0.0, |play| self.load.taken(&play, position, velocity))
    }
}

impl<M> Turning for Shaft<M>
where
    M: FrictionModel<Continuous: Send, Memory: Send> + Send,
{
    fn truth(&self, volts: f64) -> Truth {
        let moment = self.body.moment();
        let driving = self.driving(volts, moment, self.taken());
        let friction = self.factor * self.body.friction(driving / self.factor);
        let velocity = if self.blocked { 0.0 } else { moment.velocity };
        Truth { position: moment.position, velocity, friction }
    }

    fn advance(&mut self, volts: f64, h: f64) {
        self.time += h;
        if self.blocked {
            return;
        }
        self.factor = self.factor_now();
        let factor = self.factor;
        // For the model that is a shaft with so much less inertia and torque.
        self.body.set_inertia(self.left * self.motor.inertia / factor);
        let taken = self.taken();
        let (motor, forces, stops) = (self.motor, &self.forces, self.stops);
        let inertia = self.left * motor.inertia;
        self.body.advance(h, |at| {
            let driving =
                motor.driving_torque(volts, at.velocity) + forces.torque(at.position) - taken;
            let stop = stops.map_or(0.0, |stops| stops.torque(inertia, at.position, at.velocity));
            let driving = driving + stop;
            (driving / factor).into()
        });
        if let Some(play) = &self.play {
            self.load.advance(play, taken, h);
        }
    }

    fn break_down(&mut self, what: Break) {
        match what {
            Break::Blocked => self.blocked = true,
            Break::TornLoose => {
                self.left = LEFT;
                self.play = None;
                self.forces = Forces::default();
            }
            Break::EncoderUnplugged
            | Break::EncoderSkips
            | Break::EncoderReversed
            | Break::TorqueSaturated
            | Break::Unplugged => {}
        }
    }
}
