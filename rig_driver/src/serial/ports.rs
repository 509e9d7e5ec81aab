//! Serial ports of this machine: from what Linux shows in its file system, which knows lasting names
//! and products, or as Windows lists them.

#[cfg(not(windows))]
use std::fs;
#[cfg(not(windows))]
use std::path::Path;
use std::path::PathBuf;

/// A serial port with a device on it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SerialPort {
    /// Name that stays the same when plugs change, where the system makes one.
    pub by_id: Option<PathBuf>,
    /// The device file, as `/dev/ttyACM0`.
    pub device: PathBuf,
    /// Maker and product, where the device tells them.
    pub product: Option<String>,
}

/// All serial ports of the machine, in the order of their names.
#[cfg(windows)]
pub fn serial_ports() -> Vec<SerialPort> {
    let mut ports: Vec<SerialPort> = serial2::SerialPort::available_ports()
        .unwrap_or_default()
        .into_iter()
        .map(|device| SerialPort { by_id: None, device, product: None })
        .collect();
    ports.sort_by(|a, b| a.device.cmp(&b.device));
    ports
}

/// All serial ports of the machine that belong to a device, in the order of their names.
#[cfg(not(windows))]
pub fn serial_ports() -> Vec<SerialPort> {
    ports_under(Path::new("/"))
}

/// The same under another root, for tests.
#[cfg(not(windows))]
fn ports_under(root: &Path) -> Vec<SerialPort> {
    let mut names: Vec<(PathBuf, PathBuf)> = Vec::new();
    for entry in fs::read_dir(root.join("dev/serial/by-id")).into_iter().flatten().flatten() {
        if let Ok(target) = fs::canonicalize(entry.path()) {
            names.push((target, entry.path()));
        }
    }
    let mut ports: Vec<SerialPort> = fs::read_dir(root.join("sys/class/tty"))
        .into_iter()
        .flatten()
        .flatten()
        // Consoles and pseudo-terminals have no device behind them; the sixteen-odd `ttyS` of a PC
        // are mostly nobody's.
        .filter(|entry| entry.path().join("device").exists())
        .filter(|entry| !entry.file_name().to_string_lossy().starts_with("ttyS"))
        .map(|entry| {
            let device = root.join("dev").join(entry.file_name());
            let same = fs::canonicalize(&device).unwrap_or_else(|_| device.clone());
            let by_id =
                names.iter().find(|(target, _)| *target == same).map(|(_, name)| name.clone());
            SerialPort { by_id, product: product(&entry.path().join("device")), device }
        })
        .collect();
    ports.sort_by(|a, b| a.device.cmp(&b.device));
    ports
}

/// Maker and product stand a few folders above the port, at the USB device.
#[cfg(not(windows))]
fn product(device: &Path) -> Option<String> {
    let device = fs::canonicalize(device).ok()?;
    let usb = device.ancestors().take(5).find(|folder| folder.join("product").exists())?;
    let read =
        |name: &str| fs::read_to_string(usb.join(name)).ok().map(|text| text.trim().to_owned());
    Some(
        [read("manufacturer"), read("product")].into_iter().flatten().collect::<Vec<_>>().join(" "),
    )
}

#[cfg(all(test, unix))]
mod tests {
    use std::os::unix::fs::symlink;

    use super::*;

    #[test]
    fn ports_with_a_device_are_found_with_their_lasting_name_and_product() {
        let root = tempfile::tempdir().unwrap();
        let path = |name: &str| root.path().join(name);
        let port = path("sys/devices/usb1/1-1/1-1:1.0/tty/ttyACM0");
        for folder in [&port, &path("sys/class/tty/console"), &path("dev/serial/by-id")] {
            fs::create_dir_all(folder).unwrap();
        }
        fs::write(path("sys/devices/usb1/1-1/product"), "Rig Bridge\n").unwrap();
        fs::write(path("sys/devices/usb1/1-1/manufacturer"), "Example\n").unwrap();
        fs::write(path("dev/ttyACM0"), "").unwrap();
        symlink(path("sys/devices/usb1/1-1/1-1:1.0"), port.join("device")).unwrap();
        symlink(&port, path("sys/class/tty/ttyACM0")).unwrap();
        symlink(path("dev/ttyACM0"), path("dev/serial/by-id/usb-Example_Rig_Bridge-if00")).unwrap();
        let expected = SerialPort {
            by_id: Some(path("dev/serial/by-id/usb-Example_Rig_Bridge-if00")),
            device: path("dev/ttyACM0"),
            product: Some("Example Rig Bridge".to_owned()),
        };
        assert_eq!(ports_under(root.path()), [expected]);
        assert_eq!(ports_under(&path("nothing")), []);
    }
}
