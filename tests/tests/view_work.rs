//! The view of a commission and of runs in a real browser: consent, stages, intervals, what came of
//! it, and the reports that are opened from the page.

use std::time::Duration;

use serde_json::Value;
use tests::emulated_rig::EmulatedRig;
use tests::tab::Tab;
use tests::viewed::{Viewed, barriers, inside, page};

/// How often the device is asked again.
const AGAIN: Duration = Duration::from_millis(20);
/// Cycles in which nothing may move.
const STILL: u64 = 500;
/// Cycles with volts after which the motor turns.
const TURNS: u64 = 300;

const NOW: &str = "document.getElementById('commission-now').textContent";

fn hidden(id: &str) -> String {
    format!("document.getElementById('{id}').hidden")
}

/// A commission of an emulated rig that waits for consent.
fn asking(rig: &EmulatedRig) -> (Viewed, Tab) {
    let words = ["commission", &rig.choice(), "--view-port", "0", "--out", "done"];
    let viewed = Viewed::start(rig.folder(), &words);
    let mut tab = page(&viewed);
    tab.until(&format!("!{}", hidden("consent")));
    (viewed, tab)
}

/// Waits until the motor had volts in so many cycles; false where a busy machine starved the line.
fn driven(rig: &mut EmulatedRig, tab: &mut Tab, least: u64) -> bool {
    while rig.book("driven") < least {
        if tab.evaluate(&format!("{NOW}.startsWith('It ended')")) == true {
            let why = tab.evaluate("document.getElementById('verdict-said').textContent");
            let why = why.as_str().unwrap_or_default();
            let starved = ["busy", "no measurement came"].iter().any(|word| why.contains(word));
            assert!(starved, "it ended: {why}");
            return false;
        }
        std::thread::sleep(AGAIN);
    }
    true
}

fn consent_is(tab: &mut Tab, works: bool) {
    let works = !works;
    tab.until(&format!("document.getElementById('consent-yes').disabled === {works}"));
}

#[tests::needs(chromium, namespace)]
#[test]
fn nothing_moves_before_somebody_says_yes_on_the_page() {
    inside("inside_consent");
}

#[test]
#[ignore = "in a network namespace only"]
fn inside_consent() {
    let mut rig = EmulatedRig::start(&[]);
    let (mut viewed, mut tab) = asking(&rig);
    let believed = tab.evaluate("document.getElementById('believed').textContent");
    assert!(believed.as_str().unwrap().contains("held by the safety layer"), "{believed}");
    // Yes takes two steps.
    consent_is(&mut tab, false);
    tab.click("#consent-here");
    consent_is(&mut tab, true);
    assert!(viewed.said().contains("The page asks"), "{}", viewed.said());
    // The page goes away: nothing moves by itself, and who comes back is asked anew.
    tab.go("about:blank");
    rig.pass(STILL);
    assert_eq!(rig.book("driven"), 0);
    tab.go(viewed.url());
    tab.until(&format!("!{}", hidden("consent")));
    consent_is(&mut tab, false);
    tab.click("#consent-here");
    tab.click("#consent-yes");
    tab.until(&format!("{NOW}.startsWith('meet')"));
    tab.until(
        "document.querySelector('#stages [aria-current=step] .stage').textContent === 'meet'",
    );
    if !driven(&mut rig, &mut tab, TURNS) {
        return tests::leave_out("the machine is too busy for the line of an emulated rig");
    }
    assert_eq!(tab.evaluate(&hidden("consent")), true);
    // The cycles are drawn.
    tab.until("parseInt(document.getElementById('stribeck-said').textContent) > 100");
    // Another page closes: it goes on.
    let before = rig.book("driven");
    drop(page(&viewed));
    if !driven(&mut rig, &mut tab, before + TURNS) {
        return tests::leave_out("the machine is too busy for the line of an emulated rig");
    }
    // It is stopped from the page, which says what is kept.
    tab.click("#commission-stop");
    tab.until(&format!("{NOW}.startsWith('It ended')"));
    tab.until("document.getElementById('verdict-hint').textContent.includes('--resume done')");
    assert!(viewed.runs(), "the page stays as long as somebody looks");
    assert_eq!(tab.evaluate("document.getElementById('commission-stop').disabled"), true);
    assert_eq!(tab.complaints(), [""; 0]);
    drop(tab);
    assert!(!viewed.wait().success());
    rig.finish();
}

#[tests::needs(chromium, namespace)]
#[test]
fn whoever_says_no_ends_it_and_nothing_has_moved() {
    inside("inside_refused");
}

