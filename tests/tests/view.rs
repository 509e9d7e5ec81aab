//! The view of the real program in a real browser: what is seen moves, what is asked is done or
//! refused with a reason, and the emergency stop works.

use std::path::Path;

use serde_json::Value;
use tests::tab::Tab;
use tests::viewed::{Viewed, barriers, inside, page, rig_is, said, set};

/// How often a jog is begun.
const JOGS: usize = 4;

#[tests::needs(chromium, namespace)]
#[test]
fn a_live_loop_is_seen_and_steered() {
    inside("inside_seen_and_steered");
}

#[test]
#[ignore = "in a network namespace only"]
fn inside_seen_and_steered() {
    let folder = tempfile::tempdir().unwrap();
    let live = Viewed::live(folder.path(), "0", &[]);
    let mut tab = page(&live);
    rig_is(&mut tab, "active");
    // Curves and planes fill up.
    tab.until("parseInt(document.getElementById('stribeck-said').textContent) > 500");
    tab.until("document.getElementById('curve-model').textContent === '(proposed)'");
    let plot = "document.querySelector('.plot canvas').toDataURL()";
    let before = tab.evaluate(plot);
    let before = before.as_str().unwrap();
    tab.until(&format!("{plot} !== '{before}'"));
    tab.until("document.querySelector('.plot').getAttribute('aria-label').includes('reference')");

    // A parameter within its range, beyond it, and back.
    tab.evaluate(
        "document.querySelectorAll('#parameters details').forEach((one) => one.open = true)",
    );
    tab.until("document.querySelector('[data-name=\"reference_timeout\"]')");
    set(&mut tab, "reference_timeout", "0.7");
    tab.until(&format!("{} === 'reference_timeout is 0.7'", said("reference_timeout")));
    set(&mut tab, "reference_timeout", "999");
    tab.until(&format!("{}.startsWith('refused: ')", said("reference_timeout")));
    let refused = tab.evaluate(&said("reference_timeout"));
    assert!(refused.as_str().unwrap().contains("60"), "the node's reason: {refused}");
    let shown =
        "document.querySelector('[data-name=\"reference_timeout\"] input[type=number]').value";
    assert_eq!(tab.evaluate(shown), "0.7");
    tab.click("#undo");
    tab.until(&format!("{} === 'reference_timeout is 0.5'", said("reference_timeout")));

    // The reference: within its range, beyond it, another kind, and back.
    set(&mut tab, "amplitude", "0.5");
    tab.until(&format!("{} === 'amplitude is 0.5'", said("amplitude")));
    set(&mut tab, "amplitude", "500");
    tab.until(&format!("{}.startsWith('refused: ')", said("amplitude")));
    set(&mut tab, "kind", "constant_velocity");
    tab.until(&format!("{} === 'kind is constant_velocity'", said("kind")));
    set(&mut tab, "offset", "1.25");
    let response = "[...document.querySelectorAll('.plot')].map((one) => one.getAttribute('aria-label')).find((one) => one?.startsWith('Reference'))";
    tab.until(&format!("{response}?.includes('reference 1.25 ')"));
    tab.click("#undo");
    tab.until(&format!("{response}?.includes('reference 0.00 ')"));

    // The emergency stop by its key, and the way back.
    tab.press("Escape");
    tab.until("document.getElementById('stop-said').textContent.startsWith('Emergency stop: the motor is at zero')");
    rig_is(&mut tab, "emergency stop");
    tab.click("[data-call='rig_driver/clear_fault']");
    tab.until("document.getElementById('steering-said').className === 'said good'");
    for transition in ["configure", "activate"] {
        tab.click(&format!("[data-call='rig_driver/change_state'][data-transition={transition}]"));
        let told =
            if transition == "configure" { "Configure rig: done" } else { "Activate rig: done" };
        tab.until(&format!("document.getElementById('steering-said').textContent === '{told}'"));
    }
    rig_is(&mut tab, "active");
    assert_eq!(tab.complaints(), [""; 0]);

    // The program goes and comes back.
    let port = live.port();
    live.end();
    tab.until("!document.getElementById('lost').hidden");
    tab.click("#stop");
    tab.until("document.getElementById('stop-said').textContent.includes('NOT confirmed')");
    let _live = Viewed::live(folder.path(), &port, &[]);
    tab.until("document.getElementById('connection').textContent === 'connected'");
    assert_eq!(tab.evaluate("document.getElementById('lost').hidden"), true);
    rig_is(&mut tab, "active");
}

#[tests::needs(chromium, namespace)]
#[test]
fn the_page_fits_every_width_and_is_used_by_keyboard_alone() {
    inside("inside_widths_and_keyboard");
}

