//! What a device is: its name, its channels and the meaning of a count.

use crate::{Session, wire::Reader, wire::Writer};

/// Length on the line before framing \[byte\].
pub(crate) const LENGTH: usize = 66;

/// A device's name: up to 16 bytes of printable ASCII.
#[derive(Clone, Copy, PartialEq, Eq, Default)]
pub struct Name([u8; 16]);

impl core::fmt::Debug for Name {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_tuple("Name").field(&self.as_str()).finish()
    }
}

impl Name {
    /// `text` as a name; none if it is longer than 16 bytes or has anything but printable ASCII.
    #[must_use]
    pub fn new(text: &str) -> Option<Self> {
        let mut bytes = [0; 16];
        bytes.get_mut(..text.len())?.copy_from_slice(text.as_bytes());
        Self::from_bytes(bytes)
    }

    /// The name.
    #[must_use]
    pub fn as_str(&self) -> &str {
        let text = self.0.split(|byte| *byte == 0).next().unwrap_or_default();
        // Checked when it was made: ASCII.
        core::str::from_utf8(text).unwrap_or_default()
    }

    fn from_bytes(bytes: [u8; 16]) -> Option<Self> {
        let end = bytes.iter().position(|byte| *byte == 0).unwrap_or(bytes.len());
        let (text, rest) = bytes.split_at_checked(end)?;
        let plain = text.iter().all(|byte| (b' '..=b'~').contains(byte))
            && rest.iter().all(|byte| *byte == 0);
        plain.then_some(Self(bytes))
    }
}

/// Which sensors a device has beside its encoder, which every device has.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Channels {
    /// Velocity.
    pub tachometer: bool,
    /// Position by voltage.
    pub potentiometer: bool,
    /// Friction torque.
    pub torque: bool,
    /// Motor current.
    pub current: bool,
}

impl Channels {
    const fn byte(self) -> u8 {
        let Self { tachometer, potentiometer, torque, current } = self;
        tachometer as u8 | (potentiometer as u8) << 1 | (torque as u8) << 2 | (current as u8) << 3
    }

    fn from_byte(byte: u8) -> Option<Self> {
        if byte & 0xF0 != 0 {
            return None;
        }
        let has = |bit: u8| byte & (1 << bit) != 0;
        Some(Self { tachometer: has(0), potentiometer: has(1), torque: has(2), current: has(3) })
    }
}

/// What a device is and what its counts mean. Load side of the gear, SI units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hello {
    /// The number of the hello that this answers; none when the device speaks up by itself, after
    /// it started.
    pub answers: Option<Session>,
    /// The session that the device grants: every further message of this host carries it. None when
    /// the device speaks up by itself.
    pub session: Option<Session>,
    /// The device's name.
    pub name: Name,
    /// The firmware's version: major, minor, patch.
    pub firmware: [u8; 3],
    /// Which sensors there are.
    pub channels: Channels,
    /// Period of the device's cycle \[us\], from 100 to 10000.
    pub period_us: u32,
    /// Encoder counts a turn of the load, above 0.
    pub counts_per_turn: u32,
    /// Volts a count of the voltage output \[V\].
    pub volts_per_count: f32,
    /// Largest magnitude of the motor voltage \[count\], above 0.
    pub voltage_limit: i16,
    /// Velocity a count of the tachometer \[rad/s\]. The scale of a sensor that is not there is 0.
    pub tachometer_per_count: f32,
    /// Position a count of the potentiometer \[rad\].
    pub potentiometer_per_count: f32,
    /// Friction torque a count of the torque sensor \[N m\].
    pub torque_per_count: f32,
    /// Motor current a count \[A\].
    pub current_per_count: f32,
    /// Longest validity of a command \[us\], at least a period: a longer one is cut to it.
    pub validity_limit_us: u32,
    /// The device goes inactive when it hears nothing from its host for this long \[us\], at least
    /// the validity limit.
    pub host_timeout_us: u32,
}

