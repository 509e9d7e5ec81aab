//! A secured driver and peers of another vendor: Fast DDS in C++, compiled here (Debian:
//! libfastrtps-dev, libfastcdr-dev, g++).
//!
//! The controller's enclave exchanges states and voltages with the driver, authenticated and
//! encrypted. Whoever is in the clear, of another keystore, out of date, without permission, or
//! with rules of its own making, gets and moves nothing.

use std::{
    env, fs,
    io::Read,
    path::{Path, PathBuf},
    process::{Child, Command, Stdio},
    sync::{
        Arc, Mutex,
        atomic::{AtomicBool, AtomicU64, Ordering},
    },
    thread,
    time::{Duration, Instant, SystemTime},
};

use msgs::{
    std_srvs::{Trigger, TriggerRequest},
    topics,
};
use ros_node::{
    Arguments, Discovery, Participant, RosNode,
    lifecycle::{Phase, RemoteLifecycle},
    security::{
        Standing,
        keystore::Authority,
        permissions::{Policy, read_policy},
        policy::policy,
    },
};
use socket2::{Domain, Protocol, Socket, Type};
use tests::network::namespaced;

/// Set where a test runs itself in a namespace: the folder it works in.
const INSIDE: &str = "FRICTION_SECURITY_INSIDE";
const DOMAIN: u16 = 77;
const DAY: i64 = 86_400;
/// Longest wait for what must come.
const PATIENCE: Duration = Duration::from_secs(60);
/// Time that each stranger has.
const SECONDS: &str = "8";
/// Runs a test of this file once more, in a network of its own, with a keystore and the compiled
/// peer.
fn in_a_network_of_its_own(test: &str) {
    let folder = tempfile::tempdir().expect("a folder");
    compile(folder.path());
    keystores(folder.path());
    let output = namespaced()
        .arg(env::current_exe().expect("a test knows its program"))
        .args(["--exact", test, "--nocapture"])
        .env(INSIDE, folder.path())
        .env("ROS_DOMAIN_ID", DOMAIN.to_string())
        .env("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
        .env("ROS_SECURITY_ENABLE", "true")
        .env("ROS_SECURITY_STRATEGY", "Enforce")
        .env("ROS_SECURITY_KEYSTORE", folder.path().join("keys"))
        .env_remove("ROS_SECURITY_ENCLAVE_OVERRIDE")
        .output()
        .expect("unshare starts");
    let said = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success(), "{said}\n{}", String::from_utf8_lossy(&output.stderr));
    assert!(said.contains("1 passed"), "{said}");
}

