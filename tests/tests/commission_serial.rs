//! `frictionlab commission` against the emulated rig on a pseudo-terminal, in real time: what goes
//! wrong on the way, and in the long tier three machines from end to end.
//!
//! On a busy machine a line falls silent and a commission may end there, as it should: what load can
//! change is counted and told, and what it cannot is asserted.
#![cfg(target_os = "linux")]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::sync::{Mutex, PoisonError};

use serde_json::Value;
use tests::emulated_rig::{EmulatedRig, said};

/// Cycles with volts after which the ramps of `meet` are under way.
const UNDERWAY: u64 = 2000;

fn commission(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = tests::frictionlab();
    command.arg("commission").args(arguments).current_dir(folder);
    command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

fn begun(rig: &EmulatedRig, arguments: &[&str]) -> Child {
    let choice = rig.choice();
    let all = [&[&choice, "--yes", "--out", "results"][..], arguments].concat();
    commission(rig.folder(), &all).spawn().expect("it starts")
}

/// A machine that is busy elsewhere starved the line, and the commission ended there.
struct Starved;

fn starved(output: &Output) -> Result<(), Starved> {
    if said(output).contains("keeps this machine busy") { Err(Starved) } else { Ok(()) }
}

/// The emulated device runs in cycles: where many of them came late, its clock is behind, and says no
/// more that it ran on.
fn behind(output: &Output) -> Result<(), Starved> {
    if said(output).contains("that nobody knows any more") { Err(Starved) } else { Ok(()) }
}

/// The same of one that may not even have begun: the rig was not heard when it was looked at.
fn unheard(output: &Output) -> Result<(), Starved> {
    if said(output).contains("no measurement came from") { Err(Starved) } else { starved(output) }
}

/// Tries anew, from a new rig, what a busy machine starved; one rig at a time.
fn tries(what: impl Fn() -> Result<(), Starved>) {
    static ONE_RIG: Mutex<()> = Mutex::new(());
    let _alone = ONE_RIG.lock().unwrap_or_else(PoisonError::into_inner);
    let went = (1..=10).find(|_| what().is_ok());
    match went {
        Some(1) => {}
        Some(tries) => println!("the line was starved {} times before", tries - 1),
        None => tests::leave_out("this machine is busy: the line was starved ten times"),
    }
}

/// The commission once its motor had volts in `least` cycles.
fn underway(rig: &mut EmulatedRig, mut child: Child, least: u64) -> Result<Child, Starved> {
    if rig.driven_by(&mut child, least) {
        return Ok(child);
    }
    let output = child.wait_with_output().expect("its end");
    unheard(&output)?;
    panic!("it ended: {}", said(&output));
}

/// One that goes on in its folder, once its motor had volts in more cycles.
fn going_on(rig: &mut EmulatedRig, more: &[&str]) -> Result<Child, Starved> {
    let before = rig.book("driven");
    let arguments = [&["--resume", "results", "--yes"][..], more].concat();
    let child = commission(rig.folder(), &arguments).spawn().expect("it starts");
    underway(rig, child, before + UNDERWAY)
}

fn interrupt(child: &Child) {
    let pid = child.id().to_string();
    assert!(Command::new("kill").args(["-INT", &pid]).status().expect("kill runs").success());
}

/// What it said, after it ended with something in its way: the motor at zero volts, what is done
/// kept, and nothing handed over.
fn ended(rig: &mut EmulatedRig, child: Child) -> Output {
    let output = child.wait_with_output().expect("its end");
    let status = rig.pass(5);
    assert_eq!(status["voltage"], 0, "{status} {}", said(&output));
    let results = rig.folder().join("results");
    assert!(results.join("rig.json").is_file(), "{}", said(&output));
    for file in ["parameters.yaml", "commission.json", "report.html"] {
        assert!(!results.join(file).exists(), "{file} of a commission that did not end");
    }
    output
}

#[test]
fn ctrl_c_at_any_moment_leaves_zero_volts_and_a_folder_that_goes_on() {
    tries(|| {
        let mut rig = EmulatedRig::start(&[]);
        let child = begun(&rig, &[]);
        let child = underway(&mut rig, child, UNDERWAY)?;
        interrupt(&child);
        let output = ended(&mut rig, child);
        starved(&output)?;
        assert_eq!(output.status.code(), Some(130), "{}", said(&output));
        assert!(said(&output).contains("--resume results` goes on"), "{}", said(&output));
        // It goes on, and can be stopped again.
        let again = going_on(&mut rig, &[])?;
        interrupt(&again);
        let output = ended(&mut rig, again);
        starved(&output)?;
        assert_eq!(output.status.code(), Some(130));
        rig.finish();
        Ok(())
    });
}

#[test]
fn a_stop_and_a_fault_of_the_device_say_what_it_was_and_how_to_go_on() {
    for (order, mended, words) in
        [("stop", "release", "emergency stop"), ("fault", "status", "driver stage")]
    {
        tries(|| {
            let mut rig = EmulatedRig::start(&[]);
            let child = begun(&rig, &[]);
            let child = underway(&mut rig, child, UNDERWAY)?;
            rig.order(order);
            let output = ended(&mut rig, child);
            starved(&output)?;
            let told = said(&output);
            assert!(!output.status.success() && told.contains(words), "{told}");
            assert!(told.contains("--resume results --clear"), "{told}");
            // It holds for whoever does not clear it.
            let held =
                commission(rig.folder(), &["--resume", "results", "--yes"]).output().unwrap();
            unheard(&held)?;
            assert!(!held.status.success() && said(&held).contains(words), "{}", said(&held));
            if order == "stop" {
                rig.order(mended);
                rig.pass(5);
                let again = going_on(&mut rig, &["--clear"])?;
                interrupt(&again);
                ended(&mut rig, again);
            }
            rig.finish();
            Ok(())
        });
    }
}

#[test]
fn a_limited_travel_outlives_a_silence_and_not_a_device_that_starts_anew() {
    tries(|| {
        let mut rig = EmulatedRig::start(&[]);
        // The device has run for longer than two clocks may differ and than it will be silent.
        rig.pass(5000);
        let child = begun(&rig, &["--travel", "-3:3"]);
        let child = underway(&mut rig, child, UNDERWAY)?;
        rig.order("hang 300");
        let before = rig.book("driven");
        let child = underway(&mut rig, child, before + UNDERWAY)?;
        interrupt(&child);
        starved(&ended(&mut rig, child))?;
        let travel =
            fs::read_to_string(rig.folder().join("results/travel.json")).expect("a travel");
        // The device ran on: the travel holds without a word.
        let before = rig.book("driven");
        let mut again =
            commission(rig.folder(), &["--resume", "results", "--yes"]).spawn().expect("it starts");
        if !rig.driven_by(&mut again, before + UNDERWAY) {
            let output = again.wait_with_output().expect("its end");
            behind(&output).and_then(|()| unheard(&output))?;
            panic!("it ended: {}", said(&output));
        }
        let kept = fs::read_to_string(rig.folder().join("results/travel.json")).unwrap();
        assert_eq!(kept, travel);
        // Its encoder begins anew.
        rig.order("reboot 300");
        let output = ended(&mut rig, again);
        assert!(said(&output).contains("started anew"), "{}", said(&output));
        let refused = commission(rig.folder(), &["--resume", "results", "--yes"]).output().unwrap();
        unheard(&refused)?;
        let told = said(&refused);
        assert_eq!(refused.status.code(), Some(2), "{told}");
        assert!(told.contains("started anew") && told.contains("--travel"), "{told}");
        rig.finish();
        Ok(())
    });
}

#[test]
fn another_device_and_limits_that_contradict_each_other_move_nothing() {
    tries(|| {
        let mut first = EmulatedRig::start(&[]);
        let child = begun(&first, &[]);
        let child = underway(&mut first, child, UNDERWAY)?;
        interrupt(&child);
        starved(&ended(&mut first, child))?;
        nothing_of_another_moves(first);
        Ok(())
    });
}

/// With the folder of `first`, nothing moves a second rig.
fn nothing_of_another_moves(first: EmulatedRig) {
    let mut second = EmulatedRig::start(&["--voltage-range", "9"]);
    let results = first.folder().join("results");
    let (choice, place) = (second.choice(), results.display().to_string());
    let refused = |arguments: &[&str], words: &str| {
        let heard = tests::unstarved(|| {
            let output = commission(first.folder(), arguments).output().expect("it runs");
            unheard(&output).is_ok().then_some(output)
        });
        let Some(output) = heard else { return };
        let told = said(&output);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {told}");
        assert!(told.contains(words), "{arguments:?}: {told}");
    };
    refused(&[&choice, "--yes", "--resume", &place], "it is of the rig");
    let of = fs::read_to_string(results.join("rig.json")).expect("whose it is");
    fs::write(results.join("rig.json"), of.replace(&first.name(), &second.name())).unwrap();
    refused(&[&choice, "--yes", "--resume", &place], "another device answers");
    let profile = first.folder().join("profile.yaml");
    let file = profile.display().to_string();
    for (limits, more, words) in [
        ("{voltage: -1.0}", &[][..], "voltage"),
        ("{velocity: 0.0}", &[], "velocity"),
        ("{voltage: 20.0}", &[], "the voltage range of this rig"),
        ("{travel: {min: 1.0, max: -1.0, margin: 0.1}}", &[], "a min below its max"),
        ("{travel: {min: 5.0, max: 8.0, margin: 0.1}}", &[], "turn it by hand"),
        ("{travel: {min: -5.0, max: 8.0, margin: 0.1}}", &["--travel", "find"], "leave out one"),
        ("{}", &["--travel", "-0.1:0.1"], "needs 0.5 rad"),
    ] {
        fs::write(&profile, format!("rig: {}\nlimits: {limits}\n", second.name())).unwrap();
        refused(&[&["--rig-file", &file, "--yes", "--out", "new"][..], more].concat(), words);
        assert!(!first.folder().join("new").exists(), "{limits}");
    }
    refused(&[&choice, "--out", "new"], "--yes");
    assert_eq!(second.book("driven"), 0);
    first.finish();
    second.finish();
}

/// A cable that is pulled for good ends it after half a minute.
#[tests::needs(long_tier)]
#[test]
fn an_unplugged_device_ends_it_with_what_to_check() {
    tries(|| {
        let mut rig = EmulatedRig::start(&[]);
        let child = begun(&rig, &[]);
        let child = underway(&mut rig, child, UNDERWAY)?;
        rig.order("unplug 40000");
        let output = ended(&mut rig, child);
        let told = said(&output);
        assert!(told.contains("cable") && told.contains("--resume"), "{told}");
        rig.finish();
        Ok(())
    });
}

/// Machines of the trial in real time, behind the serial protocol, as a stranger would have them:
/// their maker's limits in a profile, and ends that have to be found.
#[tests::needs(long_tier)]
#[test]
fn three_machines_are_commissioned_over_the_serial_protocol() {
    let folder = tempfile::tempdir().expect("a folder");
    let machines = described(folder.path());
    let tried: Vec<Tried> = std::thread::scope(|scope| {
        let one = |machine: &PathBuf| {
            let machine = machine.clone();
            scope.spawn(move || tried(&machine))
        };
        let all: Vec<_> = machines.iter().map(one).collect();
        all.into_iter().map(|one| one.join().expect("it does not panic")).collect()
    });
    let done = tried.iter().filter(|tried| tried.commissioned).count();
    for tried in &tried {
        println!("{}", tried.words);
    }
    println!("{done} of {} machines were commissioned over the line", tried.len());
}

struct Tried {
    commissioned: bool,
    words: String,
}

/// Files of three machines of the trial.
fn described(folder: &Path) -> Vec<PathBuf> {
    let arguments = ["--trial", "3", "--seed", "5011", "--out", "machines", "--quiet"];
    let output = commission(folder, &arguments).output().expect("it runs");
    assert!(output.status.success(), "{}", said(&output));
    (5011..5014).map(|seed| folder.join(format!("machines/machine-{seed}.json"))).collect()
}

fn tried(machine: &Path) -> Tried {
    let file = machine.display().to_string();
    let rig = EmulatedRig::start(&["--machine", &file]);
    let described: Value =
        serde_json::from_str(&fs::read_to_string(machine).expect("a machine")).expect("JSON");
    let limits = &described["limits"];
    let profile = rig.folder().join("rig.yaml");
    let text = format!(
        "rig: {}\nlimits: {{voltage: {}, velocity: {}}}\n",
        rig.name(),
        limits["voltage"],
        limits["velocity"]
    );
    fs::write(&profile, text).expect("a profile");
    let (profile, place) = (profile.display().to_string(), rig.folder().join("results"));
    let mut arguments =
        vec!["--rig-file", &profile, "--yes", "--out", "results", "--minutes", "12"];
    if !described["stops"].is_null() {
        arguments.extend(["--travel", "find"]);
    }
    let mut output = commission(rig.folder(), &arguments).output().expect("it runs");
    let mut words = said(&output);
    // A line that a busy machine starved is gone on with, as a person would.
    for _ in 0..2 {
        if output.status.success() || !words.contains("busy") {
            break;
        }
        let again = ["--resume", "results", "--rig-file", &profile, "--yes", "--minutes", "20"];
        output = commission(rig.folder(), &again).output().expect("it runs");
        words += &said(&output);
    }
    let commissioned = output.status.success();
    let parameters = place.join("parameters.yaml");
    // All of the hand-over or nothing of it.
    assert_eq!(parameters.is_file(), commissioned, "{words}");
    assert_eq!(place.join("commission.json").is_file(), commissioned, "{words}");
    if commissioned {
        let text = fs::read_to_string(&parameters).expect("parameters");
        for node in ["/rig_driver", "/friction_observer", "/controller"] {
            assert!(text.contains(node), "{text}");
        }
    } else {
        assert!(words.contains("error:"), "{words}");
    }
    let summary = rig.finish();
    assert_eq!((&summary["state"], &summary["voltage"]), (&"inactive".into(), &0.into()));
    let name = described["name"].as_str().unwrap_or_default();
    let last: Vec<&str> = words.lines().rev().take(24).collect();
    let last: Vec<&str> = last.into_iter().rev().collect();
    Tried { commissioned, words: format!("{name}\n{}", last.join("\n")) }
}