/// A device's description that cannot be.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("{field} must be {expected}")]
pub struct HelloError {
    /// The field.
    pub field: &'static str,
    /// What was expected.
    pub expected: &'static str,
}

impl Hello {
    /// Checks every field.
    ///
    /// # Errors
    /// [`HelloError`] names the field and what it must be.
    pub fn check(&self) -> Result<(), HelloError> {
        let require = |good: bool, field, expected| {
            if good { Ok(()) } else { Err(HelloError { field, expected }) }
        };
        require(
            self.answers.is_some() == self.session.is_some(),
            "session",
            "there where a hello is answered",
        )?;
        require((100..=10_000).contains(&self.period_us), "period_us", "from 100 to 10000")?;
        require(self.counts_per_turn > 0, "counts_per_turn", "above 0")?;
        require(self.voltage_limit > 0, "voltage_limit", "above 0")?;
        let scale = |scale: f32| scale.is_finite() && scale != 0.0;
        require(scale(self.volts_per_count), "volts_per_count", "a finite number other than 0")?;
        let Channels { tachometer, potentiometer, torque, current } = self.channels;
        for (present, value, field) in [
            (tachometer, self.tachometer_per_count, "tachometer_per_count"),
            (potentiometer, self.potentiometer_per_count, "potentiometer_per_count"),
            (torque, self.torque_per_count, "torque_per_count"),
            (current, self.current_per_count, "current_per_count"),
        ] {
            let expected = "a finite number other than 0, or 0 for a sensor that is not there";
            require(if present { scale(value) } else { value == 0.0 }, field, expected)?;
        }
        require(
            (self.period_us..=1_000_000).contains(&self.validity_limit_us),
            "validity_limit_us",
            "from the period to 1000000",
        )?;
        require(
            (self.validity_limit_us..=10_000_000).contains(&self.host_timeout_us),
            "host_timeout_us",
            "from the validity limit to 10000000",
        )
    }

    /// Cycles in `time_us` \[us\], rounded up.
    #[must_use]
    pub const fn cycles(&self, time_us: u32) -> u32 {
        // A period of zero is refused by `check`; dividing by one instead only keeps this free of
        // panics.
        time_us.div_ceil(if self.period_us == 0 { 1 } else { self.period_us })
    }

    pub(crate) fn write(&self, body: &mut Writer) {
        body.put(self.answers.map_or(0, Session::get).to_le_bytes())
            .put(self.session.map_or(0, Session::get).to_le_bytes())
            .put(self.name.0)
            .put(self.firmware)
            .put([self.channels.byte()])
            .put(self.period_us.to_le_bytes())
            .put(self.counts_per_turn.to_le_bytes())
            .put(self.volts_per_count.to_le_bytes())
            .put(self.voltage_limit.to_le_bytes())
            .put(self.tachometer_per_count.to_le_bytes())
            .put(self.potentiometer_per_count.to_le_bytes())
            .put(self.torque_per_count.to_le_bytes())
            .put(self.current_per_count.to_le_bytes())
            .put(self.validity_limit_us.to_le_bytes())
            .put(self.host_timeout_us.to_le_bytes());
    }

    /// Reads a payload; none if it breaks a rule.
    pub(crate) fn read(payload: &mut Reader<'_>) -> Option<Self> {
        let hello = Self {
            answers: Session::new(payload.u32()),
            session: Session::new(payload.u32()),
            name: Name::from_bytes(payload.take())?,
            firmware: payload.take(),
            channels: Channels::from_byte(payload.u8())?,
            period_us: payload.u32(),
            counts_per_turn: payload.u32(),
            volts_per_count: payload.f32(),
            voltage_limit: payload.i16(),
            tachometer_per_count: payload.f32(),
            potentiometer_per_count: payload.f32(),
            torque_per_count: payload.f32(),
            current_per_count: payload.f32(),
            validity_limit_us: payload.u32(),
            host_timeout_us: payload.u32(),
        };
        hello.check().is_ok().then_some(hello)
    }
}
