//! RTPS packets, caught as they pass an interface. Needs the right to open a raw socket.

use std::io::Read;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use socket2::{Domain, Protocol, Socket, Type};

/// A packet: when it came after the first, where it came from and where it went to, and what was in
/// it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Packet {
    /// Time since catching began.
    pub at: Duration,
    /// Address of the sender.
    pub from: [u8; 4],
    /// Address of the receiver.
    pub to: [u8; 4],
    /// Port of the receiver.
    pub port: u16,
    /// The datagram.
    pub bytes: Vec<u8>,
}

/// Catches until it is ended.
pub struct Catch {
    end: Arc<AtomicBool>,
    packets: Arc<Mutex<Vec<Packet>>>,
    thread: JoinHandle<()>,
}

impl Catch {
    /// Begins, on all interfaces of the calling thread's network namespace.
    ///
    /// # Panics
    /// If the system grants no raw socket.
    #[must_use]
    pub fn start() -> Self {
        const ALL: u16 = 3;
        let protocol = Protocol::from(i32::from(ALL.to_be()));
        let mut socket =
            Socket::new(Domain::PACKET, Type::RAW, Some(protocol)).expect("a raw socket");
        socket.set_recv_buffer_size(16 << 20).expect("room");
        socket.set_read_timeout(Some(Duration::from_millis(50))).expect("a time");
        let end = Arc::new(AtomicBool::new(false));
        let (ends, packets) = (Arc::clone(&end), Arc::<Mutex<Vec<Packet>>>::default());
        let caught = Arc::clone(&packets);
        let thread = thread::spawn(move || {
            let (began, mut frame) = (Instant::now(), vec![0; 1 << 17]);
            while !ends.load(Ordering::Relaxed) {
                let Ok(length) = socket.read(&mut frame) else { continue };
                let Some(packet) = rtps(&frame[..length], began.elapsed()) else { continue };
                let mut packets = caught.lock().expect("nobody panics");
                // What goes over loopback is seen when it leaves and when it comes.
                let again = packets
                    .iter()
                    .rev()
                    .take(8)
                    .any(|other| Packet { at: packet.at, ..other.clone() } == packet);
                if !again {
                    packets.push(packet);
                }
            }
        });
        Self { end, packets, thread }
    }

    /// Waits for the first packet. Whoever is alone sends it: it announces itself.
    ///
    /// # Panics
    /// If none comes within a minute.
    #[must_use]
    pub fn first(&self) -> Packet {
        let began = Instant::now();
        loop {
            if let Some(packet) = self.packets.lock().expect("nobody panics").first() {
                return packet.clone();
            }
            assert!(began.elapsed() < Duration::from_secs(60), "nobody says anything");
            thread::sleep(Duration::from_millis(5));
        }
    }

    /// What was caught.
    ///
    /// # Panics
    /// If the thread did.
    #[must_use]
    pub fn end(self) -> Vec<Packet> {
        self.end.store(true, Ordering::Relaxed);
        self.thread.join().expect("it catches");
        std::mem::take(&mut *self.packets.lock().expect("nobody panics"))
    }
}

/// The RTPS packet in a frame, if there is one.
fn rtps(frame: &[u8], at: Duration) -> Option<Packet> {
    let ip = frame.get(14..).filter(|_| frame[12..14] == [8, 0])?;
    let header = usize::from(*ip.first()? & 15) * 4;
    let (addresses, udp) = (ip.get(12..20)?, ip.get(header..)?);
    let bytes = udp
        .get(8..)
        .filter(|bytes| *ip.get(9).unwrap_or(&0) == 17 && bytes.starts_with(b"RTPS"))?;
    Some(Packet {
        at,
        from: addresses[..4].try_into().ok()?,
        to: addresses[4..].try_into().ok()?,
        port: u16::from_be_bytes(udp.get(2..4)?.try_into().ok()?),
        bytes: bytes.to_vec(),
    })
}

/// Keeps packets in a file.
///
/// # Panics
/// If it cannot be written.
pub fn keep(packets: &[Packet], file: &Path) {
    let mut all = Vec::new();
    for packet in packets {
        all.extend(u64::try_from(packet.at.as_micros()).expect("no age").to_le_bytes());
        all.extend(packet.from.iter().chain(&packet.to));
        all.extend(packet.port.to_le_bytes());
        all.extend(u32::try_from(packet.bytes.len()).expect("a datagram").to_le_bytes());
        all.extend(&packet.bytes);
    }
    std::fs::write(file, all).expect("a file");
}

/// Packets from a file.
///
/// # Panics
/// If it is none of [`keep`]'s.
#[must_use]
pub fn kept(file: &Path) -> Vec<Packet> {
    let all = std::fs::read(file).expect("a file");
    let (mut rest, mut packets) = (&all[..], Vec::new());
    while !rest.is_empty() {
        let (head, behind) = rest.split_at(22);
        let length = u32::from_le_bytes(head[18..22].try_into().expect("four bytes")) as usize;
        let (bytes, behind) = behind.split_at(length);
        packets.push(Packet {
            at: Duration::from_micros(u64::from_le_bytes(
                head[..8].try_into().expect("eight bytes"),
            )),
            from: head[8..12].try_into().expect("four bytes"),
            to: head[12..16].try_into().expect("four bytes"),
            port: u16::from_le_bytes(head[16..18].try_into().expect("two bytes")),
            bytes: bytes.to_vec(),
        });
        rest = behind;
    }
    packets
}
