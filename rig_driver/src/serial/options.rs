//! How a serial line is used.

use super::SerialError;

/// How a serial line is used.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SerialOptions {
    /// Baud rate; without meaning for a device that is a USB device itself.
    pub baud: u32,
    /// How long after the measurement a command may be applied \[s\], from 1 ms to 1 s. The device
    /// has a limit of its own.
    pub validity: f64,
    /// Longest wait for an answer to hello \[s\], from 0.05 to 60 s.
    pub answer: f64,
    /// Longest wait for a measurement \[s\], from 5 ms to 10 s.
    pub silence: f64,
}

impl Default for SerialOptions {
    /// 2 Mbaud, commands valid for 20 ms, 2 s for the answer to hello, 0.1 s for a measurement.
    fn default() -> Self {
        Self { baud: 2_000_000, validity: 0.02, answer: 2.0, silence: 0.1 }
    }
}

impl SerialOptions {
    /// Checks every field.
    pub(super) fn check(&self) -> Result<(), SerialError> {
        for (name, value, least, most, expected) in [
            ("validity", self.validity, 1e-3, 1.0, "from 0.001 to 1 s"),
            ("answer", self.answer, 0.05, 60.0, "from 0.05 to 60 s"),
            ("silence", self.silence, 5e-3, 10.0, "from 0.005 to 10 s"),
        ] {
            if !(least..=most).contains(&value) {
                return Err(SerialError::Option { name, expected, came: value.to_string() });
            }
        }
        if self.baud < 9600 {
            let came = self.baud.to_string();
            return Err(SerialError::Option { name: "baud", expected: "9600 or more", came });
        }
        Ok(())
    }
}