#[test]
#[ignore = "in a network namespace only"]
fn inside_widths_and_keyboard() {
    let folder = tempfile::tempdir().unwrap();
    let live = Viewed::live(folder.path(), "0", &[]);
    let mut tab = page(&live);
    tab.until("document.querySelector('[data-name=\"fade\"]')");
    tab.evaluate(
        "document.querySelectorAll('#parameters details').forEach((one) => one.open = true)",
    );
    for width in [1200, 700, 360] {
        for dark in [false, true] {
            tab.look(width, dark);
            tab.until(&format!("innerWidth === {width}"));
            let wide = tab.evaluate("document.documentElement.scrollWidth");
            assert!(wide.as_u64().unwrap() <= u64::from(width), "{width}: {wide} wide");
            let name = format!("view_{width}_{}.png", if dark { "dark" } else { "light" });
            tab.picture(&Path::new(env!("CARGO_TARGET_TMPDIR")).join(name));
        }
    }
    tab.look(1200, false);
    // From the top of the page to the emergency stop, and it is pressed.
    tab.evaluate("document.activeElement.blur()");
    let mut seen = Vec::new();
    while tab.evaluate("document.activeElement.id") != "stop" {
        tab.press("Tab");
        seen.push(tab.evaluate("document.activeElement.className || document.activeElement.id"));
        assert!(seen.len() < 20, "the stop is not reached: {seen:?}");
    }
    tab.press("Enter");
    rig_is(&mut tab, "emergency stop");
    // On to a parameter, which is typed in.
    while tab.evaluate("document.activeElement.id") != "filter" {
        tab.press("Tab");
        seen.push(Value::Null);
        assert!(seen.len() < 200, "the parameters are not reached");
    }
    for letter in "fade".chars() {
        tab.press(&letter.to_string());
    }
    tab.until("!document.querySelector('[data-name=\"fade\"]').hidden && document.querySelector('[data-name=\"pid.k_p\"]').hidden");
    assert_eq!(tab.complaints(), [""; 0]);
}

#[tests::needs(chromium, namespace, axe)]
#[test]
fn nothing_keeps_people_from_the_page() {
    inside("inside_accessible");
}

#[test]
#[ignore = "in a network namespace only"]
fn inside_accessible() {
    let folder = tempfile::tempdir().unwrap();
    let live = Viewed::live(folder.path(), "0", &["--serve"]);
    let mut tab = page(&live);
    tab.until("document.querySelector('[data-name=\"fade\"]')");
    tab.until("document.getElementById('experiment').options.length > 3");
    for dark in [false, true] {
        tab.look(if dark { 360 } else { 1200 }, dark);
        assert_eq!(barriers(&mut tab), Value::Array(Vec::new()), "dark: {dark}");
    }
}

#[tests::needs(chromium, namespace)]
#[test]
fn a_page_that_holds_a_jog_and_vanishes_stops_the_motor() {
    inside("inside_jog");
}

#[test]
#[ignore = "in a network namespace only"]
fn inside_jog() {
    let folder = tempfile::tempdir().unwrap();
    let live = Viewed::live(folder.path(), "0", &[]);
    let mut watching = page(&live);
    let mut tab = page(&live);
    rig_is(&mut tab, "active");
    tab.evaluate(
        "(() => { window.commands = 0; const send = WebSocket.prototype.send;
         WebSocket.prototype.send = function (what) {
           if (what[0] === 1) window.commands++; send.call(this, what); }; })()",
    );
    // Where the machine is too busy for a command every few milliseconds a jog ends in a fault, as it
    // must, and is begun again.
    let turns = (0..JOGS).any(|_| jogs(&mut tab, &mut watching));
    assert_eq!(tab.evaluate("window.commands > 20"), true, "the page sends commands");
    if !turns {
        return tests::leave_out("the machine is too busy for a jog by hand");
    }
    // The page is gone in the middle of it.
    drop(tab);
    watching.until(&applied("0.00"));
    rig_is(&mut watching, "faulted");
}

fn applied(volts: &str) -> String {
    let label = "[...document.querySelectorAll('.plot')].map((one) => one.getAttribute('aria-label')).find((one) => one?.startsWith('Voltage'))";
    format!("{label}?.startsWith('Voltage: applied {volts} V')")
}