fn compile(folder: &Path) {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/security/peer.cpp");
    let output = Command::new("g++")
        .args(["-std=c++17", "-O1", "-o"])
        .arg(folder.join("peer"))
        .arg(source)
        .args(["-lfastrtps", "-lfastcdr"])
        .output()
        .expect("g++ starts");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

/// The laboratory's keystore, one of strangers, and enclaves of cheats.
fn keystores(folder: &Path) {
    let now = SystemTime::now()
        .duration_since(SystemTime::UNIX_EPOCH)
        .expect("a time")
        .as_secs()
        .cast_signed();
    let ours: Policy = read_policy(&policy("/")).expect("the policy is one");
    let valid = (now - 100 * DAY, now + 100 * DAY);
    let make =
        |name: &str| Authority::new(&folder.join(name), &[DOMAIN], valid).expect("an authority");
    let (keys, strange) = (make("keys"), make("strange"));
    for (name, rights) in &ours {
        keys.enclave(name, rights, valid, valid).expect("an enclave");
    }
    strange.enclave("/controller", &ours["/controller"], valid, valid).expect("an enclave");
    let over = (now - 100 * DAY, now - 10 * DAY);
    keys.enclave("/late", &ours["/controller"], over, over).expect("an enclave");

    // A viewer whose permissions another authority signed: those of the controller.
    strange.enclave("/viewer", &ours["/controller"], valid, valid).expect("an enclave");
    for file in ["cert.pem", "key.pem", "identity_ca.cert.pem"] {
        let from = folder.join("keys/enclaves/viewer").join(file);
        fs::copy(from, folder.join("strange/enclaves/viewer").join(file)).expect("a copy");
    }
}

/// A program that is killed when the test is over.
struct Running(Child);

impl Drop for Running {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

fn driver() -> Running {
    Running(Command::new(env!("CARGO_BIN_EXE_rig_driver")).spawn().expect("the driver starts"))
}

fn peer(folder: &Path, enclave: &str, seconds: &str, manner: &[&str]) -> Running {
    let enclave = if enclave == "clear" { PathBuf::from(enclave) } else { folder.join(enclave) };
    let mut command = Command::new(folder.join("peer"));
    command.arg(DOMAIN.to_string()).arg(enclave).arg(seconds).args(manner).stdout(Stdio::piped());
    Running(command.spawn().expect("the peer starts"))
}

fn said(mut running: Running) -> String {
    let mut text = String::new();
    running.0.stdout.take().expect("a pipe").read_to_string(&mut text).expect("text");
    text
}

fn until(what: &str, mut is: impl FnMut() -> bool) {
    let began = Instant::now();
    while !is() {
        assert!(began.elapsed() < PATIENCE, "{what}: not within {PATIENCE:?}");
        thread::sleep(Duration::from_millis(10));
    }
}

/// Whoever looks at the driver: how many measurements, and the highest voltage asked for or
/// applied.
struct Watched {
    // Leaves before its participant.
    node: RosNode,
    participant: Participant,
    measurements: Arc<AtomicU64>,
    highest: Arc<Mutex<f64>>,
}

impl Watched {
    fn begin(enclave: &str) -> Self {
        let arguments = Arguments::default().or_enclave(enclave);
        let discovery = Discovery::from_environment().expect("an environment");
        let participant = Participant::join_with(&discovery, arguments).expect("joins");
        let node = participant.node(enclave.trim_start_matches('/')).expect("a node");
        let (measurements, highest) = (Arc::<AtomicU64>::default(), Arc::<Mutex<f64>>::default());
        let (counted, seen) = (Arc::clone(&measurements), Arc::clone(&highest));
        node.subscribe(&topics::RIG_MEASUREMENT, move |message| {
            counted.fetch_add(1, Ordering::Relaxed);
            let mut highest = seen.lock().expect("a number");
            *highest = highest.max(message.voltage_asked.abs()).max(message.voltage_applied.abs());
        })
        .expect("a subscription");
        Self { node, participant, measurements, highest }
    }

    fn sees(&self) -> bool {
        self.measurements.load(Ordering::Relaxed) > 0
    }

    fn highest(&self) -> f64 {
        *self.highest.lock().expect("a number")
    }

    fn count(&self, standing: Standing) -> usize {
        self.participant
            .others()
            .known()
            .values()
            .filter(|other| other.standing == Some(standing))
            .count()
    }
}

/// Whether a text was in any packet since it began; packets on loopback are seen as they travel.
struct Sniffer {
    seen: Arc<AtomicBool>,
    end: Arc<AtomicBool>,
    thread: Option<thread::JoinHandle<u64>>,
}

impl Sniffer {
    fn begin(text: &'static str) -> Self {
        const EVERYTHING: i32 = 0x0300;
        let mut socket = Socket::new(Domain::PACKET, Type::DGRAM, Some(Protocol::from(EVERYTHING)))
            .expect("a socket");
        socket.set_read_timeout(Some(Duration::from_millis(100))).expect("a limit");
        let (seen, end) = (Arc::<AtomicBool>::default(), Arc::<AtomicBool>::default());
        let (tell, ended) = (Arc::clone(&seen), Arc::clone(&end));
        let thread = thread::spawn(move || {
            let (mut packet, mut count) = (vec![0; 65_536], 0);
            while !ended.load(Ordering::Relaxed) {
                let Ok(length) = socket.read(&mut packet) else { continue };
                count += 1;
                if packet[..length].windows(text.len()).any(|part| part == text.as_bytes()) {
                    tell.store(true, Ordering::Relaxed);
                }
            }
            count
        });
        Self { seen, end, thread: Some(thread) }
    }

    /// Packets, and whether the text was in one.
    fn end(mut self) -> (u64, bool) {
        self.end.store(true, Ordering::Relaxed);
        let packets = self.thread.take().expect("a thread").join().expect("it ends");
        (packets, self.seen.load(Ordering::Relaxed))
    }
}

#[tests::needs(namespace, fast_dds)]
#[test]
fn the_controllers_enclave_drives_a_secured_rig_and_nothing_travels_in_the_clear() {
    let Some(folder) = env::var_os(INSIDE).map(PathBuf::from) else {
        return in_a_network_of_its_own(
            "the_controllers_enclave_drives_a_secured_rig_and_nothing_travels_in_the_clear",
        );
    };
    let sniffer = Sniffer::begin("load_shaft");
    let _driver = driver();
    let operator = Watched::begin("/operator");
    until("measurements", || operator.sees());
    let controller = peer(&folder, "keys/enclaves/controller", "30", &[]);
    until("the peer's voltage on the motor", || operator.highest() > 1.4);
    // The operator may stop and lead; a viewer may only stop, see below.
    let node = &operator.node;
    let stop = node.client::<Trigger>("/rig_driver/emergency_stop").expect("a client");
    let stopped =
        stop.call_until_answered(&TriggerRequest::default(), PATIENCE).expect("an answer");
    assert!(stopped.success, "{}", stopped.message);
    let clear = node.client::<Trigger>("/rig_driver/clear_fault").expect("a client");
    until("a cleared fault", || {
        clear
            .call_until_answered(&TriggerRequest::default(), PATIENCE)
            .is_ok_and(|answer| answer.success)
    });
    let lifecycle = RemoteLifecycle::new(node, "/rig_driver").expect("clients");
    lifecycle.lead_to(Phase::Active, PATIENCE).expect("active again");
    let told = said(controller);
    assert!(told.contains("authorised") && told.contains("state of"), "{told}");
    assert!(!told.contains("unauthorised") && !told.contains("refused"), "{told}");
    assert!(operator.count(Standing::Authenticated) >= 1, "{:?}", operator.participant.others());
    let (packets, readable) = sniffer.end();
    assert!(packets > 1000, "{packets} packets");
    assert!(!readable, "the name of the joint could be read on the line");
}

/// What the test above says of the sniffer, the other way round: in the clear it reads the name of
/// the joint.
#[tests::needs(namespace, fast_dds)]
#[test]
fn in_the_clear_the_same_line_can_be_read() {
    if env::var_os(INSIDE).is_none() {
        return in_a_network_of_its_own("in_the_clear_the_same_line_can_be_read");
    }
    let sniffer = Sniffer::begin("load_shaft");
    let mut command = Command::new(env!("CARGO_BIN_EXE_rig_driver"));
    command.env("ROS_SECURITY_ENABLE", "false");
    let _driver = Running(command.spawn().expect("the driver starts"));
    let participant = Participant::join_with(
        &Discovery::from_environment().expect("an environment"),
        Arguments { in_the_clear: true, ..Arguments::default() },
    )
    .expect("joins");
    let node = participant.node("listener").expect("a node");
    node.subscribe(&topics::JOINT_STATES, |_| {}).expect("a subscription");
    until("the name of the joint on the line", || sniffer.seen.load(Ordering::Relaxed));
    assert!(sniffer.end().1);
}

#[tests::needs(namespace, fast_dds)]
#[test]
fn strangers_get_and_move_nothing() {
    let Some(folder) = env::var_os(INSIDE).map(PathBuf::from) else {
        return in_a_network_of_its_own("strangers_get_and_move_nothing");
    };
    let _driver = driver();
    let viewer = Watched::begin("/viewer");
    until("measurements", || viewer.sees());
    let node = &viewer.node;
    let lifecycle = RemoteLifecycle::new(node, "/rig_driver");
    assert!(lifecycle.is_err(), "a viewer has no client that changes states");

    let strangers = [
        ("clear", &[][..]),
        ("strange/enclaves/controller", &[]),
        ("strange/enclaves/viewer", &[]),
        // Its clock says that its certificate is good.
        ("keys/enclaves/late", &["20"]),
        // Who it is and what it may do is true; its middleware lets it do more.
        ("keys/enclaves/viewer", &["0", "bold"]),
    ];
    let running =
        strangers.map(|(enclave, manner)| (enclave, peer(&folder, enclave, SECONDS, manner)));
    let permitted_reader = peer(&folder, "keys/enclaves/viewer", SECONDS, &[]);
    for (enclave, peer) in running {
        let told = said(peer);
        assert!(
            told.contains("ready") && !told.contains("refused"),
            "{enclave} had its chance: {told}"
        );
        // Only the bold one is a viewer.
        let reads = enclave == "keys/enclaves/viewer";
        assert_eq!(told.contains("state of"), reads, "{enclave} hears the driver: {told}");
    }
    let told = said(permitted_reader);
    assert!(
        told.contains("state of") && told.contains("refused voltage"),
        "a viewer reads and does not write: {told}"
    );
    let highest = viewer.highest();
    assert!(highest == 0.0, "{highest} V on the motor");

    // Everybody can stop it.
    let stop = node.client::<Trigger>("/rig_driver/emergency_stop").expect("a client");
    let stopped =
        stop.call_until_answered(&TriggerRequest::default(), PATIENCE).expect("an answer");
    assert!(stopped.success, "{}", stopped.message);
}

/// Each refusal is exit code 2 and a sentence, before anything is on the network.
#[test]
fn a_driver_whose_credentials_are_not_in_order_does_not_start() {
    let folder = tempfile::tempdir().expect("a folder");
    keystores(folder.path());
    let keys = folder.path().join("keys");
    let broken = folder.path().join("keys/enclaves/friction_observer/permissions.p7s");
    fs::copy(folder.path().join("keys/enclaves/viewer/permissions.p7s"), broken).expect("a copy");
    for (arguments, domain, said) in [
        (&["--enclave", "/late"][..], "77", "cert.pem expired"),
        (&["--enclave", "/nobody"], "77", "enclaves/nobody"),
        (&["--enclave", "/../private"], "77", "no enclave"),
        (&["--enclave", "/friction_observer"], "77", "grants nothing to CN=/friction_observer"),
        (&[], "78", "--domain 78"),
    ] {
        let output = Command::new(env!("CARGO_BIN_EXE_rig_driver"))
            .arg("--ros-args")
            .args(arguments)
            .env("ROS_DOMAIN_ID", domain)
            .env("ROS_SECURITY_ENABLE", "true")
            .env("ROS_SECURITY_STRATEGY", "Enforce")
            .env("ROS_SECURITY_KEYSTORE", &keys)
            .env_remove("ROS_SECURITY_ENCLAVE_OVERRIDE")
            .output()
            .expect("the driver starts");
        let told = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {told}");
        assert!(told.contains(said), "{arguments:?}: {told}");
    }
}
