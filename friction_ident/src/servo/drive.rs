//! How a servo turns a position error into what drives its motor.

/// What the position loop commands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Control {
    /// A duty cycle of the supply voltage: the torque falls as the motor turns.
    Voltage,
    /// A current: the torque does not fall with speed until the supply can give no more.
    Current,
}

/// The law of a servo's position loop: command = gain x `per_gain` x (goal - position) - damping x
/// speed, held within plus and minus `full_scale`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drive {
    /// What the command is.
    pub control: Control,
    /// Command per unit of the servo's gain and per error: duty cycle \[1/rad\] or current
    /// \[A/rad\].
    pub per_gain: f64,
    /// Largest command: duty cycle \[1\] or current \[A\].
    pub full_scale: f64,
}

impl Drive {
    /// Whether its numbers can be those of a servo.
    pub fn is_usable(&self) -> bool {
        [self.per_gain, self.full_scale].iter().all(|value| *value > 0.0 && value.is_finite())
    }
}