/// Begins a jog by hand and holds it: whether the motor gets its volts. Where the rig ends it in a
/// fault, that is cleared and the jog is over.
fn jogs(tab: &mut Tab, watching: &mut Tab) -> bool {
    const FAULTED: &str = "document.getElementById('rig').textContent === 'rig: faulted'";
    let held = "!document.getElementById('jog-ahead').disabled";
    tab.click("#jog-ready");
    tab.until(&format!("{held} || document.querySelector('#steering-said.bad')"));
    if tab.evaluate(held) == true {
        tab.hold("#jog-ahead");
        watching.until(&format!("{} || {FAULTED}", applied("1.00")));
        if watching.evaluate(FAULTED) == false {
            return true;
        }
        tab.let_go("#jog-ahead");
        tab.click("[data-call='rig_driver/clear_fault']");
        rig_is(tab, "inactive");
        tab.click("#jog-end");
    }
    tab.until("!document.getElementById('jog-ready').disabled");
    false
}

#[tests::needs(chromium, namespace)]
#[test]
fn an_experiment_is_started_and_aborted_from_the_page() {
    inside("inside_experiment");
}

#[test]
#[ignore = "in a network namespace only"]
fn inside_experiment() {
    let folder = tempfile::tempdir().unwrap();
    let live = Viewed::live(folder.path(), "0", &["--serve"]);
    let mut tab = page(&live);
    tab.until("document.getElementById('experiment').options.length > 3");
    tab.evaluate(
        "(() => { const one = document.getElementById('experiment'); one.value = 'characterise';
         one.dispatchEvent(new Event('change')); })()",
    );
    tab.click("#start");
    tab.until(
        "document.getElementById('experiment-status').textContent.startsWith('characterise')",
    );
    tab.until("document.getElementById('progress').value > 0");
    tab.click("#abort");
    tab.until("document.getElementById('experiment-said').className === 'said good'");
    tab.until(
        "!document.getElementById('experiment-status').textContent.startsWith('characterise')",
    );
}

#[tests::needs(chromium, namespace)]
#[test]
fn a_recording_is_played_and_sought() {
    inside("inside_recording");
}

#[test]
#[ignore = "in a network namespace only"]
fn inside_recording() {
    let folder = tempfile::tempdir().unwrap();
    let run = tests::frictionlab()
        .args(["live", "--quiet", "--duration", "4", "--out", "out"])
        .current_dir(folder.path())
        .env("ROS_DOMAIN_ID", "77")
        .output()
        .unwrap();
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    let played = Viewed::start(folder.path(), &["view", "out/bag", "--view-port", "0"]);
    let mut tab = page(&played);
    assert_eq!(tab.evaluate("document.getElementById('player').hidden"), false);
    // Nothing can be steered but the recording.
    assert_eq!(tab.evaluate("document.getElementById('steering').hidden"), true);
    tab.until("document.getElementById('play').textContent === 'Play'");
    let at = "parseFloat(document.getElementById('seek-said').textContent)";
    tab.until(&format!("{at} > 3"));
    tab.click("#play");
    tab.until(&format!("{at} < 2 && document.getElementById('play').textContent === 'Pause'"));
    tab.until("parseInt(document.getElementById('stribeck-said').textContent) > 100");
    tab.click("#play");
    tab.until("document.getElementById('play').textContent === 'Play'");
    tab.evaluate(
        "(() => { const seek = document.getElementById('seek'); seek.value = '3';
         seek.dispatchEvent(new Event('input')); seek.dispatchEvent(new Event('change')); })()",
    );
    tab.until(&format!("{at} === 3"));
    assert_eq!(tab.complaints(), [""; 0]);
}

#[tests::needs(chromium, namespace)]
#[test]
fn launched_nodes_are_seen_and_stopped() {
    inside("inside_launched");
}

#[test]
#[ignore = "in a network namespace only"]
fn inside_launched() {
    let folder = tempfile::tempdir().unwrap();
    let words = ["launch", "namespace:=axis_1", "--view-port", "0"];
    let launched = Viewed::start(folder.path(), &words);
    let mut tab = page(&launched);
    rig_is(&mut tab, "active");
    tab.until("parseInt(document.getElementById('stribeck-said').textContent) > 500");
    tab.until("document.getElementById('curve-model').textContent === '(proposed)'");
    tab.evaluate(
        "document.querySelectorAll('#parameters details').forEach((one) => one.open = true)",
    );
    tab.until("document.querySelector('[data-name=\"reference_timeout\"]')");
    set(&mut tab, "reference_timeout", "0.7");
    tab.until(&format!("{} === 'reference_timeout is 0.7'", said("reference_timeout")));
    tab.press("Escape");
    rig_is(&mut tab, "emergency stop");
    // What another process logs, and what it says of its health.
    tab.until("document.getElementById('log').textContent.includes('rig_driver')");
    tab.until("document.getElementById('timing').textContent.includes('rig_driver')");
    launched.end();
}