#[test]
#[ignore = "in a network namespace only"]
fn inside_refused() {
    let mut rig = EmulatedRig::start(&[]);
    let (mut viewed, mut tab) = asking(&rig);
    tab.click("#consent-no");
    tab.until("document.getElementById('verdict-said').textContent.includes('nothing has moved')");
    assert_eq!(rig.book("driven"), 0);
    drop(tab);
    assert_eq!(viewed.wait().code(), Some(2));
    rig.finish();
}

#[tests::needs(chromium, namespace, axe)]
#[test]
fn a_commission_is_followed_to_its_report() {
    inside("inside_followed");
}

#[test]
#[ignore = "in a network namespace only"]
fn inside_followed() {
    let folder = tempfile::tempdir().unwrap();
    // A wish that nothing meets: it takes long enough to be looked at.
    let words = ["commission", "--want", "f_c:0.01%", "--minutes", "120", "--out", "done"];
    let viewed = Viewed::start(folder.path(), &[&words[..], &["--view-port", "0"]].concat());
    let mut tab = page(&viewed);
    // Intervals come block by block.
    tab.until(&format!("!{}", hidden("narrowing")));
    tab.until("document.querySelectorAll('#narrowing-chart polyline').length >= 3");
    tab.until("document.querySelectorAll('#curve-chart circle').length >= 8");
    tab.until("document.querySelector('#narrowing-chart line.goal')");
    tab.until("document.querySelector('#intervals tr').textContent.includes('±')");
    tab.until("document.getElementById('commission-progress').value > 0");
    tab.until(&format!("{NOW} === 'Done.'"));
    assert_eq!(tab.evaluate("document.querySelectorAll('#stages li.done').length"), 7);
    let worth = tab.evaluate("document.getElementById('verdict-said').textContent");
    assert!(worth.as_str().unwrap().contains("mrad"), "{worth}");
    for dark in [false, true] {
        for width in [1200, 360] {
            tab.look(width, dark);
            tab.until(&format!("innerWidth === {width}"));
            let wide = tab.evaluate("document.documentElement.scrollWidth");
            assert!(wide.as_u64().unwrap() <= u64::from(width), "{width}: {wide} wide");
            assert_eq!(barriers(&mut tab), Value::Array(Vec::new()), "{width}, dark: {dark}");
        }
    }
    // The report, and the one of the list.
    tab.until(&format!("!{}", hidden("verdict-report")));
    let listed = tab.evaluate("document.querySelector('#runs-rows a').href");
    let report = tab.evaluate("document.getElementById('verdict-report').href");
    assert_eq!(listed, report);
    assert_eq!(tab.complaints(), [""; 0]);
    tab.go(report.as_str().unwrap());
    tab.until("document.title === 'Commission' && document.querySelector('.plotly, svg')");
    // It is no part of the page: it has an origin of its own.
    assert_eq!(tab.evaluate("self.origin"), "null");
    assert_eq!(tab.complaints(), [""; 0]);
    let socket = "new Promise((done) => { const socket = new WebSocket(`ws://${location.host}/`, ['foxglove.websocket.v1']); socket.onopen = () => done('open'); socket.onerror = () => done('refused'); })";
    assert_eq!(tab.evaluate(socket), "refused");
    viewed.end();
}

#[tests::needs(chromium, namespace)]
#[test]
fn an_experiment_that_ended_links_to_its_report() {
    inside("inside_linked");
}

#[test]
#[ignore = "in a network namespace only"]
fn inside_linked() {
    let folder = tempfile::tempdir().unwrap();
    let live = Viewed::live(folder.path(), "0", &["--serve"]);
    let mut tab = page(&live);
    tab.until("document.getElementById('experiment').options.length > 3");
    tab.evaluate(
        "(() => { const one = document.getElementById('experiment'); one.value = 'commission';
         one.dispatchEvent(new Event('change')); })()",
    );
    tab.click("#start");
    tab.until(&format!("{NOW} === 'Done.'"));
    tab.until(&format!("!{} && !{}", hidden("experiment-report"), hidden("verdict-report")));
    let report = tab.evaluate("document.getElementById('experiment-report').href");
    assert_eq!(report, tab.evaluate("document.getElementById('verdict-report').href"));
    assert_eq!(tab.complaints(), [""; 0]);
    tab.go(report.as_str().unwrap());
    tab.until("document.title === 'Commission'");
    live.end();
}
