//! Packets that no DDS program sends, on this machine's loopback: the driver's memory stays
//! bounded, its stop is answered, its loop goes on, or it ends.
//!
//! Figures are printed; what is asserted is generous, since the machine may be busy.

use std::{
    fs,
    io::Read,
    net::{Ipv4Addr, UdpSocket},
    process::{Child, Command, Stdio},
    sync::{
        Arc,
        atomic::{AtomicBool, AtomicU64, Ordering},
    },
    thread::{self, JoinHandle},
    time::{Duration, Instant},
};

use msgs::{
    lifecycle_msgs::{GetState, GetStateRequest},
    std_srvs::{Trigger, TriggerRequest},
    topics,
};
use rand::{Rng, RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use ros_node::{Discovery, Participant, RosNode};
use rustix::process::{Pid, Signal, kill_process};
use tests::{
    network::{namespaced, run_ignored},
    wire::Catch,
};

const DOMAIN: u16 = 78;
const PATIENCE: Duration = Duration::from_secs(60);
const ACTIVE: u8 = 3;
/// Memory that the driver may have [bytes]: it ends itself at most two gibibytes above its start,
/// and grows until it has noticed.
const MOST: u64 = 6 << 30;
/// Variable of the environment with the attack.
const ATTACK: &str = "ATTACK";
/// Port of discovery by multicast, of discovery and of messages of the first participant.
const PORTS: [u16; 3] = [7400 + 250 * DOMAIN, 7410 + 250 * DOMAIN, 7411 + 250 * DOMAIN];

fn run(attack: &str) {
    let command = namespaced();
    let told = run_ignored(command, "attack", &[(ATTACK, attack.as_ref())]);
    for line in told.lines().filter(|line| line.starts_with("hostile traffic:")) {
        eprintln!("{line}");
    }
}

#[tests::needs(namespace)]
#[test]
fn random_mutated_and_replayed_packets_and_strangers_by_the_thousand() {
    run("noise");
}

#[tests::needs(namespace)]
#[test]
fn heartbeats_that_promise_billions() {
    run("heartbeats");
}

#[tests::needs(namespace)]
#[test]
fn fragments_of_samples_that_are_gigabytes_long() {
    run("fragments");
}

/// A driver whose memory and loop are looked at.
struct Driver {
    child: Child,
    said: Option<JoinHandle<String>>,
    memory: Arc<AtomicU64>,
}

impl Driver {
    fn start() -> Self {
        let mut child = Command::new(env!("CARGO_BIN_EXE_rig_driver"))
            .env("ROS_DOMAIN_ID", DOMAIN.to_string())
            .env("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
            // What takes gigabytes ends it sooner, so that tests beside this one have room.
            .env(
                "FRICTION_MEMORY",
                if std::env::var(ATTACK).unwrap() == "noise" { "2048" } else { "512" },
            )
            .stdin(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let mut stderr = child.stderr.take().unwrap();
        let said = thread::spawn(move || {
            let mut text = Vec::new();
            let _ = stderr.read_to_end(&mut text);
            String::from_utf8_lossy(&text).into_owned()
        });
        let (file, memory) = (format!("/proc/{}/status", child.id()), Arc::new(AtomicU64::new(0)));
        let most = Arc::clone(&memory);
        thread::spawn(move || {
            while let Ok(text) = fs::read_to_string(&file) {
                let Some(line) = text.lines().find_map(|line| line.strip_prefix("VmRSS:")) else {
                    break;
                };
                let kilobytes: u64 = line.trim().trim_end_matches("kB").trim().parse().unwrap();
                most.fetch_max(kilobytes << 10, Ordering::Relaxed);
                thread::sleep(Duration::from_millis(20));
            }
        });
        Self { child, said: Some(said), memory }
    }

    fn has_ended(&mut self) -> bool {
        self.child.try_wait().unwrap().is_some()
    }

    /// Its exit code, what it said, and the most memory that it had.
    fn end(mut self) -> (Option<i32>, String, u64) {
        if !self.has_ended() {
            let _ = kill_process(Pid::from_child(&self.child), Signal::INT);
        }
        let began = Instant::now();
        while !self.has_ended() {
            assert!(began.elapsed() < PATIENCE, "the driver does not end");
            thread::sleep(Duration::from_millis(10));
        }
        let code = self.child.wait().unwrap().code();
        let said = self.said.take().expect("told once").join().unwrap();
        (code, said, self.memory.load(Ordering::Relaxed))
    }
}

impl Drop for Driver {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// A client of the driver.
struct Client {
    node: RosNode,
    cycles: Arc<AtomicU64>,
    _participant: Participant,
}

impl Client {
    fn join() -> Self {
        let participant =
            Participant::join(&Discovery { domain: DOMAIN, ..Discovery::default() }).unwrap();
        let node = participant.node("client").unwrap();
        let cycles = Arc::new(AtomicU64::new(0));
        let seen = Arc::clone(&cycles);
        node.subscribe(&topics::RIG_MEASUREMENT, move |measured| {
            seen.store(measured.cycle, Ordering::Relaxed)
        })
        .unwrap();
        Self { node, cycles, _participant: participant }
    }

    fn until_active(&self) {
        let states = self.node.client::<GetState>("/rig_driver/get_state").unwrap();
        let began = Instant::now();
        while states
            .call_until_answered(&GetStateRequest::default(), PATIENCE)
            .unwrap()
            .current_state
            .id
            != ACTIVE
        {
            assert!(began.elapsed() < PATIENCE, "the driver is not active");
            thread::sleep(Duration::from_millis(20));
        }
    }

    /// The loop goes on.
    fn goes_on(&self) -> bool {
        let (before, began) = (self.cycles.load(Ordering::Relaxed), Instant::now());
        while began.elapsed() < PATIENCE {
            if self.cycles.load(Ordering::Relaxed) > before + 100 {
                return true;
            }
            thread::sleep(Duration::from_millis(10));
        }
        false
    }
}

/// What was caught, for those who forge.
struct Known {
    packets: Vec<Vec<u8>>,
    /// Participants, and their writers.
    writers: Vec<([u8; 12], [u8; 4])>,
    /// Announcements of participants.
    announcements: Vec<Vec<u8>>,
}

const DATA: u8 = 0x15;
const DATA_FRAG: u8 = 0x16;
const HEARTBEAT: u8 = 0x07;
const ANNOUNCER: [u8; 4] = [0, 1, 0, 0xC2];

impl Known {
    fn of(packets: Vec<Vec<u8>>) -> Self {
        let (mut writers, mut announcements) = (Vec::new(), Vec::new());
        for packet in packets.iter().filter(|packet| packet.len() > 40) {
            let prefix: [u8; 12] = packet[8..20].try_into().unwrap();
            let mut at = 20;
            while at + 4 <= packet.len() {
                let length = u16::from_le_bytes([packet[at + 2], packet[at + 3]]) as usize;
                let begin = match packet[at] {
                    DATA => at + 4 + 8,
                    HEARTBEAT => at + 4 + 4,
                    _ => usize::MAX - 4,
                };
                if let Some(writer) = packet.get(begin..begin + 4) {
                    let writer: [u8; 4] = writer.try_into().unwrap();
                    if !writers.contains(&(prefix, writer)) {
                        writers.push((prefix, writer));
                    }
                    if writer == ANNOUNCER {
                        announcements.push(packet.clone());
                    }
                }
                if length == 0 {
                    break;
                }
                at += 4 + length;
            }
        }
        assert!(writers.len() > 4 && !announcements.is_empty(), "{} writers", writers.len());
        Self { packets, writers, announcements }
    }

    fn header(prefix: [u8; 12]) -> Vec<u8> {
        [&b"RTPS\x02\x04\x01\x12"[..], &prefix].concat()
    }

    fn random(dice: &mut Pcg64Mcg) -> Vec<u8> {
        let mut bytes = vec![0; dice.random_range(1..1400)];
        dice.fill_bytes(&mut bytes);
        if dice.random_range(0..2) == 0 {
            let header = Self::header(dice.random());
            let length = header.len().min(bytes.len());
            bytes[..length].copy_from_slice(&header[..length]);
        }
        bytes
    }

    fn replayed(&self, dice: &mut Pcg64Mcg) -> Vec<u8> {
        self.packets[dice.random_range(0..self.packets.len())].clone()
    }

    fn mutated(&self, dice: &mut Pcg64Mcg) -> Vec<u8> {
        let mut bytes = self.replayed(dice);
        for _ in 0..[1, 1, 2, 8, 40][dice.random_range(0..5)] {
            let at = dice.random_range(20.min(bytes.len() - 1)..bytes.len());
            bytes[at] = [0, 1, 0x7F, 0x80, 0xFF, dice.random()][dice.random_range(0..6)];
        }
        if dice.random_range(0..4) == 0 {
            bytes.truncate(dice.random_range(1..bytes.len()));
        }
        bytes
    }

    /// A participant that nobody has seen.
    fn stranger(&self, dice: &mut Pcg64Mcg) -> Vec<u8> {
        let mut bytes = self.announcements[dice.random_range(0..self.announcements.len())].clone();
        let (old, new): ([u8; 12], [u8; 12]) = (bytes[8..20].try_into().unwrap(), dice.random());
        for at in 0..bytes.len() - 12 {
            if bytes[at..at + 12] == old {
                bytes[at..at + 12].copy_from_slice(&new);
            }
        }
        bytes
    }

    fn heartbeat(&self, dice: &mut Pcg64Mcg) -> Vec<u8> {
        let (prefix, writer) = self.writers[dice.random_range(0..self.writers.len())];
        let mut bytes = Self::header(prefix);
        bytes.extend([HEARTBEAT, 1, 28, 0, 0, 0, 0, 0]);
        bytes.extend(writer);
        let high = [0_i32, 1, 200, i32::MAX][dice.random_range(0..4)];
        for word in [0, 1, high, -2, dice.random_range(1..i32::MAX)] {
            bytes.extend(word.to_le_bytes());
        }
        bytes
    }

    fn fragment(&self, dice: &mut Pcg64Mcg) -> Vec<u8> {
        let (prefix, writer) = self.writers[dice.random_range(0..self.writers.len())];
        let mut bytes = Self::header(prefix);
        let payload = vec![0; 1024];
        let length = u16::try_from(32 + payload.len()).unwrap();
        bytes.extend([DATA_FRAG, 1]);
        bytes.extend(length.to_le_bytes());
        bytes.extend([0, 0, 28, 0, 0, 0, 0, 0]);
        bytes.extend(writer);
        bytes.extend(0_i32.to_le_bytes());
        bytes.extend(dice.random_range(1..100_000_u32).to_le_bytes());
        bytes.extend(dice.random_range(1..1000_u32).to_le_bytes());
        bytes.extend(1_u16.to_le_bytes());
        bytes.extend(1024_u16.to_le_bytes());
        bytes.extend(
            [1_u32 << 20, 1 << 28, 1 << 30, u32::MAX][dice.random_range(0..4)].to_le_bytes(),
        );
        bytes.extend(payload);
        bytes
    }
}

#[test]
#[ignore = "speaks DDS: run in a network namespace by the tests above"]
fn attack() {
    let which = std::env::var(ATTACK).unwrap();
    let full = std::env::var_os("FRICTION_FULL").is_some();
    let (noise, strangers, forged) =
        if full { (60_000, 18_000, 20_000) } else { (3_000, 500, 300) };
    let catch = Catch::start();
    let mut driver = Driver::start();
    // It has the ports of the first participant.
    let _ = catch.first();
    let first = Client::join();
    first.until_active();
    assert!(first.goes_on());
    drop(first);
    // Nobody forges packets of the one who asks for the stop: what a node thinks of it would be
    // spoiled, as every client of the same machine can.
    let known = Known::of(catch.end().into_iter().map(|packet| packet.bytes).collect());
    let client = Client::join();
    assert!(client.goes_on());

    let flooding = Arc::new(AtomicBool::new(true));
    let floods = Arc::clone(&flooding);
    let attack = which.clone();
    let flood = thread::spawn(move || {
        let mut dice = Pcg64Mcg::seed_from_u64(6);
        let socket = UdpSocket::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
        let send = |packet: Vec<u8>, ports: &[u16]| {
            for port in ports {
                // A port of a driver that has ended.
                let _ = socket.send_to(&packet, (Ipv4Addr::LOCALHOST, *port));
            }
        };
        let count = if attack == "noise" { noise } else { forged };
        for number in 0..count {
            match (attack.as_str(), number % 3) {
                ("heartbeats", _) => send(known.heartbeat(&mut dice), &PORTS[1..]),
                ("fragments", _) => send(known.fragment(&mut dice), &PORTS[1..]),
                (_, 0) => send(Known::random(&mut dice), &PORTS[1..]),
                (_, 1) => send(known.replayed(&mut dice), &PORTS[1..]),
                _ => send(known.mutated(&mut dice), &PORTS[1..]),
            }
            if number % 10 == 0 {
                thread::sleep(Duration::from_millis(1));
            }
        }
        for number in 0..if attack == "noise" { strangers } else { 0 } {
            send(known.stranger(&mut dice), &PORTS[1..2]);
            if number % 10 == 0 {
                thread::sleep(Duration::from_millis(1));
            }
        }
        floods.store(false, Ordering::Relaxed);
    });

    // The stop, again and again, while they come, and once when they are over.
    let stop = client.node.client::<Trigger>("/rig_driver/emergency_stop").unwrap();
    let (mut took, mut unanswered) = (Vec::new(), 0);
    loop {
        let last = !flooding.load(Ordering::Relaxed);
        let began = Instant::now();
        loop {
            match stop.call_until_answered(&TriggerRequest::default(), Duration::from_secs(2)) {
                Ok(answer) => {
                    assert!(answer.success, "{}", answer.message);
                    took.push(began.elapsed());
                    break;
                }
                Err(_) if !driver.has_ended() && began.elapsed() < PATIENCE => {}
                Err(_) => {
                    unanswered += 1;
                    break;
                }
            }
        }
        if last || driver.has_ended() {
            break;
        }
    }
    flood.join().unwrap();
    let goes_on = !driver.has_ended() && client.goes_on();
    let (code, said, memory) = driver.end();
    took.sort();
    let at = |part: usize| took.get((took.len() * part / 100).min(took.len().saturating_sub(1)));
    eprintln!(
        "hostile traffic: {which}: {} stops answered after {:?} (median), {:?} (99 of 100); {unanswered} not; {} MiB; exit code {code:?}; the loop went on: {goes_on}",
        took.len(),
        at(50),
        at(99),
        memory >> 20
    );
    assert!(memory < MOST, "{memory} bytes");
    assert!(!said.contains("panicked"), "{said}");
    if code == Some(1) {
        // Ended by itself, and it said why.
        assert!(said.contains("with the motor at zero volts"), "{said}");
    } else {
        assert!(code == Some(0) || code == Some(i32::from(ros_node::FORCED)), "{code:?}: {said}");
        assert!(unanswered == 0 && !took.is_empty(), "{unanswered} stops unanswered: {said}");
        // Of packets that are changed at random one may be the word of a node of the same name that
        // began earlier: beside it this one does not work.
        let gave_way = said.contains("was there before");
        assert!(goes_on || gave_way && said.contains("deactivate: active to inactive"), "{said}");
    }
}
