//! How a rig on a serial line is found and opened.

use std::path::Path;

use rig_protocol::Hello;

use super::ports::{SerialPort, serial_ports};
use super::{SerialOptions, SerialRig, limits};
use crate::back_end::{
    BackEnd, Listed, Place, PlaceError, RigDescription, RigFactory, RigSetup, Scales,
    SensorsPresent, Standing,
};
use crate::{Rig, RigError, emulated};

/// A device on a serial port: `PORT`, or `PORT@BAUD` for another rate than 2000000.
#[derive(Debug, Clone, Copy, Default)]
pub struct SerialFactory;

/// Port and baud rate of the text behind the colon.
fn read(place: &str) -> Result<(&str, u32), PlaceError> {
    let (port, baud) = match place.rsplit_once('@') {
        Some((port, baud)) => {
            (port, baud.parse().map_err(|_| PlaceError(format!("`{baud}` is no baud rate")))?)
        }
        None => (place, SerialOptions::default().baud),
    };
    if port.is_empty() {
        return Err(PlaceError("the port is missing".to_owned()));
    }
    Ok((port, baud))
}

impl RigFactory for SerialFactory {
    fn name(&self) -> &'static str {
        "serial"
    }

    fn about(&self) -> &'static str {
        "a device on a serial port that speaks the protocol of rig_driver/PROTOCOL.md"
    }

    fn place(&self) -> Place {
        Place::Required { what: "PORT[@BAUD]", example: "/dev/ttyACM0" }
    }

    fn normal(&self, place: &str) -> Result<String, PlaceError> {
        let (port, baud) = read(place)?;
        let usual = baud == SerialOptions::default().baud;
        Ok(if usual { port.to_owned() } else { format!("{port}@{baud}") })
    }

    fn comes_back(&self) -> bool {
        true
    }

    fn listed(&self) -> Vec<Listed> {
        let emulated =
            emulated::folder().map(|folder| emulated::announced(&folder)).unwrap_or_default();
        let emulated = emulated.iter().map(|port| {
            Listed::ready(
                format!("serial:{}", port.display()),
                "an emulated rig, by a rig_emulator that runs on this machine",
            )
        });
        let mut listed: Vec<Listed> = serial_ports().iter().map(port).chain(emulated).collect();
        if listed.is_empty() {
            listed.push(Listed::absent(
                self.name(),
                "no serial port with a device on it; plug the board in, and see that your user may open it (group dialout)",
            ));
        }
        listed
    }

    fn open(&self, place: Option<&str>, _: &RigSetup) -> Result<BackEnd, RigError> {
        // An address has a port that could be read.
        let (port, baud) = read(place.unwrap_or_default())
            .unwrap_or((place.unwrap_or_default(), SerialOptions::default().baud));
        let rig =
            SerialRig::open(Path::new(port), SerialOptions { baud, ..SerialOptions::default() })?;
        let channels = rig.hello().channels;
        Ok(BackEnd {
            limits: limits(rig.hello()),
            sensors: SensorsPresent { torque: channels.torque, current: channels.current },
            about: Some(about(&rig)),
            description: Some(described(rig.hello(), rig.period(), rig.voltage_range())),
            rig: Box::new(rig),
        })
    }
}

/// A port as it is listed.
fn port(port: &SerialPort) -> Listed {
    let name = port.by_id.as_ref().unwrap_or(&port.device).display();
    let product = port.product.as_deref().unwrap_or("a device that does not tell its name");
    Listed {
        address: format!("serial:{name}"),
        about: format!("{product} ({})", port.device.display()),
        standing: standing(&port.device),
    }
}

/// Whether this user may open a port.
#[cfg(unix)]
fn standing(device: &Path) -> Standing {
    use rustix::fs::{Access, access};
    match access(device, Access::READ_OK | Access::WRITE_OK) {
        Ok(()) => Standing::Ready,
        Err(error) => Standing::Refused {
            why: error.to_string(),
            mend: "`sudo usermod -aG dialout $USER` (some systems say uucp), then log in again",
        },
    }
}

/// Whether this user may open a port: only opening it tells.
#[cfg(not(unix))]
fn standing(_: &Path) -> Standing {
    Standing::Ready
}

/// What a device says of itself, in a line.
fn about(rig: &SerialRig) -> String {
    let hello = rig.hello();
    let [major, minor, patch] = hello.firmware;
    let limit = f64::from(hello.voltage_limit) * f64::from(hello.volts_per_count);
    format!(
        "{} (firmware {major}.{minor}.{patch}), {} us a cycle, at most {:.2} V; {}",
        hello.name.as_str(),
        hello.period_us,
        limit.abs(),
        rig.latency()
    )
}

/// What a device says of itself, number by number.
fn described(hello: &Hello, period: f64, voltage_range: f64) -> RigDescription {
    let [major, minor, patch] = hello.firmware;
    RigDescription {
        name: hello.name.as_str().to_owned(),
        firmware: Some(format!("{major}.{minor}.{patch}")),
        period,
        voltage_range,
        counts_per_turn: hello.counts_per_turn.into(),
        scales: Some(Scales {
            volts_per_count: hello.volts_per_count.into(),
            tachometer_per_count: hello.tachometer_per_count.into(),
            potentiometer_per_count: hello.potentiometer_per_count.into(),
            torque_per_count: hello.torque_per_count.into(),
            current_per_count: hello.current_per_count.into(),
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[cfg(unix)]
    fn a_port_that_is_not_there_may_not_be_opened() {
        let gone = SerialPort { by_id: None, device: "/nowhere/ttyACM0".into(), product: None };
        let listed = port(&gone);
        assert_eq!(listed.address, "serial:/nowhere/ttyACM0");
        assert!(matches!(listed.standing, Standing::Refused { .. }));
    }
}
